/* SPDX-License-Identifier: MIT */
/*
 * star.h - the ring of a vertex in coordinates of its own (SPEC 6.5): relative
 * to a base point and scaled by a power of two such that the largest lies in
 * 2^15 .. 2^16. All that follows fits 64 bits, for grids of any size.
 */
#ifndef PMESH_STAR_H
#define PMESH_STAR_H

#include "format/codec.h"

enum {
    PMESH_STAR_BITS = 16,
    PMESH_NORMAL_BITS = 14 /* a normal has length 2^14 */
};

typedef struct pmesh_star {
    uint32_t count, face_count;
    bool open;
    int shift;       /* star coordinate = grid coordinate x 2^shift */
    int64_t size;    /* mean distance of the members from their mean */
    int64_t height;  /* mean |height| over the plane of mean and normal */
    int64_t mean[3];
    int64_t normal[3]; /* zero if there is none */
    int64_t point[PMESH_MAX_RING][3];
    int64_t spoke[PMESH_MAX_RING][3]; /* from the mean */
    int64_t face[PMESH_MAX_RING][3];  /* spoke i x spoke i + 1 */
    int64_t length[PMESH_MAX_RING];   /* of spokes, about */
} pmesh_star;

/* x 2^shift, rounded down. */
static inline int64_t pmesh_scale(int64_t value, int shift)
{
    return shift >= 0 ? value * ((int64_t)1 << shift) : value >> -shift;
}

/* value / count, rounded down or 1 less; |value| < 2^30, count of a ring. */
int64_t pmesh_share(int64_t value, uint32_t count);

/* About the length of v: the largest coordinate and 3/8 of the others. */
int64_t pmesh_rough_length(const int64_t v[3]);

/* Number of binary digits; 0 has none. */
unsigned pmesh_bit_length(uint64_t value);

/* Integer square root, rounded down. */
uint32_t pmesh_isqrt(uint64_t value);

void pmesh_star_make(pmesh_star *s, const pmesh_codec *c,
                     const pmesh_ring *ring, const int32_t base[3]);

/* Centres from the mean: of the polygon by the area of its triangles, and of
 * the spokes by their length. */
void pmesh_star_centres(const pmesh_star *s, int64_t area[3],
                        int64_t spokes[3]);

#endif
