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

/* Codes `position` (in and out) and learns from the outcome; `which` is 0 for
 * a child and 1 for a moved parent. Decoding: false if it leaves the bounds. */
bool pmesh_residual_code(pmesh_codec *c, pmesh_coder *coder, int which,
                         pmesh_prediction *p, int32_t position[3]);

#endif
