/* SPDX-License-Identifier: MIT */
/* Base meshes that hooks code: by Draco, and by a stub that shuffles all
 * numbers and spoils what it is told to. */
#include <stdlib.h>
#include <string.h>

#include "encoder/enc_match.h"
#include "format/alloc.h"
#include "tests/unit/faces.h"
#include "tests/unit/shapes.h"
#include "tests/unit/test.h"
#include "tools/draco_base.h"

/* What the stub decodes to. */
typedef struct answer {
    int32_t *positions;
    uint32_t *indices;
    uint32_t vertices, faces;
} answer;

typedef struct stub {
    pmesh_status encoding, decoding; /* what to return */
    void (*spoil)(answer a);         /* NULL: nothing */
    size_t excess;                   /* claimed beyond the capacity */
} stub;

/* Raw numbers: vertices and faces in reverse, faces turned by one corner. */
static pmesh_status stub_encode(void *user, const int32_t *positions,
                                uint32_t vertices, const uint32_t *indices,
                                uint32_t faces, void *out, size_t capacity,
                                size_t *size)
{
    const stub *s = user;
    uint8_t *to = out;
    *size = 12 * ((size_t)vertices + faces);
    if (s->encoding != PMESH_OK)
        return s->encoding;
    CHECK(*size <= capacity);
    for (size_t v = vertices; v-- > 0; to += 12)
        memcpy(to, positions + 3 * v, 12);
    for (size_t f = faces; f-- > 0; to += 12) {
        uint32_t corner[3];
        for (size_t k = 0; k < 3; k++)
            corner[k] = vertices - 1 - indices[3 * f + (k + 1) % 3];
        memcpy(to, corner, 12);
    }
    if (s->excess)
        *size = capacity + s->excess;
    return PMESH_OK;
}

static pmesh_status stub_decode(void *user, const void *data, size_t size,
                                uint32_t vertices, uint32_t faces,
                                int32_t *positions, uint32_t *indices)
{
    const stub *s = user;
    const uint8_t *from = data;
    if (size != 12 * ((size_t)vertices + faces))
        return PMESH_E_CORRUPT;
    if (s->decoding != PMESH_OK)
        return s->decoding;
    memcpy(positions, from, 12 * (size_t)vertices);
    memcpy(indices, from + 12 * (size_t)vertices, 12 * (size_t)faces);
    if (s->spoil)
        s->spoil((answer){ positions, indices, vertices, faces });
    return PMESH_OK;
}

static pmesh_encoder_config stub_config(stub *s)
{
    pmesh_encoder_config config = pmesh_encoder_config_default();
    config.base_faces = 30;
    config.position_bits = 12;
    config.base_coder = PMESH_BASE_DRACO;
    config.topology = PMESH_TOPOLOGY_KEEP; /* joined bases are native */
    config.base_encoder = stub_encode;
    config.base_decoder = stub_decode;
    config.base_user = s;
    return config;
}

/* Decodes with the hook, if any; the decoder is the caller's. */
static pmesh_status decode(const shape_bytes *b, pmesh_base_decode hook,
                           void *user, pmesh_decoder **dec)
{
    pmesh_decoder_config config = pmesh_decoder_config_default();
    config.base_decoder = hook;
    config.base_user = user;
    CHECK(pmesh_decoder_create(dec, &config) == PMESH_OK);
    return pmesh_decoder_feed(*dec, b->data, b->size);
}

static uint32_t size_of(shape_kind kind)
{
    static const uint32_t sizes[SHAPE_COUNT] = { 12, 20, 18, 10, 40, 30 };
    return sizes[kind];
}

/* Full detail is the input, and every budget shows a mesh. */
static bool comes_back(shape_kind kind, const pmesh_encoder_config *config)
{
    shape_mesh *s = shape_make(kind, size_of(kind), 1 + (uint32_t)kind);
    shape_bytes bytes;
    pmesh_encode_report report;
    pmesh_decoder *dec;
    pmesh_header h;
    CHECK(shape_bake(s, config, &bytes, &report) == PMESH_OK);
    CHECK(report.base_coder == config->base_coder);
    CHECK(decode(&bytes, config->base_decoder, config->base_user, &dec) ==
          PMESH_OK);
    CHECK(pmesh_decoder_header(dec, &h) == PMESH_OK);
    bool good = h.base_coder == config->base_coder && h.bytes == bytes.size;
    for (uint32_t faces = h.base_faces; faces <= h.faces; faces += 7) {
        pmesh_view v;
        const pmesh_target target = { .faces = faces };
        pmesh_decoder_refine(dec, &target, NULL);
        pmesh_decoder_mesh(dec, &v);
        good = good && v.face_count + 2 > faces && shape_view_sound(dec);
    }
    good = good && faces_match(&s->input, dec);
    pmesh_decoder_destroy(dec);
    free(bytes.data);
    shape_free(s);
    return good;
}

/* Of all sizes, a base of the whole mesh among them. */
static void every_shape_comes_back(pmesh_encoder_config config)
{
    static const uint32_t faces[] = { 1, 100, UINT32_MAX };
    for (int kind = 0; kind < SHAPE_COUNT; kind++)
        for (int i = 0; i < 6; i++) {
            config.base_faces = faces[i / 2];
            config.placement = i % 2 ? PMESH_OPTIMAL : PMESH_SUBSET;
            config.position_bits = i % 2 ? 24 : 4;
            CHECK(comes_back((shape_kind)kind, &config));
        }
}

TEST(splits_follow_the_numbers_of_a_base_hook)
{
    stub s = { 0 };
    every_shape_comes_back(stub_config(&s));
}

TEST(draco_carries_the_base_of_every_shape)
{
    pmesh_encoder_config config = pmesh_encoder_config_default();
    config.base_coder = PMESH_BASE_DRACO;
    config.topology = PMESH_TOPOLOGY_KEEP;
    config.base_encoder = draco_base_encode;
    config.base_decoder = draco_base_decode;
    every_shape_comes_back(config);
}

static shape_bytes bake(pmesh_encoder_config config, pmesh_status expected,
                        pmesh_base_coder coder)
{
    shape_mesh *s = shape_make(SHAPE_SPHERE, 8, 3);
    shape_bytes bytes;
    pmesh_encode_report report;
    CHECK(shape_bake(s, &config, &bytes, &report) == expected);
    CHECK(expected != PMESH_OK || report.base_coder == coder);
    shape_free(s);
    return bytes;
}

TEST(decoder_without_a_base_hook_says_so_behind_the_header)
{
    stub s = { 0 };
    shape_bytes b = bake(stub_config(&s), PMESH_OK, PMESH_BASE_DRACO);
    pmesh_decoder *dec;
    pmesh_header h;
    pmesh_view v;
    CHECK(decode(&b, NULL, NULL, &dec) == PMESH_E_UNSUPPORTED);
    CHECK(PMESH_E_UNSUPPORTED == -14); /* pinned */
    const pmesh_decode_error error = pmesh_decoder_error(dec);
    CHECK(error.status == PMESH_E_UNSUPPORTED);
    CHECK(strstr(error.rule, "base_decoder"));
    CHECK(pmesh_decoder_header(dec, &h) == PMESH_OK);
    CHECK(h.base_coder == PMESH_BASE_DRACO);
    CHECK(error.offset < h.levels[0].bytes);
    CHECK(pmesh_decoder_mesh(dec, &v) == PMESH_NEED_DATA);
    CHECK(pmesh_decoder_feed(dec, b.data, 1) == PMESH_E_UNSUPPORTED);
    pmesh_decoder_destroy(dec);
    free(b.data);
}

/* ---- hostile answers ---------------------------------------------------- */

static void nothing(answer a)
{
    memset(a.positions, 0, 12 * (size_t)a.vertices);
    memset(a.indices, 0, 12 * (size_t)a.faces);
}

static void negative(answer a) { a.positions[5] = -1; }
static void too_far(answer a) { a.positions[3] = 1 << 12; }
static void most_far(answer a) { a.positions[3] = INT32_MAX; }
static void no_such_vertex(answer a) { a.indices[7] = a.vertices; }
static void no_vertex(answer a) { a.indices[0] = UINT32_MAX; }
static void vertex_twice(answer a) { a.indices[1] = a.indices[0]; }
static void face_twice(answer a) { memcpy(a.indices, a.indices + 3, 12); }

static void flipped(answer a)
{
    const uint32_t x = a.indices[0];
    a.indices[0] = a.indices[1];
    a.indices[1] = x;
}

/* One vertex takes the faces of another, which is left without. */
static void joined(answer a)
{
    for (uint32_t i = 0; i < 3 * a.faces; i++)
        if (a.indices[i] == a.vertices - 1)
            a.indices[i] = 0;
}

static const struct {
    void (*spoil)(answer a);
    const char *rule;
} spoilt[] = {
    { nothing, "the same way" },
    { negative, "out of bounds" },
    { too_far, "out of bounds" },
    { most_far, "out of bounds" },
    { no_such_vertex, "no such base vertex" },
    { no_vertex, "no such base vertex" },
    { vertex_twice, "SPEC 6.2" },
    { face_twice, "the same way" },
    { flipped, "the same way" },
    { joined, "SPEC 6.2" },
};
enum { SPOILT = sizeof spoilt / sizeof *spoilt };

TEST(decoder_checks_all_that_a_base_hook_answers)
{
    stub s = { 0 };
    shape_bytes b = bake(stub_config(&s), PMESH_OK, PMESH_BASE_DRACO);
    for (int i = 0; i < SPOILT; i++) {
        pmesh_decoder *dec;
        pmesh_view v;
        s.spoil = spoilt[i].spoil;
        CHECK(decode(&b, stub_decode, &s, &dec) == PMESH_E_CORRUPT);
        CHECK(strstr(pmesh_decoder_error(dec).rule, spoilt[i].rule));
        CHECK(pmesh_decoder_mesh(dec, &v) == PMESH_NEED_DATA);
        pmesh_decoder_destroy(dec);
    }
    free(b.data);
}

/* It claims to have done its work and touches nothing: what the decoder looks
 * at then must not be memory of before (valgrind, MSan). */
static pmesh_status idle(void *user, const void *data, size_t size,
                         uint32_t vertices, uint32_t faces, int32_t *positions,
                         uint32_t *indices)
{
    CHECK(user == NULL && data && size == 12 * ((size_t)vertices + faces));
    for (uint32_t i = 0; i < 3 * vertices; i++)
        CHECK(positions[i] == 0);
    for (uint32_t i = 0; i < 3 * faces; i++)
        CHECK(indices[i] == 0);
    return PMESH_OK;
}

TEST(an_idle_base_hook_sees_and_shows_zeros)
{
    stub s = { 0 };
    shape_bytes b = bake(stub_config(&s), PMESH_OK, PMESH_BASE_DRACO);
    pmesh_decoder *dec;
    CHECK(decode(&b, idle, NULL, &dec) == PMESH_E_CORRUPT);
    pmesh_decoder_destroy(dec);
    free(b.data);
}

TEST(the_status_of_a_base_hook_is_passed_on)
{
    static const pmesh_status given[] = { PMESH_E_MEMORY, PMESH_E_CORRUPT,
                                          PMESH_E_VERSION, PMESH_NEED_DATA };
    stub s = { 0 };
    shape_bytes b = bake(stub_config(&s), PMESH_OK, PMESH_BASE_DRACO);
    for (int i = 0; i < 4; i++) {
        pmesh_decoder *dec;
        s.decoding = given[i];
        CHECK(decode(&b, stub_decode, &s, &dec) ==
              (i == 0 ? PMESH_E_MEMORY : PMESH_E_CORRUPT));
        CHECK(strstr(pmesh_decoder_error(dec).rule, "SPEC 6.2: the Draco"));
        pmesh_decoder_destroy(dec);
    }
    free(b.data);
}

/* ---- the encoder's side ------------------------------------------------- */

static void moved(answer a) { a.positions[0] ^= 1; }

static void turned_inside_out(answer a)
{
    for (uint32_t f = 0; f < a.faces; f++)
        flipped((answer){ .indices = a.indices + 3 * (size_t)f });
}

/* Two vertices change their places, but not their faces. */
static void swapped(answer a)
{
    int32_t first[3];
    memcpy(first, a.positions, 12);
    memcpy(a.positions, a.positions + 3, 12);
    memcpy(a.positions + 3, first, 12);
}

TEST(a_base_that_the_hook_cannot_hold_is_coded_natively)
{
    static void (*const wrong[])(answer a) = { moved, turned_inside_out,
                                               swapped };
    stub s = { 0 };
    pmesh_encoder_config native = stub_config(&s);
    native.base_coder = PMESH_BASE_NATIVE;
    shape_bytes expected = bake(native, PMESH_OK, PMESH_BASE_NATIVE);
    for (int i = 0; i < SPOILT + 6; i++) {
        s = (stub){ 0 };
        if (i < SPOILT)
            s.spoil = spoilt[i].spoil;
        else if (i < SPOILT + 3)
            s.spoil = wrong[i - SPOILT];
        else if (i == SPOILT + 3)
            s.encoding = PMESH_E_UNSUPPORTED;
        else if (i == SPOILT + 4)
            s.decoding = PMESH_E_CORRUPT;
        else
            s.excess = 1;
        shape_bytes b = bake(stub_config(&s), PMESH_OK, PMESH_BASE_NATIVE);
        CHECK(b.size == expected.size);
        CHECK(memcmp(b.data, expected.data, b.size) == 0);
        free(b.data);
    }
    free(expected.data);
}

/* Native bytes for want of memory would not be the same bytes again. */
TEST(a_base_hook_without_memory_ends_the_bake)
{
    for (int i = 0; i < 2; i++) {
        stub s = { 0 };
        *(i ? &s.encoding : &s.decoding) = PMESH_E_MEMORY;
        shape_bytes b = bake(stub_config(&s), PMESH_E_MEMORY,
                             PMESH_BASE_DRACO);
        CHECK(b.size == 0);
        free(b.data);
    }
}

TEST(a_draco_base_needs_both_hooks)
{
    stub s = { 0 };
    pmesh_encoder_config config = stub_config(&s);
    config.base_encoder = NULL;
    bake(config, PMESH_E_ARGUMENT, PMESH_BASE_DRACO);
    config = stub_config(&s);
    config.base_decoder = NULL;
    bake(config, PMESH_E_ARGUMENT, PMESH_BASE_DRACO);
}

/* ---- matching ----------------------------------------------------------- */

enum { STRIP = 3, PIECES = 200, EDGES = 3 * STRIP * PIECES };

typedef struct soup {
    pmesh_mesh mesh;
    uint32_t vertex[EDGES], twin[EDGES];
    int32_t position[(STRIP + 2) * PIECES][3];
} soup;

/* Strips of three faces, the first two of which all lie upon each other; the
 * third one's tip is at the height of `tip`. */
static soup *strips(uint32_t count, const int32_t *tip)
{
    static const int32_t place[][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 },
                                        { 1, 1, 0 }, { 0, 2, 0 } };
    static const uint32_t corner[] = { 0, 1, 2, 2, 1, 3, 2, 3, 4 };
    static const uint32_t twin[] = { PMESH_NONE, 3, PMESH_NONE, 1, PMESH_NONE,
                                     6, 5, PMESH_NONE, PMESH_NONE };
    soup *s = calloc(1, sizeof *s);
    s->mesh = (pmesh_mesh){ .vertex_count = (STRIP + 2) * count,
                            .face_count = STRIP * count,
                            .vertex = s->vertex, .twin = s->twin,
                            .position = s->position };
    for (uint32_t i = 0; i < count; i++) {
        memcpy(s->position[(STRIP + 2) * i], place, sizeof place);
        s->position[(STRIP + 2) * i + 4][2] = tip[i];
        for (uint32_t h = 0; h < 3 * STRIP; h++) {
            const uint32_t t = twin[h];
            s->vertex[3 * STRIP * i + h] = (STRIP + 2) * i + corner[h];
            s->twin[3 * STRIP * i + h] =
                t == PMESH_NONE ? t : 3 * STRIP * i + t;
        }
    }
    return s;
}

static bool match(const soup *mesh, const soup *copy)
{
    static const pmesh_allocator none = { 0 };
    const pmesh_allocator a = pmesh_allocator_resolve(none);
    uint32_t edge_of[EDGES];
    bool same = false;
    CHECK(enc_match(&a, &mesh->mesh, &copy->mesh, edge_of, &same) ==
          PMESH_OK);
    for (uint32_t h = 0; same && h < 3 * copy->mesh.face_count; h++) {
        const uint32_t o = edge_of[h], t = copy->twin[h];
        CHECK(memcmp(mesh->position[mesh->vertex[o]],
                     copy->position[copy->vertex[h]], 12) == 0);
        CHECK(mesh->twin[o] == (t == PMESH_NONE ? t : edge_of[t]));
        for (uint32_t k = 0; k < h; k++)
            CHECK(edge_of[k] != o);
    }
    return same;
}

TEST(pieces_upon_each_other_are_told_apart_by_what_follows)
{
    static const int32_t there[] = { 5, 6, 7, 7 }, back[] = { 7, 6, 7, 5 };
    static const int32_t other[] = { 5, 6, 7, 8 }, copies[] = { 5, 6, 6, 7 };
    soup *mesh = strips(4, there);
    soup *same = strips(4, back), *not = strips(4, other);
    soup *more = strips(4, copies), *less = strips(3, there);
    CHECK(match(mesh, mesh));
    CHECK(match(mesh, same));
    CHECK(!match(mesh, not));
    CHECK(!match(mesh, more)); /* each piece once */
    CHECK(!match(mesh, less));
    free(mesh);
    free(same);
    free(not);
    free(more);
    free(less);
}

/* 200 pieces, each one found among those left, the last one first: 20,000
 * tries of three faces, or of as many as patience allows. */
TEST(the_search_among_many_such_pieces_is_given_up)
{
    int32_t up[PIECES], down[PIECES];
    for (int32_t i = 0; i < PIECES; i++) {
        up[i] = i;
        down[i] = PIECES - 1 - i;
    }
    soup *mesh = strips(PIECES, up), *copy = strips(PIECES, down);
    CHECK(!match(mesh, copy));
    free(mesh);
    free(copy);
}
