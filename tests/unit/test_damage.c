/* SPDX-License-Identifier: MIT */
/* Damage is noticed; and where checksums are forged, it does no harm. */
#include <stdlib.h>
#include <string.h>

#include "format/crc32c.h"
#include "format/cursor.h"
#include "format/header.h"
#include "format/layout.h"
#include "tests/unit/shapes.h"
#include "tests/unit/test.h"
#include "tools/draco_base.h"

static shape_bytes bake_base(shape_kind kind, uint32_t size,
                             pmesh_placement placement,
                             pmesh_base_coder coder)
{
    shape_mesh *s = shape_make(kind, size, 7);
    pmesh_encoder_config config = pmesh_encoder_config_default();
    pmesh_encode_report report;
    shape_bytes bytes;
    config.position_bits = 10;
    config.base_faces = 12;
    config.placement = placement;
    config.base_coder = coder;
    config.base_encoder = draco_base_encode;
    config.base_decoder = draco_base_decode;
    config.lossless = (kind ^ (unsigned)placement) & 1; /* half of them */
    const pmesh_status status = shape_bake(s, &config, &bytes, &report);
    shape_free(s);
    CHECK(status == PMESH_OK);
    return bytes;
}

static shape_bytes bake(shape_kind kind, uint32_t size,
                        pmesh_placement placement)
{
    return bake_base(kind, size, placement, PMESH_BASE_NATIVE);
}

TEST(every_flipped_bit_is_noticed)
{
    shape_bytes b = bake(SHAPE_SPHERE, 5, PMESH_SUBSET);
    for (size_t bit = 0; bit < 8 * b.size; bit++) {
        pmesh_status status;
        b.data[bit / 8] ^= (uint8_t)(1u << bit % 8);
        pmesh_decoder *dec = shape_decode(b.data, b.size, b.size, &status);
        CHECK(status != PMESH_OK);
        pmesh_decoder_refine(dec, NULL, NULL);
        pmesh_view v;
        CHECK(pmesh_decoder_mesh(dec, &v) != PMESH_OK ||
              shape_view_sound(dec));
        pmesh_decoder_destroy(dec);
        b.data[bit / 8] ^= (uint8_t)(1u << bit % 8);
    }
    free(b.data);
}

/* Makes every chunk's checksum right again, as far as framing holds. */
static void forge_checksums(uint8_t *data, size_t size)
{
    size_t at = PMESH_SIGNATURE_SIZE;
    uint32_t chain = 0;
    while (at < size) {
        pmesh_cursor in = pmesh_cursor_make(data + at, size - at);
        const bool chained = pmesh_chunk_is_chained(pmesh_get_u8(&in));
        const uint64_t payload = pmesh_get_varint(&in);
        const size_t start = (size_t)(in.next - (data + at));
        if (in.overrun || payload + PMESH_CRC_SIZE > size - at - start)
            return;
        const size_t body = start + (size_t)payload;
        const uint32_t crc = pmesh_crc32c(chained ? chain : 0, data + at, body);
        if (chained)
            chain = crc;
        for (size_t i = 0; i < PMESH_CRC_SIZE; i++)
            data[at + body + i] = (uint8_t)(crc >> (8 * i));
        at += body + PMESH_CRC_SIZE;
    }
}

/* What an engine calls, on buffers of exactly the size that is asked for. */
static void use_all(pmesh_decoder *dec)
{
    const double origin[3] = { 0, 0, 9 }, direction[3] = { 0.1, 0.1, -1 };
    const pmesh_target low = { .faces = 1 }, step = { .max_ops = 100 };
    double a[3], b[3];
    pmesh_changes changes;
    pmesh_header h;
    pmesh_hit hit;
    pmesh_decoder_header(dec, &h);
    pmesh_buffers out = { .indices = malloc(12 * (size_t)h.faces),
                          .positions = malloc(12 * (size_t)h.vertices) };
    for (uint32_t i = 0; i < h.attribute_count; i++)
        out.attributes[i] =
            malloc(4u * h.attributes[i].components * (size_t)h.vertices);
    pmesh_range *groups = malloc(h.material_count * sizeof *groups);
    CHECK(pmesh_decoder_bind(dec, &out) == PMESH_OK);
    pmesh_decoder_refine(dec, &low, &changes);
    while (pmesh_decoder_refine(dec, &step, &changes) == PMESH_MORE)
        ;
    CHECK(pmesh_decoder_copy_morph(dec, &low, out.positions, 0) == PMESH_OK);
    CHECK(pmesh_decoder_copy_indices(dec, out.indices, 0, groups) == PMESH_OK);
    CHECK(pmesh_decoder_bounds(dec, a, b) == PMESH_OK);
    pmesh_decoder_raycast(dec, origin, direction, &hit);
    pmesh_decoder_bind(dec, NULL);
    for (uint32_t i = 0; i < h.attribute_count; i++)
        free(out.attributes[i]);
    free(out.indices);
    free(out.positions);
    free(groups);
}

static void damage_and_decode(const shape_bytes *b, uint32_t *seed)
{
    uint8_t *copy = malloc(b->size);
    memcpy(copy, b->data, b->size);
    for (uint32_t n = 1 + shape_random(seed, 3); n > 0; n--) {
        const size_t at = PMESH_SIGNATURE_SIZE +
                          shape_random(seed, (uint32_t)b->size - 8);
        copy[at] = (uint8_t)shape_random(seed, 256);
    }
    forge_checksums(copy, b->size);
    pmesh_status status;
    pmesh_decoder_config config = pmesh_decoder_config_default();
    pmesh_decoder *dec;
    config.max_memory = (uint64_t)64 << 20;
    config.base_decoder = draco_base_decode;
    CHECK(pmesh_decoder_create(&dec, &config) == PMESH_OK);
    status = pmesh_decoder_feed(dec, copy, b->size);
    (void)status; /* a valid stream of another mesh is a possible outcome */
    pmesh_view v;
    pmesh_changes changes;
    if (pmesh_decoder_refine(dec, NULL, &changes) == PMESH_OK) {
        CHECK(shape_view_sound(dec));
        const pmesh_target target = { .faces = 1 };
        pmesh_decoder_refine(dec, &target, &changes);
        CHECK(pmesh_decoder_mesh(dec, &v) == PMESH_OK);
        CHECK(shape_view_sound(dec));
        float *xyz = malloc(12 * (size_t)v.vertex_count);
        CHECK(pmesh_decoder_copy_positions(dec, xyz, 0) == PMESH_OK);
        free(xyz);
        use_all(dec);
    }
    pmesh_decoder_destroy(dec);
    free(copy);
}

TEST(damage_behind_forged_checksums_does_no_harm)
{
    for (int kind = 0; kind < SHAPE_COUNT; kind++)
        for (int placement = 0; placement < 2; placement++) {
            shape_bytes b = bake((shape_kind)kind,
                                 kind == SHAPE_SOUP ? 30 : 6,
                                 (pmesh_placement)placement);
            uint32_t seed = 11 + (uint32_t)kind;
            for (int i = 0; i < 400; i++)
                damage_and_decode(&b, &seed);
            free(b.data);
        }
}

/* Half of the damage hits the Draco buffer. */
TEST(damage_to_a_draco_base_does_no_harm)
{
    for (int kind = 0; kind < SHAPE_COUNT; kind++) {
        shape_bytes b = bake_base((shape_kind)kind,
                                  kind == SHAPE_SOUP ? 30 : 6, PMESH_SUBSET,
                                  PMESH_BASE_DRACO);
        uint32_t seed = 31 + (uint32_t)kind;
        for (int i = 0; i < 400; i++)
            damage_and_decode(&b, &seed);
        free(b.data);
    }
}

/* Where the payload of the first chunk of that type begins. */
static size_t payload_of(const shape_bytes *b, uint8_t type)
{
    size_t at = PMESH_SIGNATURE_SIZE;
    for (;;) {
        pmesh_cursor in = pmesh_cursor_make(b->data + at, b->size - at);
        const uint8_t found = pmesh_get_u8(&in);
        const size_t size = (size_t)pmesh_get_varint(&in);
        CHECK(!in.overrun);
        at = (size_t)(in.next - b->data);
        if (found == type)
            return at;
        at += size + PMESH_CRC_SIZE;
    }
}

TEST(a_draco_buffer_larger_than_its_chunk_is_refused)
{
    static const uint8_t sizes[][2] = { { 0xff, 0x7f }, { 0x80, 0x00 } };
    for (int i = 0; i < 2; i++) {
        shape_bytes b = bake_base(SHAPE_TORUS, 12, PMESH_SUBSET,
                                  PMESH_BASE_DRACO);
        memcpy(b.data + payload_of(&b, PMESH_CHUNK_BASE), sizes[i], 2);
        forge_checksums(b.data, b.size);
        pmesh_decoder_config config = pmesh_decoder_config_default();
        pmesh_decoder *dec;
        config.base_decoder = draco_base_decode;
        CHECK(pmesh_decoder_create(&dec, &config) == PMESH_OK);
        CHECK(pmesh_decoder_feed(dec, b.data, b.size) == PMESH_E_CORRUPT);
        CHECK(strstr(pmesh_decoder_error(dec).rule, "larger than its chunk"));
        pmesh_decoder_destroy(dec);
        free(b.data);
    }
}

enum { CHUNKS = 64 };

/* Where chunks start, and the last ends; returns their number. */
static uint32_t list_chunks(const shape_bytes *b, size_t *at, uint32_t room)
{
    uint32_t n = 0;
    at[0] = PMESH_SIGNATURE_SIZE;
    while (at[n] < b->size && n + 1 < room) {
        pmesh_cursor in = pmesh_cursor_make(b->data + at[n], b->size - at[n]);
        pmesh_get_u8(&in);
        const size_t size = (size_t)pmesh_get_varint(&in) + PMESH_CRC_SIZE;
        at[n + 1] = (size_t)(in.next - b->data) + size;
        n++;
    }
    return n;
}

typedef enum misplacing { MISSING, REPEATED, SWAPPED, MISPLACINGS } misplacing;

/* The file with that done to chunk i of n; SWAPPED with the next. To free. */
static shape_bytes misplace(const shape_bytes *b, const size_t *at, uint32_t n,
                            uint32_t i, misplacing kind)
{
    shape_bytes out = { .data = malloc(2 * b->size), .size = at[0] };
    uint32_t order[2 * CHUNKS], count = 0;
    for (uint32_t k = 0; k < n; k++) {
        if (k != i || kind != MISSING)
            order[count++] = k;
        if (k == i && kind == REPEATED)
            order[count++] = k;
    }
    if (kind == SWAPPED) {
        order[i] = i + 1;
        order[i + 1] = i;
    }
    memcpy(out.data, b->data, at[0]);
    for (uint32_t k = 0; k < count; k++) {
        const size_t from = at[order[k]], size = at[order[k] + 1] - from;
        memcpy(out.data + out.size, b->data + from, size);
        out.size += size;
    }
    return out;
}

/* Refused behind the first `good` bytes, with what these show. */
static void check_refused(const shape_bytes *bad, const shape_bytes *b,
                          size_t good)
{
    pmesh_status status, before;
    pmesh_view v = { 0 }, w = { 0 };
    pmesh_decoder *dec = shape_decode(bad->data, bad->size, bad->size, &status);
    pmesh_decoder *cut = shape_decode(b->data, good, good, &before);

    CHECK(status < 0 && before == PMESH_NEED_DATA);
    CHECK(pmesh_decoder_error(dec).offset == good);
    pmesh_decoder_refine(dec, NULL, NULL);
    pmesh_decoder_refine(cut, NULL, NULL);
    pmesh_decoder_mesh(dec, &v);
    pmesh_decoder_mesh(cut, &w);
    CHECK(v.face_count == w.face_count);
    CHECK(v.face_count == 0 || shape_view_hash(dec) == shape_view_hash(cut));
    pmesh_decoder_destroy(cut);
    pmesh_decoder_destroy(dec);
}

/* A chunk that is missing, repeated, or swapped with the next one is noticed
 * where it stands, before it can change what is shown. */
TEST(chunks_out_of_place_are_noticed_at_once)
{
    size_t at[CHUNKS];
    shape_bytes b = bake(SHAPE_SPHERE, 12, PMESH_SUBSET);
    const uint32_t n = list_chunks(&b, at, CHUNKS);
    CHECK(n > 8 && n < CHUNKS - 1);
    for (int kind = 0; kind < MISPLACINGS; kind++)
        for (uint32_t i = 1; i + 1 < n; i++) {
            shape_bytes bad = misplace(&b, at, n, i, (misplacing)kind);
            check_refused(&bad, &b, at[kind == REPEATED ? i + 1 : i]);
            free(bad.data);
        }
    free(b.data);
}

TEST(bytes_behind_the_end_are_ignored)
{
    shape_bytes b = bake(SHAPE_TORUS, 6, PMESH_SUBSET);
    pmesh_decoder *dec;
    CHECK(pmesh_decoder_create(&dec, NULL) == PMESH_OK);
    CHECK(pmesh_decoder_feed(dec, b.data, b.size) == PMESH_OK);
    CHECK(pmesh_decoder_feed(dec, "trailing", 8) == PMESH_OK);
    pmesh_decoder_destroy(dec);
    free(b.data);
}

TEST(unknown_chunks_are_skipped_or_refused)
{
    static const uint8_t types[] = { 0x85, 0x45 };
    for (int i = 0; i < 2; i++) {
        shape_bytes b = bake(SHAPE_TORUS, 6, PMESH_SUBSET);
        pmesh_cursor in = pmesh_cursor_make(b.data + 9, b.size - 9);
        const size_t header_size = (size_t)pmesh_get_varint(&in);
        const size_t header_end =
            (size_t)(in.next - b.data) + header_size + PMESH_CRC_SIZE;
        uint8_t *copy = malloc(b.size + 9);
        const uint8_t chunk[9] = { types[i], 3, 'a', 'b', 'c' };
        memcpy(copy, b.data, header_end);
        memcpy(copy + header_end, chunk, sizeof chunk);
        memcpy(copy + header_end + 9, b.data + header_end,
               b.size - header_end);
        forge_checksums(copy, b.size + 9);
        pmesh_status status;
        pmesh_decoder *dec = shape_decode(copy, b.size + 9, 64, &status);
        CHECK(status == (i == 0 ? PMESH_OK : PMESH_E_VERSION));
        pmesh_decoder_destroy(dec);
        free(copy);
        free(b.data);
    }
}

TEST(other_files_are_refused_at_the_first_byte)
{
    pmesh_status status;
    pmesh_decoder *dec =
        shape_decode((const uint8_t *)"ply\nformat", 10, 1, &status);
    CHECK(status == PMESH_E_MAGIC);
    CHECK(pmesh_decoder_error(dec).status == PMESH_E_MAGIC);
    pmesh_decoder_destroy(dec);
}
