/* SPDX-License-Identifier: MIT */
/*
 * enc_mux.h - a scene file in the making: its chunks, in their order.
 */
#ifndef ENC_MUX_H
#define ENC_MUX_H

#include "encoder/enc_split.h"
#include "format/scene.h"

/* A chunk of the file to be. */
typedef struct enc_piece {
    uint32_t part, size;
    const uint8_t *data;
    uint32_t crc;
    bool is_row; /* all base meshes are there, and it ends a level: */
    pmesh_scene_row row;
} enc_piece;

typedef struct enc_mux {
    const pmesh_scene_input *in;
    pmesh_allocator allocator;
    enc_split *mesh;
    uint32_t *heap, heap_count;
    enc_piece *piece;
    size_t piece_count, piece_room;
    pmesh_scene_row now; /* what is there so far */
    bool failed;         /* out of memory */
} enc_mux;

/* Opens the streams, in which *bad is the one that is none, and lists all
 * chunks of the scene. On failure, too, enc_mux_destroy() is due. */
pmesh_status enc_mux_build(enc_mux *m, const pmesh_scene_input *in,
                           const pmesh_allocator *allocator, size_t *bad);
void enc_mux_destroy(enc_mux *m);

#endif
