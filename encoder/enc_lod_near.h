/* SPDX-License-Identifier: MIT */
/*
 * enc_lod_near.h - pairs of vertices that are close but share no edge (Garland
 * and Heckbert 1997): contracted, they join what is apart.
 */
#ifndef ENC_LOD_NEAR_H
#define ENC_LOD_NEAR_H

#include "encoder/enc_lod.h"

/* A vertex gets so many pairs with later vertices at most, the closest ones,
 * of so many that are looked at: neither memory nor time explodes if the
 * threshold is too large. */
enum { ENC_LOD_NEAR_PAIRS = 8, ENC_LOD_NEAR_LOOKS = 2048 };

/*
 * Lists pairs closer than `threshold`, in order, two numbers each. Left out
 * are edges, and pairs that see each other through the inside of the surface,
 * as the two sides of a thin wall do.
 *
 * E_MEMORY leaves nothing to free; else release *pairs with *capacity.
 */
pmesh_status enc_lod_find_near(enc_lod *lod, double threshold,
                               uint32_t (**pairs)[2], size_t *capacity,
                               uint32_t *count);

#endif
