/* SPDX-License-Identifier: MIT */
#include "encoder/enc_lod_wedges.h"

#include <math.h>
#include <string.h>

#include "format/alloc.h"

pmesh_status enc_lod_wedges_create(enc_lod *lod,
                                   const enc_lod_channels *channels,
                                   double boundary, double seam, double *value,
                                   enc_lod_wedges *out)
{
    const pmesh_allocator *a = &lod->allocator;
    const size_t n = lod->vertex_count;

    *out = (enc_lod_wedges){ .lod = lod,
                             .channels = *channels,
                             .active = channels->active,
                             .passive = channels->passive,
                             .value = value,
                             .boundary = boundary,
                             .seam = seam };
    out->quadric = pmesh_alloc(a, n, sizeof *out->quadric);
    out->tail =
        pmesh_alloc(a, n * enc_joint_tail(out->active), sizeof *out->tail);
    out->list = pmesh_alloc(a, n, sizeof *out->list);
    out->fate = pmesh_alloc(a, n, sizeof *out->fate);
    out->choice = pmesh_alloc(a, n, sizeof *out->choice);
    out->stamp = pmesh_alloc_zero(a, n, sizeof *out->stamp);
    out->next = pmesh_alloc(a, n * enc_lod_stride(out), sizeof *out->next);
    if (!value || !out->quadric || !out->tail || !out->list || !out->fate ||
        !out->choice || !out->stamp || !out->next) {
        enc_lod_wedges_destroy(out);
        return PMESH_E_MEMORY;
    }
    return PMESH_OK;
}

void enc_lod_wedges_destroy(enc_lod_wedges *ws)
{
    if (!ws->lod)
        return;
    const pmesh_allocator *a = &ws->lod->allocator;
    const size_t n = ws->lod->vertex_count, values = n * enc_lod_stride(ws);

    pmesh_release(a, ws->value, values, sizeof *ws->value);
    pmesh_release(a, ws->quadric, n, sizeof *ws->quadric);
    pmesh_release(a, ws->tail, n * enc_joint_tail(ws->active),
                  sizeof *ws->tail);
    pmesh_release(a, ws->list, n, sizeof *ws->list);
    pmesh_release(a, ws->fate, n, sizeof *ws->fate);
    pmesh_release(a, ws->choice, n, sizeof *ws->choice);
    pmesh_release(a, ws->stamp, n, sizeof *ws->stamp);
    pmesh_release(a, ws->next, values, sizeof *ws->next);
    *ws = (enc_lod_wedges){ 0 };
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void difference(const double a[3], const double b[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = a[i] - b[i];
}

/* ---- quadrics of the current surface ------------------------------------- */

static void add_corner(const enc_lod_wedges *ws, uint32_t c)
{
    const enc_lod *lod = ws->lod;
    const uint32_t corner[3] = { c, enc_lod_after(c), enc_lod_before(c) };
    const double *at = lod->position[lod->corner_vertex[c]];
    const uint32_t wedge = lod->corner_wedge[c];
    double place[2][3], value[2][ENC_JOINT_MAX];

    if (ws->active == 0) {
        double n[3];
        enc_lod_normal(lod, c, at, n);
        const double square = dot(n, n);
        if (square > 0)
            enc_quadric_add_plane(&ws->quadric[wedge], n, 0.5 * sqrt(square));
        return;
    }
    for (int k = 0; k < 2; k++) {
        const uint32_t other = corner[k + 1];
        const double *v = enc_lod_value(ws, lod->corner_wedge[other]);
        difference(lod->position[lod->corner_vertex[other]], at, place[k]);
        for (unsigned i = 0; i < ws->active; i++)
            value[k][i] = v[i] - enc_lod_value(ws, wedge)[i];
    }
    enc_joint_add_face(&ws->quadric[wedge], enc_lod_tail(ws, wedge), ws->active,
                       place[0], value[0], place[1], value[1]);
}

/* The plane through the edge from corner c to `far` that stands upright on its
 * face, if the edge is a line to be held. */
static void hold_edge(const enc_lod_wedges *ws, uint32_t c, uint32_t far)
{
    const enc_lod *lod = ws->lod;
    const enc_lod_mark *m = &lod->mark[lod->corner_vertex[far]];
    const bool seam =
        m->breaks && (lod->lines[lod->corner_vertex[c]] & ENC_LOD_SEAM);
    const double weight = m->faces == 1           ? ws->boundary
                          : seam || m->faces != 2 ? ws->seam
                                                  : 0;
    const double *from = lod->position[lod->corner_vertex[c]];
    double along[3], n[3];

    if (!(weight > 0))
        return;
    difference(lod->position[lod->corner_vertex[far]], from, along);
    enc_lod_normal(lod, c, from, n);
    const double upright[3] = { along[1] * n[2] - along[2] * n[1],
                                along[2] * n[0] - along[0] * n[2],
                                along[0] * n[1] - along[1] * n[0] };
    if (dot(upright, upright) > 0)
        enc_quadric_add_plane(&ws->quadric[lod->corner_wedge[c]], upright,
                              weight * dot(along, along));
}

void enc_lod_renew(enc_lod_wedges *ws, uint32_t v)
{
    enc_lod_survey(ws->lod, v);
    enc_lod_sum_planes(ws, v);
}

void enc_lod_sum_planes(enc_lod_wedges *ws, uint32_t v)
{
    const enc_lod *lod = ws->lod;
    uint32_t c = lod->first_corner[v];

    do {
        const uint32_t wedge = lod->corner_wedge[c];
        ws->quadric[wedge] = (enc_quadric){ .c = 0 };
        if (ws->active)
            memset(enc_lod_tail(ws, wedge), 0,
                   enc_joint_tail(ws->active) * sizeof *ws->tail);
    } while ((c = lod->corner_next[c]) != lod->first_corner[v]);
    do {
        add_corner(ws, c);
        if (lod->lines[v]) {
            hold_edge(ws, c, enc_lod_after(c));
            hold_edge(ws, c, enc_lod_before(c));
        }
    } while ((c = lod->corner_next[c]) != lod->first_corner[v]);
}

/* ---- which wedges become one --------------------------------------------- */

static void see_wedge(enc_lod_wedges *ws, uint32_t wedge)
{
    if (ws->stamp[wedge] == ws->now)
        return;
    ws->stamp[wedge] = ws->now;
    ws->fate[wedge] = wedge;
    ws->list[ws->count++] = wedge;
}

static void see_all(enc_lod_wedges *ws, uint32_t v)
{
    const enc_lod *lod = ws->lod;
    uint32_t c = lod->first_corner[v];

    if (lod->lone[v] != ENC_NONE) {
        see_wedge(ws, lod->lone[v]);
        return;
    }
    do
        see_wedge(ws, lod->corner_wedge[c]);
    while ((c = lod->corner_next[c]) != lod->first_corner[v]);
}

static uint32_t find(const enc_lod_wedges *ws, uint32_t wedge)
{
    while (ws->fate[wedge] != wedge)
        wedge = ws->fate[wedge];
    return wedge;
}

void enc_lod_gather(enc_lod_wedges *ws, uint32_t gone, uint32_t kept)
{
    const enc_lod *lod = ws->lod;
    const uint32_t single = lod->lone[gone];
    uint32_t c = lod->first_corner[gone];

    if (++ws->now == 0) {
        memset(ws->stamp, 0, lod->vertex_count * sizeof *ws->stamp);
        ws->now = 1;
    }
    ws->count = 0;
    see_all(ws, kept);
    ws->kept_count = ws->count;
    see_all(ws, gone);
    if (single != ENC_NONE && lod->lone[kept] != ENC_NONE) {
        ws->fate[single] = lod->lone[kept];
        return;
    }
    do {
        const uint32_t d = enc_lod_corner_of(lod, c, kept);
        if (d == ENC_NONE)
            continue;
        const uint32_t a = find(ws, lod->corner_wedge[c]);
        const uint32_t b = find(ws, lod->corner_wedge[d]);
        ws->fate[a] = b;
    } while ((c = lod->corner_next[c]) != lod->first_corner[gone]);
    for (uint32_t i = 0; i < ws->count; i++)
        ws->fate[ws->list[i]] = find(ws, ws->list[i]);
}
