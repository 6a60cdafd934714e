/* SPDX-License-Identifier: MIT */
#include "encoder/enc_lod_near.h"
#include "encoder/pmesh_simplify.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "format/alloc.h"
#include "tests/unit/lods.h"
#include "tests/unit/shapes.h"
#include "tests/unit/test.h"

/* Two squares of 8 x 8 cells that face each other, `gap` apart. */
static lods *plates(double gap, bool apart)
{
    lods *one = lods_flat(8);
    const size_t n = one->in.vertex_count, faces = one->in.face_count;
    double *xyz = malloc(6 * n * sizeof *xyz);
    uint32_t *tri = malloc(6 * faces * sizeof *tri);

    for (size_t v = 0; v < n; v++) {
        memcpy(&xyz[3 * v], &one->xyz[3 * v], 3 * sizeof *xyz);
        memcpy(&xyz[3 * (n + v)], &one->xyz[3 * v], 3 * sizeof *xyz);
        /* The first looks up: the other is before it, or behind. */
        xyz[3 * (n + v) + 2] = apart ? -gap : gap;
    }
    for (size_t c = 0; c < 3 * faces; c++) {
        tri[c] = one->tri[c];
        tri[3 * faces + c] = (uint32_t)(n + one->tri[c - c % 3 + 2 - c % 3]);
    }
    lods_free(one);
    return lods_make(xyz, 2 * n, tri, 2 * faces);
}

TEST(threshold_joins_what_is_closer_and_nothing_else)
{
    lods *l = plates(0.25, false);

    l->options.vertices = 81;
    CHECK(lods_run(l) == PMESH_OK);
    CHECK(l->out.joined == 0 && lods_components(l) == 2);
    l->options.threshold = 0.24; /* less than the gap */
    CHECK(lods_run(l) == PMESH_OK);
    CHECK(l->out.joined == 0 && lods_components(l) == 2);
    l->options.threshold = 0.26;
    l->options.cost = PMESH_COST_LENGTH;
    CHECK(lods_run(l) == PMESH_OK);
    CHECK(l->out.joined > 0 && lods_components(l) == 1);
    CHECK(lods_is_sound(l));
    lods_free(l);
}

TEST(threshold_does_not_reach_through_a_wall)
{
    lods *l = plates(0.25, true); /* back to back */

    l->options.threshold = 0.3;
    l->options.vertices = 81;
    CHECK(lods_run(l) == PMESH_OK);
    CHECK(l->out.joined == 0 && l->out.vertex_count == 81);
    lods_free(l);
}

TEST(threshold_welds_a_soup_as_a_by_product)
{
    lods *l = lods_sphere(10);
    const size_t all = l->in.face_count, n = l->in.vertex_count;
    double *xyz = malloc(9 * all * sizeof *xyz);
    uint32_t *tri = malloc(3 * all * sizeof *tri), seed = 5;

    for (size_t c = 0; c < 3 * all; c++) {
        tri[c] = (uint32_t)c;
        for (size_t i = 0; i < 3; i++)
            xyz[3 * c + i] = l->xyz[3 * (size_t)l->tri[c] + i] +
                             1e-8 * (double)shape_random(&seed, 10);
    }
    lods *soup = lods_make(xyz, 3 * all, tri, all);
    soup->options.threshold = 1e-5;
    soup->options.vertices = n;
    CHECK(lods_run(soup) == PMESH_OK);
    CHECK(soup->out.vertex_count == n && soup->out.joined > 0);
    CHECK(soup->out.face_count == all);
    lods_free(soup);
    lods_free(l);
}

/* Random triangles apart, by numbers, that all look up. */
static lods *confetti(uint32_t count)
{
    double *xyz = malloc(9 * (size_t)count * sizeof *xyz);
    uint32_t *tri = malloc(3 * (size_t)count * sizeof *tri), seed = 21;

    for (uint32_t v = 0; v < 3 * count; v++) {
        tri[v] = v;
        for (uint32_t i = 0; i < 3; i++)
            xyz[3 * v + i] = v % 3 == 0 ? shape_random(&seed, 1000) / 1000.0
                                        : xyz[3 * (v - v % 3) + i];
        xyz[3 * v] += v % 3 == 1 ? 0.01 : 0;
        xyz[3 * v + 1] += v % 3 == 2 ? 0.01 : 0;
    }
    return lods_make(xyz, 3 * (size_t)count, tri, count);
}

static void create(const pmesh_allocator *a, const lods *l, enc_lod *out)
{
    const uint32_t n = (uint32_t)l->in.vertex_count;
    uint32_t *same = malloc(n * sizeof *same);

    for (uint32_t v = 0; v < n; v++)
        same[v] = v;
    CHECK(enc_lod_create(a, l->tri, n / 3, NULL, n, same, same,
                         (const double (*)[3])l->xyz, out) == PMESH_OK);
    free(same);
}

TEST(threshold_finds_the_pairs_that_all_against_all_finds)
{
    const pmesh_allocator a = pmesh_allocator_resolve((pmesh_allocator){ 0 });
    const double t = 0.06;
    lods *l = confetti(100);
    const uint32_t n = (uint32_t)l->in.vertex_count;
    uint32_t count, next = 0, found = 0;
    uint32_t (*pairs)[2];
    size_t capacity;
    enc_lod lod;

    create(&a, l, &lod);
    CHECK(enc_lod_find_near(&lod, t, &pairs, &capacity, &count) == PMESH_OK);
    for (uint32_t u = 0; u < n; u++) {
        uint32_t want = 0, got = 0;
        for (uint32_t v = u + 1; v < n; v++) {
            double square = 0;
            for (uint32_t i = 0; i < 3; i++)
                square += (l->xyz[3 * u + i] - l->xyz[3 * v + i]) *
                          (l->xyz[3 * u + i] - l->xyz[3 * v + i]);
            want += u / 3 != v / 3 && square < t * t;
        }
        for (; next < count && pairs[next][0] == u; next++)
            got++;
        CHECK(got == (want < ENC_LOD_NEAR_PAIRS ? want : ENC_LOD_NEAR_PAIRS));
        found += got;
    }
    CHECK(next == count && found >= 50);
    pmesh_release(&a, pairs, capacity, sizeof *pairs);
    enc_lod_destroy(&lod);
    lods_free(l);
}

/* Seconds for the pairs of so many triangles under a threshold that puts all
 * vertices into one cell. */
static double time_in_one_cell(uint32_t triangles)
{
    const pmesh_allocator a = pmesh_allocator_resolve((pmesh_allocator){ 0 });
    lods *l = confetti(triangles);
    uint32_t (*pairs)[2], count;
    size_t capacity;
    enc_lod lod;

    create(&a, l, &lod);
    const clock_t start = clock();
    CHECK(enc_lod_find_near(&lod, 100, &pairs, &capacity, &count) == PMESH_OK);
    const double seconds = (double)(clock() - start) / CLOCKS_PER_SEC;
    pmesh_release(&a, pairs, capacity, sizeof *pairs);
    enc_lod_destroy(&lod);
    lods_free(l);
    return seconds;
}

/* Each vertex looks at a part of those behind it, but none at those before. */
TEST(threshold_of_the_whole_model_takes_time_in_proportion)
{
    const double few = time_in_one_cell(3000);
    const double many = time_in_one_cell(30000);

    if (getenv("PMESH_FIGURES"))
        printf("    9000 and 90000 vertices: %.3f and %.3f s (%.1fx)\n", few,
               many, many / few);
    CHECK(many < 20 * few + 0.05);
}

TEST(threshold_may_be_as_large_as_the_model)
{
    lods *l = lods_sphere(20);

    l->options.threshold = 100;
    l->options.faces = 200;
    CHECK(lods_run(l) == PMESH_OK);
    CHECK(l->out.face_count <= 200 && lods_is_sound(l));
    lods_free(l);
}

/* Places divided by it are beyond whole numbers. */
TEST(threshold_may_be_as_small_as_numbers_are)
{
    lods *l = lods_sphere(20);

    l->options.threshold = 1e-300;
    l->options.faces = 200;
    CHECK(lods_run(l) == PMESH_OK);
    CHECK(l->out.joined == 0 && lods_is_sound(l));
    lods_free(l);
}
