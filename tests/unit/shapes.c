/* SPDX-License-Identifier: MIT */
#include "tests/unit/shapes.h"

#include <stdlib.h>
#include <string.h>

#include "tools/trig.h"

static const double pi = 3.14159265358979323846;

/* Of radians; unlike the C library's the same on every machine. */
static double sine(double x)
{
    return trig_sin(x / (2 * pi));
}

static double cosine(double x)
{
    return trig_cos(x / (2 * pi));
}

uint32_t shape_random(uint32_t *seed, uint32_t below)
{
    *seed = *seed * 1664525u + 1013904223u;
    return (uint32_t)((uint64_t)(*seed >> 8) * below >> 24);
}

static shape_mesh *shape_alloc(size_t vertices, size_t faces)
{
    shape_mesh *s = calloc(1, sizeof *s);
    s->positions = calloc(3 * vertices, sizeof *s->positions);
    s->indices = calloc(3 * faces, sizeof *s->indices);
    s->input = (pmesh_mesh_input){ .positions = s->positions,
                                   .vertex_count = vertices,
                                   .indices = s->indices,
                                   .face_count = faces };
    return s;
}

void shape_free(shape_mesh *s)
{
    for (int i = 0; i < SHAPE_ATTRIBUTES; i++)
        free(s->values[i]);
    free(s->corner_indices);
    free(s->materials);
    free(s->indices);
    free(s->positions);
    free(s);
}

static float *add_attribute(shape_mesh *s, pmesh_attribute_kind kind,
                            uint8_t components, size_t count,
                            const uint32_t *indices)
{
    const size_t i = s->input.attribute_count++;
    s->values[i] = calloc(count * components, sizeof(float));
    s->attributes[i] = (pmesh_attribute_input){ .kind = kind,
                                                .components = components,
                                                .values = s->values[i],
                                                .count = count,
                                                .indices = indices };
    s->input.attributes = s->attributes;
    return s->values[i];
}

static double bump(double x, double y, uint32_t seed)
{
    return 0.1 * sine(5 * x + seed) * cosine(4 * y) +
           0.02 * sine(23 * x + 19 * y);
}

/* A (rows x columns) grid of quads, joined across columns, and across rows too
 * if `closed`; two triangles each. */
static void grid_faces(shape_mesh *s, uint32_t rows, uint32_t columns,
                       uint32_t row_size, bool wrap_rows, bool wrap_columns)
{
    uint32_t *out = s->indices;
    for (uint32_t r = 0; r < rows; r++)
        for (uint32_t c = 0; c < columns; c++) {
            const uint32_t r1 = wrap_rows && r + 1 == rows ? 0 : r + 1;
            const uint32_t c1 = wrap_columns && c + 1 == columns ? 0 : c + 1;
            const uint32_t q[4] = { r * row_size + c, r * row_size + c1,
                                    r1 * row_size + c1, r1 * row_size + c };
            const uint32_t t[6] = { q[0], q[1], q[2], q[0], q[2], q[3] };
            memcpy(out, t, sizeof t);
            out += 6;
        }
}

static shape_mesh *make_torus(uint32_t n, uint32_t seed)
{
    shape_mesh *s = shape_alloc((size_t)n * n, 2 * (size_t)n * n);
    for (uint32_t r = 0; r < n; r++)
        for (uint32_t c = 0; c < n; c++) {
            const double a = 2 * pi * r / n, b = 2 * pi * c / n;
            const double k = 0.4 + bump(cosine(a), sine(b), seed);
            double *p = s->positions + 3 * ((size_t)r * n + c);
            p[0] = (1 + k * cosine(b)) * cosine(a);
            p[1] = (1 + k * cosine(b)) * sine(a);
            p[2] = k * sine(b);
        }
    grid_faces(s, n, n, n, true, true);
    return s;
}

static shape_mesh *make_terrain(uint32_t n, uint32_t seed)
{
    const uint32_t m = n + 1;
    shape_mesh *s = shape_alloc((size_t)m * m, 2 * (size_t)n * n);
    float *color =
        add_attribute(s, PMESH_COLOR, 4, (size_t)m * m, NULL);
    for (uint32_t r = 0; r < m; r++)
        for (uint32_t c = 0; c < m; c++) {
            const size_t i = (size_t)r * m + c;
            const double x = (double)c / n, y = (double)r / n;
            const double z = bump(3 * x, 3 * y, seed);
            const double p[3] = { x, y, z };
            memcpy(s->positions + 3 * i, p, sizeof p);
            color[4 * i] = (float)x;
            color[4 * i + 1] = (float)(0.5 + 4 * z);
            color[4 * i + 3] = 1;
        }
    grid_faces(s, n, n, m, false, false);
    return s;
}

/* Columns meet along a seam: the vertices there are listed once, the texture
 * coordinates twice. Poles are small holes. */
static shape_mesh *make_sphere(uint32_t n, uint32_t seed)
{
    const uint32_t rows = n, columns = 2 * n;
    const size_t vertices = (size_t)(rows + 1) * columns;
    shape_mesh *s = shape_alloc(vertices, 2 * (size_t)rows * columns);
    const uint32_t uv_row = columns + 1;
    s->corner_indices = calloc(3 * s->input.face_count, sizeof(uint32_t));
    float *normal = add_attribute(s, PMESH_NORMAL, 3, vertices, NULL);
    float *uv = add_attribute(s, PMESH_TEXCOORD, 2,
                              (size_t)(rows + 1) * uv_row, s->corner_indices);
    for (uint32_t r = 0; r <= rows; r++)
        for (uint32_t c = 0; c < columns; c++) {
            const size_t i = (size_t)r * columns + c;
            const double a = pi * (r + 0.5) / (rows + 1);
            const double b = 2 * pi * c / columns;
            const double d[3] = { sine(a) * cosine(b), sine(a) * sine(b),
                                  cosine(a) };
            const double k = 1 + bump(d[0] + d[2], d[1], seed);
            for (int j = 0; j < 3; j++) {
                s->positions[3 * i + (size_t)j] = k * d[j];
                normal[3 * i + (size_t)j] = (float)d[j];
            }
        }
    for (uint32_t r = 0; r <= rows; r++)
        for (uint32_t c = 0; c <= columns; c++) {
            uv[2 * ((size_t)r * uv_row + c)] = (float)c / (float)columns;
            uv[2 * ((size_t)r * uv_row + c) + 1] = (float)r / (float)rows;
        }
    grid_faces(s, rows, columns, uv_row, false, false);
    memcpy(s->corner_indices, s->indices,
           3 * s->input.face_count * sizeof(uint32_t));
    grid_faces(s, rows, columns, columns, false, true);

    s->materials = calloc(s->input.face_count, sizeof(uint32_t));
    for (size_t f = s->input.face_count / 3; f < s->input.face_count; f++)
        s->materials[f] = f % 5 == 0 ? 2 : 1;
    s->input.materials = s->materials;
    s->input.material_count = 3;
    return s;
}

static shape_mesh *make_facets(uint32_t n, uint32_t seed)
{
    shape_mesh *s = make_torus(n, seed);
    const size_t faces = s->input.face_count;
    s->corner_indices = calloc(3 * faces, sizeof(uint32_t));
    float *normal =
        add_attribute(s, PMESH_NORMAL, 3, faces, s->corner_indices);
    for (size_t f = 0; f < faces; f++) {
        for (size_t k = 0; k < 3; k++) {
            s->corner_indices[3 * f + k] = (uint32_t)f;
            normal[3 * f + k] = (float)((f * (7 + k)) % 13) - 6;
        }
    }
    return s;
}

static shape_mesh *make_soup(uint32_t n, uint32_t seed)
{
    shape_mesh *s = shape_alloc(n, 3 * (size_t)n);
    for (size_t i = 0; i < 3 * (size_t)n; i++)
        s->positions[i] = shape_random(&seed, 10);
    for (size_t i = 0; i < 9 * (size_t)n; i++)
        s->indices[i] = shape_random(&seed, n);
    return s;
}

static shape_mesh *make_pieces(uint32_t n, uint32_t seed)
{
    static const uint32_t corners[] = { 0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2 };
    shape_mesh *s = shape_alloc(4 * (size_t)n, 4 * (size_t)n);
    for (uint32_t i = 0; i < n; i++) {
        for (uint32_t k = 0; k < 4; k++)
            for (uint32_t j = 0; j < 3; j++)
                s->positions[12 * (size_t)i + 3 * k + j] =
                    (j == 0 ? 2.0 * i : 0) + (k == j + 1) +
                    shape_random(&seed, 100) / 1000.0;
        for (uint32_t k = 0; k < 12; k++)
            s->indices[12 * (size_t)i + k] = 4 * i + corners[k];
    }
    return s;
}

shape_mesh *shape_make(shape_kind kind, uint32_t size, uint32_t seed)
{
    switch (kind) {
    case SHAPE_SPHERE: return make_sphere(size, seed);
    case SHAPE_TERRAIN: return make_terrain(size, seed);
    case SHAPE_FACETS: return make_facets(size, seed);
    case SHAPE_SOUP: return make_soup(size, seed);
    case SHAPE_PIECES: return make_pieces(size, seed);
    default: return make_torus(size, seed);
    }
}

static int append(void *user, const void *data, size_t size)
{
    shape_bytes *out = user;
    if (out->capacity - out->size < size) {
        out->capacity = 2 * (out->size + size);
        out->data = realloc(out->data, out->capacity);
    }
    memcpy(out->data + out->size, data, size);
    out->size += size;
    return 0;
}

pmesh_status shape_bake(const shape_mesh *shape,
                        const pmesh_encoder_config *config, shape_bytes *out,
                        pmesh_encode_report *report)
{
    *out = (shape_bytes){ 0 };
    *report = (pmesh_encode_report){ 0 };
    return pmesh_encode(&shape->input, config, append, out, report);
}

pmesh_decoder *shape_decode(const uint8_t *data, size_t size, size_t piece,
                            pmesh_status *status)
{
    pmesh_decoder *dec;
    *status = pmesh_decoder_create(&dec, NULL);
    if (*status != PMESH_OK)
        return NULL;
    *status = pmesh_decoder_feed(dec, NULL, 0);
    for (size_t at = 0; at < size; at += piece) {
        const size_t part = size - at < piece ? size - at : piece;
        uint8_t *copy = malloc(part); /* exact: ASan sees its end */
        memcpy(copy, data + at, part);
        *status = pmesh_decoder_feed(dec, copy, part);
        free(copy);
    }
    return dec;
}

static uint64_t hash_bytes(uint64_t h, const void *data, size_t size)
{
    const uint8_t *p = data;
    for (size_t i = 0; i < size; i++)
        h = (h ^ p[i]) * 0x100000001b3u;
    return h;
}

uint64_t shape_view_hash(const pmesh_decoder *dec)
{
    pmesh_view v;
    uint64_t h = 0xcbf29ce484222325u;
    if (pmesh_decoder_mesh(dec, &v) != PMESH_OK)
        return 0;
    h = hash_bytes(h, v.indices, 12 * (size_t)v.face_count);
    h = hash_bytes(h, v.positions, 12 * (size_t)v.mesh_vertex_count);
    if (v.values) {
        h = hash_bytes(h, v.values,
                       2 * (size_t)v.value_stride * v.vertex_count);
        h = hash_bytes(h, v.positions_of, 4 * (size_t)v.vertex_count);
    }
    if (v.materials)
        h = hash_bytes(h, v.materials, 4 * (size_t)v.face_count);
    return h;
}

bool shape_view_sound(const pmesh_decoder *dec)
{
    pmesh_view v;
    if (pmesh_decoder_mesh(dec, &v) != PMESH_OK)
        return false;
    for (uint32_t f = 0; f < v.face_count; f++) {
        uint32_t vertex[3];
        for (uint32_t k = 0; k < 3; k++) {
            const uint32_t w = v.indices[3 * (size_t)f + k];
            if (w >= v.vertex_count)
                return false;
            vertex[k] = v.positions_of ? v.positions_of[w] : w;
            if (vertex[k] >= v.mesh_vertex_count)
                return false;
        }
        if (vertex[0] == vertex[1] || vertex[1] == vertex[2] ||
            vertex[2] == vertex[0])
            return false;
    }
    return true;
}
