/* SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "encoder/enc_distance.h"
#include "encoder/enc_nearest.h"
#include "format/alloc.h"
#include "tests/unit/shapes.h"
#include "tests/unit/test.h"

/* Integer triangles of a view. */
typedef struct shown {
    uint32_t *corner;
    int32_t (*position)[3];
    uint32_t faces, vertices;
} shown;

static shown copy_view(const pmesh_decoder *dec)
{
    pmesh_view view;

    CHECK(pmesh_decoder_mesh(dec, &view) == PMESH_OK);
    shown s = { .faces = view.face_count, .vertices = view.mesh_vertex_count };
    s.corner = malloc(3 * s.faces * sizeof *s.corner);
    s.position = malloc(s.vertices * sizeof *s.position);
    memcpy(s.position, view.positions, s.vertices * sizeof *s.position);
    for (uint32_t c = 0; c < 3 * s.faces; c++)
        s.corner[c] = view.positions_of ? view.positions_of[view.indices[c]]
                                        : view.indices[c];
    return s;
}

static void drop(shown *s)
{
    free(s->corner);
    free(s->position);
}

static void to_doubles(const int32_t p[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = p[i];
}

/* Of all faces, one after the other. */
static double distance(const shown *s, const double x[3])
{
    double least = INFINITY, c[3][3];

    for (uint32_t f = 0; f < s->faces; f++) {
        for (int k = 0; k < 3; k++)
            to_doubles(s->position[s->corner[3 * f + (uint32_t)k]], c[k]);
        least = fmin(least, enc_distance_square(x, c[0], c[1], c[2]));
    }
    return sqrt(least);
}

static double furthest_vertex(const shown *from, const shown *to)
{
    double most = 0;

    for (uint32_t v = 0; v < from->vertices; v++) {
        double x[3];
        to_doubles(from->position[v], x);
        most = fmax(most, distance(to, x));
    }
    return most;
}

static pmesh_decoder *bake(shape_kind kind, uint32_t size,
                           const pmesh_encoder_config *config,
                           pmesh_encode_report *report)
{
    shape_mesh *s = shape_make(kind, size, 3);
    shape_bytes bytes;
    pmesh_status status;

    CHECK(shape_bake(s, config, &bytes, report) == PMESH_OK);
    pmesh_decoder *dec =
        shape_decode(bytes.data, bytes.size, bytes.size, &status);
    CHECK(dec && status == PMESH_OK);
    CHECK(pmesh_decoder_refine(dec, &(pmesh_target){ .faces = 0 }, NULL) ==
          PMESH_OK);
    free(bytes.data);
    shape_free(s);
    return dec;
}

static double noise(uint32_t *seed)
{
    return shape_random(seed, 2001) / 1000.0 - 1;
}

TEST(distance_of_a_triangle_is_that_of_its_closest_point)
{
    enum { FINE = 60 };
    uint32_t seed = 7;

    for (int round = 0; round < 200; round++) {
        double c[3][3], x[3], least = INFINITY;
        for (int i = 0; i < 3; i++) {
            for (int k = 0; k < 3; k++)
                c[k][i] = noise(&seed);
            if (round % 8 == 0) /* no area */
                c[2][i] = 2 * c[1][i] - c[0][i];
            x[i] = 2 * noise(&seed);
        }
        for (int a = 0; a <= FINE; a++)
            for (int b = 0; a + b <= FINE; b++) {
                double square = 0;
                for (int i = 0; i < 3; i++) {
                    const double p = (a * c[0][i] + b * c[1][i] +
                                      (FINE - a - b) * c[2][i]) / FINE;
                    square += (p - x[i]) * (p - x[i]);
                }
                least = fmin(least, square);
            }
        const double square = enc_distance_square(x, c[0], c[1], c[2]);
        CHECK(square <= least + 1e-12);
        CHECK(sqrt(square) >= sqrt(least) - 4.0 / FINE);
    }
}

TEST(nearest_of_a_tree_is_the_nearest_of_all)
{
    const pmesh_allocator a = pmesh_allocator_resolve((pmesh_allocator){ 0 });
    const pmesh_encoder_config config = pmesh_encoder_config_default();
    pmesh_encode_report report;
    pmesh_decoder *dec = bake(SHAPE_SOUP, 60, &config, &report);
    uint32_t seed = 5;

    shown s = copy_view(dec);
    for (uint32_t faces = 1; faces <= s.faces; faces += faces < 20 ? 1 : 23) {
        const shown part = { s.corner, s.position, faces, s.vertices };
        const enc_triangles mesh = { s.corner,
                                     (const int32_t(*)[3])s.position, faces };
        enc_nearest tree;
        CHECK(enc_nearest_create(&a, &mesh, &tree) == PMESH_OK);
        for (int i = 0; i < 30; i++) {
            double x[3];
            for (int k = 0; k < 3; k++)
                x[k] = 16384 * (0.5 + noise(&seed));
            const double all = distance(&part, x);
            CHECK(fabs(sqrt(enc_nearest_square(&tree, x)) - all) <=
                  1e-12 * all);
        }
        enc_nearest_destroy(&tree);
    }
    drop(&s);
    pmesh_decoder_destroy(dec);
}

/* And none is loose: it is reached, here or at a finer level. */
static void check_bounds(shape_kind kind, uint32_t size,
                         const pmesh_encoder_config *config)
{
    pmesh_encode_report report;
    pmesh_decoder *dec = bake(kind, size, config, &report);
    const double step = report.grid.step;
    shown full = copy_view(dec);
    double most = 0;

    for (uint32_t i = report.level_count; i-- > 0;) {
        const double error = (double)report.levels[i].error;
        CHECK(pmesh_decoder_refine(
                  dec, &(pmesh_target){ .faces = report.levels[i].faces },
                  NULL) == PMESH_OK);
        shown level = copy_view(dec);
        const double furthest = step * furthest_vertex(&full, &level);
        CHECK(furthest <= error && error >= most);
        most = fmax(most, furthest);
CHECK(error <= 1.25 * most + step);
        drop(&level);
    }
    drop(&full);
    pmesh_decoder_destroy(dec);
}

TEST(level_errors_bound_the_distance_of_all_vertices)
{
    pmesh_encoder_config config = pmesh_encoder_config_default();

    for (int moving = 0; moving < 2; moving++) {
        config.placement = moving ? PMESH_OPTIMAL : PMESH_SUBSET;
        config.profile = moving ? PMESH_QUALITY : PMESH_COMPACT;
        check_bounds(SHAPE_TORUS, 20, &config);
        check_bounds(SHAPE_TERRAIN, 20, &config);
        check_bounds(SHAPE_SPHERE, 12, &config);
        check_bounds(SHAPE_FACETS, 14, &config);
    }
    config.topology = PMESH_TOPOLOGY_KEEP;
    check_bounds(SHAPE_PIECES, 30, &config);
}

TEST(decoder_keeps_within_an_error_that_is_asked_for)
{
    const pmesh_encoder_config config = pmesh_encoder_config_default();
    pmesh_encode_report report;
    pmesh_decoder *dec = bake(SHAPE_TORUS, 24, &config, &report);
    shown full = copy_view(dec);

    for (double error = 0.5; error > 0.1; error /= 1.7) {
        CHECK(pmesh_decoder_refine(dec, &(pmesh_target){ .error = error },
                                   NULL) == PMESH_OK);
        shown level = copy_view(dec);
        CHECK(report.grid.step * furthest_vertex(&full, &level) <= error);
        CHECK(level.faces < full.faces);
        drop(&level);
    }
    drop(&full);
    pmesh_decoder_destroy(dec);
}

TEST(bake_stops_before_a_level_is_too_far)
{
    pmesh_encoder_config config = pmesh_encoder_config_default();
    pmesh_encode_report report;

    config.base_faces = 1;
    for (int moving = 0; moving < 2; moving++) {
        config.placement = moving ? PMESH_OPTIMAL : PMESH_SUBSET;
        for (config.base_error = 0.1; config.base_error > 1e-3;
             config.base_error /= 3) {
            pmesh_decoder *dec = bake(SHAPE_TERRAIN, 24, &config, &report);
            shown full = copy_view(dec);
            pmesh_decoder_refine(dec, &(pmesh_target){ .faces = 1 }, NULL);
            shown base = copy_view(dec);
            CHECK(report.end == PMESH_END_ERROR);
            CHECK((double)report.levels[0].error <= config.base_error);
            CHECK(report.grid.step * furthest_vertex(&full, &base) <=
                  config.base_error);
            drop(&full);
            drop(&base);
            pmesh_decoder_destroy(dec);
        }
    }
}

/* Both ways, at the vertices and the middles of faces. */
static double furthest_of_both(const shown *a, const shown *b)
{
    double most = fmax(furthest_vertex(a, b), furthest_vertex(b, a));

    for (int side = 0; side < 2; side++) {
        const shown *from = side ? b : a, *to = side ? a : b;
        for (uint32_t f = 0; f < from->faces; f++) {
            double x[3] = { 0, 0, 0 };
            for (uint32_t k = 0; k < 3; k++)
                for (int i = 0; i < 3; i++)
                    x[i] += from->position[from->corner[3 * f + k]][i] / 3.0;
            most = fmax(most, distance(to, x));
        }
    }
    return most;
}

TEST(bake_measures_levels_both_ways)
{
    pmesh_encoder_config config = pmesh_encoder_config_default();
    pmesh_encode_report report, plain;
    pmesh_header header;

    pmesh_decoder_destroy(bake(SHAPE_TERRAIN, 24, &config, &plain));
    CHECK(!plain.measured && plain.levels[0].furthest == 0);
    config.measure = 1;
    config.placement = PMESH_OPTIMAL;
    pmesh_decoder *dec = bake(SHAPE_TERRAIN, 24, &config, &report);
    CHECK(pmesh_decoder_header(dec, &header) == PMESH_OK);
    CHECK(header.measured && report.measured);
    shown full = copy_view(dec);
    for (uint32_t i = 0; i + 1 < header.level_count; i++) {
        const pmesh_level *l = &header.levels[i];
        CHECK(l->rms == report.levels[i].rms);
        CHECK(l->furthest == report.levels[i].furthest);
        pmesh_decoder_refine(dec, &(pmesh_target){ .faces = l->faces }, NULL);
        shown level = copy_view(dec);
        const double most =
            report.grid.step * furthest_of_both(&full, &level);
        CHECK((double)l->furthest > 0.8 * most - report.grid.step);
        CHECK((double)l->furthest < 1.6 * most + report.grid.step);
        CHECK(l->rms > 0 && l->rms < 0.7f * l->furthest);
        drop(&level);
    }
    CHECK(header.levels[header.level_count - 1].furthest == 0);
    drop(&full);
    pmesh_decoder_destroy(dec);
}
