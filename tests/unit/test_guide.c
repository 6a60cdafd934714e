/* SPDX-License-Identifier: MIT */
#include "encoder/enc_guide.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "encoder/enc_candidate.h"
#include "encoder/enc_guide_pull.h"
#include "encoder/enc_schedule.h"
#include "tests/unit/shapes.h"
#include "tests/unit/test.h"

/* A mesh, what is said of it, and what becomes of it. */
typedef struct trial {
    shape_mesh *shape;
    float *weights;
    uint8_t *locks;
    uint16_t *segments;
    pmesh_guide guide;
    pmesh_encoder_config config;
    enc_mesh mesh;
    enc_schedule schedule;
} trial;

static trial *trial_of(shape_mesh *shape)
{
    trial *t = calloc(1, sizeof *t);
    const size_t n = shape->input.vertex_count;

    t->shape = shape;
    shape->input.attribute_count = 0;
    t->weights = calloc(n, sizeof *t->weights);
    t->locks = calloc(n, sizeof *t->locks);
    t->segments = calloc(n, sizeof *t->segments);
    for (size_t v = 0; v < n; v++)
        t->weights[v] = 0.5f;
    t->guide = pmesh_guide_default();
    t->config = pmesh_encoder_config_default();
    t->config.guide = &t->guide;
    return t;
}

static void forget(trial *t)
{
    enc_schedule_destroy(&t->schedule);
    enc_mesh_destroy(&t->mesh);
}

static void run(trial *t)
{
    pmesh_encode_report report = { 0 };

    forget(t);
    CHECK(enc_mesh_import(&t->shape->input, &t->config, &t->mesh, &report) ==
          PMESH_OK);
    CHECK(enc_schedule_build(&t->mesh, &t->config, 0, &t->schedule) ==
          PMESH_OK);
}

static void finish(trial *t)
{
    forget(t);
    shape_free(t->shape);
    free(t->weights);
    free(t->locks);
    free(t->segments);
    free(t);
}

static shape_bytes bake(trial *t)
{
    shape_bytes bytes;
    pmesh_encode_report report;
    CHECK(shape_bake(t->shape, &t->config, &bytes, &report) == PMESH_OK);
    return bytes;
}

static bool same_bytes(shape_bytes a, shape_bytes b)
{
    const bool same = a.size == b.size && memcmp(a.data, b.data, a.size) == 0;
    free(a.data);
    free(b.data);
    return same;
}

/* The vertex that v has become in the base mesh. */
static uint32_t root_of(const trial *t, uint32_t v)
{
    while (t->schedule.vertex_end[v] != ENC_NONE)
        v = t->schedule.contraction[t->schedule.vertex_end[v]].parent;
    return v;
}

static double distance(const int32_t a[3], const int32_t b[3])
{
    double sum = 0;
    for (int k = 0; k < 3; k++)
        sum += (double)(a[k] - b[k]) * (a[k] - b[k]);
    return sqrt(sum);
}

static double diagonal(const trial *t)
{
    const int32_t zero[3] = { 0, 0, 0 };
    return distance(t->mesh.bounds, zero);
}

/* Positions of the input in grid steps. */
static void step_place(const trial *t, uint32_t v, double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = (t->shape->positions[3 * v + (uint32_t)k] -
                  t->mesh.grid.origin[k]) /
                 t->mesh.grid.step;
}

/* A box of n x n uneven cells a side: flat sides, straight edges. */
static shape_mesh *box(uint32_t n)
{
    const uint32_t side = n + 1, all = side * side * side;
    uint32_t *number = calloc(all, sizeof *number), count = 0, faces = 0;
    shape_mesh *s = calloc(1, sizeof *s);
    uint32_t seed = n;

    s->positions = calloc(3 * all, sizeof *s->positions);
    s->indices = calloc(36 * n * n, sizeof *s->indices);
    for (uint32_t i = 0; i < all; i++) {
        const uint32_t at[3] = { i % side, i / side % side, i / side / side };
        bool outside = false;
        for (int k = 0; k < 3; k++)
            outside = outside || at[k] == 0 || at[k] == n;
        number[i] = count;
        for (int k = 0; outside && k < 3; k++)
            s->positions[3 * count + (uint32_t)k] =
                at[k] == 0 || at[k] == n
                    ? at[k]
                    : at[k] + shape_random(&seed, 1000) / 2500.0 - 0.2;
        count += outside;
    }
    const uint32_t step[3] = { 1, side, side * side };
    for (uint32_t k = 0; k < 3; k++)
        for (uint32_t far = 0; far < 2; far++)
            for (uint32_t c = 0; c < n * n; c++) {
                const uint32_t u = step[(k + 1) % 3], v = step[(k + 2) % 3];
                const uint32_t o = far * n * step[k] + c % n * u + c / n * v;
                const uint32_t quad[4] = { o, o + u, o + u + v, o + v };
                const uint32_t order[2][6] = { { 0, 2, 1, 0, 3, 2 },
                                               { 0, 1, 2, 0, 2, 3 } };
                for (uint32_t i = 0; i < 6; i++)
                    s->indices[3 * faces + i] = number[quad[order[far][i]]];
                faces += 2;
            }
    free(number);
    s->input = (pmesh_mesh_input){ .positions = s->positions,
                                   .vertex_count = count,
                                   .indices = s->indices,
                                   .face_count = faces };
    return s;
}

/* ---- weights ------------------------------------------------------------- */

TEST(guide_of_neutral_weights_gives_the_same_bytes)
{
    trial *t = trial_of(shape_make(SHAPE_TERRAIN, 20, 1));
    for (int metric = 0; metric < 2; metric++) {
        t->config.metric = (pmesh_metric)metric;
        t->config.guide = NULL;
        const shape_bytes plain = bake(t);
        t->config.guide = &t->guide;
        t->guide.weights = t->weights;
        CHECK(same_bytes(plain, bake(t)));
    }
    finish(t);
}

/* Vertices of the right half that are left in the base mesh. */
static uint32_t kept_right(const trial *t)
{
    uint32_t count = 0;
    for (uint32_t v = 0; v < t->mesh.vertex_count; v++)
        count += t->schedule.vertex_end[v] == ENC_NONE &&
                 2 * t->mesh.position[v][0] > t->mesh.bounds[0];
    return count;
}

static void weigh_right(trial *t, float weight)
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
        trial *t = trial_of(shape_make(SHAPE_TORUS, 24, 3));
        uint32_t before = 0;
        t->config.base_faces = 300;
        t->config.metric = (pmesh_metric)metric;
        for (int i = 0; i < 5; i++) {
            weigh_right(t, weights[i]);
            run(t);
                        CHECK(kept_right(t) > before);
            before = kept_right(t);
        }
        finish(t);
    }
}

/* Of a mesh and one with ten times the faces. */
TEST(guide_keeps_a_region_its_share_at_any_resolution)
{
    double share[2];
    for (int fine = 0; fine < 2; fine++) {
        trial *t = trial_of(shape_make(SHAPE_SPHERE, fine ? 220 : 70, 5));
        t->config.base_faces = 600;
        t->config.profile = PMESH_QUALITY;
        weigh_right(t, 0.75f);
        run(t);
        const double all =
            t->mesh.vertex_count - t->schedule.contraction_count;
        share[fine] = kept_right(t) / all;
        finish(t);
    }
    CHECK(fabs(share[0] - share[1]) <= 0.1 * share[0]);
}

/* A ridge whose left side gets heavier: the place nears its plane. */
TEST(guide_moves_the_place_towards_the_heavier_planes)
{
    double before = HUGE_VAL;
    for (int i = 0; i < 5; i++) {
        trial *t = trial_of(shape_make(SHAPE_TERRAIN, 12, 7));
        enc_pricing pricing;
        enc_surface s;
        t->config.placement = PMESH_OPTIMAL;
        t->guide.weights = t->weights;
        t->weights[0] = 0.5f;
        run(t);
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
        enc_star_quadric(&s, pair.child, &child);
        for (int k = 0; k < 3; k++)
            x[k] = offer.place[k] - s.position[pair.child][k];
        const double value = enc_quadric_value(&child, x);
        CHECK(value <= before * 1.01 + 1);
        if (i == 4)
            CHECK(value < 0.5 * before || value < 100);
        before = i == 0 ? value : fmin(before, value);
        enc_pricing_destroy(&t->mesh, &pricing);
        enc_surface_destroy(&s);
        finish(t);
    }
}

/* ---- constraints --------------------------------------------------------- */

/* Vertices of the box's side z = 0, or of its edge y = z = 0 in order. */
static size_t side_of(const trial *t, bool edge, uint32_t *out)
{
    size_t count = 0;
    for (uint32_t v = 0; v < t->shape->input.vertex_count; v++) {
        const double *p = &t->shape->positions[3 * v];
        if (p[2] > 0 || (edge && p[1] > 0))
            continue;
        size_t i = count++;
        for (; edge && i > 0 &&
               t->shape->positions[3 * (size_t)out[i - 1]] > p[0]; i--)
            out[i] = out[i - 1];
        out[i] = v;
    }
    return count;
}

/* All that a bake does is the same: sides are flat and edges straight, so the
 * places that a constraint asks for are the best ones anyway. */
TEST(guide_leaves_the_order_alone_where_places_are_good_already)
{
    uint32_t list[1000];
    for (int kind = 0; kind < 2; kind++)
        for (int placement = 0; placement < 2; placement++) {
            trial *t = trial_of(box(12));
            pmesh_constraint c = { .kind = kind ? PMESH_PLANE : PMESH_CONTOUR,
                                   .vertices = list };
            c.vertex_count = side_of(t, kind == 0, list);
            CHECK(c.vertex_count > 10);
            t->config.placement = (pmesh_placement)placement;
            run(t);
            const enc_schedule plain = t->schedule;
            t->schedule = (enc_schedule){ 0 };
            t->guide.constraints = &c;
            t->guide.constraint_count = 1;
            run(t);
            CHECK(plain.contraction_count == t->schedule.contraction_count);
            for (uint32_t i = 0; i < plain.contraction_count; i++) {
                const enc_contraction *a = &plain.contraction[i];
                const enc_contraction *b = &t->schedule.contraction[i];
                CHECK(a->child == b->child && a->parent == b->parent);
            }
            enc_schedule other = plain;
            enc_schedule_destroy(&other);
            finish(t);
        }
}

/* A constraint never counts as cost: where the place is given, so is that. */
TEST(guide_constraints_are_no_cost)
{
    trial *t = trial_of(shape_make(SHAPE_TORUS, 16, 2));
    uint32_t list[] = { 3, 40, 77, 120 };
    const pmesh_constraint c = { .kind = PMESH_POINT, .vertices = list,
                                 .vertex_count = 4, .importance = 1e6 };
    enc_pricing plain, guided;
    enc_surface s;

    run(t);
    CHECK(enc_pricing_create(&t->mesh, &t->config, &plain) == PMESH_OK);
    enc_mesh first = t->mesh;
    t->mesh = (enc_mesh){ 0 };
    t->guide.constraints = &c;
    t->guide.constraint_count = 1;
    run(t);
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
    finish(t);
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
static double contour_drift(const trial *t, const pmesh_constraint *c)
{
    double worst = 0;
    for (size_t i = 0; i < c->vertex_count; i++) {
        const uint32_t root = root_of(t, c->vertices[i]);
        double p[3], best = HUGE_VAL;
        for (int k = 0; k < 3; k++)
            p[k] = t->schedule.position[root][k];
        for (size_t j = 1; j < c->vertex_count; j++) {
            double a[3], b[3];
            step_place(t, c->vertices[j - 1], a);
            step_place(t, c->vertices[j], b);
            best = fmin(best, line_distance(p, a, b));
        }
        worst = fmax(worst, best);
    }
    return worst / diagonal(t);
}

/* A path along the torus: one of its rings, with bumps. */
static size_t ring_of(const trial *t, uint32_t size, uint32_t *out)
{
    (void)t;
    for (uint32_t i = 0; i <= size; i++)
        out[i] = i % size;
    return size + 1;
}

TEST(guide_contours_stay_on_their_line_to_the_base)
{
    uint32_t list[200];
    trial *t = trial_of(shape_make(SHAPE_TORUS, 24, 4));
    pmesh_constraint c = { .kind = PMESH_CONTOUR, .vertices = list };

    c.vertex_count = ring_of(t, 24, list);
    t->config.base_faces = 120;
    run(t);
    const double plain = contour_drift(t, &c);
    t->guide.constraints = &c;
    t->guide.constraint_count = 1;
    run(t);
    CHECK(plain > 1e-2);
    CHECK(contour_drift(t, &c) <= 1e-3);
    finish(t);
}

TEST(guide_points_stay_where_they_are)
{
    uint32_t list[] = { 7, 150, 333, 411 };
    const pmesh_constraint c = { .kind = PMESH_POINT, .vertices = list,
                                 .vertex_count = 4 };
    for (int placement = 0; placement < 2; placement++) {
        double drift[2] = { 0, 0 };
        trial *t = trial_of(shape_make(SHAPE_TORUS, 24, 4));
        t->guide.constraints = &c;
        t->config.base_faces = 120;
        t->config.placement = (pmesh_placement)placement;
        for (size_t on = 0; on < 2; on++) {
            t->guide.constraint_count = on;
            run(t);
            for (int i = 0; i < 4; i++) {
                double at[3], sum = 0;
                const uint32_t root = root_of(t, list[i]);
                step_place(t, list[i], at);
                for (int k = 0; k < 3; k++)
                    sum += (t->schedule.position[root][k] - at[k]) *
                           (t->schedule.position[root][k] - at[k]);
                drift[on] = fmax(drift[on], sqrt(sum) / diagonal(t));
            }
        }
        CHECK(drift[0] > 1e-2);
        CHECK(drift[1] <= 1e-4);
        finish(t);
    }
}

/* Importance and area scale the pull, and nothing else does. */
TEST(guide_pull_is_importance_times_the_area_around)
{
    for (int twice = 1; twice <= 2; twice++) {
        trial *t = trial_of(box(8));
        uint32_t list[1000];
        pmesh_constraint c = { .kind = PMESH_POINT, .vertices = list,
                               .importance = twice };
        c.vertex_count = side_of(t, false, list);
        t->guide.constraints = &c;
        t->guide.constraint_count = 1;
        run(t);
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
        finish(t);
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

static uint32_t pulled(trial *t)
{
    uint32_t count = 0;
    run(t);
    for (uint32_t v = 0; v < t->mesh.vertex_count; v++)
        count += t->mesh.guide->pull[v].weight > 0;
    return count;
}

TEST(guide_finds_contours_by_itself)
{
    trial *t = trial_of(box(8));
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
    finish(t);
}

TEST(guide_finds_seams_of_attributes)
{
    shape_mesh *sphere = shape_make(SHAPE_SPHERE, 12, 1);
    const size_t attributes = sphere->input.attribute_count;
    trial *t = trial_of(sphere);
    sphere->input.attribute_count = attributes; /* coordinates with a seam */
    t->guide.seams = 1;
    const uint32_t on_seam = pulled(t);
    CHECK(on_seam > 5 && on_seam < t->mesh.vertex_count / 2);
    finish(t);
}

/* ---- locks and segments -------------------------------------------------- */

TEST(guide_locked_vertices_stay_at_their_place)
{
    for (int placement = 0; placement < 2; placement++) {
        trial *t = trial_of(shape_make(SHAPE_TORUS, 24, 6));
        t->config.placement = (pmesh_placement)placement;
        t->guide.locks = t->locks;
        for (uint32_t v = 0; v < t->shape->input.vertex_count; v += 50)
            t->locks[v] = 1;
        run(t);
        for (uint32_t v = 0; v < t->mesh.vertex_count; v += 50) {
            CHECK(t->schedule.vertex_end[v] == ENC_NONE);
            CHECK(distance(t->schedule.position[v], t->mesh.position[v]) == 0);
        }
        finish(t);
    }
}

TEST(guide_segments_are_never_joined_and_keep_their_shares)
{
    trial *t = trial_of(shape_make(SHAPE_TORUS, 40, 6));
    const double shares[3] = { 0, 0.6, 0.1 };
    uint32_t size[3] = { 0 }, all = 0;
    const double *p = t->shape->positions;

    for (size_t v = 0; v < t->shape->input.vertex_count; v++)
        t->segments[v] = p[3 * v] > 0.9 ? 1 : p[3 * v] < -0.9 ? 2 : 0;
    t->guide.segments = t->segments;
    t->guide.shares = shares;
    t->guide.segment_count = 3;
    t->config.base_faces = 300;
    run(t);
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
    finish(t);
}

/* ---- the rest ------------------------------------------------------------ */

TEST(guide_out_of_range_is_refused)
{
    trial *t = trial_of(box(4));
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
    finish(t);
}

/* Weights that are no numbers, or beyond the range, do no harm. */
TEST(guide_takes_any_weight)
{
    trial *t = trial_of(shape_make(SHAPE_SOUP, 20, 3));
    const float odd[] = { NAN, -INFINITY, INFINITY, -1, 2, 0.5f };
    for (size_t v = 0; v < t->shape->input.vertex_count; v++)
        t->weights[v] = odd[v % 6];
    t->guide.weights = t->weights;
    for (int placement = 0; placement < 2; placement++) {
        t->config.placement = (pmesh_placement)placement;
        shape_bytes bytes = bake(t);
        pmesh_status status;
        pmesh_decoder *dec =
            shape_decode(bytes.data, bytes.size, bytes.size, &status);
        CHECK(status == PMESH_OK && shape_view_sound(dec));
        pmesh_decoder_destroy(dec);
        free(bytes.data);
    }
    finish(t);
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
    trial *t = trial_of(box(3));
    uint32_t list[100];
    pmesh_constraint c = { .kind = PMESH_PLANE, .vertices = list };
    const double share = 0.1;
    pmesh_status status = PMESH_E_MEMORY;

    c.vertex_count = side_of(t, false, list);
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
    finish(t);
}
