/* SPDX-License-Identifier: MIT */
/*
 * pmesh_inspect.h - what the simplifier sees in a mesh, for pictures.
 *
 *   double *cost = malloc(vertex_count * sizeof *cost);
 *   pmesh_inspect_costs(&mesh, cost);           // a heat map
 *
 * The quadric of a vertex is that of its faces, weighted by area, as Garland
 * and Heckbert have it (1997); thin along directions in which the surface is
 * curved, long where it is flat. Functions are pure: call them from any thread.
 */
#ifndef PMESH_INSPECT_H
#define PMESH_INSPECT_H

#include "encoder/pmesh_encode.h"

#ifdef __cplusplus
extern "C" {
#endif

/*
 * cost[v]: the least cost of contracting an edge of v to its best place, a
 * squared distance times area in model units; 0 where no face uses v. Only
 * positions and indices of the mesh count; vertices are one by index alone.
 *
 * Returns PMESH_OK, E_ARGUMENT (an array is missing), E_INDEX or E_MEMORY.
 */
PMESH_API pmesh_status pmesh_inspect_costs(const pmesh_mesh_input *mesh,
                                           const pmesh_allocator *allocator,
                                           double *cost);

/* All places that a quadric rates the same: an ellipsoid. */
typedef struct pmesh_ellipsoid {
    double center[3];  /* the vertex */
    double axis[3][3]; /* unit vectors at right angles, right-handed */
    double radius[3];  /* along them, ascending, at most the limit */
} pmesh_ellipsoid;

/*
 * The ellipsoid of each of the `count` vertices: where the root of the mean
 * squared distance from the planes of its faces is `distance`. No radius
 * exceeds `limit`. Without a face it is a sphere of that radius.
 *
 * Returns PMESH_OK, E_ARGUMENT (also for a distance or limit that is not
 * positive), E_INDEX or E_MEMORY.
 */
PMESH_API pmesh_status pmesh_inspect_ellipsoids(
    const pmesh_mesh_input *mesh, const pmesh_allocator *allocator,
    const uint32_t *vertices, size_t count, double distance, double limit,
    pmesh_ellipsoid *out);

#ifdef __cplusplus
}
#endif
#endif
