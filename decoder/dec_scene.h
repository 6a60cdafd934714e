/* SPDX-License-Identifier: MIT */
/*
 * dec_scene.h - the state of a scene: framing, parts, and a decoder for each
 * mesh.
 */
#ifndef DEC_SCENE_H
#define DEC_SCENE_H

#include <stdbool.h>

#include "decoder/dec_frame.h"
#include "decoder/pmesh_scene.h"
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

struct pmesh_scene {
    pmesh_allocator allocator;
    pmesh_scene_config config;
    dec_frame frame;
    uint64_t memory_left;

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

/* Of the frame, whose owner is a pmesh_scene. */
pmesh_status dec_scene_begin(void *scene);
pmesh_status dec_scene_finish(void *scene);

#endif
