/* SPDX-License-Identifier: MIT */
/*
 * repair.c - the border control of asset_read(): behind it every index is in
 * range, and every attribute value is finite and makes sense for its kind.
 * Positions are let through as they are.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/builder.h"

static bool indices_below(const uint32_t *indices, size_t count, size_t limit)
{
    uint32_t bad = 0;
    for (size_t i = 0; i < count; i++)
        bad |= indices[i] >= limit;
    return !bad;
}

static const char *kind_name(pmesh_attribute_kind kind)
{
    switch (kind) {
    case PMESH_NORMAL: return "normals";
    case PMESH_TEXCOORD: return "texture coordinates";
    case PMESH_COLOR: return "colours";
    case PMESH_GENERIC: break;
    }
    return "custom values";
}

static bool is_usable(const asset *mesh, const asset_attribute *a)
{
    const uint8_t n = a->components;
    const bool fits = a->kind == PMESH_NORMAL     ? n == 3
                      : a->kind == PMESH_TEXCOORD ? n == 2
                      : a->kind == PMESH_COLOR    ? n == 3 || n == 4
                                                  : n >= 1 && n <= 4;
    if (!fits || !a->values || !a->count)
        return false;
    if (!a->indices)
        return a->count >= mesh->vertex_count;
    return indices_below(a->indices, 3 * mesh->face_count, a->count);
}

static void drop_attribute(asset *mesh, size_t i)
{
    free(mesh->attributes[i].values);
    free(mesh->attributes[i].indices);
    mesh->attribute_count--;
    memmove(&mesh->attributes[i], &mesh->attributes[i + 1],
            (mesh->attribute_count - i) * sizeof mesh->attributes[0]);
}

static void repair_values(asset *mesh, asset_attribute *a)
{
    const size_t count = a->count * a->components;
    size_t bad = 0;
    for (size_t i = 0; i < count; i++) {
        if (!isfinite(a->values[i])) {
            a->values[i] = 0;
            bad++;
        }
    }
    if (bad)
        asset_warn(mesh, "%s: %zu values are not finite, now 0",
                   kind_name(a->kind), bad);
}

/* Files hold colours as 0 .. 1, or as 0 .. 255 without saying so. */
static void repair_colors(asset *mesh, asset_attribute *a)
{
    const size_t count = a->count * a->components;
    bool bytes = true;
    size_t outside = 0;
    for (size_t i = 0; i < count; i++) {
        const float v = a->values[i];
        outside += v < 0 || v > 1;
        bytes &= v >= 0 && v <= 255 && v == floorf(v);
    }
    if (!outside)
        return;
    for (size_t i = 0; i < count; i++) {
        const float v = a->values[i];
        a->values[i] = bytes ? v / 255 : v < 0 ? 0 : v > 1 ? 1 : v;
    }
    if (!bytes)
        asset_warn(mesh, "colours: %zu values outside 0 .. 1 were clamped",
                   outside);
}

static double length_of(const float *v)
{
    return sqrt((double)v[0] * v[0] + (double)v[1] * v[1] +
                (double)v[2] * v[2]);
}

/* Adds to the marked tuples the unit normals of the faces they touch. */
static void add_face_normals(const asset *mesh, asset_attribute *a,
                             const bool *marked)
{
    const uint32_t *tuples = a->indices ? a->indices : mesh->indices;
    for (size_t f = 0; f < mesh->face_count; f++) {
        const uint32_t *t = tuples + 3 * f, *v = mesh->indices + 3 * f;
        if (!marked[t[0]] && !marked[t[1]] && !marked[t[2]])
            continue;
        const double *p[3];
        double e[2][3], n[3];
        for (int k = 0; k < 3; k++)
            p[k] = mesh->positions + 3 * (size_t)v[k];
        for (int k = 0; k < 3; k++) {
            e[0][k] = p[1][k] - p[0][k];
            e[1][k] = p[2][k] - p[0][k];
        }
        for (int k = 0; k < 3; k++)
            n[k] = e[0][(k + 1) % 3] * e[1][(k + 2) % 3] -
                   e[0][(k + 2) % 3] * e[1][(k + 1) % 3];
        const double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        if (!(length > 0) || !isfinite(length))
            continue;
        for (int c = 0; c < 3; c++)
            for (int k = 0; marked[t[c]] && k < 3; k++)
                a->values[3 * (size_t)t[c] + (size_t)k] +=
                    (float)(n[k] / length);
    }
}

/* Lengths are made 1; normals without a direction come from the faces. */
static bool repair_normals(asset *mesh, asset_attribute *a)
{
    bool *marked = calloc(a->count, sizeof *marked);
    if (!marked)
        return false;
    size_t bad = 0;
    for (size_t i = 0; i < a->count; i++) {
        float *v = a->values + 3 * i;
        const double length = length_of(v);
        marked[i] = !(length > 1e-6) || !isfinite(length);
        bad += marked[i];
        for (int k = 0; k < 3; k++) {
            if (marked[i])
                v[k] = 0;
            else if (fabs(length - 1) > 1e-3)
                v[k] = (float)(v[k] / length);
        }
    }
    if (bad) {
        add_face_normals(mesh, a, marked);
        asset_warn(mesh, "normals: %zu without a direction, taken from faces",
                   bad);
    }
    for (size_t i = 0; bad && i < a->count; i++) {
        float *v = a->values + 3 * i;
        const double length = length_of(v);
        if (!marked[i])
            continue;
        for (int k = 0; k < 3; k++)
            v[k] = length > 1e-6 ? (float)(v[k] / length) : k == 2;
    }
    free(marked);
    return true;
}

static bool check_faces(const asset *mesh, asset_error *error)
{
    if (!mesh->face_count)
        return asset_fail(error, "", "there is no triangle in it");
    if (mesh->vertex_count > UINT32_MAX || mesh->face_count > UINT32_MAX)
        return asset_fail(error, "", "more than 2^32 vertices or faces");
    if (!indices_below(mesh->indices, 3 * mesh->face_count,
                       mesh->vertex_count))
        return asset_fail(error, "", "a face names a vertex that is not there");
    if (mesh->materials && !indices_below(mesh->materials, mesh->face_count,
                                          mesh->material_count))
        return asset_fail(error, "", "a face names a material that is not "
                                     "there");
    return true;
}

bool asset_check(asset *mesh, asset_error *error)
{
    if (!check_faces(mesh, error))
        return false;
    for (size_t i = 0; i < mesh->attribute_count;) {
        asset_attribute *a = &mesh->attributes[i];
        if (!is_usable(mesh, a)) {
            asset_warn(mesh, "%s: too few or out of range, left out",
                       kind_name(a->kind));
            drop_attribute(mesh, i);
            continue;
        }
        if (a->kind == PMESH_NORMAL) {
            if (!repair_normals(mesh, a))
                return asset_fail(error, "", "out of memory");
        } else {
            repair_values(mesh, a);
        }
        if (a->kind == PMESH_COLOR)
            repair_colors(mesh, a);
        i++;
    }
    return true;
}
