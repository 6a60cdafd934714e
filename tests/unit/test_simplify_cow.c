/* SPDX-License-Identifier: MIT */
/*
 * The cow of the papers: simple and quadric decimation at 1000 and 100 faces,
 * and costs at 500 faces as a camera sees them. The model is that of
 * PMESH_MODELS, or ../shared/models; without it, nothing to test.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/unit/lods.h"
#include "tests/unit/test.h"
#include "tools/distance.h"
#include "tools/load.h"

static lods *load_cow(asset *cow)
{
    const char *folder = getenv("PMESH_MODELS");
    char path[4096];
    asset_error error;

    snprintf(path, sizeof path, "%s/cow.obj",
             folder ? folder : "../shared/models");
    if (load_mesh(path, cow, &error) != 0)
        return NULL;
    return lods_copy(cow->positions, cow->vertex_count, cow->indices,
                     cow->face_count);
}

static bool is_near(double value, double golden, double share)
{
    return fabs(value / golden - 1) < share;
}

/* ---- how far from the cow ------------------------------------------------ */

/* The larger of the one-sided maxima, by the diagonal. */
static double hausdorff(const asset *cow, lods *l)
{
    asset result = { .positions = l->out.positions,
                     .vertex_count = l->in.vertex_count,
                     .indices = l->out.indices };
    distance_report report;

    CHECK(lods_run(l) == PMESH_OK);
    CHECK(l->out.face_count <= l->options.faces);
    result.face_count = l->out.face_count;
    CHECK(distance_measure(cow, &result, 20000, &report));
    return report.both.max / report.diagonal;
}

TEST(simplify_cow_by_quadrics_stays_closer_than_by_length)
{
    static const struct {
        size_t faces;
        double quadric, simple;
    } golden[] = { { 1000, 0.00746, 0.0379 }, { 100, 0.0612, 0.1508 } };
    asset cow;
    lods *l = load_cow(&cow);

    if (!l)
        return;
    for (size_t i = 0; i < sizeof golden / sizeof *golden; i++) {
        l->options = pmesh_simplify_options_default();
        l->options.faces = golden[i].faces;
        const double quadric = hausdorff(&cow, l);
        l->options.cost = PMESH_COST_LENGTH;
        l->options.placement = PMESH_PLACE_MIDPOINT;
        const double simple = hausdorff(&cow, l);
        if (getenv("PMESH_FIGURES"))
            printf("cow at %zu: quadric %.5f, length %.5f of the diagonal\n",
                   golden[i].faces, quadric, simple);
        CHECK(quadric < simple);
        CHECK(is_near(quadric, golden[i].quadric, 0.05));
        CHECK(is_near(simple, golden[i].simple, 0.05));
    }
    lods_free(l);
    asset_free(&cow);
}

/* ---- what the camera sees ------------------------------------------------ */

/* Half of an edge by 0.01 of its middle's distance to (0, 0, z): the largest of
 * the result's, from nothing but its faces. */
static double largest_cost(const lods *l, double z)
{
    double most = 0;

    for (size_t c = 0; c < 3 * l->out.face_count; c++) {
        const size_t next = c % 3 == 2 ? c - 2 : c + 1;
        const double *a = &l->out.positions[3 * (size_t)l->out.indices[c]];
        const double *b = &l->out.positions[3 * (size_t)l->out.indices[next]];
        double length = 0, far = 0;
        for (int i = 0; i < 3; i++) {
            const double middle = 0.5 * (a[i] + b[i]);
            length += (a[i] - b[i]) * (a[i] - b[i]);
            far += (middle - (i == 2 ? z : 0)) * (middle - (i == 2 ? z : 0));
        }
        most = fmax(most, 0.5 * sqrt(length) / (0.01 * sqrt(far)));
    }
    return most;
}

TEST(simplify_cow_costs_less_and_spreads_less_the_farther_the_camera_is)
{
    static const struct {
        double z, least, most;
    } golden[] = { { 10, 2.314, 7.926 },
                   { 25, 0.953, 3.268 },
                   { 50, 0.4816, 1.592 } };
    double least = INFINITY, most = INFINITY, spread = INFINITY;
    asset cow;
    lods *l = load_cow(&cow);

    if (!l)
        return;
    l->options.faces = 500;
    l->options.cost = PMESH_COST_CAMERA;
    l->options.placement = PMESH_PLACE_MIDPOINT;
    for (size_t i = 0; i < sizeof golden / sizeof *golden; i++) {
        l->options.camera[2] = golden[i].z;
        CHECK(lods_run(l) == PMESH_OK);
        CHECK(l->out.face_count == 500);
        if (getenv("PMESH_FIGURES"))
            printf("cow from z = %g: %.4f to %.4f\n", golden[i].z,
                   l->out.cost_least, l->out.cost_most);
        CHECK(is_near(largest_cost(l, golden[i].z), l->out.cost_most, 1e-9));
        CHECK(is_near(l->out.cost_least, golden[i].least, 0.01));
        CHECK(is_near(l->out.cost_most, golden[i].most, 0.01));
        CHECK(l->out.cost_least < least && l->out.cost_most < most);
        CHECK(l->out.cost_most - l->out.cost_least < spread);
        least = l->out.cost_least;
        most = l->out.cost_most;
        spread = most - least;
    }
    lods_free(l);
    asset_free(&cow);
}
