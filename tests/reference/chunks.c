/* SPDX-License-Identifier: MIT */
#include "tests/reference/chunks.h"

#include <stdlib.h>
#include <string.h>

#include "tests/reference/ref.h"

enum { SIGNATURE = 8, HASH_AT = 1 };

void bytes_put(shape_bytes *out, const void *data, size_t size)
{
    if (out->capacity - out->size < size) {
        out->capacity = 2 * (out->size + size) + 64;
        out->data = realloc(out->data, out->capacity);
    }
    if (size)
        memcpy(out->data + out->size, data, size);
    out->size += size;
}

/* ---- a file as chunks, and back ----------------------------------------- */

chunk chunk_make(uint8_t type, const uint8_t *data, size_t size)
{
    chunk c = { type, calloc(2 * size + 64, 1), size };
    if (size)
        memcpy(c.data, data, size);
    return c;
}

size_t chunk_framed_size(const chunk *c)
{
    size_t bytes = 1 + c->size + 4;
    for (size_t left = c->size; left >= 128; left /= 128)
        bytes++;
    return bytes + 1;
}

void chunks_take_apart(const shape_bytes *file, chunks *out)
{
    out->count = 0;
    for (size_t at = SIGNATURE; at < file->size && out->count < CHUNKS - 2;) {
        const uint8_t type = file->data[at++];
        size_t size = 0;
        int shift = 0;
        for (; file->data[at] >= 128; shift += 7)
            size |= (size_t)(file->data[at++] & 127) << shift;
        size |= (size_t)file->data[at++] << shift;
        out->at[out->count++] = chunk_make(type, file->data + at, size);
        at += size + 4;
    }
}

static uint32_t put_chunk(shape_bytes *out, uint32_t before, const chunk *c)
{
    const size_t start = out->size;
    size_t left = c->size;
    bytes_put(out, &c->type, 1);
    do {
        const uint8_t byte = (uint8_t)(left % 128 + (left >= 128 ? 128 : 0));
        bytes_put(out, &byte, 1);
        left /= 128;
    } while (left > 0);
    bytes_put(out, c->data, c->size);
    const uint32_t crc =
        ref_crc32c(before, out->data + start, out->size - start);
    for (int i = 0; i < 4; i++) {
        const uint8_t byte = (uint8_t)(crc >> (8 * i));
        bytes_put(out, &byte, 1);
    }
    return crc;
}

static bool is_header(const chunk *c)
{
    return c->type == CHUNK_HEADER || c->type == CHUNK_SCENE;
}

/* Twice: the first time tells the checksums that the header's hash is of. */
shape_bytes chunks_put_together(chunks *c)
{
    static const uint8_t signature[SIGNATURE] = { 0x89, 0x50, 0x4d, 0x53,
                                                  0x48, 0x0d, 0x0a, 0x1a };
    shape_bytes out = { 0 };
    for (int pass = 0; pass < 2; pass++) {
        uint64_t hash = 0xcbf29ce484222325u;
        uint32_t before = 0;
        out.size = 0;
        bytes_put(&out, signature, SIGNATURE);
        for (uint32_t i = 0; i < c->count; i++) {
            const bool goes_on = !is_header(&c->at[i]) && c->at[i].type < 128;
            const uint32_t crc =
                put_chunk(&out, goes_on ? before : 0, &c->at[i]);
            if (goes_on && c->at[i].type != CHUNK_END)
                hash = ref_hash_crc(hash, before = crc);
        }
        chunk *header = &c->at[0];
        const bool has_hash = c->count > 0 && is_header(header);
        for (size_t i = 0; has_hash && i < 8 && HASH_AT + i < header->size; i++)
            header->data[HASH_AT + i] = (uint8_t)(hash >> (8 * i));
    }
    for (uint32_t i = 0; i < c->count; i++)
        free(c->at[i].data);
    return out;
}
