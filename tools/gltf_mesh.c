/* SPDX-License-Identifier: MIT */
/*
 * gltf_mesh.c - one mesh of a glTF scene as an asset: in its own space, with all
 * attributes that its channels carry, one material for each primitive.
 */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "tools/gltf.h"

#define BLOCK 256 /* elements at a time */

typedef struct maker {
    const gltf_model *model;
    const gltf_channels *channels;
    asset *out;
    asset_error *error;
    bool empty;
    gltf_order order;
    gltf_budget *budget;
} maker;

/* One primitive at work. */
typedef struct part {
    const gltf_primitive *primitive;
    const gltf_accessor *position;
    const gltf_accessor *channel[PMESH_MAX_ATTRIBUTES]; /* NULL: neutral */
    uint32_t material;
    uint64_t faces;
    char where[48];
} part;

/* Bytes of one vertex. */
static uint64_t vertex_size(const gltf_channels *channels)
{
    uint64_t size = 3 * sizeof(double);
    for (size_t i = 0; i < channels->count; i++)
        size += channels->item[i].components * sizeof(float);
    return size;
}

/* A mesh may use a few vertices of a large buffer: room is for those that faces
 * can name. */
static bool reserve(maker *m, uint64_t faces, uint64_t vertices,
                    uint64_t largest)
{
    asset *out = m->out;
    bool ok;

    if (faces > GLTF_MAX_FACES)
        return asset_fail(m->error, "", "more than %llu triangles",
                          (unsigned long long)GLTF_MAX_FACES);
    if (!gltf_spend(m->budget, faces, 4 * sizeof *out->indices) ||
        !gltf_spend(m->budget, vertices, vertex_size(m->channels)))
        return asset_fail(m->error, "", "the meshes expand to more than a file "
                          "of this size may");
    out->positions = malloc((size_t)vertices * 3 * sizeof *out->positions);
    out->indices = malloc((size_t)faces * 3 * sizeof *out->indices);
    out->materials = malloc((size_t)faces * sizeof *out->materials);
    ok = gltf_order_make(&m->order, largest);
    for (size_t i = 0; i < m->channels->count; i++) {
        const gltf_channel *c = &m->channels->item[i];
        float *values =
            malloc((size_t)vertices * c->components * sizeof *values);
        out->attributes[i] = (asset_attribute){
            .kind = c->kind, .set = c->number, .components = c->components,
            .bits = c->bits, .values = values
        };
        snprintf(out->attributes[i].name, sizeof out->attributes[i].name, "%s",
                 c->set == 0 ? c->semantic : "");
        ok = ok && values;
    }
    out->attribute_count = m->channels->count;
    out->texcoords_down = true;
    ok = ok && out->positions && out->indices && out->materials;
    return ok || asset_fail(m->error, "", "out of memory");
}

static void put_channel(const gltf_channel *c, const gltf_accessor *from,
                        const double *in, float *out)
{
    for (unsigned k = 0; k < c->components; k++)
        out[k] = c->kind == PMESH_COLOR ? 1.0f : 0.0f;
    if (c->kind == PMESH_NORMAL)
        out[2] = 1.0f;
    for (unsigned k = 0; from && k < from->components; k++)
        out[k] = fabs(in[k]) <= (double)FLT_MAX ? (float)in[k] : NAN;
}

static void take_channels(const maker *m, const part *p, size_t n)
{
    double in[4 * BLOCK];

    for (size_t i = 0; i < m->channels->count; i++) {
        const gltf_channel *c = &m->channels->item[i];
        const gltf_accessor *from = p->channel[i];
        const size_t width = from ? from->components : 0;
        for (size_t at = 0; at < n; at += BLOCK) {
            const size_t size = n - at < BLOCK ? n - at : BLOCK;
            float *out = m->out->attributes[i].values +
                         (m->out->vertex_count + at) * c->components;
            if (from)
                gltf_gather(from, m->order.vertices + at, size, in);
            for (size_t k = 0; k < size; k++)
                put_channel(c, from, in + k * width, out + k * c->components);
        }
    }
}

static bool take_part(maker *m, const part *p)
{
    asset *out = m->out;
    uint32_t *corners = out->indices + 3 * out->face_count;
    size_t faces;

    if (!gltf_faces(m->model, p->primitive, p->where, corners, &faces,
                    m->error))
        return false;
    const size_t n = gltf_renumber(&m->order, (uint32_t)out->vertex_count,
                                   corners, 3 * faces);
    if (!gltf_positions(p->position, m->order.vertices, n, p->where,
                        out->positions + 3 * out->vertex_count, m->error))
        return false;
    take_channels(m, p, n);
    out->vertex_count += n;
    for (size_t i = 0; i < faces; i++)
        out->materials[out->face_count++] = p->material;
    return true;
}

/* Names a primitive by its mesh, of which `mesh` may be a part. */
static void place_of(const gltf_model *model, size_t primitive, char *where,
                     size_t size)
{
    size_t i = 0;
    while (i + 1 < model->mesh_count &&
           primitive >= model->meshes[i].first + model->meshes[i].count)
        i++;
    snprintf(where, size, "mesh %zu, primitive %zu", i,
             primitive - model->meshes[i].first);
}

/* The coded primitives of a mesh, counted; at most mesh->count. */
static bool find_parts(const maker *m, const gltf_mesh *mesh, part *parts,
                       size_t *count)
{
    *count = 0;
    for (size_t k = 0; k < mesh->count; k++) {
        const gltf_primitive *primitive =
            &m->model->primitives[mesh->first + k];
        part *p = &parts[*count];
        if (!gltf_is_coded(primitive))
            continue;
        *p = (part){ .primitive = primitive,
                     .position = &m->model->accessors[primitive->position],
                     .material = (uint32_t)(*count)++ };
        place_of(m->model, mesh->first + k, p->where, sizeof p->where);
        if (!gltf_face_count(m->model, primitive, p->where, &p->faces,
                             m->error))
            return false;
        for (size_t i = 0; i < m->channels->count; i++)
            p->channel[i] = gltf_channel_accessor(m->model, primitive,
                                                  &m->channels->item[i]);
    }
    return true;
}

static bool fail_empty(maker *m)
{
    m->empty = true;
    return asset_fail(m->error, "", "the mesh has no triangles");
}

static bool make(maker *m, const gltf_mesh *mesh, part *parts)
{
    uint64_t faces = 0, vertices = 0, largest = 1;
    size_t count;

    if (!find_parts(m, mesh, parts, &count))
        return false;
    for (size_t k = 0; k < count; k++) {
        const uint64_t n = parts[k].position->count;
        const uint64_t named = 3 * parts[k].faces;
        faces += parts[k].faces;
        vertices += n < named ? n : named;
        largest = n > largest ? n : largest;
    }
    if (faces == 0)
        return fail_empty(m);
    m->out->material_count = (uint32_t)count;
    if (!reserve(m, faces, vertices, largest))
        return false;
    for (size_t k = 0; k < count; k++)
        if (!take_part(m, &parts[k]))
            return false;
    for (size_t i = 0; i < m->out->attribute_count; i++)
        m->out->attributes[i].count = m->out->vertex_count;
    return m->out->face_count > 0 || fail_empty(m);
}

bool gltf_mesh_asset(const gltf_model *model, const gltf_mesh *mesh,
                     const gltf_channels *channels, gltf_budget *budget,
                     asset *out, bool *empty, asset_error *error)
{
    maker m = { .model = model, .channels = channels, .out = out,
                .error = error, .budget = budget };
    part *parts = calloc(mesh->count + 1, sizeof *parts);

    *out = (asset){ 0 };
    const bool ok = parts ? make(&m, mesh, parts)
                          : asset_fail(error, "", "out of memory");
    *empty = m.empty;
    free(parts);
    gltf_order_free(&m.order);
    if (!ok) {
        asset_free(out);
        *out = (asset){ 0 };
    }
    return ok;
}
