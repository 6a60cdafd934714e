/* SPDX-License-Identifier: MIT */
/*
 * io_gltf.cpp - the bridge to tinygltf: a plain document into C structs.
 *
 * tinygltf is compiled here, under another name: Debian's libdraco exports the
 * symbols of a second tinygltf, and linked together they crash. It never sees
 * the stranger's bytes, for it reads out of bounds on damaged files.
 */
#include <algorithm>
#include <map>
#include <memory>
#include <new>

#include "tools/gltf_plain.h"

#define tinygltf pmesh_tinygltf
#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_INCLUDE_JSON
#define TINYGLTF_NO_INCLUDE_STB_IMAGE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE_WRITE
#include <tiny_gltf.h>

namespace {

using tinygltf::Accessor;
using tinygltf::BufferView;
using tinygltf::Model;

/* What a gltf_model points into. */
struct owner {
    Model model;
    std::vector<gltf_blob> blobs;
    std::set<std::string> sides;
    std::vector<gltf_accessor> accessors;
    std::vector<gltf_primitive> primitives;
    std::vector<gltf_mesh> meshes;
    std::vector<gltf_node> nodes;
    std::vector<gltf_named> named;
    std::vector<gltf_set> sets;
    std::vector<uint32_t> children, roots;
    std::vector<const char *> names;
};

/* The text names no file and holds no buffer: nothing else is read. */
void load_model(const gltf_plain &plain, Model *model)
{
    tinygltf::TinyGLTF loader;
    std::string error, warning;

    if (plain.text.size() > UINT32_MAX)
        throw std::runtime_error("the JSON part is too large");
    if (!loader.LoadASCIIFromString(
            model, &error, &warning, plain.text.data(),
            static_cast<unsigned>(plain.text.size()), "",
            tinygltf::NO_REQUIRE))
        throw std::runtime_error(error.empty() ? "unreadable glTF" : error);
}

/* A list's element number, or GLTF_NONE for tinygltf's -1. */
uint32_t to_id(int number, size_t limit)
{
    if (number < 0)
        return GLTF_NONE;
    if (static_cast<size_t>(number) >= limit)
        throw std::runtime_error("a reference is out of range");
    return static_cast<uint32_t>(number);
}

gltf_view view_from(const owner &o, int number, uint64_t offset,
                    uint32_t *stride)
{
    if (number < 0)
        return { nullptr, 0 };
    const BufferView &view =
        o.model.bufferViews.at(static_cast<size_t>(number));
    const gltf_blob &data = o.blobs.at(static_cast<size_t>(view.buffer));
    if (view.byteOffset > data.size() ||
        view.byteLength > data.size() - view.byteOffset ||
        offset > view.byteLength)
        throw std::runtime_error("an accessor begins past its buffer view");
    if (stride)
        *stride = static_cast<uint32_t>(view.byteStride);
    return { data.data() + view.byteOffset + offset, view.byteLength - offset };
}

gltf_accessor convert(const owner &o, const Accessor &from)
{
    gltf_accessor to{};

    to.number = static_cast<uint32_t>(std::stoul(from.name));
    to.view = view_from(o, from.bufferView, from.byteOffset, &to.stride);
    to.count = from.count;
    to.type = static_cast<uint32_t>(from.componentType);
    to.components = static_cast<uint8_t>(
        tinygltf::GetNumComponentsInType(static_cast<uint32_t>(from.type)));
    to.normalised = from.normalized;
    if (!from.sparse.isSparse)
        return to;
    const auto &sparse = from.sparse;
    to.sparse_count = static_cast<uint64_t>(sparse.count);
    to.sparse_type = static_cast<uint32_t>(sparse.indices.componentType);
    to.sparse_indices =
        view_from(o, sparse.indices.bufferView,
                  static_cast<uint64_t>(sparse.indices.byteOffset), nullptr);
    to.sparse_values =
        view_from(o, sparse.values.bufferView,
                  static_cast<uint64_t>(sparse.values.byteOffset), nullptr);
    return to;
}

/* The names stay in the model, which is not touched any more. */
void add_set(owner &o, const std::map<std::string, int> &attributes)
{
    o.sets.push_back({ o.named.size(), attributes.size() });
    for (const auto &[name, number] : attributes)
        o.named.push_back(
            { name.c_str(), to_id(number, o.accessors.size()) });
}

void convert_meshes(owner &o)
{
    const Model &model = o.model;

    for (const tinygltf::Mesh &mesh : model.meshes) {
        o.meshes.push_back({ o.primitives.size(), mesh.primitives.size() });
        for (const tinygltf::Primitive &from : mesh.primitives) {
            gltf_primitive to{};
            to.mode = static_cast<uint32_t>(from.mode);
            to.position = GLTF_NONE;
            to.indices = to_id(from.indices, o.accessors.size());
            to.material = to_id(from.material, model.materials.size());
            std::fill_n(to.slots, GLTF_SLOTS, GLTF_NONE);
            for (const auto &[name, number] : from.attributes) {
                const uint32_t id = to_id(number, o.accessors.size());
                const int slot = gltf_slot(name.c_str());
                if (name == "POSITION")
                    to.position = id;
                else if (slot >= 0)
                    to.slots[slot] = id;
            }
            to.first_set = o.sets.size();
            to.set_count = 1 + from.targets.size();
            add_set(o, from.attributes);
            for (const auto &target : from.targets)
                add_set(o, target);
            o.primitives.push_back(to);
        }
    }
}

void copy_numbers(const std::vector<double> &from, double *to, size_t count)
{
    if (from.size() == count)
        std::copy(from.begin(), from.end(), to);
}

void convert_nodes(owner &o)
{
    const Model &model = o.model;

    for (const tinygltf::Node &from : model.nodes) {
        gltf_node to{};
        to.mesh = to_id(from.mesh, o.meshes.size());
        to.first = o.children.size();
        to.count = from.children.size();
        for (const int child : from.children)
            o.children.push_back(to_id(child, model.nodes.size()));
        to.has_matrix = from.matrix.size() == 16;
        to.rotation[3] = 1.0;
        std::fill_n(to.scale, 3, 1.0);
        copy_numbers(from.matrix, to.matrix, 16);
        copy_numbers(from.translation, to.translation, 3);
        copy_numbers(from.rotation, to.rotation, 4);
        copy_numbers(from.scale, to.scale, 3);
        o.nodes.push_back(to);
    }
    for (const int root : model.scenes.at(0).nodes)
        o.roots.push_back(to_id(root, model.nodes.size()));
}

/* Names become C strings: nothing in them may end one or break a line. */
void convert_materials(owner &o)
{
    for (tinygltf::Material &material : o.model.materials) {
        for (char &c : material.name) {
            if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F)
                c = '_';
        }
        o.names.push_back(material.name.c_str());
    }
}

void fill(const gltf_source &source, gltf_budget &budget, asset *warnings,
          gltf_model *out)
{
    auto o = std::make_unique<owner>();
    gltf_plain plain = gltf_make_plain(source, budget, warnings);

    load_model(plain, &o->model);
    o->blobs = std::move(plain.blobs);
    o->sides = std::move(plain.sides);
    for (const Accessor &from : o->model.accessors)
        o->accessors.push_back(convert(*o, from));
    convert_meshes(*o);
    convert_nodes(*o);
    convert_materials(*o);
    *out = {};
    out->accessors = o->accessors.data();
    out->primitives = o->primitives.data();
    out->meshes = o->meshes.data();
    out->nodes = o->nodes.data();
    out->named = o->named.data();
    out->sets = o->sets.data();
    out->children = o->children.data();
    out->roots = o->roots.data();
    out->materials = o->names.data();
    out->accessor_count = o->accessors.size();
    out->primitive_count = o->primitives.size();
    out->mesh_count = o->meshes.size();
    out->node_count = o->nodes.size();
    out->root_count = o->roots.size();
    out->material_count = o->names.size();
    out->byte_count = plain.byte_count;
    out->owner = o.release();
}

} // namespace

const std::set<std::string> &gltf_sides_of(const gltf_model &model)
{
    return static_cast<const owner *>(model.owner)->sides;
}

bool gltf_load(const gltf_source *source, gltf_budget *budget, gltf_model *out,
               asset *warnings, asset_error *error)
{
    try {
        fill(*source, *budget, warnings, out);
        return true;
    } catch (const gltf_json::parse_error &e) {
        const std::string where = "byte " + std::to_string(e.byte);
        return asset_fail(error, where.c_str(), "not valid JSON");
    } catch (const gltf_json::out_of_range &) {
        return asset_fail(error, "", "a number in the JSON is too large");
    } catch (const std::bad_alloc &) {
        return asset_fail(error, "", "out of memory");
    } catch (const std::exception &e) {
        return asset_fail(error, "", "%s", e.what());
    } catch (...) {
        return asset_fail(error, "", "unreadable glTF");
    }
}

void gltf_unload(gltf_model *model)
{
    delete static_cast<owner *>(model->owner);
    *model = {};
}
