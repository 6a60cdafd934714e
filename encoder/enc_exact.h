/* SPDX-License-Identifier: MIT */
/*
 * enc_exact.h - the last layer of a lossless file (SPEC 6.8).
 */
#ifndef ENC_EXACT_H
#define ENC_EXACT_H

#include "encoder/enc_replay.h"
#include "encoder/enc_stream.h"

/*
 * Appends the exact positions of the replayed mesh, which is complete, and
 * sets exact_size and exact_form of the header. `room` is scratch for a chunk,
 * twice PMESH_BLOCK_CHUNK_SIZE at least.
 */
pmesh_status enc_exact_write(const enc_replay *r, enc_stream *stream,
                             uint8_t *room, pmesh_header_chunk *header);

#endif
