/* SPDX-License-Identifier: MIT */
#include "encoder/enc_lod_hull.h"

#include <math.h>
#include <string.h>

/* So far inside a plane is rounding; of the extent of the model. */
#define SLACK 1e-13

/* Squared sines below are those of parallel planes. */
#define PARALLEL 1e-10

/* The least of what is allowed so far. */
typedef struct enc_lod_hull {
    const enc_quadric *quadric;
    enc_plane plane[ENC_LOD_HULL_FACES]; /* unit normals: n'x >= offset */
    uint32_t count;
    double least, reach; /* the latter squared */
    double x[3];
    bool found;
} enc_lod_hull;

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* The faces of both once are those of v and, of u, those without v. */
static bool add_planes(const enc_lod *lod, enc_lod_hull *h, uint32_t v,
                       uint32_t without, const double seen[3])
{
    uint32_t c = lod->first_corner[v];

    do {
        enc_plane *p = &h->plane[h->count];
        if (without != ENC_NONE &&
            enc_lod_corner_of(lod, c, without) != ENC_NONE)
            continue;
        if (h->count == ENC_LOD_HULL_FACES)
            return false;
        enc_lod_normal(lod, c, lod->position[v], p->n);
        const double size = sqrt(dot(p->n, p->n));
        if (!(size > 0))
            continue;
        for (int i = 0; i < 3; i++)
            p->n[i] /= size;
        p->offset = dot(p->n, seen);
        h->count++;
    } while ((c = lod->corner_next[c]) != lod->first_corner[v]);
    return true;
}

static void try_place(enc_lod_hull *h, const double x[3])
{
    if (!(dot(x, x) <= h->reach))
        return;
    for (uint32_t i = 0; i < h->count; i++)
        if (dot(h->plane[i].n, x) < h->plane[i].offset - SLACK)
            return;
    const double value = enc_quadric_value(h->quadric, x);
    if (h->found && value >= h->least)
        return;
    h->found = true;
    h->least = value;
    memcpy(h->x, x, sizeof h->x);
}

/* The least on the line where two planes meet, and its ends at the others. */
static void try_line(enc_lod_hull *h, uint32_t i, uint32_t k)
{
    const enc_plane *p = &h->plane[i], *q = &h->plane[k];
    double along[3], a[3], b[3], from[3], slope[3], there[3], x[3];

    cross(p->n, q->n, along);
    const double square = dot(along, along);
    if (!(square > PARALLEL))
        return;
    cross(q->n, along, a);
    cross(along, p->n, b);
    for (int j = 0; j < 3; j++)
        from[j] = (p->offset * a[j] + q->offset * b[j]) / square;
    enc_quadric_slope(h->quadric, from, slope);
    for (int j = 0; j < 3; j++)
        x[j] = from[j] + along[j];
    enc_quadric_slope(h->quadric, x, there);
    const double rise = dot(along, there) - dot(along, slope);
    if (rise > 0) {
        for (int j = 0; j < 3; j++)
            x[j] = from[j] - dot(along, slope) / rise * along[j];
        try_place(h, x);
    }
    for (uint32_t m = k + 1; m < h->count; m++) {
        const double fall = dot(h->plane[m].n, along);
        if (!(fall * fall > PARALLEL * square))
            continue;
        const double t = (h->plane[m].offset - dot(h->plane[m].n, from)) / fall;
        for (int j = 0; j < 3; j++)
            x[j] = from[j] + t * along[j];
        try_place(h, x);
    }
}

/* A quadric's least within half-spaces lies on at most three of their planes.
 * Its values are convex: no place is missed. */
bool enc_lod_hull_place(const enc_lod *lod, const enc_lod_edge *e,
                        const enc_quadric *q, double x[3])
{
    const double at_gone[3] = { e->half[0], e->half[1], e->half[2] };
    const double at_kept[3] = { -e->half[0], -e->half[1], -e->half[2] };
    enc_lod_hull h = { .quadric = q, .reach = 64 * dot(e->half, e->half) };
    double y[3];

    if (!add_planes(lod, &h, e->kept, ENC_NONE, at_kept) ||
        !add_planes(lod, &h, e->gone, e->kept, at_gone))
        return false;
    if (enc_quadric_minimum(q, NULL, y))
        try_place(&h, y);
    for (uint32_t i = 0; i < h.count; i++)
        if (enc_quadric_minimum(q, &h.plane[i], y))
            try_place(&h, y);
    /* The ends and the middle are allowed where all is flat or hollow. */
    try_place(&h, at_gone);
    try_place(&h, at_kept);
    for (uint32_t i = 0; i < h.count; i++)
        for (uint32_t k = i + 1; k < h.count; k++)
            try_line(&h, i, k);
    memcpy(x, h.x, sizeof h.x);
    return h.found;
}
