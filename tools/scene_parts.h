/* SPDX-License-Identifier: MIT */
/*
 * scene_parts.h - a glTF scene taken apart for baking: meshes, and everything
 * else as a document and resources (SPEC 11.4).
 */
#ifndef SCENE_PARTS_H
#define SCENE_PARTS_H

#include "tools/asset.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct scene_mesh {
    asset mesh;
    float scale; /* largest of its instances; 0: nothing shows it */
    char name[64]; /* for messages */
} scene_mesh;

typedef struct scene_parts {
    scene_mesh *meshes;
    size_t mesh_count;
    asset_bytes document;
    bool packed; /* that is; see pack.h */
    asset_bytes *resources;
    size_t resource_count, early_count;
    asset notes; /* its warnings: what was left out, and what is not refined */
    asset_bytes outside; /* text: a line for each image left in its file */
} scene_parts;

/* Whether a glTF file has anything that one merged mesh would lose: several
 * meshes, textures, skins, animations, cameras, lights. False too if it is not
 * readable. */
bool scene_is_worth_it(const uint8_t *data, size_t size);

/* Takes a .gltf or .glb apart; with `leave_images` those in files stay there.
 * Fails if there is no triangle in it. On failure nothing is to be freed. */
bool scene_parts_read(const uint8_t *data, size_t size, const char *path,
                      bool leave_images, scene_parts *out, asset_error *error);

void scene_parts_free(scene_parts *parts);

#ifdef __cplusplus
}
#endif
#endif
