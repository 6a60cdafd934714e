/* SPDX-License-Identifier: MIT */
/*
 * dec_stream.c - cuts the stream into chunks (SPEC 5.1, 5.2), whatever the
 * pieces it arrives in.
 */
#include <string.h>

#include "decoder/dec_internal.h"
#include "format/crc32c.h"

enum { MAX_START = 1 + 5 }; /* type and a varint below 2^35 */

pmesh_status dec_fail(pmesh_decoder *dec, pmesh_status status,
                      const char *rule)
{
    dec->error = (pmesh_decode_error){ status, dec->chunk_offset, rule };
    return status;
}

static pmesh_status take_signature(pmesh_decoder *dec)
{
    if (dec->start_size < PMESH_SIGNATURE_SIZE)
        return PMESH_OK;
    dec->start_size = 0;
    dec->stage = DEC_CHUNK_START;
    dec->chunk_offset = dec->offset;
    return PMESH_OK;
}

/* One byte of type and size. */
static pmesh_status take_start(pmesh_decoder *dec)
{
    const uint8_t last = dec->start[dec->start_size - 1];
    if (dec->start_size == 1 || last >= 0x80) {
        return dec->start_size < MAX_START
                   ? PMESH_OK
                   : dec_fail(dec, PMESH_E_CORRUPT,
                              "SPEC 5.2: a chunk's size is out of range");
    }
    pmesh_cursor in = pmesh_cursor_make(dec->start, dec->start_size);
    dec->type = pmesh_get_u8(&in);
    const uint32_t size = pmesh_get_count(&in, PMESH_MAX_CHUNK_SIZE);
    if (in.overrun)
        return dec_fail(dec, PMESH_E_CORRUPT,
                        "SPEC 5.2: a chunk's size is out of range");
    dec->crc = pmesh_crc32c(0, dec->start, dec->start_size);
    dec->start_size = 0;
    dec->size = size;
    dec->received = 0;
    dec->stage = DEC_CHUNK_BODY;
    return dec_chunk_begin(dec);
}

static pmesh_status finish_chunk(pmesh_decoder *dec)
{
    pmesh_cursor in = pmesh_cursor_make(dec->tail, sizeof dec->tail);
    if (pmesh_get_u32(&in) != dec->crc)
        return dec_fail(dec, PMESH_E_CHECKSUM,
                        "SPEC 5.2: a chunk's checksum does not match");
    if (!dec->skipping && dec->type != PMESH_CHUNK_HEADER &&
        dec->type != PMESH_CHUNK_END)
        dec->hash = pmesh_hash_crc(dec->hash, dec->crc);
    if (!dec->skipping) {
        const pmesh_status status = dec_chunk_finish(dec);
        if (status != PMESH_OK)
            return status;
    }
    dec->whole = dec->offset;
    dec->chunk_offset = dec->offset;
    dec->stage =
        dec->type == PMESH_CHUNK_END ? DEC_END : DEC_CHUNK_START;
    return PMESH_OK;
}

/* Payload first, then the checksum; returns the bytes used. */
static size_t take_body(pmesh_decoder *dec, const uint8_t *data, size_t size)
{
    if (dec->received < dec->size) {
        const uint32_t left = dec->size - dec->received;
        const uint32_t part = size < left ? (uint32_t)size : left;
        uint8_t *to =
            dec->type == PMESH_CHUNK_HEADER ? dec->small : dec->payload;
        if (!dec->skipping)
            memcpy(to + dec->received, data, part);
        dec->crc = pmesh_crc32c(dec->crc, data, part);
        dec->received += part;
        return part;
    }
    dec->tail[dec->received - dec->size] = *data;
    dec->received++;
    return 1;
}

static pmesh_status step(pmesh_decoder *dec, const uint8_t **data,
                         size_t *size)
{
    size_t used = 1;
    if (dec->stage == DEC_CHUNK_BODY) {
        used = take_body(dec, *data, *size);
    } else {
        dec->start[dec->start_size++] = **data;
        if (dec->stage == DEC_SIGNATURE &&
            **data != (uint8_t)PMESH_SIGNATURE[dec->start_size - 1])
            return dec_fail(dec, PMESH_E_MAGIC,
                            "SPEC 5.1: the signature is missing");
    }
    *data += used;
    *size -= used;
    dec->offset += used;
    if (dec->stage == DEC_SIGNATURE)
        return take_signature(dec);
    if (dec->stage == DEC_CHUNK_START)
        return take_start(dec);
    if (dec->received == dec->size + PMESH_CRC_SIZE)
        return finish_chunk(dec);
    return PMESH_OK;
}

pmesh_status pmesh_decoder_feed(pmesh_decoder *dec, const void *data,
                                size_t size)
{
    const uint8_t *next = (const uint8_t *)data;
    if (!dec || (!data && size > 0))
        return PMESH_E_ARGUMENT;
    while (dec->error.status >= 0 && dec->stage != DEC_END && size > 0)
        step(dec, &next, &size);
    if (dec->error.status < 0)
        return dec->error.status;
    return dec->stage == DEC_END ? PMESH_OK : PMESH_NEED_DATA;
}
