/* SPDX-License-Identifier: MIT */
/*
 * enc_lod_hull.h - places that keep the surface outside of what it was.
 *
 * On the outer side of the planes of all the faces around a pair, the new
 * vertex spans tetrahedra with them that only add to the volume: each mesh
 * contains the one before (Sander, Gu, Gortler, Hoppe and Snyder, Silhouette
 * Clipping, 2000).
 */
#ifndef ENC_LOD_HULL_H
#define ENC_LOD_HULL_H

#include "encoder/enc_lod_wedges.h"

/*
 * The least of q among these places, as seen from the middle of the edge.
 * Returns false if there is none, or if there are more faces around than
 * ENC_LOD_HULL_FACES, whose triples are tried one by one.
 */
#define ENC_LOD_HULL_FACES 20
bool enc_lod_hull_place(const enc_lod *lod, const enc_lod_edge *e,
                        const enc_quadric *q, double x[3]);

#endif
