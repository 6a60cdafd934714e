/* SPDX-License-Identifier: MIT */
/*
 * enc_encode.c - pmesh_encode(): import, contraction, coding, writing.
 */
#include <float.h>
#include <string.h>

#include "encoder/enc_exact.h"
#include "encoder/enc_import.h"
#include "encoder/enc_inflate.h"
#include "encoder/enc_measure.h"
#include "encoder/enc_mesh.h"
#include "encoder/enc_replay.h"
#include "encoder/enc_schedule.h"
#include "encoder/enc_stream.h"
#include "format/alloc.h"
#include "format/quantize.h"

#define MAX_WEIGHT 1e6

enum {
    SPENT_BYTE = 8 * 256, /* of pmesh_codec.attribute_spent */
    BLOCK_ROOM = 1 << 22,  /* far beyond what a block of 64 KiB can need; */
    SPLIT_ROOM = 8, /* without attributes, so is this many times the bits as
                       they are */
    BASE_FACE_ROOM = 96,   /* bytes: a face is a few flags and, at most, one */
    BASE_WEDGE_ROOM = 160, /* vertex of 3 x 24 bits; 32 values of 16 bits */
    /* Small blocks show progress sooner, but cost 0.1 % of the file, and what
     * lies between two levels is refined block by block. */
    COMPACT_BLOCK = PMESH_BLOCK_CHUNK_SIZE - 256,
    BLOCK = COMPACT_BLOCK / 2
};

pmesh_encoder_config pmesh_encoder_config_default(void)
{
    return (pmesh_encoder_config){
        .profile = PMESH_BALANCED,
        .placement = PMESH_SUBSET,
        .metric = PMESH_MEMORYLESS,
        .position_bits = 14,
        .normal_bits = 10,
        .texcoord_bits = 12,
        .color_bits = 8,
        .generic_bits = 12,
        .normal_weight = 0.01,
        .texcoord_weight = 0.1,
        .color_weight = 0.03,
        .threads = 1,
    };
}

static bool within(unsigned value, unsigned least, unsigned most)
{
    return value >= least && value <= most;
}

/* Not NaN, not infinite, not negative. */
static bool is_amount(double value)
{
    return value - value == 0 && value >= 0;
}

static bool is_weight(double value)
{
    return value >= 0 && value <= MAX_WEIGHT;
}

static bool is_finite(const double x[3])
{
    return x[0] - x[0] == 0 && x[1] - x[1] == 0 && x[2] - x[2] == 0;
}

static bool config_is_sound(const pmesh_encoder_config *c)
{
    return within(c->profile, PMESH_COMPACT, PMESH_QUALITY) &&
           within(c->placement, PMESH_SUBSET, PMESH_OPTIMAL) &&
           within(c->metric, PMESH_MEMORYLESS, PMESH_ACCUMULATED) &&
           within(c->base_coder, PMESH_BASE_NATIVE, PMESH_BASE_DRACO) &&
           within(c->topology, PMESH_TOPOLOGY_AUTO, PMESH_TOPOLOGY_JOIN) &&
           (c->base_coder == PMESH_BASE_NATIVE ||
            (c->base_encoder && c->base_decoder)) &&
           within(c->position_bits, 4, 24) && within(c->normal_bits, 4, 16) &&
           within(c->texcoord_bits, 4, 16) && within(c->color_bits, 4, 16) &&
           within(c->generic_bits, 4, 16) && is_amount(c->weld) &&
           is_amount(c->threshold) && is_amount(c->base_ratio) &&
           is_amount(c->base_error) && is_weight(c->normal_weight) &&
           is_weight(c->texcoord_weight) && is_weight(c->color_weight) &&
           is_weight(c->generic_weight) &&
           within(c->cost, PMESH_COST_QUADRIC, PMESH_COST_CUSTOM) &&
           (c->cost != PMESH_COST_CUSTOM || c->cost_hook) &&
           is_finite(c->camera) &&
           !c->allocator.alloc == !c->allocator.release;
}

/* One file in the making, and all that it owns but the mesh. */
typedef struct job {
    pmesh_encoder_config config;
    pmesh_encode_report *report;
    const enc_mesh *mesh;
    enc_schedule schedule;
    enc_replay replay;
    enc_stream stream;
    enc_inflate inflate;
    enc_measure measure;
    pmesh_header_chunk header;
    uint8_t *room;
    size_t room_size;
    uint64_t bytes_base;
} job;

static double now(const job *j)
{
    return j->report->clock ? j->report->clock() : 0;
}

static bool cancelled(const job *j, const char *stage, double done)
{
    return j->config.progress &&
           j->config.progress(j->config.progress_user, stage, done);
}

/* ---- the level table --------------------------------------------------- */

/* Level k is the mesh after all batches but the last k. Bounds are rounded up,
 * to a finite float. */
static void fill_errors(job *j)
{
    const enc_schedule *s = &j->schedule;
    j->header.levels[s->batch_count].error = 0;
    for (uint32_t b = 0; b < s->batch_count; b++)
        j->header.levels[s->batch_count - b - 1].error = pmesh_narrow(
            s->batch_error[b] * j->mesh->grid.step * (1 + FLT_EPSILON));
}

static pmesh_status finish_level(job *j, uint32_t level)
{
    const pmesh_mesh *m = &j->replay.codec.mesh;
    pmesh_level_entry *e = &j->header.levels[level];
    e->bytes = j->stream.size;
    e->faces = m->face_count;
    e->vertices = m->vertex_count;
    e->wedges = m->wedge_count;
    if (level == j->schedule.batch_count)
        return PMESH_OK;
    e->inflation = enc_inflate_level(&j->inflate, m);
    if (!j->header.measured)
        return PMESH_OK;
    const enc_triangles shown = { m->vertex, (const int32_t(*)[3])m->position,
                                  m->face_count };
    return enc_measure_level(&j->measure, &shown, &e->rms, &e->most);
}

/* ---- chunks ------------------------------------------------------------ */

static double raw_split_bits(const job *j)
{
    double bits = 3.0 * j->mesh->grid.bits * (j->replay.moves ? 2 : 1) + 20;
    for (uint32_t i = 0; i < j->mesh->attribute_count; i++)
        bits += 2.0 * PMESH_MAX_COMPONENTS * j->mesh->attribute[i].bits;
    return bits;
}

static size_t larger(size_t a, size_t b)
{
    return a > b ? a : b;
}

static bool make_room(job *j, const pmesh_mesh_input *in)
{
    const size_t wedges =
        j->mesh->value_count ? 3 * (size_t)j->replay.base_faces : 0;
    const size_t base = BASE_FACE_ROOM * (size_t)j->replay.base_faces +
                        BASE_WEDGE_ROOM * wedges;
    const double splits = SPLIT_ROOM * raw_split_bits(j) / 8 *
                          j->schedule.contraction_count;
    const bool plain = j->mesh->value_count == 0 && !j->mesh->joined;
    const size_t block = plain && splits < BLOCK_ROOM
                             ? 2 * PMESH_BLOCK_CHUNK_SIZE + (size_t)splits
                             : BLOCK_ROOM;
    j->room_size = larger(base, block);
    if (in->material_names)
        j->room_size = larger(j->room_size, PMESH_MAX_NAMES_SIZE);
    j->room = pmesh_alloc(&j->config.allocator, j->room_size, 1);
    return j->room != NULL;
}

/* Names with their final zeros, one after the other; none if nothing is named
 * or they would be too long. */
static void write_names(job *j, const pmesh_mesh_input *in)
{
    pmesh_writer out = { j->room, 0, PMESH_MAX_NAMES_SIZE, false };
    for (uint32_t i = 0; in->material_names && i < in->material_count; i++) {
        const char *name = in->material_names[i] ? in->material_names[i] : "";
        for (; *name; name++)
            pmesh_put(&out, (uint8_t)*name, 1);
        pmesh_put(&out, 0, 1);
    }
    if (out.overflow || out.size == 0)
        return;
    j->header.names_size = (uint32_t)out.size;
    enc_stream_chunk(&j->stream, PMESH_CHUNK_NAMES, j->room,
                     (uint32_t)out.size);
}

static pmesh_status write_base(job *j)
{
    pmesh_writer out = { j->room, 0, j->room_size, false };
    const pmesh_status status = enc_replay_base(&j->replay, &j->config, &out);
    if (status != PMESH_OK)
        return status;
    if (out.size > PMESH_MAX_CHUNK_SIZE)
        return PMESH_E_LIMIT;
    enc_stream_chunk(&j->stream, PMESH_CHUNK_BASE, j->room, (uint32_t)out.size);
    j->bytes_base = out.size;
    const pmesh_mesh *m = &j->replay.codec.mesh;
    const pmesh_status measured = finish_level(j, 0);
    if (measured != PMESH_OK)
        return measured;
    return enc_count_pieces(&j->config.allocator, m->vertex,
                            3 * m->face_count, m->vertex_count,
                            &j->report->base_components);
}

/* What the decoder's view will list: see dec_view.c. */
static uint32_t count_moved_corners(const pmesh_codec *c)
{
    const pmesh_mesh *m = &c->mesh;
    uint32_t count = 0;
    for (uint32_t i = 0; i < c->block.vertex_count; i++) {
        uint32_t start = m->first[c->block.vertex + i];
        for (uint32_t h = start; h != PMESH_NONE;
             h = pmesh_corner_next(m, &start, h))
            count += h < 3 * c->child_face[i];
    }
    return count;
}

static uint32_t largest(uint32_t a, uint32_t b)
{
    return a > b ? a : b;
}

/* One block of at most `splits` splits; *bits becomes what a split took. */
static pmesh_status write_block(job *j, uint32_t splits, double *bits)
{
    enum { COUNT_ROOM = 5 };
    enc_replay *r = &j->replay;
    pmesh_writer head = { j->room, 0, COUNT_ROOM, false };
    pmesh_put_varint(&head, splits);
    pmesh_writer out = { j->room + head.size, 0, j->room_size - head.size,
                         false };
    pmesh_coder coder;
    pmesh_coder_encode(&coder, &out);
    const pmesh_status status = enc_replay_block(r, &coder, splits);
    if (status != PMESH_OK)
        return status;
    if (!pmesh_coder_finish(&coder))
        return PMESH_E_LIMIT;
    const size_t size = head.size + out.size;
    enc_stream_chunk(
        &j->stream, r->splits_left ? PMESH_CHUNK_BLOCK : PMESH_CHUNK_BLOCK_LAST,
        j->room, (uint32_t)size);
    *bits = 8.0 * (double)size / splits;

    pmesh_codec_sizes *s = &j->header.sizes;
    s->block_splits = largest(s->block_splits, splits);
    if (s->joined)
        s->block_faces = largest(s->block_faces, r->codec.block.face_count);
    s->block_wedges = largest(
        s->block_wedges, j->mesh->value_count ? r->codec.block.wedge_count : 0);
    j->header.moved_corners += count_moved_corners(&r->codec);
    return PMESH_OK;
}

/* Splits are expected to cost a quarter more than those of the block before;
 * the first ones, all their bits. */
static uint32_t splits_of_block(const job *j, double bits)
{
    const double room =
        j->config.profile == PMESH_COMPACT ? COMPACT_BLOCK : BLOCK;
    const double fit = 8.0 * room / (1.25 * bits + 8);
    const uint32_t limit = fit < 1 ? 1
                           : fit < PMESH_MAX_BLOCK_SPLITS
                               ? (uint32_t)fit
                               : PMESH_MAX_BLOCK_SPLITS;
    return j->replay.splits_left < limit ? j->replay.splits_left : limit;
}

static pmesh_status write_levels(job *j)
{
    const enc_schedule *s = &j->schedule;
    double bits = raw_split_bits(j);
    for (uint32_t level = 1; level <= s->batch_count; level++) {
        enc_replay_begin(&j->replay, s->batch_count - level);
        while (j->replay.splits_left) {
            const pmesh_status status =
                write_block(j, splits_of_block(j, bits), &bits);
            if (status != PMESH_OK)
                return status;
            if (cancelled(j, "code",
                          (double)j->replay.codec.mesh.face_count /
                              j->mesh->face_count))
                return PMESH_E_CANCELLED;
        }
        const pmesh_status status = finish_level(j, level);
        if (status != PMESH_OK)
            return status;
    }
    return PMESH_OK;
}

/* ---- the whole --------------------------------------------------------- */

static void fill_header(job *j)
{
    pmesh_header_chunk *h = &j->header;
    const enc_mesh *m = j->mesh;
    h->profile = j->config.profile;
    h->base_coder = j->replay.base_coder;
    h->grid = m->grid;
    memcpy(h->bounds, m->bounds, sizeof h->bounds);
    h->sizes.attribute_count = m->attribute_count;
    h->sizes.value_count = m->value_count;
    h->sizes.material_count = m->material_count;
    h->sizes.moves = j->replay.moves;
    if (h->sizes.joined)
        h->sizes.base_fans = j->replay.codec.sizes.base_fans;
    h->attribute_count = m->attribute_count;
    memcpy(h->attributes, m->attribute, sizeof h->attributes);
    h->level_count = j->schedule.batch_count + 1;
}

static void fill_report(job *j, uint64_t header_size, uint64_t file_size)
{
    pmesh_encode_report *r = j->report;
    const pmesh_header_chunk *h = &j->header;
    const pmesh_codec *c = &j->replay.codec;
    r->grid = j->mesh->grid;
    r->faces = c->mesh.face_count;
    r->vertices = c->mesh.vertex_count;
    r->wedges = c->mesh.wedge_count;
    r->base_coder = h->base_coder;
    r->base_faces = h->levels[0].faces;
    r->base_vertices = h->levels[0].vertices;
    r->end = j->schedule.end;
    r->level_count = h->level_count;
    for (uint32_t i = 0; i < h->level_count; i++) {
        const pmesh_level_entry *e = &h->levels[i];
        const double unit = h->grid.step / PMESH_MEASURE_UNIT;
        r->levels[i] = (pmesh_level){
            .bytes = header_size + e->bytes,
            .faces = e->faces,
            .mesh_vertices = e->vertices,
            .vertices = e->wedges,
            .error = e->error,
            .inflation = (float)e->inflation / PMESH_INFLATE_ONE,
            .rms = pmesh_narrow(unit * e->rms),
            .furthest = pmesh_narrow(unit * e->most)
        };
    }
    r->measured = h->measured;
    r->bytes = file_size;
    r->bytes_base = j->bytes_base;
    r->bytes_connectivity = c->part_size[0];
    r->bytes_positions = c->part_size[1];
    r->bytes_attributes = c->part_size[2];
    r->bytes_lossless = h->exact_size;
    r->attribute_count = h->attribute_count;
    for (uint32_t i = 0; i < h->attribute_count; i++)
        r->attributes[i] = (pmesh_attribute_size){
            .kind = h->attributes[i].kind, .set = h->attributes[i].set,
            .bytes = (c->attribute_spent[i] + SPENT_BYTE / 2) / SPENT_BYTE
        };
    r->bytes_header = file_size - r->bytes_base - r->bytes_connectivity -
                      r->bytes_positions - r->bytes_attributes -
                      r->bytes_lossless;
}

static pmesh_status code(job *j, const pmesh_mesh_input *in)
{
    pmesh_status status =
        enc_replay_create(&j->replay, j->mesh, &j->schedule,
                          j->config.placement == PMESH_OPTIMAL);
    if (status != PMESH_OK)
        return status;
    status = enc_inflate_create(j->mesh, &j->inflate);
    if (status != PMESH_OK)
        return status;
    if (j->config.measure)
        status = enc_measure_create(j->mesh, &j->measure);
    if (status != PMESH_OK)
        return status;
    if (!make_room(j, in))
        return PMESH_E_MEMORY;
    j->header.measured = j->config.measure;
    j->header.sizes.joined = j->mesh->joined;
    write_names(j, in);
    status = write_base(j);
    if (status == PMESH_OK)
        status = write_levels(j);
    if (status == PMESH_OK && j->mesh->exact)
        status = enc_exact_write(&j->replay, &j->stream, j->room, &j->header);
    enc_schedule_settle(&j->schedule);
    fill_errors(j);
    return status;
}

/* Accepts NULL. */
static void job_destroy(job *j)
{
    if (!j)
        return;
    const pmesh_allocator a = j->config.allocator;
    pmesh_release(&a, j->room, j->room_size, 1);
    enc_inflate_destroy(&j->inflate);
    enc_measure_destroy(&j->measure);
    enc_stream_destroy(&j->stream);
    enc_replay_destroy(&j->replay);
    enc_schedule_destroy(&j->schedule);
    pmesh_release(&a, j, 1, sizeof *j);
}

/* Everything but the header, by one variant of the profile; NULL if that
 * fails. A job is too large for the stack. */
static job *draft(const enc_mesh *mesh, const pmesh_mesh_input *in,
                  const pmesh_encoder_config *config, uint32_t variant,
                  pmesh_encode_report *report, pmesh_status *status)
{
    enc_schedule schedule;
    const double start = report->clock ? report->clock() : 0;
    *status = enc_schedule_build(mesh, config, variant, &schedule);
    const double contracted = report->clock ? report->clock() : 0;
    report->seconds_contract += contracted - start;
    if (*status != PMESH_OK)
        return NULL;
    job *j = pmesh_alloc_zero(&config->allocator, 1, sizeof *j);
    if (!j) {
        enc_schedule_destroy(&schedule);
        *status = PMESH_E_MEMORY;
        return NULL;
    }
    j->config = *config;
    j->report = report;
    j->mesh = mesh;
    j->schedule = schedule;
    enc_stream_init(&j->stream, config->allocator);
    *status = code(j, in);
    report->seconds_code += now(j) - contracted;
    if (*status == PMESH_OK) {
        fill_header(j);
        return j;
    }
    job_destroy(j);
    return NULL;
}

/* The second variant, in a thread of its own: without hooks of the caller. */
typedef struct rival {
    const enc_mesh *mesh;
    const pmesh_mesh_input *in;
    pmesh_encoder_config config;
    pmesh_encode_report report;
    pmesh_status status;
    job *made;
} rival;

static void draft_rival(void *user, uint32_t part, unsigned worker)
{
    rival *r = user;
    (void)part;
    (void)worker;
    r->made = draft(r->mesh, r->in, &r->config, 1, &r->report, &r->status);
}

/* There are two at most. They go into one thread each if there are two threads
 * and the allocator can bear it: see wants_rivals(). */
static void draft_all(rival *second, enc_pool *pool, job **first,
                      const pmesh_encoder_config *config,
                      pmesh_encode_report *report, pmesh_status *status)
{
    const bool two = enc_schedule_variants(config) > 1;
    if (two && pool)
        enc_pool_begin(pool, 1, draft_rival, second);
    *first = draft(second->mesh, second->in, config, 0, report, status);
    if (two && pool)
        enc_pool_end(pool);
    else if (two && *first)
        draft_rival(second, 0, 0);
}

/* Of all variants the one that becomes smallest; NULL if one fails. pool: for
 * the variants. */
static job *draft_best(const enc_mesh *mesh, const pmesh_mesh_input *in,
                       const pmesh_encoder_config *config, enc_pool *pool,
                       pmesh_encode_report *report, pmesh_status *status)
{
    rival *other =
        pmesh_alloc_zero(&config->allocator, 1, sizeof *other);
    job *best = NULL;
    *status = PMESH_E_MEMORY;
    if (!other)
        return NULL;
    *other = (rival){ .mesh = mesh, .in = in, .config = *config };
    if (pool)
        other->config.progress = NULL;
    else
        other->report.clock = report->clock;
    draft_all(other, pool, &best, config, report, status);
    if (best && other->status != PMESH_OK)
        *status = other->status;
    report->seconds_contract += other->report.seconds_contract;
    report->seconds_code += other->report.seconds_code;
    if (other->made && best && other->made->stream.size < best->stream.size) {
        job *const worse = best;
        best = other->made;
        best->report = report;
        report->base_components = other->report.base_components;
        other->made = worse;
    }
    job_destroy(other->made);
    pmesh_release(&config->allocator, other, 1, sizeof *other);
    if (*status == PMESH_OK)
        return best;
    job_destroy(best);
    return NULL;
}

/* Each variant in a thread is better than the threads for each variant. Draco's
 * hooks are the caller's, and stay in its thread. */
static bool wants_rivals(const pmesh_encoder_config *config,
                         const enc_pool *pool)
{
    return pool && enc_schedule_variants(config) > 1 &&
           config->base_coder == PMESH_BASE_NATIVE;
}

static pmesh_status run(const pmesh_mesh_input *in,
                        const pmesh_encoder_config *config, enc_pool *pool,
                        pmesh_write write, void *user,
                        pmesh_encode_report *report)
{
    enc_mesh mesh;
    const double start = report->clock ? report->clock() : 0;
    pmesh_status status = enc_mesh_import(in, config, pool, &mesh, report);
    if (status != PMESH_OK)
        return status;
    const bool rivals = wants_rivals(config, pool);
    if (rivals)
        mesh.pool = NULL;
    report->seconds_import = (report->clock ? report->clock() : 0) - start;

    job *j = draft_best(&mesh, in, config, rivals ? pool : NULL, report,
                        &status);
    if (j) {
        uint64_t header_size, file_size;
        status = enc_stream_write(&j->stream, &j->header, write, user,
                                  &header_size, &file_size);
        if (status == PMESH_OK)
            fill_report(j, header_size, file_size);
    }
    job_destroy(j);
    enc_mesh_destroy(&mesh);
    return status;
}

pmesh_status pmesh_encode(const pmesh_mesh_input *mesh,
                          const pmesh_encoder_config *config, pmesh_write write,
                          void *user, pmesh_encode_report *report)
{
    pmesh_encode_report unwanted;
    if (!mesh || !config || !write || !config_is_sound(config))
        return PMESH_E_ARGUMENT;
    double (*const clock)(void) = report ? report->clock : NULL;
    if (!report)
        report = &unwanted;
    *report = (pmesh_encode_report){ .clock = clock };

    pmesh_encoder_config resolved = *config;
    resolved.allocator = pmesh_allocator_resolve(config->allocator);
    /* Hooks of the caller run in the caller's thread. */
    const uint32_t threads =
        config->cost == PMESH_COST_CUSTOM ? 1 : config->threads;
    enc_pool *pool = enc_pool_create(&resolved.allocator, threads);
    if (wants_rivals(config, pool))
        resolved.allocator = enc_pool_allocator(pool);
    const pmesh_status status =
        run(mesh, &resolved, pool, write, user, report);
    enc_pool_destroy(pool);
    return status;
}
