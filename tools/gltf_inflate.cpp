/* SPDX-License-Identifier: MIT */
/* gltf_inflate.cpp - buffer data compressed by meshoptimizer or by Draco. */
#include <algorithm>
#include <cstring>

#include <meshoptimizer.h>

#include "tools/draco.h"
#include "tools/gltf_plain.h"

namespace {

/* meshoptimizer's densest streams: a vertex block of equal bytes shrinks 64
 * times, an index takes a third of a byte at least. */
constexpr uint64_t bytes_per_byte = 72;
constexpr uint64_t free_bytes = 1 << 16;

std::string text(const gltf_item &item, const char *member,
                 const char *fallback)
{
    const auto found = item.value.find(member);
    if (found == item.value.end())
        return fallback;
    if (!found->is_string())
        item.fail(std::string(member) + " is not a string");
    return found->get<std::string>();
}

void unfilter(const gltf_item &item, gltf_bytes &bytes, size_t count,
              size_t stride)
{
    const std::string filter = text(item, "filter", "NONE");

    if (filter == "NONE")
        return;
    if (text(item, "mode", "") != "ATTRIBUTES")
        item.fail("a filter on indices");
    if (filter == "OCTAHEDRAL" && (stride == 4 || stride == 8))
        meshopt_decodeFilterOct(bytes.data(), count, stride);
    else if (filter == "QUATERNION" && stride == 8)
        meshopt_decodeFilterQuat(bytes.data(), count, stride);
    else if (filter == "EXPONENTIAL" && stride % 4 == 0)
        meshopt_decodeFilterExp(bytes.data(), count, stride);
    else
        item.fail("unusable filter " + filter);
}

void put_u32(gltf_bytes &out, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        out.push_back(static_cast<uint8_t>(value >> (8 * i)));
}

} // namespace

gltf_bytes gltf_inflate(const gltf_item &item, const uint8_t *source,
                        size_t size, gltf_budget &budget)
{
    const std::string mode = text(item, "mode", "");
    const uint64_t count = item.whole("count");
    const uint64_t stride = item.whole("byteStride");
    const bool attributes = mode == "ATTRIBUTES";
    const bool triangles = mode == "TRIANGLES";

    if (!attributes && !triangles && mode != "INDICES")
        item.fail("unknown meshopt mode");
    if (attributes ? stride == 0 || stride > 256 || stride % 4 != 0
                   : stride != 2 && stride != 4)
        item.fail("unusable meshopt stride");
    if (triangles && count % 3 != 0)
        item.fail("meshopt triangles of " + std::to_string(count) +
                  " indices");
    if (count == 0 || count > (bytes_per_byte * size + free_bytes) / stride ||
        !gltf_spend(&budget, count, stride))
        item.fail("meshopt claims more elements than its bytes can hold");

    gltf_bytes out(count * stride);
    const int status =
        attributes
            ? meshopt_decodeVertexBuffer(out.data(), count, stride, source,
                                         size)
        : triangles
            ? meshopt_decodeIndexBuffer(out.data(), count, stride, source, size)
            : meshopt_decodeIndexSequence(out.data(), count, stride, source,
                                          size);
    if (status != 0)
        item.fail("damaged meshopt data");
    unfilter(item, out, count, stride);
    return out;
}

gltf_draco gltf_inflate_draco(const gltf_item &primitive, const gltf_json &ids,
                              const std::vector<std::string> &normalised,
                              const uint8_t *source, size_t size,
                              gltf_budget &budget)
{
    gltf_draco out;
    const auto mesh = draco_decode(source, size);

    out.points = mesh->num_points();
    out.faces = mesh->num_faces();
    if (!gltf_spend(&budget, out.faces, 12) ||
        !gltf_spend(&budget, out.points, 4 * 4 * (1 + ids.size())))
        primitive.fail("too much Draco data for a file of this size");
    out.indices.reserve(out.faces * 12);
    for (draco::FaceIndex f(0); f < mesh->num_faces(); ++f) {
        for (size_t k = 0; k < 3; k++)
            put_u32(out.indices, mesh->face(f)[k].value());
    }
    for (const auto &[semantic, number] : ids.items()) {
        if (!number.is_number_unsigned() || number > UINT32_MAX)
            primitive.fail("a Draco attribute id is not a number");
        const draco::PointAttribute *from =
            mesh->GetAttributeByUniqueId(number.get<uint32_t>());
        if (!from)
            primitive.fail("Draco attribute " + number.dump() +
                           " is not there");
        const unsigned n = from->num_components();
        if (n < 1 || n > 4)
            continue;
        const std::vector<float> values = draco_values(*mesh, *from, n);
        if (values.empty())
            primitive.fail("unreadable Draco attribute");
        const float unit = draco_unit(*from);
        const bool divide =
            unit > 0.0f && std::find(normalised.begin(), normalised.end(),
                                     semantic) != normalised.end();
        gltf_draco::attribute to{ semantic, n, {} };
        to.values.reserve(values.size() * 4);
        for (const float value : values) {
            const float scaled = divide ? value / unit : value;
            uint32_t bits;
            std::memcpy(&bits, &scaled, sizeof bits);
            put_u32(to.values, bits);
        }
        out.attributes.push_back(std::move(to));
    }
    return out;
}
