/* SPDX-License-Identifier: MIT */
#include "encoder/enc_guide.h"

#include <math.h>
#include <string.h>

#include "encoder/enc_guide_pull.h"
#include "format/alloc.h"

/* The number of vertices at which the factor is what it says. */
#define REFERENCE_VERTICES 10000.0

pmesh_guide pmesh_guide_default(void)
{
    return (pmesh_guide){ .factor = 100 };
}

/* Not NaN, not infinite, not negative. */
static bool is_amount(double value)
{
    return value - value == 0 && value >= 0;
}

static bool constraint_is_sound(const pmesh_constraint *c, size_t vertex_count)
{
    if ((unsigned)c->kind > PMESH_POINT || !is_amount(c->importance) ||
        (c->vertex_count > 0 && !c->vertices))
        return false;
    for (size_t i = 0; i < c->vertex_count; i++)
        if (c->vertices[i] >= vertex_count)
            return false;
    return true;
}

bool enc_guide_is_sound(const pmesh_guide *g, size_t vertex_count)
{
    if (!is_amount(g->factor) || !(g->factor > 1) || !is_amount(g->crease) ||
        !is_amount(g->importance) || (g->constraint_count && !g->constraints) ||
        ((g->segments || g->shares) && g->segment_count == 0) ||
        g->segment_count > UINT16_MAX + 1)
        return false;
    for (size_t i = 0; i < g->constraint_count; i++)
        if (!constraint_is_sound(&g->constraints[i], vertex_count))
            return false;
    for (size_t v = 0; g->segments && v < vertex_count; v++)
        if (g->segments[v] >= g->segment_count)
            return false;
    for (uint32_t i = 0; g->shares && i < g->segment_count; i++)
        if (!(g->shares[i] >= 0 && g->shares[i] <= 1))
            return false;
    return true;
}

static bool has_pull(const pmesh_guide *g)
{
    return g->constraint_count > 0 || g->crease > 0 || g->seams || g->borders;
}

static bool allocate(enc_mesh *mesh, const pmesh_guide *from)
{
    const pmesh_allocator *a = &mesh->allocator;
    const size_t n = mesh->vertex_count;
    enc_guide *g = mesh->guide = pmesh_alloc_zero(a, 1, sizeof *g);

    if (!g)
        return false;
    g->segment_count = from->segment_count;
    if (from->weights)
        g->factor = pmesh_alloc_zero(a, n, sizeof *g->factor);
    if (from->locks)
        g->lock = pmesh_alloc_zero(a, n, sizeof *g->lock);
    if (from->segments)
        g->segment = pmesh_alloc_zero(a, n, sizeof *g->segment);
    if (from->segments && from->shares)
        g->share = pmesh_alloc_zero(a, g->segment_count, sizeof *g->share);
    if (has_pull(from))
        g->pull = pmesh_alloc_zero(a, n, sizeof *g->pull);
    return (g->factor || !from->weights) && (g->lock || !from->locks) &&
           (g->segment || !from->segments) &&
           (g->share || !from->segments || !from->shares) &&
           (g->pull || !has_pull(from));
}

void enc_guide_destroy(enc_mesh *mesh)
{
    const pmesh_allocator *a = &mesh->allocator;
    const size_t n = mesh->vertex_count;
    enc_guide *g = mesh->guide;

    if (!g)
        return;
    pmesh_release(a, g->factor, n, sizeof *g->factor);
    pmesh_release(a, g->lock, n, sizeof *g->lock);
    pmesh_release(a, g->segment, n, sizeof *g->segment);
    pmesh_release(a, g->share, g->segment_count, sizeof *g->share);
    pmesh_release(a, g->pull, n, sizeof *g->pull);
    pmesh_release(a, g, 1, sizeof *g);
    mesh->guide = NULL;
}

static double exponent(float weight)
{
    const double w = weight == weight ? (double)weight : 0.5;
    return 2 * (w < 0 ? 0 : w > 1 ? 1 : w) - 1;
}

/* base^e, -1 <= e <= 1, by square roots alone: IEEE rounds those the same way
 * everywhere, pow() it does not. */
static double power(double base, double e)
{
    enum { BITS = 20 };
    double rest = e < 0 ? -e : e, root = base, product = 1;

    for (int i = 0; i <= BITS; i++) {
        if (rest >= 1) {
            product *= root;
            rest -= 1;
        }
        rest *= 2;
        root = sqrt(root);
    }
    return e < 0 ? 1 / product : product;
}

/* The binary logarithm of n > 0, to 20 bits, likewise. */
static double logarithm(double n)
{
    double whole = 0, bit = 1, sum = 0;

    for (; n >= 2; n /= 2)
        whole++;
    for (int i = 0; i < 20; i++) {
        n *= n;
        bit /= 2;
        if (n >= 2) {
            n /= 2;
            sum += bit;
        }
    }
    return whole + sum;
}

/* Factors have no value yet where they are 0. */
static void take_corner(enc_guide *g, const pmesh_guide *from, double base,
                        uint32_t v, uint32_t input)
{
    if (g->factor) {
        const float f = (float)power(base, exponent(from->weights[input]));
        if (f > g->factor[v])
            g->factor[v] = f;
    }
    if (g->lock && from->locks[input])
        g->lock[v] = 1;
    if (g->segment && from->segments[input] > g->segment[v])
        g->segment[v] = from->segments[input];
}

/* The factor is never below 1 nor so large that sums of it lose the rest. */
static double scaled_factor(const pmesh_guide *guide, uint32_t vertices)
{
    const double f = guide->factor * logarithm(vertices) /
                     logarithm(REFERENCE_VERTICES);
    return f < 1 ? 1 : f > 1e9 ? 1e9 : f;
}

pmesh_status enc_guide_create(enc_mesh *mesh, const pmesh_mesh_input *in,
                              const pmesh_guide *guide, const uint32_t *number,
                              const uint32_t *source)
{
    const pmesh_allocator *a = &mesh->allocator;
    pmesh_status status = PMESH_OK;

    if (!guide)
        return PMESH_OK;
    if (!enc_guide_is_sound(guide, in->vertex_count))
        return PMESH_E_ARGUMENT;
    if (!allocate(mesh, guide))
        return PMESH_E_MEMORY;
    uint32_t *first = pmesh_alloc(a, mesh->vertex_count, sizeof *first);
    if (!first)
        return PMESH_E_MEMORY;
    const double base = scaled_factor(guide, mesh->vertex_count);
    for (uint32_t c = 0; c < 3 * mesh->face_count; c++) {
        const uint32_t input = in->indices[3 * (size_t)source[c / 3] + c % 3];
        take_corner(mesh->guide, guide, base, mesh->vertex[c], input);
        first[mesh->vertex[c]] = number[input];
    }
    for (uint32_t i = 0; mesh->guide->share && i < guide->segment_count; i++)
        mesh->guide->share[i] = guide->shares[i];
    if (mesh->guide->pull)
        status = enc_pull_all(mesh, guide, number, first);
    pmesh_release(a, first, mesh->vertex_count, sizeof *first);
    return status;
}

unsigned enc_guide_directions(const enc_guide *g, uint32_t u, uint32_t v)
{
    if (g->segment && g->segment[u] != g->segment[v])
        return 0;
    if (!g->lock)
        return ENC_GUIDE_FORTH | ENC_GUIDE_BACK;
    return (g->lock[u] ? 0u : ENC_GUIDE_FORTH) |
           (g->lock[v] ? 0u : ENC_GUIDE_BACK);
}
