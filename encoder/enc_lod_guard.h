/* SPDX-License-Identifier: MIT */
/*
 * enc_lod_guard.h - which contractions of an enc_lod are harmless.
 */
#ifndef ENC_LOD_GUARD_H
#define ENC_LOD_GUARD_H

#include "encoder/enc_lod.h"

typedef enum enc_lod_strictness {
    ENC_LOD_SEAMS,    /* two lines of seams stay apart */
    ENC_LOD_TOPOLOGY, /* they may touch */
    ENC_LOD_LOOSE     /* anything goes, but not the last face */
} enc_lod_strictness;

/*
 * True if contracting u and v keeps the topology: they have no common
 * neighbours but the wings, the outer vertices of the faces between them; no
 * two faces come to lie over the same vertices; and the ends are not on two
 * different lines (the link condition of Dey, Edelsbrunner, Guha and Nekhayev,
 * Topology Preserving Edge Contraction, 1999).
 *
 * A pair without an edge joins what is apart. There only faces may not become
 * one.
 */
bool enc_lod_can_join(enc_lod *lod, uint32_t u, uint32_t v,
                      enc_lod_strictness strictness);

/* True if the two have an edge, that is, a face. */
bool enc_lod_share_face(const enc_lod *lod, uint32_t u, uint32_t v);

/* True if a face of u or v that survives would turn over or lose its area,
 * were both at `place`. Faces that have no area already are free. */
bool enc_lod_flips(const enc_lod *lod, uint32_t u, uint32_t v,
                   const double place[3]);

#endif
