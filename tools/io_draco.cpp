/* SPDX-License-Identifier: MIT */
/* io_draco.cpp - the bridge to Draco: .drc both ways, and its part of glTF. */
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <new>
#include <stdexcept>

#include <draco/compression/decode.h>
#include <draco/compression/encode.h>

#include "tools/asset.h"
#include "tools/corners.h"
#include "tools/draco.h"
#include "tools/ration.h"

namespace {

/* Written with these. On a 16-bit grid a position moves by at most 1/131070 of
 * the largest extent; speed 3 is the encoder's compression level 7. */
constexpr int position_bits = 16;
constexpr int normal_bits = 10;
constexpr int texcoord_bits = 12;
constexpr int generic_bits = 12;
constexpr int speed = 3;

/* Read with these: what a stream may claim before Draco takes memory for it. A
 * flat regular grid, the easiest mesh there is, has about 40 faces a byte. */
constexpr uint64_t max_faces = uint64_t{1} << 27;
constexpr uint64_t free_faces = uint64_t{1} << 16;
constexpr uint64_t faces_per_byte = 128;

/* What it may ask for then: at once a table of entropy coding (4 MiB) or 24
 * bytes for each face and point, in all 250 of these, as measured with normals
 * and texture coordinates; 5 and 16 times as much, for more attributes. */
constexpr uint64_t table_bytes = uint64_t{6} << 20, bytes_at_once = 128;
constexpr uint64_t many_tables = uint64_t{128} << 20, bytes_in_all = 4096;

using draco::GeometryAttribute;
using draco::PointAttribute;
using draco::PointIndex;

bool is_integer(const PointAttribute &attribute)
{
    return attribute.data_type() >= draco::DT_INT8 &&
           attribute.data_type() <= draco::DT_UINT64;
}

/* Faces and points. */
uint64_t check_claim(const uint8_t *data, size_t size)
{
    draco_claim claim;
    if (!draco_claim_read(data, size, &claim))
        throw std::runtime_error("not a Draco stream, or cut off");
    if (!claim.mesh)
        throw std::runtime_error("a Draco point cloud has no triangles");
    uint64_t limit = free_faces + faces_per_byte * size;
    if (limit > max_faces)
        limit = max_faces;
    if (claim.faces > limit || claim.points > 3 * limit)
        throw std::runtime_error("the Draco stream claims more faces than its "
                                 "bytes can hold");
    return claim.faces + claim.points;
}

std::unique_ptr<draco::Mesh> decode(const uint8_t *data, size_t size)
{
    const uint64_t n = check_claim(data, size);
    const ration memory(table_bytes + bytes_at_once * n,
                        many_tables + bytes_in_all * n);
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char *>(data), size);
    try {
        draco::Decoder decoder;
        auto result = decoder.DecodeMeshFromBuffer(&buffer);
        if (!result.ok())
            throw std::runtime_error("damaged Draco stream: " +
                                     result.status().error_msg_string());
        return std::move(result).value();
    } catch (const std::bad_alloc &) {
        if (!memory.was_too_small())
            throw;
        throw std::runtime_error("the Draco stream asks for more memory than "
                                 "its faces need");
    }
}

} // namespace

std::unique_ptr<draco::Mesh> draco_decode(const uint8_t *data, size_t size)
{
    std::unique_ptr<draco::Mesh> mesh = decode(data, size);

    if (!mesh || mesh->num_faces() == 0)
        throw std::runtime_error("the Draco stream has no triangles");
    for (draco::FaceIndex f(0); f < mesh->num_faces(); ++f) {
        for (size_t k = 0; k < 3; k++) {
            if (mesh->face(f)[k].value() >= mesh->num_points())
                throw std::runtime_error("damaged Draco stream: a face names "
                                         "a point that is not there");
        }
    }
    return mesh;
}

float draco_unit(const PointAttribute &attribute)
{
    switch (attribute.data_type()) {
    case draco::DT_INT8:
        return 127.0f;
    case draco::DT_UINT8:
        return 255.0f;
    case draco::DT_INT16:
        return 32767.0f;
    case draco::DT_UINT16:
        return 65535.0f;
    default:
        return is_integer(attribute) ? 4294967295.0f : 0.0f;
    }
}

std::vector<float> draco_values(const draco::Mesh &mesh,
                                const PointAttribute &attribute,
                                unsigned components)
{
    const size_t points = mesh.num_points();
    std::vector<float> out(points * components);

    if (!attribute.is_mapping_identity() &&
        attribute.indices_map_size() < points)
        return {};
    for (size_t i = 0; i < points; i++) {
        const auto at =
            attribute.mapped_index(PointIndex(static_cast<uint32_t>(i)));
        float *dst = &out[i * components];
        const auto n = static_cast<int8_t>(components);
        int64_t whole[4];
        if (at.value() >= attribute.size())
            return {};
        if (!is_integer(attribute)) {
            if (!attribute.ConvertValue<float>(at, n, dst))
                return {};
            continue;
        }
        if (!attribute.ConvertValue<int64_t>(at, n, whole))
            return {};
        for (unsigned k = 0; k < components; k++)
            dst[k] = static_cast<float>(whole[k]);
    }
    return out;
}

namespace {

template <typename T> T *take(size_t count)
{
    T *p = static_cast<T *>(std::calloc(count + 1, sizeof(T)));
    if (!p)
        throw std::bad_alloc();
    return p;
}

/* The kind of an attribute that an asset can hold; false for others. */
bool attribute_kind(const PointAttribute &attribute, pmesh_attribute_kind *kind)
{
    const unsigned n = attribute.num_components();
    switch (attribute.attribute_type()) {
    case GeometryAttribute::NORMAL:
        *kind = PMESH_NORMAL;
        return n == 3;
    case GeometryAttribute::TEX_COORD:
        *kind = PMESH_TEXCOORD;
        return n == 2;
    case GeometryAttribute::COLOR:
        *kind = PMESH_COLOR;
        return n == 3 || n == 4;
    case GeometryAttribute::GENERIC:
        *kind = PMESH_GENERIC;
        return n >= 1 && n <= 4;
    default:
        return false;
    }
}

void read_attribute(const draco::Mesh &mesh, const PointAttribute &attribute,
                    asset *out)
{
    pmesh_attribute_kind kind;
    if (!attribute_kind(attribute, &kind) ||
        out->attribute_count == PMESH_MAX_ATTRIBUTES) {
        asset_warn(out, "a Draco attribute is left out");
        return;
    }
    const unsigned n = attribute.num_components();
    std::vector<float> values = draco_values(mesh, attribute, n);
    if (values.empty()) {
        asset_warn(out, "an unreadable Draco attribute is left out");
        return;
    }
    const float unit = draco_unit(attribute);
    if (unit > 0.0f && (kind == PMESH_COLOR || attribute.normalized())) {
        for (float &v : values)
            v /= unit;
    }
    asset_attribute *a = &out->attributes[out->attribute_count];
    *a = {};
    a->kind = kind;
    for (size_t i = 0; i < out->attribute_count; i++)
        a->set = static_cast<uint8_t>(a->set +
                                      (out->attributes[i].kind == kind));
    a->components = static_cast<uint8_t>(n);
    a->values = take<float>(values.size());
    a->count = mesh.num_points();
    std::memcpy(a->values, values.data(), values.size() * sizeof(float));
    out->attribute_count++;
}

void read_mesh(const draco::Mesh &mesh, asset *out)
{
    const PointAttribute *position =
        mesh.GetNamedAttribute(GeometryAttribute::POSITION);
    if (!position || position->num_components() != 3)
        throw std::runtime_error("the Draco stream has no positions");
    const std::vector<float> values = draco_values(mesh, *position, 3);
    if (values.empty())
        throw std::runtime_error("damaged Draco stream: unreadable positions");

    out->vertex_count = mesh.num_points();
    out->face_count = mesh.num_faces();
    out->positions = take<double>(values.size());
    out->indices = take<uint32_t>(out->face_count * 3);
    out->material_count = 1;
    for (size_t i = 0; i < values.size(); i++)
        out->positions[i] = static_cast<double>(values[i]);
    for (draco::FaceIndex f(0); f < mesh.num_faces(); ++f) {
        for (size_t k = 0; k < 3; k++) {
            const uint32_t point = mesh.face(f)[k].value();
            out->indices[3 * f.value() + k] = point;
            for (size_t i = 0; i < 3; i++) {
                if (!std::isfinite(values[3 * size_t{point} + i]))
                    throw std::runtime_error("a position is not finite");
            }
        }
    }
    for (int i = 0; i < mesh.num_attributes(); i++) {
        if (mesh.attribute(i) != position)
            read_attribute(mesh, *mesh.attribute(i), out);
    }
}

} // namespace

bool asset_read_drc(const uint8_t *data, size_t size, asset *out,
                    asset_error *error)
{
    const char *what = "out of memory";
    std::string text;

    *out = {};
    try {
        read_mesh(*draco_decode(data, size), out);
        return true;
    } catch (const std::bad_alloc &) {
    } catch (const std::exception &e) {
        text.assign(e.what());
        what = text.c_str();
    } catch (...) {
        what = "damaged Draco stream";
    }
    asset_free(out);
    *out = {};
    return asset_fail(error, "", "%s", what);
}

namespace {

/* Draco takes the difference of two values as a float, and if that is infinite
 * writes out of bounds. */
constexpr float largest = std::numeric_limits<float>::max() / 2;

/* Points and faces of the mesh to write; positions that no face uses stay
 * behind, for they would stretch the grid. */
void add_positions(const asset &mesh, const corners &table, draco::Mesh *out)
{
    constexpr uint32_t none = UINT32_MAX;
    std::vector<uint32_t> renumber(mesh.vertex_count, none);
    std::vector<uint32_t> used;

    for (size_t i = 0; i < table.count; i++) {
        const uint32_t v = mesh.indices[table.first[i]];
        if (renumber[v] == none) {
            renumber[v] = static_cast<uint32_t>(used.size());
            used.push_back(v);
        }
    }
    GeometryAttribute format;
    format.Init(GeometryAttribute::POSITION, nullptr, 3, draco::DT_FLOAT32,
                false, 3 * sizeof(float), 0);
    PointAttribute *a = out->attribute(
        out->AddAttribute(format, false, static_cast<uint32_t>(used.size())));
    for (size_t i = 0; i < used.size(); i++) {
        float v[3];
        for (size_t k = 0; k < 3; k++) {
            v[k] = static_cast<float>(mesh.positions[3 * size_t{used[i]} + k]);
            if (!(std::fabs(v[k]) <= largest))
                throw std::runtime_error("a position is too large for .drc");
        }
        a->SetAttributeValue(
            draco::AttributeValueIndex(static_cast<uint32_t>(i)), v);
    }
    for (size_t i = 0; i < table.count; i++)
        a->SetPointMapEntry(
            PointIndex(static_cast<uint32_t>(i)),
            draco::AttributeValueIndex(renumber[mesh.indices[table.first[i]]]));
}

uint8_t to_byte(float value)
{
    const float unit = value > 0.0f ? value < 1.0f ? value : 1.0f : 0.0f;
    return static_cast<uint8_t>(std::lround(unit * 255.0f));
}

void add_attribute(const asset &mesh, const asset_attribute &from,
                   const corners &table, draco::Mesh *out)
{
    static const GeometryAttribute::Type types[] = {
        GeometryAttribute::NORMAL, GeometryAttribute::TEX_COORD,
        GeometryAttribute::COLOR, GeometryAttribute::GENERIC
    };
    const unsigned n = from.components;
    const bool color = from.kind == PMESH_COLOR;
    GeometryAttribute format;

    format.Init(types[from.kind], nullptr, from.components,
                color ? draco::DT_UINT8 : draco::DT_FLOAT32, color,
                static_cast<int64_t>(n * (color ? 1 : sizeof(float))), 0);
    PointAttribute *a = out->attribute(
        out->AddAttribute(format, true, static_cast<uint32_t>(table.count)));
    for (size_t i = 0; i < table.count; i++) {
        const draco::AttributeValueIndex at(static_cast<uint32_t>(i));
        float v[4];
        uint8_t bytes[4];
        std::memcpy(v, corners_values(&mesh, &from, table.first[i]),
                    n * sizeof(float));
        for (unsigned k = 0; k < n; k++) {
            if (!std::isfinite(v[k]))
                v[k] = 0.0f;
            if (!(std::fabs(v[k]) <= largest))
                throw std::runtime_error("an attribute's value is too large "
                                         "for .drc");
            bytes[k] = to_byte(v[k]);
        }
        a->SetAttributeValue(at, color ? static_cast<const void *>(bytes)
                                       : static_cast<const void *>(v));
    }
    /* Seams are where neighbouring corners name different values. */
    a->DeduplicateValues(*a);
}

/* Whether some face names a position twice: the connectivity coder would lose
 * it, the sequential one keeps every face. */
bool has_degenerate(const asset &mesh)
{
    for (size_t f = 0; f < mesh.face_count; f++) {
        const uint32_t *v = mesh.indices + 3 * f;
        if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0])
            return true;
    }
    return false;
}

void write_mesh(const asset &mesh, const corners &table, asset_bytes *out)
{
    draco::Mesh built;
    built.set_num_points(static_cast<uint32_t>(table.count));
    add_positions(mesh, table, &built);
    for (size_t i = 0; i < mesh.attribute_count; i++)
        add_attribute(mesh, mesh.attributes[i], table, &built);
    built.SetNumFaces(mesh.face_count);
    for (size_t f = 0; f < mesh.face_count; f++) {
        draco::Mesh::Face face;
        for (size_t k = 0; k < 3; k++)
            face[k] = PointIndex(table.points[3 * f + k]);
        built.SetFace(draco::FaceIndex(static_cast<uint32_t>(f)), face);
    }

    draco::Encoder encoder;
    encoder.SetSpeedOptions(speed, speed);
    encoder.SetEncodingMethod(has_degenerate(mesh)
                                  ? draco::MESH_SEQUENTIAL_ENCODING
                                  : draco::MESH_EDGEBREAKER_ENCODING);
    encoder.SetAttributeQuantization(GeometryAttribute::POSITION,
                                     position_bits);
    encoder.SetAttributeQuantization(GeometryAttribute::NORMAL, normal_bits);
    encoder.SetAttributeQuantization(GeometryAttribute::TEX_COORD,
                                     texcoord_bits);
    encoder.SetAttributeQuantization(GeometryAttribute::GENERIC, generic_bits);
    draco::EncoderBuffer buffer;
    const draco::Status status = encoder.EncodeMeshToBuffer(built, &buffer);
    if (!status.ok())
        throw std::runtime_error("Draco: " + status.error_msg_string());
    asset_put(out, buffer.data(), buffer.size());
}

} // namespace

bool asset_write_drc(const asset *mesh, asset_bytes *out, asset_error *error)
{
    corners table;
    bool ok = false;

    if (mesh->face_count == 0)
        return asset_fail(error, "", "there are no triangles to write");
    if (!corners_unify(mesh, &table))
        return asset_fail(error, "", "out of memory");
    try {
        write_mesh(*mesh, table, out);
        ok = !out->failed || asset_fail(error, "", "out of memory");
    } catch (const std::bad_alloc &) {
        asset_fail(error, "", "out of memory");
    } catch (const std::exception &e) {
        asset_fail(error, "", "%s", e.what());
    } catch (...) {
        asset_fail(error, "", "Draco failed");
    }
    corners_free(&table);
    return ok;
}
