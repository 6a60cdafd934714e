/* SPDX-License-Identifier: MIT */
/* guide_weights.cpp - weights that come with the mesh. */
#include <cmath>
#include <cstring>
#include <memory>
#include <new>

#include "tools/guide_mask.h"
#include "tools/guide_store.h"

namespace {

const asset_attribute *find_kind(const asset *mesh, pmesh_attribute_kind kind)
{
    for (size_t i = 0; i < mesh->attribute_count; i++)
        if (mesh->attributes[i].kind == kind && mesh->attributes[i].set == 0)
            return &mesh->attributes[i];
    return nullptr;
}

const asset_attribute *find_name(const asset *mesh, const char *name)
{
    for (size_t i = 0; i < mesh->attribute_count; i++)
        if (strcmp(mesh->attributes[i].name, name) == 0)
            return &mesh->attributes[i];
    return nullptr;
}

/* Each vertex takes the largest of its corners' weights. */
template <typename weigh>
std::vector<float> gather(const asset *mesh, const asset_attribute &from,
                          weigh of)
{
    std::vector<float> out(mesh->vertex_count, -1);

    for (size_t c = 0; c < 3 * mesh->face_count; c++) {
        const size_t v = mesh->indices[c];
        const size_t tuple = from.indices ? from.indices[c] : v;
        const float w = of(from.values + tuple * from.components);
        const float clamped = w > 1 ? 1 : w >= 0 ? w : w < 0 ? 0 : 0.5f;
        if (clamped > out[v])
            out[v] = clamped;
    }
    for (float &w : out)
        if (w < 0)
            w = 0.5f;
    return out;
}

std::vector<float> from_color(const asset *mesh, const std::string &what)
{
    const asset_attribute *color = find_kind(mesh, PMESH_COLOR);
    const std::string letters = "rgba";
    size_t plus = letters.find(what.empty() ? 'x' : what[0]), minus = plus;
    const bool difference = what.size() == 3 && what[1] == '-';

    if (difference)
        minus = letters.find(what[2]);
    if (plus == std::string::npos || minus == std::string::npos ||
        (what.size() != 1 && !difference))
        guide_fail("color:" + what, "r, g, b, a or a difference such as r-b is "
                                    "expected");
    if (!color)
        guide_fail("color:" + what, "the mesh has no colours");
    if (plus >= color->components || minus >= color->components)
        guide_fail("color:" + what, "the colours have no alpha");
    return gather(mesh, *color, [=](const float *v) {
        return difference ? 0.5f + 0.5f * (v[plus] - v[minus]) : v[plus];
    });
}

std::vector<float> from_attribute(const asset *mesh, const std::string &name)
{
    const asset_attribute *found = find_name(mesh, name.c_str());

    if (!found)
        guide_fail("attr:" + name, "the mesh has no such attribute");
    return gather(mesh, *found, [](const float *v) { return v[0]; });
}

std::vector<float> from_texture(const asset *mesh, const std::string &path)
{
    const asset_attribute *uv = find_kind(mesh, PMESH_TEXCOORD);
    guide_mask mask = {};
    const std::unique_ptr<guide_mask, void (*)(guide_mask *)> freed(
        &mask, guide_mask_free);
    asset_error error;

    if (!uv)
        guide_fail("texture:" + path, "the mesh has no texture coordinates");
    if (!guide_mask_read(path.c_str(), &mask, &error))
        guide_fail("texture:" + path, error.what);
    return gather(mesh, *uv, [&](const float *v) {
        return guide_mask_at(&mask, v[0],
                             mesh->texcoords_down ? v[1] : 1 - v[1]);
    });
}

std::vector<float> from(const asset *mesh, const std::string &source)
{
    const size_t colon = source.find(':');
    const std::string kind = source.substr(0, colon);
    const std::string what =
        colon == std::string::npos ? "" : source.substr(colon + 1);

    if (kind == "color")
        return from_color(mesh, what);
    if (kind == "attr")
        return from_attribute(mesh, what);
    if (kind == "texture")
        return from_texture(mesh, what);
    guide_fail(source, "color:, attr: or texture: is expected");
}

} // namespace

bool guide_take_weights(guide *g, const asset *mesh, const char *source,
                        asset_error *error)
{
    guide_store *to = static_cast<guide_store *>(g->owner);

    try {
        to->weights = from(mesh, source);
        to->publish(g);
        return true;
    } catch (const std::exception &e) {
        return asset_fail(error, "", "%s", e.what());
    }
}

bool guide_take_own_weights(guide *g, const asset *mesh, asset_error *error)
{
    return !find_name(mesh, "_LOD_WEIGHT") ||
           guide_take_weights(g, mesh, "attr:_LOD_WEIGHT", error);
}
