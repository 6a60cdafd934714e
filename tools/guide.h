/* SPDX-License-Identifier: MIT */
/*
 * guide.h - guide files and other sources of weights, for one mesh.
 *
 * A guide file (NAME.guide.json, tools/guide.md) names vertices by number, place
 * or region. Numbers are those of the mesh that it was made for; for another
 * one they are carried over to the nearest vertices, if the file tells where
 * its vertices were.
 */
#ifndef GUIDE_H
#define GUIDE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "encoder/pmesh_guide.h"
#include "tools/asset.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A view that the author of a guide likes. */
typedef struct guide_camera {
    const char *name;
    double yaw, pitch; /* degrees */
} guide_camera;

typedef struct guide {
    pmesh_guide use; /* what the encoder takes; points into the owner */
    const guide_camera *cameras;
    size_t camera_count;
    const char *warning; /* what was not quite as it should be, or "" */
    void *owner;
} guide;

/* A guide that says nothing. */
bool guide_create(guide *out);
void guide_free(guide *g);

/*
 * Weights from the mesh: "color:r" and the like (r, g, b, a, or a difference
 * as in "r-b", around 0.5), "attr:NAME" (quality, _LOD_WEIGHT, ...), or
 * "texture:FILE.png", whose brightness is looked up at the first texture
 * coordinates. 0 .. 1, clamped.
 */
bool guide_take_weights(guide *g, const asset *mesh, const char *source,
                        asset_error *error);

/* The mesh's own _LOD_WEIGHT, if it has one. */
bool guide_take_own_weights(guide *g, const asset *mesh, asset_error *error);

/* Reads a guide file; its weights go over those that are there. */
bool guide_read(guide *g, const uint8_t *data, size_t size, const asset *mesh,
                asset_error *error);

/* What a guide file calls the mesh by: 16 hexadecimal digits. */
void guide_hash(const asset *mesh, char out[17]);

/* Writes a guide file for the mesh that holds the places of all its vertices,
 * the weights there are, and empty lists. */
bool guide_write(const guide *g, const asset *mesh, asset_bytes *out);

#ifdef __cplusplus
}
#endif
#endif
