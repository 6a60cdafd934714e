/* SPDX-License-Identifier: MIT */
/*
 * dec_scene_stream.c - cuts a scene file into chunks (SPEC 5.1, 5.2), whatever
 * the pieces it arrives in.
 */
#include <string.h>

#include "decoder/dec_scene.h"
#include "format/crc32c.h"
#include "format/header.h"

enum { MAX_START = 1 + 5 }; /* type and a varint below 2^35 */

pmesh_status pmesh_scene_probe(const void *data, size_t size)
{
    const uint8_t *bytes = (const uint8_t *)data;
    const size_t n = size < PMESH_SIGNATURE_SIZE ? size : PMESH_SIGNATURE_SIZE;

    if (n > 0 && memcmp(bytes, PMESH_SIGNATURE, n) != 0)
        return PMESH_E_MAGIC;
    if (size <= PMESH_SIGNATURE_SIZE)
        return PMESH_NEED_DATA;
    return bytes[PMESH_SIGNATURE_SIZE] == PMESH_CHUNK_SCENE
               ? PMESH_OK
               : PMESH_E_UNSUPPORTED;
}

pmesh_status dec_scene_fail(pmesh_scene *s, pmesh_status status,
                            const char *rule)
{
    s->error = (pmesh_decode_error){ status, s->chunk_offset, rule };
    return status;
}

static pmesh_status take_signature(pmesh_scene *s)
{
    if (s->start_size < PMESH_SIGNATURE_SIZE)
        return PMESH_OK;
    s->start_size = 0;
    s->stage = DEC_SCENE_START;
    s->chunk_offset = s->offset;
    return PMESH_OK;
}

/* One byte of type and size. */
static pmesh_status take_start(pmesh_scene *s)
{
    const uint8_t last = s->start[s->start_size - 1];
    if (s->start_size == 1 || last >= 0x80) {
        return s->start_size < MAX_START
                   ? PMESH_OK
                   : dec_scene_fail(s, PMESH_E_CORRUPT,
                                    "SPEC 5.2: a chunk's size is out of range");
    }
    pmesh_cursor in = pmesh_cursor_make(s->start, s->start_size);
    s->type = pmesh_get_u8(&in);
    s->size = pmesh_get_count(&in, PMESH_MAX_CHUNK_SIZE);
    if (in.overrun)
        return dec_scene_fail(s, PMESH_E_CORRUPT,
                              "SPEC 5.2: a chunk's size is out of range");
    s->crc = pmesh_crc32c(0, s->start, s->start_size);
    s->start_size = 0;
    s->received = 0;
    s->stage = DEC_SCENE_BODY;
    return dec_scene_begin(s);
}

static pmesh_status finish_chunk(pmesh_scene *s)
{
    pmesh_cursor in = pmesh_cursor_make(s->tail, sizeof s->tail);
    if (pmesh_get_u32(&in) != s->crc)
        return dec_scene_fail(s, PMESH_E_CHECKSUM,
                              "SPEC 5.2: a chunk's checksum does not match");
    if (s->type == PMESH_CHUNK_PART)
        s->hash = pmesh_hash_crc(s->hash, s->crc);
    if (!s->skipping) {
        const pmesh_status status = dec_scene_finish(s);
        if (status != PMESH_OK)
            return status;
    }
    s->whole = s->chunk_offset = s->offset;
    s->stage = s->type == PMESH_CHUNK_END ? DEC_SCENE_END : DEC_SCENE_START;
    return PMESH_OK;
}

/* Payload first, then the checksum; returns the bytes used. */
static size_t take_body(pmesh_scene *s, const uint8_t *data, size_t size)
{
    if (s->received < s->size) {
        const uint32_t left = s->size - s->received;
        const uint32_t part = size < left ? (uint32_t)size : left;
        uint8_t *to = s->type == PMESH_CHUNK_SCENE ? s->header : s->payload;
        if (!s->skipping)
            memcpy(to + s->received, data, part);
        s->crc = pmesh_crc32c(s->crc, data, part);
        s->received += part;
        return part;
    }
    s->tail[s->received - s->size] = *data;
    s->received++;
    return 1;
}

static pmesh_status step(pmesh_scene *s, const uint8_t **data, size_t *size)
{
    size_t used = 1;
    if (s->stage == DEC_SCENE_BODY) {
        used = take_body(s, *data, *size);
    } else {
        s->start[s->start_size++] = **data;
        if (s->stage == DEC_SCENE_SIGNATURE &&
            **data != (uint8_t)PMESH_SIGNATURE[s->start_size - 1])
            return dec_scene_fail(s, PMESH_E_MAGIC,
                                  "SPEC 5.1: the signature is missing");
    }
    *data += used;
    *size -= used;
    s->offset += used;
    if (s->stage == DEC_SCENE_SIGNATURE)
        return take_signature(s);
    if (s->stage == DEC_SCENE_START)
        return take_start(s);
    if (s->received == s->size + PMESH_CRC_SIZE)
        return finish_chunk(s);
    return PMESH_OK;
}

pmesh_status pmesh_scene_feed(pmesh_scene *s, const void *data, size_t size)
{
    const uint8_t *next = (const uint8_t *)data;
    if (!s || (!data && size > 0))
        return PMESH_E_ARGUMENT;
    while (s->error.status >= 0 && s->stage != DEC_SCENE_END && size > 0)
        step(s, &next, &size);
    if (s->error.status < 0)
        return s->error.status;
    return s->stage == DEC_SCENE_END ? PMESH_OK : PMESH_NEED_DATA;
}
