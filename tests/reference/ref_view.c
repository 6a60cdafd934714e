/* SPDX-License-Identifier: MIT */
/* SPEC 7: what n vertices show. */
#include "tests/reference/ref.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

typedef struct shown {
    uint32_t vertices, faces, wedges;
} shown;

static shown shown_at(const ref *r, uint64_t faces)
{
    shown s = { r->base_vertices, r->base_faces, r->base_wedges };
    for (; s.vertices < r->vertex_count; s.vertices++) {
        const ref_split *split = &r->split[s.vertices - r->base_vertices];
        if (split->face_end > faces)
            break;
        s.faces = split->face_end;
        s.wedges = split->wedge_end;
    }
    if (r->header.attribute_count == 0)
        s.wedges = s.vertices;
    return s;
}

/* The output vertex of a corner: its own, or that of an ancestor below n. */
static uint32_t shown_corner(const ref *r, uint32_t h, uint32_t n)
{
    uint32_t v = r->edge[h].vertex, w = r->edge[h].wedge;
    while (v >= n) {
        v = r->vertex[v].parent;
        if (w != REF_NONE)
            w = r->wedge[w].from;
    }
    return r->header.attribute_count > 0 ? w : v;
}

/* Where vertices stand after the splits below n. */
static ref_vec *places_at(const ref *r, uint32_t n)
{
    ref_vec *at = malloc(n * sizeof *at);
    for (uint32_t v = 0; v < n; v++)
        at[v] = r->vertex[v].born;
    for (uint32_t u = r->base_vertices; u < n && r->header.moving; u++) {
        const ref_split *s = &r->split[u - r->base_vertices];
        at[s->parent] = s->after;
    }
    return at;
}

static float narrow(double x)
{
    if (x > (double)FLT_MAX)
        return FLT_MAX;
    return x < -(double)FLT_MAX ? -FLT_MAX : (float)x;
}

static void put_position(const ref *r, const ref_vec *at, uint32_t v,
                         float *out)
{
    bool exact = v < r->exact_count;
    for (int i = 0; i < 3; i++)
        exact = exact && at[v].c[i] == r->vertex[v].at.c[i];
    for (int i = 0; i < 3; i++)
        out[i] = exact ? r->vertex[v].exact[i]
                       : narrow(r->header.origin[i] +
                                r->header.step * (double)at[v].c[i]);
}

static void put_normal(const ref_attribute *a, const uint16_t *q, float *out)
{
    const int c = (1 << (a->bits - 1)) - 1;
    int x = q[0] - c, y = q[1] - c;
    const int z = c - abs(x) - abs(y);
    if (z < 0) {
        const int fold_x = c - abs(y), fold_y = c - abs(x);
        x = x < 0 ? -fold_x : fold_x;
        y = y < 0 ? -fold_y : fold_y;
    }
    const double length =
        sqrt((double)x * x + (double)y * y + (double)z * z);
    out[0] = (float)(x / length);
    out[1] = (float)(y / length);
    out[2] = (float)(z / length);
}

uint32_t ref_face_components(const ref_header *h)
{
    uint32_t sum = 0;
    for (int i = 0; i < h->attribute_count; i++)
        sum += (uint32_t)h->attribute[i].components;
    return sum;
}

/* Attribute by attribute, as wide as its components. */
static void put_attributes(const ref *r, const ref_view *v)
{
    float *out = v->attributes;
    int coded = 0;
    for (int i = 0; i < r->header.attribute_count; i++) {
        const ref_attribute *a = &r->header.attribute[i];
        for (uint32_t w = 0; w < v->wedges; w++) {
            const uint16_t *q = r->wedge[w].value + coded;
            if (a->kind == 0)
                put_normal(a, q, out);
            for (int k = 0; a->kind != 0 && k < a->components; k++)
                out[k] = narrow((double)a->minimum[k] +
                                q[k] * (double)a->scale[k]);
            out += a->components;
        }
        coded += a->coded;
    }
}

static void allocate(const ref *r, ref_view *v)
{
    const size_t components = ref_face_components(&r->header);
    const size_t values = (size_t)r->header.value_count * v->wedges;
    v->indices = calloc(3 * (size_t)v->faces, sizeof *v->indices);
    v->materials = calloc(v->faces, sizeof *v->materials);
    v->vertex_of = calloc(v->wedges, sizeof *v->vertex_of);
    v->grid = calloc(3 * (size_t)v->vertices, sizeof *v->grid);
    v->parents = calloc(v->vertices, sizeof *v->parents);
    v->values = calloc(values + 1, sizeof *v->values);
    v->positions = calloc(3 * (size_t)v->wedges, sizeof *v->positions);
    v->attributes =
        calloc(components * v->wedges + 1, sizeof *v->attributes);
}

ref_view ref_view_at(const ref *r, uint64_t faces)
{
    const shown s = shown_at(r, faces);
    ref_view v = { .faces = s.faces,
                   .vertices = s.vertices,
                   .wedges = s.wedges };
    const int count = r->header.value_count;
    allocate(r, &v);
    ref_vec *at = places_at(r, s.vertices);
    for (uint32_t h = 0; h < 3 * s.faces; h++)
        v.indices[h] = shown_corner(r, h, s.vertices);
    for (uint32_t f = 0; f < s.faces; f++)
        v.materials[f] = r->material[f];
    for (uint32_t n = 0; n < s.vertices; n++) {
        v.parents[n] = r->vertex[n].parent;
        for (int i = 0; i < 3; i++)
            v.grid[3 * n + (uint32_t)i] = (int32_t)at[n].c[i];
    }
    for (uint32_t w = 0; w < s.wedges; w++) {
        v.vertex_of[w] =
            r->header.attribute_count > 0 ? r->wedge[w].vertex : w;
        for (int i = 0; i < count; i++)
            v.values[(size_t)count * w + (size_t)i] = r->wedge[w].value[i];
        put_position(r, at, v.vertex_of[w], v.positions + 3 * (size_t)w);
    }
    put_attributes(r, &v);
    free(at);
    return v;
}

void ref_view_free(ref_view *v)
{
    free(v->indices);
    free(v->materials);
    free(v->vertex_of);
    free(v->grid);
    free(v->parents);
    free(v->values);
    free(v->positions);
    free(v->attributes);
}
