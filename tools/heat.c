/* SPDX-License-Identifier: MIT */
#include "tools/heat.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "encoder/pmesh_inspect.h"
#include "tools/surface.h"
#include "tools/topology.h"

/* Costs are told apart down to this many halvings of red. */
#define HALVINGS 16

static bool begin(const asset *mesh, heat *out)
{
    *out = (heat){ 0 };
    out->value = calloc(mesh->vertex_count + 1, sizeof *out->value);
    return out->value != NULL;
}

void heat_free(heat *h)
{
    free(h->value);
    *h = (heat){ 0 };
}

static int by_size(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return x < y ? -1 : x > y;
}

/* The value that a hundredth exceeds, or the largest if that is 0. */
static bool find_red(const float *value, size_t count, double *red)
{
    float *sorted = malloc((count + 1) * sizeof *sorted);

    if (!sorted)
        return false;
    for (size_t i = 0; i < count; i++)
        sorted[i] = value[i];
    qsort(sorted, count, sizeof *sorted, by_size);
    *red = count > 0 ? (double)sorted[count - 1 - count / 100] : 0;
    if (!(*red > 0) && count > 0)
        *red = (double)sorted[count - 1];
    free(sorted);
    return true;
}

static float clamp(double t)
{
    return t > 1 ? 1.0f : t >= 0 ? (float)t : 0.0f;
}

bool heat_distances(const asset *mesh, const asset *level, float *out,
                    double *diagonal)
{
    const asset *const both[2] = { mesh, level };
    surface_frame frame;
    surface whole = { 0 }, s = { 0 };
    uint32_t hint = 0;

    if (!surface_frame_of(both, 2, &frame) ||
        !surface_build(&whole, mesh, &frame))
        return false;
    *diagonal = ldexp(whole.diagonal, frame.exponent);
    surface_free(&whole);
    if (!surface_build(&s, level, &frame))
        return false;
    for (size_t v = 0; s.face_count > 0 && v < mesh->vertex_count; v++) {
        double p[3];
        for (size_t k = 0; k < 3; k++)
            p[k] = ldexp(mesh->positions[3 * v + k] - frame.center[k],
                         -frame.exponent);
        out[v] = (float)ldexp(sqrt(surface_closest(&s, p, &hint)),
                              frame.exponent);
    }
    surface_free(&s);
    return true;
}

bool heat_of_errors(const asset *mesh, const asset *level, heat *out)
{
    double diagonal, red;

    if (!begin(mesh, out))
        return false;
    if (!heat_distances(mesh, level, out->value, &diagonal) ||
        !find_red(out->value, mesh->vertex_count, &red)) {
        heat_free(out);
        return false;
    }
    for (size_t v = 0; v < mesh->vertex_count; v++)
        out->value[v] = red > 0 ? clamp((double)out->value[v] / red) : 0;
    snprintf(out->blue, sizeof out->blue, "0");
    snprintf(out->red, sizeof out->red, "%.2g %%", 100 * red / diagonal);
    return true;
}

/* Vertices at one place are one, as they are to the simplifier. */
static bool costs_of(const asset *mesh, double *cost)
{
    uint32_t *joined = topology_join(mesh);
    uint32_t *indices = malloc((3 * mesh->face_count + 1) * sizeof *indices);
    bool ok = joined && indices;

    for (size_t c = 0; ok && c < 3 * mesh->face_count; c++)
        indices[c] = joined[mesh->indices[c]];
    const pmesh_mesh_input input = { .positions = mesh->positions,
                                     .vertex_count = mesh->vertex_count,
                                     .indices = indices,
                                     .face_count = mesh->face_count };
    ok = ok && pmesh_inspect_costs(&input, NULL, cost) == PMESH_OK;
    for (size_t v = 0; ok && v < mesh->vertex_count; v++)
        cost[v] = cost[joined[v]];
    free(indices);
    free(joined);
    return ok;
}

/* About the binary logarithm, in straight pieces: log2() is not the same on
 * every machine. */
static double logarithm(double t)
{
    int exponent;
    const double part = frexp(t, &exponent);
    return exponent + 2 * part - 2;
}

bool heat_of_costs(const asset *mesh, heat *out)
{
    double *cost = malloc((mesh->vertex_count + 1) * sizeof *cost), red = 0;
    bool ok = begin(mesh, out) && cost && costs_of(mesh, cost);

    for (size_t v = 0; ok && v < mesh->vertex_count; v++)
        out->value[v] = (float)cost[v];
    ok = ok && find_red(out->value, mesh->vertex_count, &red);
    for (size_t v = 0; ok && v < mesh->vertex_count; v++)
        out->value[v] =
            cost[v] > 0 ? clamp(1 + logarithm(cost[v] / red) / HALVINGS) : 0;
    free(cost);
    if (!ok) {
        heat_free(out);
        return false;
    }
    snprintf(out->blue, sizeof out->blue, "%.1g", ldexp(red, -HALVINGS));
    snprintf(out->red, sizeof out->red, "%.1g", red);
    return true;
}

bool heat_of_weights(const asset *mesh, const guide *g, heat *out)
{
    if (!begin(mesh, out))
        return false;
    for (size_t v = 0; v < mesh->vertex_count; v++)
        out->value[v] = g->use.weights ? clamp((double)g->use.weights[v]) : 0.5f;
    snprintf(out->blue, sizeof out->blue, "0");
    snprintf(out->red, sizeof out->red, "1");
    return true;
}
