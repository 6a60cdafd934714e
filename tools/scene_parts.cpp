/* SPDX-License-Identifier: MIT */
/* scene_parts.cpp - a glTF file in: its meshes, its document, its resources. */
#include "tools/scene_parts.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <utility>

#include "tools/exhausted.h"
#include "tools/gltf_document.h"
#include "tools/pack.h"

namespace {

/* A loaded model, unloaded in any case. */
struct holder {
    gltf_model model = {};
    bool loaded = false;

    ~holder()
    {
        for (size_t i = 0; loaded && i < model.accessor_count; i++)
            free(model.accessors[i].expanded);
        if (loaded)
            gltf_unload(&model);
    }
};

[[noreturn]] void fail(const asset_error &error)
{
    throw std::runtime_error(std::string(error.where) +
                             (error.where[0] ? ": " : "") + error.what);
}

std::string name_of(const gltf_json &in, size_t mesh)
{
    std::string text = "mesh " + std::to_string(mesh);
    const auto name = in["meshes"][mesh].find("name");
    if (name != in["meshes"][mesh].end() && name->is_string())
        text += " (" + name->get<std::string>().substr(0, 40) + ")";
    return text;
}

/* Whether two primitives have a face in common: a decal upon another material,
 * of which one stream would keep one. Faces are told by a hash. */
bool share_faces(const asset &mesh)
{
    std::vector<std::pair<uint64_t, uint32_t>> faces(mesh.face_count);

    for (size_t f = 0; f < mesh.face_count; f++) {
        uint64_t corner[3];
        for (size_t k = 0; k < 3; k++) {
            const double *p =
                mesh.positions + 3 * size_t{ mesh.indices[3 * f + k] };
            corner[k] = 14695981039346656037u;
            for (size_t i = 0; i < 3; i++) {
                uint64_t bits;
                const double value = p[i] + 0.0; /* -0 is 0 */
                memcpy(&bits, &value, sizeof bits);
                corner[k] = (corner[k] ^ bits) * 0x9E3779B97F4A7C15u;
                corner[k] ^= corner[k] >> 29;
            }
        }
        std::rotate(corner, std::min_element(corner, corner + 3), corner + 3);
        faces[f] = { (corner[0] * 3 + corner[1]) * 0xD6E8FEB86659FD93u +
                         corner[2],
                     mesh.materials[f] };
    }
    std::sort(faces.begin(), faces.end());
    for (size_t f = 1; f < faces.size(); f++)
        if (faces[f].first == faces[f - 1].first &&
            faces[f].second != faces[f - 1].second)
            return true;
    return false;
}

/* One stream in the making, for some primitives of a mesh. */
class streamer {
public:
    streamer(const gltf_model &from, scene_parts *to,
             std::vector<gltf_stream> *of)
        : model(from), budget(gltf_budget_for(from.byte_count)), out(to),
          streams(of)
    {
    }
    void take(size_t number, const std::string &name);

private:
    const gltf_model &model;
    gltf_budget budget; /* of all meshes together */
    scene_parts *out;
    std::vector<gltf_stream> *streams; /* by primitive */

    bool add(const gltf_mesh &mesh, const std::string &name, bool whole);
};

/* Adds the primitives of `mesh` as one stream, unless they have to stay as they
 * are. False if they are not to be one stream, but `whole` asks for that. */
bool streamer::add(const gltf_mesh &mesh, const std::string &name, bool whole)
{
    scene_mesh *to = &out->meshes[out->mesh_count];
    gltf_stream stream;
    asset_error error;
    bool empty;

    if (!gltf_channels_of(&model, &mesh, name.c_str(), &budget,
                          &stream.channels, &out->notes, &error))
        fail(error);
    if (!stream.channels.fits) {
        asset_warn(&out->notes, "%s: its morph targets need more than %d "
                   "attributes; it is kept as it is", name.c_str(),
                   PMESH_MAX_ATTRIBUTES);
        return true;
    }
    if (!gltf_mesh_asset(&model, &mesh, &stream.channels, &budget, &to->mesh,
                         &empty, &error)) {
        if (!empty)
            fail(error);
        return true;
    }
    if (whole && share_faces(to->mesh)) {
        asset_free(&to->mesh);
        to->mesh = {};
        return false;
    }
    snprintf(to->name, sizeof to->name, "%s", name.c_str());
    stream.number = static_cast<uint32_t>(out->mesh_count++);
    for (size_t k = mesh.first; k < mesh.first + mesh.count; k++)
        if (gltf_is_coded(&model.primitives[k])) {
            (*streams)[k] = stream;
            stream.material++;
        }
    return true;
}

void streamer::take(size_t number, const std::string &name)
{
    const gltf_mesh &mesh = model.meshes[number];

    if (add(mesh, name, true))
        return;
    asset_warn(&out->notes, "%s: primitives share faces, and are refined each "
               "for itself", name.c_str());
    for (size_t k = 0; k < mesh.count; k++)
        add({ mesh.first + k, 1 }, name, false);
}

void put(asset_bytes *to, const void *data, size_t size)
{
    asset_put(to, data, size);
    if (to->failed)
        throw std::bad_alloc();
}

void note_kept(const gltf_json &in, asset *notes)
{
    size_t kept = 0;
    for (const gltf_json &mesh : in["meshes"])
        for (const gltf_json &p : mesh["primitives"])
            kept += p.contains("mode") && gltf_number_of(p["mode"]) < 4;
    if (kept > 0)
        asset_warn(notes, "%zu primitives of points or lines are kept as they "
                   "are", kept);
}

/* They are kept as they are, and whoever takes meshes out walks over them. */
void check_nodes(const gltf_model &model)
{
    gltf_instance *instances = nullptr;
    size_t count = 0;
    asset_error error = {};

    const bool tree = gltf_scene_walk(&model, &instances, &count, &error);
    free(instances);
    if (!tree)
        fail(error);
}

/* The document is parsed anew by each who reads it, and let go of: parsed, it
 * takes up to twenty times its size. */
void take_meshes(const gltf_source &source, const gltf_model &model,
                 gltf_sides &sides, gltf_budget &budget, scene_parts *out,
                 std::vector<gltf_stream> *streams)
{
    const std::vector<double> scales = gltf_scales(source, sides, budget);
    const gltf_json in =
        gltf_json::parse(source.json, source.json + source.json_size);
    streamer taker(model, out, streams);

    out->meshes = static_cast<scene_mesh *>(
        calloc(model.primitive_count + 1, sizeof *out->meshes));
    if (!out->meshes)
        throw std::bad_alloc();
    for (size_t i = 0; i < model.mesh_count; i++) {
        const size_t first = out->mesh_count;
        taker.take(i, name_of(in, i));
        for (size_t k = first; k < out->mesh_count; k++)
            out->meshes[k].scale = static_cast<float>(scales[i]);
    }
    if (out->mesh_count == 0)
        throw std::runtime_error("the scene has no triangles to refine");
    note_kept(in, &out->notes);
}

/* Packed, unless it packs so well that none would dare to unpack it. */
void take_document(const std::string &text, scene_parts *out)
{
    gltf_source source = {};
    asset unused = {};
    asset_error error = {};

    if (!pack_zlib(text.data(), text.size(), &out->document))
        throw std::bad_alloc();
    if (!gltf_open(reinterpret_cast<const uint8_t *>(text.data()), text.size(),
                   &source, &unused, &error))
        fail(error);
    out->packed = gltf_fits_stored(&source, out->document.size);
    if (!out->packed) {
        out->document.size = 0;
        put(&out->document, text.data(), text.size());
    }
}

void read(const gltf_source &source, holder *held, scene_parts *out)
{
    gltf_budget budget = gltf_budget_for(source.file_size);
    asset_error error = {};

    held->loaded = gltf_load(&source, &budget, &held->model, &out->notes,
                             &error);
    if (!held->loaded)
        fail(error);
    const gltf_model &model = held->model;
    for (size_t i = 0; i < model.accessor_count; i++)
        if (!gltf_accessor_prepare(&model.accessors[i], &budget, &error))
            fail(error);
    check_nodes(model);

    std::vector<gltf_stream> streams(model.primitive_count);
    gltf_sides sides = { gltf_sides_of(model), {} };
    take_meshes(source, model, sides, budget, out, &streams);
    const gltf_parts parts =
        gltf_take_apart(source, model, streams, sides, budget, &out->notes);
    take_document(parts.document, out);
    out->resources = static_cast<asset_bytes *>(
        calloc(parts.resources.size() + 1, sizeof *out->resources));
    if (!out->resources)
        throw std::bad_alloc();
    for (const gltf_bytes &bytes : parts.resources)
        put(&out->resources[out->resource_count++], bytes.data(),
            bytes.size());
    out->early_count = parts.early;
    put(&out->outside, parts.outside.c_str(), parts.outside.size() + 1);
}

bool is_list(const gltf_json &in, const char *name, size_t least)
{
    const auto found = in.find(name);
    return found != in.end() && found->is_array() && found->size() >= least;
}

/* Whether a material is more than a name. */
bool has_looks(const gltf_json &in)
{
    if (!is_list(in, "materials", 1))
        return false;
    for (const gltf_json &material : in["materials"])
        if (material.size() > material.count("name"))
            return true;
    return false;
}

/* Whether some primitive has an attribute of its author's own. */
bool has_own_attributes(const gltf_json &in)
{
    if (!is_list(in, "meshes", 1))
        return false;
    for (const gltf_json &mesh : in["meshes"]) {
        if (!mesh.is_object() || !is_list(mesh, "primitives", 1))
            continue;
        for (const gltf_json &p : mesh["primitives"])
            if (p.is_object() && p.contains("attributes"))
                for (const auto &item : p["attributes"].items())
                    if (item.key()[0] == '_')
                        return true;
    }
    return false;
}

} // namespace

bool scene_is_worth_it(const uint8_t *data, size_t size)
{
    gltf_source source = {};
    asset notes = {};
    asset_error error;

    if (!gltf_open(data, size, &source, &notes, &error))
        return false;
    try {
        const gltf_json in =
            gltf_json::parse(source.json, source.json + source.json_size);
        if (!in.is_object())
            return false;
        for (const char *list : { "images", "skins", "animations", "cameras" })
            if (is_list(in, list, 1))
                return true;
        return is_list(in, "meshes", 2) || is_list(in, "scenes", 2) ||
               is_list(in, "nodes", 2) || in.contains("extensions") ||
               has_looks(in) || has_own_attributes(in);
    } catch (const std::bad_alloc &) {
        exhausted_end(); /* "no" would be another file, without a word */
    } catch (...) {
        return false;
    }
}

bool scene_parts_read(const uint8_t *data, size_t size, const char *path,
                      bool leave_images, scene_parts *out, asset_error *error)
{
    gltf_source source = {};

    *out = {};
    source.path = path;
    source.everything = true;
    source.leave_images = leave_images;
    if (!gltf_open(data, size, &source, &out->notes, error))
        return false;
    try {
        holder held;
        read(source, &held, out);
        return true;
    } catch (const std::bad_alloc &) {
        asset_fail(error, "", "out of memory");
    } catch (const std::exception &e) {
        asset_fail(error, "", "%s", e.what());
    } catch (...) {
        asset_fail(error, "", "unreadable glTF");
    }
    scene_parts_free(out);
    return false;
}

void scene_parts_free(scene_parts *parts)
{
    for (size_t i = 0; i < parts->mesh_count; i++)
        asset_free(&parts->meshes[i].mesh);
    for (size_t i = 0; i < parts->resource_count; i++)
        asset_bytes_free(&parts->resources[i]);
    free(parts->meshes);
    free(parts->resources);
    asset_bytes_free(&parts->document);
    asset_bytes_free(&parts->outside);
    *parts = {};
}
