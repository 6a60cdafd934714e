/* SPDX-License-Identifier: MIT */
/*
 * Joined streams that nobody baked: an oracle that makes up base, partings,
 * lone faces, positions, wedges and materials; what it wrote is then decoded.
 */
#include "format/join.h"

#include <stdlib.h>
#include <string.h>

#include "decoder/pmesh_decode.h"
#include "encoder/enc_stream.h"
#include "format/alloc.h"
#include "tests/unit/random_cut.h"
#include "tests/unit/shapes.h"
#include "tests/unit/test.h"

enum {
    POINTS = 2 * PMESH_MAX_PARTS + 1,
    PIECES = 24, /* of the base: triangles and tetrahedra */
    LEVELS = 6,
    VERTICES = 1500,
    FACES = 8000,
    WEDGES = 60000,
    BITS = 10,
    ROOM = 1 << 20
};

/* How corners share wedges: as their vertex does, each its own, or two kinds. */
typedef enum wedging { BY_VERTEX, BY_CORNER, BY_KIND } wedging;

typedef struct inventor {
    pmesh_codec codec;
    pmesh_oracle oracle;
    void *block;
    uint32_t seed;
    wedging how;
    bool partial; /* few splits cut a fan */
    bool wide;    /* vertex 0 has the most fans, and parts as widely as can be */
    pmesh_mesh base;
    uint32_t base_vertex[12 * PIECES], base_twin[12 * PIECES];
    uint32_t point[12 * PIECES], codec_fan[12 * PIECES],
        codec_edge[12 * PIECES], point_vertex[POINTS];
    int32_t position[12 * PIECES][3], place[POINTS][3];
    uint8_t kind[3 * FACES]; /* of corners */
    uint32_t number[3 * FACES];
    uint16_t values[2];
    enc_stream stream;
    pmesh_header_chunk header;
} inventor;

static uint32_t below(inventor *t, uint32_t n)
{
    return shape_random(&t->seed, n);
}

/* ---- the base ------------------------------------------------------------ */

/* Of point i of a piece: of the first pieces all there are, one after the
 * other, then any. Wide, all pieces have point 0. */
static uint32_t choose_point(inventor *t, uint32_t fan, uint32_t i)
{
    if (t->wide)
        return i == 0 ? 0 : fan - fan / 3;
    return fan < POINTS ? fan : below(t, POINTS);
}

static void add_piece(inventor *t, const uint32_t *corners,
                      const uint32_t *twins, uint32_t faces, uint32_t fans)
{
    pmesh_mesh *m = &t->base;
    const uint32_t v = m->vertex_count, h = 3 * m->face_count;
    for (uint32_t i = 0; i < fans; i++) {
        bool fresh;
        do { /* different points; of the first pieces, all there are */
            t->point[v + i] = choose_point(t, v + i, i);
            fresh = true;
            for (uint32_t k = 0; k < i; k++)
                fresh &= t->point[v + k] != t->point[v + i];
        } while (!fresh);
        memcpy(t->position[v + i], t->place[t->point[v + i]],
               sizeof *t->place);
    }
    for (uint32_t i = 0; i < 3 * faces; i++) {
        m->vertex[h + i] = v + corners[i];
        m->twin[h + i] = twins[i] == PMESH_NONE ? PMESH_NONE : h + twins[i];
    }
    m->vertex_count += fans;
    m->face_count += faces;
}

static void make_base(inventor *t)
{
    static const uint32_t solid[] = { 0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2 };
    static const uint32_t glue[] = { 11, 6, 3, 2, 8, 9, 1, 10, 4, 5, 7, 0 };
    static const uint32_t alone[] = { PMESH_NONE, PMESH_NONE, PMESH_NONE };
    static const uint32_t corner[] = { 0, 1, 2 };
    static const uint32_t leaf[] = { 0, 1, 2, 1, 0, 2 };
    static const uint32_t seam[] = { 3, 5, 4, 0, 2, 1 };
    t->base = (pmesh_mesh){ .vertex = t->base_vertex,
                            .twin = t->base_twin,
                            .position = t->position };
    for (uint32_t p = 0; p < POINTS; p++)
        for (int k = 0; k < 3; k++)
            t->place[p][k] = (int32_t)below(t, 1 << BITS);
    for (uint32_t i = 0; i < PIECES; i++) {
        if (t->wide)
            add_piece(t, leaf, seam, 2, 3);
        else if (below(t, 2))
            add_piece(t, solid, glue, 4, 4);
        else
            add_piece(t, corner, alone, 1, 3);
    }
    memset(t->codec_fan, 0xff, sizeof t->codec_fan);
    memset(t->point_vertex, 0xff, sizeof t->point_vertex);
}

/* ---- answers ------------------------------------------------------------- */

static bool answer_splits(void *user, uint32_t v)
{
    inventor *t = user;
    return t->wide ? v == 0 || v % 2 : below(t, 3) > 0;
}

static uint32_t fans_of(const pmesh_mesh *m, uint32_t v)
{
    uint32_t count = 0;
    for (uint32_t h = m->first[v]; h != PMESH_NONE; h = m->fan[h])
        count++;
    return count;
}

static void answer_part(void *user, uint32_t v, const pmesh_fans *fans,
                        pmesh_parting *p)
{
    inventor *t = user;
    const pmesh_mesh *m = &t->codec.mesh;
    const bool most = t->wide && v == 0;
    bool v_has = false, u_has = false;
    for (uint32_t i = 0; i < fans->count; i++) {
        p->way[i] = (pmesh_way)(below(t, t->partial ? 8 : 3) % 3);
        if (t->partial && p->way[i] == PMESH_FAN_CUT && below(t, 2))
            p->way[i] = PMESH_FAN_STAYS;
        if (most)
            p->way[i] = PMESH_FAN_CUT;
        if (p->way[i] == PMESH_FAN_CUT)
            p->cut[i] = random_cut(&t->seed, &fans->ring[i]);
        v_has |= p->way[i] != PMESH_FAN_MOVES;
        u_has |= p->way[i] != PMESH_FAN_STAYS;
    }
    const uint32_t wanted = most ? PMESH_MAX_LONE
                            : v_has && u_has && below(t, 3) ? 0
                            : below(t, 20) ? 1 + below(t, 3) : PMESH_MAX_LONE;
    for (uint32_t tries = 0; tries < 200 && p->lone_count < wanted; tries++) {
        uint32_t w = below(t, m->vertex_count);
        if (below(t, 2))
            w = fans->ring[0].vertex[below(t, fans->ring[0].count)];
        if (w == v || fans_of(m, w) > PMESH_MAX_FANS - PMESH_MAX_LONE)
            continue;
        p->lone[p->lone_count] =
            most ? PMESH_LONE_PAIR : (pmesh_lone)below(t, 3);
        p->third[p->lone_count++] = w;
    }
}

static void answer_split_done(void *user, uint32_t child, uint32_t face,
                              uint32_t count)
{
    inventor *t = user;
    (void)child;
    for (uint32_t h = 3 * face; h < 3 * (face + count); h++)
        t->kind[h] = (uint8_t)below(t, 2);
}

static void answer_position(void *user, uint32_t v, int32_t out[3])
{
    inventor *t = user;
    for (int k = 0; k < 3; k++) {
        const int32_t x = t->codec.mesh.position[v][k] + (int32_t)below(t, 21);
        out[k] = x < 10 ? 0 : x - 10 >= 1 << BITS ? (1 << BITS) - 1 : x - 10;
    }
}

static uint32_t answer_key(void *user, uint32_t h)
{
    const inventor *t = user;
    const uint32_t v = t->codec.mesh.vertex[h];
    return t->how == BY_VERTEX ? v : t->how == BY_CORNER ? h
                                                         : 2 * v + t->kind[h];
}

static uint32_t answer_number(void *user, uint32_t key)
{
    return ((inventor *)user)->number[key];
}

static void answer_set_number(void *user, uint32_t key, uint32_t wedge)
{
    ((inventor *)user)->number[key] = wedge;
}

static const uint16_t *answer_values(void *user, uint32_t wedge)
{
    inventor *t = user;
    t->values[0] = (uint16_t)below(t, 256);
    t->values[1] = (uint16_t)(wedge % 256);
    return t->values;
}

static uint32_t answer_material(void *user, uint32_t face)
{
    return face % 7 ? 0 : below(user, 3);
}

/* ---- writing ------------------------------------------------------------- */

static inventor *invent(uint32_t seed, wedging how, bool moves, bool partial,
                        bool wide)
{
    inventor *t = calloc(1, sizeof *t);
    t->seed = seed;
    t->how = how;
    t->partial = partial;
    t->wide = wide;
    make_base(t);
    pmesh_header_chunk *h = &t->header;
    h->attribute_count = 1;
    h->attributes[0] = (pmesh_attribute){ .kind = PMESH_TEXCOORD,
                                          .components = 2,
                                          .bits = 8,
                                          .scale = { 1, 1 } };
    h->grid = (pmesh_grid){ .step = 1, .bits = BITS };
    h->sizes = (pmesh_codec_sizes){ .vertices = VERTICES,
                                    .faces = FACES,
                                    .wedges = WEDGES,
                                    .base_faces = t->base.face_count,
                                    .attribute_count = 1,
                                    .value_count = 2,
                                    .material_count = 3,
                                    .moves = moves,
                                    .joined = true,
                                    .base_fans = t->base.vertex_count,
                                    .block_splits = VERTICES,
                                    .block_faces = FACES,
                                    .block_wedges = WEDGES };
    t->block =
        calloc(1, (size_t)pmesh_codec_bind(&t->codec, &h->sizes, NULL));
    pmesh_codec_bind(&t->codec, &h->sizes, t->block);
    pmesh_codec_limit_values(&t->codec, h->attributes, 1);
    for (int k = 0; k < 3; k++)
        h->bounds[k] = t->codec.bounds[k] = (1 << BITS) - 1;
    memset(t->number, 0xff, sizeof t->number);
    t->oracle = (pmesh_oracle){ .user = t,
                                .base = &t->base,
                                .base_edge = t->codec_edge,
                                .base_vertex = t->codec_fan,
                                .base_point = t->point,
                                .point_vertex = t->point_vertex,
                                .splits = answer_splits,
                                .part = answer_part,
                                .split_done = answer_split_done,
                                .position = answer_position,
                                .key = answer_key,
                                .number = answer_number,
                                .set_number = answer_set_number,
                                .values = answer_values,
                                .material = answer_material };
    enc_stream_init(&t->stream,
                    pmesh_allocator_resolve((pmesh_allocator){ 0 }));
    h->sizes.block_splits = h->sizes.block_faces = h->sizes.block_wedges = 0;
    return t;
}

static void discard(inventor *t)
{
    enc_stream_destroy(&t->stream);
    free(t->block);
    free(t);
}

/* The block's numbers are new: kinds of corners, and keys. */
static void renumber(inventor *t)
{
    const pmesh_codec *c = &t->codec;
    const pmesh_block *b = &c->block;
    uint8_t *copy = malloc(3 * (size_t)b->face_count + 1);
    memcpy(copy, t->kind + 3 * b->face, 3 * b->face_count);
    for (uint32_t i = 0; i < b->face_count; i++)
        memcpy(t->kind + 3 * (b->face + i), copy + 3 * c->face_order[i], 3);
    free(copy);
    memset(t->number, 0xff, sizeof t->number);
    for (uint32_t h = 0; h < 3 * c->mesh.face_count; h++)
        t->number[answer_key(t, h)] = c->mesh.wedge[h];
}

/* Degrees, and sums of neighbours, are those of all edges. */
static bool counts_hold(const pmesh_codec *c)
{
    const pmesh_mesh *m = &c->mesh;
    uint32_t(*sum)[4] = calloc(m->vertex_count, sizeof *sum);
    bool hold = true;
    for (uint32_t h = 0; h < 3 * m->face_count; h++) {
        const uint32_t end[2] = { m->vertex[h], m->vertex[pmesh_next(h)] };
        for (int i = 0; i < (m->twin[h] == PMESH_NONE ? 2 : 1); i++) {
            sum[end[i]][3]++;
            for (int k = 0; k < 3; k++)
                sum[end[i]][k] += (uint32_t)m->position[end[1 - i]][k];
        }
    }
    for (uint32_t v = 0; v < m->vertex_count; v++)
        hold &= sum[v][3] == c->near[v].degree &&
                memcmp(sum[v], c->near[v].sum, sizeof c->near[v].sum) == 0;
    free(sum);
    return hold;
}

static bool is_sound(const pmesh_codec *c)
{
    uint8_t *seen = malloc(3 * (size_t)c->mesh.face_count);
    const bool sound = pmesh_mesh_check(&c->mesh, seen) == NULL;
    free(seen);
    return sound && counts_hold(c);
}

static void finish_level(inventor *t)
{
    const pmesh_mesh *m = &t->codec.mesh;
    t->header.levels[t->header.level_count++] =
        (pmesh_level_entry){ .bytes = t->stream.size,
                             .faces = m->face_count,
                             .vertices = m->vertex_count,
                             .wedges = m->wedge_count };
}

static uint32_t moved_corners(const pmesh_codec *c)
{
    uint32_t count = 0;
    for (uint32_t h = 0; h < 3 * c->mesh.face_count; h++) {
        const uint32_t u = c->mesh.vertex[h];
        count += u >= c->block.vertex &&
                 h < 3 * c->child_face[u - c->block.vertex];
    }
    return count;
}

static void write_block(inventor *t, uint32_t splits, uint8_t *room, bool last)
{
    pmesh_codec_sizes *s = &t->header.sizes;
    const pmesh_block *b = &t->codec.block;
    pmesh_writer out = { room, 0, ROOM, false };
    pmesh_coder coder;
    pmesh_put_varint(&out, splits);
    pmesh_coder_encode(&coder, &out);
    CHECK(pmesh_block_code(&t->codec, &coder, &t->oracle, splits) == PMESH_OK);
    CHECK(pmesh_coder_finish(&coder));
    renumber(t);
    CHECK(is_sound(&t->codec));
    enc_stream_chunk(&t->stream,
                     last ? PMESH_CHUNK_BLOCK_LAST : PMESH_CHUNK_BLOCK, room,
                     (uint32_t)out.size);
    if (s->block_splits < splits)
        s->block_splits = splits;
    if (s->block_faces < b->face_count)
        s->block_faces = b->face_count;
    if (s->block_wedges < b->wedge_count)
        s->block_wedges = b->wedge_count;
    t->header.moved_corners += moved_corners(&t->codec);
}

static void write_file(inventor *t)
{
    uint8_t *room = malloc(ROOM);
    pmesh_writer out = { room, 0, ROOM, false };
    pmesh_coder coder;
    pmesh_coder_encode(&coder, &out);
    CHECK(pmesh_base_code(&t->codec, &coder, &t->oracle, POINTS,
                          t->base.face_count) == PMESH_OK);
    CHECK(pmesh_base_attributes_code(&t->codec, &coder, &t->oracle, WEDGES) ==
          PMESH_OK);
    CHECK(pmesh_coder_finish(&coder) && is_sound(&t->codec));
    enc_stream_chunk(&t->stream, PMESH_CHUNK_BASE, room, (uint32_t)out.size);
    finish_level(t);
    for (int level = 1; level < LEVELS; level++) {
        const uint32_t splits = t->codec.mesh.vertex_count / 6;
        pmesh_level_begin(&t->codec);
        write_block(t, splits, room, false);
        write_block(t, splits / 2 + 1, room, true);
        finish_level(t);
    }
    free(room);
}

static int append(void *user, const void *data, size_t size)
{
    shape_bytes *out = user;
    memcpy(out->data + out->size, data, size);
    out->size += size;
    return 0;
}

static shape_bytes take_file(inventor *t)
{
    shape_bytes out = { malloc(ROOM), 0, ROOM };
    uint64_t header_size, file_size;
    CHECK(enc_stream_write(&t->stream, &t->header, append, &out, &header_size,
                           &file_size) == PMESH_OK);
    return out;
}

/* ---- reading ------------------------------------------------------------- */

/* The view of the first n vertices names the nearest ancestors below n. */
static bool shows_ancestors(const inventor *t, pmesh_decoder *dec)
{
    const pmesh_mesh *m = &t->codec.mesh;
    pmesh_view view;
    if (pmesh_decoder_mesh(dec, &view) != PMESH_OK)
        return false;
    for (uint32_t h = 0; h < 3 * view.face_count; h++) {
        uint32_t v = m->vertex[h], w = m->wedge[h];
        for (; v >= view.mesh_vertex_count; v = m->parent[v])
            w = m->wedge_parent[w];
        if (view.indices[h] != w || view.positions_of[w] != v ||
            w >= view.vertex_count)
            return false;
    }
    return true;
}

static bool decodes(const inventor *t, const shape_bytes *file)
{
    const pmesh_mesh *m = &t->codec.mesh;
    pmesh_status status;
    pmesh_decoder *dec = shape_decode(file->data, file->size, 1000, &status);
    bool good = status == PMESH_OK;
    uint32_t faces = 1;
    while (good && faces < 2 * m->face_count) {
        const pmesh_target target = { .faces = faces };
        pmesh_decoder_refine(dec, &target, NULL);
        good = shows_ancestors(t, dec) && shape_view_sound(dec);
        faces += 1 + faces / 9;
    }
    pmesh_decoder_refine(dec, NULL, NULL);
    pmesh_view view;
    good = good && pmesh_decoder_mesh(dec, &view) == PMESH_OK &&
           view.face_count == m->face_count &&
           memcmp(view.positions, m->position,
                  m->vertex_count * sizeof *m->position) == 0 &&
           memcmp(view.indices, m->wedge,
                  3 * (size_t)m->face_count * sizeof *m->wedge) == 0;
    pmesh_decoder_destroy(dec);
    return good;
}

TEST(joined_streams_of_any_shape_decode_to_what_was_written)
{
    for (uint32_t seed = 1; seed <= 24; seed++) {
        inventor *t = invent(seed, (wedging)(seed % 3), seed % 2, seed % 5 > 1,
                             false);
        write_file(t);
        shape_bytes file = take_file(t);
        CHECK(decodes(t, &file));
        free(file.data);
        discard(t);
    }
}

/* Of all that a split can change, the most. */
TEST(a_vertex_parts_with_all_fans_and_lone_faces_there_can_be)
{
    for (uint32_t seed = 1; seed <= 6; seed++) {
        inventor *t = invent(seed, (wedging)(seed % 3), seed % 2, true, true);
        write_file(t);
        CHECK(t->header.sizes.block_faces >= 2 * PMESH_MAX_PARTS +
                                                 2 * PMESH_MAX_LONE);
        shape_bytes file = take_file(t);
        CHECK(decodes(t, &file));
        free(file.data);
        discard(t);
    }
}

/* Every byte of a chunk may be anything once its checksum is right: the
 * decoder's own rules must hold. */
TEST(damaged_joined_blocks_are_survived)
{
    for (uint32_t seed = 1; seed <= 60; seed++) {
        inventor *t = invent(seed % 6 + 1, (wedging)(seed % 3), seed % 2, true,
                             seed % 7 == 0);
        write_file(t);
        enc_stream *s = &t->stream;
        uint32_t at = 0;
        enc_stream damaged;
        enc_stream_init(&damaged, s->allocator);
        while (at < s->size) {
            pmesh_cursor in = pmesh_cursor_make(s->data + at, s->size - at);
            const uint8_t type = pmesh_get_u8(&in);
            const uint32_t size = pmesh_get_count(&in, PMESH_MAX_CHUNK_SIZE);
            uint8_t *payload = s->data + (in.next - s->data);
            for (uint32_t n = below(t, 3); n > 0; n--)
                payload[below(t, size)] ^= (uint8_t)(1u << below(t, 8));
            enc_stream_chunk(&damaged, type, payload, size);
            at = (uint32_t)(payload - s->data) + size + PMESH_CRC_SIZE;
        }
        enc_stream_destroy(s);
        *s = damaged;
        shape_bytes file = take_file(t);
        pmesh_status status;
        pmesh_decoder *dec = shape_decode(file.data, file.size, 999, &status);
        CHECK(dec && status != PMESH_E_CHECKSUM);
        pmesh_view view;
        if (pmesh_decoder_mesh(dec, &view) == PMESH_OK) {
            pmesh_decoder_refine(dec, NULL, NULL);
            CHECK(shape_view_sound(dec));
        }
        pmesh_decoder_destroy(dec);
        free(file.data);
        discard(t);
    }
}
