/* SPDX-License-Identifier: MIT */
#include "encoder/enc_lod_near.h"

#include <math.h>
#include <string.h>

#include "encoder/enc_import.h"
#include "format/alloc.h"

/* Cells as wide as the threshold, hashed into chains of vertices. */
typedef struct near_grid {
    enc_lod *lod;
    double threshold, square;
    size_t size;     /* a power of two */
    uint32_t *first; /* per slot */
    uint32_t *next;  /* per vertex: ascending */
} near_grid;

typedef struct near_best {
    uint32_t vertex[ENC_LOD_NEAR_PAIRS];
    double square[ENC_LOD_NEAR_PAIRS];
    unsigned count, looks;
} near_best;

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Any threshold above 0 may be asked for: cells far out are one. */
static void cell_of(const near_grid *g, const double p[3], int64_t cell[3])
{
    const double most = 0x1p62;
    for (int i = 0; i < 3; i++) {
        const double at = floor(p[i] / g->threshold);
        cell[i] = (int64_t)(!(at > -most) ? -most : at < most ? at : most);
    }
}

static size_t slot_of(const near_grid *g, const int64_t cell[3])
{
    uint64_t hash = 0;

    for (int i = 0; i < 3; i++)
        hash = enc_mix(hash, (uint64_t)cell[i]);
    return (size_t)hash & (g->size - 1);
}

static void fill(near_grid *g)
{
    memset(g->first, 0xff, g->size * sizeof *g->first);
    for (uint32_t v = g->lod->vertex_count; v-- > 0;) {
        int64_t cell[3];
        if (g->lod->first_corner[v] == ENC_NONE)
            continue;
        cell_of(g, g->lod->position[v], cell);
        const size_t slot = slot_of(g, cell);
        g->next[v] = g->first[slot];
        g->first[slot] = v;
        enc_lod_sum_normals(g->lod, v);
    }
}

/* True unless the two look in opposite directions and away from each other, as
 * the sides of a wall do. */
static bool no_wall(const near_grid *g, uint32_t u, uint32_t v)
{
    const double *p = g->lod->position[u], *q = g->lod->position[v];
    const double way[3] = { q[0] - p[0], q[1] - p[1], q[2] - p[2] };

    return dot(g->lod->normal[u], g->lod->normal[v]) >= 0 ||
           (dot(g->lod->normal[u], way) >= 0 &&
            dot(g->lod->normal[v], way) <= 0);
}

/* Keeps the closest, in ascending order. */
static void keep(near_best *best, uint32_t v, double square)
{
    unsigned at = best->count;

    if (at == ENC_LOD_NEAR_PAIRS && square >= best->square[at - 1])
        return;
    if (at < ENC_LOD_NEAR_PAIRS)
        best->count++;
    else
        at--;
    for (; at > 0 && best->square[at - 1] > square; at--) {
        best->square[at] = best->square[at - 1];
        best->vertex[at] = best->vertex[at - 1];
    }
    best->square[at] = square;
    best->vertex[at] = v;
}

/* Vertices come in ascending order, and each looks at later ones only: those
 * before it leave the chain, which without that would be walked n times. */
static void look_into(const near_grid *g, uint32_t u, const int64_t cell[3],
                      near_best *best)
{
    const double *p = g->lod->position[u];
    uint32_t *first = &g->first[slot_of(g, cell)];

    while (*first != ENC_NONE && *first <= u)
        *first = g->next[*first];
    for (uint32_t v = *first; v != ENC_NONE; v = g->next[v]) {
        const double *q = g->lod->position[v];
        int64_t own[3];
        double square = 0;
        if (best->looks++ >= ENC_LOD_NEAR_LOOKS)
            return;
        cell_of(g, q, own);
        for (int i = 0; i < 3; i++)
            square += (p[i] - q[i]) * (p[i] - q[i]);
        if (memcmp(own, cell, sizeof own) == 0 && square < g->square &&
            !enc_lod_marked(g->lod, v) && no_wall(g, u, v))
            keep(best, v, square);
    }
}

static void look_around(const near_grid *g, uint32_t u, near_best *best)
{
    int64_t center[3], cell[3];

    *best = (near_best){ .count = 0 };
    enc_lod_survey(g->lod, u);
    cell_of(g, g->lod->position[u], center);
    for (int k = 0; k < 27; k++) {
        cell[0] = center[0] + k % 3 - 1;
        cell[1] = center[1] + k / 3 % 3 - 1;
        cell[2] = center[2] + k / 9 - 1;
        look_into(g, u, cell, best);
    }
}

static uint32_t list(near_grid *g, uint32_t (*pairs)[2])
{
    uint32_t count = 0;

    fill(g);
    for (uint32_t u = 0; u < g->lod->vertex_count; u++) {
        near_best best;
        if (g->lod->first_corner[u] == ENC_NONE)
            continue;
        look_around(g, u, &best);
        for (unsigned i = 0; i < best.count; i++) {
            pairs[count][0] = u;
            pairs[count++][1] = best.vertex[i];
        }
    }
    return count;
}

pmesh_status enc_lod_find_near(enc_lod *lod, double threshold,
                               uint32_t (**pairs)[2], size_t *capacity,
                               uint32_t *count)
{
    const pmesh_allocator *a = &lod->allocator;
    const size_t n = lod->vertex_count;
    near_grid g = { .lod = lod,
                    .threshold = threshold,
                    .square = threshold * threshold,
                    .size = enc_table_size(n) };

    *capacity = (size_t)lod->vertices * ENC_LOD_NEAR_PAIRS;
    *pairs = pmesh_alloc(a, *capacity, sizeof **pairs);
    g.first = pmesh_alloc(a, g.size, sizeof *g.first);
    g.next = pmesh_alloc(a, n, sizeof *g.next);
    const bool good = *pairs && g.first && g.next;
    if (good)
        *count = list(&g, *pairs);
    else
        pmesh_release(a, *pairs, *capacity, sizeof **pairs);
    pmesh_release(a, g.first, g.size, sizeof *g.first);
    pmesh_release(a, g.next, n, sizeof *g.next);
    return good ? PMESH_OK : PMESH_E_MEMORY;
}
