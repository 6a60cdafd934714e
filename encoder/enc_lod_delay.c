/* SPDX-License-Identifier: MIT */
#include "encoder/enc_lod_delay.h"

#include <math.h>
#include <string.h>

#include "format/alloc.h"

/* A squared distance so many times the usual one makes dearer, by its excess
 * to the power of 3/2. Less keeps fewer outliers in and costs 1 % more root
 * mean square; twice that hardly catches any. Places of the input are farther
 * off as a rule. */
#define MAX_EXCESS         3.0
#define MAX_EXCESS_AT_ENDS 4.0

/* Contractions. Among the last hundred what is usual grows fast: a mean over
 * 256 lags behind, and costs 3 % there. */
#define USUAL_OVER  32.0
#define LEAST_USUAL 1e-10 /* squared: nobody sees less */

/* Each blemish makes so many times dearer; but where the whole star is smaller
 * than so many usual distances, squared, nobody sees it. Tiny handles and
 * tunnels, which fold as they shrink, would else keep their faces while what is
 * larger loses its own. */
#define BLEMISH          16.0
#define MIN_REACH        49.0
#define MIN_TURN_COSINE  0.7 /* of one contraction: 46 degrees */
#define MIN_DRIFT_COSINE 0.0 /* of all so far */
#define MIN_SHAPE                                                              \
    0.05 /* height by longest side; what is worse already                      \
            may stay as it is */
#define MAX_VALENCE 12
#define FOLD_COSINE (-0.866) /* of neighbours: 150 degrees */

/* Stars of more faces are not searched for folds. */
#define MAX_STAR 32

pmesh_status enc_lod_delay_create(const enc_lod *lod, bool at_ends,
                                  enc_lod_delay *out)
{
    const pmesh_allocator *a = &lod->allocator;

    *out = (enc_lod_delay){ .lod = lod,
                            .most = at_ends ? MAX_EXCESS_AT_ENDS : MAX_EXCESS };
    out->normal = pmesh_alloc_zero(a, lod->face_count, sizeof *out->normal);
    out->left = pmesh_alloc_zero(a, lod->vertex_count, sizeof *out->left);
    if (!out->normal || !out->left) {
        enc_lod_delay_destroy(out);
        return PMESH_E_MEMORY;
    }
    for (uint32_t f = 0; f < lod->face_count; f++) {
        const uint32_t v = lod->corner_vertex[3 * f];
        double n[3];
        if (v == ENC_NONE)
            continue;
        enc_lod_normal(lod, 3 * f, lod->position[v], n);
        const double size = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        for (int i = 0; i < 3 && size > 0; i++)
            out->normal[f][i] = (float)(n[i] / size);
    }
    return PMESH_OK;
}

void enc_lod_delay_destroy(enc_lod_delay *d)
{
    if (!d->lod)
        return;
    pmesh_release(&d->lod->allocator, d->normal, d->lod->face_count,
                  sizeof *d->normal);
    pmesh_release(&d->lod->allocator, d->left, d->lod->vertex_count,
                  sizeof *d->left);
    *d = (enc_lod_delay){ 0 };
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

/* ---- the star of what u and v become ------------------------------------- */

typedef struct enc_lod_spoke {
    uint32_t after, before; /* the outer vertices of a face */
    double n[3];            /* its unit normal */
} enc_lod_spoke;

typedef struct enc_lod_star {
    const double *place;
    uint32_t faces;
    enc_lod_spoke spoke[MAX_STAR]; /* as many of the faces as fit */
    double peak; /* squared distance of the place to the planes of before */
    double reach; /* squared: from the place to the farthest outer vertex */
    double turn, drift; /* least cosines: against before, against the input */
    double shape, old_shape; /* worst heights by longest sides */
} enc_lod_star;

static double longest_square(const double a[3], const double b[3],
                             const double c[3])
{
    double side[3][3], most = 0;

    difference(a, b, side[0]);
    difference(b, c, side[1]);
    difference(c, a, side[2]);
    for (int i = 0; i < 3; i++)
        most = fmax(most, dot(side[i], side[i]));
    return most;
}

static void add_face(const enc_lod_delay *d, enc_lod_star *s, uint32_t c,
                     const double from[3])
{
    const enc_lod *lod = d->lod;
    const uint32_t a = lod->corner_vertex[enc_lod_after(c)];
    const uint32_t b = lod->corner_vertex[enc_lod_before(c)];
    const double *p = lod->position[a], *q = lod->position[b];
    const double first[3] = { (double)d->normal[c / 3][0],
                              (double)d->normal[c / 3][1],
                              (double)d->normal[c / 3][2] };
    double n[3], old[3], way[2][3];

    difference(p, s->place, way[0]);
    difference(q, s->place, way[1]);
    s->reach = fmax(s->reach,
                    fmax(dot(way[0], way[0]), dot(way[1], way[1])));
    enc_lod_normal(lod, c, s->place, n);
    enc_lod_normal(lod, c, from, old);
    const double size = sqrt(dot(n, n)), old_size = sqrt(dot(old, old));
    if (old_size > 0)
        s->old_shape =
            fmin(s->old_shape, old_size / longest_square(from, p, q));
    if (size > 0) {
        for (int i = 0; i < 3; i++)
            n[i] /= size;
        if (old_size > 0)
            s->turn = fmin(s->turn, dot(n, old) / old_size);
        if (dot(first, first) > 0)
            s->drift = fmin(s->drift, dot(n, first));
        s->shape = fmin(s->shape, size / longest_square(s->place, p, q));
        if (s->faces < MAX_STAR)
            s->spoke[s->faces] = (enc_lod_spoke){ a, b, { n[0], n[1], n[2] } };
        s->faces++;
    }
}

static void add_faces(const enc_lod_delay *d, enc_lod_star *s, uint32_t v,
                      uint32_t other)
{
    const enc_lod *lod = d->lod;
    const double *from = lod->position[v];
    uint32_t c = lod->first_corner[v];
    double way[3];

    difference(s->place, from, way);
    do {
        double n[3];
        enc_lod_normal(lod, c, from, n);
        const double square = dot(n, n), rise = dot(n, way);
        if (square > 0)
            s->peak = fmax(s->peak, rise * rise / square);
        if (enc_lod_corner_of(lod, c, other) == ENC_NONE)
            add_face(d, s, c, from);
    } while ((c = lod->corner_next[c]) != lod->first_corner[v]);
}

static bool folds(const enc_lod_star *s)
{
    const uint32_t count = s->faces < MAX_STAR ? s->faces : MAX_STAR;

    for (uint32_t i = 0; i < count; i++)
        for (uint32_t k = 0; k < count; k++)
            if (s->spoke[i].after == s->spoke[k].before &&
                dot(s->spoke[i].n, s->spoke[k].n) < FOLD_COSINE)
                return true;
    return false;
}

static double blemishes(const enc_lod_star *s)
{
    double factor = 1;

    if (s->turn < MIN_TURN_COSINE)
        factor *= BLEMISH;
    if (s->drift < MIN_DRIFT_COSINE)
        factor *= BLEMISH;
    if (s->shape < MIN_SHAPE && s->shape < s->old_shape)
        factor *= BLEMISH;
    if (s->faces > MAX_VALENCE)
        factor *= BLEMISH;
    if (folds(s))
        factor *= BLEMISH;
    return factor;
}

/* ---- places left behind -------------------------------------------------- */

/* Squared distance of p to the segment from a to b. */
static double to_segment(const double p[3], const double a[3],
                         const double b[3])
{
    double along[3], away[3];

    difference(b, a, along);
    difference(p, a, away);
    const double square = dot(along, along);
    double t = square > 0 ? dot(along, away) / square : 0;
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    for (int i = 0; i < 3; i++)
        away[i] -= t * along[i];
    return dot(away, away);
}

static double to_triangle(const double p[3], const double a[3],
                          const double b[3], const double c[3])
{
    double u[3], v[3], away[3];

    difference(b, a, u);
    difference(c, a, v);
    difference(p, a, away);
    const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v);
    const double pu = dot(u, away), pv = dot(v, away);
    const double det = uu * vv - uv * uv;
    const double s = vv * pu - uv * pv, t = uu * pv - uv * pu;
    if (det > 0 && s >= 0 && t >= 0 && s + t <= det) {
        for (int i = 0; i < 3; i++)
            away[i] -= (s * u[i] + t * v[i]) / det;
        return dot(away, away);
    }
    return fmin(to_segment(p, a, b),
                fmin(to_segment(p, b, c), to_segment(p, c, a)));
}

/* Or something that is `enough` or less: nobody wants to know, then. */
static double to_star(const enc_lod *lod, uint32_t v, uint32_t other,
                      const double place[3], const double p[3], double enough,
                      double least)
{
    uint32_t c = lod->first_corner[v];

    do {
        const uint32_t a = lod->corner_vertex[enc_lod_after(c)];
        const uint32_t b = lod->corner_vertex[enc_lod_before(c)];
        if (a != other && b != other)
            least = fmin(least, to_triangle(p, place, lod->position[a],
                                            lod->position[b]));
        if (least <= enough)
            return least;
    } while ((c = lod->corner_next[c]) != lod->first_corner[v]);
    return least;
}

/* Of the places that the two remember and their own, those that will be
 * farthest from the star are remembered next. */
static void leave(enc_lod_delay *d, uint32_t u, uint32_t v,
                  const double place[3])
{
    const enc_lod *lod = d->lod;
    const uint32_t end[2] = { u, v };
    double far[ENC_LOD_LEFT];

    d->next.count = 0;
    for (int side = 0; side < 2; side++) {
        const enc_lod_left *l = &d->left[end[side]];
        for (uint32_t i = 0; i <= l->count; i++) {
            const double *p =
                i < l->count ? l->place[i] : lod->position[end[side]];
            uint32_t at = d->next.count;
            const double enough = at == ENC_LOD_LEFT ? far[at - 1] : 0;
            double distance = to_star(lod, u, v, place, p, enough, INFINITY);
            distance = to_star(lod, v, u, place, p, enough, distance);
            if (!(distance > 0 && distance < INFINITY))
                continue;
            while (at > 0 && far[at - 1] < distance) {
                if (at < ENC_LOD_LEFT) {
                    far[at] = far[at - 1];
                    memcpy(d->next.place[at], d->next.place[at - 1],
                           sizeof d->next.place[at]);
                }
                at--;
            }
            if (at == ENC_LOD_LEFT)
                continue;
            far[at] = distance;
            memcpy(d->next.place[at], p, sizeof d->next.place[at]);
            d->next.count += d->next.count < ENC_LOD_LEFT;
        }
    }
    if (d->next.count > 0)
        d->far = fmax(d->far, far[0]);
}

/* ---- both ---------------------------------------------------------------- */

double enc_lod_delay_factor(enc_lod_delay *d, uint32_t u, uint32_t v,
                            const double place[3])
{
    enc_lod_star star = {
        .place = place, .turn = 1, .drift = 1, .shape = 1, .old_shape = 1
    };

    add_faces(d, &star, u, v);
    add_faces(d, &star, v, u);
    d->least_cosine = star.drift;
    d->far = star.peak;
    leave(d, u, v, place);
    double factor = star.reach < MIN_REACH * d->usual ? 1 : blemishes(&star);
    const double limit = d->most * fmax(d->usual, LEAST_USUAL);
    if (d->usual > 0 && d->far > limit)
        factor *= d->far / limit * sqrt(d->far / limit);
    return factor;
}

void enc_lod_delay_move(enc_lod_delay *d, uint32_t kept)
{
    d->left[kept] = d->next;
    d->usual += (d->far - d->usual) / USUAL_OVER;
}
