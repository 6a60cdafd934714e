/* SPDX-License-Identifier: MIT */
/* random_cut.h - a cut of a ring, any of those that are legal. */
#ifndef RANDOM_CUT_H
#define RANDOM_CUT_H

#include "format/mesh.h"

pmesh_cut random_cut(uint32_t *seed, const pmesh_ring *ring);

#endif
