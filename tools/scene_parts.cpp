/* SPDX-License-Identifier: MIT */
/* scene_parts.cpp - a glTF file in: its meshes, its document, its resources. */
#include "tools/scene_parts.h"

#include <cstdlib>
#include <memory>
#include <new>

#include "tools/gltf_document.h"

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

/* The mesh as an asset at the end of the list, unless it has to stay as it is;
 * its stream's number then. */
gltf_stream take_mesh(const gltf_model &model, size_t number,
                      const std::string &name, scene_parts *out)
{
    gltf_stream stream;
    const gltf_mesh *mesh = &model.meshes[number];
    scene_mesh *to = &out->meshes[out->mesh_count];
    asset_error error;
    bool empty;

    gltf_channels_of(&model, mesh, name.c_str(), &stream.channels, &out->notes);
    if (!stream.channels.fits) {
        asset_warn(&out->notes, "%s: its morph targets need more than %d "
                   "attributes; it is kept as it is", name.c_str(),
                   PMESH_MAX_ATTRIBUTES);
        return stream;
    }
    if (!gltf_mesh_asset(&model, mesh, &stream.channels, &to->mesh, &empty,
                         &error)) {
        if (!empty)
            fail(error);
        return stream;
    }
    snprintf(to->name, sizeof to->name, "%s", name.c_str());
    stream.number = static_cast<uint32_t>(out->mesh_count++);
    return stream;
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
            kept += p.value("mode", 4) < 4;
    if (kept > 0)
        asset_warn(notes, "%zu primitives of points or lines are kept as they "
                   "are", kept);
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

    const gltf_json in =
        gltf_json::parse(source.json, source.json + source.json_size);
    const std::vector<double> scales = gltf_scales(source);
    std::vector<gltf_stream> streams;
    out->meshes = static_cast<scene_mesh *>(
        calloc(model.mesh_count + 1, sizeof *out->meshes));
    if (!out->meshes)
        throw std::bad_alloc();
    for (size_t i = 0; i < model.mesh_count; i++) {
        streams.push_back(take_mesh(model, i, name_of(in, i), out));
        if (streams[i].number != GLTF_NONE)
            out->meshes[streams[i].number].scale =
                static_cast<float>(scales[i]);
    }
    if (out->mesh_count == 0)
        throw std::runtime_error("the scene has no triangles to refine");
    note_kept(in, &out->notes);

    const gltf_parts parts =
        gltf_take_apart(source, model, streams, budget, &out->notes);
    put(&out->document, parts.document.data(), parts.document.size());
    out->resources = static_cast<asset_bytes *>(
        calloc(parts.resources.size() + 1, sizeof *out->resources));
    if (!out->resources)
        throw std::bad_alloc();
    for (const gltf_bytes &bytes : parts.resources)
        put(&out->resources[out->resource_count++], bytes.data(),
            bytes.size());
    out->early_count = parts.early;
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
               has_looks(in);
    } catch (...) {
        return false;
    }
}

bool scene_parts_read(const uint8_t *data, size_t size, const char *path,
                      scene_parts *out, asset_error *error)
{
    gltf_source source = {};

    *out = {};
    source.path = path;
    source.everything = true;
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
    *parts = {};
}
