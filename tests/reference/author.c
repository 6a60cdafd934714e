/* SPDX-License-Identifier: MIT */
#include "tests/reference/author.h"

#include <stdlib.h>
#include <string.h>

#include "tests/golden/golden_mesh.h"
#include "tests/reference/chunks.h"
#include "tests/reference/random_mesh.h"
#include "tests/reference/ref.h"

enum { MOST = 1 << 20 };

/* ---- the header (5.3), as the decoder has it ---------------------------- */

static void put(shape_bytes *out, uint64_t value, int bytes)
{
    for (int i = 0; i < bytes; i++) {
        const uint8_t byte = (uint8_t)(value >> (8 * i));
        bytes_put(out, &byte, 1);
    }
}

static void put_varint(shape_bytes *out, uint64_t value)
{
    for (; value >= 128; value /= 128)
        put(out, value % 128 + 128, 1);
    put(out, value, 1);
}

static void put_f32(shape_bytes *out, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    put(out, bits, 4);
}

static void put_f64(shape_bytes *out, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    put(out, bits, 8);
}

static void put_frame(shape_bytes *out, const ref_header *h)
{
    put(out, 0, 1); /* version */
    put(out, 0, 8); /* content_hash, mended later */
    put(out,
        (uint64_t)h->profile + (h->moving ? 4 : 0) + (h->joined ? 32 : 0), 1);
    put(out, (uint64_t)h->position_bits, 1);
    for (int i = 0; i < 3; i++)
        put_f64(out, h->origin[i]);
    put_f64(out, h->step);
    for (int i = 0; i < 3; i++)
        put_varint(out, (uint64_t)h->bounds[i]);
    put_varint(out, h->material_count);
    put_varint(out, h->chunk_size);
    put_varint(out, h->block_splits);
    put_varint(out, h->block_wedges);
    put_varint(out, h->moved_corners);
    put_varint(out, 0); /* no names */
    if (h->joined) {
        put_varint(out, h->base_fans);
        put_varint(out, h->block_faces);
    }
}

static void put_attributes(shape_bytes *out, const ref_header *h)
{
    put(out, (uint64_t)h->attribute_count, 1);
    for (int i = 0; i < h->attribute_count; i++) {
        const ref_attribute *a = &h->attribute[i];
        put(out, (uint64_t)a->kind, 1);
        put(out, (uint64_t)a->set, 1);
        put(out, (uint64_t)a->components, 1);
        put(out, (uint64_t)a->bits, 1);
        for (int k = 0; a->kind != 0 && k < a->components; k++) {
            put_f32(out, a->minimum[k]);
            put_f32(out, a->scale[k]);
        }
    }
}

static shape_bytes write_header(const ref_header *h)
{
    static const ref_level none;
    shape_bytes out = { 0 };
    put_frame(&out, h);
    put_attributes(&out, h);
    put(&out, (uint64_t)h->level_count, 1);
    for (int i = 0; i < h->level_count; i++) {
        const ref_level *l = &h->level[i], *was = i > 0 ? l - 1 : &none;
        put_varint(&out, 1);
        put_varint(&out, l->faces - was->faces);
        put_varint(&out, l->vertices - was->vertices);
        if (h->attribute_count > 0)
            put_varint(&out, l->wedges - was->wedges);
        put_f32(&out, 0);
        put(&out, 0, 1);
    }
    return out;
}

/* ---- a decoder that writes ---------------------------------------------- */

typedef struct writer {
    ref *r;
    ref_author author;
    chunks c;
    uint32_t seed;
    uint32_t ring, rank; /* of the wide split */
} writer;

static void add_chunk(writer *w, int type, const shape_bytes *data)
{
    w->c.at[w->c.count++] = chunk_make((uint8_t)type, data->data, data->size);
}

/* The base of a whole file, decoded, and its chunk; limits off. */
static bool start(writer *w, const shape_bytes *file)
{
    chunks c;
    chunks_take_apart(file, &c);
    size_t size = 8;
    w->c.count = 0;
    w->c.at[w->c.count++] = chunk_make(CHUNK_HEADER, NULL, 0);
    for (uint32_t i = 0; i < c.count; i++) {
        const chunk *one = &c.at[i];
        if (w->c.count < 2)
            size += chunk_framed_size(one);
        if (one->type == CHUNK_BASE)
            w->c.at[w->c.count++] =
                chunk_make(CHUNK_BASE, one->data, one->size);
        free(one->data);
    }
    w->r = ref_decode(file->data, size);
    ref_header *h = &w->r->header;
    h->block_splits = h->block_wedges = h->moved_corners = h->block_faces =
        MOST;
    h->level_count = 1;
    h->lossless = h->draco = h->measured = false;
    w->r->in.author = &w->author;
    w->author.user = w;
    return w->r->has_base;
}

/* What the table says of a level: what there is, or what there would be. */
static void count_level(ref *r, ref_level *level, uint64_t splits, bool good)
{
    const ref_level *was = level - 1;
    level->vertices = was->vertices + splits;
    level->faces = good ? r->face_count
                        : was->faces + (r->header.joined ? 64 : 2) * splits;
    level->wedges = good ? r->wedge_count
                         : was->wedges +
                               (r->header.joined ? 200 : 40) * splits;
    if (r->header.attribute_count == 0)
        level->wedges = level->vertices;
}

/* A level of one block; false if it breaks a rule on the way. */
static bool write_level(writer *w, uint8_t splits)
{
    ref *r = w->r;
    ref_level *level = &r->header.level[r->header.level_count++];
    shape_bytes payload = { 0 };
    volatile bool good = false;
    *level = (ref_level){ .vertices = MOST, .faces = MOST, .wedges = MOST };
    w->author.size = 0;
    w->author.low = 0;
    if (!setjmp(r->stop)) {
        ref_read_block(r, &splits, 1, false);
        good = true;
    }
    r->levels++;
    r->in_level = false;
    ref_author_end(&w->author);
    count_level(r, level, splits, good);
    bytes_put(&payload, &splits, 1);
    bytes_put(&payload, w->author.data, w->author.size);
    add_chunk(w, CHUNK_LAST, &payload);
    free(payload.data);
    return good;
}

/* Limits become what the levels reach. */
static shape_bytes finish(writer *w)
{
    static const shape_bytes nothing;
    ref_header *h = &w->r->header;
    const ref_level *last = &h->level[h->level_count - 1];
    const uint64_t splits = last->vertices - h->level[0].vertices;
    h->block_splits = splits;
    h->block_wedges = last->wedges - h->level[0].wedges;
    h->block_faces = h->joined ? last->faces - h->level[0].faces : 0;
    h->moved_corners = 48 * splits + h->block_faces;
    h->chunk_size = 1 << 20;
    add_chunk(w, CHUNK_END, &nothing);
    shape_bytes header = write_header(h);
    free(w->c.at[0].data);
    w->c.at[0] = chunk_make(CHUNK_HEADER, header.data, header.size);
    free(header.data);
    free(w->author.data);
    ref_free(w->r);
    return chunks_put_together(&w->c);
}

/* ---- random levels ------------------------------------------------------ */

static bool within(const void *m, const void *part, size_t size)
{
    const char *at = m, *from = part;
    return at >= from && at < from + size;
}

/* As the model expects, or not; positions seldom far off. */
static int choose_any(void *user, const ref_model *m, int given)
{
    writer *w = user;
    (void)given;
    const ref *r = w->r;
    if (!m)
        return (int)shape_random(&w->seed, 2);
    const uint32_t p = (uint32_t)m->p / 64;
    const int expected = shape_random(&w->seed, 65536) >= p;
    if (within(m, r->flag, sizeof r->flag))
        return shape_random(&w->seed, 3) > 0;
    if (within(m, &r->cut, sizeof r->cut))
        return shape_random(&w->seed, 16) > 0;
    if (within(m, &r->join.lone, sizeof r->join.lone))
        return shape_random(&w->seed, 4) == 0;
    if (within(m, &r->join, sizeof r->join))
        return (int)shape_random(&w->seed, 2);
    if (within(m, r->residual, sizeof r->residual))
        return shape_random(&w->seed, 50) ? 0 : expected;
    if (within(m, r->channel_models, sizeof r->channel_models))
        return shape_random(&w->seed, 8) == 0;
    if (within(m, &r->wedge_models.pick, sizeof r->wedge_models.pick))
        return shape_random(&w->seed, 5) == 0;
    return shape_random(&w->seed, 4) ? expected
                                     : (int)shape_random(&w->seed, 2);
}

bool author_random_file(uint32_t seed, shape_bytes *out)
{
    shape_bytes file;
    writer w = { .author = { .choose = choose_any }, .seed = seed };
    *out = (shape_bytes){ 0 };
    const bool baked = random_file(seed, &file) == PMESH_OK;
    if (baked && start(&w, &file)) {
        uint32_t levels = 1 + shape_random(&w.seed, 3);
        while (levels > 0 &&
               write_level(&w, (uint8_t)(1 + shape_random(&w.seed, 6))))
            levels--;
        *out = finish(&w);
    }
    free(file.data);
    return out->size > 0;
}

/* ---- a wide split ------------------------------------------------------- */

static shape_bytes bake_spindle(uint32_t ring, bool textured)
{
    golden_mesh mesh;
    shape_bytes out;
    pmesh_encode_report report;
    pmesh_encoder_config config = pmesh_encoder_config_default();
    golden_mesh_make(&mesh, GOLDEN_SPINDLE, ring);
    float *uv = calloc(2 * mesh.input.vertex_count, sizeof *uv);
    for (size_t i = 0; i < 2 * mesh.input.vertex_count; i++)
        uv[i] = (float)mesh.input.positions[3 * (i / 2) + i % 2];
    const pmesh_attribute_input channel = { .kind = PMESH_TEXCOORD,
                                            .components = 2,
                                            .values = uv,
                                            .count = mesh.input.vertex_count };
    mesh.shape->input.attributes = &channel;
    mesh.shape->input.attribute_count = textured;
    config.base_faces = (uint32_t)mesh.input.face_count;
    shape_bake(mesh.shape, &config, &out, &report);
    free(uv);
    golden_mesh_free(&mesh);
    return out;
}

/* Splits the wide vertex alone; all else as expected. */
static int choose_wide(void *user, const ref_model *m, int given)
{
    writer *w = user;
    (void)given;
    const ref *r = w->r;
    if (within(m, r->flag, sizeof r->flag))
        return ref_degree(r, r->order[r->order_at - 1]) == w->ring;
    if (!within(m, r->cut.rank, sizeof r->cut.rank) || w->rank == 0)
        return 0;
    w->rank--;
    return 1;
}

uint32_t author_wide_split(uint32_t ring, bool textured, uint32_t rank,
                           shape_bytes *out)
{
    shape_bytes file = bake_spindle(ring, textured);
    writer w = { .author = { .choose = choose_wide },
                 .ring = ring,
                 .rank = rank };
    uint32_t degree = 0;
    *out = (shape_bytes){ 0 };
    if (start(&w, &file)) {
        if (write_level(&w, 1) && w.rank == 0)
            degree = ref_degree(w.r, w.r->vertex_count - 1);
        *out = finish(&w);
    }
    free(file.data);
    return degree;
}
