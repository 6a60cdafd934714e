/* SPDX-License-Identifier: MIT */
/* glyphs.h - small shapes that show quadrics. */
#ifndef GLYPHS_H
#define GLYPHS_H

#include <stdbool.h>

#include "tools/asset.h"

/*
 * Adds the ellipsoids of the quadrics of about `count` vertices, spread over
 * the mesh, as faces behind its own; `mesh` then is positions and faces only.
 * Each is about 1/60 of the diagonal where the surface is flat. False when
 * memory is out.
 */
bool glyphs_add(asset *mesh, uint32_t count);

#endif
