/* SPDX-License-Identifier: MIT */
/*
 * star.h - the ring of a vertex in coordinates of its own (SPEC 6.5): relative
 * to a base point and scaled by a power of two such that the largest lies in
 * 2^11 .. 2^12. All that follows fits 32 bits, for grids of any size.
 */
#ifndef PMESH_STAR_H
#define PMESH_STAR_H

#include "format/codec.h"
#include "format/lanes.h"

enum {
    PMESH_STAR_BITS = 12,
    PMESH_NORMAL_BITS = 14,              /* a normal has length 2^14 */
    PMESH_STAR_ROOM = PMESH_MAX_RING + 9 /* loops run over eights of them */
};

/* By coordinate, then member. Behind the last member come zeros, but the first
 * spoke of a closed ring comes once more. */
typedef struct pmesh_star {
    uint32_t count, face_count;
    bool open;
    int shift;      /* star coordinate = grid coordinate x 2^shift */
    int32_t size;   /* mean distance of the members from their mean */
    int32_t height; /* mean |height| over the plane of mean and normal */
    int32_t mean[3];
    int32_t normal[3]; /* zero if there is none */
    int16_t point[3][PMESH_STAR_ROOM];
    quads row[PMESH_STAR_ROOM]; /* the points once more, each by itself */
    int16_t spoke[3][PMESH_STAR_ROOM]; /* from the mean; below 2^13 */
    int16_t length[PMESH_STAR_ROOM];   /* of spokes, about */
    int32_t face[3][PMESH_STAR_ROOM];  /* spoke i x spoke i + 1 */
} pmesh_star;

/* x 2^shift, rounded down. */
static inline int64_t pmesh_scale(int64_t value, int shift)
{
    return shift >= 0 ? value * ((int64_t)1 << shift) : value >> -shift;
}

/* 2^32 / n, rounded up or 1 more. */
extern const int64_t pmesh_reciprocal[PMESH_MAX_RING + 2];

/* value / count, rounded down or 1 less; |value| < 2^30, count of a ring or 1
 * more. */
static inline int32_t pmesh_share(int32_t value, uint32_t count)
{
    return (int32_t)(value * pmesh_reciprocal[count] >> 32);
}

/* About the length of v: the largest coordinate and 3/8 of the others. */
static inline int64_t pmesh_rough_length(const int64_t v[3])
{
    const int64_t x = v[0] < 0 ? -v[0] : v[0], y = v[1] < 0 ? -v[1] : v[1];
    const int64_t z = v[2] < 0 ? -v[2] : v[2], xy = x > y ? x : y;
    const int64_t largest = xy > z ? xy : z, rest = x + y + z - largest;
    return largest + (rest >> 2) + (rest >> 3);
}

/* Number of binary digits; 0 has none. */
static inline unsigned pmesh_bit_length(uint64_t value)
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

/* Integer square root, rounded down. */
uint32_t pmesh_isqrt(uint32_t value);

void pmesh_star_make(pmesh_star *s, const pmesh_codec *c,
                     const pmesh_ring *ring, const int32_t base[3]);

/* Centres from the mean: of the polygon by the area of its triangles, and of
 * the spokes by their length; and a 0. */
void pmesh_star_centres(const pmesh_star *s, int32_t area[QUADS],
                        int32_t spokes[QUADS]);

#endif
