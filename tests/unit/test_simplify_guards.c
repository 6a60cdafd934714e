/* SPDX-License-Identifier: MIT */
/* What no contraction may do: turn faces over, lose volume, let the input stick
 * out of a hull. */
#include <math.h>
#include <stdlib.h>

#include "tests/unit/lods.h"
#include "tests/unit/shapes.h"
#include "tests/unit/test.h"

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* With its faces outside. */
static lods *torus(uint32_t size)
{
    shape_mesh *shape = shape_make(SHAPE_TORUS, size, 5);
    lods *l = lods_copy(shape->positions, shape->input.vertex_count,
                        shape->indices, shape->input.face_count);

    for (size_t f = 0; f < l->in.face_count; f++) {
        const uint32_t corner = l->tri[3 * f];
        l->tri[3 * f] = l->tri[3 * f + 1];
        l->tri[3 * f + 1] = corner;
    }
    CHECK(lods_volume(l->xyz, l->tri, l->in.face_count) > 0);
    shape_free(shape);
    return l;
}

static void input_normal(const lods *l, size_t face, double out[3])
{
    const double *p[3];
    double a[3], b[3];

    for (int k = 0; k < 3; k++)
        p[k] = &l->xyz[3 * (size_t)l->tri[3 * face + (size_t)k]];
    for (int i = 0; i < 3; i++) {
        a[i] = p[1][i] - p[0][i];
        b[i] = p[2][i] - p[0][i];
    }
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* The least cosine between a face that is left and what it was. */
static double least_cosine(const lods *l)
{
    double least = 1;

    for (size_t f = 0; f < l->out.face_count; f++) {
        double n[3], old[3];
        lods_normal(l, f, n);
        input_normal(l, l->out.face_source[f], old);
        least = fmin(least, dot(n, old) / sqrt(dot(n, n) * dot(old, old)));
    }
    return least;
}

TEST(simplify_turns_no_face_further_in_all_than_it_may)
{
    lods *l = torus(24);

    l->options.faces = l->in.face_count / 40;
    CHECK(lods_run(l) == PMESH_OK);
    const double free_turn = least_cosine(l);
    l->options.turn_cosine = 0.8;
    CHECK(lods_run(l) == PMESH_OK);
    CHECK(least_cosine(l) > 0.8 - 1e-6);
    CHECK(free_turn < 0.8 - 0.05);
    l->options.turn_cosine = 1;
    CHECK(lods_run(l) == PMESH_E_ARGUMENT);
    lods_free(l);
}

/* Of each face that both results have. */
static double least_step(const lods *l, const double (*before)[3])
{
    double least = 1;

    for (size_t f = 0; f < l->out.face_count; f++) {
        const double *old = before[l->out.face_source[f]];
        double n[3];
        lods_normal(l, f, n);
        least = fmin(least, dot(n, old) / sqrt(dot(n, n) * dot(old, old)));
    }
    return least;
}

TEST(simplify_turns_no_face_by_more_than_78_degrees_at_once)
{
    lods *l = lods_sphere(8);
    double(*before)[3] = calloc(l->in.face_count, sizeof *before);
    size_t faces = l->in.face_count;

    for (size_t f = 0; f < faces; f++)
        input_normal(l, f, before[f]);
    while (faces > 12) {
        l->options.faces = faces - 1;
        CHECK(lods_run(l) == PMESH_OK);
        CHECK(l->out.face_count < faces);
        CHECK(least_step(l, (const double(*)[3])before) > 0.2 - 1e-9);
        faces = l->out.face_count;
        for (size_t f = 0; f < faces; f++)
            lods_normal(l, f, before[l->out.face_source[f]]);
    }
    free(before);
    lods_free(l);
}

TEST(simplify_keeps_the_volume_where_it_has_to)
{
    for (int hole = 0; hole < 2; hole++) {
        lods *l = hole ? torus(16) : lods_sphere(16);
        const double volume = lods_volume(l->xyz, l->tri, l->in.face_count);
        l->options.placement = PMESH_PLACE_VOLUME;
        for (size_t part = 2; part <= 16; part *= 2) {
            l->options.faces = l->in.face_count / part;
            CHECK(lods_run(l) == PMESH_OK);
            CHECK(l->out.face_count <= l->options.faces);
            CHECK(fabs(lods_volume(l->out.positions, l->out.indices,
                                   l->out.face_count) /
                           volume -
                       1) < 1e-9);
        }
        lods_free(l);
    }
}

/* How often the result winds around p: 1 inside, 0 outside (van Oosterom and
 * Strackee, The Solid Angle of a Plane Triangle, 1983). */
static double winding(const lods *l, const double p[3])
{
    double sum = 0;

    for (size_t f = 0; f < l->out.face_count; f++) {
        double r[3][3], size[3];
        for (size_t k = 0; k < 3; k++) {
            const size_t v = l->out.indices[3 * f + k];
            for (size_t i = 0; i < 3; i++)
                r[k][i] = l->out.positions[3 * v + i] - p[i];
            size[k] = sqrt(dot(r[k], r[k]));
        }
        const double n[3] = { r[1][1] * r[2][2] - r[1][2] * r[2][1],
                              r[1][2] * r[2][0] - r[1][0] * r[2][2],
                              r[1][0] * r[2][1] - r[1][1] * r[2][0] };
        sum += 2 *
               atan2(dot(r[0], n),
                     size[0] * size[1] * size[2] + dot(r[0], r[1]) * size[2] +
                         dot(r[1], r[2]) * size[0] + dot(r[2], r[0]) * size[1]);
    }
    return sum / (4 * 3.14159265358979);
}

/* Middles of the input's faces, a little inside, that are outside. */
static size_t outside(const lods *l)
{
    size_t count = 0;

    for (size_t f = 0; f < l->in.face_count; f++) {
        double n[3], p[3] = { 0, 0, 0 };
        input_normal(l, f, n);
        const double size = sqrt(dot(n, n));
        for (size_t i = 0; i < 3; i++) {
            for (size_t k = 0; k < 3; k++)
                p[i] += l->xyz[3 * (size_t)l->tri[3 * f + k] + i] / 3;
            p[i] -= 1e-7 * n[i] / size;
        }
        count += winding(l, p) < 0.5;
    }
    return count;
}

TEST(simplify_hull_encloses_the_input_at_every_level)
{
    for (int hole = 0; hole < 2; hole++) {
        lods *l = hole ? torus(12) : lods_sphere(12);
        double volume = lods_volume(l->xyz, l->tri, l->in.face_count);
        l->options.placement = PMESH_PLACE_HULL;
        for (size_t part = 2; part <= 16; part *= 2) {
            l->options.faces = l->in.face_count / part;
            CHECK(lods_run(l) == PMESH_OK);
            CHECK(outside(l) == 0);
            const double grown = lods_volume(l->out.positions, l->out.indices,
                                             l->out.face_count);
            CHECK(grown > volume * (1 - 1e-12));
            volume = grown;
        }
        CHECK(l->out.face_count < l->in.face_count / 4);
        l->options.placement = PMESH_PLACE_OPTIMAL; /* can the test fail? */
        CHECK(lods_run(l) == PMESH_OK);
        CHECK(outside(l) > 0);
        lods_free(l);
    }
}
