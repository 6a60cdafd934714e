/* SPDX-License-Identifier: MIT */
/*
 * quantize.h - model floats <-> coded integers.
 *
 * Each function gives the same bits with every compiler and CPU that computes
 * IEEE doubles without contraction: only + - * / and comparisons, no libm.
 *
 * For every q that a quantise function returns,
 * quantise(dequantise(q)) == q: a decoded mesh can be coded again losslessly.
 */
#ifndef PMESH_QUANTIZE_H
#define PMESH_QUANTIZE_H

#include "format/pmesh.h"

/* Integers per value in the file: 2 for normals, else `components`. */
uint32_t pmesh_coded_components(const pmesh_attribute *attribute);

/* The nearest grid point on one axis (0, 1, 2), clamped to the grid. */
int32_t pmesh_grid_quantize(const pmesh_grid *grid, int axis, double value);
double pmesh_grid_dequantize(const pmesh_grid *grid, int axis, int32_t q);

/* The nearest finite float; a hostile grid leaves them (-FLT_MAX for NaN). */
float pmesh_narrow(double value);

/*
 * One value: `in` holds `components` floats, `out` gets the coded integers.
 *
 * Never fails: components that are not finite count as 0, values outside of
 * the range go to its nearest end, a normal without length becomes (0, 0, 1).
 */
void pmesh_attribute_quantize(const pmesh_attribute *attribute,
                              const float *in, uint16_t *out);

/*
 * The inverse. Safe for any integers, those that quantisation never yields
 * included: normals have unit length, all else is at most FLT_MAX in size if
 * `minimum` and `scale` are finite.
 */
void pmesh_attribute_dequantize(const pmesh_attribute *attribute,
                                const uint16_t *in, float *out);

#endif
