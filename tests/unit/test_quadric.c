/* SPDX-License-Identifier: MIT */
#include "encoder/enc_quadric.h"
#include "tests/unit/shapes.h"
#include "tests/unit/test.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

TEST(quadric_measures_distance_to_its_planes)
{
    const double normal[3] = { 0, 0, 5 }, away[3] = { 7, -3, 2 };
    const double offset[3] = { 0, 0, 1 };
    enc_quadric q = { .c = 0 }, sum = { .c = 0 };

    enc_quadric_add_plane(&q, normal, 3);
    CHECK(enc_quadric_value(&q, away) == 3 * 2 * 2);
    enc_quadric_add(&sum, &q, offset);
    enc_quadric_add(&sum, &q, offset);
    CHECK(enc_quadric_value(&sum, away) == 2 * 3 * 1 * 1);
    CHECK(sum.weight == 6);
}

TEST(quadric_minimum_is_where_planes_meet)
{
    static const double normals[3][3] = { { 1, 0, 0 },
                                          { 0, 1, 0 },
                                          { 0, 1, 1 } };
    const double corner[3] = { 3, -2, 5 };
    enc_quadric q = { .c = 0 }, sum = { .c = 0 };
    double x[3];

    CHECK(!enc_quadric_minimum(&q, NULL, x));
    for (int i = 0; i < 3; i++)
        enc_quadric_add_plane(&q, normals[i], 1);
    enc_quadric_add(&sum, &q, corner);
    CHECK(enc_quadric_minimum(&sum, NULL, x));
    for (int i = 0; i < 3; i++)
        CHECK(fabs(x[i] - corner[i]) < 1e-2);

    const enc_plane keep = { { 0, 0, 2 }, 8 };
    CHECK(enc_quadric_minimum(&sum, &keep, x));
    CHECK(fabs(x[2] - 4) < 1e-9);
}

static double noise(uint32_t *seed)
{
    return shape_random(seed, 20001) / 10000.0 - 1;
}

TEST(quadric_is_eleven_numbers)
{
    /* The ten of a symmetric 4 x 4 matrix, and the weight. */
    CHECK(sizeof(enc_quadric) == 11 * sizeof(double));
}

TEST(quadric_equals_the_product_with_a_4_by_4_matrix)
{
    uint32_t seed = 1;
    double k[4][4] = { { 0 } };
    enc_quadric sum = { .c = 0 };

    for (int plane = 0; plane < 5; plane++) {
        double p[4] = { noise(&seed), noise(&seed), noise(&seed), 0 };
        const double at[3] = { noise(&seed), noise(&seed), noise(&seed) };
        const double length = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        enc_quadric q = { .c = 0 };
        for (int i = 0; i < 3; i++) {
            p[i] /= length;
            p[3] -= p[i] * at[i];
        }
        for (int i = 0; i < 4; i++)
            for (int j = 0; j < 4; j++)
                k[i][j] += p[i] * p[j];
        enc_quadric_add_plane(&q, p, 1);
        enc_quadric_add(&sum, &q, at);
    }
    for (int trial = 0; trial < 10; trial++) {
        const double v[4] = { noise(&seed), noise(&seed), noise(&seed), 1 };
        double want = 0;
        for (int i = 0; i < 4; i++)
            for (int j = 0; j < 4; j++)
                want += v[i] * k[i][j] * v[j];
        CHECK(fabs(enc_quadric_value(&sum, v) - want) < 1e-12);
    }
}

TEST(quadrics_add_up_in_any_order)
{
    enum { N = 16 };
    const double none[3] = { 0, 0, 0 }, x[3] = { 0.3, -2, 1.5 };
    enc_quadric q[N], first = { .c = 0 };
    uint32_t seed = 2;

    memset(q, 0, sizeof q);
    for (int i = 0; i < N; i++) {
        const double n[3] = { noise(&seed), noise(&seed), noise(&seed) };
        const double at[3] = { noise(&seed), noise(&seed), noise(&seed) };
        enc_quadric plane = { .c = 0 };
        enc_quadric_add_plane(&plane, n, 1);
        enc_quadric_add(&q[i], &plane, at);
        enc_quadric_add(&first, &q[i], none);
    }
    const double want = enc_quadric_value(&first, x);
    for (int trial = 0; trial < 20; trial++) { /* random trees of sums */
        enc_quadric tree[N];
        memcpy(tree, q, sizeof q);
        for (uint32_t left = N; left > 1; left--) {
            const uint32_t a = shape_random(&seed, left - 1);
            enc_quadric_add(&tree[a], &tree[left - 1], none);
        }
        CHECK(fabs(enc_quadric_value(&tree[0], x) - want) < 1e-12 * want);
    }
}

TEST(quadric_of_a_triangle_is_that_of_its_quarters)
{
    const double n[3] = { 1, -2, 3 }, x[3] = { 4, 5, 6 };
    enc_quadric whole = { .c = 0 }, quarters = { .c = 0 };

    enc_quadric_add_plane(&whole, n, 8);
    for (int i = 0; i < 4; i++)
        enc_quadric_add_plane(&quarters, n, 2);
    CHECK(enc_quadric_value(&whole, x) == enc_quadric_value(&quarters, x));
    CHECK(whole.weight == quarters.weight);
}

/* Jacobi's rotations: the matrix becomes diagonal, `vector` its columns. */
static void eigen(const enc_quadric *q, double value[3], double vector[3][3])
{
    double m[3][3] = { { q->a[0], q->a[1], q->a[2] },
                       { q->a[1], q->a[3], q->a[4] },
                       { q->a[2], q->a[4], q->a[5] } };

    memset(vector, 0, 9 * sizeof(double));
    for (int i = 0; i < 3; i++)
        vector[i][i] = 1;
    for (int step = 0; step < 60; step++) {
        const int i = step % 3, j = (i + 1) % 3;
        const double t = 0.5 * atan2(2 * m[i][j], m[j][j] - m[i][i]);
        const double c = cos(t), s = sin(t);
        for (int k = 0; k < 3; k++) {
            const double a = m[k][i], b = m[k][j];
            m[k][i] = c * a - s * b;
            m[k][j] = s * a + c * b;
        }
        for (int k = 0; k < 3; k++) {
            const double a = m[i][k], b = m[j][k], d = vector[k][i];
            m[i][k] = c * a - s * b;
            m[j][k] = s * a + c * b;
            vector[k][i] = c * d - s * vector[k][j];
            vector[k][j] = s * d + c * vector[k][j];
        }
    }
    for (int i = 0; i < 3; i++)
        value[i] = m[i][i];
}

TEST(quadric_of_a_plane_a_crease_a_corner_has_rank_one_two_three)
{
    static const double normals[4][3] = {
        { 0, 0, 1 }, { 0, 0, 2 }, { 0, 1, 1 }, { 1, 1, 0 }
    };
    static const int planes[3] = { 2, 3, 4 };

    for (int rank = 1; rank <= 3; rank++) {
        enc_quadric q = { .c = 0 };
        double value[3], vector[3][3];
        int count = 0;
        for (int i = 0; i < planes[rank - 1]; i++)
            enc_quadric_add_plane(&q, normals[i], 1);
        eigen(&q, value, vector);
        for (int i = 0; i < 3; i++)
            count += value[i] > 1e-9;
        CHECK(count == rank);
    }
}

/* The point of a torus, radii 3 and 1, and its unit normal. */
static void torus(double u, double v, double normal[3])
{
    normal[0] = cos(v) * cos(u);
    normal[1] = cos(v) * sin(u);
    normal[2] = sin(v);
}

TEST(quadric_is_elongated_where_a_torus_bends_least)
{
    for (int k = 0; k < 8; k++) {
        const double u = 0.7 * k, v = 0.35 * (k - 4), step = 0.02;
        enc_quadric q = { .c = 0 };
        double value[3], vector[3][3];

        /* Patches of equal size in space around (u, v). */
        for (int i = -4; i <= 4; i++)
            for (int j = -4; j <= 4; j++) {
                double n[3];
                torus(u + step * i / (3 + cos(v)), v + step * j, n);
                enc_quadric_add_plane(&q, n, 1);
            }
        eigen(&q, value, vector);
        int least = 0, most = 0;
        for (int i = 1; i < 3; i++) {
            least = value[i] < value[least] ? i : least;
            most = value[i] > value[most] ? i : most;
        }
        /* Around the axis it bends less than around the tube. */
        const double along = -sin(u) * vector[0][least] +
                             cos(u) * vector[1][least];
        double n[3];
        torus(u, v, n);
        const double up = n[0] * vector[0][most] + n[1] * vector[1][most] +
                          n[2] * vector[2][most];
        CHECK(fabs(along) > cos(5 * 3.14159265 / 180));
        CHECK(fabs(up) > cos(5 * 3.14159265 / 180));
    }
}
