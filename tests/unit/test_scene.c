/* SPDX-License-Identifier: MIT */
/* Many meshes in one file: what goes in comes out, from every prefix, at every
 * budget, and nothing but that from damaged bytes. */
#include <stdlib.h>
#include <string.h>

#include "decoder/pmesh_scene.h"
#include "encoder/pmesh_scene_encode.h"
#include "format/crc32c.h"
#include "format/layout.h"
#include "format/scene.h"
#include "tests/unit/shapes.h"
#include "tests/unit/test.h"

enum { MESHES = 4, RESOURCES = 2 };

typedef struct bytes {
    uint8_t *data;
    size_t size, capacity;
} bytes;

static int collect(void *user, const void *data, size_t size)
{
    bytes *b = user;
    while (b->capacity - b->size < size) {
        b->capacity = b->capacity ? 2 * b->capacity : 1024;
        b->data = realloc(b->data, b->capacity);
        CHECK(b->data);
    }
    if (size > 0)
        memcpy(b->data + b->size, data, size);
    b->size += size;
    return 0;
}

/* A scene of `count` shapes, the kinds in turn. */
typedef struct made {
    size_t count;
    shape_bytes *streams;
    pmesh_scene_mesh_input *meshes;
    uint8_t document[300], image[70000];
    pmesh_scene_blob resources[RESOURCES];
    pmesh_scene_input input;
    pmesh_scene_report report;
    bytes file;
} made;

static made *make(size_t count, int lossless)
{
    made *m = calloc(1, sizeof *m);
    CHECK(m);
    m->count = count;
    m->streams = calloc(count, sizeof *m->streams);
    m->meshes = calloc(count, sizeof *m->meshes);
    CHECK(m->streams && m->meshes);
    for (size_t i = 0; i < count; i++) {
        pmesh_encoder_config config = pmesh_encoder_config_default();
        pmesh_encode_report report;
        config.base_faces = 12;
        config.lossless = lossless;
        shape_mesh *shape = shape_make((shape_kind)(i % SHAPE_COUNT),
                                       8 + (uint32_t)i % 9, (uint32_t)i);
        CHECK(shape_bake(shape, &config, &m->streams[i], &report) ==
              PMESH_OK);
        shape_free(shape);
        m->meshes[i] = (pmesh_scene_mesh_input){
            .stream = m->streams[i].data, .size = m->streams[i].size,
            .scale = (float)(1 + i * i % 7) / 4
        };
    }
    for (size_t i = 0; i < sizeof m->image; i++)
        m->image[i] = (uint8_t)(i * 7);
    memset(m->document, 'd', sizeof m->document);
    m->resources[0] = (pmesh_scene_blob){ m->image, 100 };
    m->resources[1] = (pmesh_scene_blob){ m->image, sizeof m->image };
    m->input = (pmesh_scene_input){
        .meshes = m->meshes, .mesh_count = count,
        .document = { m->document, sizeof m->document },
        .document_form = PMESH_DOCUMENT_ZLIB,
        .resources = m->resources, .resource_count = RESOURCES,
        .early_count = 1
    };
    CHECK(pmesh_scene_encode(&m->input, NULL, collect, &m->file,
                             &m->report) == PMESH_OK);
    return m;
}

static void unmake(made *m)
{
    for (size_t i = 0; i < m->count; i++)
        free(m->streams[i].data);
    free(m->streams);
    free(m->meshes);
    free(m->file.data);
    free(m);
}

static pmesh_scene *decode(const uint8_t *data, size_t size, size_t piece,
                           pmesh_status *status)
{
    pmesh_scene *scene;
    CHECK(pmesh_scene_create(&scene, NULL) == PMESH_OK);
    *status = PMESH_NEED_DATA;
    for (size_t at = 0; at < size; at += piece)
        *status = pmesh_scene_feed(scene, data + at,
                                   size - at < piece ? size - at : piece);
    return scene;
}

static bool same_bytes(pmesh_scene_bytes got, const void *want, size_t size)
{
    return got.size == size && got.arrived == size &&
           memcmp(got.data, want, size) == 0;
}

TEST(scene_comes_back_whole)
{
    for (int lossless = 0; lossless < 2; lossless++)
        for (size_t piece = 1; piece < 3000000; piece *= 1000) {
            made *m = make(MESHES, lossless);
            pmesh_status status;
            pmesh_scene_header h;
            pmesh_scene_shown shown;
            pmesh_scene *s =
                decode(m->file.data, m->file.size, piece, &status);
            CHECK(status == PMESH_OK);
            CHECK(m->report.bytes == m->file.size);
            CHECK(pmesh_scene_get_header(s, &h) == PMESH_OK);
            CHECK(h.mesh_count == MESHES && h.resource_count == RESOURCES);
            CHECK(h.document_form == PMESH_DOCUMENT_ZLIB);
            CHECK(pmesh_scene_refine(s, NULL, &shown) == PMESH_OK);
            CHECK(shown.faces == m->report.faces && shown.meshes == MESHES);
            CHECK(h.levels[h.level_count - 1].faces == shown.faces);
            CHECK(!(shown.error > 0));
            CHECK(same_bytes(pmesh_scene_document(s), m->document,
                             sizeof m->document));
            CHECK(same_bytes(pmesh_scene_resource(s, 0), m->image, 100));
            CHECK(same_bytes(pmesh_scene_resource(s, 1), m->image,
                             sizeof m->image));
            for (uint32_t i = 0; i < MESHES; i++) {
                pmesh_decoder *alone =
                    shape_decode(m->streams[i].data, m->streams[i].size,
                                 m->streams[i].size, &status);
                CHECK(status == PMESH_OK);
                pmesh_decoder_refine(alone, NULL, NULL);
                CHECK(shape_view_hash(alone) ==
                      shape_view_hash(pmesh_scene_mesh(s, i)));
                pmesh_decoder_destroy(alone);
            }
            pmesh_scene_destroy(s);
            unmake(m);
        }
}

TEST(scene_prefixes_show_what_the_whole_shows_of_as_many_bytes)
{
    made *m = make(MESHES, 0);
    pmesh_status status;
    pmesh_scene_header h;
    pmesh_scene *all = decode(m->file.data, m->file.size, 4096, &status);
    pmesh_scene *some;
    uint64_t last = 0;

    CHECK(pmesh_scene_create(&some, NULL) == PMESH_OK);
    CHECK(pmesh_scene_get_header(all, &h) == PMESH_OK);
    for (size_t size = 0; size < m->file.size; size++) {
        CHECK(pmesh_scene_feed(some, m->file.data + size, 1) ==
              (size + 1 < m->file.size ? PMESH_NEED_DATA : PMESH_OK));
        const pmesh_scene_progress p = pmesh_scene_get_progress(some);
        CHECK(p.faces >= last && p.bytes <= size + 1);
        if (p.faces == last && p.bytes < size + 1)
            continue;
        last = p.faces;
        pmesh_scene_shown here, there;
        const pmesh_scene_target target = { .bytes = size + 1 };
        const bool any = p.bases > 0;
        CHECK((pmesh_scene_refine(some, &target, &here) == PMESH_OK) == any);
        CHECK((pmesh_scene_refine(all, &target, &there) == PMESH_OK));
        CHECK(!any || here.meshes < MESHES || here.faces == there.faces);
        for (uint32_t i = 0; i < h.level_count; i++)
            if (h.levels[i].bytes == size + 1)
                CHECK(here.faces >= h.levels[i].faces &&
                      here.error <= 1.0001 * (double)h.levels[i].error);
    }
    pmesh_scene_destroy(all);
    pmesh_scene_destroy(some);
    unmake(m);
}

/* The least largest error of any choice of levels with at most `faces`. */
static double best_error(pmesh_scene *s, uint32_t count, uint64_t faces)
{
    double best = 1e300;
    for (uint32_t i = 0; i < count; i++) {
        pmesh_header candidate;
        CHECK(pmesh_decoder_header(pmesh_scene_mesh(s, i), &candidate) ==
              PMESH_OK);
        for (uint32_t k = 0; k < candidate.level_count; k++) {
            const double bound = (double)candidate.levels[k].error *
                                 (double)pmesh_scene_scale(s, i);
            uint64_t sum = 0;
            bool fits = bound < best;
            for (uint32_t j = 0; fits && j < count; j++) {
                pmesh_header h;
                uint32_t at = 0;
                pmesh_decoder_header(pmesh_scene_mesh(s, j), &h);
                while (at + 1 < h.level_count &&
                       (double)h.levels[at].error *
                               (double)pmesh_scene_scale(s, j) > bound)
                    at++;
                fits = (double)h.levels[at].error *
                           (double)pmesh_scene_scale(s, j) <= bound;
                sum += h.levels[at].faces;
            }
            if (fits && sum <= faces)
                best = bound;
        }
    }
    return best;
}

TEST(scene_budgets_are_met_as_well_as_levels_can)
{
    enum { COUNT = 50, BUDGETS = 20 };
    made *m = make(COUNT, 0);
    pmesh_status status;
    pmesh_scene_shown base, all;
    pmesh_scene *s = decode(m->file.data, m->file.size, 4096, &status);
    CHECK(status == PMESH_OK);
    CHECK(pmesh_scene_refine(s, &(pmesh_scene_target){ .faces = 1 }, &base) ==
          PMESH_OK);
    CHECK(pmesh_scene_refine(s, NULL, &all) == PMESH_OK);
    for (uint32_t i = 0; i <= BUDGETS; i++) {
        const uint64_t faces =
            base.faces + (all.faces - base.faces) * i / BUDGETS;
        pmesh_scene_shown shown;
        CHECK(pmesh_scene_refine(s, &(pmesh_scene_target){ .faces = faces },
                                 &shown) == PMESH_OK);
        CHECK(shown.faces <= faces && shown.faces + 2 > faces);
        CHECK(shown.error <= 1.0001 * best_error(s, COUNT, faces));
        const double bound = shown.error * 1.01;
        pmesh_scene_refine(s, &(pmesh_scene_target){ .error = bound }, &shown);
        CHECK(!(bound > 0) || shown.error <= bound);
    }
    pmesh_scene_destroy(s);
    unmake(m);
}

TEST(scene_shares_what_refine_would_show)
{
    enum { COUNT = 12 };
    made *m = make(COUNT, 0);
    pmesh_status status;
    pmesh_scene_shown all;
    uint32_t share[COUNT];
    pmesh_scene *s = decode(m->file.data, m->file.size, 4096, &status);
    pmesh_scene_refine(s, NULL, &all);
    for (uint64_t faces = 1; faces < all.faces; faces += all.faces / 7) {
        const pmesh_scene_target target = { .faces = faces };
        CHECK(pmesh_scene_refine(s, &target, NULL) == PMESH_OK);
        CHECK(pmesh_scene_share(s, &target, share) == PMESH_OK);
        for (uint32_t i = 0; i < COUNT; i++) {
            pmesh_view view;
            pmesh_decoder *dec = pmesh_scene_mesh(s, i);
            CHECK(pmesh_decoder_mesh(dec, &view) == PMESH_OK);
            CHECK(view.face_count <= share[i] && view.face_count + 2 > share[i]);
        }
    }
    pmesh_scene_destroy(s);
    s = decode(m->file.data, 8, 8, &status);
    CHECK(pmesh_scene_share(s, NULL, share) == PMESH_NEED_DATA);
    pmesh_scene_destroy(s);
    unmake(m);
}

TEST(scene_levels_put_the_worst_mesh_first)
{
    made *m = make(20, 0);
    pmesh_status status;
    pmesh_scene_header h;
    pmesh_scene *s = decode(m->file.data, m->file.size, 4096, &status);
    CHECK(pmesh_scene_get_header(s, &h) == PMESH_OK);
    CHECK(h.level_count > 10);
    /* A level may lower the error without a face: so with one face less. */
    for (uint32_t i = 1; i < h.level_count; i++)
        CHECK((double)h.levels[i].error <=
              1.0001 * best_error(s, 20, h.levels[i].faces - 1));
    pmesh_scene_destroy(s);
    unmake(m);
}

TEST(scene_notices_every_damaged_bit)
{
    made *m = make(2, 0);
    uint32_t seed = 1;
    m->input.resource_count = m->input.early_count;
    m->file.size = 0;
    CHECK(pmesh_scene_encode(&m->input, NULL, collect, &m->file, NULL) ==
          PMESH_OK);
    for (size_t i = 0; i < m->file.size; i++) {
        const uint8_t flip = (uint8_t)(1 << shape_random(&seed, 8));
        uint8_t *copy = malloc(m->file.size); /* ASan sees its end */
        pmesh_status status;
        CHECK(copy);
        memcpy(copy, m->file.data, m->file.size);
        copy[i] ^= flip;
        pmesh_scene *s = decode(copy, m->file.size, 5000, &status);
        CHECK(status != PMESH_OK);
        CHECK(status > 0 || pmesh_scene_error(s).rule[0] != '\0');
        pmesh_scene_shown shown;
        if (pmesh_scene_refine(s, NULL, &shown) == PMESH_OK)
            for (uint32_t k = 0; k < 2; k++)
                CHECK(!pmesh_scene_mesh(s, k) || k >= shown.meshes ||
                      shape_view_sound(pmesh_scene_mesh(s, k)));
        pmesh_scene_destroy(s);
        free(copy);
    }
    unmake(m);
}

/* ---- files that no encoder makes ---------------------------------------- */

static void put_chunk(bytes *out, uint8_t type, const uint8_t *data,
                      size_t size)
{
    uint8_t start[8], tail[4];
    pmesh_writer w = { start, 0, sizeof start, false };
    pmesh_put(&w, type, 1);
    pmesh_put_varint(&w, size);
    const uint32_t crc = pmesh_crc32c(pmesh_crc32c(0, start, w.size), data,
                                      size);
    collect(out, start, w.size);
    collect(out, data, size);
    w = (pmesh_writer){ tail, 0, sizeof tail, false };
    pmesh_put(&w, crc, 4);
    collect(out, tail, sizeof tail);
}

/* A scene's header of one mesh and one resource, as `h` and the sizes say. */
static void put_header(bytes *out, const pmesh_scene_head *h,
                       pmesh_scene_stream mesh, uint64_t resource)
{
    uint8_t payload[512];
    pmesh_writer w = { payload, 0, sizeof payload, false };
    pmesh_scene_head_write(&w, h, &mesh, &resource);
    CHECK(!w.overflow);
    collect(out, PMESH_SIGNATURE, PMESH_SIGNATURE_SIZE);
    put_chunk(out, PMESH_CHUNK_SCENE, payload, w.size);
}

static pmesh_scene_head plain_head(void)
{
    return (pmesh_scene_head){ .chunk_size = 100, .document_size = 3,
                               .mesh_count = 1, .resource_count = 1,
                               .level_count = 1,
                               .levels = { { 10, 4, 4, 0 } } };
}

static pmesh_status status_of(bytes *b)
{
    pmesh_status status;
    pmesh_scene *s = decode(b->data, b->size, 7, &status);
    CHECK(status >= 0 || pmesh_scene_error(s).rule[0] != '\0');
    pmesh_scene_destroy(s);
    free(b->data);
    *b = (bytes){ 0 };
    return status;
}

TEST(scene_header_is_checked)
{
    const pmesh_scene_stream mesh = { 50, 1 };
    bytes b = { 0 };
    pmesh_scene_head h = plain_head();
    put_header(&b, &h, mesh, 5);
    CHECK(status_of(&b) == PMESH_NEED_DATA);
    h.mesh_count = 0;
    put_header(&b, &h, mesh, 5);
    CHECK(status_of(&b) == PMESH_E_CORRUPT);
    h.mesh_count = 1;
    h.level_count = 0;
    put_header(&b, &h, mesh, 5);
    CHECK(status_of(&b) == PMESH_E_CORRUPT);
    h = plain_head();
    h.levels[0].error = -1;
    put_header(&b, &h, mesh, 5);
    CHECK(status_of(&b) == PMESH_E_CORRUPT);
    h = plain_head();
    put_header(&b, &h, (pmesh_scene_stream){ 50, -1 }, 5);
    CHECK(status_of(&b) == PMESH_E_CORRUPT);
    put_header(&b, &h, mesh, (uint64_t)1 << 40); /* a lie about memory */
    CHECK(status_of(&b) == PMESH_E_LIMIT);
    put_header(&b, &h, mesh, PMESH_MAX_FILE);
    CHECK(status_of(&b) < 0);
    h.document_form = PMESH_DOCUMENT_ZLIB;
    put_header(&b, &h, mesh, 5);
    CHECK(status_of(&b) == PMESH_NEED_DATA);
    h.document_form = PMESH_DOCUMENT_ZLIB + 1;
    put_header(&b, &h, mesh, 5);
    CHECK(status_of(&b) == PMESH_E_CORRUPT);
    h = plain_head();
    h.chunk_size = PMESH_MAX_CHUNK_SIZE + 1;
    put_header(&b, &h, mesh, 5);
    CHECK(status_of(&b) == PMESH_E_CORRUPT);
}

TEST(scene_parts_are_checked)
{
    static const struct {
        uint8_t payload[8];
        size_t size;
        pmesh_status status;
    } cases[] = {
        { { 0, 'a', 'b', 'c' }, 4, PMESH_NEED_DATA },
        { { 0, 'a', 'b', 'c', 'd' }, 5, PMESH_E_CORRUPT }, /* too many */
        { { 0 }, 1, PMESH_E_CORRUPT },                     /* no bytes */
        { { 0 }, 0, PMESH_E_CORRUPT },                     /* no number */
        { { 3, 'a' }, 2, PMESH_E_CORRUPT },                /* no such part */
        { { 0x81, 0, 'a' }, 3, PMESH_E_CORRUPT },  /* not canonical */
        { { 1, 0x89, 'P' }, 3, PMESH_NEED_DATA },  /* a mesh begins */
        { { 1, 'x' }, 2, PMESH_E_MAGIC },          /* it does not */
        { { 2, 1, 2, 3, 4, 5 }, 6, PMESH_NEED_DATA },
        { { 2, 1, 2, 3, 4, 5, 6 }, 7, PMESH_E_CORRUPT }
    };
    const pmesh_scene_stream mesh = { 50, 1 };
    const pmesh_scene_head h = plain_head();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bytes b = { 0 };
        put_header(&b, &h, mesh, 5);
        put_chunk(&b, PMESH_CHUNK_PART, cases[i].payload, cases[i].size);
        CHECK(status_of(&b) == cases[i].status);
    }
    for (int type = 0; type < 256; type++) {
        bytes b = { 0 };
        put_header(&b, &h, mesh, 5);
        put_chunk(&b, (uint8_t)type, NULL, 0);
        const pmesh_status status = status_of(&b);
        CHECK(type >= PMESH_CHUNK_SKIPPABLE ? status == PMESH_NEED_DATA
                                            : status < 0);
    }
}

TEST(scene_and_mesh_are_told_apart)
{
    made *m = make(1, 0);
    pmesh_status status;
    const shape_bytes *alone = &m->streams[0];
    CHECK(pmesh_scene_probe(m->file.data, 9) == PMESH_OK);
    CHECK(pmesh_scene_probe(alone->data, 9) == PMESH_E_UNSUPPORTED);
    CHECK(pmesh_scene_probe(m->file.data, 8) == PMESH_NEED_DATA);
    CHECK(pmesh_scene_probe("o bunny", 7) == PMESH_E_MAGIC);
    pmesh_scene *s = decode(alone->data, alone->size, 1000, &status);
    CHECK(status == PMESH_E_UNSUPPORTED);
    pmesh_scene_destroy(s);
    pmesh_decoder *dec =
        shape_decode(m->file.data, m->file.size, 1000, &status);
    CHECK(status == PMESH_E_UNSUPPORTED);
    pmesh_decoder_destroy(dec);
    unmake(m);
}

TEST(scene_encoder_takes_complete_streams_only)
{
    made *m = make(2, 0);
    bytes b = { 0 };
    pmesh_scene_report report;
    for (size_t size = 0; size < m->meshes[1].size; size += 97) {
        pmesh_scene_mesh_input meshes[2] = { m->meshes[0], m->meshes[1] };
        const pmesh_scene_input in = { .meshes = meshes, .mesh_count = 2 };
        meshes[1].size = size;
        CHECK(pmesh_scene_encode(&in, NULL, collect, &b, &report) !=
              PMESH_OK);
        CHECK(report.error_mesh == 1 && b.size == 0);
    }
    m->meshes[0].scale = -1;
    CHECK(pmesh_scene_encode(&m->input, NULL, collect, &b, NULL) ==
          PMESH_E_ARGUMENT);
    unmake(m);
}

/* ---- memory ------------------------------------------------------------- */

typedef struct meter {
    int left;       /* allocations until they fail; negative: never */
    size_t in_use;
} meter;

static void *meter_alloc(void *user, size_t size)
{
    meter *m = user;
    if (m->left == 0)
        return NULL;
    m->left--;
    m->in_use += size;
    return malloc(size);
}

static void meter_release(void *user, void *ptr, size_t size)
{
    ((meter *)user)->in_use -= size;
    free(ptr);
}

TEST(scene_gives_all_memory_back_when_it_runs_out)
{
    made *m = make(2, 0);
    for (int left = 0; left < 8; left++) {
        meter use = { left, 0 };
        const pmesh_allocator a = { meter_alloc, meter_release, &use };
        const pmesh_scene_config config = { .decoder = { .allocator = a } };
        pmesh_scene *s;
        pmesh_status status = pmesh_scene_create(&s, &config);
        if (status == PMESH_OK)
            status = pmesh_scene_feed(s, m->file.data, m->file.size);
        CHECK(status == (left < 7 ? PMESH_E_MEMORY : PMESH_OK));
        pmesh_scene_destroy(s);
        CHECK(use.in_use == 0);
    }
    for (int left = 0; left < 7; left++) {
        meter use = { left, 0 };
        const pmesh_allocator a = { meter_alloc, meter_release, &use };
        bytes b = { 0 };
        const pmesh_status status =
            pmesh_scene_encode(&m->input, &a, collect, &b, NULL);
        CHECK(status == (left < 6 ? PMESH_E_MEMORY : PMESH_OK));
        CHECK(use.in_use == 0);
        free(b.data);
    }
    unmake(m);
}

TEST(scene_limit_is_for_all_meshes_together)
{
    made *m = make(MESHES, 0);
    pmesh_scene *s;
    for (uint64_t limit = 1000; limit < 100000000; limit *= 2) {
        const pmesh_scene_config config = {
            .decoder = { .max_memory = limit }, .skip_resources = 1
        };
        CHECK(pmesh_scene_create(&s, &config) == PMESH_OK);
        const pmesh_status status =
            pmesh_scene_feed(s, m->file.data, m->file.size);
        uint64_t used = 0;
        for (uint32_t i = 0; i < MESHES; i++) {
            pmesh_header h;
            if (pmesh_scene_mesh(s, i) &&
                pmesh_decoder_header(pmesh_scene_mesh(s, i), &h) == PMESH_OK)
                used += h.memory;
        }
        CHECK(used <= limit);
        CHECK(status == PMESH_OK || status == PMESH_E_LIMIT);
        CHECK(pmesh_scene_resource(s, 0).data == NULL);
        pmesh_scene_destroy(s);
        if (status == PMESH_OK) {
            unmake(m);
            return;
        }
    }
    test_fail(__FILE__, __LINE__, "no limit is enough");
}
