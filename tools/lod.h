/* SPDX-License-Identifier: MIT */
/*
 * lod.h - an asset with fewer faces.
 */
#ifndef LOD_H
#define LOD_H

#include "encoder/pmesh_simplify.h"
#include "tools/asset.h"

typedef struct lod_weights {
    double normal, texcoord, color, generic;
} lod_weights;

/* The rest of what pmesh_simplify_mesh() tells. */
typedef struct lod_report {
    pmesh_simplify_end end;
    size_t vertices; /* distinct positions */
    double error, cost_least, cost_mean, cost_most;
    size_t dropped_faces, joined;
} lod_report;

/*
 * Simplifies `in` into *out, which keeps materials and attributes, these
 * weighted by kind. Returns a status of pmesh_simplify_mesh(); if it is not
 * PMESH_OK, *out is empty.
 */
pmesh_status lod_make(const asset *in, const pmesh_simplify_options *options,
                      const lod_weights *weights, asset *out,
                      lod_report *report);

#endif
