/* SPDX-License-Identifier: MIT */
/*
 * bench_attributes - what simplification does to attributes.
 *
 *   bench_attributes MODEL DIR PERCENT...
 *
 * MODEL is a mesh file with attributes, or "gouraud": a sphere with smooth and
 * with sharp colours. Simplified to each percentage of the faces by
 *
 *   joint           pmesh_simplify_mesh(), attributes in the quadrics
 *   geometry        the same without: attributes are interpolated on the edges
 *   joint-subset, geometry-subset   both onto vertices of the input
 *   bake-joint, bake-geometry       levels of a .pmesh file, baked with and
 *                   without weights, otherwise as by default
 *   bake-optimal-joint, bake-optimal-geometry   with optimal placement
 *   meshopt         meshopt_simplifyWithAttributes of the package MESHOPT_JS
 *                   names (a path to meshopt_simplifier.js; needs node), with
 *                   the same weights, by way of files in DIR
 *   meshopt-update  meshopt_simplifyWithUpdate, which moves vertices
 *
 * TOOLS="joint bake-joint" takes some of them. Writes a line of CSV each:
 *
 *   model,tool,percent,target,faces,rms,normal,texcoord,color,psnr,flips,open
 *
 * rms is the two-sided distance by the diagonal; the attributes' the root mean
 * square of the difference at closest points, both ways, of unit vectors and of
 * values (texture coordinates: by the largest extent of theirs). psnr compares
 * drawings from six sides: a wavy texture over the coordinates, colours, light
 * by normals. flips: faces whose texture coordinates run the other way than
 * those of the closest face of the original. open: edges without two faces,
 * with positions joined.
 */
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "decoder/pmesh_decode.h"
#include "encoder/pmesh_encode.h"
extern "C" {
#include "tools/corners.h"
#include "tools/load.h"
#include "tools/surface.h"
}
#include "tests/bench/attribute_measure.h"

namespace
{

const struct {
    pmesh_attribute_kind kind;
    float weight;
} weights[] = { { PMESH_NORMAL, 0.01f },
                { PMESH_TEXCOORD, 0.1f },
                { PMESH_COLOR, 0.03f },
                { PMESH_GENERIC, 0.03f } };

float weight_of(pmesh_attribute_kind kind)
{
    static const char *const names[] = { "W_NORMAL", "W_UV", "W_COLOR", "W" };
    const char *text = std::getenv(names[kind]);
    return text ? static_cast<float>(std::atof(text)) : weights[kind].weight;
}

Mesh read_mesh(const std::string &path)
{
    asset in;
    asset_error error;
    corners split;
    if (load_mesh(path.c_str(), &in, &error) != 0)
        throw std::runtime_error(path + ": " + error.what);
    if (!corners_unify(&in, &split))
        throw std::bad_alloc();
    Mesh mesh;
    for (std::size_t i = 0; i < in.attribute_count; i++)
        mesh.add(in.attributes[i].kind, in.attributes[i].components);
    for (std::size_t p = 0; p < split.count; p++) {
        const std::size_t corner = split.first[p];
        const double *at = in.positions + 3 * std::size_t{ in.indices[corner] };
        mesh.xyz.insert(mesh.xyz.end(), at, at + 3);
        for (std::size_t i = 0; i < in.attribute_count; i++) {
            const float *v = corners_values(&in, &in.attributes[i], corner);
            mesh.rows.insert(mesh.rows.end(), v,
                             v + in.attributes[i].components);
        }
    }
    mesh.tri.assign(split.points, split.points + 3 * in.face_count);
    corners_free(&split);
    asset_free(&in);
    return mesh;
}

Mesh gouraud()
{
    const std::uint32_t w = 200, h = 100;
    const double pi = std::acos(-1.0);
    Mesh mesh;
    mesh.add(PMESH_COLOR, 3);
    for (std::uint32_t j = 0; j <= h; j++)
        for (std::uint32_t i = 0; i < w; i++) {
            const double u = 2 * pi * i / w, v = pi * j / h;
            const double p[3] = { std::sin(v) * std::cos(u),
                                  std::sin(v) * std::sin(u), std::cos(v) };
            mesh.xyz.insert(mesh.xyz.end(), p, p + 3);
            const double spot = std::sin(5 * p[0]) * std::sin(5 * p[1]) > 0.3;
            mesh.rows.push_back(static_cast<float>(0.5 + 0.5 * p[2]));
            mesh.rows.push_back(static_cast<float>(spot));
            mesh.rows.push_back(
                static_cast<float>(0.5 + 0.4 * std::sin(9 * p[0])));
        }
    for (std::uint32_t j = 0; j < h; j++)
        for (std::uint32_t i = 0; i < w; i++) {
            const std::uint32_t a = j * w + i, b = j * w + (i + 1) % w;
            for (std::uint32_t c : { a, a + w, b, b, a + w, b + w })
                mesh.tri.push_back(c);
        }
    return mesh;
}

/* ---- simplification ------------------------------------------------------ */

Mesh ours(const Mesh &in, std::size_t target, bool joint, bool subset)
{
    Mesh out = in;
    std::vector<std::vector<float>> own;
    std::vector<pmesh_simplify_attribute> attributes;
    pmesh_simplify_output to = {};
    for (const Channel &c : in.channels) {
        own.emplace_back();
        for (std::size_t p = 0; p < in.points(); p++)
            for (std::size_t k = 0; k < c.components; k++)
                own.back().push_back(in.rows[p * in.width + c.offset + k]);
    }
    for (std::size_t i = 0; i < own.size(); i++) {
        const float weight = joint ? weight_of(in.channels[i].kind) : 0;
        attributes.push_back(
            { in.channels[i].kind,
              static_cast<std::uint8_t>(in.channels[i].components),
              own[i].data(),
              0,
              { weight, weight, weight, weight } });
        to.attribute_values[i] = own[i].data();
    }
    const std::vector<std::vector<float>> before = own;
    for (std::size_t i = 0; i < own.size(); i++)
        attributes[i].values = before[i].data();
    pmesh_simplify_input mesh = {};
    mesh.indices = in.tri.data();
    mesh.face_count = in.faces();
    mesh.vertex_count = in.points();
    mesh.doubles = in.xyz.data();
    mesh.attributes = attributes.data();
    mesh.attribute_count = attributes.size();
    pmesh_simplify_options options = pmesh_simplify_options_default();
    options.faces = target;
    if (subset)
        options.placement = PMESH_PLACE_ENDPOINT;
    to.indices = out.tri.data();
    to.positions = out.xyz.data();
    const pmesh_status status = pmesh_simplify_mesh(&mesh, &options, &to);
    if (status != PMESH_OK)
        throw std::runtime_error(pmesh_status_text(status));
    out.tri.resize(3 * to.face_count);
    for (std::size_t i = 0; i < own.size(); i++) {
        const Channel &c = in.channels[i];
        for (std::size_t p = 0; p < in.points(); p++)
            for (std::size_t k = 0; k < c.components; k++)
                out.rows[p * in.width + c.offset + k] =
                    own[i][p * c.components + k];
    }
    return out;
}

int collect(void *user, const void *data, std::size_t size)
{
    auto *file = static_cast<std::vector<std::uint8_t> *>(user);
    const auto *bytes = static_cast<const std::uint8_t *>(data);
    file->insert(file->end(), bytes, bytes + size);
    return 0;
}

std::vector<std::uint8_t> bake(const Mesh &in, bool joint, bool optimal)
{
    std::vector<pmesh_attribute_input> attributes;
    std::uint8_t sets[4] = { 0, 0, 0, 0 };
    for (const Channel &c : in.channels) {
        pmesh_attribute_input a = {};
        a.kind = c.kind;
        a.set = sets[c.kind]++;
        a.components = static_cast<std::uint8_t>(c.components);
        a.values = in.rows.data() + c.offset;
        a.stride = in.width * sizeof(float);
        a.count = in.points();
        a.weight = joint && c.kind != PMESH_GENERIC ? weight_of(c.kind) : -1;
        attributes.push_back(a);
    }
    pmesh_mesh_input mesh = {};
    mesh.positions = in.xyz.data();
    mesh.vertex_count = in.points();
    mesh.indices = in.tri.data();
    mesh.face_count = in.faces();
    mesh.attributes = attributes.data();
    mesh.attribute_count = attributes.size();
    pmesh_encoder_config config = pmesh_encoder_config_default();
    if (optimal)
        config.placement = PMESH_OPTIMAL;
    std::vector<std::uint8_t> file;
    const pmesh_status status =
        pmesh_encode(&mesh, &config, collect, &file, nullptr);
    if (status != PMESH_OK)
        throw std::runtime_error(pmesh_status_text(status));
    std::cerr << "    " << (joint ? "joint" : "geometry")
              << (optimal ? ", optimal: " : ": ") << file.size() << " bytes\n";
    return file;
}

/* A level of a file. */
Mesh baked(const Mesh &in, std::size_t target, bool joint, bool optimal)
{
    const std::vector<std::uint8_t> file = bake(in, joint, optimal);
    pmesh_decoder *dec;
    pmesh_view view;
    pmesh_target to = {};
    to.faces = static_cast<std::uint32_t>(target);
    if (pmesh_decoder_create(&dec, nullptr) != PMESH_OK ||
        pmesh_decoder_feed(dec, file.data(), file.size()) != PMESH_OK ||
        pmesh_decoder_refine(dec, &to, nullptr) < 0 ||
        pmesh_decoder_mesh(dec, &view) != PMESH_OK)
        throw std::runtime_error("a baked file does not decode");
    Mesh out;
    out.channels = in.channels;
    out.width = in.width;
    out.tri.assign(view.indices, view.indices + 3 * view.face_count);
    std::vector<float> xyz(3 * std::size_t{ view.vertex_count });
    pmesh_decoder_copy_positions(dec, xyz.data(), 0);
    out.xyz.assign(xyz.begin(), xyz.end());
    out.rows.resize(out.width * view.vertex_count);
    for (std::size_t i = 0; i < in.channels.size(); i++)
        pmesh_decoder_copy_attribute(dec, static_cast<std::uint32_t>(i),
                                     out.rows.data() + in.channels[i].offset,
                                     out.width * sizeof(float));
    pmesh_decoder_destroy(dec);
    return out;
}

template <typename T>
void dump(const std::string &path, const std::vector<T> &data)
{
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char *>(data.data()),
               static_cast<std::streamsize>(data.size() * sizeof(T)));
    if (!file.flush())
        throw std::runtime_error(path + ": cannot be written");
}

template <typename T> std::vector<T> slurp(const std::string &path)
{
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    std::vector<T> data(static_cast<std::size_t>(file.tellg()) / sizeof(T));
    file.seekg(0);
    file.read(reinterpret_cast<char *>(data.data()),
              static_cast<std::streamsize>(data.size() * sizeof(T)));
    if (!file)
        throw std::runtime_error(path + ": cannot be read");
    return data;
}

Mesh meshopt(const Mesh &in, std::size_t target, const std::string &dir,
             bool update)
{
    std::string list;
    for (const Channel &c : in.channels)
        for (std::size_t k = 0; k < c.components; k++)
            list +=
                (list.empty() ? "" : ",") + std::to_string(weight_of(c.kind));
    dump(dir + "/indices", in.tri);
    dump(dir + "/positions", std::vector<float>(in.xyz.begin(), in.xyz.end()));
    dump(dir + "/attributes", in.rows);
    const std::string command =
        "node tests/bench/attributes.mjs \"" + dir + "\" " + list + " " +
        std::to_string(3 * target) + (update ? " update" : "");
    if (std::system(command.c_str()) != 0)
        throw std::runtime_error("node failed");
    Mesh out = in;
    out.tri = slurp<std::uint32_t>(dir + "/indices");
    if (update) {
        const std::vector<float> xyz = slurp<float>(dir + "/positions");
        out.xyz.assign(xyz.begin(), xyz.end());
        out.rows = slurp<float>(dir + "/attributes");
    }
    return out;
}

/* ---- all ----------------------------------------------------------------- */

double uv_extent(const Mesh &mesh)
{
    const Channel *c = find(mesh, PMESH_TEXCOORD);
    double extent = 0;
    for (std::size_t k = 0; c && k < 2; k++) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (std::size_t p = 0; p < mesh.points(); p++) {
            const double v =
                static_cast<double>(mesh.rows[p * mesh.width + c->offset + k]);
            low = std::min(low, v);
            high = std::max(high, v);
        }
        extent = std::max(extent, high - low);
    }
    return extent > 0 ? extent : 1;
}

std::vector<std::string> tool_names()
{
    std::vector<std::string> tools = { "joint",
                                       "geometry",
                                       "joint-subset",
                                       "geometry-subset",
                                       "bake-joint",
                                       "bake-geometry",
                                       "bake-optimal-joint",
                                       "bake-optimal-geometry" };
    if (std::getenv("MESHOPT_JS")) {
        tools.push_back("meshopt");
        tools.push_back("meshopt-update");
    }
    if (const char *some = std::getenv("TOOLS")) {
        std::istringstream words(some);
        tools.assign(std::istream_iterator<std::string>(words), {});
    }
    return tools;
}

Mesh simplified(const Mesh &in, std::size_t target, const std::string &tool,
                const std::string &dir)
{
    auto has = [&](const char *word) {
        return tool.find(word) != std::string::npos;
    };
    if (has("meshopt"))
        return meshopt(in, target, dir, has("update"));
    if (has("bake"))
        return baked(in, target, has("joint"), has("optimal"));
    return ours(in, target, has("joint"), has("subset"));
}

void run(const std::string &model, const std::string &dir, int count,
         char **percents)
{
    const Mesh in = model == "gouraud" ? gouraud() : read_mesh(model);
    const asset whole = Searchable::as_asset(in);
    const asset *list[] = { &whole };
    surface_frame frame;
    if (!surface_frame_of(list, 1, &frame))
        throw std::runtime_error("nothing to measure");
    const Searchable original(in, frame);
    const std::vector<Image> images = draw_all(original);
    const std::vector<std::string> tools = tool_names();
    std::string name = model.substr(model.rfind('/') + 1);
    name = name.substr(0, name.rfind('.'));
    for (int i = 0; i < count; i++) {
        const auto target = static_cast<std::size_t>(std::lround(
            static_cast<double>(in.faces()) * std::atof(percents[i]) / 100));
        for (const std::string &tool : tools) {
            const Mesh out = simplified(in, target, tool, dir);
            const Searchable result(out, frame);
            Sums sums;
            one_way(original, result, &sums);
            one_way(result, original, &sums);
            auto root = [&](double sum) {
                return std::sqrt(sum / static_cast<double>(sums.count));
            };
            std::printf("%s,%s,%s,%zu,%zu,%.4g,%.4g,%.4g,%.4g,%.2f,%zu,%zu\n",
                        name.c_str(), tool.c_str(), percents[i], target,
                        out.faces(),
                        root(sums.distance) / original.tree.diagonal,
                        root(sums.kind[PMESH_NORMAL]),
                        root(sums.kind[PMESH_TEXCOORD]) / uv_extent(in),
                        root(sums.kind[PMESH_COLOR]), psnr(images, draw_all(result)),
                        count_flips(original, result), count_open(out));
            std::fflush(stdout);
        }
    }
}

} // namespace

int main(int argc, char **argv)
{
    if (argc < 4) {
        std::cerr << "usage: bench_attributes MODEL DIR PERCENT...\n";
        return 2;
    }
    try {
        run(argv[1], argv[2], argc - 3, argv + 3);
    } catch (const std::exception &e) {
        std::cerr << "bench_attributes: " << e.what() << '\n';
        return 1;
    }
    return 0;
}
