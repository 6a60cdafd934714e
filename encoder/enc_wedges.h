/* SPDX-License-Identifier: MIT */
/*
 * enc_wedges.h - where the attributes of a vertex go when it is contracted.
 *
 * A face that dies has a corner at the child and one at the parent: the wedge
 * of the first becomes that of the second. If this names one parent wedge for
 * each of the child's, the contraction is clean: no attribute jumps. Else some
 * wedges have to take the most similar one.
 */
#ifndef ENC_WEDGES_H
#define ENC_WEDGES_H

#include "encoder/enc_join.h"

/* Always true without attributes. */
bool enc_wedges_clean(const enc_surface *s, const enc_pair *pair);

/* Fills in wedge_parent[] for all wedges at the child's corners. */
void enc_wedges_map(const enc_surface *s, const enc_pair *pair,
                    uint32_t *wedge_parent);

/* The same for a pair with this link. */
void enc_wedges_map_link(const enc_surface *s, const enc_pair *pair,
                         const enc_link *link, uint32_t *wedge_parent);

/* Fills in what is missing: wedges whose last face died before their vertex.
 * vertex_parent: per vertex, ENC_NONE in the base mesh. */
pmesh_status enc_wedges_finish(const enc_mesh *mesh,
                               const uint32_t *vertex_parent,
                               uint32_t *wedge_parent);

#endif
