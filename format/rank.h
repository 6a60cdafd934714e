/* SPDX-License-Identifier: MIT */
/*
 * rank.h - renumbers a block by importance (SPEC 6.7): the split that changes
 * the surface most comes first, so that a part of a block is the best part.
 */
#ifndef PMESH_RANK_H
#define PMESH_RANK_H

#include "format/codec.h"

/* Numbers of scratch that pmesh_block_rank() needs. */
uint64_t pmesh_rank_scratch(const pmesh_codec_sizes *sizes);

/* Sorts the block's splits by c->importance, largest first, earlier ones first
 * among equals, and renumbers vertices, faces and wedges accordingly; fills
 * child_order, face_order, wedge_order, made_faces and wedge_end. */
void pmesh_block_rank(pmesh_codec *c);

#endif
