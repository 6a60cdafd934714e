/* SPDX-License-Identifier: MIT */
/*
 * enc_parallel.h - the neighbours of a contraction that run parallel to it.
 *
 * On regular parts of a mesh, batches whose contractions all point the same
 * way leave a regular mesh behind, and regular meshes are cheap to code.
 */
#ifndef ENC_PARALLEL_H
#define ENC_PARALLEL_H

#include "encoder/enc_surface.h"

typedef struct enc_direction {
    uint32_t edge; /* a half-edge of the pair, or ENC_NONE */
    bool child_is_end;
} enc_direction;

/* The pairs to the right, to the left, ahead and behind. */
void enc_parallel_pairs(const enc_surface *s, const enc_pair *pair,
                        enc_direction out[4]);

#endif
