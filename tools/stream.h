/* SPDX-License-Identifier: MIT */
/*
 * stream.h - a .pmesh file, or what there is of it, in a decoder.
 */
#ifndef STREAM_H
#define STREAM_H

#include <stdbool.h>
#include <stdint.h>

#include "decoder/pmesh_decode.h"
#include "tools/asset.h"
#include "tools/file.h"

typedef struct stream {
    pmesh_decoder *decoder;
    bool has_header;
    pmesh_header header;           /* if has_header */
    pmesh_progress_state progress; /* how far decoding came */
    bool shown; /* the base mesh is there, so there is a mesh to look at */
} stream;

/*
 * Decodes `data` as far as it goes; the memory for it is bounded by its size.
 * Returns CMD_DONE for a whole file and for a prefix (progress.complete tells
 * which), CMD_STREAM if it is damaged, no .pmesh or needs more memory than the
 * bound, CMD_IO if memory is out. *error is set unless CMD_DONE; *out is open
 * in every case and says what came before the failure.
 */
int stream_open(const file_data *data, stream *out, asset_error *error);

/* Reads no further than the base mesh: counts, level table and names. A file
 * too short for the header returns CMD_STREAM. */
int stream_open_header(const file_data *data, stream *out, asset_error *error);

void stream_close(stream *s);

/* The most memory that a file of `size` bytes may take to decode. */
uint64_t stream_memory(uint64_t size);

/* The message for a failure, and the exit code. */
int stream_explain(const pmesh_decode_error *damage, uint64_t size,
                   asset_error *error);

#endif
