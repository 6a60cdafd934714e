/* SPDX-License-Identifier: MIT */
/*
 * scene_draco.cpp - primitives by KHR_draco_mesh_compression. Accessors keep
 * their places, but describe what the stream decodes to; its points may come in
 * another order and number.
 */
#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstring>

#include <draco/compression/expert_encode.h>

#include "tools/draco.h"
#include "tools/scene_writer.h"

namespace {

constexpr int speed = 3; /* compression level 7 */

using draco::GeometryAttribute;
using draco::PointAttribute;
using draco::PointIndex;

draco::DataType type_of(const scene_array &data)
{
    switch (data.component_type) {
    case GLTF_I8:
        return draco::DT_INT8;
    case GLTF_U8:
        return draco::DT_UINT8;
    case GLTF_I16:
        return draco::DT_INT16;
    case GLTF_U16:
        return draco::DT_UINT16;
    default:
        return draco::DT_FLOAT32;
    }
}

GeometryAttribute::Type kind_of(const std::string &semantic)
{
    const std::string kind = semantic.substr(0, semantic.find('_'));
    return kind == "POSITION"   ? GeometryAttribute::POSITION
           : kind == "NORMAL"   ? GeometryAttribute::NORMAL
           : kind == "TEXCOORD" ? GeometryAttribute::TEX_COORD
           : kind == "COLOR"    ? GeometryAttribute::COLOR
                                : GeometryAttribute::GENERIC;
}

/* Its number, by which the extension names it. */
int add_attribute(draco::Mesh *mesh, const std::string &semantic,
                  const scene_array &data)
{
    const draco::DataType type = type_of(data);
    const auto width = static_cast<int64_t>(
        data.components * static_cast<unsigned>(draco::DataTypeLength(type)));
    const auto count = static_cast<uint32_t>(data.count);
    GeometryAttribute format;

    format.Init(kind_of(semantic), nullptr,
                static_cast<uint8_t>(data.components), type, data.normalised,
                width, 0);
    const int number = mesh->AddAttribute(format, true, count);
    PointAttribute *a = mesh->attribute(number);
    for (uint32_t i = 0; i < count; i++)
        a->SetAttributeValue(draco::AttributeValueIndex(i),
                             &data.bytes[size_t{ i } * data.stride]);
    /* Seams are where neighbouring corners name different values. */
    a->DeduplicateValues(*a);
    return number;
}

/* Whether some face has a position twice. */
bool add_faces(draco::Mesh *mesh, const scene_array &indices)
{
    const PointAttribute *positions = mesh->attribute(0);
    const size_t size = indices.component_type == GLTF_U32 ? 4 : 2;
    const uint8_t *at = indices.bytes.data();
    bool degenerate = false;

    mesh->SetNumFaces(indices.count / 3);
    for (uint32_t f = 0; f < indices.count / 3; f++) {
        draco::Mesh::Face face;
        draco::AttributeValueIndex v[3];
        for (size_t k = 0; k < 3; k++, at += size) {
            uint32_t point = 0;
            for (size_t i = 0; i < size; i++)
                point |= uint32_t{ at[i] } << (8 * i);
            face[k] = PointIndex(point);
            v[k] = positions->mapped_index(face[k]);
        }
        mesh->SetFace(draco::FaceIndex(f), face);
        degenerate |= v[0] == v[1] || v[1] == v[2] || v[2] == v[0];
    }
    return degenerate;
}

/* Draco computes the cell of a value without looking whether there is one: a
 * number that is not finite, or far from the grid, is written out of bounds. */
bool fits_grid(const scene_array &data)
{
    const scene_grid &grid = data.grid;
    const float cell = grid.range / static_cast<float>(1u << grid.bits);
    bool fits = grid.range > 0 && std::isfinite(grid.range);

    for (size_t i = 0; i < data.count; i++)
        for (size_t k = 0; k < data.components; k++) {
            float value;
            memcpy(&value, &data.bytes[i * data.stride + k * sizeof value],
                   sizeof value);
            if (!(std::fabs(value) < FLT_MAX / 4))
                throw std::runtime_error("a number is too large for Draco");
            const float from = value - grid.origin[k % 3];
            fits = fits && from > -cell && from < grid.range + cell;
        }
    return fits;
}

void set_grid(draco::ExpertEncoder *encoder, int number,
              const scene_array &data)
{
    const auto bits = static_cast<int>(data.grid.bits);
    if (data.component_type != GLTF_F32 || bits == 0)
        return; /* as they are */
    if (fits_grid(data))
        encoder->SetAttributeExplicitQuantization(
            number, bits, static_cast<int>(data.components), data.grid.origin,
            data.grid.range);
    else
        encoder->SetAttributeQuantization(number, bits);
}

void encode(const draco::Mesh &mesh, draco::ExpertEncoder *encoder,
            bool sequential, gltf_bytes *out)
{
    draco::EncoderBuffer buffer;

    encoder->SetSpeedOptions(speed, speed);
    encoder->SetEncodingMethod(sequential
                                   ? draco::MESH_SEQUENTIAL_ENCODING
                                   : draco::MESH_EDGEBREAKER_ENCODING);
    const draco::Status status = encoder->EncodeToBuffer(&buffer);
    if (!status.ok() || mesh.num_points() == 0)
        throw std::runtime_error("Draco: " + status.error_msg_string());
    out->assign(buffer.data(), buffer.data() + buffer.size());
}

/* What the stream's readers will see of the positions, which come first. */
void read_back(const gltf_bytes &stream, scene_array *positions, size_t *faces)
{
    const auto mesh = draco_decode(stream.data(), stream.size());
    const PointAttribute *from =
        mesh->GetNamedAttribute(GeometryAttribute::POSITION);
    const std::vector<float> xyz =
        from ? draco_values(*mesh, *from, 3) : std::vector<float>();

    if (xyz.empty())
        throw std::runtime_error("Draco lost the positions of a primitive");
    *faces = mesh->num_faces();
    positions->count = mesh->num_points();
    positions->low.assign(xyz.begin(), xyz.begin() + 3);
    positions->high = positions->low;
    for (size_t i = 0; i < xyz.size(); i++) {
        float &low = positions->low[i % 3], &high = positions->high[i % 3];
        low = std::min(low, xyz[i]);
        high = std::max(high, xyz[i]);
    }
}

} // namespace

/* An accessor without data of its own. */
size_t scene_writer::add_described(const scene_array &data, size_t count,
                                   bool bounds)
{
    return place("accessors", free_accessors,
                 accessor_of(data, count, bounds));
}

void scene_writer::pack_draco(gltf_document &p, scene_array positions,
                              const std::map<std::string, scene_array> &others,
                              scene_array indices, bool ordered)
{
    draco::Mesh mesh;
    std::map<std::string, int> ids;
    gltf_bytes stream;
    size_t faces;

    mesh.set_num_points(static_cast<uint32_t>(positions.count));
    ids["POSITION"] = add_attribute(&mesh, "POSITION", positions);
    for (const auto &[semantic, data] : others)
        ids[semantic] = add_attribute(&mesh, semantic, data);
    /* The connectivity coder would lose such a face, the sequential one keeps
     * all faces, and the order of points, which morph targets have, too. */
    const bool degenerate = add_faces(&mesh, indices);
    draco::ExpertEncoder encoder(mesh);
    set_grid(&encoder, 0, positions);
    for (const auto &[semantic, data] : others)
        set_grid(&encoder, ids[semantic], data);
    encode(mesh, &encoder, degenerate || ordered, &stream);
    read_back(stream, &positions, &faces);
    if (faces != indices.count / 3 ||
        (ordered && positions.count != mesh.num_points()))
        throw std::runtime_error("Draco lost a part of a primitive");

    gltf_document attributes = {
        { "POSITION", add_described(positions, positions.count, true) }
    };
    for (const auto &[semantic, data] : others)
        attributes[semantic] = add_described(data, positions.count, false);
    p["attributes"] = std::move(attributes);
    indices.component_type = positions.count > 0xFFFF ? GLTF_U32 : GLTF_U16;
    p["indices"] = add_described(indices, indices.count, false);
    align(4);
    gltf_object(p, "extensions")[GLTF_DRACO] = {
        { "bufferView", place("bufferViews", free_views,
                              { { "buffer", 0 },
                                { "byteOffset", bin.size() },
                                { "byteLength", stream.size() } }) },
        { "attributes", ids }
    };
    bin.insert(bin.end(), stream.begin(), stream.end());
    uses_draco = true;
}
