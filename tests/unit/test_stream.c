/* SPDX-License-Identifier: MIT */
/* From triangles to bytes and back: what goes in comes out, at every budget
 * and from every prefix. */
#include <stdlib.h>
#include <string.h>

#include "tests/unit/faces.h"
#include "tests/unit/shapes.h"
#include "tests/unit/test.h"
#include "tools/draco_base.h"

static uint32_t shape_size(shape_kind kind)
{
    static const uint32_t sizes[SHAPE_COUNT] = { 12, 20, 18, 10, 40, 30 };
    return sizes[kind];
}

typedef struct baked {
    shape_mesh *shape;
    shape_bytes bytes;
    pmesh_encode_report report;
    pmesh_status status;
} baked;

static baked bake(shape_kind kind, uint32_t size, pmesh_encoder_config config)
{
    baked b;
    b.shape = shape_make(kind, size, 1 + (uint32_t)kind);
    b.status = shape_bake(b.shape, &config, &b.bytes, &b.report);
    return b;
}

static void baked_free(baked *b)
{
    shape_free(b->shape);
    free(b->bytes.data);
}

static pmesh_encoder_config config_of(pmesh_profile profile,
                                      pmesh_placement placement, uint8_t bits)
{
    pmesh_encoder_config config = pmesh_encoder_config_default();
    config.profile = profile;
    config.placement = placement;
    config.position_bits = bits;
    config.base_faces = 12;
    return config;
}

TEST(every_shape_comes_back_whole)
{
    static const uint8_t bits[] = { 4, 8, 12, 16, 21, 24 };
    for (int kind = 0; kind < SHAPE_COUNT; kind++)
        for (unsigned i = 0; i < sizeof bits; i++) {
            const pmesh_placement placement =
                i & 1 ? PMESH_OPTIMAL : PMESH_SUBSET;
            baked b = bake((shape_kind)kind, shape_size((shape_kind)kind),
                           config_of((pmesh_profile)(i % 3), placement,
                                     bits[i]));
            CHECK(b.status == PMESH_OK);
            pmesh_status status;
            pmesh_decoder *dec = shape_decode(b.bytes.data, b.bytes.size,
                                              b.bytes.size, &status);
            CHECK(status == PMESH_OK);
            CHECK(shape_view_sound(dec));
            CHECK(faces_match(&b.shape->input, dec));
            pmesh_decoder_destroy(dec);
            baked_free(&b);
        }
}

TEST(feed_granularity_changes_nothing)
{
    baked b = bake(SHAPE_SPHERE, 12,
                   config_of(PMESH_BALANCED, PMESH_OPTIMAL, 12));
    uint64_t hash = 0;
    static const size_t pieces[] = { 1, 7, 1000, 1 << 20 };
    for (int i = 0; i < 4; i++) {
        pmesh_status status;
        pmesh_decoder *dec =
            shape_decode(b.bytes.data, b.bytes.size, pieces[i], &status);
        CHECK(status == PMESH_OK);
        pmesh_decoder_refine(dec, NULL, NULL);
        CHECK(i == 0 || shape_view_hash(dec) == hash);
        hash = shape_view_hash(dec);
        pmesh_decoder_destroy(dec);
    }
    baked_free(&b);
}

/* What a prefix shows is what the whole file shows at that many faces. */
static bool prefix_is_genuine(pmesh_decoder *whole, const uint8_t *data,
                              size_t size, uint32_t *faces)
{
    pmesh_status status;
    pmesh_view v;
    pmesh_decoder *dec = shape_decode(data, size, size, &status);
    bool good = status == PMESH_NEED_DATA;
    if (good && pmesh_decoder_refine(dec, NULL, NULL) == PMESH_OK) {
        pmesh_decoder_mesh(dec, &v);
        good = shape_view_sound(dec) && v.face_count >= *faces;
        *faces = v.face_count;
        const pmesh_target target = { .faces = v.face_count };
        pmesh_decoder_refine(whole, &target, NULL);
        good = good && shape_view_hash(whole) == shape_view_hash(dec);
    }
    pmesh_decoder_destroy(dec);
    return good;
}

TEST(every_proper_prefix_is_a_mesh_of_the_whole_file)
{
    for (int kind = 0; kind < SHAPE_COUNT; kind++) {
        baked b = bake((shape_kind)kind, kind == SHAPE_SOUP ? 20 : 6,
                       config_of(PMESH_QUALITY, PMESH_OPTIMAL, 10));
        pmesh_status status;
        pmesh_decoder *whole = shape_decode(b.bytes.data, b.bytes.size,
                                            b.bytes.size, &status);
        uint32_t faces = 0;
        CHECK(status == PMESH_OK);
        for (size_t size = 0; size < b.bytes.size; size++)
            CHECK(prefix_is_genuine(whole, b.bytes.data, size, &faces));
        pmesh_decoder_destroy(whole);
        baked_free(&b);
    }
}

TEST(any_face_budget_is_met)
{
    for (int kind = 0; kind < SHAPE_COUNT; kind++) {
        baked b = bake((shape_kind)kind, shape_size((shape_kind)kind),
                       config_of(PMESH_BALANCED, PMESH_SUBSET, 12));
        pmesh_status status;
        pmesh_decoder *dec = shape_decode(b.bytes.data, b.bytes.size,
                                          b.bytes.size, &status);
        pmesh_header h;
        pmesh_decoder_header(dec, &h);
        for (uint32_t faces = h.base_faces; faces <= h.faces; faces++) {
            pmesh_view v;
            const pmesh_target target = { .faces = faces };
            pmesh_decoder_refine(dec, &target, NULL);
            pmesh_decoder_mesh(dec, &v);
            /* A split shows two faces at most, unless sheets meet. */
            CHECK(v.face_count <= faces &&
                  (h.joined || v.face_count + 2 > faces));
            CHECK(shape_view_sound(dec));
        }
        pmesh_decoder_destroy(dec);
        baked_free(&b);
    }
}

TEST(walks_up_and_down_end_where_they_started)
{
    for (int placement = 0; placement < 2; placement++) {
        baked b = bake(SHAPE_SPHERE, 14,
                       config_of(PMESH_BALANCED,
                                 (pmesh_placement)placement, 12));
        pmesh_status status;
        pmesh_decoder *dec = shape_decode(b.bytes.data, b.bytes.size,
                                          b.bytes.size, &status);
        pmesh_decoder_refine(dec, NULL, NULL);
        const uint64_t hash = shape_view_hash(dec);
        uint32_t seed = 5;
        for (int i = 0; i < 1000; i++) {
            const pmesh_target target = {
                .faces = 1 + shape_random(&seed, b.report.faces)
            };
            pmesh_decoder_refine(dec, &target, NULL);
        }
        pmesh_decoder_refine(dec, NULL, NULL);
        CHECK(shape_view_hash(dec) == hash);
        pmesh_decoder_destroy(dec);
        baked_free(&b);
    }
}

/* Copies what the ranges name, and nothing else, into a second mesh. */
static bool replay_equals(const pmesh_view *v, const pmesh_changes *c,
                          uint32_t *indices, int32_t *positions)
{
    for (uint32_t i = 0; i < c->face_range_count; i++)
        memcpy(indices + 3 * (size_t)c->faces[i].first,
               v->indices + 3 * (size_t)c->faces[i].first,
               12 * (size_t)c->faces[i].count);
    for (uint32_t i = 0; i < c->vertex_range_count; i++)
        for (uint32_t k = 0; k < c->vertices[i].count; k++) {
            const uint32_t w = c->vertices[i].first + k;
            const uint32_t x = v->positions_of ? v->positions_of[w] : w;
            memcpy(positions + 3 * (size_t)w, v->positions + 3 * (size_t)x, 12);
        }
    for (uint32_t w = 0; w < v->vertex_count; w++) {
        const uint32_t x = v->positions_of ? v->positions_of[w] : w;
        if (memcmp(positions + 3 * (size_t)w, v->positions + 3 * (size_t)x, 12))
            return false;
    }
    return memcmp(indices, v->indices, 12 * (size_t)v->face_count) == 0;
}

TEST(dirty_ranges_name_all_that_changed)
{
    for (int placement = 0; placement < 2; placement++) {
        baked b = bake(SHAPE_SPHERE, 14,
                       config_of(PMESH_QUALITY,
                                 (pmesh_placement)placement, 12));
        pmesh_status status;
        pmesh_decoder *dec = shape_decode(b.bytes.data, b.bytes.size,
                                          b.bytes.size, &status);
        uint32_t *indices = calloc(b.report.faces, 12);
        int32_t *positions = calloc(b.report.wedges, 12);
        pmesh_view v;
        pmesh_decoder_mesh(dec, &v);
        memcpy(indices, v.indices, 12 * (size_t)v.face_count);
        for (uint32_t w = 0; w < v.vertex_count; w++)
            memcpy(positions + 3 * (size_t)w,
                   v.positions + 3 * (size_t)v.positions_of[w], 12);
        uint32_t seed = 9;
        for (int i = 0; i < 300; i++) {
            pmesh_changes changes;
            const pmesh_target target = {
                .faces = 1 + shape_random(&seed, b.report.faces)
            };
            pmesh_decoder_refine(dec, &target, &changes);
            pmesh_decoder_mesh(dec, &v);
            CHECK(replay_equals(&v, &changes, indices, positions));
        }
        free(indices);
        free(positions);
        pmesh_decoder_destroy(dec);
        baked_free(&b);
    }
}

TEST(material_names_travel)
{
    static const char *const names[] = { "skin", "", "gold \xc3\xa9" };
    shape_mesh *s = shape_make(SHAPE_SPHERE, 6, 1);
    const pmesh_encoder_config config = pmesh_encoder_config_default();
    shape_bytes bytes;
    pmesh_encode_report report;
    s->input.material_names = names;
    CHECK(shape_bake(s, &config, &bytes, &report) == PMESH_OK);
    pmesh_status status;
    pmesh_decoder *dec = shape_decode(bytes.data, bytes.size, 99, &status);
    CHECK(status == PMESH_OK);
    for (uint32_t i = 0; i < 3; i++)
        CHECK(!strcmp(pmesh_decoder_material_name(dec, i), names[i]));
    CHECK(!strcmp(pmesh_decoder_material_name(dec, 3), ""));
    pmesh_decoder_destroy(dec);
    free(bytes.data);
    shape_free(s);
}

typedef struct meter {
    unsigned calls, fail_at;
    bool and_on; /* all behind fail, too */
    size_t bytes;
} meter;

static void *meter_alloc(void *user, size_t size)
{
    meter *m = user;
    if (++m->calls == m->fail_at ||
        (m->and_on && m->fail_at && m->calls > m->fail_at))
        return NULL;
    m->bytes += size;
    return malloc(size);
}

static void meter_release(void *user, void *ptr, size_t size)
{
    meter *m = user;
    m->bytes -= size;
    free(ptr);
}

TEST(decoder_allocates_twice)
{
    pmesh_encoder_config baking = config_of(PMESH_COMPACT, PMESH_SUBSET, 12);
    baking.lossless = 1;
    baked b = bake(SHAPE_TORUS, 10, baking);
    for (unsigned fail = 0; fail <= 2; fail++) {
        meter m = { .fail_at = fail };
        pmesh_decoder_config config = pmesh_decoder_config_default();
        config.allocator =
            (pmesh_allocator){ meter_alloc, meter_release, &m };
        pmesh_decoder *dec;
        pmesh_status status = pmesh_decoder_create(&dec, &config);
        if (status == PMESH_OK)
            status = pmesh_decoder_feed(dec, b.bytes.data, b.bytes.size);
        CHECK(status == (fail ? PMESH_E_MEMORY : PMESH_OK));
        CHECK(m.calls == (fail ? fail : 2));
        pmesh_decoder_destroy(dec);
        CHECK(m.bytes == 0);
    }
    baked_free(&b);
}

/* True as long as the bake made as many allocations as were to succeed. */
static bool bake_fails(const shape_mesh *s, pmesh_base_coder coder,
                       unsigned fail, bool and_on)
{
    meter m = { .fail_at = fail, .and_on = and_on };
    pmesh_encoder_config config = config_of(PMESH_BALANCED, PMESH_OPTIMAL, 12);
    config.allocator = (pmesh_allocator){ meter_alloc, meter_release, &m };
    config.lossless = 1;
    config.base_coder = coder;
    config.base_encoder = draco_base_encode;
    config.base_decoder = draco_base_decode;
    shape_bytes bytes;
    pmesh_encode_report report;
    const pmesh_status status = shape_bake(s, &config, &bytes, &report);
    free(bytes.data);
    CHECK(m.bytes == 0);
    CHECK(status == (m.calls < fail ? PMESH_OK : PMESH_E_MEMORY));
    return m.calls >= fail;
}

TEST(encoder_survives_every_failing_allocation)
{
    shape_mesh *s = shape_make(SHAPE_SPHERE, 6, 3);
    for (int coder = 0; coder < 2; coder++)
        for (unsigned fail = 1;
             bake_fails(s, (pmesh_base_coder)coder, fail, false) &&
             bake_fails(s, (pmesh_base_coder)coder, fail, true);)
            fail++;
    shape_free(s);
}
