/* SPDX-License-Identifier: MIT */
#include "encoder/enc_lod_wedges.h"

#include <math.h>
#include <string.h>

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void difference(const double a[3], const double b[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = a[i] - b[i];
}

/* ---- one place for both ends --------------------------------------------- */

/* Both ends' quadrics of the wedges whose fate is `fate`, about the middle of
 * the edge and the mean of their values, which goes to `center`. */
static void sum_group(const enc_lod_wedges *ws, const enc_lod_edge *e,
                      uint32_t fate, enc_quadric *q, double *tail,
                      double *center)
{
    const double back[3] = { -e->half[0], -e->half[1], -e->half[2] };
    unsigned count = 0;

    *q = (enc_quadric){ .c = 0 };
    memset(tail, 0, enc_joint_tail(ws->active) * sizeof *tail);
    for (unsigned i = 0; i < ws->active; i++)
        center[i] = 0;
    for (uint32_t w = 0; w < ws->count && ws->active; w++) {
        if (ws->fate[ws->list[w]] != fate)
            continue;
        count++;
        for (unsigned i = 0; i < ws->active; i++)
            center[i] += enc_lod_value(ws, ws->list[w])[i];
    }
    for (unsigned i = 0; i < ws->active; i++)
        center[i] /= count;
    for (uint32_t w = 0; w < ws->count; w++) {
        const uint32_t wedge = ws->list[w];
        double away[ENC_JOINT_MAX];
        if (ws->fate[wedge] != fate)
            continue;
        for (unsigned i = 0; i < ws->active; i++)
            away[i] = enc_lod_value(ws, wedge)[i] - center[i];
        enc_joint_add(q, tail, &ws->quadric[wedge], enc_lod_tail(ws, wedge),
                      ws->active, w < ws->kept_count ? back : e->half, away);
    }
}

void enc_lod_sum_plain(const enc_lod_wedges *ws, const enc_lod_edge *e,
                       enc_quadric *total)
{
    const double back[3] = { -e->half[0], -e->half[1], -e->half[2] };

    *total = (enc_quadric){ .c = 0 };
    enc_quadric_add(total, &ws->quadric[ws->lod->lone[e->kept]], back);
    enc_quadric_add(total, &ws->quadric[ws->lod->lone[e->gone]], e->half);
}

void enc_lod_sum(const enc_lod_wedges *ws, const enc_lod_edge *e,
                 enc_quadric *total)
{
    *total = (enc_quadric){ .c = 0 };
    if (enc_lod_is_plain(ws, e->gone, e->kept)) {
        enc_lod_sum_plain(ws, e, total);
        return;
    }
    for (uint32_t w = 0; w < ws->count; w++) {
        double tail[ENC_JOINT_TAIL_MAX], center[ENC_JOINT_MAX];
        const double none[3] = { 0, 0, 0 };
        enc_joint_solver solver;
        enc_quadric q;
        if (ws->fate[ws->list[w]] != ws->list[w])
            continue;
        sum_group(ws, e, ws->list[w], &q, tail, center);
        enc_joint_reduce(&q, tail, ws->active, &solver);
        enc_quadric_add(total, &q, none);
    }
}

double enc_lod_weight(const enc_lod_wedges *ws)
{
    double sum = 0;

    for (uint32_t w = 0; w < ws->count; w++)
        sum += ws->quadric[ws->list[w]].weight;
    return sum;
}

/* How far from `kept` to `gone` the place is, 0 to 1. */
static double share_of_gone(const enc_lod_edge *e, const double x[3])
{
    const double square = dot(e->half, e->half);
    const double t = square > 0 ? 0.5 + 0.5 * dot(x, e->half) / square : 0.5;

    return t < 0 ? 0 : t > 1 ? 1 : t;
}

static void interpolate(const enc_lod_wedges *ws, const enc_lod_edge *e,
                        uint32_t fate, const double x[3], double *out)
{
    const double t = share_of_gone(e, x);
    double sum[2][ENC_JOINT_MAX] = { { 0 } };
    unsigned count[2] = { 0, 0 };

    for (uint32_t w = 0; w < ws->count; w++) {
        const bool from_gone = w >= ws->kept_count;
        if (ws->fate[ws->list[w]] != fate)
            continue;
        count[from_gone]++;
        for (unsigned i = 0; i < ws->passive; i++)
            sum[from_gone][i] += enc_lod_value(ws, ws->list[w])[ws->active + i];
    }
    const double share = count[0] == 0 ? 1 : count[1] == 0 ? 0 : t;
    for (unsigned i = 0; i < ws->passive; i++) {
        out[i] = 0;
        if (count[0] > 0)
            out[i] += (1 - share) * sum[0][i] / count[0];
        if (count[1] > 0)
            out[i] += share * sum[1][i] / count[1];
    }
}

void enc_lod_solve(enc_lod_wedges *ws, const enc_lod_edge *e, const double x[3])
{
    for (uint32_t w = 0; w < ws->count; w++) {
        const uint32_t fate = ws->list[w];
        double tail[ENC_JOINT_TAIL_MAX], center[ENC_JOINT_MAX];
        double *next = &ws->next[fate * enc_lod_stride(ws)];
        enc_joint_solver solver;
        enc_quadric q;
        if (ws->fate[fate] != fate)
            continue;
        if (ws->active) {
            sum_group(ws, e, fate, &q, tail, center);
            enc_joint_reduce(&q, tail, ws->active, &solver);
            enc_joint_attributes(&solver, ws->active, x, next);
            for (unsigned i = 0; i < ws->active; i++)
                next[i] += center[i];
        }
        if (ws->passive)
            interpolate(ws, e, fate, x, next + ws->active);
        enc_lod_channels_tidy(&ws->channels, next);
    }
}

/* ---- onto one of the ends ------------------------------------------------ */

/* Which wedge at the other end suits `wedge` best, of those that it belongs to
 * or of all; infinite if there is none. */
static double best_choice(enc_lod_wedges *ws, uint32_t wedge,
                          const double way[3], bool any)
{
    double best = INFINITY;

    for (uint32_t w = 0; w < ws->kept_count; w++) {
        const uint32_t to = ws->list[w];
        double away[ENC_JOINT_MAX];
        if (!any && ws->fate[to] != ws->fate[wedge])
            continue;
        for (unsigned i = 0; i < ws->active; i++)
            away[i] = enc_lod_value(ws, to)[i] - enc_lod_value(ws, wedge)[i];
        const double value =
            enc_joint_value(&ws->quadric[wedge], enc_lod_tail(ws, wedge),
                            ws->active, way, away);
        if (value < best) {
            best = value;
            ws->choice[wedge] = to;
        }
    }
    return best;
}

double enc_lod_onto_kept(enc_lod_wedges *ws, const enc_lod_edge *e,
                         bool break_seams)
{
    const double way[3] = { -2 * e->half[0], -2 * e->half[1], -2 * e->half[2] };
    double sum = 0;

    for (uint32_t w = 0; w < ws->kept_count; w++)
        sum += ws->quadric[ws->list[w]].c;
    for (uint32_t w = ws->kept_count; w < ws->count; w++) {
        double best = best_choice(ws, ws->list[w], way, false);
        if (break_seams && !(best < INFINITY))
            best = best_choice(ws, ws->list[w], way, true);
        sum += best;
    }
    return sum;
}

void enc_lod_choose(enc_lod_wedges *ws)
{
    for (uint32_t w = 0; w < ws->count; w++) {
        const uint32_t wedge = ws->list[w];
        ws->fate[wedge] = w < ws->kept_count ? wedge : ws->choice[wedge];
        memcpy(&ws->next[wedge * enc_lod_stride(ws)], enc_lod_value(ws, wedge),
               enc_lod_stride(ws) * sizeof *ws->next);
    }
}

/* ---- contraction --------------------------------------------------------- */

/* The sum of the quadrics of one fate, about its new place and values. */
static void carry_over(const enc_lod_wedges *ws, uint32_t gone, uint32_t kept,
                       const double place[3], uint32_t fate, enc_quadric *q,
                       double *tail)
{
    const double *to = &ws->next[fate * enc_lod_stride(ws)];

    *q = (enc_quadric){ .c = 0 };
    memset(tail, 0, enc_joint_tail(ws->active) * sizeof *tail);
    for (uint32_t w = 0; w < ws->count; w++) {
        const uint32_t wedge = ws->list[w];
        const uint32_t v = w < ws->kept_count ? kept : gone;
        double way[3], away[ENC_JOINT_MAX];
        if (ws->fate[wedge] != fate)
            continue;
        difference(ws->lod->position[v], place, way);
        for (unsigned i = 0; i < ws->active; i++)
            away[i] = enc_lod_value(ws, wedge)[i] - to[i];
        enc_joint_add(q, tail, &ws->quadric[wedge], enc_lod_tail(ws, wedge),
                      ws->active, way, away);
    }
}

void enc_lod_merge(enc_lod_wedges *ws, uint32_t gone, uint32_t kept,
                   const double place[3])
{
    const size_t stride = enc_lod_stride(ws);

    for (uint32_t w = 0; w < ws->count; w++) {
        const uint32_t wedge = ws->list[w];
        double tail[ENC_JOINT_TAIL_MAX];
        enc_quadric q;
        if (ws->fate[wedge] != wedge)
            continue;
        carry_over(ws, gone, kept, place, wedge, &q, tail);
        ws->quadric[wedge] = q;
        memcpy(enc_lod_tail(ws, wedge), tail,
               enc_joint_tail(ws->active) * sizeof *tail);
    }
    for (uint32_t w = 0; w < ws->count; w++)
        if (ws->fate[ws->list[w]] == ws->list[w])
            memcpy(&ws->value[ws->list[w] * stride],
                   &ws->next[ws->list[w] * stride], stride * sizeof *ws->next);
}

void enc_lod_settle(enc_lod_wedges *ws, uint32_t kept)
{
    enc_lod *lod = ws->lod;
    uint32_t c = lod->first_corner[kept];

    if (c == ENC_NONE)
        return;
    do
        lod->corner_wedge[c] = ws->fate[lod->corner_wedge[c]];
    while ((c = lod->corner_next[c]) != lod->first_corner[kept]);
}
