/* SPDX-License-Identifier: MIT */
/* scene_info.h - what pmesh info says of scenes. */
#ifndef SCENE_INFO_H
#define SCENE_INFO_H

#include <stdbool.h>

#include "tools/file.h"

/* Prints what the headers say. Returns an exit code and has said why unless it
 * is CMD_DONE. */
int scene_info(const char *path, const file_data *data, bool as_json,
               bool levels);

#endif
