/* SPDX-License-Identifier: MIT */
/*
 * attribute_measure.h - how far two meshes with attributes are apart.
 */
#ifndef ATTRIBUTE_MEASURE_H
#define ATTRIBUTE_MEASURE_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <new>
#include <vector>

#include "format/pmesh.h"
extern "C" {
#include "tools/surface.h"
}

using Vec = std::array<double, 3>;

struct Channel {
    pmesh_attribute_kind kind;
    std::size_t components, offset;
};

/* One index per corner; rows of attribute values. */
struct Mesh {
    std::vector<Channel> channels;
    std::size_t width = 0;
    std::vector<double> xyz;
    std::vector<float> rows;
    std::vector<std::uint32_t> tri;

    std::size_t faces() const
    {
        return tri.size() / 3;
    }
    std::size_t points() const
    {
        return xyz.size() / 3;
    }
    void add(pmesh_attribute_kind kind, std::size_t components)
    {
        channels.push_back({ kind, components, width });
        width += components;
    }
};

/* A mesh with its search tree; the frame maps positions into -1 .. 1. */
struct Searchable {
    const Mesh &mesh;
    surface tree = {};
    Searchable(const Mesh &m, const surface_frame &frame) : mesh(m)
    {
        const asset a = as_asset(m);
        if (!surface_build(&tree, &a, &frame))
            throw std::bad_alloc();
    }
    ~Searchable()
    {
        surface_free(&tree);
    }
    static asset as_asset(const Mesh &m)
    {
        asset a = {};
        a.positions = const_cast<double *>(m.xyz.data());
        a.vertex_count = m.points();
        a.indices = const_cast<std::uint32_t *>(m.tri.data());
        a.face_count = m.faces();
        return a;
    }
    Vec local(std::uint32_t p) const
    {
        const double *q = tree.points + 3 * std::size_t{ p };
        return { q[0], q[1], q[2] };
    }
};

/* Sums of squares: of distances, and of differences by kind of attribute. */
struct Sums {
    double distance = 0, kind[4] = { 0, 0, 0, 0 };
    std::size_t count = 0;
};

/* Adds what samples of one mesh find at the closest points of the other. */
void one_way(const Searchable &from, const Searchable &to, Sums *sums);

/* The first attribute of a kind, or nullptr. */
const Channel *find(const Mesh &mesh, pmesh_attribute_kind kind);

/* Faces whose texture coordinates run the other way than those of the closest
 * face of the original. */
std::size_t count_flips(const Searchable &original, const Searchable &result);

/* Edges without two faces, with positions joined. */
std::size_t count_open(const Mesh &mesh);

/* Pictures from six sides; colours below 0 are background. */
using Image = std::vector<std::array<float, 3>>;
std::vector<Image> draw_all(const Searchable &s);

/* In dB; what is background in both does not count. */
double psnr(const std::vector<Image> &a, const std::vector<Image> &b);

#endif
