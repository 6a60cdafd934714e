/* SPDX-License-Identifier: MIT */
/*
 * wedge.h - codes which corners share attributes, the attributes themselves,
 * and materials (SPEC 6.6). Without attributes and materials these calls code
 * nothing.
 */
#ifndef PMESH_WEDGE_H
#define PMESH_WEDGE_H

#include "format/codec.h"

/* Codes the wedges of all corners of x, counter-clockwise, the first one new:
 * for a vertex of the base mesh. */
pmesh_status pmesh_wedge_ring_code(pmesh_codec *c, pmesh_coder *coder,
                                   const pmesh_oracle *oracle, uint32_t x);

/* The new faces of a split, by their first half-edges. */
typedef struct pmesh_fresh {
    uint32_t count;                     /* fans that were cut, and of each */
    uint32_t face[PMESH_MAX_PARTS][2];  /* face a, face b, or PMESH_NONE; */
    uint32_t start[PMESH_MAX_PARTS];    /* where u's part of it starts */
    uint32_t lone, lone_end;            /* of a joined mesh: the lone faces */
} pmesh_fresh;

/* Codes wedges and materials of what the split that made u changed: all
 * corners of u, and those of v and the wings in the new faces. */
pmesh_status pmesh_wedge_split_code(pmesh_codec *c, pmesh_coder *coder,
                                    const pmesh_oracle *oracle, uint32_t u,
                                    const pmesh_fresh *fresh);

/* Codes a face's material, given two guesses. */
pmesh_status pmesh_material_code(pmesh_codec *c, pmesh_coder *coder,
                                 const pmesh_oracle *oracle, uint32_t face,
                                 uint32_t guess, uint32_t second);

#endif
