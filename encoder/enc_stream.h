/* SPDX-License-Identifier: MIT */
/*
 * enc_stream.h - a file in the making: chunks one after the other in memory,
 * the header put before them at the end.
 */
#ifndef ENC_STREAM_H
#define ENC_STREAM_H

#include "encoder/pmesh_encode.h"
#include "format/header.h"

typedef struct enc_stream {
    pmesh_allocator allocator;
    uint8_t *data; /* everything behind the header chunk */
    size_t size, capacity;
    uint64_t hash;
    uint32_t crc;     /* of all chunks so far */
    uint32_t largest; /* payload */
    bool failed;      /* out of memory, sticky */
} enc_stream;

void enc_stream_init(enc_stream *s, pmesh_allocator allocator);
void enc_stream_destroy(enc_stream *s);

/* Appends a chunk with its framing. */
void enc_stream_chunk(enc_stream *s, uint8_t type, const uint8_t *payload,
                      uint32_t size);

/* Appends the end, fills in chunk_size and content_hash, and writes signature,
 * header and everything else. `file_size` and `header_size` are set. */
pmesh_status enc_stream_write(enc_stream *s, pmesh_header_chunk *header,
                              pmesh_write write, void *user,
                              uint64_t *header_size, uint64_t *file_size);

#endif
