/* SPDX-License-Identifier: MIT */
/*
 * farthest.h - the largest distance of any point of one surface from another:
 * the one-sided Hausdorff distance.
 */
#ifndef FARTHEST_H
#define FARTHEST_H

#include <stdbool.h>
#include <stddef.h>

#include "tools/surface.h"

/*
 * Raises *max2, a squared distance that is known to occur (0 will do), to the
 * largest one found. The result is at most 0.5 % below the true maximum (or
 * 1e-9 of the extent), unless `budget` searches did not suffice to tell; then
 * it still is a distance that occurs. False when memory is out.
 */
bool farthest_from(const surface *from, const surface *to, size_t budget,
                   double *max2);

#endif
