/* SPDX-License-Identifier: MIT */
/*
 * bake_scene.h - a whole glTF scene into one file.
 */
#ifndef BAKE_SCENE_H
#define BAKE_SCENE_H

#include "tools/bake_report.h"
#include "tools/file.h"

/* Bakes one mesh into `out` with so many threads, fills report->encode; returns
 * an exit code and has said why unless it is CMD_DONE. Several may be baked at
 * a time, but only with one thread each. */
typedef int (*bake_mesh)(void *user, const char *name, const asset *mesh,
                         unsigned threads, bake_report *report,
                         asset_bytes *out);

/*
 * Bakes the scene in `data` into `out`: each of its meshes by `bake`, then all
 * of them together. report->encode gets the sums and the scene's level table.
 * glb: into a GLB that shows the base meshes and holds the scene's file.
 * leave_images: those in files beside the input stay there.
 */
int bake_scene(const file_data *data, unsigned threads, bake_mesh bake,
               void *user, bool glb, bool leave_images, bake_report *report,
               asset_bytes *out);

#endif
