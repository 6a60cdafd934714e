/* SPDX-License-Identifier: MIT */
#include "encoder/pmesh_simplify.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "tests/unit/lods.h"
#include "tests/unit/shapes.h"
#include "tests/unit/test.h"

TEST(simplify_reaches_the_faces_that_are_asked)
{
    lods *l = lods_sphere(12);
    const size_t all = l->in.face_count;

    for (size_t faces = all; faces >= 4; faces = faces * 3 / 4) {
        l->options.faces = faces;
        CHECK(lods_run(l) == PMESH_OK);
        CHECK(l->out.face_count <= faces && l->out.face_count + 1 >= faces);
        CHECK(l->out.end == PMESH_END_FACES);
        CHECK(lods_is_closed(l));
    }
    lods_free(l);
}

TEST(simplify_names_vertices_of_the_input_in_the_small_form)
{
    lods *l = lods_sphere(16);
    const size_t n = l->in.vertex_count, all = l->in.face_count;
    float *xyz = malloc(n * 4 * sizeof *xyz); /* a stride of four floats */
    uint32_t *out = malloc(all * 3 * sizeof *out);
    size_t count;
    double error = -1;

    for (size_t v = 0; v < n; v++)
        for (size_t i = 0; i < 3; i++)
            xyz[4 * v + i] = (float)l->xyz[3 * v + i];
    CHECK(pmesh_simplify(l->tri, all, xyz, n, 4 * sizeof *xyz, all / 4, 0, out,
                         &count, &error) == PMESH_OK);
    CHECK(count <= all / 4 && count + 1 >= all / 4 && error > 0);
    for (size_t i = 0; i < 3 * count; i++)
        CHECK(out[i] < n);
    /* In place, and by error alone. */
    memcpy(out, l->tri, all * 3 * sizeof *out);
    CHECK(pmesh_simplify(out, all, xyz, n, 4 * sizeof *xyz, 0, 0.01, out,
                         &count, &error) == PMESH_OK);
    CHECK(count < all && error <= 0.01);
    free(xyz);
    free(out);
    lods_free(l);
}

TEST(simplify_gives_the_same_twice_and_whatever_the_unit_and_place)
{
    static const double scales[] = { 1, 1, 1e-6, 1e6, 1000, 3e-9 };
    lods *l = lods_terrain(20);
    lods *first = lods_terrain(20);

    l->options.faces = first->options.faces = 60;
    CHECK(lods_run(first) == PMESH_OK);
    for (size_t i = 0; i < sizeof scales / sizeof *scales; i++) {
        for (size_t k = 0; k < 3 * l->in.vertex_count; k++)
            l->xyz[k] = first->xyz[k] * scales[i];
        CHECK(lods_run(l) == PMESH_OK);
        CHECK(lods_same_faces(l, first));
        CHECK(fabs(l->out.error / (first->out.error * scales[i]) - 1) < 1e-6);
    }
    /* Exact far from the origin: all coordinates are multiples of 2^-20. */
    for (size_t k = 0; k < 3 * l->in.vertex_count; k++)
        l->xyz[k] = first->xyz[k] + 1048576;
    CHECK(lods_run(l) == PMESH_OK);
    CHECK(lods_same_faces(l, first));
    lods_free(l);
    lods_free(first);
}

/* Triangles 2^squeeze times as long as they are wide, but exact numbers. */
static lods *needles(int squeeze)
{
    lods *l = lods_terrain(20);

    for (size_t v = 0; v < l->in.vertex_count; v++)
        l->xyz[3 * v] *= ldexp(1, -squeeze);
    return l;
}

TEST(simplify_takes_needles_of_any_size_anywhere_in_the_same_order)
{
    static const double scales[] = { 1e-6, 1e6, 1000, 3e-9 };

    for (int squeeze = 4; squeeze <= 16; squeeze += 6) {
        lods *first = needles(squeeze), *l = needles(squeeze);
        for (size_t faces = 400; faces >= 25; faces /= 2) {
            l->options.faces = first->options.faces = faces;
            CHECK(lods_run(first) == PMESH_OK);
            CHECK(first->out.face_count <= faces);
            for (size_t c = 0; c < 3 * first->out.face_count; c++)
                for (size_t i = 0; i < 3; i++)
                    CHECK(isfinite(
                        first->out
                            .positions[3 * first->out.indices[c] + i]));
            for (size_t i = 0; i < sizeof scales / sizeof *scales; i++) {
                for (size_t k = 0; k < 3 * l->in.vertex_count; k++)
                    l->xyz[k] = first->xyz[k] * scales[i];
                CHECK(lods_run(l) == PMESH_OK);
                CHECK(lods_same_faces(l, first));
            }
            for (size_t k = 0; k < 3 * l->in.vertex_count; k++)
                l->xyz[k] = first->xyz[k] + 1048576;
            CHECK(lods_run(l) == PMESH_OK);
            CHECK(lods_same_faces(l, first));
        }
        lods_free(first);
        lods_free(l);
    }
}

TEST(simplify_keeps_flat_parts_flat_and_their_outline)
{
    lods *l = lods_flat(20);

    l->options.faces = 8;
    CHECK(lods_run(l) == PMESH_OK);
    CHECK(l->out.face_count <= 8 && l->out.error < 1e-9);
    double area = 0;
    for (size_t f = 0; f < l->out.face_count; f++) {
        double n[3];
        lods_normal(l, f, n);
        CHECK(fabs(n[0]) < 1e-9 && fabs(n[1]) < 1e-9 && n[2] > 0);
        area += n[2] / 2;
    }
    CHECK(fabs(area - 20 * 20) < 1e-6);
    /* Without the planes that hold it, the outline goes. */
    l->options.boundary = 0;
    CHECK(lods_run(l) == PMESH_OK);
    double loose = 0;
    for (size_t f = 0; f < l->out.face_count; f++) {
        double n[3];
        lods_normal(l, f, n);
        loose += n[2] / 2;
    }
    CHECK(loose < area - 1);
    lods_free(l);
}

TEST(simplify_stops_at_vertices_ratio_and_error_whichever_comes_first)
{
    lods *l = lods_terrain(20);
    const size_t all = l->in.face_count;

    l->options.vertices = 50;
    CHECK(lods_run(l) == PMESH_OK);
    CHECK(l->out.end == PMESH_END_VERTICES && l->out.vertex_count == 50);
    l->options.faces = all / 2;
    CHECK(lods_run(l) == PMESH_OK);
    CHECK(l->out.end == PMESH_END_FACES && l->out.vertex_count > 50);
    l->options.ratio = 0.75;
    CHECK(lods_run(l) == PMESH_OK);
    CHECK(l->out.face_count + 1 >= all * 3 / 4);
    CHECK(l->out.face_count <= all * 3 / 4);
    l->options = pmesh_simplify_options_default();
    double last = 0;
    size_t faces = all;
    for (double limit = 0.01; limit < 1; limit *= 2) {
        l->options.error = limit;
        CHECK(lods_run(l) == PMESH_OK);
        CHECK(l->out.end == PMESH_END_ERROR);
        CHECK(l->out.error <= limit && l->out.error >= last);
        CHECK(l->out.face_count <= faces);
        last = l->out.error;
        faces = l->out.face_count;
    }
    CHECK(faces < all / 4 && last > 0);
    lods_free(l);
}

TEST(simplify_error_never_falls_while_faces_do)
{
    lods *l = lods_terrain(16);
    double last = 0;

    for (size_t faces = l->in.face_count; faces > 10; faces -= faces / 5) {
        l->options.faces = faces;
        CHECK(lods_run(l) == PMESH_OK);
        CHECK(l->out.error >= last);
        last = l->out.error;
    }
    lods_free(l);
}

TEST(simplify_says_when_it_is_exhausted)
{
    lods *l = lods_tetrahedra(2);

    l->options.faces = 1;
    CHECK(lods_run(l) == PMESH_OK);
    CHECK(l->out.end == PMESH_END_EXHAUSTED && l->out.face_count == 8);
    CHECK(l->out.cost_least == 0 && l->out.cost_most == 0);
    l->options.loose = 1;
    l->options.faces = 4;
    CHECK(lods_run(l) == PMESH_OK);
    CHECK(l->out.end == PMESH_END_FACES && l->out.face_count == 4);
    CHECK(lods_is_closed(l));
    l->options.faces = 1; /* the last piece stays */
    CHECK(lods_run(l) == PMESH_OK);
    CHECK(l->out.end == PMESH_END_EXHAUSTED && l->out.face_count == 4);
    lods_free(l);
}

TEST(simplify_placements_are_what_they_say)
{
    lods *l = lods_terrain(16);

    l->options.faces = l->in.face_count / 3;
    for (int place = 0; place <= PMESH_PLACE_ENDPOINT; place++) {
        l->options.placement = (pmesh_place)place;
        CHECK(lods_run(l) == PMESH_OK);
        size_t moved = 0;
        for (size_t c = 0; c < 3 * l->out.face_count; c++) {
            const size_t v = l->out.indices[c];
            for (size_t i = 0; i < 3; i++)
                CHECK(isfinite(l->out.positions[3 * v + i]));
            moved += memcmp(&l->out.positions[3 * v], &l->xyz[3 * v],
                            3 * sizeof *l->xyz) != 0;
        }
        CHECK((moved == 0) == (place == PMESH_PLACE_ENDPOINT));
    }
    lods_free(l);
}

TEST(simplify_midpoint_is_the_midpoint)
{
    lods *l = lods_sphere(8);
    size_t moved = 0;

    l->options.placement = PMESH_PLACE_MIDPOINT;
    l->options.cost = PMESH_COST_LENGTH;
    l->options.faces = l->in.face_count - 2; /* one contraction */
    CHECK(lods_run(l) == PMESH_OK);
    for (size_t c = 0; c < 3 * l->out.face_count; c++) {
        const double *p = &l->out.positions[3 * (size_t)l->out.indices[c]];
        const double *q = &l->xyz[3 * (size_t)l->out.indices[c]];
        if (memcmp(p, q, 3 * sizeof *p) == 0)
            continue;
        moved++;
        bool found = false;
        for (size_t v = 0; v < l->in.vertex_count; v++) {
            double off = 0;
            for (size_t i = 0; i < 3; i++)
                off = fmax(off, fabs(0.5 * (q[i] + l->xyz[3 * v + i]) - p[i]));
            found = found || off < 1e-9;
        }
        CHECK(found);
    }
    CHECK(moved > 0);
    lods_free(l);
}

TEST(simplify_optimal_places_are_better_than_ends)
{
    lods *l = lods_sphere(32);
    double worst[2];

    l->options.faces = 200;
    for (int end = 0; end < 2; end++) {
        l->options.placement = end ? PMESH_PLACE_ENDPOINT : PMESH_PLACE_OPTIMAL;
        CHECK(lods_run(l) == PMESH_OK);
        worst[end] = lods_sphere_rms(l);
    }
    CHECK(worst[0] < 0.7 * worst[1]);
    lods_free(l);
}

TEST(simplify_keeps_the_volume_of_a_sphere)
{
    lods *l = lods_sphere(32);
    const double before = lods_volume(l->xyz, l->tri, l->in.face_count);

    l->options.faces = 200;
    CHECK(lods_run(l) == PMESH_OK);
    const double after =
        lods_volume(l->out.positions, l->out.indices, l->out.face_count);
    CHECK(fabs(after / before - 1) < 0.002);
    lods_free(l);
}

TEST(simplify_takes_any_soup)
{
    for (uint32_t seed = 1; seed < 16; seed++) {
        lods *l = lods_soup(40 + 10 * seed, 12 + seed, seed);
        for (int loose = 0; loose < 2; loose++) {
            for (int place = 0; place <= PMESH_PLACE_ENDPOINT; place++) {
                l->options.placement = (pmesh_place)place;
                l->options.loose = loose;
                l->options.faces = 1;
                CHECK(lods_run(l) == PMESH_OK);
                CHECK(l->out.face_count >= 1);
                CHECK(lods_is_sound(l));
            }
        }
        lods_free(l);
    }
}

TEST(simplify_drops_bad_faces_and_counts_them)
{
    lods *l = lods_sphere(8);
    const size_t all = l->in.face_count;

    l->xyz[3 * (size_t)l->tri[0]] = NAN;
    CHECK(lods_run(l) == PMESH_OK);
    CHECK(l->out.dropped_faces > 0);
    l->options.faces = all;
    CHECK(lods_run(l) == PMESH_OK);
    CHECK(l->out.face_count + l->out.dropped_faces == all);
    for (size_t v = 0; v < l->in.vertex_count; v++)
        l->xyz[3 * v] = INFINITY;
    CHECK(lods_run(l) == PMESH_E_NOT_FINITE);
    for (size_t v = 0; v < 3 * l->in.vertex_count; v++)
        l->xyz[v] = 5;
    CHECK(lods_run(l) == PMESH_E_NO_FACES);
    lods_free(l);
}

TEST(simplify_rejects_what_makes_no_sense)
{
    lods *l = lods_sphere(8);
    const pmesh_simplify_options good = l->options;

    l->options.placement = (pmesh_place)6;
    CHECK(lods_run(l) == PMESH_E_ARGUMENT);
    l->options = good;
    l->options.cost = PMESH_COST_CUSTOM; /* without a hook */
    CHECK(lods_run(l) == PMESH_E_ARGUMENT);
    l->options = good;
    l->options.error = -1;
    CHECK(lods_run(l) == PMESH_E_ARGUMENT);
    l->options.error = NAN;
    CHECK(lods_run(l) == PMESH_E_ARGUMENT);
    l->options = good;
    l->options.camera[1] = INFINITY;
    CHECK(lods_run(l) == PMESH_E_ARGUMENT);
    l->options = good;
    l->tri[5] = (uint32_t)l->in.vertex_count;
    CHECK(lods_run(l) == PMESH_E_INDEX);
    l->in.face_count = 0;
    CHECK(lods_run(l) == PMESH_E_NO_FACES);
    lods_free(l);
}

TEST(simplify_survives_want_of_memory)
{
    lods *l = lods_sphere(8);
    lods_budget budget = { 0, 0 };
    pmesh_status status = PMESH_E_MEMORY;

    l->options.allocator = lods_budget_allocator(&budget);
    l->options.faces = 50;
    for (size_t allowed = 0; status == PMESH_E_MEMORY; allowed++) {
        budget = (lods_budget){ .left = allowed, .bytes = 0 };
        status = lods_run(l);
        CHECK(status == PMESH_OK || status == PMESH_E_MEMORY);
        CHECK(budget.bytes == 0);
        CHECK(allowed < 100);
    }
    lods_free(l);
}

TEST(simplify_welds_what_is_close)
{
    lods *l = lods_sphere(12);
    const size_t all = l->in.face_count;
    double *xyz = malloc(9 * all * sizeof *xyz);
    uint32_t *tri = malloc(3 * all * sizeof *tri), seed = 9;

    for (size_t c = 0; c < 3 * all; c++) {
        tri[c] = (uint32_t)c; /* every corner is a vertex of its own */
        for (size_t i = 0; i < 3; i++)
            xyz[3 * c + i] = l->xyz[3 * (size_t)l->tri[c] + i] +
                             1e-7 * (double)shape_random(&seed, 10);
    }
    lods *soup = lods_make(xyz, 3 * all, tri, all);
    soup->options.weld = 1e-5;
    soup->options.faces = all / 4;
    CHECK(lods_run(soup) == PMESH_OK);
    CHECK(soup->out.face_count <= all / 4);
    CHECK(lods_is_closed(soup));
    lods_free(l);
    lods_free(soup);
}

TEST(simplify_tells_which_face_is_which_and_holds_borders_of_materials)
{
    lods *l = lods_flat(16);
    uint32_t *material = malloc(l->in.face_count * sizeof *material);

    /* Left and right half, told apart by the first corner's x. */
    for (size_t f = 0; f < l->in.face_count; f++) {
        const double *p = &l->xyz[3 * (size_t)l->tri[3 * f]];
        const double *q = &l->xyz[3 * (size_t)l->tri[3 * f + 1]];
        const double *r = &l->xyz[3 * (size_t)l->tri[3 * f + 2]];
        material[f] = p[0] + q[0] + r[0] > 24;
    }
    l->in.materials = material;
    l->options.faces = 12;
    CHECK(lods_run(l) == PMESH_OK);
    double area[2] = { 0, 0 };
    for (size_t f = 0; f < l->out.face_count; f++) {
        double n[3];
        lods_normal(l, f, n);
        CHECK(l->out.face_source[f] < l->in.face_count);
        area[material[l->out.face_source[f]]] += n[2] / 2;
    }
    CHECK(fabs(area[0] - 128) < 1e-6 && fabs(area[1] - 128) < 1e-6);
    free(material);
    lods_free(l);
}

/* FNV-1a over corners and the bits of their positions. */
static uint64_t hash_result(const lods *l)
{
    uint64_t hash = UINT64_C(0xcbf29ce484222325);

    for (size_t c = 0; c < 3 * l->out.face_count; c++) {
        const uint32_t v = l->out.indices[c];
        for (size_t i = 0; i < 4; i++) {
            uint64_t word = v;
            if (i > 0)
                memcpy(&word, &l->out.positions[3 * (size_t)v + i - 1],
                       sizeof word);
            hash = (hash ^ word) * UINT64_C(0x100000001b3);
        }
    }
    return hash;
}

/* Another compiler or machine gives these bits, too; a better simplifier gives
 * others: then the number is to be replaced. */
TEST(simplify_gives_the_same_bits_on_every_machine)
{
    shape_mesh *shape = shape_make(SHAPE_TORUS, 24, 3);
    lods *l = lods_copy(shape->positions, shape->input.vertex_count,
                        shape->indices, shape->input.face_count);

    l->options.faces = l->in.face_count / 5;
    CHECK(lods_run(l) == PMESH_OK);
    CHECK(hash_result(l) == UINT64_C(0xd61208ef65b9913d));
    lods_free(l);
    shape_free(shape);
}
