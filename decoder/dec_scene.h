/* SPDX-License-Identifier: MIT */
/*
 * dec_scene.h - the state of a scene: framing, parts, and a decoder for each
 * mesh.
 */
#ifndef DEC_SCENE_H
#define DEC_SCENE_H

#include <stdbool.h>

#include "decoder/pmesh_scene.h"
#include "format/layout.h"
#include "format/scene.h"

typedef struct dec_scene_mesh {
    pmesh_decoder *decoder; /* NULL until the mesh begins */
    uint64_t received;
    bool counted; /* its block was taken from the memory that is left */
    uint32_t levels;
    uint64_t level_end[PMESH_MAX_LEVELS]; /* in the scene file; `levels` */
    /* While refining: the level it stands at, and the faces to show. */
    uint32_t level, faces;
} dec_scene_mesh;

typedef struct dec_scene_part {
    uint8_t *data; /* NULL: not kept */
    uint64_t size, received;
} dec_scene_part;

typedef enum dec_scene_stage {
    DEC_SCENE_SIGNATURE,
    DEC_SCENE_START, /* type and size */
    DEC_SCENE_BODY,  /* payload and checksum */
    DEC_SCENE_END
} dec_scene_stage;

struct pmesh_scene {
    pmesh_allocator allocator;
    pmesh_scene_config config;
    pmesh_decode_error error;
    uint64_t memory_left;

    /* Framing (dec_scene_stream.c). */
    dec_scene_stage stage;
    uint64_t offset, chunk_offset, whole;
    uint8_t start[16];
    uint32_t start_size;
    uint8_t type;
    uint32_t size, received;
    uint32_t crc;
    uint8_t tail[PMESH_CRC_SIZE];
    uint64_t hash;
    bool skipping;

    /* Contents (dec_scene_part.c). */
    bool has_header;
    uint64_t header_end;
    pmesh_scene_head head;
    uint8_t *header; /* payload of the header chunk, until it is read */
    void *block;     /* the arrays below, document, resources, payload */
    uint64_t block_size;
    uint8_t *payload; /* of head.chunk_size bytes */
    dec_scene_part document;
    dec_scene_part *resource;
    dec_scene_mesh *mesh;
    pmesh_scene_stream *stream; /* what the header says of each mesh */
    uint32_t *heap;             /* of refining */
};

/* Makes `status` final; offset is that of the current chunk. */
pmesh_status dec_scene_fail(pmesh_scene *scene, pmesh_status status,
                            const char *rule);

/* Is a chunk of this type and payload size legal here? Sets skipping. */
pmesh_status dec_scene_begin(pmesh_scene *scene);

/* Takes in a chunk whose checksum was right. */
pmesh_status dec_scene_finish(pmesh_scene *scene);

#endif
