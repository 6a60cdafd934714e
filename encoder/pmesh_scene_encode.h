/* SPDX-License-Identifier: MIT */
/*
 * pmesh_scene_encode.h - many baked meshes, a document and resources into one
 * scene file.
 *
 *   pmesh_scene_mesh_input meshes[2] = {
 *       { .stream = a, .size = a_size, .scale = 1 },
 *       { .stream = b, .size = b_size, .scale = 0.01f }
 *   };
 *   pmesh_scene_input scene = { .meshes = meshes, .mesh_count = 2 };
 *   pmesh_status status =
 *       pmesh_scene_encode(&scene, NULL, my_write, my_file, &report);
 *
 * Each mesh is a file that pmesh_encode() wrote: the caller bakes them, in as
 * many threads and with as many configs as it likes. Their chunks are
 * interleaved: first all base meshes, then always the next level of the mesh
 * whose error is the largest in the world, so that any prefix is the best
 * scene of its size. The same input gives the same bytes.
 */
#ifndef PMESH_SCENE_ENCODE_H
#define PMESH_SCENE_ENCODE_H

#include "encoder/pmesh_encode.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A complete .pmesh file of a single mesh. `scale` is the largest factor by
 * which an instance enlarges it; 0: nothing shows it. */
typedef struct pmesh_scene_mesh_input {
    const void *stream;
    size_t size;
    float scale;
} pmesh_scene_mesh_input;

typedef struct pmesh_scene_blob {
    const void *data;
    size_t size;
} pmesh_scene_blob;

/* All of it is borrowed for the call. */
typedef struct pmesh_scene_input {
    const pmesh_scene_mesh_input *meshes;
    size_t mesh_count; /* 1 .. 65536 */
    pmesh_scene_blob document; /* at most 2^28 bytes; may be empty */
    pmesh_document_form document_form; /* of these bytes; they are not looked
                                          at */
    const pmesh_scene_blob *resources;
    size_t resource_count; /* at most 65536 */
    size_t early_count;    /* the first of the resources, which are needed to
                              show anything, go before the meshes */
    uint64_t *resource_offsets; /* NULL, or room for resource_count: each
                                   resource stays in one piece, and this is told
                                   where it starts in the file */
} pmesh_scene_input;

typedef struct pmesh_scene_report {
    uint64_t bytes;           /* the file */
    uint64_t bytes_header, bytes_document, bytes_meshes, bytes_resources; /*
                                 its parts, framing included */
    uint64_t faces, vertices; /* output vertices; of all meshes */
    uint32_t level_count;
    pmesh_scene_level levels[PMESH_MAX_LEVELS];
    size_t error_mesh;        /* of a failure: which mesh, if it is one's */
} pmesh_scene_report;

/*
 * Writes the file front to back. allocator NULL: malloc and free. report: NULL
 * or filled.
 *
 * Returns PMESH_OK, E_ARGUMENT (counts or a scale out of range), E_MEMORY,
 * E_LIMIT, E_WRITE; E_MAGIC, E_VERSION, E_CORRUPT, E_CHECKSUM, NEED_DATA if a
 * mesh is no complete file. Nothing has been written then, but with E_WRITE.
 */
PMESH_API pmesh_status pmesh_scene_encode(const pmesh_scene_input *scene,
                                          const pmesh_allocator *allocator,
                                          pmesh_write write, void *user,
                                          pmesh_scene_report *report);

#ifdef __cplusplus
}
#endif
#endif
