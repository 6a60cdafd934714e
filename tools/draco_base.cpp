/* SPDX-License-Identifier: MIT */
/*
 * draco_base.cpp - integer positions and nothing else: Draco does not quantise
 * them, and without a second attribute its points are the vertices.
 */
#include "tools/draco_base.h"

#include <cstring>
#include <new>

#include <draco/compression/encode.h>

#include "tools/draco.h"

namespace {

using draco::GeometryAttribute;
using draco::PointAttribute;
using draco::PointIndex;

constexpr int speed = 0; /* compression level 10 */

void build(const int32_t *positions, uint32_t vertex_count,
           const uint32_t *indices, uint32_t face_count, draco::Mesh *mesh)
{
    GeometryAttribute format;
    format.Init(GeometryAttribute::POSITION, nullptr, 3, draco::DT_INT32, false,
                3 * sizeof(int32_t), 0);
    mesh->set_num_points(vertex_count);
    PointAttribute *a =
        mesh->attribute(mesh->AddAttribute(format, true, vertex_count));
    for (uint32_t v = 0; v < vertex_count; v++)
        a->SetAttributeValue(draco::AttributeValueIndex(v),
                             positions + 3 * size_t{v});
    mesh->SetNumFaces(face_count);
    for (uint32_t f = 0; f < face_count; f++, indices += 3) {
        const draco::Mesh::Face face = { PointIndex(indices[0]),
                                         PointIndex(indices[1]),
                                         PointIndex(indices[2]) };
        mesh->SetFace(draco::FaceIndex(f), face);
    }
}

bool read_positions(const draco::Mesh &mesh, int32_t *positions)
{
    const PointAttribute *a =
        mesh.GetNamedAttribute(GeometryAttribute::POSITION);
    if (!a || a->num_components() != 3 || a->data_type() != draco::DT_INT32 ||
        (!a->is_mapping_identity() &&
         a->indices_map_size() < mesh.num_points()))
        return false;
    for (uint32_t v = 0; v < mesh.num_points(); v++) {
        const auto at = a->mapped_index(PointIndex(v));
        if (at.value() >= a->size() ||
            !a->ConvertValue<int32_t>(at, 3, positions + 3 * size_t{v}))
            return false;
    }
    return true;
}

} // namespace

pmesh_status draco_base_encode(void *, const int32_t *positions,
                               uint32_t vertex_count, const uint32_t *indices,
                               uint32_t face_count, void *out, size_t capacity,
                               size_t *size)
{
    try {
        draco::Mesh mesh;
        build(positions, vertex_count, indices, face_count, &mesh);
        draco::Encoder encoder;
        encoder.SetSpeedOptions(speed, speed);
        encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
        draco::EncoderBuffer buffer;
        if (!encoder.EncodeMeshToBuffer(mesh, &buffer).ok() ||
            buffer.size() > capacity)
            return PMESH_E_UNSUPPORTED;
        std::memcpy(out, buffer.data(), buffer.size());
        *size = buffer.size();
        return PMESH_OK;
    } catch (const std::bad_alloc &) {
        return PMESH_E_MEMORY;
    } catch (...) {
        return PMESH_E_UNSUPPORTED;
    }
}

pmesh_status draco_base_decode(void *, const void *data, size_t size,
                               uint32_t vertex_count, uint32_t face_count,
                               int32_t *positions, uint32_t *indices)
{
    const auto *bytes = static_cast<const uint8_t *>(data);
    draco_claim claim;

    try {
        if (!draco_claim_read(bytes, size, &claim) ||
            claim.faces != face_count || claim.points != vertex_count)
            return PMESH_E_CORRUPT;
        const auto mesh = draco_decode(bytes, size);
        if (mesh->num_faces() != face_count ||
            mesh->num_points() != vertex_count ||
            !read_positions(*mesh, positions))
            return PMESH_E_CORRUPT;
        for (draco::FaceIndex f(0); f < mesh->num_faces(); ++f) {
            for (size_t k = 0; k < 3; k++)
                *indices++ = mesh->face(f)[k].value();
        }
        return PMESH_OK;
    } catch (const std::bad_alloc &) {
        return PMESH_E_MEMORY;
    } catch (...) {
        return PMESH_E_CORRUPT;
    }
}
