/* SPDX-License-Identifier: MIT */
#include "tools/raster.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/unit/test.h"
#include "tools/budgets.h"
#include "tools/digits.h"
#include "tools/font.h"
#include "tools/sample.h"
#include "tools/shade.h"
#include "tools/topology.h"
#include "tools/trig.h"

#define PAPER 0xFFFFFFu

/* FNV-1a */
static uint64_t hash(uint64_t h, const void *data, size_t size)
{
    const unsigned char *p = data;
    for (size_t i = 0; i < size; i++)
        h = (h ^ p[i]) * 0x100000001b3u;
    return h;
}

#define HASH_START 0xcbf29ce484222325u

static picture paper(uint32_t width, uint32_t height)
{
    picture p;
    CHECK(picture_create(&p, width, height, PAPER));
    return p;
}

static uint32_t pixel(const picture *p, uint32_t x, uint32_t y)
{
    const uint8_t *c = p->rgb + 3 * ((size_t)y * p->width + x);
    return (uint32_t)c[0] << 16 | (uint32_t)c[1] << 8 | c[2];
}

/* A camera that looks along -z at the square -1 .. 1. */
static const raster_camera front = {
    .rows = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, .extent = 1
};
static const raster_style flat = { .flat = true };

static const double wedge_points[] = {
    -0.5, -0.5, 0,   0.5, -0.5, 0, 0.5, 0.5, 0, /* faces the viewer */
    -0.5, -0.5, 0.5, 0.5, 0.5,  0.5, 0.5, -0.5, 0.5, /* shows its back */
};

/* The faces first .. first + count - 1 of the points above. */
static picture draw_wedge(size_t first, size_t face_count)
{
    picture p = paper(32, 32);
    double positions[18];
    uint32_t indices[6];
    for (uint32_t i = 0; i < 6; i++)
        indices[i] = i;
    memcpy(positions, wedge_points, sizeof positions);
    const asset mesh = { .positions = positions, .vertex_count = 6,
                         .indices = indices + 3 * first,
                         .face_count = face_count };
    CHECK(raster_draw(&p, 0, 0, 32, &mesh, &front, &flat));
    return p;
}

TEST(raster_covers_the_face_and_nothing_else)
{
    picture p = draw_wedge(0, 1);
    CHECK(pixel(&p, 20, 20) != PAPER);  /* inside: x > -y, below the diagonal */
    CHECK(pixel(&p, 12, 12) == PAPER);  /* above it */
    CHECK(pixel(&p, 7, 24) == PAPER);   /* outside of its box */
    CHECK(pixel(&p, 8, 23) != PAPER);   /* its corner at -0.5, -0.5 */
    CHECK(pixel(&p, 24, 20) == PAPER);
    picture_free(&p);
}

TEST(raster_shows_the_nearer_face_whatever_the_order)
{
    picture far = draw_wedge(0, 1);
    picture near = draw_wedge(1, 1);
    picture both = draw_wedge(0, 2);
    CHECK(memcmp(near.rgb, both.rgb, 3 * 32 * 32) == 0);
    CHECK(memcmp(near.rgb, far.rgb, 3 * 32 * 32) != 0); /* seen from behind */
    picture_free(&far);
    picture_free(&near);
    picture_free(&both);
}

TEST(raster_survives_positions_that_are_not_numbers_or_far_away)
{
    double positions[] = { 0,   0, 0, 1e300, 0, 0,    0, 1,      0,
                           NAN, 0, 0, 0,     0, -HUGE_VAL, 1, 1e9, 5 };
    uint32_t indices[] = { 0, 1, 2, 0, 2, 3, 0, 2, 4, 0, 2, 5, 3, 4, 1 };
    const asset mesh = { .positions = positions, .vertex_count = 6,
                         .indices = indices, .face_count = 5 };
    raster_camera camera;
    picture p = paper(32, 32);
    CHECK(raster_draw(&p, 0, 0, 32, &mesh, &front, &flat));
    CHECK(raster_camera_fit(&camera, &mesh, 0.1, 0.1));
    CHECK(isfinite(camera.extent) && isfinite(camera.center[0]));
    CHECK(raster_draw(&p, 0, 0, 32, &mesh, &camera, &flat));
    picture_free(&p);

    const asset none = { .positions = positions, .vertex_count = 6,
                         .indices = indices + 3, .face_count = 1 };
    CHECK(!raster_camera_fit(&camera, &none, 0, 0));
}

TEST(raster_camera_shows_the_whole_model)
{
    asset mesh;
    raster_camera camera;
    CHECK(sample_build(SAMPLE_MIN_FACES, &mesh));
    CHECK(raster_camera_fit(&camera, &mesh, 0.3, 0.1));
    double most = 0;
    for (size_t v = 0; v < mesh.vertex_count; v++) {
        for (size_t i = 0; i < 2; i++) {
            double x = 0;
            for (size_t k = 0; k < 3; k++)
                x += camera.rows[i][k] *
                     (mesh.positions[3 * v + k] - camera.center[k]);
            most = fmax(most, fabs(x) / camera.extent);
        }
    }
    CHECK(most <= 1 && most > 0.9);
    asset_free(&mesh);
}

/* If a change of the drawing is meant, look at the pictures, then take over
 * the new number. Compilers and machines must never change it. */
TEST(raster_draws_the_same_pixels_everywhere)
{
    static const raster_style styles[] = {
        { .flat = true }, { .flat = true, .wire = true }, { .flat = false }
    };
    asset mesh;
    raster_camera camera;
    picture p = paper(3 * 96, 96);
    const font_style style = { 9, 1.3, 0x202020 };

    CHECK(sample_build(SAMPLE_MIN_FACES, &mesh));
    CHECK(raster_camera_fit(&camera, &mesh, -0.08, 0.05));
    for (uint32_t i = 0; i < 3; i++)
        CHECK(raster_draw(&p, 96 * i, 0, 96, &mesh, &camera, &styles[i]));
    font_draw(&p, 4, 12, "4,012 faces", &style);
    CHECK(hash(HASH_START, p.rgb, 3 * 3 * 96 * 96) == 0x1da3eeb5653ea638u);
    picture_free(&p);
    asset_free(&mesh);
}

TEST(picture_becomes_a_png)
{
    picture p = paper(3, 2);
    asset_bytes png = { 0 };
    CHECK(picture_to_png(&p, &png));
    CHECK(png.size > 40 && memcmp(png.data, "\x89PNG\r\n\x1A\n", 8) == 0);
    CHECK(png.data[19] == 3 && png.data[23] == 2);
    asset_bytes_free(&png);
    picture_free(&p);
}

TEST(picture_ignores_what_lies_outside)
{
    picture p = paper(8, 8);
    picture_blend(&p, -1, 0, 0, 255);
    picture_blend(&p, 0, 8, 0, 255);
    for (uint32_t i = 0; i < 64; i++)
        CHECK(pixel(&p, i % 8, i / 8) == PAPER);
    picture_blend(&p, 7, 7, 0x102030, 255);
    CHECK(pixel(&p, 7, 7) == 0x102030);
    picture_free(&p);
}

TEST(font_shortens_text_that_does_not_fit)
{
    const font_style style = { 9, 1.3, 0 };
    char text[600];
    picture p = paper(200, 20);
    memset(text, 'x', sizeof text);
    text[sizeof text - 1] = '\0';
    CHECK(font_draw_fitted(&p, 0, 15, 150, text, &style) <= 150);
    CHECK(font_draw_fitted(&p, 0, 15, 150, "short", &style) ==
          font_width("short", &style));
    /* Bytes that are no text, and nothing at all. */
    CHECK(font_draw(&p, 0, 15, "\xFF\x80\xC3", &style) > 0);
    CHECK(font_draw(&p, 0, 15, "", &style) == 0);
    CHECK(font_width("1,111", &style) == font_width("8,888", &style));
    picture_free(&p);
}

/* ---- numbers ------------------------------------------------------------ */

TEST(budgets_are_read_with_suffixes)
{
    budgets b;
    CHECK(budgets_parse("200,2k,1.5M", &b) && b.count == 3);
    CHECK(b.faces[0] == 200 && b.faces[1] == 2000 && b.faces[2] == 1500000);
    CHECK(!budgets_parse("", &b) && !budgets_parse("1,", &b));
    CHECK(!budgets_parse("0", &b) && !budgets_parse("-5", &b));
    CHECK(!budgets_parse("1e99", &b) && !budgets_parse("nan", &b));
    CHECK(!budgets_parse("5x", &b));
}

TEST(budgets_spread_in_equal_ratios)
{
    budgets b;
    budgets_spread(100, 3200, 6, &b);
    CHECK(b.count == 6 && b.faces[0] == 100 && b.faces[5] == 3200);
    for (uint32_t i = 1; i < 6; i++)
        CHECK(b.faces[i] == 2 * b.faces[i - 1]);
    budgets_spread(12, 12, 6, &b);
    CHECK(b.count == 1 && b.faces[0] == 12);
    budgets_spread(3, 5, 6, &b);
    CHECK(b.count == 3 && b.faces[2] == 5);
}

TEST(digits_are_grouped_and_bytes_get_units)
{
    char text[32];
    digits_grouped(text, 0);
    CHECK(strcmp(text, "0") == 0);
    digits_grouped(text, UINT64_MAX);
    CHECK(strcmp(text, "18,446,744,073,709,551,615") == 0);
    digits_grouped(text, 69451);
    CHECK(strcmp(text, "69,451") == 0);
    static const struct {
        uint64_t bytes;
        const char *text;
    } cases[] = { { 0, "0 B" },           { 999, "999 B" },
                  { 1000, "1.00 kB" },    { 99940, "99.9 kB" },
                  { 105231, "105 kB" },   { 999499, "999 kB" },
                  { 999500, "1.00 MB" },  { UINT64_MAX, "18.4 EB" } };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        digits_bytes(text, cases[i].bytes);
        CHECK(strcmp(text, cases[i].text) == 0);
    }
}

TEST(trig_is_accurate)
{
    const double pi = acos(-1);
    for (int i = -500; i <= 500; i++) {
        const double turns = i / 123.0;
        CHECK(fabs(trig_sin(turns) - sin(2 * pi * turns)) < 1e-12);
        CHECK(fabs(trig_cos(turns) - cos(2 * pi * turns)) < 1e-12);
    }
    CHECK(trig_sin(0) == 0 && trig_cos(0) == 1);
}

/* ---- sample ------------------------------------------------------------- */

static uint64_t hash_mesh(const asset *m)
{
    uint64_t h = HASH_START;
    /* Multiples of 1e-6, compared as such: free of byte order. */
    for (size_t i = 0; i < 3 * m->vertex_count; i++) {
        const int64_t q = llround(m->positions[i] * 1e6);
        CHECK((double)q / 1e6 == m->positions[i]);
        h = (h ^ (uint64_t)q) * 0x100000001b3u;
    }
    for (size_t i = 0; i < 3 * m->face_count; i++)
        h = (h ^ m->indices[i]) * 0x100000001b3u;
    for (size_t a = 0; a < 2; a++) {
        const asset_attribute *at = &m->attributes[a];
        for (size_t i = 0; i < at->count * at->components; i++)
            h = (h ^ (uint64_t)llround((double)at->values[i] * 1e5)) *
                0x100000001b3u;
    }
    return h;
}

TEST(sample_is_the_same_everywhere)
{
    asset mesh;
    CHECK(sample_build(20000, &mesh));
    CHECK(hash_mesh(&mesh) == 0xf336b4c44a6db775u);
    asset_free(&mesh);
}

/* Six times the volume, and the least height of a face by its longest side
 * (roughly: the side is measured along the axes). */
static void weigh(const asset *m, double *volume, double *lowest)
{
    *volume = 0;
    *lowest = HUGE_VAL;
    for (size_t f = 0; f < m->face_count; f++) {
        const double *p[3];
        double u[3], v[3], longest = 0;
        for (size_t k = 0; k < 3; k++)
            p[k] = m->positions + 3 * (size_t)m->indices[3 * f + k];
        for (size_t k = 0; k < 3; k++) {
            u[k] = p[1][k] - p[0][k];
            v[k] = p[2][k] - p[0][k];
            longest = fmax(longest, fmax(fabs(u[k]), fabs(v[k])));
        }
        const double n[3] = { u[1] * v[2] - u[2] * v[1],
                              u[2] * v[0] - u[0] * v[2],
                              u[0] * v[1] - u[1] * v[0] };
        const double area2 = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        *volume += n[0] * p[0][0] + n[1] * p[0][1] + n[2] * p[0][2];
        *lowest = fmin(*lowest, area2 / (longest * longest));
    }
}

TEST(sample_is_closed_outward_and_has_no_sliver)
{
    static const uint32_t sizes[] = { SAMPLE_MIN_FACES, 10000, 100000 };
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        asset mesh;
        topology_report t;
        double volume, lowest;
        CHECK(sample_build(sizes[i], &mesh));
        CHECK(topology_measure(&mesh, &t));
        CHECK(fabs((double)mesh.face_count / sizes[i] - 1) < 0.02);
        CHECK(t.vertices == mesh.vertex_count && t.degenerate_faces == 0);
        CHECK(t.boundary_edges == 0 && t.nonmanifold_edges == 0);
        CHECK(t.misoriented_edges == 0 && t.components == 1 && t.euler == 2);
        weigh(&mesh, &volume, &lowest);
        CHECK(volume > 0 && lowest > 0.05);
        asset_free(&mesh);
    }
}

TEST(sample_has_normals_and_a_texture_seam)
{
    asset mesh;
    CHECK(sample_build(10000, &mesh));
    CHECK(mesh.attribute_count == 2);
    const asset_attribute *normals = &mesh.attributes[0];
    const asset_attribute *texture = &mesh.attributes[1];
    CHECK(normals->kind == PMESH_NORMAL && !normals->indices);
    CHECK(normals->count == mesh.vertex_count);
    for (size_t i = 0; i < normals->count; i++) {
        const float *n = normals->values + 3 * i;
        CHECK(fabsf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-3f);
    }
    CHECK(texture->kind == PMESH_TEXCOORD && texture->indices);
    CHECK(texture->count > mesh.vertex_count);
    for (size_t i = 0; i < 3 * mesh.face_count; i++) {
        CHECK(texture->indices[i] < texture->count);
        CHECK(mesh.indices[i] < mesh.vertex_count);
    }
    for (size_t i = 0; i < 2 * texture->count; i++)
        CHECK(texture->values[i] >= 0 && texture->values[i] <= 1);
    asset_free(&mesh);
}

/* Half of the wedge's face is hot, and only its first face has heat. */
TEST(raster_mixes_heat_over_a_face)
{
    double positions[18];
    uint32_t indices[6];
    const float values[6] = { 0, 1, 1, 1, 1, 1 };
    for (uint32_t i = 0; i < 6; i++)
        indices[i] = i;
    memcpy(positions, wedge_points, sizeof positions);
    const asset mesh = { .positions = positions, .vertex_count = 6,
                         .indices = indices, .face_count = 1 };
    raster_style style = { .flat = true, .heat = values };
    picture p = paper(64, 64);
    CHECK(raster_draw(&p, 0, 0, 64, &mesh, &front, &style));
    const uint32_t cold = pixel(&p, 18, 46), hot = pixel(&p, 46, 30);
    CHECK((cold & 0xFF) > (cold >> 16)); /* blue */
    CHECK((hot >> 16) > (hot & 0xFF));   /* red */
    picture_free(&p);

    const asset both = { .positions = positions, .vertex_count = 6,
                         .indices = indices, .face_count = 2 };
    picture plain = paper(64, 64), half = paper(64, 64);
    const raster_style none = { .flat = true };
    style.plain = 1; /* the second face, in front, has none */
    CHECK(raster_draw(&plain, 0, 0, 64, &both, &front, &none));
    CHECK(raster_draw(&half, 0, 0, 64, &both, &front, &style));
    CHECK(pixel(&plain, 30, 33) == pixel(&half, 30, 33));
    picture_free(&plain);
    picture_free(&half);
}

TEST(shade_heat_runs_from_blue_to_red)
{
    CHECK(shade_heat(0) == 0x2C3E96u && shade_heat(-1) == shade_heat(0));
    CHECK(shade_heat(1) == 0xCE3028u && shade_heat(2) == shade_heat(1));
    CHECK(shade_heat(0.5) == 0x5CB65Cu);
}
