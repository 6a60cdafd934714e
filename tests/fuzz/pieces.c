/* SPDX-License-Identifier: MIT */
#include "tests/fuzz/pieces.h"

#include <string.h>

#include "format/crc32c.h"
#include "format/cursor.h"
#include "format/header.h"
#include "format/layout.h"

enum { HASH_AT = 1, HASH_SIZE = 8 }; /* in both kinds of header */

/* The checksum of a chunk, given by its bytes before it; `chain` is that of the
 * last that goes on. */
static uint32_t checksum(uint32_t *chain, uint8_t type, const uint8_t *data,
                         size_t size)
{
    const bool chained = pmesh_chunk_is_chained(type);
    const uint32_t crc = pmesh_crc32c(chained ? *chain : 0, data, size);
    if (chained)
        *chain = crc;
    return crc;
}

/* The next chunk; false if there is no whole one. */
static bool take(pmesh_cursor *in, uint32_t *chain, piece *out, bool *fit)
{
    const uint8_t *start = in->next;
    out->type = pmesh_get_u8(in);
    const uint64_t size = pmesh_get_varint(in);
    const size_t left = (size_t)(in->end - in->next);
    if (in->overrun || left < PMESH_CRC_SIZE || size > left - PMESH_CRC_SIZE)
        return false;
    out->data = in->next;
    out->size = (size_t)size;
    in->next += size;
    *fit &= checksum(chain, out->type, start, (size_t)(in->next - start)) ==
            pmesh_get_u32(in);
    out->frame = start;
    out->frame_size = (size_t)(in->next - start);
    return true;
}

bool pieces_take_apart(const uint8_t *data, size_t size, pieces *out)
{
    out->count = 0;
    out->fit = true;
    if (size < PMESH_SIGNATURE_SIZE ||
        memcmp(data, PMESH_SIGNATURE, PMESH_SIGNATURE_SIZE) != 0)
        return false;
    pmesh_cursor in = pmesh_cursor_make(data, size);
    in.next += PMESH_SIGNATURE_SIZE;
    bool more = true;
    uint32_t chain = 0;
    while (more && out->count < PIECES) {
        const uint8_t *start = in.next;
        more = take(&in, &chain, &out->at[out->count], &out->fit);
        if (!more)
            in.next = start;
        else
            more = out->at[out->count++].type != PMESH_CHUNK_END;
    }
    out->rest = (piece){ .data = in.next,
                         .size = (size_t)(in.end - in.next) };
    return true;
}

static void put_bytes(pmesh_writer *out, const uint8_t *data, size_t size)
{
    if (size > out->capacity - out->size) {
        out->overflow = true;
        return;
    }
    if (size > 0)
        memcpy(out->data + out->size, data, size);
    out->size += size;
}

static void put(pmesh_writer *out, uint32_t *chain, const piece *p,
                uint64_t hash)
{
    const size_t start = out->size;
    pmesh_put(out, p->type, 1);
    pmesh_put_varint(out, p->size);
    const size_t body = out->size;
    put_bytes(out, p->data, p->size);
    if (hash && p->size >= HASH_AT + HASH_SIZE && !out->overflow)
        for (unsigned i = 0; i < HASH_SIZE; i++)
            out->data[body + HASH_AT + i] = (uint8_t)(hash >> 8 * i);
    pmesh_put(out, checksum(chain, p->type, out->data + start,
                            out->size - start), PMESH_CRC_SIZE);
}

static bool is_header(uint8_t type)
{
    return type == PMESH_CHUNK_HEADER || type == PMESH_CHUNK_SCENE;
}

uint64_t pieces_hash(const pieces *p)
{
    uint64_t hash = PMESH_HASH_START;
    uint32_t chain = 0;
    for (uint32_t i = 0; i < p->count; i++) {
        const piece *c = &p->at[i];
        uint8_t start[16];
        pmesh_writer w = { start, 0, sizeof start, false };
        pmesh_put(&w, c->type, 1);
        pmesh_put_varint(&w, c->size);
        if (!pmesh_chunk_is_chained(c->type) || c->type == PMESH_CHUNK_END)
            continue;
        chain = pmesh_crc32c(pmesh_crc32c(chain, start, w.size), c->data,
                             c->size);
        hash = pmesh_hash_crc(hash, chain);
    }
    return hash;
}

uint64_t pieces_hash_stored(const pieces *p)
{
    if (p->count == 0 || p->at[0].size < HASH_AT + HASH_SIZE)
        return 0;
    pmesh_cursor in = pmesh_cursor_make(p->at[0].data + HASH_AT, HASH_SIZE);
    return pmesh_get(&in, HASH_SIZE);
}

size_t pieces_put_together(const pieces *p, bool mend, uint8_t *out,
                           size_t capacity)
{
    const uint64_t hash = mend ? pieces_hash(p) : 0;
    pmesh_writer w = { out, 0, capacity, false };
    uint32_t chain = 0;
    put_bytes(&w, (const uint8_t *)PMESH_SIGNATURE, PMESH_SIGNATURE_SIZE);
    for (uint32_t i = 0; i < p->count; i++)
        put(&w, &chain, &p->at[i], is_header(p->at[i].type) ? hash : 0);
    put_bytes(&w, p->rest.data, p->rest.size);
    return w.overflow ? 0 : w.size;
}
