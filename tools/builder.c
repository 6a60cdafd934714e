/* SPDX-License-Identifier: MIT */
#include "tools/builder.h"

#include <stdlib.h>
#include <string.h>

void *list_grow(void *items, size_t *capacity, size_t need, size_t size)
{
    if (items && need <= *capacity)
        return items;
    size_t next = *capacity + *capacity / 2 + 64;
    if (next < need)
        next = need;
    if (next > SIZE_MAX / size)
        return NULL;
    void *grown = realloc(items, next * size);
    if (grown)
        *capacity = next;
    return grown;
}

void builder_position(mesh_builder *mesh, double x, double y, double z)
{
    f64_list *list = &mesh->positions;
    if (mesh->vertex_count >= UINT32_MAX - 1) {
        mesh->too_many = true;
        return;
    }
    if (list->count + 3 > list->capacity) {
        double *items = list_grow(list->items, &list->capacity,
                                  list->count + 3, sizeof *items);
        if (!items) {
            mesh->failed = true;
            return;
        }
        list->items = items;
    }
    double *to = list->items + list->count;
    to[0] = x;
    to[1] = y;
    to[2] = z;
    list->count += 3;
    mesh->vertex_count++;
}

/* Brings a channel that has not been used yet up to `count` corners. */
static bool start_channel(u32_list *channel, size_t count)
{
    uint32_t *items = list_grow(channel->items, &channel->capacity, count,
                                sizeof *items);
    if (!items)
        return false;
    channel->items = items;
    for (; channel->count < count; channel->count++)
        items[channel->count] = BUILDER_NONE;
    return true;
}

static bool push_triangle(mesh_builder *mesh, const mesh_corner *a,
                          const mesh_corner *b, const mesh_corner *c)
{
    const size_t before = mesh->corners[BUILDER_VERTEX].count;
    for (int k = 0; k < BUILDER_CHANNELS; k++) {
        u32_list *list = &mesh->corners[k];
        const uint32_t i = a->index[k], j = b->index[k], l = c->index[k];
        if (k != BUILDER_VERTEX && !list->items) {
            if ((i & j & l) == BUILDER_NONE)
                continue;
            if (!start_channel(list, before))
                return false;
        }
        if (!u32_push(list, i) || !u32_push(list, j) || !u32_push(list, l))
            return false;
    }
    mesh->face_count++;
    return true;
}

void builder_begin_face(mesh_builder *mesh)
{
    mesh->size = 0;
}

void builder_corner(mesh_builder *mesh, mesh_corner corner)
{
    if (mesh->failed || mesh->too_many)
        return;
    if (mesh->size == 0)
        mesh->first = corner;
    if (mesh->size >= 2) {
        if (mesh->face_count >= UINT32_MAX - 1)
            mesh->too_many = true;
        else if (!push_triangle(mesh, &mesh->first, &mesh->last, &corner))
            mesh->failed = true;
    }
    mesh->last = corner;
    mesh->size++;
}

void builder_end_face(mesh_builder *mesh)
{
    const size_t size = mesh->size;
    if (size < 3) {
        mesh->skipped++;
    } else if (size > 3 && !mesh->failed && !mesh->too_many) {
        const uint32_t first = (uint32_t)(mesh->face_count - (size - 2));
        if (!u32_push(&mesh->polygons, first) ||
            !u32_push(&mesh->polygons, (uint32_t)size))
            mesh->failed = true;
    }
}

typedef struct polygon_scratch {
    double (*positions)[3];
    uint32_t *corners, *triangles;
} polygon_scratch;

/* Corner i of a fan of n corners, as a place in its n - 2 triangles. */
static size_t fan_place(size_t i, size_t n)
{
    if (i == 0)
        return 0;
    return i + 1 < n ? 3 * (i - 1) + 1 : 3 * (n - 3) + 2;
}

static void retriangulate(mesh_builder *mesh, size_t face, size_t n,
                          const polygon_scratch *s)
{
    const uint32_t *vertices = mesh->corners[BUILDER_VERTEX].items + 3 * face;
    for (size_t i = 0; i < n; i++) {
        const size_t vertex = vertices[fan_place(i, n)];
        memcpy(s->positions[i], mesh->positions.items + 3 * vertex,
               sizeof s->positions[i]);
    }
    asset_triangulate((const double(*)[3])s->positions, n, s->triangles);
    for (int k = 0; k < BUILDER_CHANNELS; k++) {
        if (!mesh->corners[k].items)
            continue;
        uint32_t *indices = mesh->corners[k].items + 3 * face;
        for (size_t i = 0; i < n; i++)
            s->corners[i] = indices[fan_place(i, n)];
        for (size_t i = 0; i < 3 * (n - 2); i++)
            indices[i] = s->corners[s->triangles[i]];
    }
}

static bool retriangulate_all(mesh_builder *mesh)
{
    const u32_list *polygons = &mesh->polygons;
    size_t largest = 0;
    for (size_t i = 1; i < polygons->count; i += 2)
        if (polygons->items[i] > largest)
            largest = polygons->items[i];
    if (!largest)
        return true;
    if (largest > SIZE_MAX / sizeof(double[3]))
        return false;
    const polygon_scratch s = {
        .positions = malloc(largest * sizeof *s.positions),
        .corners = malloc(largest * sizeof *s.corners),
        .triangles = malloc(3 * largest * sizeof *s.triangles),
    };
    const bool ok = s.positions && s.corners && s.triangles;
    for (size_t i = 0; ok && i < polygons->count; i += 2)
        retriangulate(mesh, polygons->items[i], polygons->items[i + 1], &s);
    free(s.positions);
    free(s.corners);
    free(s.triangles);
    return ok;
}

bool builder_finish(mesh_builder *mesh, asset *out, asset_error *error)
{
    if (mesh->too_many)
        return asset_fail(error, "", "more than 2^32 vertices or faces");
    if (mesh->failed || !retriangulate_all(mesh))
        return asset_fail(error, "", "out of memory");
    out->positions = mesh->positions.items;
    out->vertex_count = mesh->vertex_count;
    out->indices = mesh->corners[BUILDER_VERTEX].items;
    out->face_count = mesh->face_count;
    mesh->positions.items = NULL;
    mesh->corners[BUILDER_VERTEX].items = NULL;
    if (mesh->skipped)
        asset_warn(out, "%zu faces of less than 3 corners were left out",
                   mesh->skipped);
    return true;
}

void builder_free(mesh_builder *mesh)
{
    free(mesh->positions.items);
    for (int k = 0; k < BUILDER_CHANNELS; k++)
        free(mesh->corners[k].items);
    free(mesh->polygons.items);
    *mesh = (mesh_builder){ 0 };
}

void builder_attach(asset *out, pmesh_attribute_kind kind, uint8_t components,
                    f32_list *values, u32_list *indices)
{
    asset_attribute *to = &out->attributes[out->attribute_count++];
    *to = (asset_attribute){
        .kind = kind,
        .components = components,
        .values = values->items,
        .count = values->count / components,
        .indices = indices ? indices->items : NULL,
    };
    *values = (f32_list){ 0 };
    if (indices)
        *indices = (u32_list){ 0 };
}
