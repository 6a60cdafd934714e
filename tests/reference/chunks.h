/* SPDX-License-Identifier: MIT */
/*
 * chunks.h - a file as the list of its chunks, and back.
 */
#ifndef CHUNKS_H
#define CHUNKS_H

#include "tests/unit/shapes.h"

enum {
    CHUNKS = 512,
    CHUNK_HEADER = 1,
    CHUNK_BASE = 2,
    CHUNK_LAST = 4, /* a block */
    CHUNK_END = 5,
    CHUNK_POSITIONS = 7,
    CHUNK_SCENE = 8
};

typedef struct chunk {
    uint8_t type, *data; /* data has room for twice the size and some more */
    size_t size;
} chunk;

typedef struct chunks {
    chunk at[CHUNKS];
    uint32_t count;
} chunks;

chunk chunk_make(uint8_t type, const uint8_t *data, size_t size);
size_t chunk_framed_size(const chunk *c); /* with type, size and checksum */
void bytes_put(shape_bytes *out, const void *data, size_t size);

/* Of a file that is whole. */
void chunks_take_apart(const shape_bytes *file, chunks *out);

/* With checksums and a content hash that fit; frees the chunks. */
shape_bytes chunks_put_together(chunks *c);

#endif
