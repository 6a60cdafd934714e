/* SPDX-License-Identifier: MIT */
/*
 * scene_library.cpp - a scene's materials for OBJ: a .mtl text, and the images
 * that it names. Names of materials become unique, for OBJ knows them by name.
 */
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <new>
#include <set>

#include "tools/scene_writer.h"

namespace {

constexpr uint64_t block = 4096;

/* Made when it is first asked for: before main() nobody tells of memory that
 * lacks. */
const gltf_document &nothing()
{
    static const gltf_document none = gltf_document::object();
    return none;
}

const gltf_document &member(const gltf_document &of, const char *name)
{
    const auto found = of.is_object() ? of.find(name) : of.end();
    return found != of.end() ? *found : nothing();
}

double factor(const gltf_document &of, const char *name, double fallback)
{
    const gltf_document &value = member(of, name);
    return value.is_number() ? value.get<double>() : fallback;
}

/* A colour's component; the fallback if there is no such list. */
double component(const gltf_document &of, const char *name, size_t k,
                 double fallback)
{
    const gltf_document &list = member(of, name);
    return list.is_array() && k < list.size() && list[k].is_number()
               ? list[k].get<double>()
               : fallback;
}

/* JSON may hold what no float does. */
void put_number(asset_bytes *out, double value)
{
    constexpr double most = std::numeric_limits<float>::max();
    char text[40];
    const size_t n = asset_number_print_float(
        text + 1, static_cast<float>(std::clamp(value, -most, most)));
    text[0] = ' ';
    asset_put(out, text, n + 1);
}

void put_color(asset_bytes *out, const char *word, const gltf_document &of,
               const char *name, double fallback)
{
    asset_printf(out, "%s", word);
    for (size_t k = 0; k < 3; k++)
        put_number(out, component(of, name, k, fallback));
    asset_printf(out, "\n");
}

/* By the first bytes: names and types are often wrong or not there. */
const char *ending_of(const uint8_t *data, size_t size)
{
    static const struct {
        const char *magic, *ending;
    } kinds[] = { { "\x89PNG", "png" }, { "\xff\xd8\xff", "jpg" },
                  { "RIFF", "webp" },   { "\xabKTX", "ktx2" },
                  { "DDS ", "dds" } };
    for (const auto &kind : kinds)
        if (size > 4 && memcmp(data, kind.magic, strlen(kind.magic)) == 0)
            return kind.ending;
    return "bin";
}

/* Control characters would end a line. */
std::string name_of(const gltf_document &material, size_t number)
{
    const gltf_document &name = member(material, "name");
    std::string text = name.is_string() ? name.get<std::string>() : "";

    for (char &c : text)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F)
            c = '_';
    return text.empty() ? "material_" + std::to_string(number) : text;
}

/* Of an image that is a file; false if no line can name it. */
bool put_path(asset_bytes *out, const char *word, const std::string &uri)
{
    std::vector<char> path(uri.size() + 1);

    if (!gltf_uri_path(uri.c_str(), uri.size(), path.data()))
        return false;
    asset_printf(out, "%s %s\n", word, path.data());
    return true;
}

} // namespace

/* The image of a texture, or SIZE_MAX; extensions name others of theirs. */
size_t scene_writer::image_of(const gltf_document &slot) const
{
    const gltf_document &index = member(slot, "index");
    const gltf_document &textures = member(doc, "textures");

    if (gltf_number_of(index) >= textures.size())
        return SIZE_MAX;
    const gltf_document &texture = textures.at(gltf_number_of(index));
    const gltf_document *source = &member(texture, "source");
    for (const gltf_document &extension : member(texture, "extensions"))
        if (!source->is_number_unsigned())
            source = &member(extension, "source");
    const uint32_t image = gltf_number_of(*source);
    return image < member(doc, "images").size() ? image : SIZE_MAX;
}

/* Makes room for one more image: their array doubles. */
static void reserve_image(scene_library *to)
{
    const size_t n = to->image_count;

    if ((n & (n - 1)) != 0)
        return; /* not full: it holds the next power of two */
    scene_image *grown = static_cast<scene_image *>(
        realloc(to->images, (n ? 2 * n : 1) * sizeof *to->images));
    if (!grown)
        throw std::bad_alloc();
    to->images = grown;
}

/* The image's bytes, added to the library; its ending, or nullptr. Images may
 * share bytes, but each is a file of its own, of a block at least. */
const char *scene_writer::add_image(const gltf_document &image, size_t number)
{
    scene_library *to = style.library;

    if (!image.contains("bufferView"))
        return nullptr;
    const gltf_document &view =
        doc["bufferViews"].at(gltf_number_of(image["bufferView"]));
    const pmesh_scene_bytes all =
        pmesh_scene_resource(scene, gltf_number_of(view.at("buffer")));
    const uint64_t offset = offset_of(view);
    const uint64_t size = gltf_number(view.at("byteLength"));
    if (!all.data || offset > all.arrived || size > all.arrived - offset)
        return nullptr;
    if (!gltf_spend(&budget, 1, size + block))
        throw std::runtime_error("the images are longer than a file of this "
                                 "size may have");
    const uint8_t *data = static_cast<const uint8_t *>(all.data) + offset;
    reserve_image(to);
    to->images[to->image_count++] = { number, data, static_cast<size_t>(size),
                                      ending_of(data,
                                                static_cast<size_t>(size)) };
    return to->images[to->image_count - 1].ending;
}

/* The same once for all materials that show it. */
const char *scene_writer::library_image(size_t number)
{
    const auto found = endings.find(number);

    if (found != endings.end())
        return found->second;
    return endings[number] = add_image(doc["images"].at(number), number);
}

void scene_writer::library_map(const char *word, const gltf_document &slot)
{
    scene_library *to = style.library;
    const size_t image = image_of(slot);
    const char *ending = image == SIZE_MAX ? nullptr : library_image(image);
    const gltf_document &uri =
        image == SIZE_MAX ? nothing() : member(doc["images"].at(image), "uri");

    if (ending)
        asset_printf(&to->mtl, "%s %s-%zu.%s\n", word, to->stem, image,
                     ending);
    else if (uri.is_string() && put_path(&to->mtl, word, uri))
        return;
    else if (image != SIZE_MAX)
        to->missing = true;
}

void scene_writer::library_material(const gltf_document &material)
{
    asset_bytes *out = &style.library->mtl;
    const gltf_document &pbr = member(material, "pbrMetallicRoughness");

    asset_printf(out, "\nnewmtl %s\n",
                 material["name"].get<std::string>().c_str());
    put_color(out, "Kd", pbr, "baseColorFactor", 1);
    put_color(out, "Ke", material, "emissiveFactor", 0);
    const bool blended = member(material, "alphaMode") == "BLEND";
    asset_printf(out, "d");
    put_number(out, blended ? component(pbr, "baseColorFactor", 3, 1) : 1);
    asset_printf(out, "\nPr");
    put_number(out, factor(pbr, "roughnessFactor", 1));
    asset_printf(out, "\nPm");
    put_number(out, factor(pbr, "metallicFactor", 1));
    asset_printf(out, "\n");
    library_map("map_Kd", member(pbr, "baseColorTexture"));
    library_map("map_Ke", member(material, "emissiveTexture"));
    library_map("norm", member(material, "normalTexture"));
}

/* Before views move: they still name resources. */
void scene_writer::library()
{
    std::set<std::string> taken;

    if (!style.library || !doc.contains("materials"))
        return;
    gltf_document &materials = doc["materials"];
    for (size_t i = 0; i < materials.size(); i++) {
        std::string name = name_of(materials[i], i);
        while (!taken.insert(name).second)
            name += "_" + std::to_string(i);
        materials[i]["name"] = name;
        library_material(materials[i]);
    }
    if (style.library->mtl.failed)
        throw std::bad_alloc();
}

void scene_library_free(scene_library *library)
{
    asset_bytes_free(&library->mtl);
    free(library->images);
    library->images = nullptr;
    library->image_count = 0;
}
