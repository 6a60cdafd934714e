/* SPDX-License-Identifier: MIT */
#include "tests/unit/guide_trial.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/unit/test.h"

guide_trial *guide_trial_of(shape_mesh *shape)
{
    guide_trial *t = calloc(1, sizeof *t);
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

void guide_forget(guide_trial *t)
{
    enc_schedule_destroy(&t->schedule);
    enc_mesh_destroy(&t->mesh);
}

void guide_run(guide_trial *t)
{
    pmesh_encode_report report = { 0 };

    guide_forget(t);
    CHECK(enc_mesh_import(&t->shape->input, &t->config, NULL, &t->mesh,
                          &report) ==
          PMESH_OK);
    CHECK(enc_schedule_build(&t->mesh, &t->config, 0, &t->schedule) ==
          PMESH_OK);
}

void guide_finish(guide_trial *t)
{
    guide_forget(t);
    shape_free(t->shape);
    free(t->weights);
    free(t->locks);
    free(t->segments);
    free(t);
}

shape_bytes guide_bake(guide_trial *t)
{
    shape_bytes bytes;
    pmesh_encode_report report;
    CHECK(shape_bake(t->shape, &t->config, &bytes, &report) == PMESH_OK);
    return bytes;
}

bool guide_same_bytes(shape_bytes a, shape_bytes b)
{
    const bool same = a.size == b.size && memcmp(a.data, b.data, a.size) == 0;
    free(a.data);
    free(b.data);
    return same;
}

uint32_t guide_root_of(const guide_trial *t, uint32_t v)
{
    while (t->schedule.vertex_end[v] != ENC_NONE)
        v = t->schedule.contraction[t->schedule.vertex_end[v]].parent;
    return v;
}

double guide_distance(const int32_t a[3], const int32_t b[3])
{
    double sum = 0;
    for (int k = 0; k < 3; k++)
        sum += (double)(a[k] - b[k]) * (a[k] - b[k]);
    return sqrt(sum);
}

double guide_diagonal(const guide_trial *t)
{
    const int32_t zero[3] = { 0, 0, 0 };
    return guide_distance(t->mesh.bounds, zero);
}

void guide_step_place(const guide_trial *t, uint32_t v, double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = (t->shape->positions[3 * v + (uint32_t)k] -
                  t->mesh.grid.origin[k]) /
                 t->mesh.grid.step;
}

shape_mesh *guide_box(uint32_t n)
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

size_t guide_side_of(const guide_trial *t, bool edge, uint32_t *out)
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
