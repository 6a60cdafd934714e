/* SPDX-License-Identifier: MIT */
/* What the libraries need is bounded by what they were given: stack, memory,
 * time. */
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "decoder/pmesh_scene.h"
#include "encoder/pmesh_scene_encode.h"
#include "format/crc32c.h"
#include "format/cursor.h"
#include "format/header.h"
#include "format/layout.h"
#include "tests/unit/shapes.h"
#include "tests/unit/test.h"

/* ---- stack -------------------------------------------------------------- */

enum { STACK = 64 << 10 };

static int collect(void *user, const void *data, size_t size)
{
    shape_bytes *out = user;
    out->data = realloc(out->data, out->size + size + 1);
    CHECK(out->data);
    memcpy(out->data + out->size, data, size);
    out->size += size;
    return 0;
}

static shape_bytes bake(shape_kind kind, pmesh_placement placement,
                        int lossless, pmesh_topology topology)
{
    shape_mesh *s = shape_make(kind, kind == SHAPE_SOUP ? 60 : 12, 5);
    pmesh_encoder_config config = pmesh_encoder_config_default();
    pmesh_encode_report report;
    shape_bytes out;
    config.base_faces = 40;
    config.placement = placement;
    config.lossless = lossless;
    config.topology = topology;
    CHECK(shape_bake(s, &config, &out, &report) == PMESH_OK);
    shape_free(s);
    return out;
}

/* All that reads of a mesh, or moves it. */
static void use(pmesh_decoder *dec)
{
    const pmesh_target low = { .faces = 1 };
    const double origin[3] = { 0, 0, 9 }, direction[3] = { 0.1, 0.1, -1 };
    double a[3], b[3];
    pmesh_changes changes;
    pmesh_view v;
    pmesh_hit hit;
    CHECK(pmesh_decoder_refine(dec, &low, &changes) == PMESH_OK);
    CHECK(pmesh_decoder_refine(dec, NULL, &changes) == PMESH_OK);
    CHECK(pmesh_decoder_mesh(dec, &v) == PMESH_OK);
    float *xyz = malloc(12 * (size_t)v.vertex_count);
    CHECK(pmesh_decoder_copy_positions(dec, xyz, 0) == PMESH_OK);
    CHECK(pmesh_decoder_bounds(dec, a, b) == PMESH_OK);
    pmesh_decoder_raycast(dec, origin, direction, &hit);
    free(xyz);
}

static void *decode_mesh(void *bytes)
{
    const shape_bytes *b = bytes;
    pmesh_status status;
    pmesh_decoder *dec = shape_decode(b->data, b->size, 1000, &status);
    CHECK(status == PMESH_OK);
    use(dec);
    pmesh_decoder_destroy(dec);
    return NULL;
}

static void *decode_scene(void *bytes)
{
    const shape_bytes *b = bytes;
    pmesh_scene *scene;
    CHECK(pmesh_scene_create(&scene, NULL) == PMESH_OK);
    CHECK(pmesh_scene_feed(scene, b->data, b->size) == PMESH_OK);
    CHECK(pmesh_scene_refine(scene, NULL, NULL) == PMESH_OK);
    pmesh_scene_destroy(scene);
    return NULL;
}

static void run_in_small_stack(void *(*run)(void *), shape_bytes *bytes)
{
    pthread_attr_t attributes;
    pthread_t thread;
    CHECK(pthread_attr_init(&attributes) == 0);
    CHECK(pthread_attr_setstacksize(&attributes, STACK) == 0);
    CHECK(pthread_create(&thread, &attributes, run, bytes) == 0);
    CHECK(pthread_join(thread, NULL) == 0);
    pthread_attr_destroy(&attributes);
}

TEST(decoder_runs_in_64_kib_of_stack)
{
#if defined(__SANITIZE_ADDRESS__)
    return; /* frames are larger by far */
#endif
    for (int kind = 0; kind < SHAPE_COUNT; kind++)
        for (int way = 0; way < 4; way++) {
            shape_bytes b = bake((shape_kind)kind, (pmesh_placement)(way & 1),
                                 way > 1,
                                 way == 3 ? PMESH_TOPOLOGY_JOIN
                                          : PMESH_TOPOLOGY_AUTO);
            run_in_small_stack(decode_mesh, &b);
            const pmesh_scene_mesh_input mesh = { b.data, b.size, 1 };
            const pmesh_scene_input input = { .meshes = &mesh,
                                              .mesh_count = 1 };
            shape_bytes scene = { 0 };
            CHECK(pmesh_scene_encode(&input, NULL, collect, &scene, NULL) ==
                  PMESH_OK);
            run_in_small_stack(decode_scene, &scene);
            free(scene.data);
            free(b.data);
        }
}

/* ---- memory ------------------------------------------------------------- */

typedef struct meter {
    size_t bytes, most;
    unsigned calls;
} meter;

static void *meter_alloc(void *user, size_t size)
{
    meter *m = user;
    m->calls++;
    m->bytes += size;
    m->most = m->most > m->bytes ? m->most : m->bytes;
    return malloc(size);
}

static void meter_release(void *user, void *ptr, size_t size)
{
    ((meter *)user)->bytes -= size;
    free(ptr);
}

/* A header that promises `faces` faces, as the first bytes of a file. */
static size_t make_header(uint32_t faces, uint8_t out[300])
{
    uint8_t payload[200];
    pmesh_writer in = { payload, 0, sizeof payload, false };
    pmesh_writer w = { out, 0, 300, false };
    pmesh_header_chunk h = { .profile = PMESH_BALANCED,
                             .chunk_size = 65536,
                             .level_count = 2,
                             .grid = { .step = 1, .bits = 14 } };
    h.sizes.material_count = 1;
    h.levels[0] = (pmesh_level_entry){ .bytes = 100, .faces = 12,
                                       .vertices = 8, .wedges = 8,
                                       .error = 1 };
    h.levels[1] = (pmesh_level_entry){ .bytes = 200, .faces = faces,
                                       .vertices = 8 + (faces - 12) / 2,
                                       .wedges = 8 + (faces - 12) / 2 };
    h.sizes.block_splits = 1;
    pmesh_header_write(&in, &h);
    memcpy(out, PMESH_SIGNATURE, PMESH_SIGNATURE_SIZE);
    w.size = PMESH_SIGNATURE_SIZE;
    pmesh_put(&w, PMESH_CHUNK_HEADER, 1);
    pmesh_put_varint(&w, in.size);
    memcpy(out + w.size, payload, in.size);
    w.size += in.size;
    const uint32_t crc = pmesh_crc32c(0, out + PMESH_SIGNATURE_SIZE,
                                      w.size - PMESH_SIGNATURE_SIZE);
    pmesh_put(&w, crc, 4);
    CHECK(!in.overflow && !w.overflow);
    return w.size;
}

TEST(decoder_takes_no_memory_beyond_its_limit)
{
    static const uint64_t limits[] = { 1, 1000, 100000, 1 << 20, 32 << 20 };
    for (uint32_t faces = 20; faces < 1u << 28; faces = 3 * faces & ~1u)
        for (size_t i = 0; i < sizeof limits / sizeof *limits; i++) {
            uint8_t data[300];
            meter m = { 0 };
            pmesh_decoder_config config = pmesh_decoder_config_default();
            pmesh_decoder *dec;
            pmesh_header h;
            const size_t size = make_header(faces, data);
            config.allocator =
                (pmesh_allocator){ meter_alloc, meter_release, &m };
            config.max_memory = limits[i];
            CHECK(pmesh_decoder_create(&dec, &config) == PMESH_OK);
            const size_t handle = m.most;
            const pmesh_status status = pmesh_decoder_feed(dec, data, size);
            CHECK(status == PMESH_NEED_DATA || status == PMESH_E_LIMIT);
            CHECK(m.most - handle <= limits[i] && m.calls <= 2);
            CHECK(status == PMESH_E_LIMIT ? m.calls == 1 : m.calls == 2);
            if (status == PMESH_NEED_DATA)
                CHECK(pmesh_decoder_header(dec, &h) == PMESH_OK &&
                      h.faces == faces);
            pmesh_decoder_destroy(dec);
            CHECK(m.bytes == 0);
        }
}

/* ---- time --------------------------------------------------------------- */

/* What makes an algorithm quadratic that is not careful. */
typedef enum hard {
    HUB,    /* all faces at one vertex */
    BOOK,   /* all faces at one edge */
    DUST,   /* all faces apart */
    PILE,   /* all faces the same, each of its own material */
    WELDED, /* a plane whose faces share no vertex, but positions */
    HARD_KINDS
} hard;

static const char *const hard_names[] = { "hub", "book", "dust", "pile",
                                           "unwelded" };

enum { SIDE = 300 };

/* Corner k of face i of n, as if the face was alone. */
static void hard_corner(hard kind, uint32_t n, uint32_t i, uint32_t k,
                        double out[3])
{
    static const uint32_t dx[2][3] = { { 0, 1, 0 }, { 1, 1, 0 } };
    static const uint32_t dy[2][3] = { { 0, 0, 1 }, { 0, 1, 1 } };
    const double t = (double)(i + (k == 2)) / n;
    const uint32_t quad = i / 2;
    out[0] = out[1] = out[2] = 0;
    switch (kind) {
    case HUB: /* a spiral around the hub */
        if (k > 0) {
            out[0] = 2 - t;
            out[1] = 100 * t;
            out[2] = t * t;
        }
        break;
    case BOOK: /* pages of all lengths, in no order */
        out[2] = k == 1;
        if (k == 2) {
            out[0] = 1 + t;
            out[1] = (double)(i * (uint64_t)7919 % n) / n;
        }
        break;
    case DUST:
        out[0] = 10.0 * (i % SIDE) + (k == 1);
        out[1] = 10.0 * (i / SIDE) + (k == 2);
        break;
    case PILE:
        out[0] = k == 1;
        out[1] = k == 2;
        break;
    default:
        out[0] = quad % SIDE + dx[i % 2][k];
        out[1] = quad / SIDE + dy[i % 2][k];
        out[2] = (double)((uint32_t)(out[0] * out[1]) % 7) / 10;
        break;
    }
}

/* CPU seconds that baking n such faces down to a base and decoding them takes;
 * the least of two. */
static double time_to(hard kind, uint32_t n, uint32_t base_faces,
                      double *decoding)
{
    double *xyz = malloc(9 * (size_t)n * sizeof *xyz);
    uint32_t *index = malloc(3 * (size_t)n * sizeof *index);
    uint32_t *material = malloc((size_t)n * sizeof *material);
    const uint32_t materials = n < PMESH_MAX_MATERIALS ? n : PMESH_MAX_MATERIALS;
    pmesh_mesh_input in = { .positions = xyz, .indices = index,
                            .face_count = n };
    for (uint32_t i = 0; i < n; i++)
        material[i] = i % materials;
    if (kind == PILE) {
        in.materials = material;
        in.material_count = materials;
    }
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t k = 0; k < 3; k++) {
            const size_t corner = in.vertex_count++;
            hard_corner(kind, n, i, k, xyz + 3 * corner);
            index[corner] = (uint32_t)corner;
        }
    double best = 1e9;
    *decoding = 1e9;
    for (int i = 0; i < 2; i++) {
        pmesh_encoder_config config = pmesh_encoder_config_default();
        shape_bytes out = { 0 };
        pmesh_status status;
        config.base_faces = base_faces;
        clock_t from = clock();
        CHECK(pmesh_encode(&in, &config, collect, &out, NULL) == PMESH_OK);
        const double bake = (double)(clock() - from) / CLOCKS_PER_SEC;
        from = clock();
        pmesh_decoder *dec =
            shape_decode(out.data, out.size, out.size, &status);
        CHECK(status == PMESH_OK);
        CHECK(pmesh_decoder_refine(dec, NULL, NULL) == PMESH_OK);
        const double decode = (double)(clock() - from) / CLOCKS_PER_SEC;
        best = bake < best ? bake : best;
        *decoding = decode < *decoding ? decode : *decoding;
        pmesh_decoder_destroy(dec);
        free(out.data);
    }
    free(material);
    free(index);
    free(xyz);
    return best;
}

/* Ten times the input takes some twelve times as long; a quadratic step would
 * take a hundred times. The bound is wide, as other processes disturb; what is
 * measured is printed with PMESH_FIGURES. */
TEST(ten_times_the_faces_take_no_hundred_times_as_long)
{
    const char *figures = getenv("PMESH_FIGURES");
    const uint32_t n = figures ? 20000 : 2000;
    for (int kind = 0; kind < HARD_KINDS; kind++) {
        double few_decoded, many_decoded;
        const double few = time_to((hard)kind, n, 0, &few_decoded);
        const double many = time_to((hard)kind, 10 * n, 0, &many_decoded);
        if (figures)
            printf("    %s of %u and %u faces: bake %.3f and %.3f s (%.1fx), "
                   "decode %.4f and %.4f s (%.1fx)\n",
                   hard_names[kind], n, 10 * n, few, many, many / few,
                   few_decoded, many_decoded, many_decoded / few_decoded);
        CHECK(many < 30 * few + 0.05);
        CHECK(many_decoded < 30 * few_decoded + 0.05);
    }
}

/* Of a base mesh that is the whole mesh, half-edges are found by their ends:
 * those of a hub, which share one, take no longer than others. */
TEST(base_of_a_hub_takes_no_longer_than_a_plane)
{
    const uint32_t n = 200000;
    double plane, hub;
    const double plane_bake = time_to(WELDED, n, n, &plane);
    const double hub_bake = time_to(HUB, n, n, &hub);
    if (getenv("PMESH_FIGURES"))
        printf("    %u faces: a plane %.3f and %.3f s, a hub %.3f and %.3f s\n",
               n, plane_bake, plane, hub_bake, hub);
    CHECK(hub < 3 * plane + 0.02);
}
