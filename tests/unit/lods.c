/* SPDX-License-Identifier: MIT */
#include "tests/unit/lods.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/unit/shapes.h"

static const double PI = 3.14159265358979323846;

lods *lods_make(double *xyz, size_t vertex_count, uint32_t *tri,
                size_t face_count)
{
    lods *l = calloc(1, sizeof *l);

    l->xyz = xyz;
    l->tri = tri;
    l->in = (pmesh_simplify_input){ .indices = tri,
                                    .face_count = face_count,
                                    .vertex_count = vertex_count,
                                    .doubles = xyz,
                                    .attributes = l->attributes };
    l->options = pmesh_simplify_options_default();
    l->out.indices = malloc(face_count * 3 * sizeof *tri);
    l->out.position_indices = malloc(face_count * 3 * sizeof *tri);
    l->out.face_source = malloc(face_count * sizeof *tri);
    l->out.positions = malloc(vertex_count * 3 * sizeof *xyz);
    return l;
}

lods *lods_copy(const double *xyz, size_t vertex_count, const uint32_t *tri,
                size_t face_count)
{
    double *points = malloc(vertex_count * 3 * sizeof *points);
    uint32_t *faces = malloc(face_count * 3 * sizeof *faces);

    memcpy(points, xyz, vertex_count * 3 * sizeof *points);
    memcpy(faces, tri, face_count * 3 * sizeof *faces);
    return lods_make(points, vertex_count, faces, face_count);
}

void lods_free(lods *l)
{
    free(l->xyz);
    free(l->tri);
    free(l->out.indices);
    free(l->out.position_indices);
    free(l->out.face_source);
    free(l->out.positions);
    for (size_t i = 0; i < l->in.attribute_count; i++) {
        free((void *)(uintptr_t)l->attributes[i].values);
        free(l->out.attribute_values[i]);
    }
    free(l);
}

static void put_face(uint32_t **next, uint32_t a, uint32_t b, uint32_t c)
{
    *(*next)++ = a;
    *(*next)++ = b;
    *(*next)++ = c;
}

/* Rings of 2 * size vertices between two poles. */
lods *lods_sphere(uint32_t size)
{
    const uint32_t rings = size - 1, around = 2 * size;
    const uint32_t count = rings * around + 2;
    double *xyz = malloc(3 * (size_t)count * sizeof *xyz), *p = xyz;
    uint32_t *tri = malloc(6 * (size_t)rings * around * sizeof *tri), *t = tri;

    for (uint32_t j = 0; j < rings; j++) {
        for (uint32_t i = 0; i < around; i++) {
            const double u = 2 * PI * (i + 0.5 * j) / around;
            const double v = PI * (j + 1) / (rings + 1);
            *p++ = sin(v) * cos(u);
            *p++ = sin(v) * sin(u);
            *p++ = cos(v);
        }
    }
    memcpy(p, (double[]){ 0, 0, 1, 0, 0, -1 }, 6 * sizeof *p);
    for (uint32_t i = 0; i < around; i++) {
        const uint32_t right = (i + 1) % around, last = (rings - 1) * around;
        put_face(&t, count - 2, i, right);
        put_face(&t, count - 1, last + right, last + i);
        for (uint32_t j = 0; j + 1 < rings; j++) {
            const uint32_t up = j * around, down = up + around;
            put_face(&t, up + i, down + i, up + right);
            put_face(&t, up + right, down + i, down + right);
        }
    }
    return lods_make(xyz, count, tri, (size_t)(t - tri) / 3);
}

static lods *lattice(uint32_t size, double scale, double bump)
{
    const uint32_t w = size + 1;
    double *xyz = malloc(3 * (size_t)w * w * sizeof *xyz), *p = xyz;
    uint32_t *tri = malloc(6 * (size_t)size * size * sizeof *tri), *t = tri;
    uint32_t seed = 11;

    for (uint32_t j = 0; j < w; j++) {
        for (uint32_t i = 0; i < w; i++) {
            const double z = sin(0.5 * i) * cos(0.4 * j) +
                             0.2 * (shape_random(&seed, 1000) / 1000.0);
            *p++ = i * scale;
            *p++ = j * scale;
            *p++ = floor(bump * z * 1048576) / 1048576;
        }
    }
    for (uint32_t j = 0; j < size; j++) {
        for (uint32_t i = 0; i < size; i++) {
            const uint32_t at = j * w + i;
            put_face(&t, at, at + 1, at + w + 1);
            put_face(&t, at, at + w + 1, at + w);
        }
    }
    return lods_make(xyz, (size_t)w * w, tri, 2 * (size_t)size * size);
}

lods *lods_terrain(uint32_t size)
{
    return lattice(size, 1, 1);
}

lods *lods_flat(uint32_t size)
{
    return lattice(size, 1, 0);
}

lods *lods_tetrahedra(uint32_t count)
{
    static const double shape[12] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1 };
    static const uint32_t faces[12] = { 0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3 };
    double *xyz = malloc(12 * (size_t)count * sizeof *xyz);
    uint32_t *tri = malloc(12 * (size_t)count * sizeof *tri);

    for (uint32_t k = 0; k < count; k++)
        for (uint32_t i = 0; i < 12; i++) {
            xyz[12 * k + i] = shape[i] * (1 + 0.1 * k) + 3 * (double)k;
            tri[12 * k + i] = faces[i] + 4 * k;
        }
    return lods_make(xyz, 4 * (size_t)count, tri, 4 * (size_t)count);
}

lods *lods_soup(uint32_t faces, uint32_t vertices, uint32_t seed)
{
    double *xyz = malloc(3 * (size_t)vertices * sizeof *xyz);
    uint32_t *tri = malloc(3 * (size_t)faces * sizeof *tri);

    for (uint32_t i = 0; i < 3 * vertices; i++)
        xyz[i] = shape_random(&seed, 7); /* some at one place */
    for (uint32_t i = 0; i < 3 * faces; i++)
        tri[i] = shape_random(&seed, vertices);
    return lods_make(xyz, vertices, tri, faces);
}

void lods_add(lods *l, pmesh_attribute_kind kind, uint8_t components,
              float *values, float weight)
{
    const size_t i = l->in.attribute_count++;
    pmesh_simplify_attribute *a = &l->attributes[i];

    *a = (pmesh_simplify_attribute){ .kind = kind,
                                     .components = components,
                                     .values = values };
    for (size_t k = 0; k < components; k++)
        a->weight[k] = weight;
    l->out.attribute_values[i] =
        malloc(l->in.vertex_count * components * sizeof(float));
}

pmesh_status lods_run(lods *l)
{
    return pmesh_simplify_mesh(&l->in, &l->options, &l->out);
}

bool lods_is_sound(const lods *l)
{
    for (size_t f = 0; f < l->out.face_count; f++) {
        const uint32_t *t = &l->out.indices[3 * f];
        const uint32_t *p = &l->out.position_indices[3 * f];
        for (size_t k = 0; k < 3; k++)
            if (t[k] >= l->in.vertex_count || p[k] >= l->in.vertex_count)
                return false;
        if (p[0] == p[1] || p[1] == p[2] || p[2] == p[0])
            return false;
    }
    return true;
}

bool lods_is_closed(const lods *l)
{
    const uint32_t *p = l->out.position_indices;
    const size_t corners = 3 * l->out.face_count;

    if (!lods_is_sound(l))
        return false;
    for (size_t c = 0; c < corners; c++) {
        const uint32_t a = p[c], b = p[c % 3 == 2 ? c - 2 : c + 1];
        size_t same = 0, opposite = 0;
        for (size_t d = 0; d < corners; d++) {
            const uint32_t e = p[d], f = p[d % 3 == 2 ? d - 2 : d + 1];
            same += e == a && f == b;
            opposite += e == b && f == a;
        }
        if (same != 1 || opposite != 1)
            return false;
    }
    return true;
}

static uint32_t root(uint32_t *parent, uint32_t v)
{
    while (parent[v] != v)
        v = parent[v] = parent[parent[v]];
    return v;
}

size_t lods_components(const lods *l)
{
    const size_t n = l->in.vertex_count;
    uint32_t *parent = malloc(n * sizeof *parent);
    bool *seen = calloc(n, sizeof *seen);
    size_t count = 0;

    for (uint32_t v = 0; v < n; v++)
        parent[v] = v;
    for (size_t c = 0; c < 3 * l->out.face_count; c++) {
        const uint32_t *p = &l->out.position_indices[c - c % 3];
        parent[root(parent, p[c % 3])] = root(parent, p[0]);
    }
    for (size_t c = 0; c < 3 * l->out.face_count; c++) {
        const uint32_t r = root(parent, l->out.position_indices[c]);
        count += !seen[r];
        seen[r] = true;
    }
    free(parent);
    free(seen);
    return count;
}

bool lods_same_faces(const lods *a, const lods *b)
{
    return a->out.face_count == b->out.face_count &&
           memcmp(a->out.indices, b->out.indices,
                  3 * a->out.face_count * sizeof *a->out.indices) == 0;
}

void lods_normal(const lods *l, size_t face, double out[3])
{
    const double *p[3];
    double a[3], b[3];

    for (size_t k = 0; k < 3; k++)
        p[k] = &l->out.positions[3 * (size_t)l->out.indices[3 * face + k]];
    for (size_t i = 0; i < 3; i++) {
        a[i] = p[1][i] - p[0][i];
        b[i] = p[2][i] - p[0][i];
    }
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

double lods_volume(const double *xyz, const uint32_t *tri, size_t face_count)
{
    double sum = 0;

    for (size_t f = 0; f < face_count; f++) {
        const double *a = &xyz[3 * (size_t)tri[3 * f]];
        const double *b = &xyz[3 * (size_t)tri[3 * f + 1]];
        const double *c = &xyz[3 * (size_t)tri[3 * f + 2]];
        sum += a[0] * (b[1] * c[2] - b[2] * c[1]) +
               a[1] * (b[2] * c[0] - b[0] * c[2]) +
               a[2] * (b[0] * c[1] - b[1] * c[0]);
    }
    return sum / 6;
}

double lods_sphere_rms(const lods *l)
{
    double sum = 0;

    for (size_t f = 0; f < l->out.face_count; f++) {
        double m[3] = { 0, 0, 0 };
        for (size_t k = 0; k < 3; k++)
            for (size_t i = 0; i < 3; i++)
                m[i] +=
                    l->out
                        .positions[3 * (size_t)l->out.indices[3 * f + k] + i] /
                    3;
        const double r = sqrt(m[0] * m[0] + m[1] * m[1] + m[2] * m[2]) - 1;
        sum += r * r;
    }
    return sqrt(sum / (double)l->out.face_count);
}

static void *budget_alloc(void *user, size_t size)
{
    lods_budget *budget = user;

    if (budget->left == 0)
        return NULL;
    budget->left--;
    budget->bytes += size;
    return malloc(size ? size : 1);
}

static void budget_release(void *user, void *ptr, size_t size)
{
    lods_budget *budget = user;

    budget->bytes -= size;
    free(ptr);
}

pmesh_allocator lods_budget_allocator(lods_budget *budget)
{
    return (pmesh_allocator){ budget_alloc, budget_release, budget };
}
