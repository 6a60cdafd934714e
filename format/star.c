/* SPDX-License-Identifier: MIT */
#include "format/star.h"

enum {
    SUM_BITS = 15,   /* of a sum of face normals, before it is normalised */
    WEIGHT_BITS = 11 /* of what centres are weighted by */
};

#define R(n)  ((int64_t)(((uint64_t)1 << 32) / (n)) + 1)
#define R4(n) R(n), R((n) + 1), R((n) + 2), R((n) + 3)

const int64_t pmesh_reciprocal[PMESH_MAX_RING + 2] = {
    0,      R4(1),  R4(5),  R4(9),  R4(13), R4(17), R4(21),
    R4(25), R4(29), R4(33), R4(37), R4(41), R4(45), R(49),
};

/* 16 sqrt(x + 1/2), rounded down, from x = 64 on. */
static const uint8_t root_of[] = {
    128, 129, 130, 131, 132, 133, 134, 135, 136, 137, 138, 139, 139, 140, 141,
    142, 143, 144, 145, 146, 147, 147, 148, 149, 150, 151, 152, 153, 153, 154,
    155, 156, 157, 157, 158, 159, 160, 161, 161, 162, 163, 164, 165, 165, 166,
    167, 168, 168, 169, 170, 171, 171, 172, 173, 174, 174, 175, 176, 177, 177,
    178, 179, 179, 180, 181, 182, 182, 183, 184, 184, 185, 186, 186, 187, 188,
    188, 189, 190, 190, 191, 192, 192, 193, 194, 194, 195, 196, 196, 197, 198,
    198, 199, 200, 200, 201, 202, 202, 203, 203, 204, 205, 205, 206, 207, 207,
    208, 208, 209, 210, 210, 211, 211, 212, 213, 213, 214, 214, 215, 216, 216,
    217, 217, 218, 219, 219, 220, 220, 221, 221, 222, 223, 223, 224, 224, 225,
    225, 226, 227, 227, 228, 228, 229, 229, 230, 231, 231, 232, 232, 233, 233,
    234, 234, 235, 235, 236, 237, 237, 238, 238, 239, 239, 240, 240, 241, 241,
    242, 242, 243, 243, 244, 245, 245, 246, 246, 247, 247, 248, 248, 249, 249,
    250, 250, 251, 251, 252, 252, 253, 253, 254, 254, 255, 255,
};

/* One step of Newton's method from a root of eight digits, which is 2^-7 off at
 * most: then 2^-15, that is 2, and never below the root. */
uint32_t pmesh_isqrt(uint32_t value)
{
    const unsigned half = (pmesh_bit_length(value) + 1) / 2;
    if (value < 4)
        return value > 0;
    const uint32_t top = half > 4 ? value >> (2 * half - 8)
                                  : value << (8 - 2 * half); /* 64 .. 255 */
    const uint32_t first = (uint32_t)root_of[top - 64] << 8 >> (16 - half);
    uint32_t root = (first + value / first) / 2;
    root -= (uint64_t)root * root > value;
    return root - ((uint64_t)root * root > value);
}

static uint32_t padded(uint32_t count)
{
    return (count + LANES - 1) / LANES * LANES;
}

/* ---- points and spokes ----------------------------------------------------
 */

/* The members relative to `base`, then zeros; returns the bitwise or of 1 and
 * all sizes. */
static uint32_t gather(const pmesh_codec *c, const pmesh_ring *ring,
                       const int32_t base[3], quads d[PMESH_STAR_ROOM])
{
    const int32_t(*position)[3] = (const int32_t(*)[3])c->mesh.position;
    const uint32_t n = ring->count, end = padded(n + 1);
    const quads from = quads_triple(base);
    quads all = quads_of(1);
    for (uint32_t i = end - LANES; i < end; i++) /* a number known beforehand */
        d[i] = quads_of(0);
    for (uint32_t i = 0; i < n; i++) {
        d[i] = quads_sub(quads_triple(position[ring->vertex[i]]), from);
        all = quads_or(all, quads_size(d[i]));
    }
    return quads_any(all);
}

static void place_points(pmesh_star *s, const pmesh_codec *c,
                         const pmesh_ring *ring, const int32_t base[3])
{
    quads d[PMESH_STAR_ROOM],
        sum[3] = { quads_of(0), quads_of(0), quads_of(0) };
    const uint32_t n = s->count, end = padded(n + 1);
    const uint32_t all = gather(c, ring, base, d);
    s->shift = PMESH_STAR_BITS - (int)pmesh_bit_length(all);
    const int up = s->shift > 0 ? s->shift : 0, down = up - s->shift;
    for (uint32_t i = 0; i < end; i += LANES) {
        lanes x[3];
        for (uint32_t j = 0; j < LANES; j++)
            s->row[i + j] = quads_right(quads_left(d[i + j], up), down);
        lanes_columns(s->row + i, x);
        for (int k = 0; k < 3; k++) {
            lanes_store(s->point[k] + i, x[k]);
            sum[k] = quads_add(sum[k], quads_dot(x[k], lanes_of(1)));
        }
    }
    for (int k = 0; k < 3; k++)
        s->mean[k] = pmesh_share(quads_total(sum[k]), n);
}

/* All bits set in a ring's lanes, no bit in those behind it. */
#define X8(x)  x, x, x, x, x, x, x, x
#define X24(x) X8(x), X8(x), X8(x)
static const int16_t mask[] = { X24(-1), X24(-1), X24(0), X24(0), X8(0) };

/* What counts of lanes i .. i + 7. */
static lanes ring_mask(const pmesh_star *s, uint32_t i)
{
    return lanes_load(mask + PMESH_MAX_RING - s->count + i);
}

/* As pmesh_rough_length(). */
static lanes rough_lengths(lanes x, lanes y, lanes z)
{
    x = lanes_size(x);
    y = lanes_size(y);
    z = lanes_size(z);
    const lanes most = lanes_max(lanes_max(x, y), z);
    const lanes rest = lanes_sub(lanes_add(lanes_add(x, y), z), most);
    return lanes_add(most,
                     lanes_add(lanes_right(rest, 2), lanes_right(rest, 3)));
}

static void place_spokes(pmesh_star *s)
{
    const uint32_t n = s->count, end = padded(n + 1);
    quads sum = quads_of(0);
    for (uint32_t i = 0; i < end; i += LANES) {
        const lanes member = ring_mask(s, i);
        lanes spoke[3];
        for (int k = 0; k < 3; k++) {
            spoke[k] = lanes_and(lanes_sub(lanes_load(s->point[k] + i),
                                           lanes_of((int16_t)s->mean[k])),
                                 member);
            lanes_store(s->spoke[k] + i, spoke[k]);
        }
        const lanes length = rough_lengths(spoke[0], spoke[1], spoke[2]);
        lanes_store(s->length + i, length);
        sum = quads_add(sum, quads_dot(length, lanes_of(1)));
    }
    for (int k = 0; k < 3; k++) {
        s->spoke[k][n] = s->open ? 0 : s->spoke[k][0];
        s->spoke[k][end] = 0;
    }
    s->size = pmesh_share(quads_total(sum), n);
}

/* ---- normal and height ----------------------------------------------------
 */

/* One coordinate of the normals of LANES faces, from the others of spokes;
 * returns their sum. Behind the last face they are 0. */
static inline int32_t cross(const int16_t *a, const int16_t *b, int32_t *face)
{
    const lanes x = lanes_load(a), next_x = lanes_load(a + 1);
    const lanes y = lanes_load(b), next_y = lanes_load(b + 1);
    const lanes back = lanes_sub(lanes_of(0), next_x);
    const quads first = quads_first(x, y, next_y, back);
    const quads last = quads_last(x, y, next_y, back);
    quads_store(face, first);
    quads_store(face + QUADS, last);
    return quads_total(quads_add(first, last)); /* 8 x 2^27 at most */
}

/* The faces' normals, and their sum scaled to length 2^14. */
static void find_normal(pmesh_star *s)
{
    const int16_t *x = s->spoke[0], *y = s->spoke[1], *z = s->spoke[2];
    int64_t sum[3] = { 0, 0, 0 };
    uint64_t all = 0;
    for (uint32_t i = 0; i < s->count; i += LANES) {
        sum[0] += cross(y + i, z + i, s->face[0] + i);
        sum[1] += cross(z + i, x + i, s->face[1] + i);
        sum[2] += cross(x + i, y + i, s->face[2] + i);
    }
    for (int k = 0; k < 3; k++)
        all |= (uint64_t)(sum[k] < 0 ? -sum[k] : sum[k]);
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

static quads heights(quads flat, quads up)
{
    return quads_right(quads_size(quads_add(flat, up)), PMESH_NORMAL_BITS);
}

static void find_height(pmesh_star *s)
{
    const lanes none = lanes_of(0), nx = lanes_of((int16_t)s->normal[0]);
    const lanes ny = lanes_of((int16_t)s->normal[1]);
    const lanes nz = lanes_of((int16_t)s->normal[2]);
    quads sum = quads_of(0);
    for (uint32_t i = 0; i < s->count; i += LANES) {
        const lanes member = ring_mask(s, i);
        const lanes x = lanes_and(lanes_load(s->spoke[0] + i), member);
        const lanes y = lanes_and(lanes_load(s->spoke[1] + i), member);
        const lanes z = lanes_and(lanes_load(s->spoke[2] + i), member);
        sum = quads_add(sum, heights(quads_first(x, y, nx, ny),
                                     quads_first(z, none, nz, none)));
        sum = quads_add(sum, heights(quads_last(x, y, nx, ny),
                                     quads_last(z, none, nz, none)));
    }
    s->height = pmesh_share(quads_total(sum), s->count);
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
                   int32_t out[QUADS])
{
    const int64_t per =
        weight ? (UINT32_C(1) << 31) / (uint32_t)(weight * times) : 0;
    for (int k = 0; k < 3; k++)
        out[k] = (int32_t)(sum[k] * per >> 31);
    out[3] = 0;
}

static void centre_of_spokes(const pmesh_star *s, int32_t out[QUADS])
{
    quads sum[3] = { quads_of(0), quads_of(0), quads_of(0) };
    quads weight = quads_of(0);
    int32_t total[3];
    for (uint32_t i = 0; i < s->count; i += LANES) {
        const lanes w = lanes_right(lanes_load(s->length + i),
                                    PMESH_STAR_BITS + 2 - WEIGHT_BITS);
        for (int k = 0; k < 3; k++)
            sum[k] =
                quads_add(sum[k], quads_dot(w, lanes_load(s->spoke[k] + i)));
        weight = quads_add(weight, quads_dot(w, lanes_of(1)));
    }
    for (int k = 0; k < 3; k++)
        total[k] = quads_total(sum[k]);
    centre(total, quads_total(weight), 1, out);
}

/* As pmesh_rough_length(); below 2^28. */
static quads face_lengths(const pmesh_star *s, uint32_t i)
{
    const quads x = quads_size(quads_load(s->face[0] + i));
    const quads y = quads_size(quads_load(s->face[1] + i));
    const quads z = quads_size(quads_load(s->face[2] + i));
    const quads most = quads_max(quads_max(x, y), z);
    const quads rest = quads_sub(quads_add(quads_add(x, y), z), most);
    return quads_add(most,
                     quads_add(quads_right(rest, 2), quads_right(rest, 3)));
}

/* Behind the last face all lengths are 0. */
static void centre_of_area(const pmesh_star *s, int32_t out[QUADS])
{
    int32_t length[PMESH_STAR_ROOM], total[3];
    quads sum[3] = { quads_of(0), quads_of(0), quads_of(0) };
    quads all = quads_of(0), weight = quads_of(0);
    const uint32_t end = padded(s->count);
    for (uint32_t i = 0; i < end; i += QUADS) {
        const quads l = face_lengths(s, i);
        quads_store(length + i, l);
        all = quads_or(all, l);
    }
    const unsigned bits = pmesh_bit_length(quads_any(all));
    const int drop = bits > WEIGHT_BITS ? (int)(bits - WEIGHT_BITS) : 0;
    for (uint32_t i = 0; i < end; i += LANES) {
        const lanes w =
            lanes_within(quads_right(quads_load(length + i), drop),
                         quads_right(quads_load(length + i + QUADS), drop));
        for (int k = 0; k < 3; k++) {
            const lanes both = lanes_add(lanes_load(s->spoke[k] + i),
                                         lanes_load(s->spoke[k] + i + 1));
            sum[k] = quads_add(sum[k], quads_dot(w, both));
        }
        weight = quads_add(weight, quads_dot(w, lanes_of(1)));
    }
    for (int k = 0; k < 3; k++)
        total[k] = quads_total(sum[k]);
    centre(total, quads_total(weight), 3, out);
}

void pmesh_star_centres(const pmesh_star *s, int32_t area[QUADS],
                        int32_t spokes[QUADS])
{
    centre_of_area(s, area);
    centre_of_spokes(s, spokes);
}
