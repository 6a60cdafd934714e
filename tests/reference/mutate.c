/* SPDX-License-Identifier: MIT */
#include "tests/reference/mutate.h"

#include <stdlib.h>
#include <string.h>

#include "tests/reference/ref.h"

enum { CHUNKS = 512, SIGNATURE = 8, HEADER = 1, END = 5, HASH_AT = 1 };

typedef struct chunk {
    uint8_t type, *data; /* data has room for twice the size and some more */
    size_t size;
} chunk;

typedef struct chunks {
    chunk at[CHUNKS];
    uint32_t count;
} chunks;

static void put(shape_bytes *out, const void *data, size_t size)
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

static chunk chunk_make(uint8_t type, const uint8_t *data, size_t size)
{
    chunk c = { type, calloc(2 * size + 64, 1), size };
    if (size)
        memcpy(c.data, data, size);
    return c;
}

static void take_apart(const shape_bytes *file, chunks *out)
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

static uint32_t put_chunk(shape_bytes *out, const chunk *c)
{
    const size_t start = out->size;
    size_t left = c->size;
    put(out, &c->type, 1);
    do {
        const uint8_t byte = (uint8_t)(left % 128 + (left >= 128 ? 128 : 0));
        put(out, &byte, 1);
        left /= 128;
    } while (left > 0);
    put(out, c->data, c->size);
    const uint32_t crc = ref_crc32c(out->data + start, out->size - start);
    for (int i = 0; i < 4; i++) {
        const uint8_t byte = (uint8_t)(crc >> (8 * i));
        put(out, &byte, 1);
    }
    return crc;
}

/* Twice: the first time tells the checksums that the header's hash is of. */
static shape_bytes put_together(const shape_bytes *file, chunks *c)
{
    shape_bytes out = { 0 };
    for (int pass = 0; pass < 2; pass++) {
        uint64_t hash = 0xcbf29ce484222325u;
        out.size = 0;
        put(&out, file->data, SIGNATURE);
        for (uint32_t i = 0; i < c->count; i++) {
            const uint32_t crc = put_chunk(&out, &c->at[i]);
            if (c->at[i].type != HEADER && c->at[i].type != END &&
                c->at[i].type < 128)
                hash = ref_hash_crc(hash, crc);
        }
        chunk *header = &c->at[0];
        for (size_t i = 0; i < 8 && c->count > 0 && header->type == HEADER &&
                           HASH_AT + i < header->size;
             i++)
            header->data[HASH_AT + i] = (uint8_t)(hash >> (8 * i));
    }
    return out;
}

/* ---- damage ------------------------------------------------------------- */

static void change_byte(chunk *c, uint32_t *seed)
{
    if (c->size == 0)
        return;
    uint8_t *byte = &c->data[shape_random(seed, (uint32_t)c->size)];
    switch (shape_random(seed, 4)) {
    case 0: *byte ^= (uint8_t)(1u << shape_random(seed, 8)); break;
    case 1: *byte = (uint8_t)(*byte + 1); break;
    case 2: *byte = (uint8_t)(*byte - 1); break;
    default: *byte = (uint8_t)shape_random(seed, 256); break;
    }
}

/* Makes the payload one byte longer or a few shorter. */
static void resize(chunk *c, uint32_t *seed)
{
    if (shape_random(seed, 2) && c->size > 0)
        c->size -= shape_random(seed, c->size < 5 ? (uint32_t)c->size : 5);
    else
        c->data[c->size++] = (uint8_t)(shape_random(seed, 3) ? 0 : 77);
}

static void insert(chunks *c, uint32_t at, chunk one)
{
    memmove(c->at + at + 1, c->at + at, (c->count - at) * sizeof *c->at);
    c->at[at] = one;
    c->count++;
}

static void drop(chunks *c, uint32_t at)
{
    free(c->at[at].data);
    c->count--;
    memmove(c->at + at, c->at + at + 1, (c->count - at) * sizeof *c->at);
}

static void change_order(chunks *c, uint32_t *seed)
{
    const uint32_t a = shape_random(seed, c->count);
    const uint32_t b = shape_random(seed, c->count);
    const chunk keep = c->at[a];
    switch (shape_random(seed, 4)) {
    case 0: drop(c, a); break;
    case 1: insert(c, b, chunk_make(keep.type, keep.data, keep.size)); break;
    case 2:
        c->at[a] = c->at[b];
        c->at[b] = keep;
        break;
    default: c->at[a].type = (uint8_t)(1 + shape_random(seed, 8)); break;
    }
}

static void change_chunks(chunks *c, uint32_t *seed)
{
    static const uint8_t odd[] = { 0, 8, 127, 128, 200, 255 };
    const uint32_t at = shape_random(seed, c->count);
    const uint32_t way = shape_random(seed, 20);
    if (way < 8)
        change_byte(&c->at[at], seed);
    else if (way < 11) /* a content, if there is one */
        change_byte(&c->at[at > 0 ? at : c->count / 2], seed);
    else if (way < 14)
        change_byte(&c->at[0], seed);
    else if (way < 17)
        resize(&c->at[at], seed);
    else if (way < 19)
        change_order(c, seed);
    else
        insert(c, at,
               chunk_make(odd[shape_random(seed, 6)], (const uint8_t *)"abc",
                          shape_random(seed, 4)));
}

static shape_bytes mutate_bytes(const shape_bytes *file, uint32_t *seed)
{
    shape_bytes out = { 0 };
    chunk all = { 0, NULL, file->size };
    put(&out, file->data, file->size);
    all.data = out.data;
    if (shape_random(seed, 4))
        change_byte(&all, seed);
    else
        out.size = shape_random(seed, (uint32_t)file->size + 1);
    return out;
}

shape_bytes mutate(const shape_bytes *file, bool mend, uint32_t seed)
{
    chunks c;
    if (!mend)
        return mutate_bytes(file, &seed);
    take_apart(file, &c);
    for (uint32_t n = 1 + shape_random(&seed, 2); n > 0 && c.count > 0; n--)
        change_chunks(&c, &seed);
    const shape_bytes out = put_together(file, &c);
    for (uint32_t i = 0; i < c.count; i++)
        free(c.at[i].data);
    return out;
}
