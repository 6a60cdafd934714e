/* SPDX-License-Identifier: MIT */
/*
 * scene_budget.h - budgets of faces as they are drawn.
 *
 * pmesh_scene counts the faces of a mesh once, as a file holds them. Who asks
 * for a scene of N faces means what is drawn: a mesh that ten nodes show counts
 * ten times. The order in which meshes get their faces is the decoder's.
 */
#ifndef SCENE_BUDGET_H
#define SCENE_BUDGET_H

#include <stdbool.h>
#include <stdint.h>

#include "decoder/pmesh_scene.h"
#include "tools/asset.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct scene_budget {
    pmesh_scene *scene;
    uint32_t mesh_count;
    uint64_t stored;     /* faces of the whole file, each mesh once */
    uint64_t all;        /* the same as drawn */
    uint64_t *instances; /* of each mesh; a mesh without nodes counts once */
    uint32_t *share;     /* of each mesh, for a while */
} scene_budget;

/*
 * Counts the nodes that show each mesh. Until a mesh's own header has arrived
 * its faces count once in `all`. Fails without the document or memory; *out is
 * to be closed in every case.
 */
bool scene_budget_open(pmesh_scene *scene, scene_budget *out,
                       asset_error *error);

void scene_budget_close(scene_budget *budget);

/* Faces drawn of what is visible now. */
uint64_t scene_budget_drawn(const scene_budget *budget);

/* The largest pmesh_scene_target.faces that draws at most `faces`, or 1, the
 * base meshes, if these are too many; 0, no bound, for 0. */
uint64_t scene_budget_stored(const scene_budget *budget, uint64_t faces);

/* For each mesh the nodes, of any of the document's scenes, that show it.
 * `instances` holds zeros. */
bool scene_instances(const pmesh_scene *scene, uint32_t mesh_count,
                     uint64_t *instances, asset_error *error);

#ifdef __cplusplus
}
#endif
#endif
