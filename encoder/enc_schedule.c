/* SPDX-License-Identifier: MIT */
#include "encoder/enc_schedule.h"

#include <math.h>
#include <string.h>

#include "encoder/enc_batch.h"
#include "encoder/enc_wedges.h"
#include "format/alloc.h"

/*
 * Batches by profile; see enc_candidate.h for the terms of taste. Large ones
 * that keep the sampling even make the stream small, the guard keeps features.
 */
static const enc_batch_plan COMPACT[] = {
    /* The first suits most; the second, meshes it happens to fail on. */
    { .taste = { .quadric = 2, .length = 0.75, .uneven = 3 },
      .share = 0.499,
      .coherent = true,
      .guard = 1,
      .turn = 2 },
    { .taste = { .quadric = 2, .length = 0.4, .uneven = 5 },
      .share = 0.48,
      .coherent = true,
      .guard = 1,
      .turn = 3 },
};
static const enc_batch_plan FINE = {
    .taste = { .quadric = 2, .length = 0.75, .uneven = 3 },
    .share = 0.499,
    .coherent = true,
    .guard = 0.94,
    .turn = 2
};
static const enc_batch_plan QUALITY = {
    .taste = { .quadric = 1, .length = 3e-4, .uneven = 0 },
    .share = 0.4,
    .coherent = true,
    .guard = 0.45,
    .turn = 2
};
/* The order of the quadrics, length only to decide between flat places: for
 * coarse levels, which cost few bytes, and for moved parents, who want the best
 * levels for theirs. */
static const enc_batch_plan BEST = {
    .taste = { .quadric = 1, .length = 1e-7, .uneven = 0 },
    .share = 0.33,
    .guard = 1
};

/* PMESH_BALANCED: so many fine batches at most, and none that starts below
 * this share of the vertices. */
enum { FINE_BATCHES = 2 };
#define FINE_VERTICES 0.4

/* Levels that start below this share of the vertices are coarse. */
#define COARSE_VERTICES 0.2

/* Where vertices have weights, no batch goes beyond the share of the pairs that
 * is not heavy, but to this one in any case: heavy pairs would have to be taken
 * for want of others. Heavy is so many times the lightest. */
#define LEAST_GUARD 0.5
#define HEAVY 2.0f

/* The run ends if this many batches in a row take less than a fiftieth. */
enum { MAX_POOR_BATCHES = 3, POOR_SHARE = 50 };

/* Batches that start closer to the limit of errors than half of it are smaller
 * by this: the one that leads too far is lost. */
#define CLOSE_SHARE 0.25

enum { DEFAULT_BASE_FACES = 200, MIN_BASE_FACES = 4, BASE_DIVISOR = 8 };

static pmesh_status schedule_create(const enc_mesh *mesh, enc_schedule *out)
{
    const pmesh_allocator *a = &mesh->allocator;
    const size_t n = mesh->vertex_count;
    enc_schedule s = { .allocator = *a,
                       .vertex_count = mesh->vertex_count,
                       .face_count = mesh->face_count,
                       .wedge_count = mesh->wedge_count };

    s.batch_first =
        pmesh_alloc_zero(a, PMESH_MAX_LEVELS, sizeof *s.batch_first);
    s.batch_error =
        pmesh_alloc_zero(a, PMESH_MAX_LEVELS, sizeof *s.batch_error);
    s.contraction = pmesh_alloc(a, n, sizeof *s.contraction);
    s.vertex_end = pmesh_alloc(a, n, sizeof *s.vertex_end);
    s.face_end = pmesh_alloc(a, mesh->face_count, sizeof *s.face_end);
    if (mesh->joined)
        s.face_side = pmesh_alloc(a, mesh->face_count, sizeof *s.face_side);
    if (mesh->wedge)
        s.wedge_parent =
            pmesh_alloc(a, mesh->wedge_count, sizeof *s.wedge_parent);
    *out = s;
    if (!s.batch_first || !s.batch_error || !s.contraction || !s.vertex_end || !s.face_end ||
        (mesh->joined && !s.face_side) ||
        (mesh->wedge && !s.wedge_parent)) {
        enc_schedule_destroy(out);
        return PMESH_E_MEMORY;
    }
    memset(s.vertex_end, 0xff, n * sizeof *s.vertex_end);
    memset(s.face_end, 0xff, mesh->face_count * sizeof *s.face_end);
    if (mesh->wedge)
        memset(s.wedge_parent, 0xff,
               mesh->wedge_count * sizeof *s.wedge_parent);
    return PMESH_OK;
}

void enc_schedule_settle(enc_schedule *s)
{
    if (!s->reach)
        return;
    enc_reach_settle(s->reach);
    enc_reach_destroy(s->reach);
    pmesh_release(&s->allocator, s->reach, 1, sizeof *s->reach);
    s->reach = NULL;
}

void enc_schedule_destroy(enc_schedule *s)
{
    const pmesh_allocator *a = &s->allocator;
    const size_t n = s->vertex_count;

    if (!a->release)
        return;
    enc_schedule_settle(s);
    pmesh_release(a, s->batch_first, PMESH_MAX_LEVELS, sizeof *s->batch_first);
    pmesh_release(a, s->batch_error, PMESH_MAX_LEVELS, sizeof *s->batch_error);
    pmesh_release(a, s->contraction, n, sizeof *s->contraction);
    pmesh_release(a, s->vertex_end, n, sizeof *s->vertex_end);
    pmesh_release(a, s->position, n, sizeof *s->position);
    pmesh_release(a, s->face_end, s->face_count, sizeof *s->face_end);
    pmesh_release(a, s->face_side, s->face_count, sizeof *s->face_side);
    pmesh_release(a, s->wedge_parent, s->wedge_count, sizeof *s->wedge_parent);
    *s = (enc_schedule){ 0 };
}

/* Edges of sheets: every half-edge without twin is one, twins share one. */
static uint32_t count_edges(const enc_mesh *mesh)
{
    uint32_t count = 0;
    for (uint32_t h = 0; h < 3 * mesh->face_count; h++)
        count += h < mesh->twin[h];
    return count;
}

/* Pairs without an edge that an enc_run has room for. */
static uint32_t near_room(const enc_mesh *mesh)
{
    return mesh->joined ? 4 * mesh->vertex_count : 0;
}

static pmesh_status find_near(const enc_mesh *mesh, enc_run *run)
{
    const double steps = run->config->threshold / mesh->grid.step;
    pmesh_status status = PMESH_OK;
    if (!mesh->joined)
        return status;
    status = enc_near_create(&mesh->allocator, near_room(mesh), &run->near);
    if (status == PMESH_OK && steps >= 1)
        status = enc_near_within(mesh, steps, &run->near);
    run->within = run->near.count;
    return status;
}

/* Counts the vertices of segments that have shares. */
static bool count_segments(const enc_mesh *mesh, enc_run *run)
{
    const pmesh_allocator *a = &mesh->allocator;
    const enc_guide *g = mesh->guide;
    if (!g || !g->share)
        return true;
    run->segment_size =
        pmesh_alloc_zero(a, g->segment_count, sizeof *run->segment_size);
    if (!run->segment_size)
        return false;
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        run->segment_size[g->segment[v]]++;
    return true;
}

/* What the other workers need; see enc_collect.c. */
static bool create_scratch(const enc_mesh *mesh, enc_run *run)
{
    const pmesh_allocator *a = &mesh->allocator;
    const unsigned others = enc_pool_workers(mesh->pool) - 1;

    if (others == 0)
        return true;
    run->scratch = pmesh_alloc_zero(a, others, sizeof *run->scratch);
    run->views = pmesh_alloc_zero(a, others, sizeof *run->views);
    if (!run->scratch || !run->views)
        return false;
    for (unsigned i = 0; i < others; i++) {
        enc_scratch *own = &run->scratch[i];
        own->mark = pmesh_alloc_zero(a, mesh->vertex_count, sizeof *own->mark);
        if (!own->mark ||
            !enc_looks_fate(&run->pricing.looks, mesh, &own->fate))
            return false;
    }
    return true;
}

static void destroy_scratch(const enc_mesh *mesh, enc_run *run)
{
    const pmesh_allocator *a = &mesh->allocator;
    const unsigned others = enc_pool_workers(mesh->pool) - 1;

    for (unsigned i = 0; run->scratch && i < others; i++) {
        enc_scratch *own = &run->scratch[i];
        pmesh_release(a, own->mark, mesh->vertex_count, sizeof *own->mark);
        pmesh_release(a, own->fate, mesh->wedge_count, sizeof *own->fate);
    }
    pmesh_release(a, run->scratch, others, sizeof *run->scratch);
    pmesh_release(a, run->views, others, sizeof *run->views);
}

static pmesh_status create_reach(enc_run *run)
{
    enc_schedule *out = run->out;

    out->reach = pmesh_alloc_zero(&out->allocator, 1, sizeof *out->reach);
    return out->reach ? enc_reach_create(&run->surface,
                                         !(run->config->base_error > 0), out,
                                         out->reach)
                      : PMESH_E_MEMORY;
}

static pmesh_status run_create(const enc_mesh *mesh,
                               const pmesh_encoder_config *config,
                               enc_schedule *schedule, enc_run *run)
{
    const pmesh_allocator *a = &mesh->allocator;
    const size_t n = mesh->vertex_count;
    pmesh_status status = enc_surface_create(mesh, &run->surface);

    run->mesh = mesh;
    run->config = config;
    run->out = schedule;
    if (status == PMESH_OK)
        status = enc_pricing_create(mesh, config, &run->pricing);
    if (status == PMESH_OK)
        status = enc_queue_create(a, count_edges(mesh) + near_room(mesh),
                                  &run->queue);
    if (status == PMESH_OK)
        status = create_reach(run);
    if (status == PMESH_OK)
        status = find_near(mesh, run);
    if (status == PMESH_OK &&
        (!count_segments(mesh, run) || !create_scratch(mesh, run)))
        status = PMESH_E_MEMORY;
    if (status != PMESH_OK)
        return status;
    run->edge_state = pmesh_alloc_zero(
        a, 3 * (size_t)mesh->face_count + near_room(mesh), 1);
    run->taken = pmesh_alloc_zero(a, n, sizeof *run->taken);
    if (config->base_error > 0)
        run->drift = pmesh_alloc_zero(a, n, sizeof *run->drift);
    if (mesh->joined)
        run->role = pmesh_alloc_zero(a, n, sizeof *run->role);
    return run->edge_state && run->taken &&
                   (run->drift || !(config->base_error > 0)) &&
                   (run->role || !mesh->joined)
               ? PMESH_OK
               : PMESH_E_MEMORY;
}

/* Accepts what run_create() left half-built. */
static void run_destroy(const enc_mesh *mesh, enc_run *run)
{
    const pmesh_allocator *a = &mesh->allocator;

    destroy_scratch(mesh, run);
    enc_surface_destroy(&run->surface);
    enc_pricing_destroy(mesh, &run->pricing);
    if (run->queue.list)
        enc_queue_destroy(&run->queue);
    enc_near_destroy(&run->near);
    pmesh_release(a, run->edge_state,
                  3 * (size_t)mesh->face_count + near_room(mesh), 1);
    pmesh_release(a, run->taken, mesh->vertex_count, sizeof *run->taken);
    pmesh_release(a, run->role, mesh->vertex_count, sizeof *run->role);
    pmesh_release(a, run->drift, mesh->vertex_count, sizeof *run->drift);
    if (mesh->guide)
        pmesh_release(a, run->segment_size, mesh->guide->segment_count,
                      sizeof *run->segment_size);
}

uint32_t enc_base_target(const pmesh_encoder_config *config, uint32_t faces)
{
    uint32_t target = config->base_faces;

    if (target == 0 && config->base_vertices == 0 &&
        !(config->base_ratio > 0)) {
        target = faces / BASE_DIVISOR;
        if (target < MIN_BASE_FACES)
            target = MIN_BASE_FACES;
        if (target > DEFAULT_BASE_FACES)
            target = DEFAULT_BASE_FACES;
    }
    if (config->base_ratio > 0) {
        const double share = config->base_ratio * faces;
        const uint32_t least = share < faces ? (uint32_t)share : faces;
        if (target < least)
            target = least;
    }
    return target;
}

/* Whatever the config names is a stop, and the first one reached counts. */
static void set_targets(enc_run *run)
{
    const pmesh_encoder_config *config = run->config;

    run->face_target = enc_base_target(config, run->mesh->face_count);
    run->vertex_target = config->base_vertices;

    run->error_limit = config->base_error > 0
                           ? config->base_error / run->mesh->grid.step
                           : INFINITY;
}

/* Of the vertices that are left, those that are not heavy. */
static double light_share(const enc_run *run)
{
    const float *factor = run->pricing.factor;
    const uint32_t *first = run->surface.first;
    float least = INFINITY;
    uint32_t light = 0;

    for (uint32_t v = 0; v < run->mesh->vertex_count; v++)
        if (first[v] != ENC_NONE && factor[v] < least)
            least = factor[v];
    for (uint32_t v = 0; v < run->mesh->vertex_count; v++)
        light += first[v] != ENC_NONE && factor[v] < HEAVY * least;
    return fmax(LEAST_GUARD, (double)light / run->surface.vertex_count);
}

static enc_batch_plan plan_batch(const enc_run *run, uint32_t variant)
{
    const uint32_t n = run->surface.vertex_count;
    const pmesh_profile profile = run->config->profile;
    const bool fine = run->out->batch_count < FINE_BATCHES &&
                      n > FINE_VERTICES * run->mesh->vertex_count;
    const bool coarse = n < COARSE_VERTICES * run->mesh->vertex_count ||
                        run->config->placement == PMESH_OPTIMAL;
    enc_batch_plan plan = profile == PMESH_COMPACT            ? COMPACT[variant]
                          : profile == PMESH_BALANCED && fine ? FINE
                          : coarse                            ? BEST
                                                              : QUALITY;
    if (run->config->cost != PMESH_COST_QUADRIC)
        plan = BEST; /* strictly in its order */
    if (run->pricing.factor)
        plan.guard = fmin(plan.guard, light_share(run));
    if (run->joins_sheets)
        plan.guard = 1; /* there is little else */
    if (run->error_limit < INFINITY &&
        4 * run->out->reach->most > run->error_limit * run->error_limit)
        plan.share *= CLOSE_SHARE;
    plan.limit = (uint32_t)(plan.share * n);
    if (plan.limit == 0)
        plan.limit = 1;
    return plan;
}

/* Allows what is not allowed as long as there is anything else; false if
 * nothing is left to allow. */
static bool relent(enc_run *run)
{
    bool *next = run->mesh->joined && !run->joins_sheets ? &run->joins_sheets
                 : run->pricing.looks.guarded            ? &run->lets_turn
                                                         : NULL;
    if (!next || *next)
        return false;
    return *next = true;
}

/* Takes back the contractions from the last batch on. */
static void undo_batch(enc_run *run)
{
    enc_schedule *out = run->out;
    const uint32_t first = out->batch_first[out->batch_count];

    for (uint32_t t = out->contraction_count; t-- > first;) {
        const enc_contraction *c = &out->contraction[t];
        memcpy(run->surface.position[c->parent], c->before, sizeof c->before);
        out->vertex_end[c->child] = ENC_NONE;
    }
    for (uint32_t f = 0; f < run->mesh->face_count; f++)
        if (out->face_end[f] != ENC_NONE && out->face_end[f] >= first)
            out->face_end[f] = ENC_NONE;
    for (uint32_t w = 0; run->mesh->wedge && w < run->mesh->wedge_count; w++)
        if (out->vertex_end[run->mesh->wedge_vertex[w]] == ENC_NONE)
            out->wedge_parent[w] = ENC_NONE;
    out->contraction_count = first;
}

/* Makes a batch of the last contractions; false, and they are taken back, if
 * that led too far. */
static bool close_batch(enc_run *run)
{
    enc_schedule *out = run->out;
    const bool later = out->reach->later;
    const double bound =
        later ? 0 : enc_reach_bound(out->reach, &run->surface, out);

    if (bound > run->error_limit) {
        undo_batch(run);
        run->undone = true;
        return false;
    }
    out->batch_error[out->batch_count] = bound;
    out->batch_first[++out->batch_count] = out->contraction_count;
    if (later)
        enc_reach_later(out->reach);
    return true;
}

static void run_batches(enc_run *run, uint32_t variant)
{
    enc_schedule *out = run->out;
    unsigned poor = 0;

    while (!enc_run_done(run) && out->batch_count < PMESH_MAX_LEVELS - 1 &&
           poor < MAX_POOR_BATCHES) {
        const enc_batch_plan plan = plan_batch(run, variant);
        const uint32_t n = run->surface.vertex_count;
        const uint32_t taken = enc_batch_contract(run, &plan);

        if (taken > 0 && !close_batch(run))
            break;
        poor = taken < n / POOR_SHARE ? poor + 1 : 0;
        if (taken > n / POOR_SHARE)
            continue;
        if (relent(run))
            poor = 0;
        else if (taken == 0)
            break;
    }
}

static pmesh_simplify_end reason(const enc_run *run)
{
    if (run->undone)
        return PMESH_END_ERROR;
    if (run->surface.face_count <= run->face_target)
        return PMESH_END_FACES;
    if (run->surface.vertex_count <= run->vertex_target)
        return PMESH_END_VERTICES;
    return run->too_far ? PMESH_END_ERROR : PMESH_END_EXHAUSTED;
}

/* The parent of each vertex goes into scratch that is free by now. */
static pmesh_status finish_wedges(enc_run *run)
{
    const enc_schedule *out = run->out;
    uint32_t *parent = run->surface.mark;

    for (uint32_t v = 0; v < run->mesh->vertex_count; v++) {
        const uint32_t end = out->vertex_end[v];
        parent[v] = end == ENC_NONE ? ENC_NONE : out->contraction[end].parent;
    }
    return enc_wedges_finish(run->mesh, parent, out->wedge_parent);
}

uint32_t enc_schedule_variants(const pmesh_encoder_config *config)
{
    return config->profile == PMESH_COMPACT ? sizeof COMPACT / sizeof *COMPACT
                                            : 1;
}

pmesh_status enc_schedule_build(const enc_mesh *mesh,
                                const pmesh_encoder_config *config,
                                uint32_t variant, enc_schedule *out)
{
    enc_run run = { 0 };
    pmesh_status status = schedule_create(mesh, out);

    if (status != PMESH_OK)
        return status;
    status = run_create(mesh, config, out, &run);
    if (status == PMESH_OK) {
        set_targets(&run);
        run_batches(&run, variant);
        out->end = reason(&run);
        if (!out->reach->later)
            enc_schedule_settle(out);
        out->position = run.surface.position;
        run.surface.position = NULL;
        if (run.cancelled || run.starved)
            status = run.cancelled ? PMESH_E_CANCELLED : PMESH_E_MEMORY;
        else if (mesh->wedge)
            status = finish_wedges(&run);
    }
    run_destroy(mesh, &run);
    if (status != PMESH_OK)
        enc_schedule_destroy(out);
    return status;
}
