/* SPDX-License-Identifier: MIT */
/*
 * lods.h - small meshes for pmesh_simplify_mesh(), its buffers, and what can
 * be said of its results.
 */
#ifndef LODS_H
#define LODS_H

#include <stdbool.h>

#include "encoder/pmesh_simplify.h"

typedef struct lods {
    double *xyz; /* in.doubles */
    uint32_t *tri;
    pmesh_simplify_attribute attributes[PMESH_MAX_ATTRIBUTES];
    pmesh_simplify_input in; /* attributes: lods_add() */
    pmesh_simplify_options options;
    pmesh_simplify_output out; /* with all buffers */
} lods;

/* Takes over the arrays. */
lods *lods_make(double *xyz, size_t vertex_count, uint32_t *tri,
                size_t face_count);
lods *lods_copy(const double *xyz, size_t vertex_count, const uint32_t *tri,
                size_t face_count);
lods *lods_sphere(uint32_t size);  /* of radius 1, closed */
lods *lods_terrain(uint32_t size); /* open; coordinates n / 2^20 */
lods *lods_flat(uint32_t size);    /* a square at z = 0, cells of 1 x 1 */
lods *lods_tetrahedra(uint32_t count);
lods *lods_soup(uint32_t faces, uint32_t vertices, uint32_t seed);
void lods_free(lods *l);

/* A new attribute; the values, one tuple per vertex, are taken over. */
void lods_add(lods *l, pmesh_attribute_kind kind, uint8_t components,
              float *values, float weight);

/* pmesh_simplify_mesh() with what is there. */
pmesh_status lods_run(lods *l);

/* Indices in range; no face has a position twice. */
bool lods_is_sound(const lods *l);
/* And every edge has two faces that run opposite ways, by position_indices. */
bool lods_is_closed(const lods *l);
/* Pieces of the result, by position_indices. */
size_t lods_components(const lods *l);
bool lods_same_faces(const lods *a, const lods *b);
/* Of double length, of twice the area. */
void lods_normal(const lods *l, size_t face, double out[3]);
double lods_volume(const double *xyz, const uint32_t *tri, size_t face_count);
/* Of faces' middles from the unit sphere. */
double lods_sphere_rms(const lods *l);

/* An allocator that fails after `left` allocations; `bytes` are in use. */
typedef struct lods_budget {
    size_t left, bytes;
} lods_budget;
pmesh_allocator lods_budget_allocator(lods_budget *budget);

#endif
