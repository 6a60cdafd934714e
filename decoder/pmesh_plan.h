/* SPDX-License-Identifier: MIT */
/*
 * pmesh_plan.h - which level to load or to show, from level tables alone: pure
 * functions, no decoder needed, no memory taken.
 *
 *   pmesh_decoder_header(dec, &h);
 *   double scale = pixels_per_unit(distance);
 *   level = pmesh_plan_pixels(h.levels, h.level_count, scale, 1.0, level);
 *   fetch up to h.levels[level].bytes, then refine to h.levels[level].faces
 *
 * The screen-space rule. A level's error bounds the distance of the full mesh's
 * vertices in units of the model; seen from `distance` it covers
 *
 *   pixels = error * pixels_per_unit
 *   pixels_per_unit = image height / (2 * distance * tan(field of view / 2))
 *
 * with the vertical field of view, the distance of the camera to the nearest
 * point of the mesh's box, and the scale of its transform multiplied in. For an
 * orthographic camera: image height / height of what it sees. Of several
 * cameras take the largest.
 */
#ifndef PMESH_PLAN_H
#define PMESH_PLAN_H

#include "format/pmesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The coarsest level whose error is at most `error`; the last if none is. */
PMESH_API uint32_t pmesh_plan_error(const pmesh_level *levels, uint32_t count,
                                    double error);

/* The finest level within the first `bytes` bytes, or with at most `faces`
 * faces; 0, the base mesh, if none is. */
PMESH_API uint32_t pmesh_plan_bytes(const pmesh_level *levels, uint32_t count,
                                    uint64_t bytes);
PMESH_API uint32_t pmesh_plan_faces(const pmesh_level *levels, uint32_t count,
                                    uint32_t faces);

/*
 * The coarsest level whose error covers at most `pixels`, with hysteresis: from
 * the level `current` (UINT32_MAX: none yet) a finer one is taken as soon as it
 * is needed, a coarser one only if its error is at most 3/4 of `pixels`. So a
 * camera that trembles around the threshold does not make levels change.
 */
PMESH_API uint32_t pmesh_plan_pixels(const pmesh_level *levels, uint32_t count,
                                     double pixels_per_unit, double pixels,
                                     uint32_t current);

/* A mesh among others: one entry for each place where it is seen, or one with
 * the largest scale of all. */
typedef struct pmesh_plan_item {
    const pmesh_level *levels;
    uint32_t level_count;
    double pixels_per_unit; /* 0: not in sight, stays at its base mesh */
    uint32_t level;         /* out */
} pmesh_plan_item;

/*
 * Shares a budget of faces and of bytes (0: none) among meshes. From base
 * meshes on, the mesh whose error covers the most pixels gets its next level,
 * until all are within `pixels`; one whose next level does not fit any more
 * stays as it is. So the largest error on the screen is as small as the budget
 * allows, and equal items get equal levels but for the last steps, which the
 * first items win. Base meshes are taken even if they exceed the budget; items
 * from 2^24 on, and levels from 256 on, are not given more.
 *
 * Time: the levels given, times the logarithm of the items. Returns the largest
 * error left, in pixels.
 */
PMESH_API double pmesh_plan_scene(pmesh_plan_item *items, uint32_t count,
                                  double pixels, uint64_t faces,
                                  uint64_t bytes);

#ifdef __cplusplus
}
#endif
#endif
