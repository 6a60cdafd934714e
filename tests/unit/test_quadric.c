/* SPDX-License-Identifier: MIT */
#include "encoder/enc_quadric.h"
#include "tests/unit/test.h"

#include <math.h>
#include <stddef.h>

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
