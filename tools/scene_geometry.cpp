/* SPDX-License-Identifier: MIT */
#include "tools/scene_geometry.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <stdexcept>

#include "tools/gltf.h"

namespace {

const uint32_t none = UINT32_MAX;

unsigned size_of(uint32_t type)
{
    return type == GLTF_F32 || type == GLTF_U32 ? 4
           : type == GLTF_I8 || type == GLTF_U8 ? 1
                                                : 2;
}

void put(std::vector<uint8_t> &out, uint32_t bits, unsigned size)
{
    for (unsigned i = 0; i < size; i++)
        out.push_back(static_cast<uint8_t>(bits >> (8 * i)));
}

/* The integer nearest to `value`, in the range of the type. */
uint32_t to_integer(double value, uint32_t type)
{
    const bool is_signed = type == GLTF_I8 || type == GLTF_I16;
    const double last =
        std::ldexp(1.0, static_cast<int>(8 * size_of(type)) - is_signed) - 1;
    const double low = is_signed ? -last - 1 : 0;
    const double rounded = std::floor(value + 0.5);
    return static_cast<uint32_t>(
        static_cast<int64_t>(std::fmin(std::fmax(rounded, low), last)));
}

double unit_of(uint32_t type)
{
    return type == GLTF_U8    ? 255
           : type == GLTF_I8  ? 127
           : type == GLTF_U16 ? 65535
                              : 32767;
}

/* Packs rows, each padded to 4 bytes, as vertex data have to be. */
scene_array pack(const std::vector<float> &values, unsigned components,
                 uint32_t type, bool normalised)
{
    scene_array out;
    const unsigned size = size_of(type);

    out.components = components;
    out.component_type = type;
    out.normalised = normalised;
    out.stride = (components * size + 3) / 4 * 4;
    out.count = values.size() / components;
    out.bytes.reserve(out.count * out.stride);
    for (size_t i = 0; i < values.size(); i++) {
        uint32_t bits;
        if (type == GLTF_F32)
            memcpy(&bits, &values[i], sizeof bits);
        else
            bits = to_integer(static_cast<double>(values[i]) *
                                  (normalised ? unit_of(type) : 1),
                              type);
        put(out.bytes, bits, size);
        if ((i + 1) % components == 0)
            out.bytes.resize((out.bytes.size() + 3) / 4 * 4);
    }
    if (type != GLTF_F32)
        return out;
    out.low.assign(values.begin(), values.begin() + components);
    out.high = out.low;
    for (size_t i = 0; i < values.size(); i++) {
        const size_t k = i % components;
        out.low[k] = std::min(out.low[k], values[i]);
        out.high[k] = std::max(out.high[k], values[i]);
    }
    return out;
}

bool starts(const std::string &text, const char *prefix)
{
    return text.compare(0, strlen(prefix), prefix) == 0;
}

/* Unit vectors with a fourth component, the handedness, of 1 or -1. */
void tidy_tangents(std::vector<float> &values)
{
    for (size_t i = 0; i + 4 <= values.size(); i += 4) {
        float *v = &values[i];
        const double x = v[0], y = v[1], z = v[2];
        const double size = std::sqrt(x * x + y * y + z * z);
        const double length = std::isfinite(size) ? size : 0;
        v[0] = length > 0 ? static_cast<float>(x / length) : 1.0f;
        v[1] = length > 0 ? static_cast<float>(y / length) : 0.0f;
        v[2] = length > 0 ? static_cast<float>(z / length) : 0.0f;
        v[3] = v[3] < 0 ? -1.0f : 1.0f;
    }
}

/* The sets of skin weights of a vertex: their sum is 1, and a joint without
 * weight is joint 0, as the specification wants it. If `whole`, they are
 * multiples of 1 / 65535. */
void tidy_skin(std::vector<std::vector<float> *> &joints,
               std::vector<std::vector<float> *> &weights, bool whole)
{
    const size_t count = weights.empty() ? 0 : weights[0]->size() / 4;
    for (size_t i = 0; i < count; i++) {
        double sum = 0;
        for (const auto *set : weights)
            for (size_t k = 0; k < 4; k++)
                sum += std::fmax((*set)[4 * i + k], 0.0f);
        if (!(sum > 0)) {
            (*weights[0])[4 * i] = 1.0f;
            sum = 1;
        }
        float rest = 1.0f, *largest = nullptr;
        for (auto *set : weights)
            for (size_t k = 0; k < 4; k++) {
                float &w = (*set)[4 * i + k];
                const double share = std::fmax(w, 0.0f) / sum;
                w = static_cast<float>(
                    whole ? std::floor(share * 65535 + 0.5) / 65535 : share);
                rest -= w;
                largest = !largest || w > *largest ? &w : largest;
            }
        *largest += rest; /* what rounding left */
        for (size_t s = 0; s < joints.size() && s < weights.size(); s++)
            for (size_t k = 0; k < 4; k++)
                if (!((*weights[s])[4 * i + k] > 0))
                    (*joints[s])[4 * i + k] = 0.0f;
    }
}

/* The type to store by; floats where glTF allows no other without extension. */
uint32_t stored_type(const std::string &semantic, const scene_form &form,
                     bool whole_weights)
{
    const uint32_t type = form.component_type, floats = GLTF_F32;
    const bool small = type == GLTF_U8 || type == GLTF_U16;
    if (starts(semantic, "JOINTS_"))
        return type == GLTF_U8 ? GLTF_U8 : GLTF_U16;
    if (starts(semantic, "WEIGHTS_") && whole_weights)
        return GLTF_U16;
    if (starts(semantic, "COLOR_") || starts(semantic, "TEXCOORD_"))
        return small && form.normalised ? type : floats;
    if (semantic[0] == '_')
        return small || type == GLTF_I8 || type == GLTF_I16 ? type : floats;
    return floats;
}

} // namespace

scene_geometry::scene_geometry(const pmesh_decoder *from, bool inflate,
                               bool whole)
    : decoder(from), whole_weights(whole)
{
    if (!decoder || pmesh_decoder_header(decoder, &header) != PMESH_OK ||
        pmesh_decoder_mesh(decoder, &view) != PMESH_OK)
        throw std::runtime_error("cut off before the base mesh of every mesh");
    xyz.resize(3 * static_cast<size_t>(view.vertex_count));
    if (inflate) {
        std::vector<std::max_align_t> room(
            pmesh_decoder_inflate_room(decoder) / sizeof(std::max_align_t) +
            1);
        pmesh_decoder_copy_inflated(decoder, xyz.data(), 0, room.data());
    } else {
        pmesh_decoder_copy_positions(decoder, xyz.data(), 0);
    }
    find_grid(inflate);
    channels.resize(header.attribute_count);
    number.assign(view.vertex_count, none);

    /* A counting sort: faces of a material keep their order. */
    const auto material = [this](uint32_t f) {
        return view.materials ? view.materials[f] : 0;
    };
    first.assign(header.material_count + 2, 0);
    for (uint32_t f = 0; f < view.face_count; f++)
        first[material(f) + 2]++;
    for (size_t i = 2; i < first.size(); i++)
        first[i] += first[i - 1];
    order.resize(view.face_count);
    for (uint32_t f = 0; f < view.face_count; f++)
        order[first[material(f) + 1]++] = f;
}

/*
 * Of positions: the file's own, on which they stand already, so that primitives
 * that meet still do. Inflated ones leave it: a finer one over them all.
 */
void scene_geometry::find_grid(bool inflated)
{
    if (header.exact_bytes > 0)
        return;
    grid.bits = header.grid.bits;
    grid.range = static_cast<float>(header.grid.step *
                                    ((1u << header.grid.bits) - 1));
    for (size_t k = 0; k < 3; k++)
        grid.origin[k] = static_cast<float>(header.grid.origin[k]);
    if (!inflated)
        return;
    float low[3], high[3];
    std::copy(&xyz[0], &xyz[3], low);
    std::copy(&xyz[0], &xyz[3], high);
    for (size_t i = 0; i < xyz.size(); i++) {
        low[i % 3] = std::min(low[i % 3], xyz[i]);
        high[i % 3] = std::max(high[i % 3], xyz[i]);
    }
    grid.bits += 2;
    grid.range = 0;
    for (size_t k = 0; k < 3; k++) {
        grid.origin[k] = low[k];
        grid.range = std::max(grid.range, high[k] - low[k]);
    }
}

void scene_geometry::choose(uint32_t material)
{
    for (const uint32_t wedge : wedges)
        number[wedge] = none;
    wedges.clear();
    corners.clear();
    if (material >= header.material_count)
        throw std::runtime_error("a primitive's material is not in its mesh");
    for (uint32_t i = first[material]; i < first[material + 1]; i++)
        for (uint32_t k = 0; k < 3; k++) {
            const uint32_t wedge =
                view.indices[3 * static_cast<size_t>(order[i]) + k];
            if (number[wedge] == none) {
                number[wedge] = static_cast<uint32_t>(wedges.size());
                wedges.push_back(wedge);
            }
            corners.push_back(number[wedge]);
        }
    if (corners.empty()) {
        wedges.assign(3, 0);
        corners = { 0, 1, 2 };
    }
}

scene_array scene_geometry::indices() const
{
    scene_array out;
    const bool wide = wedges.size() > 0xFFFF; /* 65535 itself is a restart */

    out.count = corners.size();
    out.components = 1;
    out.component_type = wide ? GLTF_U32 : GLTF_U16;
    for (const uint32_t corner : corners)
        put(out.bytes, corner, wide ? 4 : 2);
    return out;
}

scene_array scene_geometry::positions() const
{
    std::vector<float> values;
    values.reserve(3 * wedges.size());
    for (const uint32_t wedge : wedges)
        values.insert(values.end(), &xyz[3 * static_cast<size_t>(wedge)],
                      &xyz[3 * static_cast<size_t>(wedge)] + 3);
    scene_array out = pack(values, 3, GLTF_F32, false);
    out.grid = grid;
    return out;
}

const std::vector<float> &scene_geometry::channel(uint32_t at)
{
    if (at >= header.attribute_count)
        throw std::runtime_error("a primitive's channel is not in its mesh");
    std::vector<float> &values = channels[at];
    if (values.empty()) {
        values.resize(static_cast<size_t>(view.vertex_count) *
                      header.attributes[at].components);
        pmesh_decoder_copy_attribute(decoder, at, values.data(), 0);
    }
    return values;
}

std::vector<float> scene_geometry::gather(const scene_form &form)
{
    const std::vector<float> &from = channel(form.channel);
    const size_t width = header.attributes[form.channel].components;
    std::vector<float> values;

    if (form.components < 1 || form.components > width)
        throw std::runtime_error("a primitive's channel has another shape");
    values.reserve(form.components * wedges.size());
    for (const uint32_t wedge : wedges)
        for (size_t k = 0; k < form.components; k++) {
            const float v = from[wedge * width + k];
            values.push_back(form.exact ? std::floor(v + 0.5f) : v);
        }
    return values;
}

std::map<std::string, scene_array>
scene_geometry::attributes(const std::map<std::string, scene_form> &forms)
{
    std::map<std::string, std::vector<float>> values;
    std::map<std::string, scene_array> out;
    std::vector<std::vector<float> *> joints, weights;

    for (const auto &[semantic, form] : forms) {
        std::vector<float> &v = values[semantic] = gather(form);
        if (semantic == "TANGENT" && form.components == 4)
            tidy_tangents(v);
        if (starts(semantic, "JOINTS_") && form.components == 4)
            joints.push_back(&v);
        if (starts(semantic, "WEIGHTS_") && form.components == 4)
            weights.push_back(&v);
    }
    tidy_skin(joints, weights, whole_weights);
    for (const auto &[semantic, form] : forms) {
        const uint32_t type = stored_type(semantic, form, whole_weights);
        scene_array &to = out[semantic] =
            pack(values[semantic], form.components, type,
                 type != GLTF_F32 &&
                     (form.normalised || starts(semantic, "WEIGHTS_")));
        /* One bit more than the file has: a quarter of its step is lost. */
        if (!form.exact)
            to.grid.bits = header.attributes[form.channel].bits + 1u;
    }
    return out;
}

scene_array scene_geometry::differences(const scene_form &form)
{
    return pack(gather(form), form.components, GLTF_F32, false);
}
