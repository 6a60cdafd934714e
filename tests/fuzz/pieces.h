/* SPDX-License-Identifier: MIT */
/*
 * pieces.h - any bytes as a list of chunks, as far as they go, and a list of
 * chunks as a file whose sizes and checksums are right.
 */
#ifndef PIECES_H
#define PIECES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { PIECES = 256 };

typedef struct piece {
    uint8_t type;
    const uint8_t *data; /* the payload: points into the bytes */
    size_t size;
    const uint8_t *frame; /* the whole chunk, its checksum included */
    size_t frame_size;
} piece;

typedef struct pieces {
    piece at[PIECES];
    uint32_t count;
    bool fit; /* the checksums of all of them are right */
    piece rest; /* behind the last that is whole */
} pieces;

/* False if not even the signature is there. */
bool pieces_take_apart(const uint8_t *data, size_t size, pieces *out);

/* Writes them with right checksums and, if `mend`, a header that holds the
 * content hash that fits. Returns the size, or 0 if `capacity` is too small. */
size_t pieces_put_together(const pieces *p, bool mend, uint8_t *out,
                           size_t capacity);

/* The content hash that the header should hold, and does. */
uint64_t pieces_hash(const pieces *p);
uint64_t pieces_hash_stored(const pieces *p);

#endif
