/* SPDX-License-Identifier: MIT */
#include "encoder/enc_guide_pull.h"

#include <math.h>
#include <stdlib.h>

#include "encoder/enc_candidate.h"
#include "encoder/enc_guide.h"
#include "encoder/enc_schedule.h"
#include "tests/unit/guide_trial.h"
#include "tests/unit/shapes.h"
#include "tests/unit/test.h"

/* All that a bake does is the same: sides are flat and edges straight, so the
 * places that a constraint asks for are the best ones anyway. */
TEST(guide_leaves_the_order_alone_where_places_are_good_already)
{
    uint32_t list[1000];
    for (int kind = 0; kind < 2; kind++)
        for (int placement = 0; placement < 2; placement++) {
            guide_trial *t = guide_trial_of(guide_box(12));
            pmesh_constraint c = { .kind = kind ? PMESH_PLANE : PMESH_CONTOUR,
                                   .vertices = list };
            c.vertex_count = guide_side_of(t, kind == 0, list);
            CHECK(c.vertex_count > 10);
            t->config.placement = (pmesh_placement)placement;
            guide_run(t);
            const enc_schedule plain = t->schedule;
            t->schedule = (enc_schedule){ 0 };
            t->guide.constraints = &c;
            t->guide.constraint_count = 1;
            guide_run(t);
            CHECK(plain.contraction_count == t->schedule.contraction_count);
            for (uint32_t i = 0; i < plain.contraction_count; i++) {
                const enc_contraction *a = &plain.contraction[i];
                const enc_contraction *b = &t->schedule.contraction[i];
                CHECK(a->child == b->child && a->parent == b->parent);
            }
            enc_schedule other = plain;
            enc_schedule_destroy(&other);
            guide_finish(t);
        }
}

/* A constraint never counts as cost: where the place is given, so is that. */
TEST(guide_constraints_are_no_cost)
{
    guide_trial *t = guide_trial_of(shape_make(SHAPE_TORUS, 16, 2));
    uint32_t list[] = { 3, 40, 77, 120 };
    const pmesh_constraint c = { .kind = PMESH_POINT, .vertices = list,
                                 .vertex_count = 4, .importance = 1e6 };
    enc_pricing plain, guided;
    enc_surface s;

    guide_run(t);
    CHECK(enc_pricing_create(&t->mesh, &t->config, &plain) == PMESH_OK);
    enc_mesh first = t->mesh;
    t->mesh = (enc_mesh){ 0 };
    t->guide.constraints = &c;
    t->guide.constraint_count = 1;
    guide_run(t);
    CHECK(enc_pricing_create(&t->mesh, &t->config, &guided) == PMESH_OK);
    CHECK(guided.pull && !plain.pull);
    CHECK(enc_surface_create(&t->mesh, &s) == PMESH_OK);
    enc_pricing_begin(&plain, &s, (enc_taste){ 1, 1, 1 }, true);
    enc_pricing_begin(&guided, &s, (enc_taste){ 1, 1, 1 }, true);
    double pull = 0;
    for (uint32_t h = 0; h < 3 * t->mesh.face_count; h++) {
        const enc_pair pair = enc_surface_pair(&s, h, false);
        const enc_offer a = enc_pricing_offer(&plain, &s, &pair);
        const enc_offer b = enc_pricing_offer(&guided, &s, &pair);
        CHECK(a.cost == b.cost && a.distance == b.distance);
        double ends[2];
        enc_pricing_ends(&guided, &s, &pair, ends);
        pull = fmax(pull, fmax(ends[0], ends[1]));
    }
    CHECK(pull > 0);
    enc_surface_destroy(&s);
    enc_pricing_destroy(&first, &plain);
    enc_pricing_destroy(&t->mesh, &guided);
    enc_mesh_destroy(&first);
    guide_finish(t);
}

/* However important: costs are made of these. */
TEST(guide_constraints_stay_finite)
{
    uint32_t list[] = { 3, 40, 77, 120 };
    for (int kind = 0; kind < 3; kind++) {
        guide_trial *t = guide_trial_of(shape_make(SHAPE_TORUS, 16, 2));
        const pmesh_constraint c = { .kind = (pmesh_constraint_kind)kind,
                                     .vertices = list, .vertex_count = 4,
                                     .importance = 1e308 };
        t->guide.constraints = &c;
        t->guide.constraint_count = 1;
        guide_run(t);
        for (uint32_t v = 0; v < t->mesh.vertex_count; v++)
            for (int k = 0; k < 6; k++)
                CHECK(isfinite(t->mesh.guide->pull[v].a[k]));
        guide_finish(t);
    }
}

static double line_distance(const double p[3], const double a[3],
                            const double b[3])
{
    double ab[3], ap[3], dot = 0, square = 0, sum = 0;
    for (int k = 0; k < 3; k++) {
        ab[k] = b[k] - a[k];
        ap[k] = p[k] - a[k];
        dot += ab[k] * ap[k];
        square += ab[k] * ab[k];
    }
    const double s = square > 0 ? fmin(1, fmax(0, dot / square)) : 0;
    for (int k = 0; k < 3; k++)
        sum += (ap[k] - s * ab[k]) * (ap[k] - s * ab[k]);
    return sqrt(sum);
}

/* How far what became of a contour's vertices is from it, in diagonals. */
static double contour_drift(const guide_trial *t, const pmesh_constraint *c)
{
    double worst = 0;
    for (size_t i = 0; i < c->vertex_count; i++) {
        const uint32_t root = guide_root_of(t, c->vertices[i]);
        double p[3], best = HUGE_VAL;
        for (int k = 0; k < 3; k++)
            p[k] = t->schedule.position[root][k];
        for (size_t j = 1; j < c->vertex_count; j++) {
            double a[3], b[3];
            guide_step_place(t, c->vertices[j - 1], a);
            guide_step_place(t, c->vertices[j], b);
            best = fmin(best, line_distance(p, a, b));
        }
        worst = fmax(worst, best);
    }
    return worst / guide_diagonal(t);
}

/* A path along the torus: one of its rings, with bumps. */
static size_t ring_of(const guide_trial *t, uint32_t size, uint32_t *out)
{
    (void)t;
    for (uint32_t i = 0; i <= size; i++)
        out[i] = i % size;
    return size + 1;
}

TEST(guide_contours_stay_on_their_line_to_the_base)
{
    uint32_t list[200];
    guide_trial *t = guide_trial_of(shape_make(SHAPE_TORUS, 24, 4));
    pmesh_constraint c = { .kind = PMESH_CONTOUR, .vertices = list };

    c.vertex_count = ring_of(t, 24, list);
    t->config.base_faces = 120;
    guide_run(t);
    const double plain = contour_drift(t, &c);
    t->guide.constraints = &c;
    t->guide.constraint_count = 1;
    guide_run(t);
    CHECK(plain > 1e-2);
    CHECK(contour_drift(t, &c) <= 1e-3);
    guide_finish(t);
}

TEST(guide_points_stay_where_they_are)
{
    uint32_t list[] = { 7, 150, 333, 411 };
    const pmesh_constraint c = { .kind = PMESH_POINT, .vertices = list,
                                 .vertex_count = 4 };
    for (int placement = 0; placement < 2; placement++) {
        double drift[2] = { 0, 0 };
        guide_trial *t = guide_trial_of(shape_make(SHAPE_TORUS, 24, 4));
        t->guide.constraints = &c;
        t->config.base_faces = 120;
        t->config.placement = (pmesh_placement)placement;
        for (size_t on = 0; on < 2; on++) {
            t->guide.constraint_count = on;
            guide_run(t);
            for (int i = 0; i < 4; i++) {
                double at[3], sum = 0;
                const uint32_t root = guide_root_of(t, list[i]);
                guide_step_place(t, list[i], at);
                for (int k = 0; k < 3; k++)
                    sum += (t->schedule.position[root][k] - at[k]) *
                           (t->schedule.position[root][k] - at[k]);
                drift[on] = fmax(drift[on], sqrt(sum) / guide_diagonal(t));
            }
        }
        CHECK(drift[0] > 1e-2);
        CHECK(drift[1] <= 1e-4);
        guide_finish(t);
    }
}

/* Importance and area scale the pull, and nothing else does. */
TEST(guide_pull_is_importance_times_the_area_around)
{
    for (int twice = 1; twice <= 2; twice++) {
        guide_trial *t = guide_trial_of(guide_box(8));
        uint32_t list[1000];
        pmesh_constraint c = { .kind = PMESH_POINT, .vertices = list,
                               .importance = twice };
        c.vertex_count = guide_side_of(t, false, list);
        t->guide.constraints = &c;
        t->guide.constraint_count = 1;
        guide_run(t);
        double *area = calloc(t->mesh.vertex_count, sizeof *area);
        enc_surface s;
        CHECK(enc_surface_create(&t->mesh, &s) == PMESH_OK);
        for (uint32_t h = 0; h < 3 * t->mesh.face_count; h++) {
            double n[3];
            enc_surface_normal(&s, h, s.position[s.vertex[h]], n);
            area[s.vertex[h]] +=
                0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        }
        for (size_t i = 0; i < c.vertex_count; i++) {
            const enc_quadric *q = &t->mesh.guide->pull[list[i]];
            const double expected = ENC_PULL * twice * area[list[i]];
            CHECK(fabs(q->a[0] - expected) <= 1e-9 * expected);
            CHECK(q->a[1] == 0 && q->b[0] == 0 && q->c == 0);
            CHECK(fabs(q->weight - expected) <= 1e-9 * expected);
        }
        enc_surface_destroy(&s);
        free(area);
        guide_finish(t);
    }
}

TEST(guide_quadrics_measure_lines_planes_and_points)
{
    const double along[3] = { 3, 0, 4 }, n[3] = { 0, 1, 0 };
    const double through[3] = { 5, -2, 7 }, x[3] = { 4, 2, -3 };
    enc_quadric line = { .c = 0 }, plane = { .c = 0 }, point = { .c = 0 };

    enc_pull_line(&line, along, 1);
    enc_pull_plane(&plane, n, through, 1);
    enc_pull_point(&point, 1);
    /* x is (0, 0) along the line, so all of it counts. */
    CHECK(fabs(enc_quadric_value(&line, x) - 29) < 1e-12);
    CHECK(fabs(enc_quadric_value(&plane, x) - 16) < 1e-12);
    CHECK(fabs(enc_quadric_value(&point, x) - 29) < 1e-12);
    CHECK(enc_quadric_value(&line, along) < 1e-12);
}

TEST(guide_fits_the_plane_of_least_squares)
{
    /* Spread 9 and 4 along two directions, 1 along (1, 2, 2) / 3. */
    const double axes[3][3] = { { 2. / 3, 1. / 3, -2. / 3 },
                                { 2. / 3, -2. / 3, 1. / 3 },
                                { 1. / 3, 2. / 3, 2. / 3 } };
    const double spread[3] = { 9, 4, 1 };
    double covariance[6] = { 0 }, n[3];
    static const int row[] = { 0, 0, 0, 1, 1, 2 }, col[] = { 0, 1, 2, 1, 2, 2 };

    for (int i = 0; i < 6; i++)
        for (int k = 0; k < 3; k++)
            covariance[i] += spread[k] * axes[k][row[i]] * axes[k][col[i]];
    enc_pull_fit(covariance, n);
    CHECK(fabs(fabs(n[0] + 2 * n[1] + 2 * n[2]) / 3 - 1) < 1e-12);
}

static uint32_t pulled(guide_trial *t)
{
    uint32_t count = 0;
    guide_run(t);
    for (uint32_t v = 0; v < t->mesh.vertex_count; v++)
        count += t->mesh.guide->pull[v].weight > 0;
    return count;
}

TEST(guide_finds_contours_by_itself)
{
    guide_trial *t = guide_trial_of(guide_box(8));
    t->guide.crease = 40;
    CHECK(pulled(t) == 12 * 7 + 8); /* the edges of the box */
    t->guide.crease = 91;
    CHECK(pulled(t) == 0);
    t->guide.crease = 0;

    /* Half of the faces in another material. */
    uint32_t *material = calloc(t->shape->input.face_count, sizeof *material);
    t->shape->materials = material;
    t->shape->input.materials = material;
    t->shape->input.material_count = 2;
    for (size_t f = 0; f < t->shape->input.face_count; f++)
        material[f] = f < 256; /* the sides of x: two frames of edges */
    t->guide.borders = 1;
    CHECK(pulled(t) == 2 * 4 * 8);
    t->guide.borders = 0;
    t->guide.seams = 1;
    CHECK(pulled(t) == 0);
    guide_finish(t);
}

TEST(guide_finds_seams_of_attributes)
{
    shape_mesh *sphere = shape_make(SHAPE_SPHERE, 12, 1);
    const size_t attributes = sphere->input.attribute_count;
    guide_trial *t = guide_trial_of(sphere);
    sphere->input.attribute_count = attributes; /* coordinates with a seam */
    t->guide.seams = 1;
    const uint32_t on_seam = pulled(t);
    CHECK(on_seam > 5 && on_seam < t->mesh.vertex_count / 2);
    guide_finish(t);
}
