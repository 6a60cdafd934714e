/* SPDX-License-Identifier: MIT */
#include "encoder/enc_stream.h"

#include <string.h>

#include "format/alloc.h"
#include "format/crc32c.h"

enum { MAX_START = 6 }; /* type and size of a chunk */

void enc_stream_init(enc_stream *s, pmesh_allocator allocator)
{
    *s = (enc_stream){ .allocator = allocator, .hash = PMESH_HASH_START };
}

void enc_stream_destroy(enc_stream *s)
{
    pmesh_release(&s->allocator, s->data, s->capacity, 1);
    s->data = NULL;
}

static bool reserve(enc_stream *s, size_t more)
{
    if (s->capacity - s->size >= more)
        return true;
    size_t capacity = s->capacity ? 2 * s->capacity : 65536;
    while (capacity - s->size < more)
        capacity *= 2;
    uint8_t *data = pmesh_alloc(&s->allocator, capacity, 1);
    if (!data) {
        s->failed = true;
        return false;
    }
    if (s->size)
        memcpy(data, s->data, s->size);
    pmesh_release(&s->allocator, s->data, s->capacity, 1);
    s->data = data;
    s->capacity = capacity;
    return true;
}

/* Type and size; returns the CRC that goes on with the whole chunk. */
static uint32_t frame(pmesh_writer *start, uint32_t crc, uint8_t type,
                      const uint8_t *payload, uint32_t size)
{
    pmesh_put(start, type, 1);
    pmesh_put_varint(start, size);
    return pmesh_crc32c(pmesh_crc32c(crc, start->data, start->size), payload,
                        size);
}

void enc_stream_chunk(enc_stream *s, uint8_t type, const uint8_t *payload,
                      uint32_t size)
{
    if (s->failed || !reserve(s, (size_t)size + MAX_START + PMESH_CRC_SIZE))
        return;
    pmesh_writer out = { s->data + s->size, 0, MAX_START, false };
    s->crc = frame(&out, s->crc, type, payload, size);
    s->size += out.size;
    if (size)
        memcpy(s->data + s->size, payload, size);
    s->size += size;
    out = (pmesh_writer){ s->data + s->size, 0, PMESH_CRC_SIZE, false };
    pmesh_put(&out, s->crc, PMESH_CRC_SIZE);
    s->size += PMESH_CRC_SIZE;

    if (type != PMESH_CHUNK_END)
        s->hash = pmesh_hash_crc(s->hash, s->crc);
    if (size > s->largest && type != PMESH_CHUNK_NAMES)
        s->largest = size;
}

pmesh_status enc_stream_write(enc_stream *s, pmesh_header_chunk *header,
                              pmesh_write write, void *user,
                              uint64_t *header_size, uint64_t *file_size)
{
    enc_stream_chunk(s, PMESH_CHUNK_END, NULL, 0);
    if (s->failed)
        return PMESH_E_MEMORY;
    header->chunk_size = s->largest;
    header->content_hash = s->hash;

    uint8_t payload[PMESH_MAX_HEADER_SIZE];
    uint8_t head[PMESH_SIGNATURE_SIZE + MAX_START];
    uint8_t tail[PMESH_CRC_SIZE];
    pmesh_writer body = { payload, 0, sizeof payload, false };
    pmesh_header_write(&body, header);
    if (body.overflow)
        return PMESH_E_LIMIT;

    memcpy(head, PMESH_SIGNATURE, PMESH_SIGNATURE_SIZE);
    pmesh_writer start = { head + PMESH_SIGNATURE_SIZE, 0, MAX_START, false };
    const uint32_t crc =
        frame(&start, 0, PMESH_CHUNK_HEADER, payload, (uint32_t)body.size);
    pmesh_writer end = { tail, 0, sizeof tail, false };
    pmesh_put(&end, crc, PMESH_CRC_SIZE);

    *header_size =
        PMESH_SIGNATURE_SIZE + start.size + body.size + sizeof tail;
    *file_size = *header_size + s->size;
    if (write(user, head, PMESH_SIGNATURE_SIZE + start.size) ||
        write(user, payload, body.size) || write(user, tail, sizeof tail) ||
        write(user, s->data, s->size))
        return PMESH_E_WRITE;
    return PMESH_OK;
}
