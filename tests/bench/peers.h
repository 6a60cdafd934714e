/* SPDX-License-Identifier: MIT */
/*
 * peers.h - simplification by meshoptimizer, CGAL and OpenMesh.
 *
 * All of them go down to `target` faces, without a bound on the error. *seconds
 * is CPU time of the process from a ready mesh, an index buffer for
 * meshoptimizer and a halfedge mesh for the others, to the last contraction.
 */
#ifndef PEERS_H
#define PEERS_H

#include <cstddef>
#include <vector>

#include <CGAL/Simple_cartesian.h>

using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;

struct Soup {
    std::vector<Point> points;
    std::vector<std::vector<std::size_t>> triangles;
};

std::vector<unsigned> simplify_meshopt(const std::vector<unsigned> &indices,
                                       const std::vector<float> &positions,
                                       std::size_t target, double *seconds);
Soup simplify_meshopt(const Soup &in, std::size_t target, double *seconds);
Soup simplify_lindstrom_turk(const Soup &in, std::size_t target,
                             double *seconds);
/* With the filter against faces that turn over. */
Soup simplify_garland_heckbert(const Soup &in, std::size_t target,
                               double *seconds);
/* Its quadrics, and nothing else. */
Soup simplify_openmesh(const Soup &in, std::size_t target, double *seconds);

#endif
