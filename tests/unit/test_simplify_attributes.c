/* SPDX-License-Identifier: MIT */
#include "encoder/pmesh_simplify.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "tests/unit/lods.h"
#include "tests/unit/test.h"

enum { SIZE = 24 }; /* of the lattices */

/* Red is a step from 0 to 1 at x = 12, green a smooth wave, blue constant. */
static void color_at(const double p[3], float out[])
{
    const double t = p[0] - 12;

    out[0] = (float)(t < 0 ? 0 : t > 1 ? 1 : t);
    out[1] = (float)(0.5 + 0.5 * sin(0.7 * p[1]));
    out[2] = 0.25f;
}

/* Of a wavy sheet that the vertices do not show. */
static void normal_at(const double p[3], float out[])
{
    const double slope[2] = { 0.8 * cos(0.6 * p[0]), 0.8 * sin(0.5 * p[1]) };
    const double length = sqrt(1 + slope[0] * slope[0] + slope[1] * slope[1]);

    out[0] = (float)(-slope[0] / length);
    out[1] = (float)(-slope[1] / length);
    out[2] = (float)(1 / length);
}

static void texture_at(const double p[3], float out[])
{
    out[0] = (float)((p[0] + 2 * sin(0.4 * p[1])) / 30 + 0.1);
    out[1] = (float)((p[1] + 2 * sin(0.3 * p[0])) / 30 + 0.1);
}

typedef void (*field)(const double p[3], float out[]);

static void add_field(lods *l, pmesh_attribute_kind kind, uint8_t components,
                      field f, float weight)
{
    float *values = malloc(l->in.vertex_count * components * sizeof *values);

    for (size_t v = 0; v < l->in.vertex_count; v++)
        f(&l->xyz[3 * v], values + v * components);
    lods_add(l, kind, components, values, weight);
}

/* Root mean square of attribute `i`, one component, at faces' middles. */
static double attribute_error(const lods *l, size_t i, unsigned component,
                              field f)
{
    const size_t n = l->attributes[i].components;
    double sum = 0, weight = 0;

    for (size_t t = 0; t < l->out.face_count; t++) {
        double middle[3] = { 0, 0, 0 }, value = 0, normal[3];
        float want[4];
        for (size_t k = 0; k < 3; k++) {
            const size_t v = l->out.indices[3 * t + k];
            value += (double)l->out.attribute_values[i][v * n + component] / 3;
            for (size_t j = 0; j < 3; j++)
                middle[j] += l->out.positions[3 * v + j] / 3;
        }
        f(middle, want);
        lods_normal(l, t, normal);
        const double d = value - (double)want[component];
        sum += fabs(normal[2]) * d * d;
        weight += fabs(normal[2]);
    }
    return sqrt(sum / weight);
}

TEST(joint_simplification_keeps_an_edge_of_colour_on_a_plane)
{
    double error[2];

    for (int joint = 0; joint < 2; joint++) {
        lods *l = lods_flat(SIZE);
        add_field(l, PMESH_COLOR, 3, color_at, joint ? 0.05f : 0);
        l->options.faces = 200;
        CHECK(lods_run(l) == PMESH_OK);
        CHECK(l->out.face_count <= 200);
        error[joint] = attribute_error(l, 0, 0, color_at);
        lods_free(l);
    }
    CHECK(error[1] < 0.5 * error[0]);
}

/* The four kinds of the paper: xyz with rgb, st, uvw, and rgb with uvw. */
TEST(joint_simplification_beats_geometry_on_each_kind_of_attribute)
{
    static const struct {
        pmesh_attribute_kind kind;
        uint8_t components;
        field f;
    } kinds[] = { { PMESH_COLOR, 3, color_at },
                  { PMESH_TEXCOORD, 2, texture_at },
                  { PMESH_NORMAL, 3, normal_at } };

    for (unsigned set = 1; set < 8; set++) {
        double error[2][3] = { { 0 } };
        size_t count = 0;
        for (int joint = 0; joint < 2; joint++) {
            lods *l = lods_flat(SIZE);
            for (unsigned k = 0; k < 3; k++)
                if (set >> k & 1)
                    add_field(l, kinds[k].kind, kinds[k].components, kinds[k].f,
                              joint ? 0.05f : 0);
            l->options.faces = 150;
            CHECK(lods_run(l) == PMESH_OK);
            count = 0;
            for (unsigned k = 0; k < 3; k++)
                if (set >> k & 1) {
                    error[joint][count] =
                        attribute_error(l, count, 0, kinds[k].f);
                    count++;
                }
            lods_free(l);
        }
        for (size_t i = 0; i < count; i++)
            CHECK(error[1][i] < 0.9 * error[0][i]);
    }
}

TEST(weight_zero_is_as_good_as_no_attribute)
{
    lods *bare = lods_terrain(SIZE), *l = lods_terrain(SIZE);

    add_field(l, PMESH_COLOR, 3, color_at, 0);
    bare->options.faces = l->options.faces = 200;
    CHECK(lods_run(bare) == PMESH_OK && lods_run(l) == PMESH_OK);
    CHECK(lods_same_faces(bare, l));
    for (size_t c = 0; c < 3 * l->out.face_count; c++) {
        const size_t v = l->out.indices[c];
        CHECK(memcmp(&l->out.positions[3 * v], &bare->out.positions[3 * v],
                     3 * sizeof(double)) == 0);
    }
    lods_free(l);
    lods_free(bare);
}

TEST(more_weight_is_less_error)
{
    static const float weights[] = { 0, 0.003f, 0.03f, 0.1f };
    double last = HUGE_VAL;

    for (size_t i = 0; i < sizeof weights / sizeof *weights; i++) {
        lods *l = lods_terrain(SIZE);
        add_field(l, PMESH_COLOR, 3, color_at, weights[i]);
        l->options.faces = 300;
        CHECK(lods_run(l) == PMESH_OK);
        const double error = attribute_error(l, 0, 0, color_at);
        CHECK(error < last);
        last = error;
        lods_free(l);
    }
}

TEST(one_component_may_count_and_another_not)
{
    lods *l = lods_flat(SIZE), *green = lods_flat(SIZE);

    add_field(l, PMESH_COLOR, 3, color_at, 0);
    add_field(green, PMESH_COLOR, 3, color_at, 0);
    l->attributes[0].weight[0] = 0.05f;
    green->attributes[0].weight[1] = 0.05f;
    l->options.faces = green->options.faces = 150;
    CHECK(lods_run(l) == PMESH_OK && lods_run(green) == PMESH_OK);
    CHECK(attribute_error(l, 0, 0, color_at) <
          attribute_error(green, 0, 0, color_at));
    CHECK(attribute_error(green, 0, 1, color_at) <
          attribute_error(l, 0, 1, color_at));
    lods_free(l);
    lods_free(green);
}

TEST(attributes_are_made_for_the_new_place_rather_than_copied)
{
    double error[2];

    for (int copy = 0; copy < 2; copy++) {
        lods *l = lods_terrain(SIZE);
        add_field(l, PMESH_COLOR, 3, color_at, 0.03f);
        l->options.faces = 200;
        l->options.placement =
            copy ? PMESH_PLACE_ENDPOINT : PMESH_PLACE_OPTIMAL;
        CHECK(lods_run(l) == PMESH_OK);
        error[copy] = attribute_error(l, 0, 1, color_at);
        lods_free(l);
    }
    CHECK(error[0] < 0.9 * error[1]);
}

TEST(attributes_stay_in_range_and_normals_unit)
{
    lods *l = lods_terrain(SIZE);

    add_field(l, PMESH_COLOR, 3, color_at, 0.1f);
    add_field(l, PMESH_NORMAL, 3, normal_at, 0.1f);
    add_field(l, PMESH_GENERIC, 2, texture_at, 0.1f);
    for (size_t faces = 800; faces > 4; faces /= 2) {
        l->options.faces = faces;
        CHECK(lods_run(l) == PMESH_OK);
        for (size_t c = 0; c < 3 * l->out.face_count; c++) {
            const size_t v = l->out.indices[c];
            const float *color = &l->out.attribute_values[0][3 * v];
            const float *n = &l->out.attribute_values[1][3 * v];
            const double x = (double)n[0], y = (double)n[1], z = (double)n[2];
            for (int k = 0; k < 3; k++)
                CHECK(color[k] >= 0 && color[k] <= 1);
            CHECK(fabs(sqrt(x * x + y * y + z * z) - 1) < 1e-3);
        }
    }
    lods_free(l);
}

/* A sphere that was cut open along a meridian: vertices there are twice, with
 * u = 0 and with u = 1. */
static lods *globe(void)
{
    enum { AROUND = 40, RINGS = 20, W = AROUND + 1 };
    const double pi = 3.14159265358979323846;
    const size_t count = (size_t)W * (RINGS + 1);
    double *xyz = malloc(3 * count * sizeof *xyz);
    float *uv = malloc(2 * count * sizeof *uv);
    uint32_t *tri = malloc(6 * (size_t)AROUND * RINGS * sizeof *tri);
    size_t faces = 0;

    for (uint32_t j = 0; j <= RINGS; j++) {
        for (uint32_t i = 0; i < W; i++) {
            const double u = 2 * pi * (i % AROUND) / AROUND, v = pi * j / RINGS;
            const size_t at = (size_t)j * W + i;
            xyz[3 * at] = j == 0 || j == RINGS ? 0 : sin(v) * cos(u);
            xyz[3 * at + 1] = j == 0 || j == RINGS ? 0 : sin(v) * sin(u);
            xyz[3 * at + 2] = cos(v);
            uv[2 * at] = (float)i / AROUND;
            uv[2 * at + 1] = (float)j / RINGS;
        }
    }
    for (uint32_t j = 0; j < RINGS; j++) {
        for (uint32_t i = 0; i < AROUND; i++) {
            const uint32_t a = j * W + i, b = a + 1, c = a + W, d = c + 1;
            const uint32_t both[6] = { a, c, b, b, c, d };
            /* At the poles one of the two has no area. */
            if (j > 0)
                memcpy(&tri[3 * faces++], &both[0], 3 * sizeof *tri);
            if (j + 1 < RINGS)
                memcpy(&tri[3 * faces++], &both[3], 3 * sizeof *tri);
        }
    }
    lods *l = lods_make(xyz, count, tri, faces);
    lods_add(l, PMESH_TEXCOORD, 2, uv, 0.1f);
    return l;
}

static double uv_area(const float *uv, const uint32_t *t)
{
    const float *a = &uv[2 * (size_t)t[0]], *b = &uv[2 * (size_t)t[1]];
    const float *c = &uv[2 * (size_t)t[2]];

    return ((double)b[0] - (double)a[0]) * ((double)c[1] - (double)a[1]) -
           ((double)b[1] - (double)a[1]) * ((double)c[0] - (double)a[0]);
}

TEST(seams_do_not_crack_nor_turn_texture_over)
{
    for (int subset = 0; subset < 2; subset++) {
        lods *l = globe();
        if (subset)
            l->options.placement = PMESH_PLACE_ENDPOINT;
        for (size_t faces = l->in.face_count / 2; faces > 60; faces /= 2) {
            l->options.faces = faces;
            CHECK(lods_run(l) == PMESH_OK);
            CHECK(l->out.face_count <= faces);
            CHECK(lods_is_closed(l));
            for (size_t f = 0; f < l->out.face_count; f++) {
                const uint32_t *t = &l->out.indices[3 * f];
                const float *uv = l->out.attribute_values[0];
                const uint32_t *from = &l->tri[3 * l->out.face_source[f]];
                const double before = uv_area(l->attributes[0].values, from);
                CHECK(before * uv_area(uv, t) > 0);
                /* Corners of both sides in one face would span the sheet. */
                for (size_t k = 0; k < 3; k++) {
                    const float u = uv[2 * (size_t)t[k]];
                    const float w = uv[2 * (size_t)t[(k + 1) % 3]];
                    CHECK(fabs((double)u - (double)w) < 0.5);
                }
            }
        }
        lods_free(l);
    }
}

TEST(small_form_keeps_seams_it_cannot_see)
{
    lods *l = globe();
    float *xyz = malloc(3 * l->in.vertex_count * sizeof *xyz);
    uint32_t *out = malloc(3 * l->in.face_count * sizeof *out);
    size_t count;

    for (size_t i = 0; i < 3 * l->in.vertex_count; i++)
        xyz[i] = (float)l->xyz[i];
    CHECK(pmesh_simplify(l->tri, l->in.face_count, xyz, l->in.vertex_count, 0,
                         200, 0, out, &count, NULL) == PMESH_OK);
    CHECK(count <= 200);
    const float *uv = l->attributes[0].values;
    for (size_t c = 0; c < 3 * count; c++) {
        const size_t next = c % 3 == 2 ? c - 2 : c + 1;
        CHECK(fabs((double)uv[2 * (size_t)out[c]] -
                   (double)uv[2 * (size_t)out[next]]) < 0.5);
    }
    free(xyz);
    free(out);
    lods_free(l);
}

TEST(faceted_meshes_are_simplified_too)
{
    lods *smooth = lods_terrain(12);
    const size_t all = smooth->in.face_count;
    double *xyz = malloc(9 * all * sizeof *xyz);
    float *normal = malloc(9 * all * sizeof *normal);
    uint32_t *tri = malloc(3 * all * sizeof *tri);

    for (size_t c = 0; c < 3 * all; c++) {
        tri[c] = (uint32_t)c;
        memcpy(&xyz[3 * c], &smooth->xyz[3 * (size_t)smooth->tri[c]],
               3 * sizeof *xyz);
        normal[3 * c] = (float)(c / 3 % 7) / 7; /* one for each face */
        normal[3 * c + 1] = (float)(c / 3 % 11) / 11;
        normal[3 * c + 2] = 1;
    }
    lods *l = lods_make(xyz, 3 * all, tri, all);
    lods_add(l, PMESH_NORMAL, 3, normal, 0.01f);
    for (int subset = 0; subset < 2; subset++) {
        if (subset)
            l->options.placement = PMESH_PLACE_ENDPOINT;
        l->options.faces = all / 5;
        CHECK(lods_run(l) == PMESH_OK);
        CHECK(l->out.face_count <= all / 5);
    }
    lods_free(l);
    lods_free(smooth);
}

TEST(attributes_out_of_range_are_refused)
{
    lods *l = lods_flat(4);

    add_field(l, PMESH_COLOR, 3, color_at, 0.1f);
    l->options.faces = 4;
    l->attributes[0].weight[1] = -1;
    CHECK(lods_run(l) == PMESH_E_ARGUMENT);
    l->attributes[0].weight[1] = INFINITY;
    CHECK(lods_run(l) == PMESH_E_ARGUMENT);
    l->attributes[0].weight[1] = 0;
    l->attributes[0].components = 5;
    CHECK(lods_run(l) == PMESH_E_ARGUMENT);
    l->attributes[0].components = 3;
    CHECK(lods_run(l) == PMESH_OK);
    lods_free(l);
}

/* ---- other attributes, and maps ------------------------------------------ */

/* Ambient occlusion: darker in one corner. */
static void occlusion_at(const double p[3], float out[])
{
    const double x = p[0] - 6, y = p[1] - 6;

    out[0] = (float)(1 - 0.8 * exp(-(x * x + y * y) / 20));
}

/* Of two bones, the one taking over from the other halfway. */
static void bones_at(const double p[3], float out[])
{
    const double t = (p[0] - 9) / 6;

    out[0] = (float)(t < 0 ? 1 : t > 1 ? 0 : 1 - t);
    out[1] = 1 - out[0];
}

static void four_at(const double p[3], float out[])
{
    for (int i = 0; i < 4; i++)
        out[i] = (float)(100 * sin(0.1 * (i + 1) * p[i % 2]));
}

/* Of all components together. */
static double whole_error(const lods *l, size_t i, field f)
{
    double sum = 0;

    for (unsigned k = 0; k < l->attributes[i].components; k++) {
        const double error = attribute_error(l, i, k, f);
        sum += error * error;
    }
    return sqrt(sum);
}

TEST(joint_simplification_takes_channels_of_any_meaning_and_width)
{
    static const struct {
        uint8_t components;
        field f;
        float weight;
    } kinds[] = { { 1, occlusion_at, 0.1f },
                  { 2, bones_at, 0.1f },
                  { 3, color_at, 0.1f },
                  { 4, four_at, 0.001f } };

    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        double error[2];
        for (int joint = 0; joint < 2; joint++) {
            lods *l = lods_flat(SIZE);
            add_field(l, PMESH_GENERIC, kinds[k].components, kinds[k].f,
                      joint ? kinds[k].weight : 0);
            l->options.faces = 200;
            CHECK(lods_run(l) == PMESH_OK);
            error[joint] = whole_error(l, 0, kinds[k].f);
            lods_free(l);
        }
        CHECK(error[1] < 0.5 * error[0]);
    }
}

/* As many as there may be, all at once: together, by their weights, they are
 * better kept than without, and in the range of the input. */
TEST(joint_simplification_takes_eight_channels_at_once)
{
    static const struct {
        uint8_t components;
        field f;
        float weight;
    } kinds[PMESH_MAX_ATTRIBUTES] = {
        { 1, occlusion_at, 0.1f }, { 2, bones_at, 0.1f },
        { 3, color_at, 0.1f },     { 2, texture_at, 0.1f },
        { 1, occlusion_at, 0.1f }, { 2, bones_at, 0.1f },
        { 3, color_at, 0.1f },     { 4, four_at, 0.0003f }
    };
    double error[2] = { 0, 0 };

    for (int joint = 0; joint < 2; joint++) {
        lods *l = lods_flat(SIZE);
        for (size_t k = 0; k < PMESH_MAX_ATTRIBUTES; k++)
            add_field(l, PMESH_GENERIC, kinds[k].components, kinds[k].f,
                      joint ? kinds[k].weight : 0);
        l->options.faces = 300;
        CHECK(lods_run(l) == PMESH_OK);
        for (size_t k = 0; k < PMESH_MAX_ATTRIBUTES; k++)
            error[joint] +=
                pow((double)kinds[k].weight * whole_error(l, k, kinds[k].f), 2);
        for (size_t c = 0; c < 3 * l->out.face_count; c++) {
            const float *w =
                &l->out.attribute_values[1][2 * (size_t)l->out.indices[c]];
            CHECK(w[0] >= 0 && w[0] <= 1 && w[1] >= 0 && w[1] <= 1);
        }
        lods_free(l);
    }
    CHECK(error[1] < 0.5 * error[0]);
}

/* A picture looked up at the texture coordinates of a place. */
static double picture(double u, double v)
{
    return 0.5 + 0.25 * sin(40 * u) + 0.25 * cos(37 * v);
}

/* Root mean square over the faces' middles, which look their pictures up at
 * the means of their corners' coordinates. */
static double picture_error(const lods *l, const float *uv)
{
    double sum = 0, weight = 0;

    for (size_t f = 0; f < l->out.face_count; f++) {
        double at[2] = { 0, 0 }, middle[3] = { 0, 0, 0 }, n[3];
        float want[2];
        for (size_t k = 0; k < 3; k++) {
            const size_t v = l->out.indices[3 * f + k];
            for (size_t i = 0; i < 2; i++)
                at[i] += (double)uv[2 * v + i] / 3;
            for (size_t i = 0; i < 3; i++)
                middle[i] += l->out.positions[3 * v + i] / 3;
        }
        texture_at(middle, want);
        lods_normal(l, f, n);
        const double d = picture(at[0], at[1]) -
                         picture((double)want[0], (double)want[1]);
        sum += fabs(n[2]) * d * d;
        weight += fabs(n[2]);
    }
    return sqrt(sum / weight);
}

/* The two figures of the paper: the same places with coordinates that were
 * there before, and xyzst with new ones. */
TEST(new_texture_coordinates_draw_a_better_picture_than_old_ones)
{
    for (size_t faces = 400; faces >= 100; faces /= 2) {
        lods *old = lods_flat(SIZE), *joint = lods_flat(SIZE);
        add_field(joint, PMESH_TEXCOORD, 2, texture_at, 0.1f);
        add_field(old, PMESH_TEXCOORD, 2, texture_at, 0);
        old->options.faces = joint->options.faces = faces;
        CHECK(lods_run(old) == PMESH_OK && lods_run(joint) == PMESH_OK);
        const double by_joint =
            picture_error(joint, joint->out.attribute_values[0]);
        /* Interpolated, and those of the input vertex that each was. */
        CHECK(by_joint < picture_error(old, old->out.attribute_values[0]));
        CHECK(by_joint < picture_error(old, old->attributes[0].values));
        lods_free(old);
        lods_free(joint);
    }
}

static void picture_at(const double p[3], float out[])
{
    float uv[2];

    texture_at(p, uv);
    out[0] = (float)picture((double)uv[0], (double)uv[1]);
}

/* What pmesh_simplify.h advises: where a colour varies within what becomes one
 * triangle, a map keeps it and vertices cannot. */
TEST(a_map_keeps_colours_that_vertices_cannot)
{
    lods *colors = lods_flat(SIZE), *map = lods_flat(SIZE);

    add_field(colors, PMESH_GENERIC, 1, picture_at, 0.1f);
    add_field(map, PMESH_TEXCOORD, 2, texture_at, 0.1f);
    colors->options.faces = map->options.faces = 100;
    CHECK(lods_run(colors) == PMESH_OK && lods_run(map) == PMESH_OK);
    CHECK(picture_error(map, map->out.attribute_values[0]) <
          0.5 * attribute_error(colors, 0, 0, picture_at));
    lods_free(colors);
    lods_free(map);
}
