/* SPDX-License-Identifier: MIT */
#include "tests/golden/golden_mesh.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

#include "tools/trig.h"

static const char *const names[] = { "skin", "", "gold \xc3\xa9", "",
                                     "moss", "clay", "rust" };

/* The shape's arrays hold a torus of at least as many vertices and faces; here
 * they get others. */
static void put_face(pmesh_mesh_input *in, uint32_t *indices, uint32_t a,
                     uint32_t b, uint32_t c)
{
    uint32_t *out = indices + 3 * in->face_count++;
    out[0] = a;
    out[1] = b;
    out[2] = c;
}

static void put_vertex(pmesh_mesh_input *in, double *positions, double radius,
                       double turns, double height)
{
    double *out = positions + 3 * in->vertex_count++;
    out[0] = 1000 + radius * trig_cos(turns);
    out[1] = -500 + radius * trig_sin(turns);
    out[2] = height;
}

static void make_triangle(shape_mesh *s)
{
    s->input.vertex_count = s->input.face_count = 0;
    for (int k = 0; k < 3; k++)
        put_vertex(&s->input, s->positions, 1, k / 3.0, k);
    put_face(&s->input, s->indices, 0, 1, 2);
}

/* A hub, and `rows` rings of n vertices; the last ring is the boundary, or
 * meets in a second hub. */
static void make_hubs(shape_mesh *s, uint32_t n, uint32_t rows, bool closed)
{
    pmesh_mesh_input *in = &s->input;
    const uint32_t end = 1 + rows * n;
    in->vertex_count = in->face_count = 0;
    put_vertex(in, s->positions, 0, 0, 0.7);
    for (uint32_t r = 0; r < rows; r++)
        for (uint32_t c = 0; c < n; c++) {
            const double t = (r + 1.0) / (rows + 1);
            const double turns = (double)c / n;
            put_vertex(in, s->positions,
                       closed ? trig_sin(t / 2) : t + 0.1 * trig_cos(5 * turns),
                       turns, t * t + 0.05 * trig_sin(3 * turns));
        }
    if (closed)
        put_vertex(in, s->positions, 0, 0, 1.5);
    for (uint32_t c = 0; c < n; c++) {
        const uint32_t c1 = (c + 1) % n;
        put_face(in, s->indices, 0, 1 + c, 1 + c1);
        for (uint32_t r = 1; r < rows; r++) {
            const uint32_t inner = 1 + (r - 1) * n, outer = 1 + r * n;
            put_face(in, s->indices, inner + c, outer + c, outer + c1);
            put_face(in, s->indices, inner + c, outer + c1, inner + c1);
        }
        if (closed)
            put_face(in, s->indices, end, end - n + c1, end - n + c);
    }
}

/* Value k at p: smooth; tiny, negative, constant, or as large as floats are,
 * from channel to channel. */
static float channel_value(const double *p, uint32_t channel, uint32_t k)
{
    static const struct {
        double scale, offset;
    } range[PMESH_MAX_ATTRIBUTES] = { { 1, 0 },     { 1, 0 },     { -3e-9, 10 },
                                      { 0.4, 0.5 }, { 0.5, 0.5 }, { 1e39, 0 },
                                      { 0, 42 },    { 7, -100 } };
    const double wave = trig_sin(0.3 * p[k % 3] + 0.1 * p[(k + 1) % 3]);
    const double value = range[channel].offset + range[channel].scale * wave;
    return value > FLT_MAX    ? FLT_MAX
           : value < -FLT_MAX ? -FLT_MAX
                              : (float)value;
}

static void add_channel(golden_mesh *m, pmesh_attribute_kind kind, uint8_t set,
                        uint8_t components, uint8_t bits)
{
    const uint32_t i = (uint32_t)m->input.attribute_count++;
    const size_t count = m->input.vertex_count;
    float *value = calloc(count * components, sizeof *value);
    for (size_t v = 0; v < count; v++)
        for (uint32_t k = 0; k < components; k++)
            value[v * components + k] =
                channel_value(m->input.positions + 3 * v, i, k);
    m->values[i] = value;
    m->channels[i] = (pmesh_attribute_input){ .kind = kind,
                                              .set = set,
                                              .components = components,
                                              .bits = bits,
                                              .values = value,
                                              .count = count };
    m->input.attributes = m->channels;
}

static void add_channels(golden_mesh *m)
{
    add_channel(m, PMESH_NORMAL, 0, 3, 16);
    add_channel(m, PMESH_TEXCOORD, 0, 2, 9);
    add_channel(m, PMESH_TEXCOORD, 1, 2, 4);
    add_channel(m, PMESH_COLOR, 0, 3, 8);
    add_channel(m, PMESH_COLOR, 1, 4, 5);
    add_channel(m, PMESH_GENERIC, 0, 1, 16);
    add_channel(m, PMESH_GENERIC, 1, 3, 12);
    add_channel(m, PMESH_GENERIC, 2, 4, 6);
}

static void add_patches(shape_mesh *s)
{
    s->materials = calloc(s->input.face_count, sizeof *s->materials);
    for (size_t f = 0; f < s->input.face_count; f++)
        s->materials[f] = (uint32_t)(f / 2 % 5 + f / 80 * 3) % 7;
    s->input.materials = s->materials;
    s->input.material_count = 7;
}

static void make_spikes(shape_mesh *s)
{
    for (size_t v = 0; v < s->input.vertex_count; v++)
        s->positions[3 * v + 2] = v % 97 == 48 ? (double)v * 0.25 : 0;
}

static void put_piece(shape_mesh *s, uint32_t kind, uint32_t *seed)
{
    static const uint32_t count[] = { 3, 3, 4, 5 };
    pmesh_mesh_input *in = &s->input;
    const uint32_t v = (uint32_t)in->vertex_count;
    const double far = 1 + shape_random(seed, 400) / 10.0;
    const double turns = shape_random(seed, 1000) / 1000.0;
    for (uint32_t i = 0; i < count[kind]; i++) {
        const double radius = far + shape_random(seed, 100) / 50.0;
        const double angle = turns + shape_random(seed, 100) / 2000.0;
        const double height = far / 2 + shape_random(seed, 100) / 50.0;
        put_vertex(in, s->positions, radius, angle, height);
    }
    put_face(in, s->indices, v, v + 1, v + 2);
    if (kind == 1)
        put_face(in, s->indices, v + 1, v, v + 2);
    if (kind == 2) {
        put_face(in, s->indices, v, v + 2, v + 3);
        put_face(in, s->indices, v + 2, v + 1, v + 3);
        put_face(in, s->indices, v + 1, v, v + 3);
    }
    if (kind == 3) {
        put_face(in, s->indices, v + 1, v, v + 3);
        put_face(in, s->indices, v, v + 1, v + 4);
    }
}

/* In place of n x n vertices. */
static void make_leaves(shape_mesh *s, uint32_t n)
{
    uint32_t seed = 11;
    s->input.vertex_count = s->input.face_count = 0;
    for (uint32_t i = 0; i < n * n / 5; i++) {
        const uint32_t kind = shape_random(&seed, 4);
        put_piece(s, kind, &seed);
    }
}

void golden_mesh_make(golden_mesh *m, int kind, uint32_t size)
{
    const int base = kind < SHAPE_COUNT       ? kind
                     : kind == GOLDEN_PATCHES ? SHAPE_TERRAIN
                     : kind == GOLDEN_SPIKES  ? SHAPE_TERRAIN
                                              : SHAPE_TORUS;
    memset(m, 0, sizeof *m);
    shape_mesh *s = m->shape = shape_make((shape_kind)base, size, 3);
    if (kind == GOLDEN_TRIANGLE)
        make_triangle(s);
    if (kind == GOLDEN_FAN || kind == GOLDEN_SPINDLE)
        make_hubs(s, size, 4, kind == GOLDEN_SPINDLE);
    if (kind == GOLDEN_LEAVES)
        make_leaves(s, size);
    if (kind == GOLDEN_PATCHES || kind == GOLDEN_LEAVES)
        add_patches(s);
    if (kind == GOLDEN_SPIKES)
        make_spikes(s);
    if (s->input.materials)
        s->input.material_names = names;
    m->input = s->input;
    if (kind == GOLDEN_CHANNELS)
        add_channels(m);
    if (kind == GOLDEN_LEAVES) {
        add_channel(m, PMESH_NORMAL, 0, 3, 10);
        add_channel(m, PMESH_TEXCOORD, 0, 2, 12);
        add_channel(m, PMESH_GENERIC, 0, 1, 8);
    }
}

void golden_mesh_free(golden_mesh *m)
{
    for (int i = 0; i < PMESH_MAX_ATTRIBUTES; i++)
        free(m->values[i]);
    shape_free(m->shape);
}
