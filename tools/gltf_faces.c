/* SPDX-License-Identifier: MIT */
/*
 * gltf_faces.c - the triangles of a primitive, whatever its mode, and the
 * vertices that they name: each once, so that primitives that share one large
 * buffer do not multiply it.
 */
#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "tools/gltf.h"

static const gltf_accessor *indices_of(const gltf_model *model,
                                       const gltf_primitive *p)
{
    return p->indices == GLTF_NONE ? NULL : &model->accessors[p->indices];
}

bool gltf_face_count(const gltf_model *model, const gltf_primitive *p,
                     const char *where, uint64_t *faces, asset_error *error)
{
    const gltf_accessor *position = &model->accessors[p->position];
    const gltf_accessor *indices = indices_of(model, p);

    if (position->components != 3 || position->type == GLTF_U32)
        return asset_fail(error, where, "POSITION has a wrong type");
    if (indices && (indices->components != 1 ||
                    (indices->type != GLTF_U8 && indices->type != GLTF_U16 &&
                     indices->type != GLTF_U32)))
        return asset_fail(error, where, "indices have a wrong type");

    const uint64_t corners = indices ? indices->count : position->count;
    if (p->mode == 4 && corners % 3 != 0)
        return asset_fail(error, where, "%llu corners are no triangles",
                          (unsigned long long)corners);
    *faces = p->mode == 4 ? corners / 3 : corners >= 3 ? corners - 2 : 0;
    return true;
}

/* Corner numbers of triangle `i` of a strip or a fan in the order of the glTF
 * specification. */
static void triangle(uint32_t mode, uint32_t i, uint32_t corners[3])
{
    if (mode == 5) {
        corners[0] = i;
        corners[1] = i + 1 + i % 2;
        corners[2] = i + 2 - i % 2;
    } else {
        corners[0] = i + 1;
        corners[1] = i + 2;
        corners[2] = 0;
    }
}

/* Indices from `first` on, or the numbers themselves. */
static uint32_t get_vertices(const gltf_accessor *indices, uint32_t first,
                             size_t n, uint32_t *out)
{
    if (indices)
        return gltf_indices(indices, first, n, out);
    for (size_t i = 0; i < n; i++)
        out[i] = first + (uint32_t)i;
    return n > 0 ? first + (uint32_t)n - 1 : 0;
}

static uint32_t restart_of(const gltf_accessor *indices)
{
    return indices->type == GLTF_U8    ? 0xFFu
           : indices->type == GLTF_U16 ? 0xFFFFu
                                       : 0xFFFFFFFFu;
}

/* Says which of the vertices is the first that is none. */
static bool fail_index(const gltf_accessor *indices, uint64_t count,
                       const uint32_t *v, size_t first, const char *where,
                       asset_error *error)
{
    const uint32_t restart = restart_of(indices);
    while (*v != restart && *v < count) {
        v++;
        first++;
    }
    if (*v == restart)
        return asset_fail(error, where, "index %zu is a primitive restart",
                          first);
    return asset_fail(error, where, "index %u is out of range (%llu vertices)",
                      (unsigned)*v, (unsigned long long)count);
}

/* Vertices of n corners from `first` on. Without indices, corners were counted
 * from the positions. */
static bool take(const gltf_model *model, const gltf_primitive *p,
                 uint32_t first, size_t n, const char *where, uint32_t *out,
                 asset_error *error)
{
    const gltf_accessor *indices = indices_of(model, p);
    const uint64_t count = model->accessors[p->position].count;
    const uint32_t largest = get_vertices(indices, first, n, out);

    if (indices && (largest >= count || largest == restart_of(indices)))
        return fail_index(indices, count, out, first, where, error);
    return true;
}

static bool take_strip(const gltf_model *model, const gltf_primitive *p,
                       size_t triangles, const char *where, uint32_t *out,
                       size_t *faces, asset_error *error)
{
    *faces = 0;
    for (size_t i = 0; i < triangles; i++) {
        uint32_t corners[3], *v = out + 3 * *faces;
        triangle(p->mode, (uint32_t)i, corners);
        for (int k = 0; k < 3; k++)
            if (!take(model, p, corners[k], 1, where, &v[k], error))
                return false;
        *faces += v[0] != v[1] && v[1] != v[2] && v[2] != v[0];
    }
    return true;
}

bool gltf_faces(const gltf_model *model, const gltf_primitive *p,
                const char *where, uint32_t *out, size_t *faces,
                asset_error *error)
{
    uint64_t n;

    if (!gltf_face_count(model, p, where, &n, error))
        return false;
    *faces = (size_t)n;
    return p->mode == 4
               ? take(model, p, 0, 3 * *faces, where, out, error)
               : take_strip(model, p, *faces, where, out, faces, error);
}

/* ---- vertices ----------------------------------------------------------- */

bool gltf_order_make(gltf_order *order, uint64_t largest)
{
    const size_t room = (size_t)largest + 1; /* one that renumbering spoils */
    order->numbers = calloc(room, sizeof *order->numbers);
    order->vertices = malloc(room * sizeof *order->vertices);
    return order->numbers && order->vertices;
}

void gltf_order_free(gltf_order *order)
{
    free(order->numbers);
    free(order->vertices);
}

size_t gltf_renumber(gltf_order *order, uint32_t first, uint32_t *corners,
                     size_t n)
{
    uint32_t *numbers = order->numbers, *vertices = order->vertices;
    uint32_t count = first;

    /* Without a branch, which would go wrong for one corner in six. */
    for (size_t i = 0; i < n; i++) {
        const uint32_t v = corners[i];
        const bool fresh = numbers[v] <= first;
        vertices[count - first] = v; /* overwritten unless it is fresh */
        count += fresh;
        const uint32_t number = fresh ? count : numbers[v];
        numbers[v] = number;
        corners[i] = number - 1;
    }
    return count - first;
}

bool gltf_fail_position(const char *where, uint32_t vertex, asset_error *error)
{
    return asset_fail(error, where,
                      "vertex %u has a position that is not finite",
                      (unsigned)vertex);
}

bool gltf_positions(const gltf_accessor *position, const uint32_t *vertices,
                    size_t n, const char *where, double *out,
                    asset_error *error)
{
    bool finite = true;

    gltf_gather(position, vertices, n, out);
    for (size_t i = 0; i < 3 * n; i++)
        finite &= fabs(out[i]) <= DBL_MAX;
    for (size_t i = 0; !finite; i++)
        if (!(fabs(out[i]) <= DBL_MAX))
            return gltf_fail_position(where, vertices[i / 3], error);
    return true;
}
