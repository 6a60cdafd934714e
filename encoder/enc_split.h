/* SPDX-License-Identifier: MIT */
/*
 * enc_split.h - a baked stream cut where a scene may go on with another mesh:
 * behind each chunk, and level by level.
 */
#ifndef ENC_SPLIT_H
#define ENC_SPLIT_H

#include <stdbool.h>

#include "encoder/pmesh_scene_encode.h"
#include "format/header.h"

typedef struct enc_split {
    const uint8_t *data;
    size_t size;
    size_t at; /* start of the next chunk, or of the signature */
    pmesh_header_chunk header;
    uint64_t header_end;
    uint32_t level; /* levels before `at` */
} enc_split;

/* Checks the chunks of a stream and their checksums, not what they hold. */
pmesh_status enc_split_open(enc_split *s, const void *data, size_t size);

/*
 * Takes the chunks up to the end of the next level, or as many of them as fit
 * into `room` bytes, but one at least; behind the last level, what is left.
 * False if there is none.
 */
bool enc_split_next(enc_split *s, size_t room, const uint8_t **data,
                    size_t *size);

#endif
