/* SPDX-License-Identifier: MIT */
/*
 * bench_qem - contractions in strict quadric order: the reference for levels.
 *
 *   bench_qem MODEL.obj BITS OUT_DIR PERCENT...
 *
 * MODEL.obj is what a .pmesh file with BITS bits shows in full: manifold, its
 * triangles share vertices by index, positions lie on the grid that its
 * bounding box spans. The grid also takes the places of moved vertices, so
 * that both sides round alike. Written apart from the encoder, for clarity.
 *
 * One contraction at a time, always the cheapest legal one; after each, every
 * edge with an end in the ring is valued anew. Legal: the link condition holds,
 * and no face turns by a right angle. Four runs:
 *
 *   accumulated  planes of the original's faces, weighted by area, summed in
 *                each contraction (Garland, Heckbert 1997)
 *   memoryless   planes of the faces as they are; an optimal place also keeps
 *                the volume (Lindstrom, Turk 1998)
 *
 *   -subset      onto the better end of the edge
 *   -optimal     to the quadric's minimum; the best of ends and middle where it
 *                is not defined or further away than the edge is long
 *
 * Boundary edges add an upright plane of 10 times their squared length, as the
 * encoder does. Writes OUT_DIR/<run>_<percent>.obj, and a line of CSV each:
 *
 *   tool,percent,target,faces,cpu_s
 */
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <fstream>
#include <iostream>
#include <limits>
#include <queue>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Dense>

namespace {

using Vec = Eigen::Vector3d;
using Face = std::array<std::uint32_t, 3>;
using List = std::vector<std::uint32_t>;

constexpr double boundary_weight = 10;

struct Mesh {
    std::vector<Vec> points; /* in grid steps */
    std::vector<Face> faces;
    Vec origin;
    double step = 1;
};

Mesh read_obj(const std::string &path, int bits)
{
    std::ifstream file(path);
    if (!file)
        throw std::runtime_error(path + ": cannot be read");
    Mesh mesh;
    std::string line, word;
    while (std::getline(file, line)) {
        std::istringstream words(line);
        if (!(words >> word))
            continue;
        if (word == "v") {
            Vec p;
            words >> p[0] >> p[1] >> p[2];
            mesh.points.push_back(p);
        } else if (word == "f") {
            Face f;
            for (std::uint32_t &v : f) {
                words >> word; /* stoul stops at the first slash */
                v = static_cast<std::uint32_t>(std::stoul(word) - 1);
                if (v >= mesh.points.size())
                    throw std::runtime_error(path + ": bad index");
            }
            mesh.faces.push_back(f);
        }
    }
    Eigen::AlignedBox3d box;
    for (const Vec &p : mesh.points)
        box.extend(p);
    mesh.origin = box.min();
    mesh.step = box.sizes().maxCoeff() / (std::ldexp(1, bits) - 1);
    for (Vec &p : mesh.points)
        p = ((p - mesh.origin) / mesh.step).array().round();
    return mesh;
}

/* x'Ax + 2 b'x + c in coordinates about the origin of the grid: doubles hold
 * products of 14-bit coordinates with ten digits to spare. */
struct Quadric {
    Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
    Vec b = Vec::Zero();
    double c = 0;

    void add_plane(const Vec &point, const Vec &normal, double weight)
    {
        const double length = normal.norm();
        if (!(length > 0))
            return;
        const Vec n = normal / length;
        const double d = -n.dot(point);
        a += weight * n * n.transpose();
        b += weight * d * n;
        c += weight * d * d;
    }
    Quadric operator+(const Quadric &q) const
    {
        return { a + q.a, b + q.b, c + q.c };
    }
    double at(const Vec &x) const
    {
        return std::max(0.0, x.dot(a * x) + 2 * b.dot(x) + c);
    }
};

struct Way {
    const char *name;
    bool memoryless, optimal;
};

struct Candidate {
    double cost;
    std::uint32_t gone, kept; /* gone < kept if the place is free */
    std::uint64_t age;        /* of both ends, when it was valued */
    bool operator<(const Candidate &o) const /* the queue's top: the cheapest */
    {
        return std::tie(cost, gone, kept) > std::tie(o.cost, o.gone, o.kept);
    }
};

class Simplifier {
public:
    Simplifier(const Mesh &input, const Way &how)
        : mesh(input), way(how), around(input.points.size()),
          quadric(input.points.size()), age(input.points.size()),
          alive(input.faces.size(), true), face_count(input.faces.size())
    {
        for (std::uint32_t f = 0; f < mesh.faces.size(); f++)
            for (std::uint32_t v : mesh.faces[f])
                around[v].push_back(f);
        for (std::uint32_t v = 0; v < around.size(); v++)
            quadric[v] = quadric_of(v);
        for (std::uint32_t v = 0; v < around.size(); v++)
            offer_edges(v, true);
    }

    /* Stops early when nothing is legal any more. */
    void contract_to(std::size_t target)
    {
        while (face_count > target && !queue.empty()) {
            const Candidate c = queue.top();
            queue.pop();
            if (age_of(c.gone, c.kept) != c.age)
                continue;
            const Vec place = place_of(c.gone, c.kept);
            if (is_legal(c.gone, c.kept, place))
                contract(c.gone, c.kept, place);
        }
    }

    std::size_t faces() const { return face_count; }

    void write(const std::string &path) const;

private:
    Mesh mesh;
    const Way way;
    std::vector<List> around; /* faces of each vertex */
    std::vector<Quadric> quadric;
    std::vector<std::uint64_t> age; /* counts changes; huge for the dead */
    std::vector<bool> alive;
    std::size_t face_count;
    std::priority_queue<Candidate> queue;

    bool has(std::uint32_t f, std::uint32_t v) const
    {
        const Face &t = mesh.faces[f];
        return t[0] == v || t[1] == v || t[2] == v;
    }
    std::uint64_t age_of(std::uint32_t u, std::uint32_t v) const
    {
        return age[u] + age[v];
    }
    /* Of double length: of twice the area. */
    Vec normal(const Face &t) const
    {
        const Vec &p = mesh.points[t[0]];
        return (mesh.points[t[1]] - p).cross(mesh.points[t[2]] - p);
    }
    List ring(std::uint32_t v) const;
    std::size_t edge_faces(std::uint32_t u, std::uint32_t v) const;
    bool on_boundary(std::uint32_t v) const
    {
        return ring(v).size() != around[v].size();
    }
    Quadric quadric_of(std::uint32_t v) const;
    Vec place_of(std::uint32_t gone, std::uint32_t kept) const;
    bool minimum(std::uint32_t u, std::uint32_t v, Vec *x) const;
    void offer_edges(std::uint32_t v, bool upwards_only);
    void offer(std::uint32_t gone, std::uint32_t kept);
    bool turns(std::uint32_t v, std::uint32_t other, const Vec &place) const;
    bool is_legal(std::uint32_t u, std::uint32_t v, const Vec &place) const;
    void contract(std::uint32_t gone, std::uint32_t kept, const Vec &place);
};

/* Sorted. */
List Simplifier::ring(std::uint32_t v) const
{
    List list;
    for (std::uint32_t f : around[v])
        for (std::uint32_t w : mesh.faces[f])
            if (w != v)
                list.push_back(w);
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    return list;
}

std::size_t Simplifier::edge_faces(std::uint32_t u, std::uint32_t v) const
{
    std::size_t count = 0;
    for (std::uint32_t f : around[u])
        count += has(f, v);
    return count;
}

Quadric Simplifier::quadric_of(std::uint32_t v) const
{
    Quadric q;
    for (std::uint32_t f : around[v]) {
        const Face &t = mesh.faces[f];
        const Vec n = normal(t);
        q.add_plane(mesh.points[v], n, n.norm() / 2);
        for (std::uint32_t w : t) {
            if (w == v || edge_faces(v, w) != 1)
                continue;
            const Vec edge = mesh.points[w] - mesh.points[v];
            q.add_plane(mesh.points[v], edge.cross(n),
                        boundary_weight * edge.squaredNorm());
        }
    }
    return q;
}

/* False where there is none that is near. */
bool Simplifier::minimum(std::uint32_t u, std::uint32_t v, Vec *x) const
{
    const Quadric q = quadric[u] + quadric[v];
    const Vec middle = (mesh.points[u] + mesh.points[v]) / 2;
    const double trace = q.a.trace();
    if (!(trace > 0))
        return false;
    /* A slight pull to the middle, relative to the quadric. */
    const Eigen::Matrix3d a =
        q.a / trace + 1e-6 * Eigen::Matrix3d::Identity();
    const Eigen::LDLT<Eigen::Matrix3d> solver(a);
    Vec shift = solver.solve(-(q.a * middle + q.b) / trace);
    if (way.memoryless && !on_boundary(u) && !on_boundary(v)) {
        Vec n = Vec::Zero();
        double volume = 0; /* above the middle */
        for (std::uint32_t end : { u, v })
            for (std::uint32_t f : around[end]) {
                if (end == v && has(f, u))
                    continue;
                const Vec m = normal(mesh.faces[f]);
                n += m;
                volume += m.dot(mesh.points[end] - middle);
            }
        const Vec along = solver.solve(n);
        if (!(n.dot(along) > 0))
            return false;
        shift += (volume - n.dot(shift)) / n.dot(along) * along;
    }
    *x = (middle + shift).array().round();
    return (*x - middle).norm() <= (mesh.points[u] - mesh.points[v]).norm();
}

Vec Simplifier::place_of(std::uint32_t gone, std::uint32_t kept) const
{
    const Vec &p = mesh.points[gone], &q = mesh.points[kept];
    Vec best;
    if (!way.optimal)
        return q;
    if (minimum(gone, kept, &best))
        return best;
    const Quadric sum = quadric[gone] + quadric[kept];
    best = q;
    for (const Vec &x : { p, Vec(((p + q) / 2).array().round()) })
        if (sum.at(x) < sum.at(best))
            best = x;
    return best;
}

void Simplifier::offer(std::uint32_t gone, std::uint32_t kept)
{
    const Quadric sum = quadric[gone] + quadric[kept];
    queue.push({ sum.at(place_of(gone, kept)), gone, kept,
                 age_of(gone, kept) });
}

void Simplifier::offer_edges(std::uint32_t v, bool upwards_only)
{
    for (std::uint32_t w : ring(v)) {
        if (w < v && upwards_only)
            continue;
        offer(std::min(v, w), std::max(v, w));
        if (!way.optimal)
            offer(std::max(v, w), std::min(v, w));
    }
}

/* Whether a face of v, not of `other`, turns by 90 degrees or more. */
bool Simplifier::turns(std::uint32_t v, std::uint32_t other,
                       const Vec &place) const
{
    for (std::uint32_t f : around[v]) {
        if (has(f, other))
            continue;
        const Face &t = mesh.faces[f];
        const std::size_t k = t[0] == v ? 0 : t[1] == v ? 1 : 2;
        const Vec &a = mesh.points[t[(k + 1) % 3]];
        const Vec &b = mesh.points[t[(k + 2) % 3]];
        const Vec before = normal(t);
        if (!before.isZero() &&
            before.dot((a - place).cross(b - place)) <= 0)
            return true;
    }
    return false;
}

/* Across a boundary stands one more vertex, a neighbour of all its vertices:
 * the link condition then reads the same everywhere. */
bool Simplifier::is_legal(std::uint32_t u, std::uint32_t v,
                          const Vec &place) const
{
    const List a = ring(u), b = ring(v);
    const std::size_t faces = edge_faces(u, v);
    const std::size_t outer_u = a.size() != around[u].size();
    const std::size_t outer_v = b.size() != around[v].size();
    List common;
    std::set_intersection(a.begin(), a.end(), b.begin(), b.end(),
                          std::back_inserter(common));
    return common.size() + (outer_u & outer_v) == 2 &&
           faces + (faces == 1) == 2 && common.size() == faces &&
           a.size() + outer_u + b.size() + outer_v >= 7 &&
           !turns(u, v, place) && !turns(v, u, place);
}

void Simplifier::contract(std::uint32_t gone, std::uint32_t kept,
                          const Vec &place)
{
    for (std::uint32_t f : around[gone]) {
        if (has(f, kept)) {
            for (std::uint32_t v : mesh.faces[f])
                if (v != gone)
                    around[v].erase(
                        std::find(around[v].begin(), around[v].end(), f));
            alive[f] = false;
            face_count--;
        } else {
            std::replace(mesh.faces[f].begin(), mesh.faces[f].end(), gone,
                         kept);
            around[kept].push_back(f);
        }
    }
    around[gone].clear();
    age[gone] = std::uint64_t{ 1 } << 40;
    mesh.points[kept] = place;
    quadric[kept] = quadric[kept] + quadric[gone];

    List changed = ring(kept);
    changed.push_back(kept);
    for (std::uint32_t v : changed) {
        age[v]++;
        if (way.memoryless)
            quadric[v] = quadric_of(v);
    }
    for (std::uint32_t v : changed)
        offer_edges(v, false);
}

void Simplifier::write(const std::string &path) const
{
    std::ofstream file(path);
    List number(mesh.points.size());
    std::uint32_t count = 0;
    file.precision(std::numeric_limits<double>::max_digits10);
    for (std::size_t v = 0; v < mesh.points.size(); v++) {
        if (around[v].empty())
            continue;
        number[v] = ++count;
        const Vec p = mesh.origin + mesh.step * mesh.points[v];
        file << "v " << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
    }
    for (std::size_t f = 0; f < mesh.faces.size(); f++)
        if (alive[f])
            file << "f " << number[mesh.faces[f][0]] << ' '
                 << number[mesh.faces[f][1]] << ' '
                 << number[mesh.faces[f][2]] << '\n';
    if (!file.flush())
        throw std::runtime_error(path + ": cannot be written");
}

const Way ways[] = {
    { "accumulated-subset", false, false },
    { "accumulated-optimal", false, true },
    { "memoryless-subset", true, false },
    { "memoryless-optimal", true, true },
};

void run(const Mesh &mesh, const std::string &dir,
         std::vector<std::string> percents)
{
    std::sort(percents.begin(), percents.end(),
              [](const std::string &a, const std::string &b) {
                  return std::stod(a) > std::stod(b);
              });
    for (const Way &way : ways) {
        const std::clock_t start = std::clock();
        Simplifier work(mesh, way);
        for (const std::string &percent : percents) {
            const auto target = static_cast<std::size_t>(
                std::lround(static_cast<double>(mesh.faces.size()) *
                            std::stod(percent) / 100));
            work.contract_to(target);
            work.write(dir + "/" + way.name + "_" + percent + ".obj");
            std::printf("%s,%s,%zu,%zu,%.3f\n", way.name, percent.c_str(),
                        target, work.faces(),
                        static_cast<double>(std::clock() - start) /
                            CLOCKS_PER_SEC);
            std::fflush(stdout);
        }
    }
}

} // namespace

int main(int argc, char **argv)
{
    const int bits = argc > 4 ? std::atoi(argv[2]) : 0;
    if (bits < 4 || bits > 24) {
        std::cerr << "usage: bench_qem MODEL.obj BITS OUT_DIR PERCENT...\n";
        return 2;
    }
    try {
        run(read_obj(argv[1], bits), argv[3], { argv + 4, argv + argc });
    } catch (const std::exception &e) {
        std::cerr << "bench_qem: " << e.what() << '\n';
        return 1;
    }
    return 0;
}
