/* SPDX-License-Identifier: MIT */
/*
 * enc_guide.h - guidance by the vertices of the enc_mesh.
 *
 * Weights multiply the geometry quadrics of their vertex and with them the cost
 * of its pairs. Constraint quadrics are kept apart: they choose the place, and
 * of the subset placement the direction, and never count as cost. A contraction
 * sums them (Kho and Garland, 4.1), and takes the mean of the factors by area:
 * the factor of the sum of the two weighted quadrics.
 */
#ifndef ENC_GUIDE_H
#define ENC_GUIDE_H

#include <stdbool.h>

#include "encoder/enc_mesh.h"
#include "encoder/enc_quadric.h"
#include "encoder/pmesh_guide.h"

/* The directions of a pair (u, v) that a guide may leave. */
enum { ENC_GUIDE_FORTH = 1, ENC_GUIDE_BACK = 2 };

/* Each array is NULL where the guide says nothing of its kind. */
struct enc_guide {
    float *factor;     /* per vertex, > 0 */
    uint8_t *lock;     /* per vertex */
    uint16_t *segment; /* per vertex */
    double *share;     /* per segment */
    uint32_t segment_count;
    enc_quadric *pull; /* per vertex: its constraints, about its position */
};

/* False if a number is out of range; vertex_count is of the input. */
bool enc_guide_is_sound(const pmesh_guide *guide, size_t vertex_count);

/*
 * Makes mesh->guide from config->guide, if there is one. `number` and `source`
 * are the importer's: what the input's vertices became before cutting, and the
 * input face of each face. Returns PMESH_OK, E_ARGUMENT or E_MEMORY.
 */
pmesh_status enc_guide_create(enc_mesh *mesh, const pmesh_mesh_input *in,
                              const pmesh_guide *guide, const uint32_t *number,
                              const uint32_t *source);

/* Accepts a mesh without. */
void enc_guide_destroy(enc_mesh *mesh);

/* Which of "u vanishes into v" and the converse are allowed. */
unsigned enc_guide_directions(const enc_guide *guide, uint32_t u, uint32_t v);

#endif
