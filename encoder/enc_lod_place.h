/* SPDX-License-Identifier: MIT */
/*
 * enc_lod_place.h - where the vertex goes that an edge becomes.
 */
#ifndef ENC_LOD_PLACE_H
#define ENC_LOD_PLACE_H

#include <stdbool.h>

#include "encoder/enc_quadric.h"
#include "encoder/pmesh_simplify.h"

/*
 * q: both ends' quadrics about the middle of the edge; half: from there to one
 * end. keep: the places that keep the volume, or NULL. Each rule falls back on
 * the next: optimal, line, the best of the middle and the ends. The value there
 * is never above that of these three, save with PMESH_PLACE_MIDPOINT and
 * PMESH_PLACE_VOLUME, whose place is the best that keeps the volume.
 *
 * Returns false if there is no such place.
 */
bool enc_lod_place(pmesh_place rule, const enc_quadric *q, const double half[3],
                   const enc_plane *keep, double x[3]);

#endif
