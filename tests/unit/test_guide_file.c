/* SPDX-License-Identifier: MIT */
/* Guide files: which vertices they mean, and how long it takes to tell. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "tests/unit/shapes.h"
#include "tests/unit/test.h"
#include "tools/guide.h"
#include "tools/trig.h"

/* A guide with one constraint, points at these places. */
static bool read_points(guide *g, const asset *mesh, const double *at,
                        size_t count, asset_error *error)
{
    asset_bytes text = { 0 };

    asset_printf(&text, "{\"pmesh_guide\":1,\"points\":[{\"positions\":[");
    for (size_t i = 0; i < count; i++)
        asset_printf(&text, "%s[%.17g,%.17g,%.17g]", i ? "," : "", at[3 * i],
                     at[3 * i + 1], at[3 * i + 2]);
    asset_printf(&text, "]}]}");
    CHECK(!text.failed && guide_create(g));
    const bool ok = guide_read(g, text.data, text.size, mesh, error);
    asset_bytes_free(&text);
    return ok;
}

static double square(const double *a, const double *b)
{
    double sum = 0;
    for (int k = 0; k < 3; k++)
        sum += (a[k] - b[k]) * (a[k] - b[k]);
    return sum;
}

TEST(guide_positions_mean_the_first_of_the_nearest_vertices)
{
    enum { VERTICES = 500, PLACES = 500 };
    static double vertices[3 * VERTICES], places[3 * PLACES];
    uint32_t seed = 7;
    /* On few places, flat or not: many are equally near, or the same. */
    for (uint32_t width = 1; width < 1000; width *= 3) {
        const asset mesh = { .positions = vertices, .vertex_count = VERTICES };
        guide g;
        asset_error error;
        for (size_t i = 0; i < 3 * VERTICES; i++)
            vertices[i] = shape_random(&seed, i % 3 ? width : 9);
        for (size_t i = 0; i < 3 * PLACES; i++)
            places[i] = shape_random(&seed, 2 * width) / 2.0;
        CHECK(read_points(&g, &mesh, places, PLACES, &error));
        const pmesh_constraint *c = g.use.constraints;
        CHECK(g.use.constraint_count == 1 && c->vertex_count == PLACES);
        for (size_t i = 0; i < PLACES; i++) {
            uint32_t best = 0;
            for (uint32_t v = 1; v < VERTICES; v++)
                if (square(vertices + 3 * v, places + 3 * i) <
                    square(vertices + 3 * best, places + 3 * i))
                    best = v;
            CHECK(c->vertices[i] == best);
        }
        guide_free(&g);
    }
}

enum { MANY = 100000 };

/* Ten seconds, if vertices were told apart along one axis only. */
TEST(guide_positions_on_a_wall_are_found_in_time)
{
    double *vertices = calloc(3 * MANY, sizeof *vertices);
    double *places = calloc(3 * MANY, sizeof *places);
    uint32_t seed = 7;
    asset mesh = { .positions = vertices, .vertex_count = MANY };
    guide g;
    asset_error error;
    for (size_t i = 0; i < 3 * MANY; i++) {
        vertices[i] = i % 3 ? shape_random(&seed, 1u << 20) : 0;
        places[i] = shape_random(&seed, 1u << 20);
    }
    vertices[0] = 1u << 30; /* the widest axis is that one */
    const clock_t start = clock();
    CHECK(read_points(&g, &mesh, places, MANY, &error));
    CHECK(clock() - start < 3 * CLOCKS_PER_SEC);
    if (getenv("PMESH_FIGURES"))
        printf("    %d places of %d vertices: %.3f s\n", MANY, MANY,
               (double)(clock() - start) / CLOCKS_PER_SEC);
    guide_free(&g);
    free(places);
    free(vertices);
}

/* Of a circle all are equally far from its centre: no order helps. */
TEST(guides_look_at_no_more_than_their_limit)
{
    double *vertices = calloc(3 * MANY, sizeof *vertices);
    double *places = calloc(3 * MANY, sizeof *places);
    asset mesh = { .positions = vertices, .vertex_count = MANY };
    guide g;
    asset_error error;
    for (size_t i = 0; i < MANY; i++) {
        vertices[3 * i] = trig_cos((double)i / MANY);
        vertices[3 * i + 1] = trig_sin((double)i / MANY);
    }
    CHECK(read_points(&g, &mesh, places, 10, &error));
    guide_free(&g);
    CHECK(!read_points(&g, &mesh, places, MANY, &error));
    CHECK(strstr(error.what, "looks at more than 2^32 vertices") != NULL);
    guide_free(&g);
    free(places);
    free(vertices);
}
