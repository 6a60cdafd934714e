/* SPDX-License-Identifier: MIT */
/* SPEC 5.1, 5.2 and what the payloads start and end with: chunks that are
 * damaged, out of place, or one byte too long. */
#include "tests/corrupt/corrupt.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/reference/ref.h"

enum { HEADER = 1, BASE = 2, BLOCK = 3, LAST = 4, END = 5, NAMES = 6,
       POSITIONS = 7, SCENE_HEADER = 8 };

#define UNUSED "SPEC 6.1: bytes behind "
#define TOO_EARLY "SPEC 5.2: the end comes too early"
#define PLACE "SPEC 5.2: a positions chunk out of place"
#define SIZE "SPEC 5.2: a chunk's size is out of range"
#define COUNT "SPEC 6.3: a block's count is out of range"
#define POSITION_COUNT "SPEC 6.8: a count of positions is out of range"
#define DRACO_SIZE "SPEC 6.2: a Draco buffer larger than its chunk"

/* ---- chunks that come, or do not ---------------------------------------- */

typedef enum deed {
    DROP,   /* the chunk */
    COPY,   /* it, behind `to` */
    MOVE,   /* it, behind `to` */
    RETYPE, /* it becomes a chunk of type `to` */
    ADD,    /* an empty chunk of type `type`, behind `to` */
    ADD_3   /* the same with three bytes */
} deed;

typedef struct order_case {
    const char *name;
    base_file base;
    deed deed;
    uint8_t type, to, blamed; /* types; of `to` and `blamed` the last one */
    pmesh_status status;
    const char *rule;
} order_case;

static const order_case orders[] = {
    { "header-missing", PLAIN, DROP, HEADER, 0, BASE, PMESH_E_CORRUPT,
      "SPEC 5.2: the first chunk is not the header" },
    { "header-twice", PLAIN, COPY, HEADER, HEADER, HEADER, PMESH_E_CORRUPT,
      "SPEC 5.2: a second header" },
    { "header-again-at-the-end", PLAIN, COPY, HEADER, LAST, HEADER,
      PMESH_E_CORRUPT, "SPEC 5.2: a second header" },
    { "header-behind-the-base", PLAIN, MOVE, HEADER, BASE, BASE,
      PMESH_E_CORRUPT, "SPEC 5.2: the first chunk is not the header" },
    { "names-twice", FULL, COPY, NAMES, NAMES, NAMES, PMESH_E_CORRUPT,
      "SPEC 5.2: a names chunk out of place" },
    { "names-behind-the-base", FULL, MOVE, NAMES, BASE, NAMES,
      PMESH_E_CORRUPT, "SPEC 5.2: a names chunk out of place" },
    { "names-that-are-not-declared", PLAIN, ADD_3, NAMES, HEADER, NAMES,
      PMESH_E_CORRUPT, "SPEC 5.2: a names chunk out of place" },
    { "base-missing", PLAIN, DROP, BASE, 0, LAST, PMESH_E_CORRUPT,
      "SPEC 5.2: a chunk before the base mesh" },
    { "base-twice", PLAIN, COPY, BASE, BASE, BASE, PMESH_E_CORRUPT,
      "SPEC 5.2: a second base mesh" },
    { "base-again-at-the-end", PLAIN, COPY, BASE, LAST, BASE, PMESH_E_CORRUPT,
      "SPEC 5.2: a second base mesh" },
    { "block-before-the-base", PLAIN, ADD_3, BLOCK, HEADER, BLOCK,
      PMESH_E_CORRUPT, "SPEC 5.2: a chunk before the base mesh" },
    { "positions-before-the-base", FULL, ADD_3, POSITIONS, HEADER, POSITIONS,
      PMESH_E_CORRUPT, "SPEC 5.2: a chunk before the base mesh" },
    { "end-before-the-base", PLAIN, ADD, END, HEADER, END, PMESH_E_CORRUPT,
      "SPEC 5.2: a chunk before the base mesh" },
    { "block-behind-all-levels", PLAIN, ADD_3, BLOCK, LAST, BLOCK,
      PMESH_E_CORRUPT, "SPEC 5.2: more levels than the header declares" },
    { "last-block-behind-all-levels", PLAIN, COPY, LAST, LAST, LAST,
      PMESH_E_CORRUPT, "SPEC 5.2: more levels than the header declares" },
    { "block-behind-positions", FULL, COPY, LAST, POSITIONS, LAST,
      PMESH_E_CORRUPT, "SPEC 5.2: more levels than the header declares" },
    { "positions-not-lossless", PLAIN, ADD_3, POSITIONS, LAST, POSITIONS,
      PMESH_E_CORRUPT, PLACE },
    { "positions-before-the-levels", FULL, MOVE, POSITIONS, BASE, POSITIONS,
      PMESH_E_CORRUPT, PLACE },
    { "positions-again", FULL, COPY, POSITIONS, POSITIONS, POSITIONS,
      PMESH_E_CORRUPT, PLACE },
    { "end-without-positions", FULL, DROP, POSITIONS, 0, END, PMESH_E_CORRUPT,
      TOO_EARLY },
    { "end-before-the-levels", PLAIN, COPY, END, BASE, END, PMESH_E_CORRUPT,
      TOO_EARLY },
    { "end-before-the-last-level", PLAIN, RETYPE, LAST, BLOCK, END,
      PMESH_E_CORRUPT, TOO_EARLY },
    { "end-not-empty", PLAIN, ADD_3, END, LAST, END, PMESH_E_CORRUPT,
      TOO_EARLY },
    { "unknown-type-0", PLAIN, ADD, 0, HEADER, 0, PMESH_E_VERSION,
      "SPEC 5.2: an unknown critical chunk" },
    { "unknown-type-10", PLAIN, ADD_3, 10, BASE, 10, PMESH_E_VERSION,
      "SPEC 5.2: an unknown critical chunk" },
    { "unknown-type-127", PLAIN, ADD_3, 127, LAST, 127, PMESH_E_VERSION,
      "SPEC 5.2: an unknown critical chunk" },
    { "scene-chunk-in-a-mesh", PLAIN, ADD_3, 8, BASE, 8, PMESH_E_VERSION,
      "SPEC 5.2: an unknown critical chunk" },
    { "part-chunk-in-a-mesh", PLAIN, ADD_3, 9, BASE, 9, PMESH_E_VERSION,
      "SPEC 5.2: an unknown critical chunk" },
    { "skippable-before-the-header", PLAIN, MOVE, HEADER, BASE, BASE,
      PMESH_E_CORRUPT, "SPEC 5.2: the first chunk is not the header" }
};

/* Returns the chunk that was added or moved, or NULL. */
static chunk *do_deed(chunks *c, const order_case *o)
{
    const bool adds = o->deed == ADD || o->deed == ADD_3;
    chunk *one = adds ? NULL : find_chunk(c, o->type, 0);
    if (o->deed == RETYPE)
        find_chunk(c, o->type, -1)->type = o->to;
    if (o->deed == DROP)
        drop_chunk(c, one);
    if (o->deed == RETYPE || o->deed == DROP)
        return NULL;
    const chunk copy = adds ? chunk_make(o->type, (const uint8_t *)"abc",
                                         o->deed == ADD_3 ? 3 : 0)
                            : chunk_make(o->type, one->data, one->size);
    chunk *added = find_chunk(c, o->to, -1) + 1;
    insert_chunk(c, (uint32_t)(added - c->at), copy);
    if (o->deed != MOVE)
        return added;
    const bool later = one >= added; /* the insertion moved it */
    drop_chunk(c, later ? one + 1 : one);
    return later ? added : added - 1;
}

static void break_order(const order_case *o)
{
    chunks c = take_base_file(o->base);
    const chunk *added = do_deed(&c, o);
    const size_t offset = chunk_offset(
        &c, added && added->type == o->blamed ? added
                                              : find_chunk(&c, o->blamed, 0));
    judge(o->name, chunks_put_together(&c),
          (verdict){ o->status, offset, o->rule });
}

/* ---- frames ------------------------------------------------------------- */

static shape_bytes copy_of(base_file base)
{
    shape_bytes out = { 0 };
    const shape_bytes *from = base_bytes(base);
    bytes_put(&out, from->data, from->size);
    return out;
}

static void break_signature(void)
{
    for (size_t i = 0; i < 8; i++) {
        char name[32];
        shape_bytes file = copy_of(PLAIN);
        snprintf(name, sizeof name, "signature-byte-%u", (unsigned)i);
        file.data[i] ^= 0x20;
        judge(name, file,
              (verdict){ PMESH_E_MAGIC, 0,
                         "SPEC 5.1: the signature is missing" });
    }
}

static void break_checksums(void)
{
    static const struct {
        const char *name;
        base_file base;
        uint8_t type;
    } of[] = { { "crc-of-header", PLAIN, HEADER }, { "crc-of-names", FULL, NAMES },
               { "crc-of-base", PLAIN, BASE },     { "crc-of-block", PLAIN, LAST },
               { "crc-of-positions", FULL, POSITIONS },
               { "crc-of-end", PLAIN, END } };
    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        chunks c = take_base_file(of[i].base);
        const chunk *at = find_chunk(&c, of[i].type, 0);
        const size_t offset = chunk_offset(&c, at);
        const size_t last = offset + chunk_framed_size(at) - 1;
        shape_bytes file = chunks_put_together(&c);
        file.data[last] ^= 0x80;
        judge(of[i].name, file,
              (verdict){ PMESH_E_CHECKSUM, offset,
                         "SPEC 5.2: a chunk's checksum does not match" });
    }
}

/* Type and size of the base chunk, as bytes. */
static void break_sizes(void)
{
    static const struct {
        const char *name;
        uint8_t bytes[12];
        size_t size;
    } starts[] = {
        { "size-above-2-28", { BASE, 0x81, 0x80, 0x80, 0x80, 0x01 }, 6 },
        { "size-of-6-bytes", { BASE, 0x81, 0x81, 0x81, 0x81, 0x81, 0x01 }, 7 },
        { "size-largest", { BASE, 0xff, 0xff, 0xff, 0xff, 0x7f }, 6 },
        { "size-ends-in-0", { BASE, 0x90, 0x00 }, 3 },
        { "size-0-in-two-bytes", { BASE, 0x80, 0x00 }, 3 }
    };
    for (size_t i = 0; i < sizeof starts / sizeof *starts; i++) {
        chunks c = take_base_file(PLAIN);
        const size_t offset = chunk_offset(&c, find_chunk(&c, BASE, 0));
        shape_bytes file = chunks_put_together(&c);
        memcpy(file.data + offset, starts[i].bytes, starts[i].size);
        judge(starts[i].name, file,
              (verdict){ PMESH_E_CORRUPT, offset, SIZE });
    }
}

/* The header is right, but for the hash of what follows. */
static void break_hash(void)
{
    chunks c = take_base_file(PLAIN);
    const size_t end = chunk_offset(&c, find_chunk(&c, END, 0));
    const size_t size = chunk_framed_size(&c.at[0]) - 4;
    shape_bytes file = chunks_put_together(&c);
    file.data[8 + 2 + 1] ^= 1; /* type, size, version */
    const uint32_t crc = ref_crc32c(0, file.data + 8, size);
    for (size_t i = 0; i < 4; i++)
        file.data[8 + size + i] = (uint8_t)(crc >> (8 * i));
    judge("content-hash", file,
          (verdict){ PMESH_E_CORRUPT, end,
                     "SPEC 5.3: the content hash does not match" });
}

/* ---- the first and the last bytes of payloads --------------------------- */

typedef struct payload_case {
    const char *name;
    base_file base;
    uint8_t type;
    uint8_t bytes[12];
    size_t size;
    bool at_end; /* these are added; else they replace the first */
    const char *rule;
} payload_case;

static const payload_case payloads[] = {
    /* As many as a decoder reads ahead, and more. */
    { "base-with-zeros-more", PLAIN, BASE, { 0 }, 12, true,
      UNUSED "the base mesh" },
    { "base-with-bytes-more", FULL, BASE, { 1, 2, 3 }, 12, true,
      UNUSED "the base mesh" },
    { "block-with-zeros-more", PLAIN, LAST, { 0 }, 12, true, UNUSED "a block" },
    { "block-with-bytes-more", MOVING, LAST, { 9, 9, 9, 9, 9, 9 }, 12, true,
      UNUSED "a block" },
    { "positions-with-zeros-more", FULL, POSITIONS, { 0 }, 12, true,
      UNUSED "positions" },
    { "positions-with-bytes-more", COARSE, POSITIONS, { 7, 7, 7, 7, 7, 7 }, 12, true,
      UNUSED "positions" },
    { "draco-base-with-zeros-more", DRACO, BASE, { 0 }, 12, true,
      UNUSED "the base mesh" },
    { "block-of-0-splits", PLAIN, LAST, { 0 }, 1, false, COUNT },
    { "block-of-32769-splits", PLAIN, LAST, { 0x81, 0x80, 0x02 }, 3, false,
      COUNT },
    { "block-of-splits-ends-in-0", PLAIN, LAST, { 0x81, 0 }, 2, false, COUNT },
    { "block-of-too-many-splits", PLAIN, LAST, { 0x7f }, 1, false,
      "SPEC 6.3: a block larger than the header declares" },
    { "positions-of-0", FULL, POSITIONS, { 0 }, 1, false, POSITION_COUNT },
    { "positions-of-too-many", FULL, POSITIONS, { 0xff, 0x7f }, 2, false,
      POSITION_COUNT },
    { "draco-size-too-large", DRACO, BASE, { 0xff, 0x7f }, 2, false,
      DRACO_SIZE },
    { "draco-size-ends-in-0", DRACO, BASE, { 0x80, 0 }, 2, false, DRACO_SIZE },
    { "draco-size-0", DRACO, BASE, { 0 }, 1, false,
      "SPEC 6.2: the Draco buffer does not hold the base mesh" }
};

/* A decoder reads ahead, and zeros at the end are left out: so a few bytes more
 * may be read, but not as many as these. */
static void break_payload(const payload_case *p)
{
    chunks c = take_base_file(p->base);
    field_set(&c.at[0], "chunk_size", 4096);
    chunk *one = find_chunk(&c, p->type, 0);
    const size_t offset = chunk_offset(&c, one);
    memcpy(p->at_end ? one->data + one->size : one->data, p->bytes, p->size);
    if (p->at_end)
        one->size += p->size;
    judge(p->name, chunks_put_together(&c),
          (verdict){ PMESH_E_CORRUPT, offset, p->rule });
}

static void empty_payloads(void)
{
    static const struct {
        const char *name;
        base_file base;
        uint8_t type;
        const char *rule;
    } of[] = { { "block-empty", PLAIN, LAST, COUNT },
               { "positions-empty", FULL, POSITIONS, POSITION_COUNT },
               { "draco-base-empty", DRACO, BASE, DRACO_SIZE } };
    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        chunks c = take_base_file(of[i].base);
        chunk *one = find_chunk(&c, of[i].type, 0);
        const size_t offset = chunk_offset(&c, one);
        one->size = 0;
        judge(of[i].name, chunks_put_together(&c),
              (verdict){ PMESH_E_CORRUPT, offset, of[i].rule });
    }
}

/* A byte of the Draco buffer: of its magic, version, kind, method. */
static void break_draco(void)
{
    for (size_t at = 0; at < 9; at++) {
        char name[32];
        chunks c = take_base_file(DRACO);
        chunk *one = find_chunk(&c, BASE, 0);
        const size_t offset = chunk_offset(&c, one);
        snprintf(name, sizeof name, "draco-byte-%u", (unsigned)at);
        one->data[2 + at] ^= 0xff; /* behind the size */
        judge(name, chunks_put_together(&c),
              (verdict){ PMESH_E_CORRUPT, offset,
                         "SPEC 6.2: the Draco buffer does not hold the base "
                         "mesh" });
    }
}

void stream_cases(void)
{
    break_signature();
    break_checksums();
    break_sizes();
    break_hash();
    for (size_t i = 0; i < sizeof orders / sizeof *orders; i++)
        break_order(&orders[i]);
    for (size_t i = 0; i < sizeof payloads / sizeof *payloads; i++)
        break_payload(&payloads[i]);
    empty_payloads();
    break_draco();
}
