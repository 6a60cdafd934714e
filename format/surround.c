/* SPDX-License-Identifier: MIT */
#include "format/surround.h"

#include "format/star.h"

enum {
    SPACE_BITS = 12,   /* of distances */
    TRACE_BITS = 18,   /* of the moments' trace */
    SLACK = 4,         /* what is not determined: 1/16 of the trace */
    LEAST_LENGTH = 64, /* closer than this counts no more */
    LENGTH_ONE = 1 << 20,
    MOST_WEIGHT = 4 * PMESH_WEIGHT_ONE
};

static void add_neighbour(pmesh_surround *s, uint32_t w, uint32_t other)
{
    if (other >= w || s->count == PMESH_MAX_RING) /* PMESH_NONE included */
        return;
    if (s->count && (other == s->wedge[s->count - 1] || other == s->wedge[0]))
        return;
    s->wedge[s->count++] = other;
}

/* From the corner that it was made for turning left, as long as it goes on. */
static void list_neighbours(const pmesh_codec *c, uint32_t w,
                            pmesh_surround *s)
{
    const pmesh_mesh *m = &c->mesh;
    const uint32_t start = c->wedge_corner[w];
    uint32_t h = start;
    s->count = 0;
    do {
        add_neighbour(s, w, m->wedge[pmesh_next(h)]);
        add_neighbour(s, w, m->wedge[pmesh_prev(h)]);
        h = pmesh_turn_left(m, h);
    } while (h != PMESH_NONE && h != start && m->wedge[h] == w &&
             s->count < PMESH_MAX_RING);
}

/* ---- weights -------------------------------------------------------------
 */

/* Positions from the wedge's own, scaled to below 2^12; their mean. */
typedef struct cloud {
    int64_t at[PMESH_MAX_RING][3];
    int64_t mean[3];
} cloud;

static void gather(const pmesh_mesh *m, uint32_t w, const pmesh_surround *s,
                   cloud *d)
{
    const int32_t *from = m->position[m->wedge_vertex[w]];
    uint64_t all = 1;
    for (uint32_t i = 0; i < s->count; i++) {
        const int32_t *to = m->position[m->wedge_vertex[s->wedge[i]]];
        for (int k = 0; k < 3; k++) {
            const int64_t x = (int64_t)to[k] - from[k];
            d->at[i][k] = x;
            all |= (uint64_t)(x < 0 ? -x : x);
        }
    }
    const int shift = SPACE_BITS - (int)pmesh_bit_length(all);
    for (int k = 0; k < 3; k++) {
        int64_t sum = 0;
        for (uint32_t i = 0; i < s->count; i++) {
            d->at[i][k] = pmesh_scale(d->at[i][k], shift);
            sum += d->at[i][k];
        }
        d->mean[k] = sum / s->count;
    }
}

static void weigh_by_distance(const cloud *d, pmesh_surround *s)
{
    int64_t share[PMESH_MAX_RING], sum = 0;
    for (uint32_t i = 0; i < s->count; i++) {
        share[i] = LENGTH_ONE / (pmesh_rough_length(d->at[i]) + LEAST_LENGTH);
        sum += share[i];
    }
    for (uint32_t i = 0; i < s->count; i++)
        s->close[i] = (int32_t)(share[i] * PMESH_WEIGHT_ONE / sum);
}

/* Second moments around the mean (below 2^34), scaled to a trace below 2^18,
 * with the slack. The result is the scale. */
static int find_moments(const cloud *d, uint32_t count, int64_t moment[3][3])
{
    for (int k = 0; k < 3; k++)
        for (int j = 0; j <= k; j++) {
            int64_t sum = 0;
            for (uint32_t i = 0; i < count; i++)
                sum += (d->at[i][k] - d->mean[k]) * (d->at[i][j] - d->mean[j]);
            moment[k][j] = sum;
        }
    const int64_t trace = moment[0][0] + moment[1][1] + moment[2][2];
    const int scale = TRACE_BITS - (int)pmesh_bit_length((uint64_t)trace | 1);
    int64_t slack = 0;
    for (int k = 0; k < 3; k++) {
        for (int j = 0; j <= k; j++)
            moment[k][j] = moment[j][k] = pmesh_scale(moment[k][j], scale);
        slack += moment[k][k];
    }
    slack = (slack >> SLACK) + 1;
    for (int k = 0; k < 3; k++)
        moment[k][k] += slack;
    return scale;
}

/* Solves moment x slope = mean, in 1/65536, by cofactors (below 2^38); the
 * determinant is above 2^36 or, of a single point, 1. */
static void solve(int64_t moment[3][3], const int64_t mean[3],
                  int64_t slope[3])
{
    int64_t cofactor[3][3], determinant = 0;
    for (int k = 0; k < 3; k++) {
        const int64_t *a = moment[(k + 1) % 3], *b = moment[(k + 2) % 3];
        for (int j = 0; j < 3; j++)
            cofactor[k][j] = a[(j + 1) % 3] * b[(j + 2) % 3] -
                             a[(j + 2) % 3] * b[(j + 1) % 3];
    }
    for (int k = 0; k < 3; k++)
        determinant += moment[0][k] * cofactor[0][k];
    for (int k = 0; k < 3; k++) {
        int64_t sum = 0;
        for (int j = 0; j < 3; j++)
            sum += cofactor[k][j] * mean[j];
        slope[k] = sum * 256 / ((determinant >> 8) + 1);
    }
}

/* The map's value at the wedge itself: the mean less the slope times the way
 * from there to the mean; so each neighbour counts 1 / n less its share. */
static void weigh_affinely(const cloud *d, pmesh_surround *s)
{
    int64_t moment[3][3], slope[3];
    const int scale = find_moments(d, s->count, moment);
    solve(moment, d->mean, slope);
    for (uint32_t i = 0; i < s->count; i++) {
        int64_t by = 0;
        for (int k = 0; k < 3; k++)
            by += slope[k] * (d->at[i][k] - d->mean[k]);
        by = pmesh_scale(by, scale);
        by = by < -MOST_WEIGHT ? -MOST_WEIGHT
                               : by > MOST_WEIGHT ? MOST_WEIGHT : by;
        s->affine[i] = (int32_t)(PMESH_WEIGHT_ONE / (int64_t)s->count - by);
    }
}

void pmesh_surround_make(const pmesh_codec *c, uint32_t w, pmesh_surround *s)
{
    cloud d;
    list_neighbours(c, w, s);
    if (s->count == 0)
        return;
    gather(&c->mesh, w, s, &d);
    weigh_by_distance(&d, s);
    weigh_affinely(&d, s);
}

/* ---- normals -------------------------------------------------------------
 */

static void add_face(const pmesh_mesh *m, uint32_t h, int64_t normal[3])
{
    const int32_t *at = m->position[m->vertex[h]];
    const int32_t *p = m->position[m->vertex[pmesh_next(h)]];
    const int32_t *q = m->position[m->vertex[pmesh_prev(h)]];
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        normal[k] += (int64_t)(p[i] - at[i]) * (q[j] - at[j]) -
                     (int64_t)(p[j] - at[j]) * (q[i] - at[i]);
    }
}

void pmesh_fan_normal(const pmesh_mesh *m, uint32_t h, int64_t normal[3])
{
    const uint32_t start = h;
    uint32_t count = 0;
    normal[0] = normal[1] = normal[2] = 0;
    do {
        add_face(m, h, normal);
        h = pmesh_turn_left(m, h);
        count++;
    } while (h != PMESH_NONE && h != start && count < PMESH_MAX_RING);
    if (h != PMESH_NONE)
        return;
    for (h = m->twin[start]; h != PMESH_NONE && count < PMESH_MAX_RING;
         h = m->twin[h], count++) {
        h = pmesh_next(h);
        add_face(m, h, normal);
    }
}
