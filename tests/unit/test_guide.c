/* SPDX-License-Identifier: MIT */
#include "encoder/enc_guide.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "encoder/enc_candidate.h"
#include "encoder/enc_schedule.h"
#include "tests/unit/guide_trial.h"
#include "tests/unit/shapes.h"
#include "tests/unit/test.h"

/* ---- weights ------------------------------------------------------------- */

TEST(guide_of_neutral_weights_gives_the_same_bytes)
{
    guide_trial *t = guide_trial_of(shape_make(SHAPE_TERRAIN, 20, 1));
    for (int metric = 0; metric < 2; metric++) {
        t->config.metric = (pmesh_metric)metric;
        t->config.guide = NULL;
        const shape_bytes plain = guide_bake(t);
        t->config.guide = &t->guide;
        t->guide.weights = t->weights;
        CHECK(guide_same_bytes(plain, guide_bake(t)));
    }
    guide_finish(t);
}

/* Vertices of the right half that are left in the base mesh. */
static uint32_t kept_right(const guide_trial *t)
{
    uint32_t count = 0;
    for (uint32_t v = 0; v < t->mesh.vertex_count; v++)
        count += t->schedule.vertex_end[v] == ENC_NONE &&
                 2 * t->mesh.position[v][0] > t->mesh.bounds[0];
    return count;
}

static void weigh_right(guide_trial *t, float weight)
{
    double low = HUGE_VAL, high = -HUGE_VAL;
    const double *p = t->shape->positions;
    const size_t n = t->shape->input.vertex_count;

    t->guide.weights = t->weights;
    for (size_t v = 0; v < n; v++) {
        low = fmin(low, p[3 * v]);
        high = fmax(high, p[3 * v]);
    }
    for (size_t v = 0; v < n; v++)
        t->weights[v] = 2 * p[3 * v] > low + high ? weight : 0.5f;
}

TEST(guide_keeps_more_of_a_region_the_more_it_weighs)
{
    static const float weights[] = { 0, 0.25f, 0.5f, 0.75f, 1 };
    for (int metric = 0; metric < 2; metric++) {
        guide_trial *t = guide_trial_of(shape_make(SHAPE_TORUS, 24, 3));
        uint32_t before = 0;
        t->config.base_faces = 300;
        t->config.metric = (pmesh_metric)metric;
        for (int i = 0; i < 5; i++) {
            weigh_right(t, weights[i]);
            guide_run(t);
                        CHECK(kept_right(t) > before);
            before = kept_right(t);
        }
        guide_finish(t);
    }
}

/* Of a mesh and one with ten times the faces. */
TEST(guide_keeps_a_region_its_share_at_any_resolution)
{
    double share[2];
    for (int fine = 0; fine < 2; fine++) {
        guide_trial *t = guide_trial_of(shape_make(SHAPE_SPHERE, fine ? 220 : 70, 5));
        t->config.base_faces = 600;
        t->config.profile = PMESH_QUALITY;
        weigh_right(t, 0.75f);
        guide_run(t);
        const double all =
            t->mesh.vertex_count - t->schedule.contraction_count;
        share[fine] = kept_right(t) / all;
        guide_finish(t);
    }
    CHECK(fabs(share[0] - share[1]) <= 0.1 * share[0]);
}

/* A ridge whose left side gets heavier: the place nears its plane. */
TEST(guide_moves_the_place_towards_the_heavier_planes)
{
    double before = HUGE_VAL;
    for (int i = 0; i < 5; i++) {
        guide_trial *t = guide_trial_of(shape_make(SHAPE_TERRAIN, 12, 7));
        enc_pricing pricing;
        enc_surface s;
        t->config.placement = PMESH_OPTIMAL;
        t->guide.weights = t->weights;
        t->weights[0] = 0.5f;
        guide_run(t);
        CHECK(enc_surface_create(&t->mesh, &s) == PMESH_OK);
        /* Any edge within the surface. */
        uint32_t h = 0;
        while (s.twin[h] == ENC_NONE || enc_on_boundary(&s, s.vertex[h]) ||
               enc_on_boundary(&s, s.vertex[enc_next(h)]))
            h++;
        const enc_pair pair = enc_surface_pair(&s, h, false);
        CHECK(enc_pricing_create(&t->mesh, &t->config, &pricing) == PMESH_OK);
        pricing.factor[pair.child] = (float)pow(10, i);
        enc_pricing_begin(&pricing, &s, (enc_taste){ 1, 0, 0 }, true);
        const enc_offer offer = enc_pricing_offer(&pricing, &s, &pair);
        enc_quadric child;
        double x[3];
        enc_star_quadric(&s, pair.child, &child, NULL);
        for (int k = 0; k < 3; k++)
            x[k] = offer.place[k] - s.position[pair.child][k];
        const double value = enc_quadric_value(&child, x);
        CHECK(value <= before * 1.01 + 1);
        if (i == 4)
            CHECK(value < 0.5 * before || value < 100);
        before = i == 0 ? value : fmin(before, value);
        enc_pricing_destroy(&t->mesh, &pricing);
        enc_surface_destroy(&s);
        guide_finish(t);
    }
}

/* ---- locks and segments -------------------------------------------------- */

TEST(guide_locked_vertices_stay_at_their_place)
{
    for (int placement = 0; placement < 2; placement++) {
        guide_trial *t = guide_trial_of(shape_make(SHAPE_TORUS, 24, 6));
        t->config.placement = (pmesh_placement)placement;
        t->guide.locks = t->locks;
        for (uint32_t v = 0; v < t->shape->input.vertex_count; v += 50)
            t->locks[v] = 1;
        guide_run(t);
        for (uint32_t v = 0; v < t->mesh.vertex_count; v += 50) {
            CHECK(t->schedule.vertex_end[v] == ENC_NONE);
            CHECK(guide_distance(t->schedule.position[v], t->mesh.position[v]) == 0);
        }
        guide_finish(t);
    }
}

TEST(guide_segments_are_never_joined_and_keep_their_shares)
{
    guide_trial *t = guide_trial_of(shape_make(SHAPE_TORUS, 40, 6));
    const double shares[3] = { 0, 0.6, 0.1 };
    uint32_t size[3] = { 0 }, all = 0;
    const double *p = t->shape->positions;

    for (size_t v = 0; v < t->shape->input.vertex_count; v++)
        t->segments[v] = p[3 * v] > 0.9 ? 1 : p[3 * v] < -0.9 ? 2 : 0;
    t->guide.segments = t->segments;
    t->guide.shares = shares;
    t->guide.segment_count = 3;
    t->config.base_faces = 300;
    guide_run(t);
    for (uint32_t v = 0; v < t->mesh.vertex_count; v++)
        size[t->segments[v]]++;
    all = t->mesh.vertex_count;
    CHECK(size[1] > 20 && size[2] > 20 && size[1] < 0.3 * all);
    for (uint32_t b = 0; b < t->schedule.batch_count; b++) {
        uint32_t before[3];
        memcpy(before, size, sizeof before);
        for (uint32_t i = t->schedule.batch_first[b];
             i < t->schedule.batch_first[b + 1]; i++) {
            const enc_contraction *c = &t->schedule.contraction[i];
            CHECK(t->segments[c->child] == t->segments[c->parent]);
            size[t->segments[c->child]]--;
            all--;
        }
        for (int i = 1; i < 3; i++)
            CHECK(size[i] == before[i] || size[i] >= shares[i] * all);
    }
    CHECK(size[1] >= 0.6 * all && size[2] >= 0.1 * all);
    guide_finish(t);
}

/* ---- the rest ------------------------------------------------------------ */

TEST(guide_out_of_range_is_refused)
{
    guide_trial *t = guide_trial_of(guide_box(4));
    const uint32_t far = (uint32_t)t->shape->input.vertex_count;
    pmesh_constraint c = { .kind = PMESH_POINT, .vertices = &far,
                           .vertex_count = 1 };
    const double share = 1.5;
    pmesh_guide wrong[9];
    shape_bytes bytes;
    pmesh_encode_report report;

    for (int i = 0; i < 9; i++)
        wrong[i] = pmesh_guide_default();
    wrong[0].factor = 1;
    wrong[1].factor = NAN;
    wrong[2].crease = -1;
    wrong[3].importance = INFINITY;
    wrong[4].constraints = &c;
    wrong[4].constraint_count = 1;
    wrong[5].segments = t->segments; /* without a count */
    wrong[6].segments = t->segments;
    wrong[6].shares = &share;
    wrong[6].segment_count = 1;
    wrong[7].constraint_count = 1;
    wrong[8].segments = t->segments;
    wrong[8].segment_count = 1;
    t->segments[5] = 1;
    for (int i = 0; i < 9; i++) {
        t->config.guide = &wrong[i];
        if (i == 6)
            t->segments[5] = 0;
        CHECK(shape_bake(t->shape, &t->config, &bytes, &report) ==
              PMESH_E_ARGUMENT);
        t->segments[5] = 1;
    }
    guide_finish(t);
}

/* Weights that are no numbers, or beyond the range, do no harm. */
TEST(guide_takes_any_weight)
{
    guide_trial *t = guide_trial_of(shape_make(SHAPE_SOUP, 20, 3));
    const float odd[] = { NAN, -INFINITY, INFINITY, -1, 2, 0.5f };
    for (size_t v = 0; v < t->shape->input.vertex_count; v++)
        t->weights[v] = odd[v % 6];
    t->guide.weights = t->weights;
    for (int placement = 0; placement < 2; placement++) {
        t->config.placement = (pmesh_placement)placement;
        shape_bytes bytes = guide_bake(t);
        pmesh_status status;
        pmesh_decoder *dec =
            shape_decode(bytes.data, bytes.size, bytes.size, &status);
        CHECK(status == PMESH_OK && shape_view_sound(dec));
        pmesh_decoder_destroy(dec);
        free(bytes.data);
    }
    guide_finish(t);
}

typedef struct budget {
    size_t left;
    long held;
} budget;

static void *budget_alloc(void *user, size_t size)
{
    budget *b = user;
    if (b->left == 0)
        return NULL;
    b->left--;
    b->held++;
    return malloc(size);
}

static void budget_release(void *user, void *ptr, size_t size)
{
    budget *b = user;
    (void)size;
    if (ptr)
        b->held--;
    free(ptr);
}

TEST(guide_survives_every_failure_of_memory)
{
    guide_trial *t = guide_trial_of(guide_box(3));
    uint32_t list[100];
    pmesh_constraint c = { .kind = PMESH_PLANE, .vertices = list };
    const double share = 0.1;
    pmesh_status status = PMESH_E_MEMORY;

    c.vertex_count = guide_side_of(t, false, list);
    t->guide = (pmesh_guide){ .weights = t->weights, .factor = 10,
                              .locks = t->locks, .segments = t->segments,
                              .shares = &share, .segment_count = 1,
                              .constraints = &c, .constraint_count = 1 };
    for (size_t n = 0; status == PMESH_E_MEMORY; n++) {
        budget b = { .left = n };
        shape_bytes bytes;
        pmesh_encode_report report;
        CHECK(n < 1000);
        t->config.allocator = (pmesh_allocator){ .alloc = budget_alloc,
                                                 .release = budget_release,
                                                 .user = &b };
        status = shape_bake(t->shape, &t->config, &bytes, &report);
        CHECK(b.held == 0);
        if (status == PMESH_OK)
            free(bytes.data);
    }
    CHECK(status == PMESH_OK);
    guide_finish(t);
}
