/* SPDX-License-Identifier: MIT */
#include "tools/sample.h"

#include <math.h>
#include <stdlib.h>

#include "tools/shell.h"

#define LEAST_AROUND 8u
#define ASPECT 0.87 /* ring distance by edge length: equilateral triangles */

/* A ring of vertices. */
typedef struct row {
    shell_ring ring;
    double spacing;  /* edge length */
    double along;    /* texture coordinate, 0 .. 1 */
    uint32_t around; /* vertices; corners of the texture: one more */
} row;

typedef struct rows {
    row *items;
    size_t count, capacity;
    bool failed; /* out of memory */
} rows;

/* ---- rings -------------------------------------------------------------- */

static bool add_row(rows *list, double at)
{
    if (list->count == list->capacity) {
        const size_t capacity = list->capacity ? 2 * list->capacity : 256;
        row *grown = realloc(list->items, capacity * sizeof *grown);
        if (!grown) {
            list->failed = true;
            return false;
        }
        list->items = grown;
        list->capacity = capacity;
    }
    list->items[list->count++] = (row){ .along = at };
    return true;
}

/* Finer where the shell is small, but not in proportion; coarser inside. */
static double spacing_at(shell_part part, const shell_ring *r, double unit)
{
    const double radius = shell_spiral_radius(r->turn);
    const double spacing = unit * sqrt(radius);
    return part == SHELL_INSIDE || part == SHELL_WALL ? 2 * spacing : spacing;
}

static void set_row(row *r, shell_part part, double at, double unit)
{
    r->ring = shell_ring_at(part, at);
    r->spacing = spacing_at(part, &r->ring, unit);
    const double length =
        6.0 * r->ring.scale * shell_tube_radius(r->ring.turn);
    r->around =
        (uint32_t)fmax(LEAST_AROUND, floor(length / r->spacing + 0.5));
    r->along = ((int)part + at) / SHELL_PARTS;
}

/* Rings behind the start of a part up to its end. The steps suit the spacing;
 * then all are shrunk so that the last one ends with the part. */
static void add_part(rows *list, shell_part part, double unit)
{
    const size_t first = list->count;
    double at = 0;

    while (at < 1) {
        const shell_ring r = shell_ring_at(part, at);
        at += ASPECT * spacing_at(part, &r, unit) / shell_speed(part, at);
        if (!add_row(list, at))
            return;
    }
    for (size_t i = first; i < list->count; i++)
        set_row(&list->items[i], part, list->items[i].along / at, unit);
}

static void make_rows(rows *list, double unit)
{
    list->count = 0;
    for (int part = 0; part < SHELL_PARTS && !list->failed; part++)
        add_part(list, (shell_part)part, unit);
    /* The last ring is the point that closes the wall. */
    if (list->count > 0)
        list->count--;
}

static uint64_t face_count(const rows *list)
{
    uint64_t faces = 0;
    for (size_t i = 0; i < list->count; i++)
        faces += 2 * (uint64_t)list->items[i].around;
    return faces;
}

/* Finds the edge length that gives the wanted number of faces. */
static bool fit_rows(rows *list, uint32_t faces)
{
    double low = 1e-5, high = 1;
    for (int i = 0; i < 40 && !list->failed; i++) {
        const double middle = sqrt(low * high);
        make_rows(list, middle);
        if (face_count(list) > faces)
            low = middle;
        else
            high = middle;
    }
    return !list->failed;
}

/* ---- mesh --------------------------------------------------------------- */

static double rounded(double x, double steps)
{
    return floor(x * steps + 0.5) / steps;
}

static void set_point(double *to, const shell_ring *ring, double around,
                      double spacing)
{
    shell_point(ring, around, spacing, to);
    for (int k = 0; k < 3; k++)
        to[k] = rounded(to[k], 1e6);
}

static void set_texture(float *to, double around, double along)
{
    to[0] = (float)rounded(around, 1e5);
    to[1] = (float)rounded(along, 1e5);
}

/* Vertex 0 is the tip, the last one the middle of the wall. Each of the two
 * has a texture corner per face. */
static void set_vertices(const rows *list, asset *out)
{
    double *p = out->positions;
    float *uv = out->attributes[1].values;
    const row *first = &list->items[0];
    const row *last = &list->items[list->count - 1];
    const shell_ring tip = shell_ring_at(SHELL_TIP, 0);
    const shell_ring end = shell_ring_at(SHELL_WALL, 1);

    set_point(p, &tip, 0, first->spacing);
    p += 3;
    for (uint32_t i = 0; i < first->around; i++, uv += 2)
        set_texture(uv, (i + 0.5) / first->around, 0);
    for (size_t k = 0; k < list->count; k++) {
        const row *r = &list->items[k];
        for (uint32_t i = 0; i <= r->around; i++, uv += 2) {
            const double around = (double)i / r->around;
            set_texture(uv, around, r->along);
            if (i < r->around) {
                set_point(p, &r->ring, around, r->spacing);
                p += 3;
            }
        }
    }
    set_point(p, &end, 0, last->spacing);
    for (uint32_t i = 0; i < last->around; i++, uv += 2)
        set_texture(uv, (i + 0.5) / last->around, 1);
}

/* Where faces go. */
typedef struct sink {
    uint32_t *corner, *texture;
} sink;

static void put_corner(sink *to, uint32_t vertex, uint32_t texture)
{
    *to->corner++ = vertex;
    *to->texture++ = texture;
}

/* First vertex and first texture corner of a ring. */
typedef struct start {
    uint32_t vertex, texture;
} start;

static void put_ring_corner(sink *to, start s, const row *r, uint32_t i)
{
    put_corner(to, s.vertex + i % r->around, s.texture + i);
}

/* Fills the band between two rings: a triangle at a time on the side that lags
 * behind, on alternate sides if none does.
 *
 *   b  +-----+-----+
 *      |\   /|\   /
 *   a  +--+--+--+--+                                                       */
static void put_band(sink *to, const row *a, start sa, const row *b, start sb)
{
    uint32_t i = 0, j = 0;
    while (i < a->around || j < b->around) {
        const uint64_t next_a = (uint64_t)(i + 1) * b->around;
        const uint64_t next_b = (uint64_t)(j + 1) * a->around;
        const bool odd = (i + j) % 4 >= 2;
        if (next_a < next_b || (next_a == next_b && odd)) {
            put_ring_corner(to, sa, a, i);
            put_ring_corner(to, sa, a, i + 1);
            put_ring_corner(to, sb, b, j);
            i++;
        } else {
            put_ring_corner(to, sa, a, i);
            put_ring_corner(to, sb, b, j + 1);
            put_ring_corner(to, sb, b, j);
            j++;
        }
    }
}

static void set_faces(const rows *list, asset *out)
{
    const row *first = &list->items[0];
    const row *last = &list->items[list->count - 1];
    sink to = { out->indices, out->attributes[1].indices };
    start s = { 1, first->around };

    for (uint32_t i = 0; i < first->around; i++) {
        put_corner(&to, 0, i);
        put_ring_corner(&to, s, first, i + 1);
        put_ring_corner(&to, s, first, i);
    }
    for (size_t k = 0; k + 1 < list->count; k++) {
        const row *a = &list->items[k];
        const start next = { s.vertex + a->around,
                             s.texture + a->around + 1 };
        put_band(&to, a, s, a + 1, next);
        s = next;
    }
    const start end = { s.vertex + last->around,
                        s.texture + last->around + 1 };
    for (uint32_t i = 0; i < last->around; i++) {
        put_corner(&to, end.vertex, end.texture + i);
        put_ring_corner(&to, s, last, i);
        put_ring_corner(&to, s, last, i + 1);
    }
}

/* Area-weighted means of the faces around. */
static bool set_normals(asset *out)
{
    double *sum = calloc(3 * out->vertex_count, sizeof *sum);
    if (!sum)
        return false;
    for (size_t f = 0; f < out->face_count; f++) {
        const double *p[3];
        for (size_t k = 0; k < 3; k++)
            p[k] = out->positions + 3 * (size_t)out->indices[3 * f + k];
        for (size_t k = 0; k < 3; k++) {
            const size_t y = (k + 1) % 3, z = (k + 2) % 3;
            const double n = (p[1][y] - p[0][y]) * (p[2][z] - p[0][z]) -
                             (p[1][z] - p[0][z]) * (p[2][y] - p[0][y]);
            for (size_t c = 0; c < 3; c++)
                sum[3 * (size_t)out->indices[3 * f + c] + k] += n;
        }
    }
    for (size_t v = 0; v < out->vertex_count; v++) {
        const double *n = sum + 3 * v;
        const double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        for (size_t k = 0; k < 3; k++)
            out->attributes[0].values[3 * v + k] =
                (float)rounded(n[k] / length, 1e4);
    }
    free(sum);
    return true;
}

static bool make_room(const rows *list, asset *out)
{
    asset_attribute *normals = &out->attributes[0];
    asset_attribute *texture = &out->attributes[1];
    const size_t ends = (size_t)list->items[0].around +
                        list->items[list->count - 1].around;

    out->vertex_count = 2;
    texture->count = ends;
    for (size_t i = 0; i < list->count; i++) {
        out->vertex_count += list->items[i].around;
        texture->count += list->items[i].around + 1;
    }
    out->face_count = (size_t)face_count(list);
    out->material_count = 1;
    out->attribute_count = 2;
    normals->kind = PMESH_NORMAL;
    normals->components = 3;
    normals->count = out->vertex_count;
    texture->kind = PMESH_TEXCOORD;
    texture->components = 2;
    out->positions = malloc(3 * out->vertex_count * sizeof *out->positions);
    out->indices = malloc(3 * out->face_count * sizeof *out->indices);
    normals->values = malloc(3 * normals->count * sizeof *normals->values);
    texture->values = malloc(2 * texture->count * sizeof *texture->values);
    texture->indices = malloc(3 * out->face_count * sizeof *texture->indices);
    return out->positions && out->indices && normals->values &&
           texture->values && texture->indices;
}

bool sample_build(uint32_t faces, asset *out)
{
    rows list = { 0 };

    *out = (asset){ 0 };
    bool ok = fit_rows(&list, faces) && make_room(&list, out);
    if (ok) {
        set_vertices(&list, out);
        set_faces(&list, out);
        ok = set_normals(out);
    }
    free(list.items);
    if (!ok) {
        asset_free(out);
        *out = (asset){ 0 };
    }
    return ok;
}
