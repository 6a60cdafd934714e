/* SPDX-License-Identifier: MIT */
/*
 * enc_nearest.h - how far points are from a mesh of triangles: a tree of boxes.
 */
#ifndef ENC_NEAREST_H
#define ENC_NEAREST_H

#include "format/pmesh.h"

/* A mesh of integers, borrowed. */
typedef struct enc_triangles {
    const uint32_t *corner; /* 3 per face */
    const int32_t (*position)[3];
    uint32_t face_count; /* at least 1 */
} enc_triangles;

typedef struct enc_nearest {
    pmesh_allocator allocator;
    enc_triangles mesh;
    uint32_t *order;   /* faces; a node halves a range of them */
    int32_t (*box)[6]; /* per node, whose children are 2 i + 1 and 2 i + 2:
                          least and largest coordinates */
} enc_nearest;

pmesh_status enc_nearest_create(const pmesh_allocator *allocator,
                                const enc_triangles *mesh, enc_nearest *out);
void enc_nearest_destroy(enc_nearest *nearest);

/* The squared distance of x. */
double enc_nearest_square(const enc_nearest *nearest, const double x[3]);

#endif
