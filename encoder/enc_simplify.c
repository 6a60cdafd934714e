/* SPDX-License-Identifier: MIT */
#include "encoder/pmesh_simplify.h"

#include <math.h>
#include <string.h>

#include "encoder/enc_heap.h"
#include "encoder/enc_lod_delay.h"
#include "encoder/enc_lod_guard.h"
#include "encoder/enc_lod_import.h"
#include "encoder/enc_lod_price.h"
#include "format/alloc.h"

/* What is known of a pair that was put back: the other direction is next; it
 * has waited. */
enum { TURNED = 1, WAITED = 2 };

typedef struct enc_lod_run {
    const pmesh_simplify_options *options;
    enc_lod lod;
    enc_lod_channels channels;
    enc_lod_pricer pricer;
    enc_lod_delay delay;
    enc_heap heap;
    uint8_t *turned;  /* per pair */
    uint32_t *priced; /* per pair: the contraction after which it was */
    double *drift;    /* per vertex: squared distance so far */
    uint8_t *moved;   /* per vertex: it is at no place of the input */
    enc_lod_strictness strictness;
    uint32_t tick;
    uint32_t face_target, vertex_target;
    double error_limit, error; /* squared, in the frame */
    size_t joined;             /* contractions without an edge */
    bool too_far;              /* some contraction was refused for the limit */
} enc_lod_run;

pmesh_simplify_options pmesh_simplify_options_default(void)
{
    return (pmesh_simplify_options){
        .placement = PMESH_PLACE_OPTIMAL,
        .metric = PMESH_MEMORYLESS,
        .cost = PMESH_COST_QUADRIC,
        .memory = 0.35,
        .boundary = 10,
        .seam = 3,
        .turn_cosine = -1,
    };
}

/* ---- queue --------------------------------------------------------------- */

static void price_pair(enc_lod_run *run, uint32_t pair)
{
    const uint32_t u = run->lod.end_vertex[2 * pair];
    const uint32_t v = run->lod.end_vertex[2 * pair + 1];
    const double cost = enc_lod_pricer_cost(&run->pricer, u, v, false);

    run->turned[pair] = 0;
    if (cost < INFINITY)
        enc_heap_put(&run->heap, pair, cost);
    else
        enc_heap_remove(&run->heap, pair);
}

static void price_all(enc_lod_run *run)
{
    for (uint32_t pair = 0; pair < run->lod.pair_count; pair++)
        if (run->lod.end_vertex[2 * pair] != ENC_NONE)
            price_pair(run, pair);
}

/* Pairs of v that were not priced since the last contraction. */
static void price_around(enc_lod_run *run, uint32_t v)
{
    uint32_t end = run->lod.first_end[v];

    if (end == ENC_NONE)
        return;
    do {
        if (run->priced[end / 2] == run->tick)
            continue;
        run->priced[end / 2] = run->tick;
        price_pair(run, end / 2);
    } while ((end = run->lod.end_next[end]) != run->lod.first_end[v]);
}

/* ---- contraction --------------------------------------------------------- */

static bool values_flip(const enc_lod_run *run, uint32_t v, uint32_t other)
{
    const enc_lod *lod = &run->lod;
    const enc_lod_wedges *ws = &run->pricer.wedges;
    uint32_t c = lod->first_corner[v];

    do {
        const double *before[3], *after[3];
        if (enc_lod_corner_of(lod, c, other) != ENC_NONE)
            continue;
        for (uint32_t k = 0; k < 3; k++) {
            const uint32_t wedge = lod->corner_wedge[c - c % 3 + k];
            before[k] = enc_lod_value(ws, wedge);
            after[k] = enc_lod_next(ws, wedge);
        }
        if (enc_lod_channels_flip(&ws->channels, before, after))
            return true;
    } while ((c = lod->corner_next[c]) != lod->first_corner[v]);
    return false;
}

static bool is_legal(enc_lod_run *run, const enc_lod_offer *offer)
{
    return enc_lod_can_join(&run->lod, offer->gone, offer->kept,
                            run->strictness) &&
           !enc_lod_flips(&run->lod, offer->gone, offer->kept, offer->place) &&
           !(run->delay.least_cosine < run->options->turn_cosine) &&
           (run->channels.count == 0 ||
            (!values_flip(run, offer->gone, offer->kept) &&
             !values_flip(run, offer->kept, offer->gone)));
}

/* inner: v has lost no line and got none, see contract(). */
static void renew(enc_lod_run *run, uint32_t v, bool inner)
{
    const bool known = inner && run->lod.lines[v] == 0;

    if (!known)
        enc_lod_survey(&run->lod, v);
    if (run->options->metric == PMESH_MEMORYLESS)
        enc_lod_sum_planes(&run->pricer.wedges, v);
    enc_lod_sum_normals(&run->lod, v);
}

static void renew_around(enc_lod_run *run, uint32_t v, bool inner)
{
    enc_lod *lod = &run->lod;
    uint32_t end = lod->first_end[v];

    renew(run, v, inner);
    do
        renew(run, lod->end_vertex[end ^ 1], inner);
    while ((end = lod->end_next[end]) != lod->first_end[v]);
    run->tick++;
    price_around(run, v);
    do
        price_around(run, lod->end_vertex[end ^ 1]);
    while ((end = lod->end_next[end]) != lod->first_end[v]);
}

/* Pairs that will go with this one leave the queue: those of `gone` to
 * neighbours of both. */
static void drop_dead(enc_lod_run *run, uint32_t gone)
{
    uint32_t end = run->lod.first_end[gone];

    do
        enc_heap_remove(&run->heap, end / 2);
    while ((end = run->lod.end_next[end]) != run->lod.first_end[gone]);
}

/* Without attributes and materials, all edges of a vertex on no lines have two
 * faces, and so they have after a contraction that keeps the topology. */
static bool stays_inner(const enc_lod_run *run, const enc_lod_offer *offer,
                        bool joins)
{
    const enc_lod *lod = &run->lod;

    return !joins && run->strictness != ENC_LOD_LOOSE && !lod->material &&
           run->channels.count == 0 &&
           (lod->lines[offer->gone] | lod->lines[offer->kept]) == 0;
}

static void contract(enc_lod_run *run, uint32_t pair,
                     const enc_lod_offer *offer, double error)
{
    const bool joins =
        !enc_lod_share_face(&run->lod, offer->gone, offer->kept);
    const bool inner = stays_inner(run, offer, joins);

    drop_dead(run, offer->gone);
    run->drift[offer->kept] = error;
    run->moved[offer->kept] = run->pricer.placement != PMESH_PLACE_ENDPOINT;
    run->error = fmax(run->error, error);
    enc_lod_pricer_move(&run->pricer, offer);
    run->joined += joins;
    enc_lod_contract(&run->lod, pair, offer->gone, offer->kept);
    enc_lod_settle(&run->pricer.wedges, offer->kept);
    enc_lod_delay_move(&run->delay, offer->kept);
    if (run->strictness == ENC_LOD_LOOSE)
        enc_lod_cancel(&run->lod, offer->kept);
    if (run->lod.first_corner[offer->kept] != ENC_NONE)
        renew_around(run, offer->kept, inner);
}

/* True if the pair has been put back: it is taken when it comes again. */
static bool puts_off(enc_lod_run *run, uint32_t pair,
                     const enc_lod_offer *offer)
{
    const double factor = enc_lod_delay_factor(&run->delay, offer->gone,
                                               offer->kept, offer->place);

    /* Other costs mean what they say. */
    if (!(factor > 1) || (run->turned[pair] & WAITED) ||
        run->options->cost != PMESH_COST_QUADRIC)
        return false;
    run->turned[pair] |= WAITED;
    enc_heap_put(&run->heap, pair, factor * offer->cost);
    return true;
}

static void try_pair(enc_lod_run *run, uint32_t pair)
{
    const uint32_t u = run->lod.end_vertex[2 * pair];
    const uint32_t v = run->lod.end_vertex[2 * pair + 1];
    const bool turned = run->turned[pair] & TURNED;

    if (u == ENC_NONE) /* its piece has vanished */
        return;
    const enc_lod_offer offer =
        enc_lod_pricer_offer(&run->pricer, u, v, turned);

    const double error =
        fmax(offer.distance, fmax(run->drift[u], run->drift[v]));
    if (error > run->error_limit) {
        run->too_far = true;
        return;
    }
    if (puts_off(run, pair, &offer))
        return;
    if (is_legal(run, &offer)) {
        contract(run, pair, &offer, error);
        return;
    }
    if (run->pricer.placement != PMESH_PLACE_ENDPOINT || turned)
        return;
    const double cost = enc_lod_pricer_cost(&run->pricer, u, v, true);
    run->turned[pair] = TURNED;
    if (cost < INFINITY)
        enc_heap_put(&run->heap, pair, cost);
}

static bool is_done(const enc_lod_run *run)
{
    return run->lod.faces <= run->face_target ||
           run->lod.vertices <= run->vertex_target;
}

static void contract_all(enc_lod_run *run)
{
    const enc_lod_strictness last =
        run->options->loose ? ENC_LOD_LOOSE : ENC_LOD_TOPOLOGY;
    enc_heap_entry entry;

    for (;;) {
        while (!is_done(run) && enc_heap_pop(&run->heap, &entry))
            try_pair(run, entry.item);
        if (is_done(run) || run->strictness == last)
            return;
        run->strictness = (enc_lod_strictness)(run->strictness + 1);
        run->pricer.break_seams =
            run->channels.count > 0 || run->strictness == ENC_LOD_LOOSE;
        price_all(run);
    }
}

/* ---- beginning and end --------------------------------------------------- */

static bool in_range(const pmesh_simplify_options *o)
{
    return o->ratio >= 0 && o->ratio < INFINITY && o->error >= 0 &&
           o->weld >= 0 && o->weld < INFINITY && o->threshold >= 0 &&
           o->threshold < INFINITY && o->boundary >= 0 &&
           o->boundary < INFINITY && o->memory >= 0 && o->memory < INFINITY &&
           o->turn_cosine >= -1 && o->turn_cosine < 1 &&
           o->seam >= 0 && o->seam < INFINITY &&
           (unsigned)o->placement <= PMESH_PLACE_HULL &&
           (unsigned)o->cost <= PMESH_COST_CUSTOM &&
           (unsigned)o->metric <= PMESH_ACCUMULATED &&
           (o->cost != PMESH_COST_CUSTOM || o->hook) &&
           isfinite(o->camera[0]) && isfinite(o->camera[1]) &&
           isfinite(o->camera[2]);
}

/* The first of the bounds that is reached counts. */
static void set_targets(enc_lod_run *run, size_t input_faces, double extent)
{
    const pmesh_simplify_options *o = run->options;
    double faces = (double)o->faces;

    if (o->ratio > 0)
        faces = fmax(faces, floor(o->ratio * (double)input_faces));
    run->face_target = faces < UINT32_MAX ? (uint32_t)faces : UINT32_MAX;
    run->vertex_target =
        o->vertices < UINT32_MAX ? (uint32_t)o->vertices : UINT32_MAX;
    const double limit = o->error / extent;
    run->error_limit = o->error > 0 ? limit * limit : INFINITY;
}

static pmesh_status prepare(enc_lod_run *run, const pmesh_allocator *a)
{
    const pmesh_status status =
        enc_heap_create(a, run->lod.pair_count, &run->heap);

    run->turned = pmesh_alloc_zero(a, run->lod.pair_count, 1);
    run->priced = pmesh_alloc_zero(a, run->lod.pair_count, sizeof *run->priced);
    run->drift = pmesh_alloc_zero(a, run->lod.vertex_count, sizeof *run->drift);
    run->moved = pmesh_alloc_zero(a, run->lod.vertex_count, 1);
    if (status != PMESH_OK || !run->turned || !run->priced || !run->drift ||
        !run->moved)
        return PMESH_E_MEMORY;
    for (uint32_t v = 0; v < run->lod.vertex_count; v++)
        if (run->lod.first_corner[v] != ENC_NONE) {
            enc_lod_renew(&run->pricer.wedges, v);
            enc_lod_pricer_remember(&run->pricer, v);
            enc_lod_sum_normals(&run->lod, v);
        }
    price_all(run);
    return enc_lod_delay_create(&run->lod,
                                run->pricer.placement == PMESH_PLACE_ENDPOINT,
                                &run->delay);
}

static void release(enc_lod_run *run, const pmesh_allocator *a)
{
    pmesh_release(a, run->turned, run->lod.pair_count, 1);
    pmesh_release(a, run->priced, run->lod.pair_count, sizeof *run->priced);
    pmesh_release(a, run->drift, run->lod.vertex_count, sizeof *run->drift);
    pmesh_release(a, run->moved, run->lod.vertex_count, 1);
    enc_heap_destroy(&run->heap);
    enc_lod_delay_destroy(&run->delay);
    enc_lod_pricer_destroy(&run->pricer);
    enc_lod_destroy(&run->lod);
}

static void put_position(const enc_lod_run *run,
                         const pmesh_simplify_input *mesh,
                         const enc_lod_frame *frame, uint32_t vertex,
                         double out[3])
{
    if (!run->moved[vertex]) {
        enc_lod_input_position(mesh, vertex, out);
        return;
    }
    for (int i = 0; i < 3; i++)
        out[i] =
            frame->origin[i] + frame->extent * run->lod.position[vertex][i];
}

static void put_vertices(const enc_lod_run *run,
                         const pmesh_simplify_input *mesh,
                         const enc_lod_frame *frame, pmesh_simplify_output *out)
{
    const enc_lod_channels *channels = &run->channels;

    for (uint32_t c = 0; c < 3 * run->lod.face_count; c++) {
        const uint32_t v = run->lod.corner_vertex[c];
        const size_t wedge = run->lod.corner_wedge[c];
        if (v == ENC_NONE)
            continue;
        if (out->positions)
            put_position(run, mesh, frame, v, &out->positions[3 * wedge]);
        for (unsigned i = 0; i < channels->count; i++) {
            const unsigned n = channels->channel[i].components;
            const double *row =
                enc_lod_value(&run->pricer.wedges, (uint32_t)wedge);
            for (unsigned k = 0; k < n && out->attribute_values[i]; k++)
                out->attribute_values[i][wedge * n + k] =
                    enc_lod_channels_value(channels, row, i, k);
        }
    }
}

static void put_faces(const enc_lod *lod, pmesh_simplify_output *out)
{
    size_t count = 0;

    for (uint32_t f = 0; f < lod->face_count; f++) {
        if (lod->corner_vertex[3 * f] == ENC_NONE)
            continue;
        for (size_t k = 0; k < 3; k++) {
            out->indices[3 * count + k] = lod->corner_wedge[3 * f + k];
            if (out->position_indices)
                out->position_indices[3 * count + k] =
                    lod->corner_vertex[3 * f + k];
        }
        if (out->face_source)
            out->face_source[count] = f;
        count++;
    }
    out->face_count = count;
    out->vertex_count = lod->vertices;
}

static void put_costs(const enc_lod_run *run, pmesh_simplify_output *out)
{
    double sum = 0;
    size_t count = 0;

    out->cost_least = INFINITY;
    out->cost_most = out->cost_mean = 0;
    for (uint32_t i = 0; i < run->heap.count; i++) {
        const enc_heap_entry *e = &run->heap.entry[i];
        if (run->lod.end_vertex[2 * e->item] == ENC_NONE ||
            (run->turned[e->item] & WAITED))
            continue;
        sum += e->cost;
        count++;
        out->cost_least = fmin(out->cost_least, e->cost);
        out->cost_most = fmax(out->cost_most, e->cost);
    }
    if (count > 0)
        out->cost_mean = sum / (double)count;
    else
        out->cost_least = 0;
}

static pmesh_simplify_end reason(const enc_lod_run *run)
{
    if (run->lod.faces <= run->face_target)
        return PMESH_END_FACES;
    if (run->lod.vertices <= run->vertex_target)
        return PMESH_END_VERTICES;
    return run->too_far ? PMESH_END_ERROR : PMESH_END_EXHAUSTED;
}

pmesh_status pmesh_simplify_mesh(const pmesh_simplify_input *mesh,
                                 const pmesh_simplify_options *options,
                                 pmesh_simplify_output *out)
{
    const pmesh_allocator a = pmesh_allocator_resolve(options->allocator);
    enc_lod_run run = { .options = options };
    bool moving = out->positions != NULL;
    enc_lod_frame frame;
    double *value;

    if (!in_range(options) || !out->indices)
        return PMESH_E_ARGUMENT;
    for (size_t i = 0; i < mesh->attribute_count && i < PMESH_MAX_ATTRIBUTES;
         i++)
        moving = moving && out->attribute_values[i];
    pmesh_status status =
        enc_lod_import(&a, mesh, options->weld, options->threshold, !moving,
                       &run.channels, &frame, &run.lod, &value);
    if (status != PMESH_OK)
        return status;
    const size_t all = run.lod.faces;
    set_targets(&run, all, frame.extent);
    status = enc_lod_pricer_create(&run.lod, options, &frame,
                                   moving ? options->placement
                                          : PMESH_PLACE_ENDPOINT,
                                   &run.channels, value, &run.pricer);
    if (status == PMESH_OK)
        status = prepare(&run, &a);
    if (status == PMESH_OK) {
        contract_all(&run);
        put_faces(&run.lod, out);
        put_vertices(&run, mesh, &frame, out);
        put_costs(&run, out);
        out->end = reason(&run);
        out->error = sqrt(run.error) * frame.extent;
        out->joined = run.joined;
        out->dropped_faces = mesh->face_count - all;
    }
    release(&run, &a);
    return status;
}

pmesh_status pmesh_simplify(const uint32_t *indices, size_t face_count,
                            const float *positions, size_t vertex_count,
                            size_t stride, size_t faces, double error,
                            uint32_t *out, size_t *out_faces, double *out_error)
{
    const pmesh_simplify_input mesh = { .indices = indices,
                                        .face_count = face_count,
                                        .vertex_count = vertex_count,
                                        .positions = positions,
                                        .stride = stride };
    pmesh_simplify_options options = pmesh_simplify_options_default();
    pmesh_simplify_output result = { .indices = out };

    options.faces = faces;
    options.error = error;
    const pmesh_status status = pmesh_simplify_mesh(&mesh, &options, &result);
    if (status == PMESH_OK) {
        *out_faces = result.face_count;
        if (out_error)
            *out_error = result.error;
    }
    return status;
}
