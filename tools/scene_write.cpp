/* SPDX-License-Identifier: MIT */
/*
 * scene_write.cpp - the document, edited: accessors and views of the visible
 * level take the places that are free, and go behind the others when these are
 * used up. All bytes move into one buffer.
 */
#include "tools/scene_write.h"

#include <algorithm>
#include <cstring>
#include <new>

#include "tools/exhausted.h"
#include "tools/pack.h"
#include "tools/scene_writer.h"

namespace {

enum { TARGET_VERTICES = 34962, TARGET_INDICES = 34963 };
#define GLTF_MESHOPT "EXT_meshopt_compression"

/* One grey pixel, in the place of an image that has not arrived. */
const uint8_t pixel[] = {
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d,
    0x49, 0x48, 0x44, 0x52, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x01,
    0x08, 0x00, 0x00, 0x00, 0x00, 0x3a, 0x7e, 0x9b, 0x55, 0x00, 0x00, 0x00,
    0x0a, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0x68, 0x00, 0x00, 0x00,
    0x82, 0x00, 0x81, 0xda, 0x45, 0x08, 0x3b, 0x00, 0x00, 0x00, 0x00, 0x49,
    0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82
};

} // namespace

/* ---- reading the document ----------------------------------------------- */

std::vector<size_t> scene_writer::free_list(const char *name)
{
    std::vector<size_t> numbers;
    const size_t size = doc.contains(name) ? doc.at(name).size() : 0;
    const gltf_document root =
        doc.value("extensions", gltf_document::object())
            .value(GLTF_PROGRESSIVE, gltf_document::object());
    for (const gltf_document &number :
         root.value(name, gltf_document::array())) {
        const uint32_t at = gltf_number_of(number);
        if (at >= size)
            throw std::runtime_error("a free place is out of range");
        numbers.push_back(at);
    }
    std::reverse(numbers.begin(), numbers.end()); /* the last is next */
    return numbers;
}

/* As text, at most as long as a document may be. */
static void read_document(const pmesh_scene *scene, asset_bytes *plain)
{
    const pmesh_scene_bytes text = pmesh_scene_document(scene);
    const auto size = static_cast<size_t>(text.size);
    pmesh_scene_header header = {};

    if (!text.data || text.arrived < text.size)
        throw std::runtime_error("cut off before the scene's document");
    pmesh_scene_get_header(scene, &header);
    if (header.document_form == PMESH_DOCUMENT_PLAIN)
        asset_put(plain, text.data, size);
    else if (!unpack_zlib(text.data, size,
                          static_cast<size_t>(
                              std::min(GLTF_MAX_DOCUMENT,
                                       gltf_budget_for(size).left)),
                          plain))
        throw std::runtime_error("the document cannot be unpacked");
}

gltf_document scene_document(const pmesh_scene *scene)
{
    asset_bytes plain = {};
    const std::unique_ptr<asset_bytes, void (*)(asset_bytes *)> text(
        &plain, asset_bytes_free);
    gltf_source source = {};
    asset unused = {};
    asset_error error;

    read_document(scene, &plain);
    if (!gltf_open(plain.data, plain.size, &source, &unused, &error))
        throw std::runtime_error(std::string("the document is no glTF: ") +
                                 error.what);
    if (!gltf_fits_stored(&source, pmesh_scene_document(scene).size))
        throw std::runtime_error(
            "the document unpacks to more than its size allows");
    return gltf_document::parse(source.json, source.json + source.json_size);
}

void scene_writer::open()
{
    doc = scene_document(scene);
    /* Members of the root must not come or go from now on: references into an
     * ordered document would not survive it. */
    for (const char *list : { "accessors", "bufferViews", "buffers" })
        if (!doc.contains(list))
            doc[list] = gltf_document::array();
    free_accessors = free_list("accessors");
    free_views = free_list("bufferViews");
}

/* ---- new accessors ------------------------------------------------------ */

size_t scene_writer::place(const char *list, std::vector<size_t> &free,
                     gltf_document value)
{
    if (free.empty()) {
        gltf_list(doc, list).push_back(std::move(value));
        return doc[list].size() - 1;
    }
    const size_t at = free.back();
    free.pop_back();
    doc[list][at] = std::move(value);
    return at;
}

void scene_writer::align(size_t to)
{
    bin.resize((bin.size() + to - 1) / to * to);
}

static gltf_document numbers_of(const std::vector<float> &values)
{
    gltf_document list = gltf_document::array();
    for (const float v : values)
        list.push_back(static_cast<double>(v));
    return list;
}

/* Puts data into BIN; their view. Packed ones would lie in a second buffer, of
 * which there is nothing but its size. */
gltf_document scene_writer::view_of(const scene_array &data, int target)
{
    const bool indices = target == TARGET_INDICES;
    gltf_document view = { { "buffer", style.meshopt ? 1 : 0 } };

    align(4);
    view["byteOffset"] = style.meshopt ? unpacked : bin.size();
    view["byteLength"] = data.bytes.size();
    if (data.stride > 0)
        view["byteStride"] = data.stride;
    view["target"] = target;
    if (style.meshopt) {
        const size_t stride = data.bytes.size() / data.count;
        const gltf_bytes packed =
            gltf_pack(data.bytes, data.count, stride, indices);
        gltf_object(view, "extensions")[GLTF_MESHOPT] = {
            { "buffer", 0 },
            { "byteOffset", bin.size() },
            { "byteLength", packed.size() },
            { "byteStride", stride },
            { "count", data.count },
            { "mode", indices ? "TRIANGLES" : "ATTRIBUTES" }
        };
        unpacked += (data.bytes.size() + 3) / 4 * 4;
        bin.insert(bin.end(), packed.begin(), packed.end());
    } else {
        bin.insert(bin.end(), data.bytes.begin(), data.bytes.end());
    }
    return view;
}

/* An accessor of `count` elements like the data, without a view. */
gltf_document scene_writer::accessor_of(const scene_array &data, size_t count,
                                        bool bounds)
{
    static const char *const types[] = { "SCALAR", "VEC2", "VEC3", "VEC4" };
    gltf_document accessor = gltf_document::object();

    accessor["componentType"] = data.component_type;
    if (data.normalised)
        accessor["normalized"] = true;
    accessor["count"] = count;
    accessor["type"] = types[data.components - 1];
    if (bounds) {
        accessor["min"] = numbers_of(data.low);
        accessor["max"] = numbers_of(data.high);
    }
    return accessor;
}

/* The number of the data's accessor. */
size_t scene_writer::add(const scene_array &data, int target, bool bounds)
{
    gltf_document accessor = {
        { "bufferView", place("bufferViews", free_views, view_of(data, target)) }
    };
    accessor.update(accessor_of(data, data.count, bounds));
    return place("accessors", free_accessors, std::move(accessor));
}

scene_form scene_writer::form(const gltf_document &record) const
{
    static const char *const types[] = { "SCALAR", "VEC2", "VEC3", "VEC4" };
    const std::string type = record.at("type").get<std::string>();
    scene_form f{ gltf_number_of(record.at("channel")), 0, GLTF_F32,
                  record.value("normalized", false),
                  record.value("exact", false) };
    if (record.contains("componentType"))
        f.component_type = gltf_number_of(record["componentType"]);
    for (unsigned i = 0; i < 4; i++)
        if (type == types[i])
            f.components = i + 1;
    return f;
}

scene_geometry &scene_writer::geometry(const gltf_document &record)
{
    const uint32_t number = gltf_number_of(record.at("mesh"));
    auto &mesh = meshes[number];
    if (!mesh)
        mesh = std::make_unique<scene_geometry>(
            pmesh_scene_mesh(scene, number), style.inflate, style.draco);
    return *mesh;
}

/* What a mesh holds is written once for nothing, for it came with the file. A
 * few bytes of the document name it, or one of its channels, once more. */
void scene_writer::pay(const gltf_document &record, const scene_geometry &mesh)
{
    const bool first = written.emplace(gltf_number_of(record.at("mesh")),
                                       gltf_number_of(record.at("material")))
                           .second;
    const size_t held = first ? 1 + mesh.channel_count() : 0;
    size_t named = 1; /* the positions */

    for (const auto &attribute : record.at("attributes").items())
        named += attribute.key() != "POSITION";
    for (const gltf_document &target :
         record.value("targets", gltf_document::array()))
        named += target.size();
    if (!gltf_spend(&budget, first ? 0 : mesh.corner_count(), 4) ||
        !gltf_spend(&budget, named > held ? named - held : 0,
                    16 * mesh.vertex_count()))
        throw std::runtime_error("the primitives expand to more than a file "
                                 "of this size may");
}

void scene_writer::primitive(gltf_document &p)
{
    const gltf_document record = p["extensions"][GLTF_PROGRESSIVE];
    scene_geometry &mesh = geometry(record);
    std::map<std::string, scene_form> forms;

    mesh.choose(gltf_number_of(record.at("material")));
    pay(record, mesh);
    for (const auto &[name, one] : record.at("attributes").items())
        if (name != "POSITION")
            forms[name] = form(one);
    if (style.draco) {
        pack_draco(p, mesh.positions(), mesh.attributes(forms), mesh.indices(),
                   record.contains("targets"));
    } else {
        gltf_document attributes = {
            { "POSITION", add(mesh.positions(), TARGET_VERTICES, true) }
        };
        for (const auto &[name, data] : mesh.attributes(forms))
            attributes[name] = add(data, TARGET_VERTICES, false);
        p["attributes"] = std::move(attributes);
        p["indices"] = add(mesh.indices(), TARGET_INDICES, false);
    }
    for (const gltf_document &target :
         record.value("targets", gltf_document::array())) {
        gltf_document to = gltf_document::object();
        for (const auto &[name, one] : target.items())
            to[name] = add(mesh.differences(form(one)), TARGET_VERTICES,
                           name == "POSITION");
        gltf_list(p, "targets").push_back(std::move(to));
    }
    if (!style.stream)
        gltf_erase_extension(p, GLTF_PROGRESSIVE);
}

/* Whether any of the mesh's primitives is coded: these get accessors. */
bool scene_writer::fill(gltf_document &mesh)
{
    bool any = false;
    for (gltf_document &p : mesh.at("primitives"))
        if (p.contains("extensions") &&
            p["extensions"].contains(GLTF_PROGRESSIVE)) {
            primitive(p);
            any = true;
        }
    return any;
}

void scene_writer::primitives()
{
    if (style.lod_count > 0)
        lods();
    else
        for (gltf_document &mesh : doc.at("meshes"))
            fill(mesh);
}

/* ---- resources ---------------------------------------------------------- */

/* GLTF_NONE if it has none. */
static uint32_t buffer_of(const gltf_document &view)
{
    const auto found = view.find("buffer");
    return found == view.end() ? GLTF_NONE : gltf_number_of(*found);
}

uint64_t scene_writer::offset_of(const gltf_document &view)
{
    const auto found = view.find("byteOffset");
    const uint64_t offset = found == view.end() ? 0 : gltf_number(*found);
    if (offset == UINT64_MAX)
        throw std::runtime_error("a view begins nowhere");
    return offset;
}

/* Without their data; their accessors become free places. */
void scene_writer::drop_animations()
{
    std::vector<bool> used(doc["accessors"].size());
    asset_warn(notes, "the animations have not arrived and are left out");
    for (const gltf_document &animation : doc["animations"])
        for (const gltf_document &sampler : animation.at("samplers"))
            for (const char *end : { "input", "output" }) {
                const uint32_t at = gltf_number_of(sampler.at(end));
                if (at < used.size())
                    used[at] = true;
            }
    gltf_erase(doc, "animations");
    for (size_t i = 0; i < used.size(); i++)
        if (used[i])
            doc["accessors"][i] = { { "componentType", 5126 },
                                    { "count", 1 },
                                    { "type", "SCALAR" } };
}

/* Points the images at the pixel, whose view takes the place of theirs. */
void scene_writer::missing_images(const std::vector<bool> &missing)
{
    size_t count = 0;
    for (gltf_document &image : doc["images"]) {
        if (!image.contains("bufferView"))
            continue;
        gltf_document &view =
            doc["bufferViews"].at(gltf_number_of(image["bufferView"]));
        const uint32_t buffer = buffer_of(view);
        if (buffer >= missing.size() || !missing[buffer])
            continue;
        view = { { "buffer", buffer }, { "byteLength", sizeof pixel } };
        image["mimeType"] = "image/png";
        count++;
    }
    asset_warn(notes, "%zu images have not arrived and are one grey pixel",
               count);
}

/* Moves each into BIN, or what stands for it. */
void scene_writer::resources()
{
    pmesh_scene_header header = {};
    std::vector<bool> missing, image;
    bool any = false, lacks_animation = false;

    pmesh_scene_get_header(scene, &header);
    missing.resize(header.resource_count);
    image.resize(header.resource_count);
    for (const gltf_document &one : doc.value("images", gltf_document::array()))
        if (one.contains("bufferView")) {
            const uint32_t buffer = buffer_of(
                doc["bufferViews"].at(gltf_number_of(one["bufferView"])));
            if (buffer < image.size())
                image[buffer] = true;
        }
    for (uint32_t i = 0; i < header.resource_count; i++) {
        const pmesh_scene_bytes r = pmesh_scene_resource(scene, i);
        missing[i] = r.size > 0 && (!r.data || r.arrived < r.size);
        any = any || (missing[i] && image[i]);
        lacks_animation = lacks_animation || (missing[i] && !image[i]);
    }
    if (lacks_animation && !doc.contains("animations"))
        throw std::runtime_error("cut off before what is needed to show it");
    if (lacks_animation)
        drop_animations();
    if (any)
        missing_images(missing);
    for (uint32_t i = 0; i < header.resource_count; i++) {
        const pmesh_scene_bytes r = pmesh_scene_resource(scene, i);
        if (style.stream && image[i]) {
            resource_start.push_back(style.resource_offsets[i]);
            in_stream.push_back(true);
            continue;
        }
        in_stream.push_back(false);
        align(8);
        resource_start.push_back(bin.size());
        if (!missing[i])
            bin.insert(bin.end(), r.data, r.data + r.size);
        else if (image[i])
            bin.insert(bin.end(), pixel, pixel + sizeof pixel);
        else
            bin.resize(bin.size() + static_cast<size_t>(r.size));
    }
}

/* Before the geometry's views are added: all that there are name resources. */
void scene_writer::move_views()
{
    for (gltf_document &view : doc["bufferViews"]) {
        if (!view.is_object())
            throw std::runtime_error("a view is no object");
        if (!view.contains("buffer"))
            continue;
        const uint32_t number = buffer_of(view);
        const uint64_t start = resource_start.at(number);
        if (in_stream[number])
            image_views.push_back(
                static_cast<size_t>(&view - &doc["bufferViews"][0]));
        view["buffer"] = 0;
        view["byteOffset"] = start + offset_of(view);
    }
}

/* What is left of our marks: places that nothing took. */
void scene_writer::drop_marks()
{
    for (const size_t at : free_accessors)
        doc["accessors"][at] = { { "componentType", 5126 },
                                 { "count", 1 },
                                 { "type", "SCALAR" } };
    for (const size_t at : free_views)
        doc["bufferViews"][at] = { { "buffer", 0 }, { "byteLength", 1 } };
    gltf_erase_extension(doc, GLTF_PROGRESSIVE);
}

void scene_writer::use_extension(const char *name, bool required)
{
    for (const char *list : { "extensionsUsed", "extensionsRequired" }) {
        bool there = !required && list[10] == 'R';
        for (const gltf_document &one : doc.value(list, gltf_document::array()))
            there = there || one == name;
        if (!there)
            gltf_list(doc, list).push_back(name);
    }
}

/* The last of all bytes, so that a reader can go on with it. */
void scene_writer::add_stream()
{
    align(4);
    for (const size_t at : image_views) {
        gltf_document &view = doc["bufferViews"][at];
        view["byteOffset"] = bin.size() + offset_of(view);
    }
    gltf_object(doc, "extensions")[GLTF_PROGRESSIVE] = { { "bufferView",
                                              doc["bufferViews"].size() } };
    use_extension(GLTF_PROGRESSIVE, false);
    gltf_list(doc, "bufferViews").push_back({ { "buffer", 0 },
                                   { "byteOffset", bin.size() },
                                   { "byteLength", style.stream->size } });
    bin.insert(bin.end(), style.stream->data,
               style.stream->data + style.stream->size);
}

/* ---- the file ----------------------------------------------------------- */

static void put_u32(asset_bytes *out, size_t value)
{
    const uint8_t bytes[4] = { static_cast<uint8_t>(value),
                               static_cast<uint8_t>(value >> 8),
                               static_cast<uint8_t>(value >> 16),
                               static_cast<uint8_t>(value >> 24) };
    asset_put(out, bytes, sizeof bytes);
}

void scene_writer::put_glb(const std::string &json, asset_bytes *out) const
{
    const size_t text = (json.size() + 3) / 4 * 4;
    const uint64_t total = uint64_t{ 12 + 8 + 8 } + text + bin.size();

    if (total > UINT32_MAX)
        throw std::runtime_error("more than 4 GiB do not fit into a GLB");
    asset_put(out, "glTF", 4);
    put_u32(out, 2);
    put_u32(out, static_cast<size_t>(total));
    put_u32(out, text);
    asset_put(out, "JSON", 4);
    asset_put(out, json.data(), json.size());
    asset_put(out, "   ", text - json.size());
    put_u32(out, bin.size());
    asset_put(out, "BIN\0", 4);
    asset_put(out, bin.data(), bin.size());
}

static std::string base64(const gltf_bytes &in)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnop"
                                 "qrstuvwxyz0123456789+/";
    std::string out;
    for (size_t i = 0; i < in.size(); i += 3) {
        uint32_t word = 0;
        for (size_t k = 0; k < 3; k++)
            word = word << 8 | (i + k < in.size() ? in[i + k] : 0u);
        for (size_t k = 0; k < 4; k++)
            out += i + k > in.size() ? '=' : digits[word >> (18 - 6 * k) & 63];
    }
    return out;
}

void scene_writer::write(asset_bytes *out)
{
    open();
    library();
    resources();
    move_views();
    primitives();
    drop_marks();
    if (style.stream)
        add_stream();
    align(4);
    doc["buffers"] = { { { "byteLength", bin.size() } } };
    if (!style.glb)
        doc["buffers"][0]["uri"] =
            "data:application/octet-stream;base64," + base64(bin);
    if (style.meshopt) {
        gltf_list(doc, "buffers").push_back(
            { { "byteLength", unpacked },
              { "extensions", { { GLTF_MESHOPT, { { "fallback", true } } } } } });
        use_extension(GLTF_MESHOPT, true);
    }
    if (uses_draco)
        use_extension(GLTF_DRACO, true);
    if (style.glb) {
        put_glb(doc.dump(), out);
    } else {
        const std::string json = doc.dump(2) + "\n";
        asset_put(out, json.data(), json.size());
    }
    if (out->failed)
        throw std::bad_alloc();
}

static uint32_t get_u32(const uint8_t *p)
{
    return p[0] | static_cast<uint32_t>(p[1]) << 8 |
           static_cast<uint32_t>(p[2]) << 16 |
           static_cast<uint32_t>(p[3]) << 24;
}

/* The stream's view, out of the text of a GLB. Throws what the parser does. */
static bool find_view(const uint8_t *json, size_t json_size, size_t *offset,
                      size_t *size)
{
    const gltf_json doc = gltf_json::parse(json, json + json_size);
    const gltf_json &view = doc.at("bufferViews")
                                .at(gltf_number_of(
                                    doc.at("extensions")
                                        .at(GLTF_PROGRESSIVE)
                                        .at("bufferView")));
    const uint64_t start =
        view.contains("byteOffset") ? gltf_number(view["byteOffset"]) : 0;
    *offset = static_cast<size_t>(std::min<uint64_t>(start, SIZE_MAX));
    *size = static_cast<size_t>(
        std::min<uint64_t>(gltf_number(view.at("byteLength")), SIZE_MAX));
    return view.at("buffer") == 0;
}

bool scene_find_stream(const uint8_t *data, size_t data_size, size_t *offset,
                       size_t *size)
{
    if (data_size < 20 || memcmp(data, "glTF", 4) != 0)
        return false;
    const size_t text = get_u32(data + 12), left = data_size - 20;
    gltf_source source = {};
    asset unused = {};
    asset_error error;

    if (get_u32(data + 4) != 2 || text > left ||
        !gltf_open(data + 20, text, &source, &unused, &error))
        return false;
    try {
        if (left - text < 8 || !find_view(data + 20, text, offset, size) ||
            *offset > left - text - 8)
            return false;
    } catch (const std::bad_alloc &) {
        exhausted_end();
    } catch (...) {
        return false; /* a GLB of another kind */
    }
    const size_t most = left - text - 8 - *offset;
    *size = *size < most ? *size : most;
    *offset += 20 + text + 8;
    return true;
}

bool scene_write(pmesh_scene *scene, scene_style style, asset_bytes *out,
                 asset *notes, asset_error *error)
{
    try {
        scene_writer(scene, style, notes).write(out);
        return true;
    } catch (const std::bad_alloc &) {
        return asset_fail(error, "", "out of memory");
    } catch (const gltf_document::exception &) {
        return asset_fail(error, "", "the document is no glTF of a scene");
    } catch (const std::runtime_error &e) {
        return asset_fail(error, "", "%s", e.what());
    } catch (...) {
        return asset_fail(error, "", "the document is unreadable");
    }
}
