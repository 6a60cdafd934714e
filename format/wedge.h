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

/* Codes wedges and materials of what the split that made u changed: all
 * corners of u, and those of v and the wings in the new faces. */
pmesh_status pmesh_wedge_split_code(pmesh_codec *c, pmesh_coder *coder,
                                    const pmesh_oracle *oracle, uint32_t u,
                                    pmesh_cut cut);

/* Codes the values of the block's wedge w, all wedges before it being known. */
pmesh_status pmesh_wedge_values_code(pmesh_codec *c, pmesh_coder *coder,
                                     const pmesh_oracle *oracle, uint32_t w);

/* Codes a face's material, given two guesses. */
pmesh_status pmesh_material_code(pmesh_codec *c, pmesh_coder *coder,
                                 const pmesh_oracle *oracle, uint32_t face,
                                 uint32_t guess, uint32_t second);

#endif
