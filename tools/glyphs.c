/* SPDX-License-Identifier: MIT */
#include "tools/glyphs.h"

#include <math.h>
#include <stdlib.h>

#include "encoder/pmesh_inspect.h"
#include "tools/topology.h"
#include "tools/trig.h"

/* A ball of two poles and rings between them. */
enum { RINGS = 5, SPOKES = 10, BALL_VERTICES = 2 + RINGS * SPOKES,
       BALL_FACES = 2 * RINGS * SPOKES };

#define LARGEST (1.0 / 60) /* of the diagonal */
#define DISTANCE (1.0 / 400)

static void put_vertex(double *out, const pmesh_ellipsoid *e, const double u[3])
{
    for (int k = 0; k < 3; k++) {
        out[k] = e->center[k];
        for (int i = 0; i < 3; i++)
            out[k] += u[i] * e->radius[i] * e->axis[i][k];
    }
}

static void put_ball(asset *mesh, const pmesh_ellipsoid *e)
{
    const uint32_t first = (uint32_t)mesh->vertex_count;
    const double top[3] = { 0, 0, 1 }, bottom[3] = { 0, 0, -1 };
    double *p = mesh->positions + 3 * (size_t)first;
    uint32_t *f = mesh->indices + 3 * mesh->face_count;

    put_vertex(p, e, bottom);
    put_vertex(p + 3, e, top);
    for (uint32_t r = 0; r < RINGS; r++)
        for (uint32_t s = 0; s < SPOKES; s++) {
            const double up = (r + 1.0) / (RINGS + 1) / 2, a = s / (double)SPOKES;
            const double u[3] = { trig_sin(up) * trig_cos(a),
                                  trig_sin(up) * trig_sin(a), -trig_cos(up) };
            put_vertex(p + 3 * (2 + (size_t)r * SPOKES + s), e, u);
        }
    for (uint32_t s = 0; s < SPOKES; s++) {
        const uint32_t t = (s + 1) % SPOKES, low = first + 2;
        const uint32_t high = low + (RINGS - 1) * SPOKES;
        const uint32_t caps[6] = { first, low + t, low + s,
                                   first + 1, high + s, high + t };
        for (int i = 0; i < 6; i++)
            *f++ = caps[i];
        for (uint32_t r = 0; r + 1 < RINGS; r++) {
            const uint32_t a = low + r * SPOKES;
            const uint32_t quad[6] = { a + s, a + t, a + SPOKES + t,
                                       a + s, a + SPOKES + t, a + SPOKES + s };
            for (int i = 0; i < 6; i++)
                *f++ = quad[i];
        }
    }
    mesh->vertex_count += BALL_VERTICES;
    mesh->face_count += BALL_FACES;
}

static double diagonal_of(const asset *mesh)
{
    double low[3] = { HUGE_VAL, HUGE_VAL, HUGE_VAL };
    double high[3] = { -HUGE_VAL, -HUGE_VAL, -HUGE_VAL }, sum = 0;

    for (size_t c = 0; c < 3 * mesh->face_count; c++)
        for (size_t k = 0; k < 3; k++) {
            const double t = mesh->positions[3 * (size_t)mesh->indices[c] + k];
            low[k] = fmin(low[k], t);
            high[k] = fmax(high[k], t);
        }
    for (int k = 0; k < 3; k++)
        sum += (high[k] - low[k]) * (high[k] - low[k]);
    return sqrt(sum);
}

static bool make_room(asset *mesh, size_t count)
{
    double *positions =
        realloc(mesh->positions, 3 * (mesh->vertex_count +
                                      count * BALL_VERTICES) * sizeof *positions);
    if (positions)
        mesh->positions = positions;
    uint32_t *indices =
        realloc(mesh->indices, 3 * (mesh->face_count + count * BALL_FACES) *
                                   sizeof *indices);
    if (indices)
        mesh->indices = indices;
    return positions && indices;
}

/* Every so many of the vertices that stand for their place. */
static size_t choose(const asset *mesh, const uint32_t *joined, size_t count,
                     uint32_t *out)
{
    size_t all = 0, seen = 0, chosen = 0;

    for (size_t v = 0; v < mesh->vertex_count; v++)
        all += joined[v] == v;
    for (size_t v = 0; v < mesh->vertex_count && chosen < count; v++)
        if (joined[v] == v && seen++ * count / all >= chosen)
            out[chosen++] = (uint32_t)v;
    return chosen;
}

bool glyphs_add(asset *mesh, uint32_t count)
{
    uint32_t *joined = topology_join(mesh);
    uint32_t *chosen = calloc(count + 1, sizeof *chosen);
    pmesh_ellipsoid *e = calloc(count + 1, sizeof *e);
    bool ok = joined && chosen && e && make_room(mesh, count);

    if (ok) {
        const double diagonal = diagonal_of(mesh);
        for (size_t c = 0; c < 3 * mesh->face_count; c++)
            mesh->indices[c] = joined[mesh->indices[c]];
        const pmesh_mesh_input input = { .positions = mesh->positions,
                                         .vertex_count = mesh->vertex_count,
                                         .indices = mesh->indices,
                                         .face_count = mesh->face_count };
        const size_t n = choose(mesh, joined, count, chosen);
        ok = pmesh_inspect_ellipsoids(&input, NULL, chosen, n,
                                      DISTANCE * diagonal, LARGEST * diagonal,
                                      e) == PMESH_OK;
        for (size_t i = 0; ok && i < n; i++)
            put_ball(mesh, &e[i]);
    }
    free(e);
    free(chosen);
    free(joined);
    return ok;
}
