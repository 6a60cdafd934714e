/* SPDX-License-Identifier: MIT */
/*
 * residual.h - codes a position against its prediction (SPEC 6.5).
 *
 * Residuals are large along the surface and small across it. Instead of a
 * rotation, which would round, the three grid coordinates are coded one after
 * the other, each with the mean and deviation that a Gaussian of those two
 * sizes has given the coordinates before it; the axis closest to the normal
 * comes last and inherits the small size.
 */
#ifndef PMESH_RESIDUAL_H
#define PMESH_RESIDUAL_H

#include "format/predict.h"

/* Where a number is expected: around `mean`, in 1/16, with the deviation
 * 2^(scale / 2) / 16; and the models that know what happens there. */
typedef struct pmesh_expectation {
    pmesh_residual_bits *any, *here;
    pmesh_bit *low;
    pmesh_number *escape;
    unsigned scale;
    int64_t mean;
} pmesh_expectation;

/* Codes a whole number below 2^32 in size. */
int64_t pmesh_code_near(pmesh_coder *coder, const pmesh_expectation *at,
                        int64_t value);

/* The scale of a deviation below 2^32, in 1/16; of `count` scales. */
unsigned pmesh_deviation_scale(uint64_t deviation, unsigned count);

/* How far off, in 1/16, a number was: octaves from half the deviation on, below
 * PMESH_FAR. */
unsigned pmesh_how_far(int64_t off, unsigned scale);

/* Codes `position` (in and out) by what its site tells and learns from the
 * outcome: nothing but stream and models is needed or changed. Decoding: false if
 * it leaves the bounds. */
bool pmesh_residual_code(pmesh_coder *coder, pmesh_place_models *m,
                         const int32_t bounds[3], pmesh_prediction *p,
                         int32_t position[3]);

#endif
