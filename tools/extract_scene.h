/* SPDX-License-Identifier: MIT */
/*
 * extract_scene.h - a scene of any size out of a scene file or a part of one.
 */
#ifndef EXTRACT_SCENE_H
#define EXTRACT_SCENE_H

#include <stdbool.h>
#include <stdint.h>

#include "tools/asset.h"
#include "tools/file.h"

#define EXTRACT_ALL_MESHES UINT32_MAX

/* What pmesh extract was asked for. */
typedef struct extract_request {
    const char *input, *output;
    asset_format format;
    uint32_t faces;      /* 0: no bound */
    double ratio, error; /* negative: not given */
    uint32_t mesh;       /* one only, in its own space, or ALL_MESHES */
    const char *lods;    /* ratios of a chain of levels, by commas; or NULL */
    bool meshopt, draco, inflate, strict, salvage, no_attributes, quiet;
} extract_request;

/* Returns an exit code and has said why unless it is CMD_DONE. */
int extract_scene(const extract_request *request, const file_data *data);

/* The face bound of --faces and --ratio together, of `all` faces; 0: none. */
uint64_t extract_face_bound(uint32_t faces, double ratio, uint64_t all);

#endif
