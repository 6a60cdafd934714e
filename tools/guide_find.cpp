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

void guide_points::sort() const
{
    double low[3], high[3];

    sorted = true;
    for (size_t v = 0; v < count; v++)
        for (size_t k = 0; k < 3; k++) {
            const double t = xyz[3 * v + k];
            low[k] = v == 0 ? t : std::fmin(low[k], t);
            high[k] = v == 0 ? t : std::fmax(high[k], t);
        }
    for (size_t k = 1; k < 3 && count > 0; k++)
        if (high[k] - low[k] > high[axis] - low[axis])
            axis = k;
    for (size_t v = 0; v < count; v++)
        if (std::isfinite(xyz[3 * v + axis]))
            order.push_back(static_cast<uint32_t>(v));
    std::sort(order.begin(), order.end(), [this](uint32_t a, uint32_t b) {
        const double x = xyz[3 * size_t{ a } + axis];
        const double y = xyz[3 * size_t{ b } + axis];
        return x != y ? x < y : a < b;
    });
}

/* From where p would be, outwards on both sides, as long as the axis alone is
 * not further than the best so far. */
uint32_t guide_points::nearest(const double p[3]) const
{
    if (!sorted)
        sort();
    const auto along = [this](size_t i) {
        return xyz[3 * size_t{ order[i] } + axis];
    };
    const auto begin = std::lower_bound(
        order.begin(), order.end(), p[axis], [this](uint32_t v, double t) {
            return xyz[3 * size_t{ v } + axis] < t;
        });
    size_t up = static_cast<size_t>(begin - order.begin()), down = up;
    double best = HUGE_VAL;
    uint32_t found = UINT32_MAX;

    const auto look = [&](size_t i) {
        const double *q = xyz + 3 * size_t{ order[i] };
        double d = 0;
        for (size_t k = 0; k < 3; k++)
            d += (q[k] - p[k]) * (q[k] - p[k]);
        if (d < best || (d == best && order[i] < found)) {
            best = d;
            found = order[i];
        }
    };
    const auto reach = [&](size_t i) {
        const double d = along(i) - p[axis];
        return d * d <= best;
    };
    for (bool more = true; more;) {
        more = false;
        if (up < order.size() && reach(up)) {
            look(up++);
            more = true;
        }
        if (down > 0 && reach(down - 1)) {
            look(--down);
            more = true;
        }
    }
    return found;
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
    const uint32_t v = points.nearest(p);

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
        const uint32_t near = from.nearest(mesh->positions + 3 * v);
        out[v] = near == UINT32_MAX ? 0.5f : values[near];
    }
    return out;
}
