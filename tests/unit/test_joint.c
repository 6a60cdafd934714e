/* SPDX-License-Identifier: MIT */
#include "encoder/enc_heap.h"
#include "encoder/enc_joint.h"
#include "encoder/enc_lod_place.h"
#include "format/alloc.h"
#include "tests/unit/shapes.h"
#include "tests/unit/test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_N = 3 + ENC_JOINT_MAX };

static double noise(uint32_t *seed)
{
    return shape_random(seed, 20001) / 10000.0 - 1;
}

/* A triangle in n dimensions, its corner 0 at the origin. */
typedef struct triangle {
    unsigned m;
    double p[MAX_N], q[MAX_N];
} triangle;

static triangle random_triangle(unsigned m, uint32_t *seed)
{
    triangle t = { .m = m };

    for (unsigned i = 0; i < 3 + m; i++) {
        t.p[i] = noise(seed);
        t.q[i] = noise(seed);
    }
    return t;
}

static void add(const triangle *t, enc_quadric *q, double *tail)
{
    enc_joint_add_face(q, tail, t->m, t->p, t->p + 3, t->q, t->q + 3);
}

static double area(const triangle *t)
{
    double square = 0;

    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const double n = t->p[j] * t->q[k] - t->p[k] * t->q[j];
        square += n * n;
    }
    return sqrt(square) / 2;
}

static double dot(const double *a, const double *b, unsigned n)
{
    double sum = 0;
    for (unsigned i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

/* By the normal equations of x = u p + v q: another way than the code's. */
static double distance2(const triangle *t, const double *x)
{
    const unsigned n = 3 + t->m;
    const double pp = dot(t->p, t->p, n), qq = dot(t->q, t->q, n);
    const double pq = dot(t->p, t->q, n), px = dot(t->p, x, n);
    const double qx = dot(t->q, x, n), det = pp * qq - pq * pq;
    const double u = (px * qq - qx * pq) / det, v = (qx * pp - px * pq) / det;
    double rest[MAX_N];

    for (unsigned i = 0; i < n; i++)
        rest[i] = x[i] - u * t->p[i] - v * t->q[i];
    return dot(rest, rest, n);
}

TEST(joint_quadric_is_the_squared_distance_to_a_plane_in_n_dimensions)
{
    uint32_t seed = 1;

    for (unsigned m = 0; m <= ENC_JOINT_MAX; m++) {
        const triangle t = random_triangle(m, &seed);
        double tail[ENC_JOINT_TAIL_MAX] = { 0 }, x[MAX_N];
        enc_quadric q = { .c = 0 };

        add(&t, &q, tail);
        for (unsigned i = 0; i < 3 + m; i++)
            x[i] = 3 * noise(&seed);
        const double want = area(&t) * distance2(&t, x);
        CHECK(fabs(enc_joint_value(&q, tail, m, x, x + 3) - want) <
              1e-9 * (1 + want));
        CHECK(fabs(q.weight - area(&t)) < 1e-12);
        CHECK(enc_joint_value(&q, tail, m, t.p, t.p + 3) < 1e-12);
    }
}

TEST(joint_quadric_of_a_face_without_area_is_nothing)
{
    double tail[ENC_JOINT_TAIL_MAX] = { 0 };
    const double p[5] = { 1, 2, 3, 0, 1 }, far[5] = { 9, 9, 9, 9, 9 };
    const double none[5] = { 0, 0, 0, 4, 4 };
    enc_quadric q = { .c = 0 };

    enc_joint_add_face(&q, tail, 2, p, p + 3, p, p + 3);
    enc_joint_add_face(&q, tail, 2, p, p + 3, none, none + 3);
    CHECK(q.weight == 0);
    CHECK(enc_joint_value(&q, tail, 2, far, far + 3) == 0);
}

TEST(joint_quadrics_add_up_about_any_centre)
{
    uint32_t seed = 2;

    for (unsigned m = 0; m <= 9; m++) {
        double tail[2][ENC_JOINT_TAIL_MAX] = { { 0 } };
        double sum_tail[ENC_JOINT_TAIL_MAX] = { 0 };
        double away[2][MAX_N], x[MAX_N], want = 0;
        enc_quadric q[2] = { { .c = 0 }, { .c = 0 } }, sum = { .c = 0 };

        for (unsigned i = 0; i < 3 + m; i++)
            x[i] = noise(&seed);
        for (int k = 0; k < 2; k++) {
            const triangle t = random_triangle(m, &seed);
            double seen[MAX_N];
            add(&t, &q[k], tail[k]);
            for (unsigned i = 0; i < 3 + m; i++) {
                away[k][i] = noise(&seed);
                seen[i] = x[i] - away[k][i];
            }
            enc_joint_add(&sum, sum_tail, &q[k], tail[k], m, away[k],
                          away[k] + 3);
            want += enc_joint_value(&q[k], tail[k], m, seen, seen + 3);
        }
        CHECK(fabs(enc_joint_value(&sum, sum_tail, m, x, x + 3) - want) < 1e-9);
    }
}

TEST(joint_reduction_is_the_least_value_over_all_attributes)
{
    uint32_t seed = 3;

    for (unsigned m = 1; m <= 9; m++) {
        double tail[ENC_JOINT_TAIL_MAX] = { 0 }, x[3], s[MAX_N], away[MAX_N];
        double sum_tail[ENC_JOINT_TAIL_MAX] = { 0 };
        enc_quadric q = { .c = 0 }, sum = { .c = 0 };
        enc_joint_solver solver;

        for (int k = 0; k < 12; k++) {
            const triangle t = random_triangle(m, &seed);
            add(&t, &q, tail);
        }
        for (unsigned i = 0; i < 3 + m; i++)
            away[i] = noise(&seed);
        enc_joint_add(&sum, sum_tail, &q, tail, m, away, away + 3);
        for (int i = 0; i < 3; i++)
            x[i] = noise(&seed);
        enc_quadric reduced = sum;
        enc_joint_reduce(&reduced, sum_tail, m, &solver);
        enc_joint_attributes(&solver, m, x, s);
        const double least = enc_joint_value(&sum, sum_tail, m, x, s);
        CHECK(fabs(enc_quadric_value(&reduced, x) - least) < 1e-4 * least);
        for (int trial = 0; trial < 20; trial++) {
            double other[MAX_N];
            for (unsigned i = 0; i < m; i++)
                other[i] = s[i] + 0.1 * noise(&seed);
            CHECK(enc_joint_value(&sum, sum_tail, m, x, other) >=
                  least * (1 - 1e-5));
        }
    }
}

/* Planes enough for a minimum, or too few: a line or a plane of minima. */
static enc_quadric random_quadric(unsigned planes, uint32_t *seed)
{
    enc_quadric sum = { .c = 0 };

    for (unsigned i = 0; i < planes; i++) {
        enc_quadric q = { .c = 0 };
        double n[3], at[3];
        for (int k = 0; k < 3; k++) {
            n[k] = noise(seed);
            at[k] = 0.3 * noise(seed);
        }
        enc_quadric_add_plane(&q, n, 1 + noise(seed) / 2);
        enc_quadric_add(&sum, &q, at);
    }
    return sum;
}

TEST(placement_never_costs_more_than_the_ends_and_the_middle)
{
    uint32_t seed = 4;

    for (int trial = 0; trial < 4000; trial++) {
        const enc_quadric q = random_quadric(shape_random(&seed, 6), &seed);
        const double middle[3] = { 0, 0, 0 };
        enc_plane keep = { .offset = noise(&seed) };
        double half[3], end[3], x[3];

        for (int i = 0; i < 3; i++) {
            half[i] = trial % 50 ? noise(&seed) : 0;
            end[i] = -half[i];
            keep.n[i] = trial % 3 ? noise(&seed) : 0;
        }
        const double best =
            fmin(enc_quadric_value(&q, middle),
                 fmin(enc_quadric_value(&q, half), enc_quadric_value(&q, end)));
        for (int rule = PMESH_PLACE_OPTIMAL; rule <= PMESH_PLACE_ENDPOINT;
             rule++) {
            enc_lod_place((pmesh_place)rule, &q, half, trial % 2 ? &keep : NULL,
                          x);
            CHECK(isfinite(x[0]) && isfinite(x[1]) && isfinite(x[2]));
            if (rule == PMESH_PLACE_MIDPOINT)
                CHECK(x[0] == 0 && x[1] == 0 && x[2] == 0);
            else
                CHECK(enc_quadric_value(&q, x) <= best);
        }
    }
}

TEST(placement_finds_where_planes_meet)
{
    static const double normals[3][3] = { { 1, 0, 0 },
                                          { 0, 1, 0 },
                                          { 0, 1, 1 } };
    const double half[3] = { 0.5, 0, 0 }, corner[3] = { 0.2, 0.3, -0.4 };
    enc_quadric q = { .c = 0 }, sum = { .c = 0 };
    double x[3];

    for (int i = 0; i < 3; i++)
        enc_quadric_add_plane(&q, normals[i], 1);
    enc_quadric_add(&sum, &q, corner);
    enc_lod_place(PMESH_PLACE_OPTIMAL, &sum, half, NULL, x);
    for (int i = 0; i < 3; i++)
        CHECK(fabs(x[i] - corner[i]) < 1e-3);
    /* On the line only the first plane decides where. */
    enc_lod_place(PMESH_PLACE_LINE, &sum, half, NULL, x);
    CHECK(fabs(x[0] - 0.2) < 1e-12 && x[1] == 0 && x[2] == 0);
}

TEST(heap_gives_the_least_cost_and_of_equals_the_least_number)
{
    enum { N = 500 };
    const pmesh_allocator a = pmesh_allocator_resolve((pmesh_allocator){ 0 });
    double cost[N];
    bool there[N];
    uint32_t seed = 5, left = 0;
    enc_heap heap;
    enc_heap_entry last = { -1, 0 }, top;

    CHECK(enc_heap_create(&a, N, &heap) == PMESH_OK);
    for (int i = 0; i < N; i++)
        there[i] = false;
    for (int step = 0; step < 4 * N; step++) {
        const uint32_t i = shape_random(&seed, N);
        if (shape_random(&seed, 5) == 0) {
            enc_heap_remove(&heap, i);
            there[i] = false;
        } else {
            cost[i] = shape_random(&seed, 40);
            enc_heap_put(&heap, i, cost[i]);
            there[i] = true;
        }
    }
    for (int i = 0; i < N; i++)
        left += there[i];
    CHECK(heap.count == left);
    while (enc_heap_pop(&heap, &top)) {
        CHECK(there[top.item] && cost[top.item] == top.cost);
        CHECK(top.cost > last.cost ||
              (top.cost == last.cost && top.item > last.item));
        there[top.item] = false;
        last = top;
        left--;
    }
    CHECK(left == 0);
    enc_heap_destroy(&heap);
}
