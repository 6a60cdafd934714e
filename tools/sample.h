/* SPDX-License-Identifier: MIT */
/* sample.h - a detailed mesh to try the program with. */
#ifndef SAMPLE_H
#define SAMPLE_H

#include <stdbool.h>
#include <stdint.h>

#include "tools/asset.h"

#define SAMPLE_MIN_FACES 4000u
#define SAMPLE_MAX_FACES 20000000u

/*
 * Builds the shell of tools/shell.h with about `faces` triangles (within 2 %
 * from 10,000 on), normals and texture coordinates with a seam: closed,
 * manifold, no face degenerate, coordinates multiples of 1e-6. False when
 * memory is out.
 */
bool sample_build(uint32_t faces, asset *out);

#endif
