/* SPDX-License-Identifier: MIT */
/* What an engine relies on: ranges to upload, bound buffers, work in small
 * steps, geomorphs, draw groups, picking. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "decoder/dec_touched.h"
#include "tests/unit/shapes.h"
#include "tests/unit/test.h"

enum { STRIDE = 20 }; /* bytes; what lies between positions is not ours */

typedef struct scene {
    shape_mesh *shape;
    shape_bytes bytes;
    pmesh_header h;
    pmesh_decoder *dec;
    uint8_t *positions;      /* bound, STRIDE apart */
    uint32_t *indices;       /* bound */
    float *values;           /* bound: of the first attribute, if any */
    float *sent_positions;   /* what uploads by ranges made of them */
    uint32_t *sent_indices, *old_indices;
    float *room;
} scene;

static void bake(scene *s, shape_kind kind, uint32_t size,
                 pmesh_placement placement, int lossless)
{
    pmesh_encoder_config config = pmesh_encoder_config_default();
    pmesh_encode_report report;
    *s = (scene){ .shape = shape_make(kind, size, 3) };
    config.placement = placement;
    config.lossless = lossless;
    config.base_faces = 16;
    config.position_bits = 11;
    CHECK(shape_bake(s->shape, &config, &s->bytes, &report) == PMESH_OK);
    CHECK(pmesh_decoder_create(&s->dec, NULL) == PMESH_OK);
}

static void make_buffers(scene *s)
{
    CHECK(pmesh_decoder_header(s->dec, &s->h) == PMESH_OK);
    s->positions = malloc(STRIDE * (size_t)s->h.vertices);
    memset(s->positions, 0xab, STRIDE * (size_t)s->h.vertices);
    s->indices = calloc(s->h.faces, 12);
    s->values = calloc(s->h.vertices, 16);
    s->sent_positions = calloc(s->h.vertices, 12);
    s->sent_indices = calloc(s->h.faces, 12);
    s->old_indices = calloc(s->h.faces, 12);
    s->room = calloc(s->h.vertices, 16);
    pmesh_buffers b = { .indices = s->indices,
                        .positions = (float *)(void *)s->positions,
                        .position_stride = STRIDE };
    if (s->h.attribute_count > 0)
        b.attributes[0] = s->values;
    CHECK(pmesh_decoder_bind(s->dec, &b) == PMESH_OK);
}

static void scene_free(scene *s)
{
    pmesh_decoder_destroy(s->dec);
    shape_free(s->shape);
    free(s->bytes.data);
    free(s->positions);
    free(s->indices);
    free(s->values);
    free(s->sent_positions);
    free(s->sent_indices);
    free(s->old_indices);
    free(s->room);
}

/* The header is there after a few bytes; the rest comes later. */
static size_t feed_header(scene *s)
{
    size_t at = 0;
    while (pmesh_decoder_header(s->dec, &s->h) == PMESH_NEED_DATA)
        pmesh_decoder_feed(s->dec, s->bytes.data + at++, 1);
    return at;
}

/* Uploads the ranges and checks what both kinds of buffers hold. */
static void check_buffers(scene *s, const pmesh_changes *c)
{
    pmesh_view v;
    pmesh_decoder_mesh(s->dec, &v);
    for (uint32_t i = 0; i < c->face_range_count; i++) {
        const size_t at = 3 * (size_t)c->faces[i].first;
        CHECK(c->faces[i].first + c->faces[i].count <= v.face_count);
        memcpy(s->sent_indices + at, s->indices + at,
               12 * (size_t)c->faces[i].count);
    }
    for (uint32_t i = 0; i < c->vertex_range_count; i++)
        for (uint32_t k = 0; k < c->vertices[i].count; k++) {
            const size_t w = c->vertices[i].first + k;
            CHECK(w < v.vertex_count);
            memcpy(s->sent_positions + 3 * w, s->positions + STRIDE * w, 12);
        }
    CHECK(!memcmp(s->sent_indices, v.indices, 12 * (size_t)v.face_count));
    CHECK(!memcmp(s->indices, v.indices, 12 * (size_t)v.face_count));
    pmesh_decoder_copy_positions(s->dec, s->room, 0);
    CHECK(!memcmp(s->sent_positions, s->room, 12 * (size_t)v.vertex_count));
    for (size_t w = 0; w < s->h.vertices; w++)
        for (size_t k = 12; k < STRIDE; k++)
            CHECK(s->positions[STRIDE * w + k] == 0xab);
    if (s->h.attribute_count > 0) {
        pmesh_decoder_copy_attribute(s->dec, 0, s->room, 0);
        CHECK(!memcmp(s->values, s->room,
                      s->h.attributes[0].components * sizeof(float) *
                          (size_t)v.vertex_count));
    }
}

/* Ranges begin and end with faces that changed and lie apart; if there is room
 * for more of them, every face in them changed. */
static void check_tight(const scene *s, const pmesh_changes *c,
                        uint32_t old_count)
{
    const bool exact = c->face_range_count < PMESH_MAX_RANGES;
    for (uint32_t i = 0; i < c->face_range_count; i++) {
        const uint32_t first = c->faces[i].first, n = c->faces[i].count;
        CHECK(i == 0 || first > c->faces[i - 1].first + c->faces[i - 1].count);
        for (uint32_t k = 0; k < n; k += exact || n == 1 ? 1 : n - 1)
            CHECK(first + k >= old_count ||
                  memcmp(s->old_indices + 3 * (size_t)(first + k),
                         s->indices + 3 * (size_t)(first + k), 12));
    }
}

static void walk(scene *s, unsigned steps)
{
    uint32_t seed = 5;
    size_t at = feed_header(s);
    bool first = true; /* the base mesh is to be sent */
    make_buffers(s);
    for (unsigned i = 0; i < steps; i++) {
        pmesh_changes c;
        pmesh_view v = { 0 };
        pmesh_target target = {
            .faces = 1 + shape_random(&seed, s->h.faces),
            .max_ops = i % 3 ? shape_random(&seed, 9) : 0
        };
        const size_t piece = 1 + shape_random(&seed, 40);
        const size_t left = s->bytes.size - at;
        if (i % 2 == 0 && left > 0) {
            const size_t size = piece < left ? piece : left;
            CHECK(pmesh_decoder_feed(s->dec, s->bytes.data + at, size) >= 0);
            at += size;
        }
        pmesh_decoder_mesh(s->dec, &v);
        if (v.face_count > 0)
            memcpy(s->old_indices, v.indices, 12 * (size_t)v.face_count);
        if (pmesh_decoder_refine(s->dec, &target, &c) == PMESH_NEED_DATA)
            continue;
        check_buffers(s, &c);
        check_tight(s, &c, first ? 0 : v.face_count);
        first = false;
    }
    CHECK(at == s->bytes.size);
}

TEST(uploading_the_ranges_reproduces_the_mesh)
{
    for (int kind = 0; kind < SHAPE_COUNT; kind++)
        for (int way = 0; way < 4; way++) {
            scene s;
            bake(&s, (shape_kind)kind, kind == SHAPE_SOUP ? 20 : 8,
                 (pmesh_placement)(way & 1), way >> 1);
            walk(&s, 2000);
            scene_free(&s);
        }
}

TEST(ten_thousand_random_steps_reproduce_the_mesh)
{
    scene s;
    bake(&s, SHAPE_TORUS, 8, PMESH_SUBSET, 0);
    walk(&s, 10000);
    scene_free(&s);
}

static int falling(const void *a, const void *b)
{
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x < y) - (x > y);
}

/* What the widest gaps between runs of touched items leave to be listed. */
static uint64_t least_listed(const dec_touched *t, uint32_t end)
{
    uint32_t gaps[4096], count = 0, first = dec_touched_next(t, 0, end);
    uint32_t last = first;
    for (uint32_t i = first; i < end; i = dec_touched_next(t, i + 1, end)) {
        if (i > last + 1)
            gaps[count++] = i - last - 1;
        last = i;
    }
    uint64_t listed = first < end ? last + 1 - first : 0;
    qsort(gaps, count, sizeof *gaps, falling);
    for (uint32_t i = 0; i < count && i + 1 < PMESH_MAX_RANGES; i++)
        listed -= gaps[i];
    return listed;
}

TEST(few_ranges_list_as_little_as_possible)
{
    enum { ITEMS = 4001 };
    static uint32_t words[(ITEMS + 127) / 128 * 4];
    uint32_t seed = 2;
    for (uint32_t round = 0; round < 500; round++) {
        dec_touched t;
        pmesh_range ranges[PMESH_MAX_RANGES];
        uint64_t listed = 0;
        dec_touched_bind(&t, ITEMS, words);
        for (uint32_t i = shape_random(&seed, 1 + round); i > 0; i--) {
            const uint32_t at = shape_random(&seed, ITEMS);
            const uint32_t end = at + shape_random(&seed, 1 + round % 20);
            dec_touch_range(&t, at, end < ITEMS ? end : ITEMS);
        }
        const uint32_t end = 1 + shape_random(&seed, ITEMS);
        const uint32_t count = dec_touched_ranges(&t, end, ranges);
        for (uint32_t i = 0; i < count; i++) {
            CHECK(dec_is_touched(&t, ranges[i].first));
            CHECK(ranges[i].first + ranges[i].count <= end);
            listed += ranges[i].count;
        }
        CHECK(listed == least_listed(&t, end));
    }
}

TEST(max_ops_bounds_the_splits_of_a_call)
{
    scene s;
    bake(&s, SHAPE_TORUS, 12, PMESH_SUBSET, 0);
    pmesh_decoder_feed(s.dec, s.bytes.data, s.bytes.size);
    pmesh_decoder_header(s.dec, &s.h);
    for (int down = 0; down < 2; down++) {
        const pmesh_target target = { .faces = down ? 1 : 0, .max_ops = 7 };
        const uint32_t splits = s.h.mesh_vertices - s.h.base_mesh_vertices;
        uint32_t calls = 1;
        while (pmesh_decoder_refine(s.dec, &target, NULL) == PMESH_MORE)
            calls++;
        CHECK(calls == (splits + 6) / 7);
    }
    scene_free(&s);
}

TEST(binding_refuses_what_does_not_fit)
{
    scene s;
    float room[3];
    bake(&s, SHAPE_TORUS, 6, PMESH_SUBSET, 0);
    pmesh_buffers b = { .positions = room, .position_stride = 8 };
    CHECK(pmesh_decoder_bind(s.dec, &b) == PMESH_NEED_DATA);
    feed_header(&s);
    CHECK(pmesh_decoder_bind(s.dec, &b) == PMESH_E_ARGUMENT);
    b = (pmesh_buffers){ .index_size = 3 };
    CHECK(pmesh_decoder_bind(s.dec, &b) == PMESH_E_ARGUMENT);
    b = (pmesh_buffers){ .attributes = { room } };
    CHECK(pmesh_decoder_bind(s.dec, &b) == PMESH_E_ARGUMENT);
    CHECK(pmesh_decoder_bind(s.dec, NULL) == PMESH_OK);
    scene_free(&s);
}

TEST(indices_of_16_bits_are_the_same_indices)
{
    scene s;
    bake(&s, SHAPE_SPHERE, 8, PMESH_SUBSET, 0);
    pmesh_decoder_feed(s.dec, s.bytes.data, s.bytes.size);
    pmesh_decoder_header(s.dec, &s.h);
    uint16_t *narrow = calloc(s.h.faces, 6);
    const pmesh_buffers b = { .indices = narrow, .index_size = 2 };
    CHECK(pmesh_decoder_bind(s.dec, &b) == PMESH_OK);
    pmesh_decoder_refine(s.dec, NULL, NULL);
    pmesh_view v;
    pmesh_decoder_mesh(s.dec, &v);
    for (uint32_t i = 0; i < 3 * v.face_count; i++)
        CHECK(narrow[i] == v.indices[i]);
    free(narrow);
    scene_free(&s);
}

TEST(draw_groups_sort_the_faces_by_material)
{
    scene s;
    bake(&s, SHAPE_SPHERE, 10, PMESH_SUBSET, 0);
    pmesh_decoder_feed(s.dec, s.bytes.data, s.bytes.size);
    pmesh_decoder_header(s.dec, &s.h);
    CHECK(s.h.material_count > 1);
    pmesh_range *groups = calloc(s.h.material_count, sizeof *groups);
    uint32_t *sorted = calloc(s.h.faces, 12);
    for (uint32_t faces = s.h.base_faces; faces <= s.h.faces; faces += 13) {
        const pmesh_target target = { .faces = faces };
        pmesh_view v;
        pmesh_decoder_refine(s.dec, &target, NULL);
        pmesh_decoder_mesh(s.dec, &v);
        pmesh_decoder_copy_indices(s.dec, sorted, 0, groups);
        uint32_t at = 0;
        for (uint32_t m = 0; m < s.h.material_count; m++) {
            CHECK(groups[m].first == at);
            for (uint32_t f = 0; f < v.face_count; f++)
                if (v.materials[f] == m)
                    CHECK(!memcmp(sorted + 3 * (size_t)at++, v.indices + 3 * f,
                                  12));
            CHECK(groups[m].first + groups[m].count == at);
        }
        CHECK(at == v.face_count);
    }
    free(groups);
    free(sorted);
    scene_free(&s);
}

static const float *corner(const float *xyz, const pmesh_view *v, uint32_t f,
                           uint32_t k)
{
    return xyz + 3 * (size_t)v->indices[3 * (size_t)f + k];
}

/* At the start of a morph the faces of the coarse mesh lie where they lay, and
 * the others have two corners in one place. */
TEST(a_morph_starts_as_the_coarse_mesh)
{
    for (int placement = 0; placement < 2; placement++) {
        scene s;
        bake(&s, SHAPE_SPHERE, 10, (pmesh_placement)placement, 0);
        pmesh_decoder_feed(s.dec, s.bytes.data, s.bytes.size);
        pmesh_decoder_header(s.dec, &s.h);
        float *coarse = calloc(s.h.vertices, 12), *from = calloc(s.h.vertices, 12);
        uint32_t *old = calloc(s.h.faces, 12);
        const pmesh_target low = { .faces = s.h.faces / 5 };
        const pmesh_target high = { .faces = s.h.faces / 2 };
        pmesh_view v, w;
        pmesh_decoder_refine(s.dec, &low, NULL);
        pmesh_decoder_mesh(s.dec, &v);
        memcpy(old, v.indices, 12 * (size_t)v.face_count);
        pmesh_decoder_copy_positions(s.dec, coarse, 0);
        pmesh_decoder_refine(s.dec, &high, NULL);
        const uint64_t hash = shape_view_hash(s.dec);
        CHECK(pmesh_decoder_copy_morph(s.dec, &low, from, 0) == PMESH_OK);
        CHECK(shape_view_hash(s.dec) == hash);
        pmesh_decoder_mesh(s.dec, &w);
        const pmesh_view before = { .indices = old };
        for (uint32_t f = 0; f < v.face_count; f++)
            for (uint32_t k = 0; k < 3; k++)
                CHECK(!memcmp(corner(from, &w, f, k),
                              corner(coarse, &before, f, k), 12));
        for (uint32_t f = v.face_count; f < w.face_count; f++) {
            const float *a = corner(from, &w, f, 0), *b = corner(from, &w, f, 1),
                        *c = corner(from, &w, f, 2);
            CHECK(!memcmp(a, b, 12) || !memcmp(b, c, 12) || !memcmp(a, c, 12));
        }
        free(coarse);
        free(from);
        free(old);
        scene_free(&s);
    }
}

TEST(a_ray_meets_the_nearest_face)
{
    scene s;
    double low[3], high[3], middle[3];
    bake(&s, SHAPE_SPHERE, 10, PMESH_SUBSET, 0);
    pmesh_decoder_feed(s.dec, s.bytes.data, s.bytes.size);
    pmesh_decoder_refine(s.dec, NULL, NULL);
    CHECK(pmesh_decoder_bounds(s.dec, low, high) == PMESH_OK);
    for (int k = 0; k < 3; k++)
        middle[k] = (low[k] + high[k]) / 2;
    uint32_t seed = 1;
    for (int i = 0; i < 100; i++) {
        double d[3], outside[3];
        pmesh_hit near, far;
        for (int k = 0; k < 3; k++) {
            d[k] = shape_random(&seed, 2001) / 1000.0 - 1 + 1e-4;
            outside[k] = middle[k] - 10 * d[k];
        }
        CHECK(pmesh_decoder_raycast(s.dec, middle, d, &far));
        CHECK(far.distance > 0);
        CHECK(fabs(far.weight[0] + far.weight[1] + far.weight[2] - 1) < 1e-9);
        CHECK(pmesh_decoder_raycast(s.dec, outside, d, &near));
        CHECK(near.distance < 10 + far.distance); /* the side towards us */
        for (int k = 0; k < 3; k++)
            d[k] = -d[k];
        for (int k = 0; k < 3; k++)
            outside[k] = middle[k] + 1000 * d[k];
        CHECK(!pmesh_decoder_raycast(s.dec, outside, d, &near));
    }
    const double nowhere[3] = { 0, 0, 0 };
    pmesh_hit hit;
    CHECK(!pmesh_decoder_raycast(s.dec, middle, nowhere, &hit));
    scene_free(&s);
}

TEST(bounds_are_those_of_what_is_visible)
{
    scene s;
    bake(&s, SHAPE_TERRAIN, 10, PMESH_OPTIMAL, 0);
    pmesh_decoder_feed(s.dec, s.bytes.data, s.bytes.size);
    pmesh_decoder_header(s.dec, &s.h);
    float *xyz = calloc(s.h.vertices, 12);
    for (uint32_t faces = 1; faces < s.h.faces; faces += 17) {
        const pmesh_target target = { .faces = faces };
        double low[3], high[3];
        pmesh_view v;
        pmesh_decoder_refine(s.dec, &target, NULL);
        pmesh_decoder_mesh(s.dec, &v);
        pmesh_decoder_copy_positions(s.dec, xyz, 0);
        CHECK(pmesh_decoder_bounds(s.dec, low, high) == PMESH_OK);
        for (size_t k = 0; k < 3; k++) {
            float a = xyz[k], b = a;
            for (size_t w = 0; w < v.vertex_count; w++) {
                a = fminf(a, xyz[3 * w + k]);
                b = fmaxf(b, xyz[3 * w + k]);
            }
            CHECK(a == (float)low[k] && b == (float)high[k]);
        }
    }
    free(xyz);
    scene_free(&s);
}
