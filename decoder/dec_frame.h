/* SPDX-License-Identifier: MIT */
/*
 * dec_frame.h - a file cut into chunks (SPEC 5.1, 5.2), whatever the pieces it
 * arrives in: of a mesh and of a scene alike.
 */
#ifndef DEC_FRAME_H
#define DEC_FRAME_H

#include <stdbool.h>

#include "decoder/pmesh_decode.h"
#include "format/layout.h"

typedef enum dec_stage {
    DEC_SIGNATURE,
    DEC_CHUNK_START, /* type and size */
    DEC_CHUNK_BODY,  /* payload and checksum */
    DEC_END
} dec_stage;

typedef struct dec_frame {
    pmesh_decode_error error; /* once its status is negative, it is final */
    dec_stage stage;
    uint64_t offset;       /* bytes taken so far */
    uint64_t chunk_offset; /* where the current chunk starts */
    uint64_t whole;        /* bytes up to the last complete chunk */
    uint64_t hash;         /* of all critical chunks but header and end */
    uint32_t chain;        /* checksum of the last of these */
    uint8_t start[16];     /* signature, or a chunk's type and size */
    uint32_t start_size;
    uint8_t type;
    uint8_t *to;             /* room for the payload; NULL: it is skipped */
    uint32_t size, received; /* of the payload; received counts the checksum */
    uint32_t crc;
    uint8_t tail[PMESH_CRC_SIZE];
} dec_frame;

/* Who takes the chunks. Both calls may fail the frame. */
typedef struct dec_frame_owner {
    void *self;
    /* May a chunk of this type and size come now? Sets `to`, unless its type is
     * skippable. */
    pmesh_status (*begin)(void *self);
    /* Takes in a chunk, whose checksum was right. */
    pmesh_status (*finish)(void *self);
} dec_frame_owner;

void dec_frame_start(dec_frame *f);

/* Makes `status` final; the error's offset is that of the current chunk. */
pmesh_status dec_frame_fail(dec_frame *f, pmesh_status status,
                            const char *rule);

/* The rules of pmesh_decoder_feed(). */
pmesh_status dec_frame_feed(dec_frame *f, const dec_frame_owner *owner,
                            const void *data, size_t size);

#endif
