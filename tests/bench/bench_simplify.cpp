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
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iostream>
#include <limits>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/bench/peers.h"

namespace {

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
