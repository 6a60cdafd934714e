/* SPDX-License-Identifier: MIT */
/*
 * scene_write.h - what a scene shows, as glTF: its document with the accessors
 * of the visible level put in.
 */
#ifndef SCENE_WRITE_H
#define SCENE_WRITE_H

#include <stdbool.h>

#include "decoder/pmesh_scene.h"
#include "tools/asset.h"

#ifdef __cplusplus
extern "C" {
#endif

/* An image of a library: bytes of the scene, which is to live as long. */
typedef struct scene_image {
    size_t number;
    const uint8_t *data;
    size_t size;
    const char *ending; /* "png" */
} scene_image;

/* Materials for OBJ, and the images that these name: STEM-NUMBER.ENDING. */
typedef struct scene_library {
    const char *stem;
    asset_bytes mtl;
    scene_image *images;
    size_t image_count;
    bool missing; /* some image is not there */
} scene_library;

void scene_library_free(scene_library *library);

typedef struct scene_style {
    bool glb;     /* else .gltf, with a data URI */
    bool inflate; /* coarse levels, see pmesh_decoder_copy_inflated() */
    bool meshopt; /* geometry by EXT_meshopt_compression */
    bool draco;   /* or by KHR_draco_mesh_compression */
    const uint64_t *lod_faces; /* budgets of a chain of levels, falling */
    size_t lod_count;          /* 0: the level that is visible now */
    /* NULL, or the scene's own file: it goes last into the buffer, and images
     * are shown where they start in it. */
    const asset_bytes *stream;
    const uint64_t *resource_offsets;
    scene_library *library; /* NULL, or to be filled; materials get the names
                               that it has for them */
} scene_style;

/*
 * Whether this is a GLB with a stream as scene_write() puts it there, or the
 * beginning of one; where the stream is, of which `size` bytes are there.
 */
bool scene_find_stream(const uint8_t *data, size_t data_size, size_t *offset,
                       size_t *size);

/*
 * Appends a glTF file to `out`. Of a scene that has not
 * arrived whole, images that are missing become one grey pixel and missing
 * animations are left out: lines in notes->warnings say so. Fails while the
 * document, a base mesh or what nothing can be shown without is missing, and
 * for documents that are no glTF.
 */
bool scene_write(pmesh_scene *scene, scene_style style, asset_bytes *out,
                 asset *notes, asset_error *error);

#ifdef __cplusplus
}
#endif
#endif
