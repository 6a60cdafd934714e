/* SPDX-License-Identifier: MIT */
/*
 * guide_store.h - private to the guide's files: what a guide owns, and how its
 * vertices are found. Functions throw std::runtime_error.
 */
#ifndef GUIDE_STORE_H
#define GUIDE_STORE_H

#include <cmath>
#include <cstdint>
#include <list>
#include <stdexcept>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/guide.h"

using guide_json = nlohmann::json;

struct guide_store {
    std::vector<float> weights;
    std::vector<uint8_t> locks;
    std::vector<uint16_t> segments;
    std::vector<double> shares;
    std::list<std::vector<uint32_t>> lists; /* of the constraints */
    uint64_t named = 0; /* vertices in these lists */
    std::vector<pmesh_constraint> constraints;
    std::list<std::string> names;
    std::vector<guide_camera> cameras;
    std::string warning;

    /* Lets guide->use point to what is there. */
    void publish(guide *out) const;
};

struct point_box {
    double low[3] = { HUGE_VAL, HUGE_VAL, HUGE_VAL };
    double high[3] = { -HUGE_VAL, -HUGE_VAL, -HUGE_VAL };
};

/* Points in a tree, to look for the nearest. */
class guide_points {
public:
    guide_points(const double *from, size_t many) : xyz(from), count(many) {}

    /* Of equally near ones the first; UINT32_MAX if there is none. How many
     * were looked at goes to *looked. */
    uint32_t nearest(const double p[3], uint64_t *looked) const;

private:
    struct best_point {
        const double *p;
        double square; /* of its distance */
        uint32_t found;
        uint64_t looked;
    };
    struct range { /* of `order` */
        size_t node, first, last;
        bool is_leaf() const { return last - first <= 8; }
        range half(size_t second) const
        {
            const size_t middle = first + (last - first) / 2;
            return { 2 * node + second, second ? middle : first,
                     second ? last : middle };
        }
    };
    const double *xyz;
    size_t count;
    mutable bool sorted = false; /* what follows is made when first needed */
    mutable std::vector<uint32_t> order;
    mutable std::vector<point_box> boxes; /* by node */

    void sort() const;
    void part(const range &r) const;
    void look(uint32_t v, best_point *best) const;
    void search(const range &r, best_point *best) const;
};

/* Turns what a guide file says of vertices into vertices of the mesh. */
class guide_finder {
public:
    /* `source`: the file's member of that name, null if it has none. */
    guide_finder(const asset *mesh, const guide_json &source);

    /* The vertices of a "vertices", "positions", "box", "sphere", or "all"
     * member, in the order given, and how much of a brush's strength each gets
     * (1 but for spheres with a falloff). */
    std::vector<uint32_t> find(const guide_json &item, const std::string &where,
                               std::vector<double> *strength = nullptr) const;

    /* One number for each vertex of the guide's mesh, for those of this one. */
    std::vector<float> spread(const std::vector<float> &values) const;

    bool is_other() const { return other; }
    size_t count() const { return other ? theirs.size() / 3 : mesh->vertex_count; }

private:
    const asset *mesh;
    guide_points points;
    bool other = false;         /* made for another mesh */
    std::vector<double> theirs; /* its places */
    mutable uint64_t to_look_at = uint64_t{ 1 } << 32;

    /* Regions go over all vertices, and a few bytes make one more. */
    void look(uint64_t many, const std::string &where) const;
    uint32_t nearest(const double p[3], const std::string &where) const;
    uint32_t nearest_of(const guide_points &from, const double p[3],
                        const std::string &where) const;
    uint32_t vertex(const guide_json &number, const std::string &where) const;
};

/* A finite number, or complains. */
double guide_number(const guide_json &value, const std::string &where);

[[noreturn]] void guide_fail(const std::string &where, const std::string &what);

#endif
