/* SPDX-License-Identifier: MIT */
#include "tools/distance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/unit/test.h"
#include "tools/surface.h"
#include "tools/topology.h"

#define SAMPLES 20000

static bool near(double value, double expected, double tolerance)
{
    return fabs(value - expected) <= tolerance * fmax(fabs(expected), 1e-30);
}

static asset make_mesh(const double *positions, size_t vertex_count,
                       const uint32_t *indices, size_t face_count)
{
    asset mesh = { .vertex_count = vertex_count, .face_count = face_count };
    mesh.positions = malloc(3 * vertex_count * sizeof *mesh.positions);
    mesh.indices = malloc(3 * face_count * sizeof *mesh.indices);
    CHECK(mesh.positions && mesh.indices);
    memcpy(mesh.positions, positions,
           3 * vertex_count * sizeof *mesh.positions);
    memcpy(mesh.indices, indices, 3 * face_count * sizeof *mesh.indices);
    return mesh;
}

static const uint32_t square_faces[] = { 0, 1, 2, 0, 2, 3 };

/* A rectangle from the origin, its far side lifted to `rise`. */
static asset rectangle(double width, double depth, double z, double rise)
{
    const double corners[] = { 0,     0,     z,        width, 0,     z,
                               width, depth, z + rise, 0,     depth, z + rise };
    return make_mesh(corners, 4, square_faces, 2);
}

/* n x 2n quads, poles of many vertices at one position. */
static asset sphere(double radius, uint32_t n)
{
    asset mesh = { .vertex_count = (n + 1) * (2 * n + 1),
                   .face_count = 4 * n * n };
    mesh.positions = malloc(3 * mesh.vertex_count * sizeof *mesh.positions);
    mesh.indices = malloc(3 * mesh.face_count * sizeof *mesh.indices);
    CHECK(mesh.positions && mesh.indices);
    const double pi = acos(-1);
    double *p = mesh.positions;
    for (uint32_t i = 0; i <= n; i++) {
        for (uint32_t j = 0; j <= 2 * n; j++) {
            const double r = i % n ? radius * sin(pi * i / n) : 0;
            *p++ = r * cos(pi * (j % (2 * n)) / n);
            *p++ = r * sin(pi * (j % (2 * n)) / n);
            *p++ = -radius * cos(pi * i / n);
        }
    }
    uint32_t *f = mesh.indices;
    for (uint32_t i = 0; i < n; i++) {
        for (uint32_t j = 0; j < 2 * n; j++) {
            const uint32_t a = i * (2 * n + 1) + j;
            const uint32_t b = a + 2 * n + 1;
            const uint32_t quad[] = { a, a + 1, b + 1, a, b + 1, b };
            memcpy(f, quad, sizeof quad);
            f += 6;
        }
    }
    return mesh;
}

/* Frees both meshes. */
static distance_report measure(asset a, asset b)
{
    distance_report report;
    CHECK(distance_measure(&a, &b, SAMPLES, &report));
    asset_free(&a);
    asset_free(&b);
    return report;
}

static void move(asset *mesh, double scale, double shift)
{
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
        mesh->positions[i] = mesh->positions[i] * scale + shift;
}

TEST(distance_of_a_mesh_from_itself_is_zero)
{
    const distance_report r = measure(sphere(3, 12), sphere(3, 12));
    CHECK(r.both.rms == 0 && r.both.mean == 0 && r.both.max == 0);
    CHECK(r.both.normal_deg == 0);
}

TEST(distance_of_shifted_squares_is_the_shift)
{
    const distance_report r =
        measure(rectangle(1, 1, 0, 0), rectangle(1, 1, 0.25, 0));
    CHECK(near(r.diagonal, sqrt(2), 1e-12));
    CHECK(near(r.a_to_b.rms, 0.25, 1e-12) && near(r.b_to_a.rms, 0.25, 1e-12));
    CHECK(near(r.both.mean, 0.25, 1e-12) && near(r.both.max, 0.25, 1e-12));
    CHECK(r.both.normal_deg == 0);
}

TEST(distance_is_measured_in_both_directions)
{
    /* Half of the larger one lies over the smaller one, which it contains. */
    const distance_report r =
        measure(rectangle(1, 1, 0, 0), rectangle(2, 1, 0, 0));
    CHECK(r.a_to_b.max == 0);
    CHECK(near(r.b_to_a.max, 1, 1e-12));
    CHECK(near(r.b_to_a.mean, 0.25, 0.01));
    CHECK(near(r.b_to_a.rms, sqrt(1.0 / 6), 0.01));
    CHECK(near(r.both.rms, sqrt(1.0 / 12), 0.01));
    CHECK(near(r.both.mean, 0.125, 0.01));
    CHECK(r.both.max == r.b_to_a.max);
}

TEST(distance_maximum_is_found_inside_of_faces)
{
    /* Strips along two sides of a square; the middle is farthest from both. */
    const double p[] = { 0,   0, 0, 0.1, 0, 0, 0.1, 1, 0, 0,   1, 0,
                         0.9, 0, 0, 1,   0, 0, 1,   1, 0, 0.9, 1, 0 };
    const uint32_t f[] = { 0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7 };
    asset square = rectangle(1, 1, 0, 0);
    asset strips = make_mesh(p, 8, f, 4);
    distance_report r;
    CHECK(distance_measure(&square, &strips, 10000, &r));
    CHECK(r.a_to_b.max <= 0.4 && r.a_to_b.max > 0.4 / 1.005);
    CHECK(r.b_to_a.max == 0);
    asset_free(&square);
    asset_free(&strips);
}

TEST(distance_of_concentric_spheres_is_the_difference_of_radii)
{
    const distance_report r = measure(sphere(1, 60), sphere(1.1, 60));
    CHECK(near(r.both.mean, 0.1, 0.02) && near(r.both.rms, 0.1, 0.02));
    CHECK(near(r.both.max, 0.1, 0.02));
    CHECK(r.both.normal_deg < 2);
}

TEST(distance_reports_the_angle_between_normals)
{
    /* Rising 1 over a depth of 1: 45 degrees. */
    const distance_report tilted =
        measure(rectangle(1, 1, 0, 0), rectangle(1, 1, 0, 1));
    CHECK(near(tilted.both.normal_deg, 45, 1e-6));

    asset flipped = rectangle(1, 1, 0, 0);
    for (size_t i = 0; i < 6; i += 3) {
        const uint32_t t = flipped.indices[i];
        flipped.indices[i] = flipped.indices[i + 1];
        flipped.indices[i + 1] = t;
    }
    const distance_report r = measure(rectangle(1, 1, 0, 0), flipped);
    CHECK(r.both.max == 0 && near(r.both.normal_deg, 180, 1e-6));
}

TEST(distance_scales_with_the_model)
{
    /* Powers of two, so that the points taken are the same. */
    static const double scales[] = { 0x1p-1000, 0x1p-60, 0x1p60, 0x1p1000 };
    for (size_t i = 0; i < sizeof scales / sizeof *scales; i++) {
        asset a = sphere(1, 6);
        asset b = sphere(1.25, 6);
        const distance_report plain = measure(sphere(1, 6), sphere(1.25, 6));
        move(&a, scales[i], 0);
        move(&b, scales[i], 0);
        const distance_report r = measure(a, b);
        CHECK(near(r.both.rms / scales[i], plain.both.rms, 1e-9));
        CHECK(near(r.both.max / scales[i], plain.both.max, 1e-9));
        CHECK(near(r.both.rms / r.diagonal, plain.both.rms / plain.diagonal,
                   1e-9));
    }
}

TEST(distance_survives_models_far_from_the_origin)
{
    asset a = rectangle(1, 1, 0, 0);
    asset b = rectangle(1, 1, 0.25, 0);
    move(&a, 1, 1048576);
    move(&b, 1, 1048576);
    CHECK(near(measure(a, b).both.rms, 0.25, 1e-9));
}

TEST(distance_leaves_out_faces_that_are_not_finite)
{
    const double bad[] = { 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, NAN };
    const uint32_t faces[] = { 0, 1, 2, 0, 2, 3, 1, 2, 4 };
    asset a = make_mesh(bad, 5, faces, 3);
    CHECK(distance_has_faces(&a));
    CHECK(near(measure(a, rectangle(1, 1, 1, 0)).both.rms, 1, 1e-12));

    asset none = make_mesh(bad, 5, faces + 6, 1);
    CHECK(!distance_has_faces(&none));
    asset_free(&none);
}

TEST(distance_of_faces_without_area_counts_their_vertices)
{
    const double line[] = { 0, 0, 0, 1, 0, 0, 2, 0, 0 };
    const uint32_t face[] = { 0, 1, 2 };
    const distance_report r =
        measure(make_mesh(line, 3, face, 1), rectangle(2, 1, 0.5, 0));
    CHECK(near(r.a_to_b.max, 0.5, 1e-12));
    CHECK(near(r.b_to_a.max, sqrt(1.25), 1e-12));
}

/* ---- search ------------------------------------------------------------- */

static double next_number(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    return (double)(*state >> 8) / 0x1p23 - 1;
}

TEST(surface_search_finds_what_trying_every_face_finds)
{
    enum { FACES = 97, POINTS = 200 };
    static double positions[9 * FACES];
    static uint32_t indices[3 * FACES];
    static surface single[FACES];
    uint32_t state = 7;

    for (size_t f = 0; f < FACES; f++) {
        for (size_t c = 0; c < 9; c++) {
            /* Small faces among large ones, some of them slivers. */
            const double size = f % 3 ? 0.1 : 1;
            positions[9 * f + c] = c < 3 ? next_number(&state)
                                         : positions[9 * f + c % 3] +
                                               size * next_number(&state);
            if (f % 7 == 0 && c >= 6)
                positions[9 * f + c] = positions[9 * f + c - 3] + 1e-9;
        }
        for (uint32_t k = 0; k < 3; k++)
            indices[3 * f + k] = (uint32_t)(3 * f + k);
    }
    asset mesh = make_mesh(positions, 3 * FACES, indices, FACES);
    const asset *const list[] = { &mesh };
    surface_frame frame;
    surface all;
    CHECK(surface_frame_of(list, 1, &frame));
    CHECK(surface_build(&all, &mesh, &frame));
    CHECK(all.depth > 3);
    for (size_t f = 0; f < FACES; f++) {
        asset one = mesh;
        one.indices = mesh.indices + 3 * f;
        one.face_count = 1;
        CHECK(surface_build(&single[f], &one, &frame));
    }
    for (size_t i = 0; i < POINTS; i++) {
        const double p[3] = { 2 * next_number(&state), next_number(&state),
                              next_number(&state) };
        uint32_t hint = (uint32_t)(i % FACES);
        double least = HUGE_VAL;
        for (size_t f = 0; f < FACES; f++) {
            uint32_t zero = 0;
            least = fmin(least, surface_closest(&single[f], p, &zero));
        }
        CHECK(surface_closest(&all, p, &hint) == least);
        CHECK(hint < FACES);
    }
    for (size_t f = 0; f < FACES; f++)
        surface_free(&single[f]);
    surface_free(&all);
    asset_free(&mesh);
}

/* ---- topology ----------------------------------------------------------- */

static topology_report count(asset mesh)
{
    topology_report report;
    CHECK(topology_measure(&mesh, &report));
    asset_free(&mesh);
    return report;
}

TEST(topology_joins_vertices_of_equal_position)
{
    const topology_report r = count(sphere(1, 10));
    CHECK(r.faces == 400 && r.degenerate_faces == 40);
    CHECK(r.vertices == 9 * 20 + 2 && r.euler == 2 && r.components == 1);
    CHECK(r.boundary_edges == 0 && r.nonmanifold_edges == 0);
    CHECK(r.misoriented_edges == 0);
}

TEST(topology_counts_folds)
{
    /* Flaps on one side of the edge 0 1 and the other: up to 29 and 31 degrees
     * short of lying on the first face. */
    const double p[] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0.66, 0, 1, 0.5 };
    const uint32_t open[] = { 0, 1, 2, 1, 0, 3 };
    const uint32_t folded[] = { 0, 1, 2, 1, 0, 4 };
    const uint32_t turned[] = { 0, 1, 2, 0, 1, 4 }; /* runs the wrong way */

    CHECK(count(make_mesh(p, 5, open, 2)).folds == 0);
    CHECK(count(make_mesh(p, 5, folded, 2)).folds == 1);
    CHECK(count(make_mesh(p, 5, turned, 2)).folds == 0);
}

TEST(topology_counts_boundaries_fins_and_pieces)
{
    const double p[] = { 0, 0, 0,  1, 0, 0, 0, 1, 0, 0,  0,
                         1, 0, -1, 0, 5, 5, 5, 6, 5, 5,  5,
                         6, 5, 9,  9, 9, NAN, 0, 0, -0.0, 0, 0 };
    /* Three faces at the edge 0 1, one face apart; vertex 10 is vertex 0. */
    const uint32_t f[] = { 0, 1, 2, 1, 10, 3, 0, 1, 4, 5, 6, 7 };
    const topology_report r = count(make_mesh(p, 11, f, 4));
    CHECK(r.vertices == 8 && r.components == 2);
    CHECK(r.nonmanifold_edges == 1 && r.boundary_edges == 9);
    CHECK(r.misoriented_edges == 0);

    const uint32_t same_way[] = { 0, 1, 2, 0, 1, 4 };
    CHECK(count(make_mesh(p, 11, same_way, 2)).misoriented_edges == 1);
}
