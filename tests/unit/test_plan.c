/* SPDX-License-Identifier: MIT */
/* Which level to show, from the level table. */
#include "decoder/pmesh_plan.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "tests/unit/shapes.h"
#include "tests/unit/test.h"

/* Errors 16, 8, 4, 2, 1, 0; faces 100, 200, 400, ... */
enum { LEVELS = 6 };

static void make_levels(pmesh_level levels[LEVELS])
{
    for (uint32_t i = 0; i < LEVELS; i++)
        levels[i] = (pmesh_level){ .bytes = 1000u << i,
                                   .faces = 100u << i,
                                   .error = i + 1 < LEVELS
                                                ? (float)(16 >> i) : 0 };
}

TEST(plan_takes_the_coarsest_level_within_an_error)
{
    pmesh_level l[LEVELS];
    make_levels(l);
    CHECK(pmesh_plan_error(l, LEVELS, 100) == 0);
    CHECK(pmesh_plan_error(l, LEVELS, 16) == 0);
    CHECK(pmesh_plan_error(l, LEVELS, 15.9) == 1);
    CHECK(pmesh_plan_error(l, LEVELS, 0) == 5);
    CHECK(pmesh_plan_error(l, 3, 0) == 2);
}

TEST(plan_takes_the_finest_level_within_a_size)
{
    pmesh_level l[LEVELS];
    make_levels(l);
    CHECK(pmesh_plan_bytes(l, LEVELS, 0) == 0);
    CHECK(pmesh_plan_bytes(l, LEVELS, 3999) == 1);
    CHECK(pmesh_plan_bytes(l, LEVELS, 4000) == 2);
    CHECK(pmesh_plan_bytes(l, LEVELS, UINT64_MAX) == 5);
    CHECK(pmesh_plan_faces(l, LEVELS, 1) == 0);
    CHECK(pmesh_plan_faces(l, LEVELS, 799) == 2);
    CHECK(pmesh_plan_faces(l, LEVELS, 800) == 3);
}

TEST(plan_of_pixels_does_not_flicker)
{
    pmesh_level l[LEVELS];
    make_levels(l);
    CHECK(pmesh_plan_pixels(l, LEVELS, 0.5, 2, UINT32_MAX) == 2);
    CHECK(pmesh_plan_pixels(l, LEVELS, 0, 2, 4) == 0);
    /* Nearer at once, further only with a margin. */
    CHECK(pmesh_plan_pixels(l, LEVELS, 0.51, 2, 2) == 3);
    CHECK(pmesh_plan_pixels(l, LEVELS, 0.5, 2, 3) == 3);
    CHECK(pmesh_plan_pixels(l, LEVELS, 0.376, 2, 3) == 3);
    CHECK(pmesh_plan_pixels(l, LEVELS, 0.374, 2, 3) == 2);
    uint32_t level = UINT32_MAX, changes = 0, seed = 1;
    for (int i = 0; i < 1000; i++) {
        const double scale = 0.45 + shape_random(&seed, 100) / 1000.0;
        const uint32_t next = pmesh_plan_pixels(l, LEVELS, scale, 2, level);
        changes += next != level;
        level = next;
    }
    CHECK(changes <= 2);
}

TEST(plan_of_a_scene_keeps_its_budget)
{
    pmesh_level l[LEVELS];
    make_levels(l);
    pmesh_plan_item items[8];
    uint32_t seed = 4;
    for (int round = 0; round < 300; round++) {
        uint64_t faces = 0, bytes = 0;
        const uint64_t most_faces = 800 + shape_random(&seed, 20000);
        const uint64_t most_bytes = 8000 + shape_random(&seed, 200000);
        for (int i = 0; i < 8; i++)
            items[i] = (pmesh_plan_item){
                l, LEVELS, shape_random(&seed, 50) / 10.0, 77
            };
        const double left =
            pmesh_plan_scene(items, 8, 0.5, most_faces, most_bytes);
        double largest = 0;
        for (int i = 0; i < 8; i++) {
            const pmesh_level *now = &l[items[i].level];
            const double p = (double)now->error * items[i].pixels_per_unit;
            faces += now->faces;
            bytes += now->bytes;
            largest = p > largest ? p : largest;
        }
        CHECK(faces <= most_faces && bytes <= most_bytes);
        CHECK(left == largest);
        /* What is not good enough would not fit. */
        for (int i = 0; i < 8; i++) {
            const pmesh_level *now = &l[items[i].level];
            if ((double)now->error * items[i].pixels_per_unit > 0.5)
                CHECK(faces + now[1].faces - now->faces > most_faces ||
                      bytes + now[1].bytes - now->bytes > most_bytes);
        }
    }
}

TEST(plan_of_a_scene_without_budget_meets_the_pixels)
{
    pmesh_level l[LEVELS];
    make_levels(l);
    pmesh_plan_item items[3] = { { l, LEVELS, 1, 0 },
                                 { l, LEVELS, 0.25, 0 },
                                 { l, LEVELS, 0, 0 } };
    CHECK(pmesh_plan_scene(items, 3, 2, 0, 0) <= 2);
    for (int i = 0; i < 3; i++)
        CHECK(items[i].level == pmesh_plan_pixels(l, LEVELS,
                                                  items[i].pixels_per_unit, 2,
                                                  UINT32_MAX));
    CHECK(pmesh_plan_scene(items, 3, 0, 1, 0) == 16); /* bases at least */
}

/* Steps of the worst item, with a budget of faces (0: none); one that does not
 * fit is set aside. */
static void plan_plainly(pmesh_plan_item *items, uint32_t count, double pixels,
                         uint64_t faces)
{
    uint64_t shown = 0;
    bool *aside = calloc(count, sizeof *aside);
    for (uint32_t i = 0; i < count; i++) {
        items[i].level = 0;
        shown += items[i].levels[0].faces;
    }
    for (;;) {
        uint32_t worst = count;
        double most = pixels;
        for (uint32_t i = 0; i < count; i++) {
            const pmesh_plan_item *at = &items[i];
            const double p =
                at->pixels_per_unit * (double)at->levels[at->level].error;
            if (!aside[i] && at->level + 1 < at->level_count && p > most) {
                most = p;
                worst = i;
            }
        }
        if (worst == count)
            break;
        const pmesh_level *now = &items[worst].levels[items[worst].level];
        const uint64_t more = now[1].faces - now->faces;
        aside[worst] = faces > 0 && shown + more > faces;
        shown += aside[worst] ? 0 : more;
        items[worst].level += !aside[worst];
    }
    free(aside);
}

TEST(plan_of_a_scene_goes_on_with_the_worst)
{
    enum { ITEMS = 60 };
    pmesh_level l[LEVELS];
    pmesh_plan_item items[ITEMS], plain[ITEMS];
    uint32_t seed = 9;
    make_levels(l);
    for (int round = 0; round < 500; round++) {
        const uint32_t count = 1 + shape_random(&seed, ITEMS);
        const uint64_t faces =
            round % 5 ? count * 100 + shape_random(&seed, 3000 * count) : 0;
        const double pixels = shape_random(&seed, 30) / 10.0;
        for (uint32_t i = 0; i < count; i++) {
            items[i] = (pmesh_plan_item){ l, 1 + shape_random(&seed, LEVELS),
                                          shape_random(&seed, 20) / 4.0, 77 };
            if (shape_random(&seed, 20) == 0)
                items[i].pixels_per_unit = NAN;
            plain[i] = items[i];
        }
        pmesh_plan_scene(items, count, pixels, faces, 0);
        plan_plainly(plain, count, pixels, faces);
        for (uint32_t i = 0; i < count; i++)
            CHECK(items[i].level == plain[i].level);
    }
}

/* A minute, if every step looked at all items. */
TEST(plan_of_a_scene_of_many_meshes_takes_no_time)
{
    enum { MANY = 100000 };
    pmesh_level l[LEVELS];
    pmesh_plan_item *items = calloc(MANY, sizeof *items);
    make_levels(l);
    for (uint32_t i = 0; i < MANY; i++)
        items[i] = (pmesh_plan_item){ l, LEVELS, 1 + i % 1000, 0 };
    const clock_t start = clock();
    CHECK(pmesh_plan_scene(items, MANY, 0, 0, 0) == 0);
    CHECK(clock() - start < CLOCKS_PER_SEC);
    if (getenv("PMESH_FIGURES"))
        printf("    %d items: %.3f s\n", MANY,
               (double)(clock() - start) / CLOCKS_PER_SEC);
    for (uint32_t i = 0; i < MANY; i++)
        CHECK(items[i].level == LEVELS - 1);
    free(items);
}
