/* SPDX-License-Identifier: MIT */
/*
 * scene.h - the header chunk of a scene file, read and written in one place
 * (SPEC 11.2).
 */
#ifndef PMESH_SCENE_FORMAT_H
#define PMESH_SCENE_FORMAT_H

#include "format/cursor.h"
#include "format/pmesh.h"

/* What the header says of one mesh. */
typedef struct pmesh_scene_stream {
    uint64_t size; /* bytes of its stream */
    float scale;   /* largest one of its instances; 0: it has none */
} pmesh_scene_stream;

/* Of a level of the scene, with bytes from the end of the header chunk. */
typedef struct pmesh_scene_row {
    uint64_t bytes;
    uint64_t faces, vertices;
    float error;
} pmesh_scene_row;

typedef struct pmesh_scene_head {
    uint64_t content_hash;
    uint32_t chunk_size; /* largest payload of a part chunk */
    uint32_t document_form; /* pmesh_document_form */
    uint64_t document_size; /* as it is stored */
    uint32_t mesh_count, resource_count, level_count;
    pmesh_scene_row levels[PMESH_MAX_LEVELS];
} pmesh_scene_head;

/* Meshes and resources, in two arrays as long as the head says. */
void pmesh_scene_head_write(pmesh_writer *out, const pmesh_scene_head *h,
                            const pmesh_scene_stream *meshes,
                            const uint64_t *resources);

/*
 * Reading goes in two steps, as the caller makes room for the arrays between
 * them. Each returns PMESH_OK, E_VERSION or E_CORRUPT with *rule set.
 */
pmesh_status pmesh_scene_head_read(pmesh_cursor *in, pmesh_scene_head *h,
                                   const char **rule);
pmesh_status pmesh_scene_lists_read(pmesh_cursor *in,
                                    const pmesh_scene_head *h,
                                    pmesh_scene_stream *meshes,
                                    uint64_t *resources, const char **rule);

#endif
