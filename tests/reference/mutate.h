/* SPDX-License-Identifier: MIT */
/*
 * mutate.h - damages files, and makes their checksums good again.
 */
#ifndef MUTATE_H
#define MUTATE_H

#include <stdbool.h>

#include "tests/unit/shapes.h"

/* Changes a copy of `file`; `mend`: chunks by their contents, with checksums
 * and content hash that fit; otherwise single bytes anywhere. */
shape_bytes mutate(const shape_bytes *file, bool mend, uint32_t seed);

#endif
