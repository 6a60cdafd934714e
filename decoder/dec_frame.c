/* SPDX-License-Identifier: MIT */
#include "decoder/dec_frame.h"

#include <string.h>

#include "format/crc32c.h"
#include "format/cursor.h"
#include "format/header.h"

enum { MAX_START = 1 + 5 }; /* type and a varint below 2^35 */

void dec_frame_start(dec_frame *f)
{
    *f = (dec_frame){ .error = { PMESH_OK, 0, "" }, .hash = PMESH_HASH_START };
}

pmesh_status dec_frame_fail(dec_frame *f, pmesh_status status,
                            const char *rule)
{
    f->error = (pmesh_decode_error){ status, f->chunk_offset, rule };
    return status;
}

static pmesh_status take_signature(dec_frame *f)
{
    if (f->start_size < PMESH_SIGNATURE_SIZE)
        return PMESH_OK;
    f->start_size = 0;
    f->stage = DEC_CHUNK_START;
    f->chunk_offset = f->offset;
    return PMESH_OK;
}

/* One byte of type and size. */
static pmesh_status take_start(dec_frame *f, const dec_frame_owner *owner)
{
    const uint8_t last = f->start[f->start_size - 1];
    const bool open = f->start_size == 1 || last >= 0x80;
    if (open && f->start_size < MAX_START)
        return PMESH_OK;

    pmesh_cursor in = pmesh_cursor_make(f->start, f->start_size);
    f->type = pmesh_get_u8(&in);
    const uint32_t size = pmesh_get_count(&in, PMESH_MAX_CHUNK_SIZE);
    if (open || in.overrun)
        return dec_frame_fail(f, PMESH_E_CORRUPT,
                              "SPEC 5.2: a chunk's size is out of range");
    const bool chained = pmesh_chunk_is_chained(f->type);
    f->crc = pmesh_crc32c(chained ? f->chain : 0, f->start, f->start_size);
    f->start_size = 0;
    f->size = size;
    f->received = 0;
    f->to = NULL;
    f->stage = DEC_CHUNK_BODY;
    return owner->begin(owner->self);
}

static pmesh_status finish_chunk(dec_frame *f, const dec_frame_owner *owner)
{
    pmesh_cursor in = pmesh_cursor_make(f->tail, sizeof f->tail);
    if (pmesh_get_u32(&in) != f->crc)
        return dec_frame_fail(f, PMESH_E_CHECKSUM,
                              "SPEC 5.2: a chunk's checksum does not match");
    if (pmesh_chunk_is_chained(f->type) && f->type != PMESH_CHUNK_END) {
        f->hash = pmesh_hash_crc(f->hash, f->crc);
        f->chain = f->crc;
    }
    if (f->type < PMESH_CHUNK_SKIPPABLE) {
        const pmesh_status status = owner->finish(owner->self);
        if (status != PMESH_OK)
            return status;
    }
    f->whole = f->chunk_offset = f->offset;
    f->stage = f->type == PMESH_CHUNK_END ? DEC_END : DEC_CHUNK_START;
    return PMESH_OK;
}

/* Payload first, then the checksum; returns the bytes used. */
static size_t take_body(dec_frame *f, const uint8_t *data, size_t size)
{
    if (f->received < f->size) {
        const uint32_t left = f->size - f->received;
        const uint32_t part = size < left ? (uint32_t)size : left;
        if (f->to)
            memcpy(f->to + f->received, data, part);
        f->crc = pmesh_crc32c(f->crc, data, part);
        f->received += part;
        return part;
    }
    f->tail[f->received - f->size] = *data;
    f->received++;
    return 1;
}

static pmesh_status step(dec_frame *f, const dec_frame_owner *owner,
                         const uint8_t **data, size_t *size)
{
    size_t used = 1;
    if (f->stage == DEC_CHUNK_BODY) {
        used = take_body(f, *data, *size);
    } else {
        f->start[f->start_size++] = **data;
        if (f->stage == DEC_SIGNATURE &&
            **data != (uint8_t)PMESH_SIGNATURE[f->start_size - 1])
            return dec_frame_fail(f, PMESH_E_MAGIC,
                                  "SPEC 5.1: the signature is missing");
    }
    *data += used;
    *size -= used;
    f->offset += used;
    if (f->stage == DEC_SIGNATURE)
        return take_signature(f);
    if (f->stage == DEC_CHUNK_START)
        return take_start(f, owner);
    if (f->received == f->size + PMESH_CRC_SIZE)
        return finish_chunk(f, owner);
    return PMESH_OK;
}

pmesh_status dec_frame_feed(dec_frame *f, const dec_frame_owner *owner,
                            const void *data, size_t size)
{
    const uint8_t *next = (const uint8_t *)data;

    while (f->error.status >= 0 && f->stage != DEC_END && size > 0)
        step(f, owner, &next, &size);
    if (f->error.status < 0)
        return f->error.status;
    return f->stage == DEC_END ? PMESH_OK : PMESH_NEED_DATA;
}
