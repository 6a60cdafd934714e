/* SPDX-License-Identifier: MIT */
/*
 * author.h - files that no encoder makes: the reference decoder decides what
 * it would like to read.
 */
#ifndef AUTHOR_H
#define AUTHOR_H

#include "tests/unit/shapes.h"

/*
 * A base mesh with a vertex of `ring` neighbours all around, a texture
 * coordinate, and one split, of that vertex: by the option of rank `rank`.
 * Returns the number of neighbours of the child; 0: there is no such option.
 */
uint32_t author_wide_split(uint32_t ring, uint32_t rank, shape_bytes *out);

#endif
