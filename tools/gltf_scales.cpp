/* SPDX-License-Identifier: MIT */
/*
 * gltf_scales.cpp - how much the instances of a mesh enlarge it.
 *
 * The largest of all nodes of all scenes, at rest. Of skinned meshes, whose
 * nodes do not move them, the largest of the joints. Animated scales and
 * EXT_mesh_gpu_instancing are not looked at.
 */
#include <cmath>
#include <cstring>
#include <map>

#include "tools/gltf_document.h"

namespace {

struct matrix {
    double m[16]; /* column by column */
};

const matrix identity = { { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 } };

matrix multiply(const matrix &a, const matrix &b)
{
    matrix out{};
    for (int c = 0; c < 4; c++)
        for (int r = 0; r < 4; r++)
            for (int k = 0; k < 4; k++)
                out.m[4 * c + r] += a.m[4 * k + r] * b.m[4 * c + k];
    return out;
}

/*
 * At least the largest singular value of the upper 3 x 3, and equal to it if
 * that is a rotation behind a scale along the axes: the root of the largest
 * row sum of A^T A; infinite if that is not a number.
 */
double factor(const matrix &a)
{
    double largest = 0;
    for (int i = 0; i < 3; i++) {
        double sum = 0;
        for (int j = 0; j < 3; j++) {
            double product = 0;
            for (int k = 0; k < 3; k++)
                product += a.m[4 * i + k] * a.m[4 * j + k];
            sum += std::fabs(product);
        }
        largest = sum >= 0 ? std::fmax(largest, sum) : HUGE_VAL;
    }
    return std::sqrt(largest);
}

void read(const gltf_json &node, const char *member, double *out, size_t size)
{
    const auto found = node.find(member);
    if (found == node.end() || !found->is_array() || found->size() != size)
        return;
    for (size_t i = 0; i < size; i++)
        if ((*found)[i].is_number())
            out[i] = (*found)[i].get<double>();
}

matrix local(const gltf_json &node)
{
    matrix out = identity;
    double q[4] = { 0, 0, 0, 1 }, s[3] = { 1, 1, 1 };

    if (node.contains("matrix")) {
        read(node, "matrix", out.m, 16);
        return out;
    }
    read(node, "rotation", q, 4);
    read(node, "scale", s, 3);
    const double x = q[0], y = q[1], z = q[2], w = q[3];
    const double rows[9] = {
        1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),
        2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
        2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)
    };
    for (int c = 0; c < 3; c++)
        for (int r = 0; r < 3; r++)
            out.m[4 * c + r] = rows[3 * r + c] * s[c];
    return out;
}

class measure {
public:
    measure(const gltf_source &from, gltf_sides &files, gltf_budget &expand)
        : source(from), sides(files), budget(expand)
    {
        in = gltf_json::parse(source.json, source.json + source.json_size);
        sides.read.clear();
    }
    std::vector<double> run();

private:
    const gltf_source &source;
    gltf_sides &sides;
    gltf_budget &budget;
    gltf_json in;
    std::vector<matrix> world;
    std::map<uint32_t, gltf_blob> buffers; /* loaded when needed */
    std::map<size_t, double> skins;        /* what many nodes may share */

    const gltf_json &list(const char *name) const
    {
        static const gltf_json none = gltf_json::array();
        const auto found = in.find(name);
        return found == in.end() ? none : *found;
    }
    void walk();
    matrix bind(const gltf_json &skin, size_t joint);
    double of_joints(const gltf_json &skin);
    double of_skin(size_t skin);
};

/* From the roots on; a node that is met twice keeps what it had. */
void measure::walk()
{
    const gltf_json &nodes = list("nodes");
    std::vector<bool> seen(nodes.size()), child(nodes.size());
    std::vector<size_t> queue;

    world.assign(nodes.size(), identity);
    for (const gltf_json &node : nodes)
        if (node.contains("children"))
            for (const gltf_json &c : node["children"])
                child[gltf_number_of(c)] = true;
    for (size_t i = 0; i < nodes.size(); i++)
        if (!child[i]) {
            world[i] = local(nodes[i]);
            seen[i] = true;
            queue.push_back(i);
        }
    for (size_t at = 0; at < queue.size(); at++) {
        const gltf_json &node = nodes[queue[at]];
        if (!node.contains("children"))
            continue;
        for (const gltf_json &c : node["children"]) {
            const uint32_t id = gltf_number_of(c);
            if (seen[id])
                continue;
            seen[id] = true;
            world[id] = multiply(world[queue[at]], local(nodes[id]));
            queue.push_back(id);
        }
    }
}

/* A joint's inverse bind matrix; the identity where it is not plain floats. */
matrix measure::bind(const gltf_json &skin, size_t joint)
{
    matrix out = identity;
    if (!skin.contains("inverseBindMatrices"))
        return out;
    const gltf_item accessor{
        list("accessors").at(gltf_number_of(skin["inverseBindMatrices"])),
        "accessors", 0
    };
    const uint32_t number =
        accessor.id("bufferView", list("bufferViews").size());
    if (number == GLTF_NONE || accessor.whole("componentType", 0) != GLTF_F32)
        return out;
    const gltf_item view{ list("bufferViews")[number], "bufferViews", number };
    const uint32_t buffer = view.id("buffer", list("buffers").size());
    if (buffer == GLTF_NONE || view.extension("EXT_meshopt_compression"))
        return out;
    gltf_blob &bytes = buffers[buffer];
    bool first;
    if (bytes.empty())
        bytes = gltf_load_buffer(
            source, { list("buffers")[buffer], "buffers", buffer }, sides,
            budget, &first);
    const uint64_t stride = view.whole("byteStride", 64);
    const uint64_t start = view.whole("byteOffset", 0) +
                           accessor.whole("byteOffset", 0) + joint * stride;
    if (start > bytes.size() || bytes.size() - start < 64)
        return out;
    for (int i = 0; i < 16; i++) {
        float value;
        memcpy(&value, bytes.data() + start + 4 * i, sizeof value);
        out.m[i] = std::isfinite(value) ? static_cast<double>(value) : 0;
    }
    return out;
}

double measure::of_joints(const gltf_json &skin)
{
    double largest = 0;
    if (!skin.contains("joints"))
        return 1;
    const gltf_json &joints = skin["joints"];
    for (size_t i = 0; i < joints.size(); i++) {
        const uint32_t node = gltf_number_of(joints[i]);
        if (node < world.size())
            largest = std::fmax(largest,
                                factor(multiply(world[node], bind(skin, i))));
    }
    return largest;
}

double measure::of_skin(size_t skin)
{
    const auto found = skins.find(skin);
    if (found != skins.end())
        return found->second;
    return skins[skin] = of_joints(list("skins")[skin]);
}

std::vector<double> measure::run()
{
    std::vector<double> scales(list("meshes").size());
    const gltf_json &nodes = list("nodes");
    const size_t skin_count = list("skins").size();

    walk();
    for (size_t i = 0; i < nodes.size(); i++) {
        const gltf_json &node = nodes[i];
        if (!node.contains("mesh"))
            continue;
        const uint32_t mesh = gltf_number_of(node["mesh"]);
        const uint32_t skin = node.contains("skin")
                                  ? gltf_number_of(node["skin"])
                                  : GLTF_NONE;
        const double scale =
            skin < skin_count ? of_skin(skin) : factor(world[i]);
        if (mesh < scales.size())
            scales[mesh] = std::fmax(scales[mesh], scale);
    }
    for (double &scale : scales)
        if (!(scale <= 1e30))
            scale = 1e30;
    return scales;
}

} // namespace

std::vector<double> gltf_scales(const gltf_source &source, gltf_sides &sides,
                                gltf_budget &budget)
{
    return measure(source, sides, budget).run();
}
