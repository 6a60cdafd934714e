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

/* What neighbours and surface tell of a component, in 1/16. */
typedef struct pmesh_prospect {
    int64_t mean, spread;         /* of the neighbours; or a guess, and 0 */
    int64_t affine, close, shape; /* from the mean; or 0 */
} pmesh_prospect;

/* An attribute of a wedge as it is coded. */
typedef struct pmesh_outlook {
    uint32_t channel;
    unsigned group; /* of pmesh_value_models, by known neighbours */
    int32_t value[PMESH_MAX_COMPONENTS]; /* in when encoding, and out */
    pmesh_prospect of[PMESH_MAX_COMPONENTS];
} pmesh_outlook;

/* Codes the components: nothing but stream and models is needed or changed.
 * False if one is out of range. */
bool pmesh_outlook_code(pmesh_codec *c, pmesh_coder *coder, pmesh_outlook *o);

/* Encoding: what was spent since *before, which becomes now, counts as the
 * attribute's. */
void pmesh_values_spent(pmesh_codec *c, const pmesh_coder *coder,
                        uint32_t attribute, uint64_t *before);

/* Codes the values of the block's wedge w, all wedges before it being known. */
pmesh_status pmesh_wedge_values_code(pmesh_codec *c, pmesh_coder *coder,
                                     const pmesh_oracle *oracle, uint32_t w);

#endif
