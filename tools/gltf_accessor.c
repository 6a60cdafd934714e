/* SPDX-License-Identifier: MIT */
/* gltf_accessor.c - typed, strided, sparse elements of a glTF buffer view. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/gltf.h"

gltf_budget gltf_budget_for(uint64_t file_size)
{
    const uint64_t base = (uint64_t)64 << 20;
    if (file_size > (UINT64_MAX - base) / 256)
        return (gltf_budget){ UINT64_MAX };
    return (gltf_budget){ base + file_size * 256 };
}

bool gltf_spend(gltf_budget *budget, uint64_t count, uint64_t size)
{
    if (size != 0 && count > budget->left / size)
        return false;
    budget->left -= count * size;
    return true;
}

bool gltf_fits_stored(const gltf_source *document, uint64_t stored)
{
    gltf_budget budget = gltf_budget_for(stored);

    return document->file_size <= GLTF_MAX_DOCUMENT &&
           gltf_spend(&budget, document->file_size, 1) &&
           gltf_spend(&budget, document->json_values, 64);
}

static uint32_t type_size(uint32_t type)
{
    switch (type) {
    case GLTF_I8:
    case GLTF_U8:
        return 1;
    case GLTF_I16:
    case GLTF_U16:
        return 2;
    case GLTF_U32:
    case GLTF_F32:
        return 4;
    default:
        return 0;
    }
}

/* Whether `count` elements of `size` bytes, `stride` apart, lie in the view.
 * count >= 1. */
static bool fits(const gltf_view *view, uint64_t count, uint32_t size,
                 uint32_t stride)
{
    if (view->size < size)
        return false;
    return stride == 0 || count - 1 <= (view->size - size) / stride;
}

static uint32_t get_unsigned(const uint8_t *p, uint32_t size)
{
    uint32_t value = 0;
    for (uint32_t i = 0; i < size; i++)
        value |= (uint32_t)p[i] << (8 * i);
    return value;
}

/* Replaces the view by a dense copy with the sparse elements put in. */
static bool expand(gltf_accessor *a, uint32_t element, gltf_budget *budget,
                   const char *where, asset_error *error)
{
    const uint32_t index_size = type_size(a->sparse_type);

    if (a->sparse_type != GLTF_U8 && a->sparse_type != GLTF_U16 &&
        a->sparse_type != GLTF_U32)
        return asset_fail(error, where, "sparse indices of a wrong type");
    if (a->sparse_count > a->count)
        return asset_fail(error, where, "more sparse elements than elements");
    if (!fits(&a->sparse_indices, a->sparse_count, index_size, index_size) ||
        !fits(&a->sparse_values, a->sparse_count, element, element))
        return asset_fail(error, where,
                          "sparse elements run past their buffer view");
    if (!gltf_spend(budget, a->count, element))
        return asset_fail(error, where, "too many elements for a file of this "
                          "size");

    uint8_t *dense = calloc((size_t)a->count, element);
    if (!dense)
        return asset_fail(error, where, "out of memory");
    for (uint64_t i = 0; a->view.data && i < a->count; i++)
        memcpy(dense + i * element, a->view.data + i * a->stride, element);
    for (uint64_t i = 0; i < a->sparse_count; i++) {
        const uint32_t at =
            get_unsigned(a->sparse_indices.data + i * index_size, index_size);
        if (at >= a->count) {
            free(dense);
            return asset_fail(error, where,
                              "sparse index %u is out of range", (unsigned)at);
        }
        memcpy(dense + (size_t)at * element,
               a->sparse_values.data + i * element, element);
    }
    a->expanded = dense;
    a->view = (gltf_view){ dense, a->count * element };
    a->stride = element;
    a->sparse_count = 0;
    return true;
}

bool gltf_accessor_prepare(gltf_accessor *a, gltf_budget *budget,
                           asset_error *error)
{
    char where[48];
    snprintf(where, sizeof where, "accessors[%u]", (unsigned)a->number);
    const uint32_t element = type_size(a->type) * a->components;

    if (element == 0 || a->components > 4)
        return asset_fail(error, where, "elements of an unusable type");
    if (a->count == 0 || a->count >= UINT32_MAX)
        return asset_fail(error, where, "a count of %llu",
                          (unsigned long long)a->count);
    if (a->stride == 0)
        a->stride = element;
    if (a->stride < element)
        return asset_fail(error, where, "a stride shorter than its elements");
    if (a->view.data && !fits(&a->view, a->count, element, a->stride))
        return asset_fail(error, where, "runs past its buffer view");
    /* Callers keep a few words for every vertex an accessor can name. */
    if (!a->view.data && !gltf_spend(budget, a->count, 64))
        return asset_fail(error, where, "%llu elements without data",
                          (unsigned long long)a->count);
    if (a->sparse_count == 0)
        return true;
    return expand(a, element, budget, where, error);
}

static double get_component(const uint8_t *p, uint32_t type, bool normalised)
{
    const uint32_t size = type_size(type);
    const uint32_t bits = get_unsigned(p, size);

    if (type == GLTF_F32) {
        float value;
        memcpy(&value, &bits, sizeof value);
        return (double)value;
    }
    if (type == GLTF_U32)
        return (double)bits;
    if (type == GLTF_U8 || type == GLTF_U16)
        return normalised ? bits / (size == 1 ? 255.0 : 65535.0) : bits;

    const uint32_t sign = (uint32_t)1 << (8 * size - 1);
    const double value = (double)(bits ^ sign) - (double)sign;
    if (!normalised)
        return value;
    const double unit = value / ((double)sign - 1.0);
    return unit < -1.0 ? -1.0 : unit;
}

void gltf_get(const gltf_accessor *a, uint64_t i, double out[4])
{
    const uint32_t size = type_size(a->type);

    for (uint32_t k = 0; k < a->components; k++)
        out[k] = a->view.data
                     ? get_component(a->view.data + i * a->stride + k * size,
                                     a->type, a->normalised)
                     : 0.0;
}

/* `components` is a constant where this is called. */
static inline void gather_floats(const gltf_accessor *a, size_t components,
                                 const uint32_t *which, size_t n, double *out)
{
    for (size_t i = 0; i < n; i++) {
        const uint8_t *p = a->view.data + (size_t)which[i] * a->stride;
        for (size_t k = 0; k < components; k++)
            *out++ = get_component(p + 4 * k, GLTF_F32, false);
    }
}

void gltf_gather(const gltf_accessor *a, const uint32_t *which, size_t n,
                 double *out)
{
    const bool floats = a->view.data && a->type == GLTF_F32;
    double element[4];

    if (floats && a->components == 3) {
        gather_floats(a, 3, which, n, out);
    } else if (floats && a->components == 2) {
        gather_floats(a, 2, which, n, out);
    } else {
        for (size_t i = 0; i < n; i++) {
            gltf_get(a, which[i], element);
            for (size_t k = 0; k < a->components; k++)
                *out++ = element[k];
        }
    }
}

/* `size` is a constant where this is called. */
static inline uint32_t get_indices(const uint8_t *p, size_t stride,
                                   uint32_t size, size_t n, uint32_t *out)
{
    uint32_t largest = 0;
    for (size_t i = 0; i < n; i++) {
        out[i] = get_unsigned(p + i * stride, size);
        largest = out[i] > largest ? out[i] : largest;
    }
    return largest;
}

uint32_t gltf_indices(const gltf_accessor *a, uint64_t first, size_t n,
                      uint32_t *out)
{
    if (!a->view.data) {
        memset(out, 0, n * sizeof *out);
        return 0;
    }
    const uint8_t *p = a->view.data + first * a->stride;
    if (a->type == GLTF_U32 && a->stride == 4)
        return get_indices(p, 4, 4, n, out);
    if (a->type == GLTF_U16 && a->stride == 2)
        return get_indices(p, 2, 2, n, out);
    return get_indices(p, a->stride, type_size(a->type), n, out);
}
