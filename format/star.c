/* SPDX-License-Identifier: MIT */
#include "format/star.h"

/* 2^32 / n, rounded up or 1 more. */
#define R(n)  ((int64_t)(((uint64_t)1 << 32) / (n)) + 1)
#define R4(n) R(n), R((n) + 1), R((n) + 2), R((n) + 3)

static const int64_t reciprocal[PMESH_MAX_RING + 1] = {
    0,      R4(1),  R4(5),  R4(9),  R4(13), R4(17), R4(21),
    R4(25), R4(29), R4(33), R4(37), R4(41), R4(45),
};

int64_t pmesh_share(int64_t value, uint32_t count)
{
    return value * reciprocal[count] >> 32;
}

unsigned pmesh_bit_length(uint64_t value)
{
#if defined(__GNUC__)
    return value ? 64 - (unsigned)__builtin_clzll(value) : 0;
#else
    unsigned n = 0;
    for (; value; value >>= 1)
        n++;
    return n;
#endif
}

/* Newton's method from above: falls until it would not any more. The first
 * guess is (c + value / c) / 2, never below the root, with c = 3/4 of the power
 * of two above the root; rounding is made up for by 2. */
uint32_t pmesh_isqrt(uint64_t value)
{
    const unsigned half = (pmesh_bit_length(value) + 1) / 2;
    uint64_t root = (((uint64_t)3 << half) >> 3) + (value >> half) * 2 / 3 + 2;
    while (value) {
        const uint64_t next = (root + value / root) / 2;
        if (next >= root)
            return (uint32_t)root;
        root = next;
    }
    return 0;
}

static int64_t size_of(int64_t value)
{
    return value < 0 ? -value : value;
}

int64_t pmesh_rough_length(const int64_t v[3])
{
    const int64_t x = size_of(v[0]), y = size_of(v[1]), z = size_of(v[2]);
    const int64_t xy = x > y ? x : y, largest = xy > z ? xy : z;
    return largest + (x + y + z - largest) * 3 / 8;
}

/* Points, mean and spokes. */
static void place_ring(pmesh_star *s, const pmesh_codec *c,
                       const pmesh_ring *ring, const int32_t base[3])
{
    uint32_t all = 1;
    int64_t sum[3] = { 0, 0, 0 };
    for (uint32_t i = 0; i < s->count; i++) {
        const int32_t *p = c->mesh.position[ring->vertex[i]];
        for (int k = 0; k < 3; k++) {
            const int32_t d = p[k] - base[k];
            s->point[i][k] = d;
            all |= (uint32_t)(d < 0 ? -d : d);
        }
    }
    s->shift = PMESH_STAR_BITS - (int)pmesh_bit_length(all);
    for (uint32_t i = 0; i < s->count; i++)
        for (int k = 0; k < 3; k++) {
            s->point[i][k] = pmesh_scale(s->point[i][k], s->shift);
            sum[k] += s->point[i][k];
        }
    for (int k = 0; k < 3; k++)
        s->mean[k] = pmesh_share(sum[k], s->count);
    int64_t total = 0;
    for (uint32_t i = 0; i < s->count; i++) {
        for (int k = 0; k < 3; k++)
            s->spoke[i][k] = s->point[i][k] - s->mean[k];
        s->length[i] = pmesh_rough_length(s->spoke[i]);
        total += s->length[i];
    }
    s->size = pmesh_share(total, s->count);
}

/* The faces' normals, and their sum scaled to length 2^14. */
static void find_normal(pmesh_star *s)
{
    int64_t sum[3] = { 0, 0, 0 };
    for (uint32_t i = 0; i < s->face_count; i++) {
        const int64_t *a = s->spoke[i];
        const int64_t *b = s->spoke[i + 1 < s->count ? i + 1 : 0];
        int64_t *f = s->face[i];
        f[0] = a[1] * b[2] - a[2] * b[1];
        f[1] = a[2] * b[0] - a[0] * b[2];
        f[2] = a[0] * b[1] - a[1] * b[0];
        for (int k = 0; k < 3; k++)
            sum[k] += f[k];
    }
    const uint64_t all = (uint64_t)size_of(sum[0]) | (uint64_t)size_of(sum[1]) |
                         (uint64_t)size_of(sum[2]);
    const unsigned bits = pmesh_bit_length(all);
    const unsigned drop = bits > 24 ? bits - 24 : 0;
    uint64_t square = 0;
    for (int k = 0; k < 3; k++) {
        sum[k] >>= drop; /* below 2^24 */
        square += (uint64_t)(sum[k] * sum[k]);
    }
    const uint32_t length = pmesh_isqrt(square);
    const int64_t per = length ? ((int64_t)1 << 38) / length : 0;
    for (int k = 0; k < 3; k++)
        s->normal[k] = sum[k] * per >> (38 - PMESH_NORMAL_BITS);
}

void pmesh_star_make(pmesh_star *s, const pmesh_codec *c,
                     const pmesh_ring *ring, const int32_t base[3])
{
    s->count = ring->count;
    s->face_count = ring->face_count;
    s->open = ring->open;
    place_ring(s, c, ring, base);
    find_normal(s);
    int64_t height = 0;
    for (uint32_t i = 0; i < s->count; i++) {
        int64_t h = 0;
        for (int k = 0; k < 3; k++)
            h += s->spoke[i][k] * s->normal[k];
        height += size_of(h) >> PMESH_NORMAL_BITS;
    }
    s->height = pmesh_share(height, s->count);
}

/* sum / weight, where |sum| <= weight x 2^18 and weight < 2^24. */
static void centre(const int64_t sum[3], int64_t weight, int64_t out[3])
{
    const int64_t per = weight ? ((int64_t)1 << 38) / weight : 0;
    for (int k = 0; k < 3; k++)
        out[k] = sum[k] * per >> 38;
}

void pmesh_star_centres(const pmesh_star *s, int64_t area[3], int64_t spokes[3])
{
    int64_t length[PMESH_MAX_RING], all = 0;
    int64_t by_area[3] = { 0, 0, 0 }, by_spoke[3] = { 0, 0, 0 };
    int64_t area_weight = 0, spoke_weight = 0;

    for (uint32_t i = 0; i < s->count; i++) {
        const int64_t w = s->length[i];
        for (int k = 0; k < 3; k++)
            by_spoke[k] += w * s->spoke[i][k];
        spoke_weight += w;
    }
    for (uint32_t i = 0; i < s->face_count; i++) {
        length[i] = pmesh_rough_length(s->face[i]);
        all |= length[i];
    }
    const unsigned bits = pmesh_bit_length((uint64_t)all);
    const unsigned drop = bits > 18 ? bits - 18 : 0;
    for (uint32_t i = 0; i < s->face_count; i++) {
        const uint32_t j = i + 1 < s->count ? i + 1 : 0;
        const int64_t w = length[i] >> drop;
        for (int k = 0; k < 3; k++)
            by_area[k] += w * (s->spoke[i][k] + s->spoke[j][k]);
        area_weight += w;
    }
    centre(by_area, 3 * area_weight, area);
    centre(by_spoke, spoke_weight, spokes);
}
