/* SPDX-License-Identifier: MIT */
#include "tests/bench/peers.h"

#include <ctime>

#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_filter.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_plane_policies.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_cost.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_placement.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>
#include <meshoptimizer.h>

namespace {

namespace sms = CGAL::Surface_mesh_simplification;
namespace pmp = CGAL::Polygon_mesh_processing;
using Surface = CGAL::Surface_mesh<Point>;

double cpu_seconds()
{
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/* CGAL's own predicates count edges; everyone here is to meet a face count. */
struct Enough_faces {
    std::size_t target;
    template <typename Cost, typename Profile>
    bool operator()(const Cost &, const Profile &profile, std::size_t,
                    std::size_t) const
    {
        return profile.surface_mesh().number_of_faces() <= target;
    }
};

Surface surface_of(Soup soup)
{
    Surface surface;
    pmp::repair_polygon_soup(soup.points, soup.triangles);
    pmp::orient_polygon_soup(soup.points, soup.triangles);
    pmp::polygon_soup_to_polygon_mesh(soup.points, soup.triangles, surface);
    return surface;
}

Soup soup_of(Surface &surface)
{
    surface.collect_garbage();
    Soup soup;
    for (auto v : surface.vertices())
        soup.points.push_back(surface.point(v));
    for (auto f : surface.faces()) {
        std::vector<std::size_t> triangle;
        for (auto v : surface.vertices_around_face(surface.halfedge(f)))
            triangle.push_back(v);
        soup.triangles.push_back(triangle);
    }
    return soup;
}

} // namespace

std::vector<unsigned> simplify_meshopt(const std::vector<unsigned> &indices,
                                       const std::vector<float> &positions,
                                       std::size_t target, double *seconds)
{
    std::vector<unsigned> result(indices.size());
    const float no_limit = 1e9f;
    const double start = cpu_seconds();
    result.resize(meshopt_simplify(
        result.data(), indices.data(), indices.size(), positions.data(),
        positions.size() / 3, 3 * sizeof(float), 3 * target, no_limit, 0,
        nullptr));
    *seconds = cpu_seconds() - start;
    return result;
}

Soup simplify_meshopt(const Soup &in, std::size_t target, double *seconds)
{
    std::vector<unsigned> indices;
    std::vector<float> positions;
    for (const auto &t : in.triangles)
        for (std::size_t v : t)
            indices.push_back(static_cast<unsigned>(v));
    for (const Point &p : in.points)
        for (int k = 0; k < 3; k++)
            positions.push_back(static_cast<float>(p[k]));
    const std::vector<unsigned> result =
        simplify_meshopt(indices, positions, target, seconds);

    Soup out{ in.points, {} };
    for (std::size_t i = 0; i < result.size(); i += 3)
        out.triangles.push_back({ result[i], result[i + 1], result[i + 2] });
    pmp::remove_isolated_points_in_polygon_soup(out.points, out.triangles);
    return out;
}

Soup simplify_lindstrom_turk(const Soup &in, std::size_t target,
                             double *seconds)
{
    Surface surface = surface_of(in);
    const double start = cpu_seconds();
    sms::edge_collapse(
        surface, Enough_faces{ target },
        CGAL::parameters::get_cost(sms::LindstromTurk_cost<Surface>())
            .get_placement(sms::LindstromTurk_placement<Surface>()));
    *seconds = cpu_seconds() - start;
    return soup_of(surface);
}

Soup simplify_garland_heckbert(const Soup &in, std::size_t target,
                               double *seconds)
{
    Surface surface = surface_of(in);
    const double start = cpu_seconds();
    sms::GarlandHeckbert_plane_policies<Surface, Kernel> policies(surface);
    sms::edge_collapse(surface, Enough_faces{ target },
                       CGAL::parameters::get_cost(policies.get_cost())
                           .get_placement(policies.get_placement())
                           .filter(sms::Bounded_normal_change_filter<>()));
    *seconds = cpu_seconds() - start;
    return soup_of(surface);
}

Soup simplify_openmesh(const Soup &in, std::size_t target, double *seconds)
{
    using Mesh = OpenMesh::TriMesh_ArrayKernelT<>;
    Mesh mesh;
    for (const Point &p : in.points)
        mesh.add_vertex({ static_cast<float>(p.x()), static_cast<float>(p.y()),
                          static_cast<float>(p.z()) });
    for (const auto &t : in.triangles)
        mesh.add_face(mesh.vertex_handle(static_cast<unsigned>(t[0])),
                      mesh.vertex_handle(static_cast<unsigned>(t[1])),
                      mesh.vertex_handle(static_cast<unsigned>(t[2])));

    const double start = cpu_seconds();
    OpenMesh::Decimater::DecimaterT<Mesh> decimater(mesh);
    OpenMesh::Decimater::ModQuadricT<Mesh>::Handle quadric;
    decimater.add(quadric);
    decimater.module(quadric).unset_max_err();
    decimater.initialize();
    decimater.decimate_to_faces(0, target);
    *seconds = cpu_seconds() - start;

    mesh.garbage_collection();
    Soup out;
    for (auto v : mesh.vertices()) {
        const auto &p = mesh.point(v);
        out.points.emplace_back(p[0], p[1], p[2]);
    }
    for (auto f : mesh.faces()) {
        std::vector<std::size_t> triangle;
        for (auto v : mesh.fv_range(f))
            triangle.push_back(static_cast<std::size_t>(v.idx()));
        out.triangles.push_back(triangle);
    }
    return out;
}
