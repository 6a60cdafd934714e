/* SPDX-License-Identifier: MIT */
/*
 * bench_simplify - simplifies an OBJ model with other libraries.
 *
 *   bench_simplify [-t TOOL] MODEL.obj OUT_DIR PERCENT...
 *
 * Runs meshoptimizer's meshopt_simplify and CGAL's edge collapse with the
 * policies of Lindstrom-Turk and of Garland-Heckbert (or only the one of
 * meshopt, cgal-lt, cgal-gh) down to each percentage of the faces. Writes OUT_DIR/<tool>_<percent>.obj and one line of CSV each:
 *
 *   tool,percent,target,faces,cpu_s
 *
 * Time is CPU time of the simplification from a ready mesh: an index buffer for
 * meshoptimizer, a halfedge mesh for CGAL. Positions that are equal are one
 * vertex for all of them; other attributes are left out.
 */
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <fstream>
#include <iostream>
#include <limits>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_filter.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_plane_policies.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_cost.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_placement.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>
#include <meshoptimizer.h>

namespace {

namespace sms = CGAL::Surface_mesh_simplification;
namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Simple_cartesian<double>;
using Point = Kernel::Point_3;
using Surface = CGAL::Surface_mesh<Point>;

struct Soup {
    std::vector<Point> points;
    std::vector<std::vector<std::size_t>> triangles;
};

/* Models of a benchmark are trusted: positions and polygons, no more. */
Soup read_obj(const std::string &path)
{
    std::ifstream file(path);
    if (!file)
        throw std::runtime_error(path + ": cannot be read");
    Soup soup;
    std::map<Point, std::size_t> first;
    std::vector<std::size_t> welded;
    std::string line, word;
    while (std::getline(file, line)) {
        std::istringstream words(line);
        words >> word;
        if (word == "v") {
            double x, y, z;
            words >> x >> y >> z;
            const auto [at, fresh] =
                first.try_emplace(Point(x, y, z), soup.points.size());
            if (fresh)
                soup.points.push_back(at->first);
            welded.push_back(at->second);
        } else if (word == "f") {
            std::vector<std::size_t> corner;
            while (words >> word) {
                const long i = std::stol(word); /* up to the first slash */
                const long count = static_cast<long>(welded.size());
                corner.push_back(welded.at(
                    static_cast<std::size_t>(i > 0 ? i - 1 : count + i)));
            }
            for (std::size_t i = 2; i < corner.size(); i++)
                soup.triangles.push_back(
                    { corner[0], corner[i - 1], corner[i] });
        }
        word.clear();
    }
    return soup;
}

void write_obj(const std::string &path, const Soup &soup)
{
    std::ofstream file(path);
    file.precision(std::numeric_limits<double>::max_digits10);
    for (const Point &p : soup.points)
        file << "v " << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
    for (const auto &t : soup.triangles)
        file << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
    if (!file.flush())
        throw std::runtime_error(path + ": cannot be written");
}

double cpu_seconds()
{
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

Soup simplify_meshopt(const Soup &in, std::size_t target, double *seconds)
{
    std::vector<unsigned> indices, result(3 * in.triangles.size());
    std::vector<float> positions;
    for (const auto &t : in.triangles)
        for (std::size_t v : t)
            indices.push_back(static_cast<unsigned>(v));
    for (const Point &p : in.points)
        for (int k = 0; k < 3; k++)
            positions.push_back(static_cast<float>(p[k]));

    const float no_limit = 1e9f;
    const double start = cpu_seconds();
    result.resize(meshopt_simplify(
        result.data(), indices.data(), indices.size(), positions.data(),
        in.points.size(), 3 * sizeof(float), 3 * target, no_limit, 0, nullptr));
    *seconds = cpu_seconds() - start;

    Soup out{ in.points, {} };
    for (std::size_t i = 0; i < result.size(); i += 3)
        out.triangles.push_back({ result[i], result[i + 1], result[i + 2] });
    pmp::remove_isolated_points_in_polygon_soup(out.points, out.triangles);
    return out;
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

const struct {
    const char *name;
    Soup (*simplify)(const Soup &, std::size_t target, double *seconds);
} tools[] = {
    { "meshopt", simplify_meshopt },
    { "cgal-lt", simplify_lindstrom_turk },
    { "cgal-gh", simplify_garland_heckbert },
};

/* only: the name of a tool, or empty for all. */
void run(const std::string &only, const std::string &model,
         const std::string &dir, const std::vector<std::string> &percents)
{
    const Soup in = read_obj(model);
    for (const std::string &percent : percents) {
        const auto target = static_cast<std::size_t>(
            std::lround(static_cast<double>(in.triangles.size()) *
                        std::stod(percent) / 100));
        for (const auto &tool : tools) {
            if (!only.empty() && only != tool.name)
                continue;
            double seconds = 0;
            const Soup out = tool.simplify(in, target, &seconds);
            write_obj(dir + "/" + tool.name + "_" + percent + ".obj", out);
            std::printf("%s,%s,%zu,%zu,%.3f\n", tool.name, percent.c_str(),
                        target, out.triangles.size(), seconds);
            std::fflush(stdout);
        }
    }
}

} // namespace

int main(int argc, char **argv)
{
    const bool one = argc > 2 && std::string(argv[1]) == "-t";
    char **operand = argv + (one ? 3 : 1);
    if (argv + argc - operand < 3) {
        std::cerr << "usage: bench_simplify [-t TOOL] MODEL.obj OUT_DIR "
                     "PERCENT...\n";
        return 2;
    }
    try {
        run(one ? argv[2] : "", operand[0], operand[1],
            { operand + 2, argv + argc });
    } catch (const std::exception &e) {
        std::cerr << "bench_simplify: " << e.what() << '\n';
        return 1;
    }
    return 0;
}
