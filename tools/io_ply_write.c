/* SPDX-License-Identifier: MIT */
/*
 * io_ply_write.c - writes binary little-endian PLY.
 *
 * A PLY vertex carries its attributes: where corners of one vertex differ, it
 * is written once for each. Positions are floats if that loses nothing.
 * Texture coordinates and custom values of set 0 only, no materials.
 */
#include <stdlib.h>
#include <string.h>

#include "tools/builder.h"
#include "tools/corners.h"

typedef struct ply_writer {
    const asset *mesh;
    bool doubles;
    const asset_attribute *normal, *uv, *color, *quality;
    corners split; /* .points NULL: vertices are written as they are */
    asset_bytes *out;
} ply_writer;

/* Everything is written little-endian, whatever the machine is. */
static void put_u32(asset_bytes *out, uint32_t value)
{
    const uint8_t bytes[] = { (uint8_t)value, (uint8_t)(value >> 8),
                              (uint8_t)(value >> 16), (uint8_t)(value >> 24) };
    asset_put(out, bytes, sizeof bytes);
}

static void put_float(asset_bytes *out, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_u32(out, bits);
}

static void put_double(asset_bytes *out, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_u32(out, (uint32_t)bits);
    put_u32(out, (uint32_t)(bits >> 32));
}

static const asset_attribute *find_attribute(const asset *mesh,
                                             pmesh_attribute_kind kind)
{
    for (size_t i = 0; i < mesh->attribute_count; i++)
        if (mesh->attributes[i].kind == kind && mesh->attributes[i].set == 0)
            return &mesh->attributes[i];
    return NULL;
}

static void choose_properties(ply_writer *ply)
{
    const asset *mesh = ply->mesh;
    for (size_t i = 0; i < 3 * mesh->vertex_count && !ply->doubles; i++) {
        const double x = mesh->positions[i];
        ply->doubles = x == x && (double)builder_float(x) != x;
    }
    ply->normal = find_attribute(mesh, PMESH_NORMAL);
    ply->uv = find_attribute(mesh, PMESH_TEXCOORD);
    ply->color = find_attribute(mesh, PMESH_COLOR);
    ply->quality = find_attribute(mesh, PMESH_GENERIC);
    if (ply->quality && ply->quality->components != 1)
        ply->quality = NULL;
}

static bool needs_split(const asset *mesh)
{
    for (size_t i = 0; i < mesh->attribute_count; i++)
        if (mesh->attributes[i].indices)
            return true;
    return false;
}

static void write_header(const ply_writer *ply, size_t vertices)
{
    const char *type = ply->doubles ? "double" : "float";
    asset_bytes *out = ply->out;
    asset_printf(out,
                 "ply\nformat binary_little_endian 1.0\nelement vertex %zu\n"
                 "property %s x\nproperty %s y\nproperty %s z\n",
                 vertices, type, type, type);
    if (ply->normal)
        asset_printf(out, "property float nx\nproperty float ny\n"
                          "property float nz\n");
    if (ply->uv)
        asset_printf(out, "property float s\nproperty float t\n");
    if (ply->color)
        asset_printf(out, "property uchar red\nproperty uchar green\n"
                          "property uchar blue\n%s",
                     ply->color->components == 4 ? "property uchar alpha\n"
                                                 : "");
    if (ply->quality)
        asset_printf(out, "property float quality\n");
    asset_printf(out,
                 "element face %zu\nproperty list uchar %s vertex_indices\n"
                 "end_header\n",
                 ply->mesh->face_count,
                 vertices > INT32_MAX ? "uint" : "int");
}

static const float *values_at(const ply_writer *ply, const asset_attribute *a,
                              size_t point)
{
    return ply->split.points
               ? corners_values(ply->mesh, a, ply->split.first[point])
               : a->values + point * a->components;
}

static void write_floats(const ply_writer *ply, const asset_attribute *a,
                         size_t point)
{
    if (!a)
        return;
    const float *v = values_at(ply, a, point);
    for (uint8_t k = 0; k < a->components; k++)
        put_float(ply->out, v[k]);
}

static void write_color(const ply_writer *ply, size_t point)
{
    const float *v = values_at(ply, ply->color, point);
    for (uint8_t k = 0; k < ply->color->components; k++) {
        const float c = v[k] > 0 ? v[k] < 1 ? v[k] : 1 : 0;
        const uint8_t byte = (uint8_t)(c * 255 + 0.5f);
        asset_put(ply->out, &byte, 1);
    }
}

static void write_vertex(const ply_writer *ply, size_t point)
{
    const asset *mesh = ply->mesh;
    const size_t vertex = ply->split.points
                              ? mesh->indices[ply->split.first[point]]
                              : point;
    for (size_t k = 0; k < 3; k++) {
        const double x = mesh->positions[3 * vertex + k];
        if (ply->doubles)
            put_double(ply->out, x);
        else
            put_float(ply->out, (float)x);
    }
    write_floats(ply, ply->normal, point);
    write_floats(ply, ply->uv, point);
    if (ply->color)
        write_color(ply, point);
    write_floats(ply, ply->quality, point);
}

bool asset_write_ply(const asset *mesh, asset_bytes *out, asset_error *error)
{
    ply_writer ply = { .mesh = mesh, .out = out };
    choose_properties(&ply);
    if (needs_split(mesh) && !corners_unify(mesh, &ply.split))
        return asset_fail(error, "", "out of memory");

    const uint32_t *points = ply.split.points ? ply.split.points
                                              : mesh->indices;
    const size_t vertices =
        ply.split.points ? ply.split.count : mesh->vertex_count;
    write_header(&ply, vertices);
    for (size_t i = 0; i < vertices; i++)
        write_vertex(&ply, i);
    for (size_t f = 0; f < mesh->face_count; f++) {
        const uint8_t three = 3;
        asset_put(out, &three, 1);
        for (size_t c = 3 * f; c < 3 * f + 3; c++)
            put_u32(out, points[c]);
    }
    corners_free(&ply.split);
    return !out->failed || asset_fail(error, "", "out of memory");
}
