/* SPDX-License-Identifier: MIT */
/*
 * builder.h - turns the polygons of a mesh file into the triangles of an
 * asset, in one pass and with faces before or after their vertices.
 *
 *   mesh_builder mesh = { 0 };
 *   builder_position(&mesh, x, y, z);          ... in any order with
 *   builder_begin_face(&mesh);
 *   builder_corner(&mesh, (mesh_corner){ vertex, BUILDER_NONE, normal });
 *   builder_end_face(&mesh);
 *   if (!builder_finish(&mesh, &asset, error)) ...
 *
 * Memory grows with what has been put in, never with a count some file claims.
 * Running out of it sets `failed`, which sticks: builder_finish reports it.
 */
#ifndef BUILDER_H
#define BUILDER_H

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tools/asset.h"

typedef struct u32_list {
    uint32_t *items;
    size_t count, capacity;
} u32_list;

typedef struct f32_list {
    float *items;
    size_t count, capacity;
} f32_list;

typedef struct f64_list {
    double *items;
    size_t count, capacity;
} f64_list;

/* `items`, or its successor with room for `need` items of `size` bytes; NULL
 * if memory is short: `items` stays valid then. */
void *list_grow(void *items, size_t *capacity, size_t need, size_t size);

static inline bool u32_push(u32_list *list, uint32_t value)
{
    if (list->count == list->capacity) {
        uint32_t *items = list_grow(list->items, &list->capacity,
                                    list->count + 1, sizeof *items);
        if (!items)
            return false;
        list->items = items;
    }
    list->items[list->count++] = value;
    return true;
}

static inline bool f32_push(f32_list *list, float value)
{
    if (list->count == list->capacity) {
        float *items = list_grow(list->items, &list->capacity,
                                 list->count + 1, sizeof *items);
        if (!items)
            return false;
        list->items = items;
    }
    list->items[list->count++] = value;
    return true;
}

/* The corner has no such attribute; no index may have this value. */
#define BUILDER_NONE UINT32_MAX

typedef enum builder_channel {
    BUILDER_VERTEX,
    BUILDER_UV,
    BUILDER_NORMAL,
    BUILDER_CHANNELS
} builder_channel;

typedef struct mesh_corner {
    uint32_t index[BUILDER_CHANNELS];
} mesh_corner;

typedef struct mesh_builder {
    f64_list positions;
    size_t vertex_count;
    /* Per channel three indices a face; a channel other than BUILDER_VERTEX is
     * empty until some corner has it. Polygons are fans until the end. */
    u32_list corners[BUILDER_CHANNELS];
    size_t face_count;
    u32_list polygons; /* first face and corner count of those above 3 */
    mesh_corner first, last;
    size_t size;       /* corners of the current face so far */
    size_t skipped;    /* faces of less than 3 corners */
    bool too_many, failed;
} mesh_builder;

/* 0xFFFFFFFE vertices and 0xFFFFFFFE faces at most; more set `too_many`. */
void builder_position(mesh_builder *mesh, double x, double y, double z);
void builder_begin_face(mesh_builder *mesh);
void builder_corner(mesh_builder *mesh, mesh_corner corner);
void builder_end_face(mesh_builder *mesh);

static inline mesh_corner builder_vertex(uint32_t vertex)
{
    return (mesh_corner){ { vertex, BUILDER_NONE, BUILDER_NONE } };
}

/*
 * Triangulates and moves positions and faces to *out (which has to be empty);
 * the other channels' indices stay in `corners`. All vertex indices must be
 * below vertex_count. false: out of memory or too large, *out is empty.
 * In any case builder_free() is due.
 */
bool builder_finish(mesh_builder *mesh, asset *out, asset_error *error);
void builder_free(mesh_builder *mesh);

/* Moves `values` (and `indices`, NULL: tuples go with positions) to a new
 * attribute of *out, which has room for it. */
void builder_attach(asset *out, pmesh_attribute_kind kind, uint8_t components,
                    f32_list *values, u32_list *indices);

/* A number of a file as float; beyond its range the same as infinity. */
static inline float builder_float(double value)
{
    if (value > (double)FLT_MAX)
        return INFINITY;
    return value < -(double)FLT_MAX ? -INFINITY : (float)value;
}

/* asset_number_print() of a coordinate: of a float where the mesh has them. */
static inline size_t builder_print(const asset *mesh, char *dst, size_t i)
{
    return mesh->floats
               ? asset_number_print_float(dst, (float)mesh->positions[i])
               : asset_number_print(dst, mesh->positions[i]);
}

/*
 * What asset_read() does with every mesh a reader gives: fails without a face
 * or with an index out of range; repairs or drops attributes that are not
 * usable (NaN, zero normals, colours outside 0 .. 1), with a warning.
 */
bool asset_check(asset *mesh, asset_error *error);

/* In place: control characters and bytes that are no UTF-8 become '?'. */
void asset_clean_text(char *text);

#endif
