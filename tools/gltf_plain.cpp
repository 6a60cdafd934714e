/* SPDX-License-Identifier: MIT */
/*
 * gltf_plain.cpp - from a stranger's JSON to a plain document.
 *
 * The new document is built on demand, from the primitives down to the
 * buffers: what no triangle needs (images, animations, skins, unused accessors)
 * is never looked at, and everything else passes through a check on its way.
 */
#include "tools/gltf_plain.h"

#include <filesystem>

namespace {

/* Made when it is first asked for: before main() nobody tells of memory that
 * lacks. */
const gltf_json &no_items()
{
    static const gltf_json none = gltf_json::array();
    return none;
}

const char *const types[] = { "SCALAR", "VEC2", "VEC3", "VEC4" };

std::string quoted(const std::string &name)
{
    return "\"" + name.substr(0, 60) + "\"";
}

class builder {
public:
    builder(const gltf_source &from, gltf_budget &expand, asset *warn);
    gltf_plain build();

private:
    const gltf_source &source;
    gltf_budget &budget;
    asset *warnings;
    gltf_json in, out;
    gltf_plain plain;
    gltf_sides sides;
    /* From a number in `in` to one in `out`; GLTF_NONE: not needed yet. */
    std::vector<uint32_t> buffer_ids, view_ids, accessor_ids;
    bool skipped_mode = false, skipped_targets = false, skipped_skin = false;

    const gltf_json &list(const char *name) const;
    gltf_item item(const char *name, size_t number) const;
    uint32_t add(const char *name, gltf_json value);

    void check_version() const;
    void check_extensions();
    gltf_blob load(const gltf_item &buffer);
    uint32_t add_blob(gltf_blob blob);
    uint32_t buffer(uint32_t number);
    uint32_t view(uint32_t number);
    uint32_t inflated_view(const gltf_item &view, const gltf_json &extension);
    uint32_t blob_view(gltf_bytes bytes);
    gltf_json sparse(const gltf_item &accessor, const gltf_json &value);
    uint32_t accessor(uint32_t number);
    uint32_t decoded(uint32_t number, int component, unsigned components,
                     size_t count, gltf_bytes bytes);
    void draco(const gltf_item &primitive, const gltf_json &extension,
               gltf_json &to);
    bool wanted(const std::string &semantic) const;
    bool is_vector(uint32_t accessor) const;
    gltf_json attributes(const gltf_item &from, const gltf_json &names,
                         gltf_json to);
    gltf_json primitive(const gltf_item &from);
    void meshes();
    void node(const gltf_item &from);
    void nodes_and_scene();
    void materials();
};

builder::builder(const gltf_source &from, gltf_budget &expand, asset *warn)
    : source(from), budget(expand), warnings(warn)
{
    in = gltf_json::parse(source.json, source.json + source.json_size);
    out = { { "asset", { { "version", "2.0" } } } };
    for (const char *name : { "buffers", "bufferViews", "accessors", "meshes",
                              "nodes", "materials" })
        out[name] = gltf_json::array();
    buffer_ids.assign(list("buffers").size(), GLTF_NONE);
    view_ids.assign(list("bufferViews").size(), GLTF_NONE);
    accessor_ids.assign(list("accessors").size(), GLTF_NONE);
    plain.byte_count = source.file_size;
}

const gltf_json &builder::list(const char *name) const
{
    const auto found = in.find(name);
    if (found == in.end())
        return no_items();
    if (!found->is_array())
        throw std::runtime_error(std::string(name) + " is not a list");
    return *found;
}

gltf_item builder::item(const char *name, size_t number) const
{
    const gltf_item made{ list(name)[number], name, number };
    if (!made.value.is_object())
        made.fail("not an object");
    return made;
}

uint32_t builder::add(const char *name, gltf_json value)
{
    gltf_list(out, name).push_back(std::move(value));
    return static_cast<uint32_t>(out[name].size() - 1);
}

void builder::check_version() const
{
    const auto asset = in.find("asset");
    if (asset == in.end() || !asset->is_object() ||
        !asset->contains("version") || !(*asset)["version"].is_string())
        throw std::runtime_error("no glTF: asset.version is missing");
    const auto version = (*asset)["version"].get<std::string>();
    if (version.compare(0, 2, "2.") != 0)
        throw std::runtime_error("glTF version " + quoted(version) +
                                 " is not supported");
    const auto least = asset->find("minVersion");
    if (least != asset->end() && *least != "2.0")
        throw std::runtime_error("glTF minVersion " +
                                 least->dump(-1, ' ', true).substr(0, 60) +
                                 " is not supported");
}

void builder::check_extensions()
{
    for (const gltf_json &name : list("extensionsRequired")) {
        if (!name.is_string())
            throw std::runtime_error("extensionsRequired holds no names");
        if (!gltf_is_harmless(name.get<std::string>()) &&
            !(source.everything && name == "EXT_mesh_gpu_instancing"))
            throw std::runtime_error("required extension " +
                                     quoted(name.get<std::string>()) +
                                     " is not supported");
    }
    for (const gltf_json &name : list("extensionsUsed")) {
        if (name == "EXT_mesh_gpu_instancing" && !source.everything)
            asset_warn(warnings, "EXT_mesh_gpu_instancing is ignored");
    }
}

gltf_blob builder::load(const gltf_item &from)
{
    bool first;
    gltf_blob bytes = gltf_load_buffer(source, from, sides, budget, &first);
    plain.byte_count += first ? bytes.size() : 0;
    return bytes;
}

uint32_t builder::add_blob(gltf_blob blob)
{
    plain.blobs.push_back(std::move(blob));
    return static_cast<uint32_t>(plain.blobs.size() - 1);
}

uint32_t builder::buffer(uint32_t number)
{
    uint32_t &id = buffer_ids[number];
    if (id == GLTF_NONE)
        id = add_blob(load(item("buffers", number)));
    return id;
}

/* The part of a buffer that an object with buffer, byteOffset and byteLength
 * means; checked. */
struct slice {
    uint32_t buffer;
    uint64_t offset, size;
};

slice cut(const gltf_item &from, uint32_t buffer, uint64_t buffer_size)
{
    const slice s{ buffer, from.whole("byteOffset", 0),
                   from.whole("byteLength") };
    if (s.size == 0)
        from.fail("byteLength is 0");
    if (s.offset > buffer_size || s.size > buffer_size - s.offset)
        from.fail("runs past its buffer");
    return s;
}

uint32_t builder::blob_view(gltf_bytes bytes)
{
    const size_t size = bytes.size();
    return add("bufferViews",
               { { "buffer", add_blob(gltf_blob(std::move(bytes))) },
                 { "byteOffset", 0u }, { "byteLength", size } });
}

uint32_t builder::inflated_view(const gltf_item &from,
                                const gltf_json &extension)
{
    const gltf_item packed{ extension, from.list, from.number };
    const uint32_t number = packed.id("buffer", buffer_ids.size());
    if (number == GLTF_NONE)
        packed.fail("meshopt data without a buffer");
    const uint32_t id = buffer(number);
    const slice s = cut(packed, id, plain.blobs[id].size());
    return blob_view(gltf_inflate(packed, plain.blobs[id].data() + s.offset,
                                  s.size, budget));
}

uint32_t builder::view(uint32_t number)
{
    if (view_ids[number] != GLTF_NONE)
        return view_ids[number];
    const gltf_item from = item("bufferViews", number);
    const uint64_t stride = from.whole("byteStride", 0);
    if (stride > 252 || stride % 4 != 0)
        from.fail("byteStride " + std::to_string(stride));

    uint32_t id;
    if (const gltf_json *packed = from.extension("EXT_meshopt_compression")) {
        id = inflated_view(from, *packed);
    } else {
        const uint32_t buffer_number = from.id("buffer", buffer_ids.size());
        if (buffer_number == GLTF_NONE)
            from.fail("buffer is missing");
        const uint32_t to = buffer(buffer_number);
        const slice s = cut(from, to, plain.blobs[to].size());
        id = add("bufferViews", { { "buffer", s.buffer },
                                  { "byteOffset", s.offset },
                                  { "byteLength", s.size } });
    }
    if (stride > 0)
        out["bufferViews"][id]["byteStride"] = stride;
    return view_ids[number] = id;
}

gltf_json builder::sparse(const gltf_item &from, const gltf_json &value)
{
    const gltf_item top{ value, from.list, from.number };
    gltf_json to = { { "count", top.whole("count") } };
    if (to["count"] == 0 || to["count"] > INT32_MAX)
        from.fail("unusable sparse count");

    for (const char *part : { "indices", "values" }) {
        const gltf_json *object = top.object(part);
        if (!object)
            from.fail(std::string("sparse without ") + part);
        const gltf_item half{ *object, from.list, from.number };
        const uint32_t number = half.id("bufferView", view_ids.size());
        const uint64_t offset = half.whole("byteOffset", 0);
        if (number == GLTF_NONE || offset > INT32_MAX)
            from.fail(std::string("unusable sparse ") + part);
        to[part] = { { "bufferView", view(number) }, { "byteOffset", offset } };
        if (part[0] == 'i')
            to[part]["componentType"] = half.whole("componentType");
    }
    return to;
}

uint32_t builder::accessor(uint32_t number)
{
    if (accessor_ids[number] != GLTF_NONE)
        return accessor_ids[number];
    const gltf_item from = item("accessors", number);
    const uint64_t component = from.whole("componentType");
    const auto type = from.value.find("type");
    const auto normalised = from.value.find("normalized");

    bool known = false;
    for (const char *one : types)
        known = known || (type != from.value.end() && *type == one);
    if (!known)
        from.fail("neither a scalar nor a vector");
    if (component < GLTF_I8 || component > GLTF_F32)
        from.fail("componentType " + std::to_string(component));
    gltf_json to = { { "name", std::to_string(number) },
                     { "componentType", component },
                     { "count", from.whole("count") }, { "type", *type },
                     { "byteOffset", from.whole("byteOffset", 0) } };
    if (normalised != from.value.end() && normalised->is_boolean())
        to["normalized"] = *normalised;
    const uint32_t view_number = from.id("bufferView", view_ids.size());
    if (view_number != GLTF_NONE)
        to["bufferView"] = view(view_number);
    if (const gltf_json *value = from.object("sparse"))
        to["sparse"] = sparse(from, *value);
    return accessor_ids[number] = add("accessors", std::move(to));
}

/* An accessor that stands for the file's `number`. */
uint32_t builder::decoded(uint32_t number, int component, unsigned components,
                          size_t count, gltf_bytes bytes)
{
    return add("accessors", { { "name", std::to_string(number) },
                              { "componentType", component },
                              { "type", types[components - 1] },
                              { "count", count },
                              { "bufferView", blob_view(std::move(bytes)) } });
}

/* Puts accessors of decoded data in place of the primitive's. */
void builder::draco(const gltf_item &from, const gltf_json &extension,
                    gltf_json &to)
{
    const gltf_item packed{ extension, from.list, from.number };
    const gltf_json *ids = packed.object("attributes");
    const uint32_t number = packed.id("bufferView", view_ids.size());
    if (!ids || number == GLTF_NONE)
        from.fail("Draco data without a bufferView or attributes");
    const gltf_item source_view = item("bufferViews", number);
    const uint32_t whole = source_view.id("buffer", buffer_ids.size());
    if (whole == GLTF_NONE)
        source_view.fail("buffer is missing");
    const uint32_t blob = buffer(whole);
    const slice s = cut(source_view, blob, plain.blobs[blob].size());

    gltf_json taken = gltf_json::object();
    std::vector<std::string> normalised;
    for (const auto &[name, id] : ids->items()) {
        const auto ref = from.value["attributes"].find(name);
        if (ref == from.value["attributes"].end() || !wanted(name))
            continue;
        taken[name] = id;
        const uint32_t a =
            gltf_to_id(from, name.c_str(), *ref, accessor_ids.size());
        if (item("accessors", a).value.value("normalized", gltf_json()) == true)
            normalised.push_back(name);
    }
    gltf_draco data =
        gltf_inflate_draco(from, taken, normalised,
                           plain.blobs[blob].data() + s.offset, s.size, budget);
    to["mode"] = 4;
    to["indices"] = decoded(from.id("indices", SIZE_MAX), GLTF_U32, 1,
                            data.faces * 3, std::move(data.indices));
    for (auto &attribute : data.attributes) {
        const char *name = attribute.semantic.c_str();
        to["attributes"][name] =
            decoded(gltf_to_id(from, name, from.value["attributes"][name],
                               SIZE_MAX),
                    GLTF_F32, attribute.components, data.points,
                    std::move(attribute.values));
    }
}

bool builder::wanted(const std::string &semantic) const
{
    return source.everything || semantic == "POSITION" ||
           gltf_slot(semantic.c_str()) >= 0;
}

bool builder::is_vector(uint32_t number) const
{
    const gltf_item from = item("accessors", number);
    const auto type = from.value.find("type");
    return type == from.value.end() || !type->is_string() ||
           type->get_ref<const std::string &>().compare(0, 3, "MAT") != 0;
}

/* Adds to `to` the accessors of a list of attributes. */
gltf_json builder::attributes(const gltf_item &from, const gltf_json &names,
                              gltf_json to)
{
    for (const auto &[name, ref] : names.items()) {
        if (!wanted(name) || to.contains(name))
            continue;
        const uint32_t number =
            gltf_to_id(from, name.c_str(), ref, accessor_ids.size());
        if (!source.everything || is_vector(number))
            to[name] = accessor(number);
    }
    return to;
}

/* Null if there are no triangles in it. */
gltf_json builder::primitive(const gltf_item &from)
{
    const uint64_t mode = from.whole("mode", 4);
    const gltf_json *names = from.object("attributes");
    if (mode > 6)
        from.fail("primitive mode " + std::to_string(mode));
    if (!names)
        from.fail("a primitive without attributes");
    if (mode < 4) {
        skipped_mode = true;
        return nullptr;
    }
    skipped_targets = skipped_targets || from.value.contains("targets");

    gltf_json to = { { "mode", mode }, { "attributes", gltf_json::object() } };
    const uint32_t material = from.id("material", list("materials").size());
    if (material != GLTF_NONE)
        to["material"] = material;
    const gltf_json *packed = from.extension("KHR_draco_mesh_compression");
    if (packed)
        draco(from, *packed, to);
    to["attributes"] = attributes(from, *names, std::move(to["attributes"]));
    const auto targets = from.value.find("targets");
    if (source.everything && targets != from.value.end()) {
        if (!targets->is_array())
            from.fail("targets is not a list");
        to["targets"] = gltf_json::array();
        for (const gltf_json &target : *targets) {
            if (!target.is_object())
                from.fail("a target is not an object");
            gltf_list(to, "targets").push_back(
                attributes(from, target, gltf_json::object()));
        }
    }
    const uint32_t indices = from.id("indices", accessor_ids.size());
    if (indices != GLTF_NONE && !packed) {
        to["indices"] = accessor(indices);
        if (!out["accessors"][to["indices"].get<size_t>()].contains(
                "bufferView"))
            item("accessors", indices).fail("indices without a bufferView");
    }
    return to;
}

void builder::meshes()
{
    for (size_t i = 0; i < list("meshes").size(); i++) {
        const gltf_item from = item("meshes", i);
        const auto primitives = from.value.find("primitives");
        if (primitives == from.value.end() || !primitives->is_array())
            from.fail("primitives are missing");
        gltf_json to = gltf_json::array();
        for (const gltf_json &value : *primitives) {
            if (!value.is_object())
                from.fail("a primitive is not an object");
            gltf_json made = primitive({ value, "meshes", i });
            if (!made.is_null())
                to.push_back(std::move(made));
        }
        add("meshes", { { "primitives", std::move(to) } });
    }
    if (skipped_mode && !source.everything)
        asset_warn(warnings, "points and lines are left out");
    if (skipped_targets && !source.everything)
        asset_warn(warnings, "morph targets are left out");
}

void builder::node(const gltf_item &from)
{
    static const struct {
        const char *name;
        size_t size;
    } parts[] = { { "matrix", 16 }, { "translation", 3 }, { "rotation", 4 },
                  { "scale", 3 } };
    gltf_json to = gltf_json::object();

    const uint32_t mesh = from.id("mesh", list("meshes").size());
    if (mesh != GLTF_NONE)
        to["mesh"] = mesh;
    skipped_skin = skipped_skin ||
                   (mesh != GLTF_NONE && from.value.contains("skin"));
    for (const auto &part : parts) {
        const auto found = from.value.find(part.name);
        if (found == from.value.end())
            continue;
        bool ok = found->is_array() && found->size() == part.size;
        for (size_t i = 0; ok && i < part.size; i++)
            ok = (*found)[i].is_number();
        if (!ok)
            from.fail(std::string(part.name) + " is not " +
                      std::to_string(part.size) + " numbers");
        to[part.name] = *found;
    }
    const auto children = from.value.find("children");
    if (children != from.value.end()) {
        if (!children->is_array())
            from.fail("children is not a list");
        to["children"] = gltf_json::array();
        for (const gltf_json &child : *children)
            gltf_list(to, "children").push_back(
                gltf_to_id(from, "child", child, list("nodes").size()));
    }
    add("nodes", std::move(to));
}

void builder::nodes_and_scene()
{
    const size_t count = list("nodes").size();
    std::vector<bool> is_child(count);
    gltf_json roots = gltf_json::array();

    for (size_t i = 0; i < count; i++)
        node(item("nodes", i));
    if (skipped_skin && !source.everything)
        asset_warn(warnings, "skins are left out: the mesh is in its bind "
                             "pose");
    const size_t scenes = list("scenes").size();
    if (in.contains("scene") || scenes > 0) {
        const uint32_t number =
            in.contains("scene")
                ? gltf_to_id({ in, "scene", 0 }, "scene", in["scene"], scenes)
                : 0;
        const gltf_item scene = item("scenes", number);
        const auto nodes = scene.value.find("nodes");
        if (nodes != scene.value.end() && !nodes->is_array())
            scene.fail("nodes is not a list");
        for (size_t i = 0; nodes != scene.value.end() && i < nodes->size(); i++)
            roots.push_back(gltf_to_id(scene, "node", (*nodes)[i], count));
    } else {
        for (const gltf_json &node : out["nodes"]) {
            if (!node.contains("children"))
                continue;
            for (const gltf_json &child : node["children"])
                is_child[child.get<size_t>()] = true;
        }
        for (size_t i = 0; i < count; i++) {
            if (!is_child[i])
                roots.push_back(i);
        }
    }
    out["scenes"] = { { { "nodes", std::move(roots) } } };
    out["scene"] = 0;
}

void builder::materials()
{
    for (size_t i = 0; i < list("materials").size(); i++) {
        const gltf_item from = item("materials", i);
        const auto name = from.value.find("name");
        gltf_json to = gltf_json::object();
        if (name != from.value.end() && name->is_string())
            to["name"] = *name;
        add("materials", std::move(to));
    }
}

gltf_plain builder::build()
{
    check_version();
    check_extensions();
    materials();
    meshes();
    nodes_and_scene();
    plain.text = out.dump();
    plain.sides = std::move(sides.counted);
    return std::move(plain);
}

} // namespace

gltf_blob gltf_load_buffer(const gltf_source &source, const gltf_item &from,
                           gltf_sides &sides, gltf_budget &budget, bool *first)
{
    const uint64_t size = from.whole("byteLength");
    const auto uri = from.value.find("uri");
    *first = false;
    if (size == 0)
        from.fail("byteLength is 0");

    if (uri == from.value.end()) {
        if (from.number != 0 || !source.bin)
            from.fail("there are no data for it");
        if (size > source.bin_size)
            from.fail("longer than the file's BIN chunk");
        return gltf_blob(source.bin, size);
    }
    if (!uri->is_string())
        from.fail("uri is not a string");
    const auto &name = uri->get_ref<const std::string &>();
    asset_error error;
    uint64_t available;
    if (!gltf_uri_size(&source, name.c_str(), name.size(), &available, &error))
        from.fail(error.what);
    if (available < size)
        from.fail("cut off: " + std::to_string(available) + " of " +
                  std::to_string(size) + " bytes");
    gltf_bytes bytes(size);
    if (!gltf_uri_read(&source, name.c_str(), name.size(), bytes.data(), size,
                       &error))
        from.fail(error.what);
    *first = gltf_pay_side(sides, from, name, size, budget);
    return gltf_blob(std::move(bytes));
}

/* "a//./b" is the file "a/b". */
bool gltf_pay_side(gltf_sides &sides, const gltf_item &from,
                   const std::string &uri, uint64_t size, gltf_budget &budget)
{
    std::vector<char> path(uri.size() + 1);

    if (!gltf_uri_path(uri.c_str(), uri.size(), path.data()))
        return false; /* inline: the asset is as large as that */
    const std::filesystem::path plain(path.data());
    const std::string name = plain.lexically_normal().string();
    if (sides.read.insert(name).second) {
        if (!sides.counted.insert(name).second)
            return false;
        budget.left += gltf_budget_for(size).left - gltf_budget_for(0).left;
        return true;
    }
    if (!gltf_spend(&budget, 1, size))
        from.fail("its file was read too often for a file of this size");
    return false;
}

bool gltf_is_harmless(const std::string &name)
{
    static const char *const known[] = {
        "KHR_draco_mesh_compression", "EXT_meshopt_compression",
        "KHR_mesh_quantization", "KHR_lights_punctual", "KHR_animation_pointer",
        "KHR_xmp_json_ld", "MSFT_texture_dds"
    };
    static const char *const families[] = { "KHR_materials_", "KHR_texture_",
                                            "EXT_texture_" };
    for (const char *one : known) {
        if (name == one)
            return true;
    }
    for (const char *prefix : families) {
        if (name.rfind(prefix, 0) == 0)
            return true;
    }
    return false;
}

gltf_plain gltf_make_plain(const gltf_source &source, gltf_budget &budget,
                           asset *warnings)
{
    return builder(source, budget, warnings).build();
}
