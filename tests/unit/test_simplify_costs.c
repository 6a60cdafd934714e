/* SPDX-License-Identifier: MIT */
#include "encoder/pmesh_simplify.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "tests/unit/lods.h"
#include "tests/unit/test.h"

TEST(simplify_costs_are_what_they_say)
{
    /* A square of side 2 with a diagonal, in a corner of which a camera is. */
    static const double xyz[] = { 0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 2, 0 };
    static const uint32_t tri[] = { 0, 1, 2, 0, 2, 3 };
    lods *l = lods_copy(xyz, 4, tri, 2);

    l->options.faces = 2; /* nothing is contracted */
    l->options.cost = PMESH_COST_LENGTH;
    CHECK(lods_run(l) == PMESH_OK);
    CHECK(fabs(l->out.cost_least - 1) < 1e-9);
    CHECK(fabs(l->out.cost_most - sqrt(2)) < 1e-9);
    CHECK(fabs(l->out.cost_mean - (4 + sqrt(2)) / 5) < 1e-9);
    /* Equation 7 of the lab report: half the edge, by 0.01 of the distance. */
    l->options.cost = PMESH_COST_CAMERA;
    l->options.camera[2] = -10;
    CHECK(lods_run(l) == PMESH_OK);
    const double nearest = sqrt(100 + 1), farthest = sqrt(100 + 4 + 1);
    CHECK(fabs(l->out.cost_least - 1 / (0.01 * farthest)) < 1e-9);
    CHECK(l->out.cost_most > 1 / (0.01 * nearest));
    lods_free(l);
}

/* Mean edge of the half with z above 0, by that below. */
static double far_by_near(const lods *l)
{
    double sum[2] = { 0, 0 };
    size_t count[2] = { 0, 0 };

    for (size_t c = 0; c < 3 * l->out.face_count; c++) {
        const size_t next = c % 3 == 2 ? c - 2 : c + 1;
        const double *p = &l->out.positions[3 * (size_t)l->out.indices[c]];
        const double *q = &l->out.positions[3 * (size_t)l->out.indices[next]];
        const int half = p[2] + q[2] > 0;
        sum[half] +=
            sqrt((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) +
                 (p[2] - q[2]) * (p[2] - q[2]));
        count[half]++;
    }
    return (sum[1] / (double)count[1]) / (sum[0] / (double)count[0]);
}

TEST(simplify_keeps_what_a_camera_is_close_to)
{
    static const pmesh_cost costs[] = { PMESH_COST_CAMERA,
                                        PMESH_COST_QUADRIC_CAMERA };
    lods *l = lods_sphere(32);

    l->options.faces = 400;
    for (int k = 0; k < 2; k++) {
        l->options.cost = costs[k];
        l->options.camera[2] = -1.5; /* unsigned: the other side is alike */
        CHECK(lods_run(l) == PMESH_OK);
        CHECK(far_by_near(l) > 1.5);
        const double mean = l->out.cost_mean;
        l->options.camera[2] = 1.5;
        CHECK(lods_run(l) == PMESH_OK);
        CHECK(far_by_near(l) < 1 / 1.5);
        CHECK(fabs(l->out.cost_mean / mean - 1) < 0.1);
    }
    lods_free(l);
}

static double spare_the_left(void *user, const pmesh_simplify_pair *pair)
{
    size_t *calls = user;

    ++*calls;
    if (!(pair->quadric >= 0) || !(pair->distance >= 0))
        return NAN;
    if (pair->positions[0][0] < -1e-6 || pair->positions[1][0] < -1e-6)
        return -1;
    return pair->quadric;
}

TEST(simplify_asks_a_hook_for_costs)
{
    lods *l = lods_sphere(24);
    size_t calls = 0, left = 0, kept = 0;

    l->options.cost = PMESH_COST_CUSTOM;
    l->options.hook = spare_the_left;
    l->options.user = &calls;
    CHECK(lods_run(l) == PMESH_OK);
    CHECK(l->out.end == PMESH_END_EXHAUSTED && calls > 100);
    for (size_t v = 0; v < l->in.vertex_count; v++)
        left += l->xyz[3 * v] < -1e-6;
    bool *seen = calloc(l->in.vertex_count, sizeof *seen);
    for (size_t c = 0; c < 3 * l->out.face_count; c++) {
        const size_t v = l->out.indices[c];
        kept += !seen[v] && l->out.positions[3 * v] < -1e-6;
        seen[v] = true;
    }
    free(seen);
    CHECK(kept == left);
    CHECK(l->out.vertex_count < l->in.vertex_count * 3 / 4);
    lods_free(l);
}

TEST(simplify_contracts_the_cheapest_of_all)
{
    lods *l = lods_sphere(12);

    l->options.cost = PMESH_COST_LENGTH;
    l->options.placement = PMESH_PLACE_MIDPOINT;
    for (size_t faces = l->in.face_count; faces > 100; faces -= 10) {
        double least = HUGE_VAL;
        l->options.faces = faces;
        CHECK(lods_run(l) == PMESH_OK);
        for (size_t c = 0; c < 3 * l->out.face_count; c++) {
            const size_t next = c % 3 == 2 ? c - 2 : c + 1;
            const double *p = &l->out.positions[3 * (size_t)l->out.indices[c]];
            const double *q =
                &l->out.positions[3 * (size_t)l->out.indices[next]];
            double square = 0;
            for (size_t i = 0; i < 3; i++)
                square += (p[i] - q[i]) * (p[i] - q[i]);
            least = fmin(least, sqrt(square) / 2);
        }
        CHECK(fabs(l->out.cost_least - least) < 1e-8);
    }
    lods_free(l);
}
