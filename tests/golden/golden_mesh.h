/* SPDX-License-Identifier: MIT */
/*
 * golden_mesh.h - the meshes of the golden files, made up from nothing and to
 * the same bits on every machine.
 */
#ifndef GOLDEN_MESH_H
#define GOLDEN_MESH_H

#include "tests/unit/shapes.h"

/* Beyond the shapes of the unit tests. */
enum {
    GOLDEN_TRIANGLE = SHAPE_COUNT, /* one: a file without levels */
    GOLDEN_FAN,      /* a hub with a ring larger than a split may have, open */
    GOLDEN_SPINDLE,  /* two such hubs, closed */
    GOLDEN_CHANNELS, /* a torus with eight attributes: all kinds, all numbers of
                        components, values of all sizes */
    GOLDEN_PATCHES,  /* a terrain with seven materials in patches */
    GOLDEN_SPIKES,   /* a plain that no prediction misses, but for spikes */
    GOLDEN_LEAVES    /* pieces apart, with materials and three attributes:
                        triangles, some doubled back to back, tetrahedra, and
                        three triangles at an edge */
};

typedef struct golden_mesh {
    shape_mesh *shape;
    pmesh_attribute_input channels[PMESH_MAX_ATTRIBUTES];
    float *values[PMESH_MAX_ATTRIBUTES];
    pmesh_mesh_input input; /* what to bake */
} golden_mesh;

void golden_mesh_make(golden_mesh *mesh, int kind, uint32_t size);
void golden_mesh_free(golden_mesh *mesh);

#endif
