/* SPDX-License-Identifier: MIT */
/*
 * inflate.h - how far a coarse mesh should swell (SPEC 7.1).
 *
 * A mesh whose vertices lie on a curved surface encloses too little: its faces
 * cut the curves short. Moving each vertex outward by a share of its height
 * over its neighbours' mean makes up for that, as Taubin's second step does for
 * the shrinking of the first (1995). The share is one number a level, such that
 * the volume is right; so it costs one byte and is 0 where there are edges and
 * planes instead of curves.
 */
#ifndef PMESH_INFLATE_H
#define PMESH_INFLATE_H

#include <stdbool.h>
#include <stdint.h>

enum { PMESH_INFLATE_ONE = 256 }; /* a level's number is in 1/256 */

/* What the faces around a vertex add up to; starts as zeros. */
typedef struct pmesh_bulge {
    double ring[3];   /* sum of the neighbours that follow it in a face */
    double normal[3]; /* twice the faces' area, outward */
    uint32_t count;   /* faces */
    uint32_t open;    /* sum of following less preceding neighbours' numbers,
                         modulo 2^32: 0 if its fans are closed */
} pmesh_bulge;

/* Adds a face over vertices v, its corners in order; 3 coordinates each. */
void pmesh_bulge_add(pmesh_bulge *bulge, const uint32_t v[3],
                     const int32_t *positions);

/* Height of the vertex at p over its neighbours' mean, along the normal: as a
 * vector, in grid steps. False at a boundary, and where there is no normal. */
bool pmesh_bulge_height(const pmesh_bulge *bulge, const int32_t p[3],
                        double out[3]);

#endif
