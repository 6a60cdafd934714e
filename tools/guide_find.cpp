/* SPDX-License-Identifier: MIT */
/* guide_find.cpp - which vertices a guide file means. */
#include "tools/guide_store.h"

#include <algorithm>
#include <cmath>
#include <cstring>

void guide_fail(const std::string &where, const std::string &what)
{
    throw std::runtime_error(where + ": " + what);
}

double guide_number(const guide_json &value, const std::string &where)
{
    if (!value.is_number() || !std::isfinite(value.get<double>()))
        guide_fail(where, "a number is expected");
    return value.get<double>();
}

/* ---- nearest ------------------------------------------------------------ */

static bool is_finite(const double p[3])
{
    return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

/* Vertices at finite places, the first at each, as a tree: node i is a range of
 * them, of which 2i and 2i + 1 are halves. */
void guide_points::sort() const
{
    const auto at = [this](uint32_t v) { return xyz + 3 * size_t{ v }; };

    sorted = true;
    for (size_t v = 0; v < count; v++)
        if (is_finite(xyz + 3 * v))
            order.push_back(static_cast<uint32_t>(v));
    std::sort(order.begin(), order.end(), [at](uint32_t a, uint32_t b) {
        for (size_t k = 0; k < 3; k++)
            if (at(a)[k] != at(b)[k])
                return at(a)[k] < at(b)[k];
        return a < b;
    });
    order.erase(std::unique(order.begin(), order.end(),
                            [at](uint32_t a, uint32_t b) {
                                return std::equal(at(a), at(a) + 3, at(b));
                            }),
                order.end());
    part({ 1, 0, order.size() });
}

/* Finds the box of a range, and halves it across the longest side. */
void guide_points::part(const range &r) const
{
    point_box box;

    for (size_t i = r.first; i < r.last; i++)
        for (size_t k = 0; k < 3; k++) {
            const double t = xyz[3 * size_t{ order[i] } + k];
            box.low[k] = std::fmin(box.low[k], t);
            box.high[k] = std::fmax(box.high[k], t);
        }
    if (boxes.size() <= r.node)
        boxes.resize(r.node + 1);
    boxes[r.node] = box;
    if (r.is_leaf())
        return;
    size_t axis = 0;
    for (size_t k = 1; k < 3; k++)
        if (box.high[k] - box.low[k] > box.high[axis] - box.low[axis])
            axis = k;
    const auto at = order.begin() + static_cast<ptrdiff_t>(r.first);
    const auto size = static_cast<ptrdiff_t>(r.last - r.first);
    std::nth_element(at, at + size / 2, at + size,
                     [this, axis](uint32_t a, uint32_t b) {
                         return xyz[3 * size_t{ a } + axis] <
                                xyz[3 * size_t{ b } + axis];
                     });
    part(r.half(0));
    part(r.half(1));
}

static double square_to(const point_box &box, const double p[3])
{
    double sum = 0;
    for (size_t k = 0; k < 3; k++) {
        const double d = std::fmax(0, std::fmax(box.low[k] - p[k],
                                                p[k] - box.high[k]));
        sum += d * d;
    }
    return sum;
}

void guide_points::look(uint32_t v, best_point *best) const
{
    const double *q = xyz + 3 * size_t{ v };
    double d = 0;

    best->looked++;
    for (size_t k = 0; k < 3; k++)
        d += (q[k] - best->p[k]) * (q[k] - best->p[k]);
    if (d < best->square || (d == best->square && v < best->found)) {
        best->square = d;
        best->found = v;
    }
}

/* The nearer half first; none that is further than the best so far. */
void guide_points::search(const range &r, best_point *best) const
{
    if (r.is_leaf()) {
        for (size_t i = r.first; i < r.last; i++)
            look(order[i], best);
        return;
    }
    const range halves[] = { r.half(0), r.half(1) };
    const double reach[] = { square_to(boxes[halves[0].node], best->p),
                             square_to(boxes[halves[1].node], best->p) };
    const size_t nearer = reach[1] < reach[0];
    for (const size_t i : { nearer, 1 - nearer })
        if (reach[i] <= best->square && reach[i] < HUGE_VAL)
            search(halves[i], best);
}

uint32_t guide_points::nearest(const double p[3], uint64_t *looked) const
{
    best_point best = { p, HUGE_VAL, UINT32_MAX, 0 };

    if (!sorted)
        sort();
    if (is_finite(p))
        search({ 1, 0, order.size() }, &best);
    *looked = best.looked;
    return best.found;
}

/* ---- places and regions ------------------------------------------------- */

namespace {

void read_point(const guide_json &value, const std::string &where, double out[3])
{
    if (!value.is_array() || value.size() != 3)
        guide_fail(where, "three numbers are expected");
    for (size_t k = 0; k < 3; k++)
        out[k] = guide_number(value[k], where);
}

/* 1 up to the hard core, then smoothly to 0 at the radius. */
double fade(double distance, double radius, double falloff)
{
    const double t = distance / radius;
    if (t <= 1 - falloff)
        return 1;
    const double s = (1 - t) / falloff;
    return s * s * (3 - 2 * s);
}

} // namespace

guide_finder::guide_finder(const asset *of, const guide_json &source)
    : mesh(of), points(of->positions, of->vertex_count)
{
    if (source.is_null())
        return;
    if (!source.is_object())
        guide_fail("source", "an object is expected");
    const auto hash = source.find("hash");
    char ours[17];
    guide_hash(mesh, ours);
    if (hash == source.end())
        return;
    if (!hash->is_string())
        guide_fail("source.hash", "a text is expected");
    other = hash->get<std::string>() != ours;
    const auto places = source.find("positions");
    if (!other || places == source.end())
        return;
    if (!places->is_array() || places->size() % 3 != 0)
        guide_fail("source.positions", "three numbers for each vertex are "
                                       "expected");
    for (const auto &value : *places)
        theirs.push_back(guide_number(value, "source.positions"));
}

uint32_t guide_finder::nearest(const double p[3],
                               const std::string &where) const
{
    const uint32_t v = nearest_of(points, p, where);

    if (v == UINT32_MAX)
        guide_fail(where, "the mesh has no vertex at a finite place");
    return v;
}

void guide_finder::look(uint64_t many, const std::string &where) const
{
    if (many > to_look_at)
        guide_fail(where, "the guide looks at more than 2^32 vertices");
    to_look_at -= many;
}

/* Where many points are equally far, a search sees them all, each by a jump. */
uint32_t guide_finder::nearest_of(const guide_points &from, const double p[3],
                                  const std::string &where) const
{
    constexpr uint64_t usual = 256, cost = 32;
    uint64_t looked;
    const uint32_t v = from.nearest(p, &looked);

    look(looked > usual ? cost * looked : 0, where);
    return v;
}

uint32_t guide_finder::vertex(const guide_json &number,
                              const std::string &where) const
{
    if (!number.is_number_unsigned())
        guide_fail(where, "vertex numbers are expected");
    const uint64_t v = number.get<uint64_t>();
    if (other && theirs.empty())
        guide_fail(where, "the guide was made for another mesh and does not "
                          "tell where its vertices were (source.positions)");
    if (v >= count())
        guide_fail(where, "vertex " + std::to_string(v) + ", there are " +
                              std::to_string(count()));
    return other ? nearest(&theirs[3 * static_cast<size_t>(v)], where)
                 : static_cast<uint32_t>(v);
}

std::vector<uint32_t> guide_finder::find(const guide_json &item,
                                         const std::string &where,
                                         std::vector<double> *strength) const
{
    std::vector<uint32_t> found;
    const auto all = [&](auto inside) {
        std::vector<uint32_t> list;
        look(mesh->vertex_count, where);
        for (size_t v = 0; v < mesh->vertex_count; v++)
            if (inside(mesh->positions + 3 * v))
                list.push_back(static_cast<uint32_t>(v));
        return list;
    };

    if (!item.is_object())
        guide_fail(where, "an object is expected");
    if (const auto list = item.find("vertices"); list != item.end()) {
        if (!list->is_array())
            guide_fail(where + ".vertices", "a list is expected");
        for (const auto &number : *list)
            found.push_back(vertex(number, where + ".vertices"));
    } else if (const auto list = item.find("positions"); list != item.end()) {
        if (!list->is_array())
            guide_fail(where + ".positions", "a list is expected");
        for (const auto &place : *list) {
            double p[3];
            read_point(place, where + ".positions", p);
            found.push_back(nearest(p, where + ".positions"));
        }
    } else if (const auto box = item.find("box"); box != item.end()) {
        double low[3], high[3];
        if (!box->is_array() || box->size() != 2)
            guide_fail(where + ".box", "two corners are expected");
        read_point((*box)[0], where + ".box", low);
        read_point((*box)[1], where + ".box", high);
        found = all([&](const double *p) {
            return p[0] >= low[0] && p[1] >= low[1] && p[2] >= low[2] &&
                   p[0] <= high[0] && p[1] <= high[1] && p[2] <= high[2];
        });
    } else if (const auto ball = item.find("sphere"); ball != item.end()) {
        double center[3];
        if (!ball->is_object() || !ball->contains("center") ||
            !ball->contains("radius"))
            guide_fail(where + ".sphere", "center and radius are expected");
        read_point((*ball)["center"], where + ".sphere.center", center);
        const double radius =
            guide_number((*ball)["radius"], where + ".sphere.radius");
        const double falloff =
            ball->contains("falloff")
                ? guide_number((*ball)["falloff"], where + ".sphere.falloff")
                : 0;
        if (!(radius > 0) || !(falloff >= 0 && falloff <= 1))
            guide_fail(where + ".sphere", "radius > 0 and falloff 0 .. 1 are "
                                          "expected");
        const auto distance = [&](const double *p) {
            return std::sqrt((p[0] - center[0]) * (p[0] - center[0]) +
                             (p[1] - center[1]) * (p[1] - center[1]) +
                             (p[2] - center[2]) * (p[2] - center[2]));
        };
        found = all([&](const double *p) { return distance(p) <= radius; });
        for (size_t i = 0; strength && i < found.size(); i++)
            strength->push_back(
                fade(distance(mesh->positions + 3 * size_t{ found[i] }), radius,
                     falloff));
    } else if (item.contains("all")) {
        found = all([](const double *) { return true; });
    } else {
        guide_fail(where, "vertices, positions, box, sphere or all is "
                          "expected");
    }
    if (strength && strength->empty())
        strength->assign(found.size(), 1);
    return found;
}

std::vector<float> guide_finder::spread(const std::vector<float> &values) const
{
    if (!other)
        return values;
    const guide_points from(theirs.data(), theirs.size() / 3);
    std::vector<float> out(mesh->vertex_count);
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        const uint32_t near =
            nearest_of(from, mesh->positions + 3 * v, "weights");
        out[v] = near == UINT32_MAX ? 0.5f : values[near];
    }
    return out;
}
