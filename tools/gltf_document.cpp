/* SPDX-License-Identifier: MIT */
/*
 * gltf_document.cpp - what of a glTF file is not coded.
 *
 * Numbers of accessors and views stay as they are, for anything may refer to
 * them, extensions that we do not know included. What only coded primitives
 * refer to becomes a free place for the accessors of a level. Views that are
 * still needed move into new buffers, one for each resource.
 */
#include "tools/gltf_document.h"

#include <algorithm>
#include <cstring>

namespace {

/* Who needs an accessor or view; more is stronger. */
enum use : uint8_t { FREE, ANIMATION, NEEDED };

class taker {
public:
    taker(const gltf_source &from, const gltf_model &loaded,
          const std::vector<gltf_stream> &coded, gltf_sides &files,
          gltf_budget &expand, asset *warn)
        : source(from), model(loaded), streams(coded), sides(files),
          budget(expand), warnings(warn)
    {
        in = gltf_json::parse(source.json, source.json + source.json_size);
        doc = gltf_document::parse(source.json,
                                   source.json + source.json_size);
        accessor_use.assign(count("accessors"), FREE);
        view_use.assign(count("bufferViews"), FREE);
        buffers.resize(count("buffers"));
        sides.read.clear();
    }
    gltf_parts take();

private:
    const gltf_source &source;
    const gltf_model &model;
    const std::vector<gltf_stream> &streams;
    gltf_sides &sides;
    gltf_budget &budget;
    asset *warnings;
    gltf_json in;      /* as it was */
    gltf_document doc; /* as it becomes */
    gltf_parts parts;
    std::vector<use> accessor_use, view_use;
    std::vector<bool> image_view, image_taken;
    std::vector<gltf_blob> buffers; /* loaded when needed */
    bool keeps_primitives = false, keeps_draco = false;

    size_t count(const char *list) const;
    gltf_item item(const char *list, size_t number) const;
    const gltf_blob &buffer(uint32_t number);
    gltf_bytes view_bytes(size_t number);

    void mark_view(const gltf_item &from, use by);
    void mark_accessor(const gltf_item &from, const char *member,
                       const gltf_json &value, use by);
    void mark_all(const gltf_json &value);
    void mark_unknown(const gltf_json &value);
    void mark_kept(const gltf_item &primitive);
    void mark_skins_and_animations();

    gltf_document attribute(const gltf_primitive &p,
                            const gltf_channel &channel, int number);
    gltf_document set(const gltf_primitive &p, const gltf_channels &channels,
                      uint32_t number);
    void code_primitive(gltf_document &to, const gltf_primitive &p,
                        const gltf_stream &stream);
    void meshes();
    size_t add_view(size_t resource, size_t size);
    void images();
    void views();
    void free_places();
    void extensions();
};

size_t taker::count(const char *name) const
{
    const auto found = in.find(name);
    return found == in.end() ? 0 : found->size();
}

gltf_item taker::item(const char *name, size_t number) const
{
    const gltf_item made{ in[name][number], name, number };
    if (!made.value.is_object())
        made.fail("not an object");
    return made;
}

/* ---- bytes -------------------------------------------------------------- */

const gltf_blob &taker::buffer(uint32_t number)
{
    if (!buffers[number].empty())
        return buffers[number];
    const gltf_item from = item("buffers", number);
    bool first;
    buffers[number] = gltf_load_buffer(source, from, sides, budget, &first);
    return buffers[number];
}

gltf_bytes taker::view_bytes(size_t number)
{
    const gltf_item view = item("bufferViews", number);
    const gltf_json *packed = view.extension("EXT_meshopt_compression");
    const gltf_item from{ packed ? *packed : view.value, view.list, number };
    const uint32_t id = from.id("buffer", buffers.size());
    const uint64_t offset = from.whole("byteOffset", 0);
    const uint64_t size = from.whole("byteLength");
    if (id == GLTF_NONE || size == 0)
        from.fail("no buffer, or no bytes");
    const gltf_blob &bytes = buffer(id);
    if (offset > bytes.size() || size > bytes.size() - offset)
        from.fail("runs past its buffer");
    if (packed)
        return gltf_inflate(from, bytes.data() + offset, size, budget);
    if (!gltf_spend(&budget, 1, size)) /* views may share bytes */
        from.fail("the views are longer than a file of this size may have");
    return gltf_bytes(bytes.data() + offset, bytes.data() + offset + size);
}

/* ---- what is still needed ----------------------------------------------- */

void taker::mark_view(const gltf_item &from, use by)
{
    const uint32_t number = from.id("bufferView", view_use.size());
    if (number != GLTF_NONE)
        view_use[number] = std::max(view_use[number], by);
}

void taker::mark_accessor(const gltf_item &from, const char *member,
                          const gltf_json &value, use by)
{
    const uint32_t id = gltf_to_id(from, member, value, accessor_use.size());
    if (accessor_use[id] >= by)
        return;
    accessor_use[id] = by;
    const gltf_item accessor = item("accessors", id);
    mark_view(accessor, by);
    if (const gltf_json *sparse = accessor.object("sparse")) {
        const gltf_item top{ *sparse, "accessors", id };
        for (const char *half : { "indices", "values" })
            if (const gltf_json *object = top.object(half))
                mark_view({ *object, "accessors", id }, by);
    }
}

/* Whatever a whole number may mean. */
void taker::mark_all(const gltf_json &value)
{
    if (value.is_structured()) {
        for (const gltf_json &member : value)
            mark_all(member);
    } else if (value.is_number_unsigned()) {
        const uint64_t number = value.get<uint64_t>();
        if (number < accessor_use.size())
            mark_accessor({ in, "extensions", 0 }, "a number", value, NEEDED);
        if (number < view_use.size())
            view_use[number] = NEEDED;
    }
}

/* Extensions that may refer to accessors and views in ways of their own. */
void taker::mark_unknown(const gltf_json &value)
{
    if (!value.is_structured())
        return;
    if (value.is_object() && value.contains("extensions") &&
        value["extensions"].is_object()) {
        for (const auto &[name, extension] : value["extensions"].items())
            if (!gltf_is_harmless(name) && name != "MSFT_lod" &&
                name != "KHR_node_visibility")
                mark_all(extension);
    }
    for (const gltf_json &member : value)
        mark_unknown(member);
}

/* A primitive that is not coded. */
void taker::mark_kept(const gltf_item &p)
{
    keeps_primitives = true;
    if (const gltf_json *attributes = p.object("attributes"))
        for (const auto &[name, value] : attributes->items())
            mark_accessor(p, name.c_str(), value, NEEDED);
    if (p.value.contains("indices"))
        mark_accessor(p, "indices", p.value["indices"], NEEDED);
    if (p.value.contains("targets"))
        for (const gltf_json &target : p.value["targets"])
            for (const auto &[name, value] : target.items())
                mark_accessor(p, name.c_str(), value, NEEDED);
    if (const gltf_json *draco = p.extension("KHR_draco_mesh_compression")) {
        keeps_draco = true;
        mark_view({ *draco, p.list, p.number }, NEEDED);
    }
}

void taker::mark_skins_and_animations()
{
    for (size_t i = 0; i < count("skins"); i++) {
        const gltf_item skin = item("skins", i);
        if (skin.value.contains("inverseBindMatrices"))
            mark_accessor(skin, "inverseBindMatrices",
                          skin.value["inverseBindMatrices"], NEEDED);
    }
    for (size_t i = 0; i < count("animations"); i++) {
        const gltf_item animation = item("animations", i);
        const auto samplers = animation.value.find("samplers");
        if (samplers == animation.value.end() || !samplers->is_array())
            animation.fail("samplers are missing");
        for (const gltf_json &sampler : *samplers)
            for (const char *end : { "input", "output" })
                if (sampler.is_object() && sampler.contains(end))
                    mark_accessor(animation, end, sampler[end], ANIMATION);
    }
}

/* ---- primitives --------------------------------------------------------- */

gltf_document taker::attribute(const gltf_primitive &p,
                               const gltf_channel &channel, int number)
{
    const gltf_accessor *a = gltf_channel_accessor(&model, &p, &channel);
    const gltf_item from = item("accessors", a->number);
    gltf_document to = { { "channel", number },
                         { "type", from.value["type"].get<std::string>() },
                         { "componentType", from.whole("componentType") } };
    if (from.value.value("normalized", gltf_json()) == true)
        to["normalized"] = true;
    if (channel.exact)
        to["exact"] = true;
    return to;
}

gltf_document taker::set(const gltf_primitive &p,
                         const gltf_channels &channels, uint32_t number)
{
    gltf_document to = gltf_document::object();
    for (size_t i = 0; i < channels.count; i++) {
        const gltf_channel &c = channels.item[i];
        if (c.set == number && gltf_channel_accessor(&model, &p, &c))
            to[c.semantic] = attribute(p, c, static_cast<int>(i));
    }
    return to;
}

void taker::code_primitive(gltf_document &to, const gltf_primitive &p,
                           const gltf_stream &stream)
{
    gltf_document record = { { "mesh", stream.number },
                             { "material", stream.material } };
    record["attributes"] = set(p, stream.channels, 0);
    record["attributes"]["POSITION"] = gltf_document::object();
    for (uint32_t i = 1; i < p.set_count; i++)
        gltf_list(record, "targets").push_back(set(p, stream.channels, i));
    for (const char *member : { "indices", "mode", "targets" })
        gltf_erase(to, member);
    to["attributes"] = gltf_document::object();
    gltf_erase_extension(to, "KHR_draco_mesh_compression");
    gltf_object(to, "extensions")[GLTF_PROGRESSIVE] = std::move(record);
}

void taker::meshes()
{
    for (size_t i = 0; i < count("meshes"); i++) {
        const gltf_json &primitives = in["meshes"][i]["primitives"];
        size_t next = model.meshes[i].first; /* points and lines are not there */
        for (size_t k = 0; k < primitives.size(); k++) {
            const gltf_item from{ primitives[k], "meshes", i };
            if (from.whole("mode", 4) < 4) {
                mark_kept(from);
                continue;
            }
            const gltf_stream &stream = streams[next];
            if (stream.number == GLTF_NONE)
                mark_kept(from);
            else
                code_primitive(doc["meshes"][i]["primitives"][k],
                               model.primitives[next], stream);
            next++;
        }
    }
}

/* ---- resources ---------------------------------------------------------- */

size_t taker::add_view(size_t resource, size_t size)
{
    gltf_list(doc, "bufferViews").push_back({ { "buffer", resource },
                                              { "byteLength", size } });
    view_use.push_back(NEEDED);
    return view_use.size() - 1;
}

const char *mime_of(const gltf_bytes &b)
{
    const auto starts = [&b](const char *magic, size_t n, size_t at = 0) {
        return b.size() >= at + n && memcmp(b.data() + at, magic, n) == 0;
    };
    if (starts("\x89PNG", 4))
        return "image/png";
    if (starts("\xFF\xD8\xFF", 3))
        return "image/jpeg";
    if (starts("RIFF", 4) && starts("WEBP", 4, 8))
        return "image/webp";
    if (starts("\xABKTX 20\xBB", 8))
        return "image/ktx2";
    if (starts("DDS ", 4))
        return "image/vnd-ms.dds";
    return nullptr;
}

/* Each image is a resource; those beside the file move in. */
void taker::images()
{
    if (!doc.contains("bufferViews")) /* before references into doc are held */
        doc["bufferViews"] = gltf_document::array();
    for (size_t i = 0; i < count("images"); i++) {
        const gltf_item image = item("images", i);
        gltf_document &to = doc["images"][i];
        const uint32_t view = image.id("bufferView", count("bufferViews"));
        const size_t resource = parts.resources.size();
        if (view != GLTF_NONE) {
            if (image_taken[view])
                continue; /* two images, one view */
            image_taken[view] = true;
            gltf_bytes bytes = view_bytes(view);
            gltf_document &place = doc["bufferViews"][view];
            place["buffer"] = resource;
            place["byteLength"] = bytes.size();
            gltf_erase(place, "byteOffset");
            gltf_erase_extension(place, "EXT_meshopt_compression");
            parts.resources.push_back(std::move(bytes));
            continue;
        }
        const auto uri = image.value.find("uri");
        if (uri == image.value.end() || !uri->is_string())
            continue;
        const auto &name = uri->get_ref<const std::string &>();
        asset_error error = {};
        uint64_t size = 0;
        gltf_bytes bytes;
        bool ok = gltf_uri_size(&source, name.c_str(), name.size(), &size,
                                &error) && size > 0;
        if (ok && source.leave_images && name.compare(0, 5, "data:") != 0) {
            parts.outside += "image " + std::to_string(i) + " stays in " +
                             name + "\n";
            continue;
        }
        if (ok) {
            bytes.resize(size);
            ok = gltf_uri_read(&source, name.c_str(), name.size(),
                               bytes.data(), size, &error);
        }
        if (ok)
            gltf_pay_side(sides, image, name, size, budget);
        const char *mime = ok ? mime_of(bytes) : nullptr;
        if (!ok || !mime) {
            asset_warn(warnings, "image %zu stays outside: %s", i,
                       ok ? "of an unknown type" : error.what);
            continue;
        }
        gltf_erase(to, "uri");
        to["bufferView"] = add_view(resource, bytes.size());
        to["mimeType"] = mime;
        if (!to.contains("name") && name.compare(0, 5, "data:") != 0)
            to["name"] = name;
        parts.resources.push_back(std::move(bytes));
    }
}

/* All other views: those of animations behind the meshes, the rest before. */
void taker::views()
{
    for (const use kind : { NEEDED, ANIMATION }) {
        gltf_bytes all;
        for (size_t i = 0; i < count("bufferViews"); i++) {
            if (view_use[i] != kind || image_view[i])
                continue;
            const gltf_bytes bytes = view_bytes(i);
            gltf_document &to = doc["bufferViews"][i];
            all.resize((all.size() + 7) / 8 * 8);
            to["buffer"] = parts.resources.size();
            to["byteOffset"] = all.size();
            to["byteLength"] = bytes.size();
            gltf_erase_extension(to, "EXT_meshopt_compression");
            all.insert(all.end(), bytes.begin(), bytes.end());
        }
        if (!all.empty())
            parts.resources.push_back(std::move(all));
        if (kind == NEEDED)
            parts.early = parts.resources.size();
    }
}

void taker::free_places()
{
    gltf_document root = gltf_document::object();
    const struct {
        const char *name;
        const std::vector<use> &uses;
    } lists[] = { { "accessors", accessor_use }, { "bufferViews", view_use } };

    for (const auto &list : lists) {
        gltf_document numbers = gltf_document::array();
        size_t size = list.uses.size();
        while (size > 0 && list.uses[size - 1] == FREE)
            doc[list.name].erase(--size);
        for (size_t i = 0; i < size; i++) {
            if (list.uses[i] != FREE)
                continue;
            numbers.push_back(i);
            doc[list.name][i] = gltf_document::object();
        }
        if (size == 0)
            gltf_erase(doc, list.name);
        root[list.name] = std::move(numbers);
    }
    gltf_object(doc, "extensions")[GLTF_PROGRESSIVE] = std::move(root);
}

/* Names in extensionsUsed and extensionsRequired that are true no more. */
void taker::extensions()
{
    for (const char *list : { "extensionsUsed", "extensionsRequired" }) {
        if (!doc.contains(list))
            continue;
        gltf_document left = gltf_document::array();
        for (const gltf_document &name : doc[list]) {
            const bool gone =
                name == "EXT_meshopt_compression" ||
                (name == "KHR_draco_mesh_compression" && !keeps_draco) ||
                (name == "KHR_mesh_quantization" && !keeps_primitives);
            if (!gone)
                left.push_back(name);
        }
        if (left.empty())
            gltf_erase(doc, list);
        else
            doc[list] = std::move(left);
    }
}

gltf_parts taker::take()
{
    mark_unknown(in);
    mark_skins_and_animations();
    meshes();
    image_view.assign(view_use.size(), false);
    image_taken = image_view;
    for (size_t i = 0; i < count("images"); i++) {
        const gltf_item image = item("images", i);
        mark_view(image, NEEDED);
        if (image.value.contains("bufferView"))
            image_view[image.id("bufferView", view_use.size())] = true;
    }
    views();
    images();
    free_places();
    extensions();
    gltf_erase(doc, "buffers");
    for (const gltf_bytes &bytes : parts.resources)
        gltf_list(doc, "buffers").push_back({ { "byteLength", bytes.size() } });
    parts.document = doc.dump();
    return std::move(parts);
}

} // namespace

void gltf_erase(gltf_document &object, const char *member)
{
    if (!object.is_object() || !object.contains(member))
        return;
    gltf_document rest = gltf_document::object();
    for (auto &item : object.items())
        if (item.key() != member)
            rest[item.key()] = std::move(item.value());
    object = std::move(rest);
}

void gltf_erase_extension(gltf_document &object, const char *name)
{
    if (!object.contains("extensions"))
        return;
    gltf_erase(object["extensions"], name);
    if (object["extensions"].empty())
        gltf_erase(object, "extensions");
}

gltf_parts gltf_take_apart(const gltf_source &source, const gltf_model &model,
                           const std::vector<gltf_stream> &streams,
                           gltf_sides &sides, gltf_budget &budget,
                           asset *warnings)
{
    return taker(source, model, streams, sides, budget, warnings).take();
}
