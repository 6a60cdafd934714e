/* SPDX-License-Identifier: MIT */
/*
 * author.h - files that no encoder makes: the reference decoder decides what
 * it would like to read.
 */
#ifndef AUTHOR_H
#define AUTHOR_H

#include "tests/unit/shapes.h"

/*
 * Levels that `seed` makes up, on the base mesh of random_file(seed): any cuts,
 * wedges, places, materials and positions; most break a rule sooner or later,
 * and end there. Returns false if there is no such base.
 */
bool author_random_file(uint32_t seed, shape_bytes *out);

/*
 * A base mesh with a vertex of `ring` neighbours all around, with or without a
 * texture coordinate, and one split, of that vertex: by the option of rank
 * `rank`. Returns the number of neighbours of the child; 0: there is none.
 */
uint32_t author_wide_split(uint32_t ring, bool textured, uint32_t rank,
                           shape_bytes *out);

#endif
