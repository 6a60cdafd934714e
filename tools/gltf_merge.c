/* SPDX-License-Identifier: MIT */
/*
 * gltf_merge.c - placed meshes into one asset.
 *
 * Only vertices that faces name are copied, each once per primitive, so that
 * primitives sharing one large buffer do not multiply it. Attribute values that
 * make no sense pass through: asset_check() repairs them for all formats.
 */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/gltf.h"

typedef struct merge {
    const gltf_model *model;
    const gltf_instance *instances;
    size_t instance_count;
    asset *out;
    asset_error *error;
    gltf_plan plan;
    uint32_t *map, *stamp, serial; /* map[v] is valid if stamp[v] == serial */
} merge;

/* One primitive in its place. */
typedef struct placed {
    const gltf_primitive *primitive;
    const gltf_accessor *position;
    const gltf_accessor *channels[PMESH_MAX_ATTRIBUTES]; /* NULL: neutral */
    const double *m;
    double cofactor[9]; /* moves normals: inverse transpose up to a factor */
    bool mirrored;
    char where[48];
} placed;

static bool reserve(merge *g)
{
    asset *out = g->out;
    const size_t vertices = (size_t)g->plan.vertex_bound;
    const size_t faces = (size_t)g->plan.faces;

    /* faces <= 2^27 and vertices <= 3 * faces: no product here overflows. */
    out->positions = malloc(vertices * 3 * sizeof *out->positions);
    out->indices = malloc(faces * 3 * sizeof *out->indices);
    if (out->material_count > 1)
        out->materials = malloc(faces * sizeof *out->materials);
    g->map = malloc((size_t)g->plan.largest * sizeof *g->map);
    g->stamp = calloc((size_t)g->plan.largest, sizeof *g->stamp);
    bool ok = out->positions && out->indices && g->map && g->stamp &&
              (out->materials || out->material_count <= 1);
    for (size_t i = 0; i < out->attribute_count; i++) {
        asset_attribute *a = &out->attributes[i];
        a->values = malloc(vertices * a->components * sizeof *a->values);
        ok = ok && a->values;
    }
    return ok;
}

static void place(const merge *g, const gltf_instance *instance, size_t k,
                  placed *p)
{
    const gltf_model *model = g->model;
    const double *m = instance->m;
    double scale = 0.0;

    p->primitive = &model->primitives[model->meshes[instance->mesh].first + k];
    p->position = &model->accessors[p->primitive->position];
    for (size_t i = 0; i < g->out->attribute_count; i++)
        p->channels[i] =
            gltf_slot_accessor(model, p->primitive,
                               g->plan.channel_slots[i]);
    p->m = m;
    snprintf(p->where, sizeof p->where, "mesh %u, primitive %zu",
             (unsigned)instance->mesh, k);

    /* Scaled to about 1, so that products of large entries stay finite. */
    for (int i = 0; i < 12; i++) {
        if (i % 4 != 3 && fabs(m[i]) > scale)
            scale = fabs(m[i]);
    }
    if (!(scale > 0.0))
        scale = 1.0;
    double a[9];
    for (int i = 0; i < 9; i++)
        a[i] = m[i / 3 * 4 + i % 3] / scale;
    for (int row = 0; row < 3; row++) {
        const double *r = a + (row + 1) % 3 * 3;
        const double *s = a + (row + 2) % 3 * 3;
        for (int col = 0; col < 3; col++) {
            const int c = (col + 1) % 3, d = (col + 2) % 3;
            p->cofactor[row * 3 + col] = r[c] * s[d] - r[d] * s[c];
        }
    }
    const double det = a[0] * p->cofactor[0] + a[1] * p->cofactor[1] +
                       a[2] * p->cofactor[2];
    p->mirrored = det < 0.0;
    for (int i = 0; p->mirrored && i < 9; i++)
        p->cofactor[i] = -p->cofactor[i];
}

static void put_normal(const placed *p, const double in[4], float *out)
{
    double n[3];
    for (int i = 0; i < 3; i++)
        n[i] = p->cofactor[i * 3] * in[0] + p->cofactor[i * 3 + 1] * in[1] +
               p->cofactor[i * 3 + 2] * in[2];
    const double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    const bool ok = length > 0.0 && isfinite(length);
    for (int i = 0; i < 3; i++)
        out[i] = ok ? (float)(n[i] / length) : 0.0f;
}

/* Without an accessor: no direction (asset_check() takes the faces'), the UV
 * origin, white. */
static void put_channel(const merge *g, const placed *p, size_t i, uint32_t v,
                        size_t id)
{
    const asset_attribute *a = &g->out->attributes[i];
    const float neutral = a->kind == PMESH_COLOR ? 1.0f : 0.0f;
    float *out = a->values + id * a->components;
    double in[4];

    for (unsigned k = 0; k < a->components; k++)
        out[k] = neutral;
    if (!p->channels[i])
        return;
    gltf_get(p->channels[i], v, in);
    if (a->kind == PMESH_NORMAL) {
        put_normal(p, in, out);
        return;
    }
    for (unsigned k = 0; k < p->channels[i]->components; k++)
        out[k] = fabs(in[k]) <= FLT_MAX ? (float)in[k] : NAN;
}

/* Where a row moves nothing, the same bits: a sum would lose the sign of -0. */
static double placed_at(const double *m, int i, const double in[4])
{
    const double *row = m + 4 * i;
    bool still = row[3] == 0.0;
    for (int k = 0; k < 3; k++)
        still = still && row[k] == (k == i ? 1.0 : 0.0);
    return still ? in[i]
                 : row[0] * in[0] + row[1] * in[1] + row[2] * in[2] + row[3];
}

/* The asset's vertex for vertex `v` of the primitive. */
static bool take_vertex(merge *g, const placed *p, uint32_t v, uint32_t *id)
{
    if (g->stamp[v] == g->serial) {
        *id = g->map[v];
        return true;
    }
    const size_t n = g->out->vertex_count++;
    double in[4], *out = g->out->positions + 3 * n;

    gltf_get(p->position, v, in);
    for (int i = 0; i < 3; i++) {
        out[i] = placed_at(p->m, i, in);
        if (!isfinite(out[i]))
            return asset_fail(g->error, p->where,
                              "vertex %u has a position that is not finite",
                              (unsigned)v);
    }
    for (size_t i = 0; i < g->out->attribute_count; i++)
        put_channel(g, p, i, v, n);
    g->stamp[v] = g->serial;
    g->map[v] = (uint32_t)n;
    *id = (uint32_t)n;
    return true;
}

static bool take_faces(merge *g, const placed *p)
{
    const uint32_t mode = p->primitive->mode;
    uint64_t faces;
    const size_t material = p->primitive->material == GLTF_NONE
                                ? g->model->material_count
                                : p->primitive->material;
    asset *out = g->out;

    if (!gltf_face_count(g->model, p->primitive, p->where, &faces, g->error))
        return false;
    g->serial++;
    for (uint64_t i = 0; i < faces; i++) {
        uint32_t v[3];
        if (!gltf_face(g->model, p->primitive, i, p->where, v, g->error))
            return false;
        /* Strips are joined by triangles without area: no faces of anyone. */
        if (mode != 4 && (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]))
            continue;
        uint32_t *face = out->indices + 3 * out->face_count;
        for (int k = 0; k < 3; k++) {
            const int at = p->mirrored && k > 0 ? 3 - k : k;
            if (!take_vertex(g, p, v[k], &face[at]))
                return false;
        }
        if (out->materials)
            out->materials[out->face_count] = g->plan.materials[material];
        out->face_count++;
    }
    return true;
}

static bool copy_all(merge *g)
{
    for (size_t i = 0; i < g->instance_count; i++) {
        const gltf_mesh *mesh = &g->model->meshes[g->instances[i].mesh];
        for (size_t k = 0; k < mesh->count; k++) {
            placed p;
            if (g->model->primitives[mesh->first + k].position == GLTF_NONE)
                continue;
            place(g, &g->instances[i], k, &p);
            if (!take_faces(g, &p))
                return false;
        }
    }
    if (g->out->face_count == 0)
        return asset_fail(g->error, "", "the scene has no triangles");
    g->out->texcoords_down = true;
    for (size_t i = 0; i < g->out->attribute_count; i++)
        g->out->attributes[i].count = g->out->vertex_count;
    return true;
}

bool gltf_merge(const gltf_model *model, const gltf_instance *instances,
                size_t instance_count, asset *out, asset_error *error)
{
    merge g = { .model = model, .instances = instances,
                .instance_count = instance_count, .out = out, .error = error };

    bool ok = gltf_survey(model, instances, instance_count, &g.plan, out,
                          error);
    if (ok && !reserve(&g))
        ok = asset_fail(error, "", "out of memory");
    ok = ok && copy_all(&g);
    free(g.plan.materials);
    free(g.map);
    free(g.stamp);
    return ok;
}
