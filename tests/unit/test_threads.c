/* SPDX-License-Identifier: MIT */
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "encoder/enc_pipe.h"
#include "encoder/enc_pool.h"
#include "format/alloc.h"
#include "tests/unit/shapes.h"
#include "tests/unit/test.h"

/* ---- the pool ------------------------------------------------------------ */

enum { PARTS = 1000, WORKERS = 3 };

typedef struct counts {
    uint8_t part[PARTS];
    uint32_t worker[WORKERS];
} counts;

static void count_part(void *user, uint32_t part, unsigned worker)
{
    counts *c = user;

    c->part[part]++;
    c->worker[worker]++; /* a worker does one part at a time */
}

static enc_pool *pool_of(uint32_t threads)
{
    const pmesh_allocator a = pmesh_allocator_resolve((pmesh_allocator){ 0 });
    return enc_pool_create(&a, threads);
}

static void check_counts(enc_pool *pool)
{
    counts c = { { 0 }, { 0 } };
    uint32_t sum = 0;

    enc_pool_run(pool, PARTS, count_part, &c);
    for (int i = 0; i < PARTS; i++)
        CHECK(c.part[i] == 1);
    for (int i = 0; i < WORKERS; i++)
        sum += c.worker[i];
    CHECK(sum == PARTS);
    for (unsigned i = enc_pool_workers(pool); i < WORKERS; i++)
        CHECK(c.worker[i] == 0);
}

TEST(pool_does_each_part_once)
{
    for (uint32_t threads = 0; threads <= WORKERS; threads++) {
        enc_pool *pool = pool_of(threads);
        CHECK(threads > 1 || !pool);
        for (int i = 0; i < 50; i++)
            check_counts(pool);
        enc_pool_destroy(pool);
    }
}

TEST(pool_leaves_the_calling_thread_free)
{
    enc_pool *pool = pool_of(2);
    counts c = { { 0 }, { 0 } };

    enc_pool_begin(pool, PARTS, count_part, &c);
    enc_pool_end(pool);
    for (int i = 0; i < PARTS; i++)
        CHECK(c.part[i] == 1);
    enc_pool_run(pool, 0, count_part, &c);
    enc_pool_destroy(pool);
}

/* ---- aside --------------------------------------------------------------- */

typedef struct chore {
    enc_pool *pool;
    uint32_t done; /* parts */
    bool disorder, busy;
} chore;

static void do_aside(void *user, uint32_t part, unsigned worker)
{
    chore *c = user;

    c->disorder |= c->busy || part != c->done;
    c->busy = true;
    for (int i = 0; i < 10; i++)
        enc_pool_give_way(c->pool, worker);
    c->busy = false;
    c->done++;
}

TEST(pool_does_work_aside_in_order_while_loops_go_on)
{
    for (uint32_t threads = 2; threads <= WORKERS; threads++) {
        enc_pool *pool = pool_of(threads);
        for (uint32_t parts = 0; parts <= 60; parts += 20) {
            chore c = { .pool = pool };
            enc_pool_aside(pool, do_aside, &c);
            for (uint32_t i = 0; i < parts; i++) {
                enc_pool_aside_more(pool);
                check_counts(pool);
            }
            enc_pool_aside_end(pool);
            CHECK(c.done == parts && !c.disorder);
        }
        enc_pool_destroy(pool);
    }
}

/* ---- the pipe ------------------------------------------------------------ */

enum { ENTRIES = 30000 }; /* several times what the pipe holds */

typedef struct reader {
    enc_pipe *pipe;
    uint32_t read, wrong;
} reader;

static uint32_t size_of(uint32_t i)
{
    return 4 + i * 7919 % (i % 100 ? 300 : ENC_PIPE_MOST - 4);
}

/* An entry is its number, over and over. */
static void read_all(void *user, uint32_t part, unsigned worker)
{
    reader *r = user;
    const uint8_t *entry;

    (void)part;
    (void)worker;
    while ((entry = enc_pipe_next(r->pipe))) {
        const uint32_t size = size_of(r->read);
        for (uint32_t k = 0; k + 4 <= size; k += 4)
            r->wrong += memcmp(entry + k, &r->read, 4) != 0;
        r->read++;
    }
}

static void write_all(enc_pipe *pipe, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t size = size_of(i);
        uint8_t *entry = enc_pipe_room(pipe, size);
        for (uint32_t k = 0; k + 4 <= size; k += 4)
            memcpy(entry + k, &i, 4);
        if (i % 1000 == 0)
            enc_pipe_flush(pipe);
    }
    enc_pipe_close(pipe);
}

TEST(pipe_tells_everything_in_order)
{
    const pmesh_allocator a = pmesh_allocator_resolve((pmesh_allocator){ 0 });
    enc_pool *pool = pool_of(2);
    reader r = { .pipe = enc_pipe_create(&a) };

    for (uint32_t count = 0; count <= ENTRIES; count += ENTRIES / 3) {
        enc_pipe_open(r.pipe);
        r.read = 0;
        enc_pool_begin(pool, 1, read_all, &r);
        write_all(r.pipe, count);
        enc_pool_end(pool);
        CHECK(r.read == count && r.wrong == 0);
    }
    enc_pipe_open(r.pipe); /* nobody else reads */
    r.read = 0;
    write_all(r.pipe, 1000);
    read_all(&r, 0, 0);
    CHECK(r.read == 1000 && r.wrong == 0);
    enc_pipe_destroy(r.pipe);
    enc_pool_destroy(pool);
}

/* ---- bytes --------------------------------------------------------------- */

static shape_bytes bake(const shape_mesh *shape, pmesh_encoder_config config,
                        uint32_t threads, pmesh_encode_report *report)
{
    shape_bytes bytes;

    config.threads = threads;
    report->clock = NULL;
    CHECK(shape_bake(shape, &config, &bytes, report) == PMESH_OK);
    return bytes;
}

static void check_parts(const pmesh_encode_report *a,
                        const pmesh_encode_report *b)
{
    CHECK(a->bytes_connectivity == b->bytes_connectivity);
    CHECK(a->bytes_positions == b->bytes_positions);
    CHECK(a->bytes_attributes == b->bytes_attributes);
    for (uint32_t i = 0; i < a->attribute_count; i++)
        CHECK(a->attributes[i].bytes == b->attributes[i].bytes);
}

static void check_threads(const shape_mesh *shape,
                          const pmesh_encoder_config *config)
{
    pmesh_encode_report report, other;
    const shape_bytes one = bake(shape, *config, 1, &report);

    for (uint32_t threads = 2; threads <= 4; threads += 2) {
        const shape_bytes more = bake(shape, *config, threads, &other);
        CHECK(one.size == more.size &&
              memcmp(one.data, more.data, one.size) == 0);
        check_parts(&report, &other);
        free(more.data);
    }
    free(one.data);
}

/* Large enough for several blocks of vertices. */
static const struct {
    shape_kind kind;
    uint32_t size;
} subjects[] = {
    { SHAPE_SPHERE, 34 }, { SHAPE_TERRAIN, 50 }, { SHAPE_TORUS, 50 },
    { SHAPE_FACETS, 16 }, { SHAPE_SOUP, 24 },    { SHAPE_PIECES, 30 },
};

static void check_all(const pmesh_encoder_config *config)
{
    for (size_t i = 0; i < sizeof subjects / sizeof *subjects; i++) {
        shape_mesh *shape = shape_make(subjects[i].kind, subjects[i].size, 7);
        check_threads(shape, config);
        shape_free(shape);
    }
}

TEST(threads_do_not_change_a_byte_of_any_profile)
{
    for (int profile = PMESH_COMPACT; profile <= PMESH_QUALITY; profile++) {
        pmesh_encoder_config config = pmesh_encoder_config_default();
        config.profile = (pmesh_profile)profile;
        check_all(&config);
    }
}

TEST(threads_do_not_change_a_byte_of_moving_vertices)
{
    for (int metric = 0; metric < 2; metric++) {
        pmesh_encoder_config config = pmesh_encoder_config_default();
        config.placement = PMESH_OPTIMAL;
        config.metric = (pmesh_metric)metric;
        check_all(&config);
    }
}

TEST(threads_do_not_change_a_byte_of_bounds_and_measures)
{
    pmesh_encoder_config config = pmesh_encoder_config_default();
    config.measure = 1;
    config.base_error = 0.02;
    config.position_bits = 24;
    config.topology = PMESH_TOPOLOGY_JOIN;
    check_all(&config);
}

/* Most faces share one vertex with others: many lone ones come with a split. */
TEST(threads_do_not_change_a_byte_of_joined_faces)
{
    enum { VERTICES = 3000, FACES = 2500 };
    pmesh_encoder_config config = pmesh_encoder_config_default();
    shape_mesh *shape = shape_make(SHAPE_SOUP, VERTICES, 3);
    uint32_t seed = 1;

    shape->input.face_count = FACES;
    for (int i = 0; i < 3 * VERTICES; i++)
        shape->positions[i] += shape_random(&seed, 1000) / 1000.0;
    config.topology = PMESH_TOPOLOGY_JOIN;
    check_threads(shape, &config);
    shape_free(shape);
}

/* Edges are paired by blocks of vertices; the half-edges of a face may lie in
 * several. */
TEST(threads_do_not_change_a_byte_of_repeated_faces)
{
    const pmesh_encoder_config config = pmesh_encoder_config_default();
    shape_mesh *shape = shape_make(SHAPE_TORUS, 60, 3);
    const size_t count = shape->input.face_count;
    uint32_t *face = shape->indices;
    pmesh_encode_report report;

    for (size_t i = 0; i + 1 < count; i += 7) /* turned by one corner */
        for (size_t k = 0; k < 3; k++)
            face[3 * i + k] = face[3 * (i + 1) + (k + 1) % 3];
    free(bake(shape, config, 2, &report).data);
    CHECK(report.duplicate_faces == (count + 5) / 7);
    check_threads(shape, &config);
    shape_free(shape);
}

/* ---- hooks --------------------------------------------------------------- */

typedef struct witness {
    pthread_t caller;
    bool elsewhere; /* a hook was called in another thread */
    uint32_t cost, progress;
} witness;

static double watch_cost(void *user, const pmesh_simplify_pair *pair)
{
    witness *w = user;
    w->elsewhere |= !pthread_equal(w->caller, pthread_self());
    w->cost++;
    return pair->quadric;
}

static int watch_progress(void *user, const char *stage, double done)
{
    witness *w = user;
    (void)stage;
    w->elsewhere |= !pthread_equal(w->caller, pthread_self());
    w->progress++;
    return done < 0;
}

TEST(hooks_are_called_in_the_thread_of_the_caller)
{
    for (int profile = PMESH_COMPACT; profile <= PMESH_QUALITY; profile++) {
        shape_mesh *shape = shape_make(SHAPE_TORUS, 80, 1);
        witness w = { .caller = pthread_self() };
        pmesh_encode_report report;
        pmesh_encoder_config config = pmesh_encoder_config_default();
        config.profile = (pmesh_profile)profile;
        config.progress = watch_progress;
        config.progress_user = &w;
        free(bake(shape, config, 4, &report).data);
        config.cost = PMESH_COST_CUSTOM;
        config.cost_hook = watch_cost;
        config.cost_user = &w;
        free(bake(shape, config, 4, &report).data);
        CHECK(!w.elsewhere && w.cost > 0 && w.progress > 0);
        shape_free(shape);
    }
}

/* Of the allocator: one call at a time, wherever from. Fails once. */
typedef struct meter {
    unsigned calls, fail_at;
    long blocks;
    bool busy, overlapped;
} meter;

static void *meter_alloc(void *user, size_t size)
{
    meter *m = user;
    m->overlapped |= m->busy;
    m->busy = true;
    void *block = ++m->calls == m->fail_at ? NULL : malloc(size);
    m->blocks += block != NULL;
    m->busy = false;
    return block;
}

static void meter_release(void *user, void *block, size_t size)
{
    meter *m = user;
    (void)size;
    m->overlapped |= m->busy;
    m->blocks -= block != NULL;
    free(block);
}

TEST(threads_survive_a_lack_of_memory)
{
    shape_mesh *shape = shape_make(SHAPE_SPHERE, 24, 2);
    for (int profile = PMESH_COMPACT; profile <= PMESH_BALANCED; profile++) {
        pmesh_encode_report report = { .clock = NULL };
        unsigned fail = 1, calls;
        do {
            meter m = { .fail_at = fail };
            shape_bytes bytes;
            pmesh_encoder_config config = pmesh_encoder_config_default();
            config.profile = (pmesh_profile)profile;
            config.threads = 3;
            config.measure = 1;
            config.allocator =
                (pmesh_allocator){ meter_alloc, meter_release, &m };
            const pmesh_status status =
                shape_bake(shape, &config, &bytes, &report);
            CHECK(status == PMESH_OK || status == PMESH_E_MEMORY);
            CHECK(m.blocks == 0 && !m.overlapped);
            calls = m.calls;
            free(bytes.data);
            fail += 1 + fail / 8;
        } while (fail <= calls);
    }
    shape_free(shape);
}
