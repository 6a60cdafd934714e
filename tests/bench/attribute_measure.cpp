/* SPDX-License-Identifier: MIT */
#include "tests/bench/attribute_measure.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <utility>

namespace
{

constexpr std::size_t samples = 100000;
constexpr int picture = 384; /* pixels */

/* ---- distances ----------------------------------------------------------- */

Vec point(const Mesh &mesh, std::uint32_t p)
{
    return { mesh.xyz[3 * std::size_t{ p }], mesh.xyz[3 * std::size_t{ p } + 1],
             mesh.xyz[3 * std::size_t{ p } + 2] };
}

Vec minus(const Vec &a, const Vec &b)
{
    return { a[0] - b[0], a[1] - b[1], a[2] - b[2] };
}

double dot(const Vec &a, const Vec &b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Vec cross(const Vec &a, const Vec &b)
{
    return { a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
             a[0] * b[1] - a[1] * b[0] };
}

/* Weights of the corners at the point of the triangle closest to p: by the
 * regions of corners, edges and inside. */
Vec closest(const Vec &p, const Vec &a, const Vec &b, const Vec &c)
{
    const Vec ab = minus(b, a), ac = minus(c, a), n = cross(ab, ac);
    const double square = dot(n, n);
    if (square > 0) {
        const Vec ap = minus(p, a);
        const double v = dot(cross(ap, ac), n) / square;
        const double w = dot(cross(ab, ap), n) / square;
        if (v >= 0 && w >= 0 && v + w <= 1)
            return { 1 - v - w, v, w };
    }
    const Vec corner[3] = { a, b, c };
    Vec best = { 1, 0, 0 };
    double least = HUGE_VAL;
    for (std::size_t k = 0; k < 3; k++) {
        const std::size_t l = (k + 1) % 3;
        const Vec way = minus(corner[l], corner[k]);
        const double length = dot(way, way);
        double t = length > 0 ? dot(minus(p, corner[k]), way) / length : 0;
        t = std::clamp(t, 0.0, 1.0);
        Vec off = minus(p, corner[k]);
        for (std::size_t i = 0; i < 3; i++)
            off[i] -= t * way[i];
        if (dot(off, off) < least) {
            least = dot(off, off);
            best = { 0, 0, 0 };
            best[k] = 1 - t;
            best[l] = t;
        }
    }
    return best;
}

std::vector<double> blend(const Mesh &mesh, const std::uint32_t corner[3],
                          const Vec &weight)
{
    std::vector<double> row(mesh.width, 0.0);
    for (std::size_t k = 0; k < 3; k++)
        for (std::size_t i = 0; i < mesh.width; i++)
            row[i] += weight[k] * static_cast<double>(
                                      mesh.rows[corner[k] * mesh.width + i]);
    return row;
}

void normalise(double *v)
{
    const double n = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int i = 0; i < 3 && n > 0; i++)
        v[i] /= n;
}

void compare_rows(const Mesh &mesh, std::vector<double> a,
                  std::vector<double> b, Sums *sums)
{
    for (const Channel &c : mesh.channels) {
        if (c.kind == PMESH_NORMAL) {
            normalise(&a[c.offset]);
            normalise(&b[c.offset]);
        }
        for (std::size_t k = 0; k < c.components; k++) {
            const double d = a[c.offset + k] - b[c.offset + k];
            sums->kind[c.kind] += d * d;
        }
    }
}

} // namespace

void one_way(const Searchable &from, const Searchable &to, Sums *sums)
{
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> unit(0, 1);
    std::vector<double> area;
    double total = 0;
    const std::size_t faces = from.tree.face_count;
    auto corner = [](const Searchable &s, std::size_t f) {
        return s.tree.corners + 3 * f;
    };
    for (std::size_t f = 0; f < faces; f++) {
        const std::uint32_t *c = corner(from, f);
        const Vec a = from.local(c[0]);
        const Vec n =
            cross(minus(from.local(c[1]), a), minus(from.local(c[2]), a));
        total += std::sqrt(dot(n, n));
        area.push_back(total);
    }
    std::uint32_t hint = 0;
    for (std::size_t i = 0; i < samples; i++) {
        const double at = total * (static_cast<double>(i) + unit(random)) /
                          static_cast<double>(samples);
        std::size_t f = static_cast<std::size_t>(
            std::lower_bound(area.begin(), area.end(), at) - area.begin());
        f = std::min(f, faces - 1);
        const double r = std::sqrt(unit(random)), u = unit(random);
        const Vec weight = { 1 - r, r * (1 - u), r * u };
        const std::uint32_t *c = corner(from, f);
        Vec p = { 0, 0, 0 };
        for (std::size_t k = 0; k < 3; k++)
            for (std::size_t j = 0; j < 3; j++)
                p[j] += weight[k] * from.local(c[k])[j];
        sums->distance += surface_closest(&to.tree, p.data(), &hint);
        const std::uint32_t *d = corner(to, hint);
        const Vec other =
            closest(p, to.local(d[0]), to.local(d[1]), to.local(d[2]));
        compare_rows(from.mesh, blend(from.mesh, c, weight),
                     blend(to.mesh, d, other), sums);
        sums->count++;
    }
}

const Channel *find(const Mesh &mesh, pmesh_attribute_kind kind)
{
    for (const Channel &c : mesh.channels)
        if (c.kind == kind)
            return &c;
    return nullptr;
}

namespace
{

double uv_area(const Mesh &mesh, const std::uint32_t corner[3])
{
    const Channel *c = find(mesh, PMESH_TEXCOORD);
    double x[3], y[3];
    for (int k = 0; k < 3; k++) {
        x[k] =
            static_cast<double>(mesh.rows[corner[k] * mesh.width + c->offset]);
        y[k] = static_cast<double>(
            mesh.rows[corner[k] * mesh.width + c->offset + 1]);
    }
    return (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
}

} // namespace

std::size_t count_flips(const Searchable &original, const Searchable &result)
{
    std::size_t flips = 0;
    std::uint32_t hint = 0;
    if (!find(original.mesh, PMESH_TEXCOORD))
        return 0;
    for (std::size_t f = 0; f < result.tree.face_count; f++) {
        const std::uint32_t *c = result.tree.corners + 3 * f;
        Vec p = { 0, 0, 0 };
        for (std::size_t k = 0; k < 3; k++)
            for (std::size_t j = 0; j < 3; j++)
                p[j] += result.local(c[k])[j] / 3;
        surface_closest(&original.tree, p.data(), &hint);
        flips += uv_area(result.mesh, c) *
                     uv_area(original.mesh,
                             original.tree.corners + 3 * std::size_t{ hint }) <
                 0;
    }
    return flips;
}

std::size_t count_open(const Mesh &mesh)
{
    std::map<Vec, std::uint32_t> number;
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    auto at = [&](std::size_t c) {
        return number
            .try_emplace(point(mesh, mesh.tri[c]),
                         static_cast<std::uint32_t>(number.size()))
            .first->second;
    };
    for (std::size_t c = 0; c < mesh.tri.size(); c++) {
        const std::uint32_t a = at(c), b = at(c % 3 == 2 ? c - 2 : c + 1);
        edges[std::minmax(a, b)]++;
    }
    return static_cast<std::size_t>(
        std::count_if(edges.begin(), edges.end(),
                      [](const auto &e) { return e.second != 2; }));
}

namespace
{

/* ---- drawings ------------------------------------------------------------ */

std::array<float, 3> shade(const Mesh &mesh, std::vector<double> row,
                           std::size_t axis, double sign)
{
    double light = 1;
    std::array<double, 3> color = { 0.8, 0.8, 0.8 };
    for (const Channel &c : mesh.channels) {
        if (c.kind == PMESH_NORMAL) {
            normalise(&row[c.offset]);
            light = 0.25 + 0.75 * std::max(0.0, sign * row[c.offset + axis]);
        } else if (c.kind == PMESH_COLOR) {
            for (std::size_t k = 0; k < 3; k++)
                color[k] = std::clamp(row[c.offset + k], 0.0, 1.0);
        } else if (c.kind == PMESH_TEXCOORD) {
            const double turn = 2 * std::acos(-1.0) * 8;
            color = { 0.5 + 0.5 * std::sin(turn * row[c.offset]),
                      0.5 + 0.5 * std::sin(turn * row[c.offset + 1]), 0.5 };
        }
    }
    return { static_cast<float>(light * color[0]),
             static_cast<float>(light * color[1]),
             static_cast<float>(light * color[2]) };
}

Image draw(const Searchable &s, std::size_t axis, double sign)
{
    const std::size_t ax = (axis + 1) % 3, ay = (axis + 2) % 3;
    Image image(picture * picture, { -1, -1, -1 });
    std::vector<double> depth(image.size(), -HUGE_VAL);
    for (std::size_t f = 0; f < s.tree.face_count; f++) {
        const std::uint32_t *c = s.tree.corners + 3 * f;
        double x[3], y[3], z[3];
        for (std::size_t k = 0; k < 3; k++) {
            const Vec p = s.local(c[k]);
            x[k] = (p[ax] + 1) * picture / 2;
            y[k] = (p[ay] + 1) * picture / 2;
            z[k] = sign * p[axis];
        }
        const double area =
            (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
        if (!(std::fabs(area) > 0))
            continue;
        auto low = [](const double v[3]) {
            return std::max(0,
                            static_cast<int>(std::min({ v[0], v[1], v[2] })));
        };
        auto high = [](const double v[3]) {
            return std::min(picture - 1,
                            static_cast<int>(std::max({ v[0], v[1], v[2] })));
        };
        for (int py = low(y); py <= high(y); py++)
            for (int px = low(x); px <= high(x); px++) {
                const double qx = px + 0.5, qy = py + 0.5;
                Vec w;
                for (std::size_t k = 0; k < 3; k++) {
                    const std::size_t l = (k + 1) % 3, m = (k + 2) % 3;
                    w[k] = ((x[l] - qx) * (y[m] - qy) -
                            (x[m] - qx) * (y[l] - qy)) /
                           area;
                }
                if (w[0] < 0 || w[1] < 0 || w[2] < 0)
                    continue;
                const double d = w[0] * z[0] + w[1] * z[1] + w[2] * z[2];
                const auto at = static_cast<std::size_t>(py * picture + px);
                if (d <= depth[at])
                    continue;
                depth[at] = d;
                image[at] = shade(s.mesh, blend(s.mesh, c, w), axis, sign);
            }
    }
    return image;
}

} // namespace

std::vector<Image> draw_all(const Searchable &s)
{
    std::vector<Image> images;
    for (std::size_t view = 0; view < 6; view++)
        images.push_back(draw(s, view / 2, view % 2 ? 1 : -1));
    return images;
}

double psnr(const std::vector<Image> &a, const std::vector<Image> &b)
{
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t view = 0; view < a.size(); view++)
        for (std::size_t i = 0; i < a[view].size(); i++) {
            if (a[view][i][0] < 0 && b[view][i][0] < 0)
                continue;
            for (std::size_t k = 0; k < 3; k++) {
                const double d =
                    std::max(0.0, static_cast<double>(a[view][i][k])) -
                    std::max(0.0, static_cast<double>(b[view][i][k]));
                sum += d * d;
                count++;
            }
        }
    return -10 * std::log10(sum / static_cast<double>(count));
}
