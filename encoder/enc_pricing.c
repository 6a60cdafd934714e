/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "encoder/enc_candidate.h"
#include "format/alloc.h"

/* Contractions change what a vertex stands for, so a run has its own. */
static bool copy_guide(const enc_mesh *mesh, enc_pricing *out)
{
    const pmesh_allocator *a = &mesh->allocator;
    const enc_guide *g = mesh->guide;
    const size_t n = mesh->vertex_count;

    if (!g)
        return true;
    out->lock = g->lock;
    if (g->factor && (out->factor = pmesh_alloc(a, n, sizeof *out->factor)))
        memcpy(out->factor, g->factor, n * sizeof *out->factor);
    if (!g->pull)
        return out->factor || !g->factor;
    out->pull = pmesh_alloc(a, n, sizeof *out->pull);
    out->pulled = pmesh_alloc(a, n, sizeof *out->pulled);
    if (!out->pull || !out->pulled)
        return false;
    memcpy(out->pull, g->pull, n * sizeof *out->pull);
    for (size_t v = 0; v < n; v++)
        out->pulled[v] = g->pull[v].weight > 0;
    return out->factor || !g->factor;
}

pmesh_status enc_pricing_create(const enc_mesh *mesh,
                                const pmesh_encoder_config *config,
                                enc_pricing *out)
{
    const pmesh_allocator *a = &mesh->allocator;

    *out = (enc_pricing){ .metric = config->metric,
                          .placement = config->placement,
                          .rule = { .cost = config->cost,
                                    .hook = config->cost_hook,
                                    .user = config->cost_user,
                                    .unit = mesh->grid.step } };
    memcpy(out->rule.camera, config->camera, sizeof config->camera);
    memcpy(out->rule.origin, mesh->grid.origin, sizeof out->rule.origin);
    const pmesh_status status = enc_looks_create(mesh, &out->looks);
    if (status != PMESH_OK)
        return status;
    out->planes = pmesh_alloc(a, mesh->vertex_count, sizeof *out->planes);
    if (config->metric == PMESH_ACCUMULATED)
        out->moved =
            pmesh_alloc_zero(a, mesh->vertex_count, sizeof *out->moved);
    out->unevenness =
        pmesh_alloc(a, mesh->vertex_count, sizeof *out->unevenness);
    out->block = pmesh_alloc(a, enc_blocks(mesh), sizeof *out->block);
    if (!out->planes || !out->unevenness || !out->block ||
        !copy_guide(mesh, out) ||
        (config->metric == PMESH_ACCUMULATED && !out->moved)) {
        enc_pricing_destroy(mesh, out);
        return PMESH_E_MEMORY;
    }
    return PMESH_OK;
}

void enc_pricing_destroy(const enc_mesh *mesh, enc_pricing *p)
{
    const pmesh_allocator *a = &mesh->allocator;

    pmesh_release(a, p->planes, mesh->vertex_count, sizeof *p->planes);
    pmesh_release(a, p->moved, mesh->vertex_count, sizeof *p->moved);
    pmesh_release(a, p->unevenness, mesh->vertex_count, sizeof *p->unevenness);
    pmesh_release(a, p->block, enc_blocks(mesh), sizeof *p->block);
    pmesh_release(a, p->factor, mesh->vertex_count, sizeof *p->factor);
    pmesh_release(a, p->pull, mesh->vertex_count, sizeof *p->pull);
    pmesh_release(a, p->pulled, mesh->vertex_count, sizeof *p->pulled);
    enc_looks_destroy(mesh, &p->looks);
    *p = (enc_pricing){ 0 };
}

typedef struct beginning {
    enc_pricing *pricing;
    const enc_surface *surface;
    bool planes; /* are to be made */
} beginning;

/* Edges count where their lower half-edge starts. */
static void survey_block(enc_pricing *p, const enc_surface *s, uint32_t part)
{
    const uint32_t end = enc_block_end(s->mesh, part);
    enc_block sums = { .length = 0 };

    for (uint32_t v = part * ENC_BLOCK; v < end; v++) {
        enc_survey survey;
        if (s->first[v] == ENC_NONE)
            continue;
        enc_star_survey(s, v, &survey);
        p->unevenness[v] = (float)survey.unevenness;
        if (p->sign)
            p->sign[v] = survey.sign;
        sums.length += survey.length;
        sums.edges += survey.edges;
    }
    p->block[part] = sums;
}

/* Planes are one part: their sums go from face to face. */
static void begin_part(void *user, uint32_t part, unsigned worker)
{
    const beginning *b = user;
    const uint32_t blocks = enc_blocks(b->surface->mesh);

    (void)worker;
    if (part == 0 && b->planes)
        enc_star_all_planes(b->surface, b->pricing->planes);
    else if (part > 0 && part <= blocks)
        survey_block(b->pricing, b->surface, part - 1);
    else if (part > blocks)
        enc_looks_begin(&b->pricing->looks, b->surface, part - blocks - 1);
}

void enc_pricing_begin(enc_pricing *p, const enc_surface *s, enc_taste taste,
                       bool first_time)
{
    beginning b = { p, s, first_time || p->metric == PMESH_MEMORYLESS };
    const uint32_t blocks = enc_blocks(s->mesh);
    double sum = 0;

    p->taste = taste;
    enc_pool_run(enc_surface_pool(s),
                 1 + blocks + enc_looks_parts(&p->looks, s->mesh), begin_part,
                 &b);
    for (uint32_t i = 0; i < blocks; i++)
        sum += p->block[i].length;
    p->edge_square = sum / (3.0 * s->face_count);
}
