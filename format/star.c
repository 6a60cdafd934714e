/* SPDX-License-Identifier: MIT */
#include "format/star.h"

#include <string.h>

enum {
    SUM_BITS = 15,   /* of a sum of face normals, before it is normalised */
    WEIGHT_BITS = 11 /* of what centres are weighted by */
};

#define R(n)  ((int64_t)(((uint64_t)1 << 32) / (n)) + 1)
#define R4(n) R(n), R((n) + 1), R((n) + 2), R((n) + 3)

const int64_t pmesh_reciprocal[PMESH_MAX_RING + 1] = {
    0,      R4(1),  R4(5),  R4(9),  R4(13), R4(17), R4(21),
    R4(25), R4(29), R4(33), R4(37), R4(41), R4(45),
};

/* Newton's method from above: falls until it would not any more. The first
 * guess is (c + value / c) / 2, never below the root, with c = 3/4 of the power
 * of two above the root; rounding is made up for by 2. */
uint32_t pmesh_isqrt(uint32_t value)
{
    const unsigned half = (pmesh_bit_length(value) + 1) / 2;
    uint32_t root =
        (uint32_t)(((uint64_t)3 << half) >> 3) + (value >> half) * 2 / 3 + 2;
    while (value) {
        const uint32_t next = (root + value / root) / 2;
        if (next >= root)
            return root;
        root = next;
    }
    return 0;
}

static int32_t size_of(int32_t value)
{
    return value < 0 ? -value : value;
}

static uint32_t padded(uint32_t count)
{
    return (count + PMESH_STAR_LANES - 1) / PMESH_STAR_LANES * PMESH_STAR_LANES;
}

/* ---- points and spokes ----------------------------------------------------
 */

static void place_points(pmesh_star *s, const pmesh_codec *c,
                         const pmesh_ring *ring, const int32_t base[3])
{
    int32_t d[3][PMESH_STAR_ROOM];
    const uint32_t n = s->count, end = padded(n + 1);
    uint32_t all = 1;
    for (uint32_t i = 0; i < n; i++) {
        const int32_t *p = c->mesh.position[ring->vertex[i]];
        for (int k = 0; k < 3; k++) {
            d[k][i] = p[k] - base[k];
            all |= (uint32_t)size_of(d[k][i]);
        }
    }
    s->shift = PMESH_STAR_BITS - (int)pmesh_bit_length(all);
    const int up = s->shift > 0 ? s->shift : 0, down = up - s->shift;
    for (int k = 0; k < 3; k++) {
        int32_t sum = 0;
        for (uint32_t i = n; i < end; i++)
            d[k][i] = 0;
        for (uint32_t i = 0; i < end; i++) {
            const int32_t x = d[k][i] * (1 << up) >> down;
            s->point[k][i] = (int16_t)x;
            sum += x;
        }
        s->mean[k] = pmesh_share(sum, n);
    }
}

static int16_t larger(int16_t a, int16_t b)
{
    return a > b ? a : b;
}

static int16_t short_size(int16_t value)
{
    return larger(value, (int16_t)-value);
}

static void place_spokes(pmesh_star *s)
{
    const uint32_t n = s->count, end = padded(n + 1);
    int32_t total = 0;
    for (int k = 0; k < 3; k++) {
        const int16_t mean = (int16_t)s->mean[k];
        int16_t *spoke = s->spoke[k];
        for (uint32_t i = 0; i < end; i++)
            spoke[i] = (int16_t)(s->point[k][i] - mean);
        for (uint32_t i = n; i < PMESH_STAR_ROOM && i <= end; i++)
            spoke[i] = 0;
        spoke[n] = s->open ? 0 : spoke[0];
    }
    for (uint32_t i = 0; i < end; i++) {
        const int16_t x = short_size(s->spoke[0][i]);
        const int16_t y = short_size(s->spoke[1][i]);
        const int16_t z = short_size(s->spoke[2][i]);
        const int16_t most = larger(larger(x, y), z);
        const int16_t rest = (int16_t)(x + y + z - most);
        s->length[i] = (int16_t)(most + (rest >> 2) + (rest >> 3));
    }
    s->length[n] = 0;
    for (uint32_t i = 0; i < n; i++)
        total += s->length[i];
    s->size = pmesh_share(total, n);
}

/* ---- normal and height ----------------------------------------------------
 */

static void cross(uint32_t count, const int16_t *restrict a,
                  const int16_t *restrict b, int32_t *restrict out)
{
    for (uint32_t i = 0; i < count; i++)
        out[i] = a[i] * b[i + 1] - b[i] * a[i + 1];
}

/* The faces' normals, and their sum scaled to length 2^14. */
static void find_normal(pmesh_star *s)
{
    const uint32_t end = padded(s->count);
    int64_t sum[3];
    uint64_t all = 0;
    for (int k = 0; k < 3; k++) {
        int32_t *face = s->face[k];
        cross(end, s->spoke[(k + 1) % 3], s->spoke[(k + 2) % 3], face);
        sum[k] = 0;
        for (uint32_t i = 0; i < s->face_count; i++)
            sum[k] += face[i];
        all |= (uint64_t)(sum[k] < 0 ? -sum[k] : sum[k]);
    }
    const unsigned bits = pmesh_bit_length(all);
    const unsigned drop = bits > SUM_BITS ? bits - SUM_BITS : 0;
    uint32_t square = 0;
    for (int k = 0; k < 3; k++) {
        sum[k] >>= drop;
        square += (uint32_t)(sum[k] * sum[k]);
    }
    const uint32_t length = pmesh_isqrt(square);
    const int64_t per = length ? (UINT32_C(1) << 29) / length : 0;
    for (int k = 0; k < 3; k++)
        s->normal[k] = (int32_t)(sum[k] * per >> (29 - PMESH_NORMAL_BITS));
}

static void find_height(pmesh_star *s)
{
    const int16_t x = (int16_t)s->normal[0], y = (int16_t)s->normal[1];
    const int16_t z = (int16_t)s->normal[2];
    int32_t sum = 0;
    for (uint32_t i = 0; i < s->count; i++) {
        const int32_t h =
            s->spoke[0][i] * x + s->spoke[1][i] * y + s->spoke[2][i] * z;
        sum += size_of(h) >> PMESH_NORMAL_BITS;
    }
    s->height = pmesh_share(sum, s->count);
}

void pmesh_star_make(pmesh_star *s, const pmesh_codec *c,
                     const pmesh_ring *ring, const int32_t base[3])
{
    s->count = ring->count;
    s->face_count = ring->face_count;
    s->open = ring->open;
    place_points(s, c, ring, base);
    place_spokes(s);
    find_normal(s);
    find_height(s);
}

/* ---- centres --------------------------------------------------------------
 */

/* sum / (weight x times), |sum| <= weight x 2^14 < 2^31. */
static void centre(const int32_t sum[3], int32_t weight, int32_t times,
                   int32_t out[3])
{
    const int64_t per =
        weight ? (UINT32_C(1) << 31) / (uint32_t)(weight * times) : 0;
    for (int k = 0; k < 3; k++)
        out[k] = (int32_t)(sum[k] * per >> 31);
}

static void centre_of_spokes(const pmesh_star *s, int32_t out[3])
{
    int32_t sum[3] = { 0, 0, 0 }, weight = 0;
    for (uint32_t i = 0; i < s->count; i++) {
        const int32_t w = s->length[i] >> (PMESH_STAR_BITS + 2 - WEIGHT_BITS);
        for (int k = 0; k < 3; k++)
            sum[k] += w * s->spoke[k][i];
        weight += w;
    }
    centre(sum, weight, 1, out);
}

static void centre_of_area(const pmesh_star *s, int32_t out[3])
{
    int32_t length[PMESH_STAR_ROOM], sum[3] = { 0, 0, 0 }, weight = 0;
    uint32_t all = 0;
    for (uint32_t i = 0; i < s->face_count; i++) {
        const int64_t face[3] = { s->face[0][i], s->face[1][i], s->face[2][i] };
        length[i] = (int32_t)pmesh_rough_length(face);
        all |= (uint32_t)length[i];
    }
    const unsigned bits = pmesh_bit_length(all);
    const unsigned drop = bits > WEIGHT_BITS ? bits - WEIGHT_BITS : 0;
    for (uint32_t i = 0; i < s->face_count; i++) {
        const int32_t w = length[i] >> drop;
        for (int k = 0; k < 3; k++)
            sum[k] += w * (s->spoke[k][i] + s->spoke[k][i + 1]);
        weight += w;
    }
    centre(sum, weight, 3, out);
}

void pmesh_star_centres(const pmesh_star *s, int32_t area[3], int32_t spokes[3])
{
    centre_of_area(s, area);
    centre_of_spokes(s, spokes);
}
