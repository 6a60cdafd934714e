/* SPDX-License-Identifier: MIT */
/*
 * gltf_merge.c - placed meshes into one asset.
 *
 * Attribute values that make no sense pass through: asset_check() repairs them
 * for all formats.
 */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "tools/gltf.h"

#define BLOCK 256 /* elements at a time */

typedef struct merge {
    const gltf_model *model;
    const gltf_instance *instances;
    size_t instance_count;
    asset *out;
    asset_error *error;
    gltf_plan plan;
    gltf_order order;
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
    bool ok = gltf_order_make(&g->order, g->plan.largest) && out->positions &&
              out->indices && (out->materials || out->material_count <= 1);
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
static void put_channel(const placed *p, const asset_attribute *a,
                        const gltf_accessor *from, const double *in, float *out)
{
    const float neutral = a->kind == PMESH_COLOR ? 1.0f : 0.0f;

    if (a->kind == PMESH_NORMAL && from) {
        put_normal(p, in, out);
        return;
    }
    for (unsigned k = 0; k < a->components; k++)
        out[k] = neutral;
    for (unsigned k = 0; from && k < from->components; k++)
        out[k] = fabs(in[k]) <= FLT_MAX ? (float)in[k] : NAN;
}

static void take_channels(merge *g, const placed *p, size_t first, size_t n)
{
    double in[4 * BLOCK];

    for (size_t i = 0; i < g->out->attribute_count; i++) {
        const asset_attribute *a = &g->out->attributes[i];
        const gltf_accessor *from = p->channels[i];
        const size_t width = from ? from->components : 0;
        for (size_t at = 0; at < n; at += BLOCK) {
            const size_t size = n - at < BLOCK ? n - at : BLOCK;
            float *out = a->values + (first + at) * a->components;
            if (from)
                gltf_gather(from, g->order.vertices + at, size, in);
            for (size_t k = 0; k < size; k++)
                put_channel(p, a, from, in + k * width,
                            out + k * a->components);
        }
    }
}

/* Where a row moves nothing, the same bits: a sum would lose the sign of -0. */
static bool is_still(const double *row, int i)
{
    bool still = row[3] == 0.0;
    for (int k = 0; k < 3; k++)
        still = still && row[k] == (k == i ? 1.0 : 0.0);
    return still;
}

static bool move(const placed *p, const uint32_t *vertices, size_t n,
                 double *xyz, asset_error *error)
{
    const double *m = p->m;
    const bool still[3] = { is_still(m, 0), is_still(m + 4, 1),
                            is_still(m + 8, 2) };

    if (still[0] && still[1] && still[2])
        return true;
    for (size_t v = 0; v < n; v++) {
        double *at = xyz + 3 * v;
        const double in[3] = { at[0], at[1], at[2] };
        for (int i = 0; i < 3; i++) {
            const double *row = m + 4 * i;
            if (!still[i])
                at[i] = row[0] * in[0] + row[1] * in[1] + row[2] * in[2] +
                        row[3];
            if (!isfinite(at[i]))
                return gltf_fail_position(p->where, vertices[v], error);
        }
    }
    return true;
}

static bool take_vertices(merge *g, const placed *p, size_t n)
{
    const size_t first = g->out->vertex_count;
    double *xyz = g->out->positions + 3 * first;
    const uint32_t *vertices = g->order.vertices;

    if (!gltf_positions(p->position, vertices, n, p->where, xyz, g->error) ||
        !move(p, vertices, n, xyz, g->error))
        return false;
    take_channels(g, p, first, n);
    g->out->vertex_count += n;
    return true;
}

/* The other side of a face is its front. */
static void turn(uint32_t *corners, size_t faces)
{
    for (size_t i = 0; i < faces; i++) {
        uint32_t *v = corners + 3 * i, second = v[1];
        v[1] = v[2];
        v[2] = second;
    }
}

static bool take_primitive(merge *g, const placed *p)
{
    const size_t material = p->primitive->material == GLTF_NONE
                                ? g->model->material_count
                                : p->primitive->material;
    asset *out = g->out;
    uint32_t *corners = out->indices + 3 * out->face_count;
    size_t faces;

    if (!gltf_faces(g->model, p->primitive, p->where, corners, &faces,
                    g->error) ||
        !take_vertices(g, p,
                       gltf_renumber(&g->order, (uint32_t)out->vertex_count,
                                     corners, 3 * faces)))
        return false;
    if (p->mirrored)
        turn(corners, faces);
    for (size_t i = 0; out->materials && i < faces; i++)
        out->materials[out->face_count + i] = g->plan.materials[material];
    out->face_count += faces;
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
            if (!take_primitive(g, &p))
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
    gltf_order_free(&g.order);
    return ok;
}
