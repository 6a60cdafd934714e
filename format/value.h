/* SPDX-License-Identifier: MIT */
/*
 * value.h - codes the attributes of wedges (SPEC 6.6).
 *
 * An attribute is that of another wedge of the vertex (across a seam of some
 * other attribute), or each of its components is coded against a prediction:
 * the mean of the known neighbours and a few corrections, the affine map of
 * surround.h before all, whose weights follow what they were good for so far
 * (fit.h). How far off it will be is learnt from how the neighbours differ.
 */
#ifndef PMESH_VALUE_H
#define PMESH_VALUE_H

#include "format/codec.h"

/* Codes the values of the block's wedge w, all wedges before it being known. */
pmesh_status pmesh_wedge_values_code(pmesh_codec *c, pmesh_coder *coder,
                                     const pmesh_oracle *oracle, uint32_t w);

#endif
