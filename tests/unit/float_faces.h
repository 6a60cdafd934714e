/* SPDX-License-Identifier: MIT */
/*
 * float_faces.h - a mesh as the set of its faces with the bits of their
 * corners: what must be equal before and after a lossless file.
 */
#ifndef FLOAT_FACES_H
#define FLOAT_FACES_H

#include <stddef.h>
#include <stdint.h>

typedef struct float_face {
    uint32_t x[9]; /* the least of the three rotations */
} float_face;

/* Fills `out` (room for all faces) in order, without copies and without faces
 * that have two corners of equal bits; returns how many. */
size_t float_faces(const float *xyz, const uint32_t *indices, size_t count,
                   float_face *out);

/* The same of doubles, each rounded to a float. */
size_t float_faces_of(const double *xyz, size_t vertices,
                      const uint32_t *indices, size_t count, float_face *out);

#endif
