/* SPDX-License-Identifier: MIT */
/*
 * enc_near.h - pairs of vertices without an edge that are close to each other:
 * what joins pieces of the surface.
 */
#ifndef ENC_NEAR_H
#define ENC_NEAR_H

#include "encoder/enc_surface.h"

typedef struct enc_near {
    pmesh_allocator allocator;
    uint32_t (*pair)[2];
    uint32_t count, capacity;
} enc_near;

pmesh_status enc_near_create(const pmesh_allocator *allocator,
                             uint32_t capacity, enc_near *out);
void enc_near_destroy(enc_near *near);

/* Appends pairs at most `distance` steps apart, the closest few of each
 * vertex, as far as there is room. */
pmesh_status enc_near_within(const enc_mesh *mesh, double distance,
                             enc_near *out);

/* Appends a pair for each vertex that has small sheets (faces joined over
 * edges) and few neighbours in them: it, and the closest vertex that has none
 * of these sheets. */
pmesh_status enc_near_sheets(const enc_surface *s, enc_near *out);

#endif
