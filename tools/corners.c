/* SPDX-License-Identifier: MIT */
#include "tools/corners.h"

#include <stdlib.h>
#include <string.h>

typedef struct table {
    uint32_t *slots; /* point + 1, 0: free */
    size_t mask;     /* slot count - 1, a power of two less one */
} table;

const float *corners_values(const asset *mesh, const asset_attribute *attribute,
                            size_t corner)
{
    const uint32_t tuple = attribute->indices ? attribute->indices[corner]
                                              : mesh->indices[corner];
    return attribute->values + (size_t)tuple * attribute->components;
}

static uint64_t mix(uint64_t hash, uint32_t word)
{
    hash = (hash ^ word) * 0x9E3779B97F4A7C15u;
    return hash ^ hash >> 29;
}

static uint64_t hash_corner(const asset *mesh, size_t corner)
{
    uint64_t hash = mix(0, mesh->indices[corner]);

    for (size_t i = 0; i < mesh->attribute_count; i++) {
        const asset_attribute *a = &mesh->attributes[i];
        const float *v = corners_values(mesh, a, corner);
        for (unsigned k = 0; k < a->components; k++) {
            uint32_t bits;
            memcpy(&bits, v + k, sizeof bits);
            hash = mix(hash, bits);
        }
    }
    return hash;
}

static bool same_corner(const asset *mesh, size_t one, size_t two)
{
    if (mesh->indices[one] != mesh->indices[two])
        return false;
    for (size_t i = 0; i < mesh->attribute_count; i++) {
        const asset_attribute *a = &mesh->attributes[i];
        if (memcmp(corners_values(mesh, a, one), corners_values(mesh, a, two),
                   a->components * sizeof(float)) != 0)
            return false;
    }
    return true;
}

/* The slot of the corner's point, or the free one where it belongs. */
static size_t find(const table *t, const asset *mesh, const corners *c,
                   size_t corner)
{
    size_t at = (size_t)hash_corner(mesh, corner) & t->mask;

    while (t->slots[at] != 0 &&
           !same_corner(mesh, c->first[t->slots[at] - 1], corner))
        at = (at + 1) & t->mask;
    return at;
}

/* Doubles the table and the room in c->first. */
static bool grow(table *t, const asset *mesh, corners *c)
{
    const size_t size = t->slots ? (t->mask + 1) * 2 : 1024;
    if (size > SIZE_MAX / sizeof *t->slots)
        return false;
    uint32_t *first = realloc(c->first, size / 2 * sizeof *first);
    if (!first)
        return false;
    c->first = first;
    uint32_t *slots = calloc(size, sizeof *slots);
    if (!slots)
        return false;
    free(t->slots);
    *t = (table){ slots, size - 1 };
    for (size_t i = 0; i < c->count; i++)
        slots[find(t, mesh, c, c->first[i])] = (uint32_t)i + 1;
    return true;
}

bool corners_unify(const asset *mesh, corners *out)
{
    const size_t n = mesh->face_count * 3;
    table t = { 0 };

    *out = (corners){ 0 };
    if (mesh->face_count > UINT32_MAX / 3 - 1)
        return false;
    out->points = malloc((n + 1) * sizeof *out->points);
    bool ok = out->points && grow(&t, mesh, out);
    for (size_t corner = 0; ok && corner < n; corner++) {
        if (out->count == (t.mask + 1) / 2 && !grow(&t, mesh, out)) {
            ok = false;
            break;
        }
        const size_t at = find(&t, mesh, out, corner);
        if (t.slots[at] == 0) {
            out->first[out->count++] = (uint32_t)corner;
            t.slots[at] = (uint32_t)out->count;
        }
        out->points[corner] = t.slots[at] - 1;
    }
    free(t.slots);
    if (!ok)
        corners_free(out);
    return ok;
}

void corners_free(corners *c)
{
    free(c->points);
    free(c->first);
    *c = (corners){ 0 };
}
