/* SPDX-License-Identifier: MIT */
/*
 * scene_file.h - a scene file, or what there is of it, decoded: what stream.h
 * is for single meshes.
 */
#ifndef SCENE_FILE_H
#define SCENE_FILE_H

#include <stdbool.h>

#include "decoder/pmesh_scene.h"
#include "tools/asset.h"
#include "tools/file.h"
#include "tools/scene_write.h"

typedef struct scene_file {
    pmesh_scene *scene;
    bool has_header;
    pmesh_scene_header header; /* if has_header */
    pmesh_scene_progress progress;
} scene_file;

/* Whether the data begin a scene. */
bool scene_file_is(const file_data *data);

/* Leaves of a GLB with a scene in it, whole or cut off, only the scene. */
void scene_file_unwrap(file_data *data);

/*
 * Decodes `data` as far as it goes. Returns CMD_DONE for a whole file and for a
 * prefix, else as stream_open(); *out is open in every case.
 */
int scene_file_open(const file_data *data, scene_file *out, asset_error *error);
void scene_file_close(scene_file *file);

/*
 * What is shown, as one mesh in the world: every instance with its materials,
 * without nodes, skins, animations. A library (NULL: none) is filled with what
 * the materials look like. On failure *out is empty.
 */
bool scene_file_merge(const scene_file *file, bool inflate,
                      scene_library *library, asset *out, asset_error *error);

/* A whole scene, or what is there of it, merged at full detail; the rules of
 * load_mesh_data(). */
int scene_file_load(const file_data *data, asset *out, asset_error *error);

#endif
