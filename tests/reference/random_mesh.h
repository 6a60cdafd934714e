/* SPDX-License-Identifier: MIT */
/*
 * random_mesh.h - small meshes of all kinds, with all that a file can carry,
 * and ways to bake them.
 */
#ifndef RANDOM_MESH_H
#define RANDOM_MESH_H

#include "tests/unit/shapes.h"

/* The bytes of a file that `seed` alone decides; PMESH_E_NO_FACES at times. */
pmesh_status random_file(uint32_t seed, shape_bytes *out);

#endif
