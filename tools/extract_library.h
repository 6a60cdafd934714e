/* SPDX-License-Identifier: MIT */
/*
 * extract_library.h - the files beside an OBJ of a scene: x.mtl with its
 * materials, x-0.png and so on with their images.
 */
#ifndef EXTRACT_LIBRARY_H
#define EXTRACT_LIBRARY_H

#include <stdbool.h>

#include "tools/asset.h"
#include "tools/scene_write.h"

typedef struct extract_library {
    char *stem; /* the OBJ's path without its ending */
    char *path; /* room for a path of its files: of that which failed */
    scene_library content;
} extract_library;

/* For an OBJ of this path. Fails if memory is short or no line can hold the
 * file's name. *out is to be closed in every case. */
bool extract_library_open(const char *obj, extract_library *out,
                          asset_error *error);

/* The line that names the library. */
void extract_library_put_name(const extract_library *library,
                              asset_bytes *obj);

/* Writes images, then the library, each a whole file or none. */
bool extract_library_write(extract_library *library, asset_error *error);

void extract_library_close(extract_library *library);

#endif
