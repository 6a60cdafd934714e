/* SPDX-License-Identifier: MIT */
/*
 * surround.h - what is known around a new wedge (SPEC 6.6): the wedges next to
 * it whose values were coded before, and how much each of them counts.
 *
 * Values follow the surface: texture coordinates are close to an affine map of
 * the position, normals and others change about linearly. So the weights are
 * those of the affine map that fits the neighbours best (least squares, with a
 * slack that holds still what they do not determine), read at the new wedge's
 * position. They depend on positions alone and serve every component.
 */
#ifndef PMESH_SURROUND_H
#define PMESH_SURROUND_H

#include "format/codec.h"

#define PMESH_WEIGHT_ONE 65536

typedef struct pmesh_surround {
    uint32_t count;
    uint32_t wedge[PMESH_MAX_RING];
    int32_t affine[PMESH_MAX_RING]; /* in 1/PMESH_WEIGHT_ONE; their sum is 1 */
    int32_t close[PMESH_MAX_RING];  /* likewise; the closer the more */
} pmesh_surround;

void pmesh_surround_make(const pmesh_codec *c, uint32_t w, pmesh_surround *s);

/* Sum of the normals of the faces around the start of h, by their area; of at
 * most PMESH_MAX_RING faces of its fan. Below 2^56. */
void pmesh_fan_normal(const pmesh_mesh *m, uint32_t h, int64_t normal[3]);

#endif
