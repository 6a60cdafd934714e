/* SPDX-License-Identifier: MIT */
/*
 * octant.h - codes of unit vectors (SPEC 7) in integers.
 *
 * A code is continuous over the upper half and a little beyond; below, it is
 * torn along the planes x = 0 and y = 0. Where most is below, one looks from
 * the other side: at the codes of the vectors with z negated.
 */
#ifndef PMESH_OCTANT_H
#define PMESH_OCTANT_H

#include <stdbool.h>
#include <stdint.h>

/* The code of the mirrored vector; `centre` is the code of 0. Twice gives the
 * same again where the code is one that quantisation gives. */
void pmesh_octant_mirror(int32_t centre, int32_t code[2]);

/* |x| + |y| - the centre: above 0 below the equator. */
int32_t pmesh_octant_below(int32_t centre, const uint16_t code[2]);

/* The code, times `fraction`, of a vector below 2^62; `mirrored` of that with z
 * negated; that of the pole if it is 0. */
void pmesh_octant_fold(const int64_t v[3], int32_t centre, int32_t fraction,
                       bool mirrored, int64_t code[2]);

/* The vector of a code, not normalised; never 0. */
void pmesh_octant_unfold(const uint16_t code[2], int32_t centre, int32_t v[3]);

#endif
