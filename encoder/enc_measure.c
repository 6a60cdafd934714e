/* SPDX-License-Identifier: MIT */
#include "encoder/enc_measure.h"

#include <math.h>

#include "format/alloc.h"
#include "format/layout.h"

/* Points on each of the two surfaces, and of these in a thread's turn. */
enum { SAMPLES = 1 << 14, PART = 1 << 9 };

typedef struct sums {
    double square, most; /* both of squares */
} sums;

pmesh_status enc_measure_create(const enc_mesh *mesh, enc_measure *out)
{
    const enc_triangles all = { mesh->vertex,
                                (const int32_t(*)[3])mesh->position,
                                mesh->face_count };

    *out = (enc_measure){ .pool = mesh->pool };
    const pmesh_status status =
        enc_nearest_create(&mesh->allocator, &all, &out->full);
    if (status != PMESH_OK)
        return status;
    out->sample = pmesh_alloc(&mesh->allocator, SAMPLES, sizeof *out->sample);
    return out->sample ? PMESH_OK : PMESH_E_MEMORY;
}

void enc_measure_destroy(enc_measure *m)
{
    if (m->sample)
        pmesh_release(&m->full.allocator, m->sample, SAMPLES,
                      sizeof *m->sample);
    enc_nearest_destroy(&m->full);
}

static void load_corners(const enc_triangles *m, uint32_t face,
                         double corner[3][3])
{
    for (uint32_t k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            corner[k][i] = m->position[m->corner[3 * face + k]][i];
}

static double area_of(const enc_triangles *m, uint32_t face)
{
    double c[3][3], n[3];

    load_corners(m, face, c);
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        n[i] = (c[1][j] - c[0][j]) * (c[2][k] - c[0][k]) -
               (c[1][k] - c[0][k]) * (c[2][j] - c[0][j]);
    }
    return sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

/* Two sequences that fill a square evenly (Roberts 2018), folded to a
 * triangle. */
static void place_sample(const enc_triangles *m, uint32_t face, uint32_t i,
                         double x[3])
{
    double c[3][3], u = 0.7548776662466927 * i, v = 0.5698402909980532 * i;

    u -= (double)(int64_t)u;
    v -= (double)(int64_t)v;
    if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
    }
    load_corners(m, face, c);
    for (int k = 0; k < 3; k++)
        x[k] = c[0][k] + u * (c[1][k] - c[0][k]) + v * (c[2][k] - c[0][k]);
}

/* Points on `mesh`, each for the same area; returns their number. */
static uint32_t place_samples(const enc_triangles *mesh, double (*sample)[3])
{
    double total = 0, passed = 0;
    uint32_t i = 0;

    for (uint32_t f = 0; f < mesh->face_count; f++)
        total += area_of(mesh, f);
    for (uint32_t f = 0; f < mesh->face_count && i < SAMPLES; f++) {
        passed += area_of(mesh, f);
        for (; i < SAMPLES && (i + 0.5) * total < passed * SAMPLES; i++)
            place_sample(mesh, f, i, sample[i]);
    }
    return i;
}

typedef struct queries {
    const enc_nearest *to;
    double (*sample)[3]; /* the square takes the place of the first number */
    uint32_t count;
} queries;

static void answer(void *user, uint32_t part, unsigned worker)
{
    const queries *q = user;
    const uint32_t end = (part + 1) * PART < q->count ? (part + 1) * PART
                                                      : q->count;
    (void)worker;
    for (uint32_t i = part * PART; i < end; i++)
        q->sample[i][0] = enc_nearest_square(q->to, q->sample[i]);
}

static sums one_way(const enc_measure *m, const enc_triangles *mesh,
                    const enc_nearest *to)
{
    queries q = { to, m->sample, place_samples(mesh, m->sample) };
    sums s = { 0, 0 };

    enc_pool_run(m->pool, (q.count + PART - 1) / PART, answer, &q);
    for (uint32_t i = 0; i < q.count; i++) {
        s.square += q.sample[i][0];
        s.most = q.sample[i][0] > s.most ? q.sample[i][0] : s.most;
    }
    return s;
}

static uint32_t in_units(double square)
{
    return (uint32_t)ceil(sqrt(square) * PMESH_MEASURE_UNIT);
}

pmesh_status enc_measure_level(const enc_measure *m, const enc_triangles *level,
                               uint32_t *rms, uint32_t *most)
{
    enc_nearest there;

    const pmesh_status status =
        enc_nearest_create(&m->full.allocator, level, &there);
    if (status != PMESH_OK)
        return status;
    const sums forth = one_way(m, &m->full.mesh, &there);
    const sums back = one_way(m, level, &m->full);
    enc_nearest_destroy(&there);
    *rms = in_units((forth.square + back.square) / (2.0 * SAMPLES));
    *most = in_units(forth.most > back.most ? forth.most : back.most);
    return PMESH_OK;
}
