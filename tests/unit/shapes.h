/* SPDX-License-Identifier: MIT */
/*
 * shapes.h - small meshes for tests, with all that a stream can carry, and the
 * bake that tests decode.
 */
#ifndef SHAPES_H
#define SHAPES_H

#include <stdbool.h>

#include "decoder/pmesh_decode.h"
#include "encoder/pmesh_encode.h"

enum { SHAPE_ATTRIBUTES = 3 };

typedef struct shape_mesh {
    double *positions;
    uint32_t *indices, *materials;
    pmesh_attribute_input attributes[SHAPE_ATTRIBUTES];
    float *values[SHAPE_ATTRIBUTES];
    uint32_t *corner_indices; /* of the texture coordinates */
    pmesh_mesh_input input;
} shape_mesh;

typedef enum shape_kind {
    SHAPE_SPHERE,  /* closed, smooth normals, UVs with a seam, two materials */
    SHAPE_TERRAIN, /* open, colours, no seam */
    SHAPE_TORUS,   /* closed, bare */
    SHAPE_FACETS,  /* a sphere with one normal per face: all corners differ */
    SHAPE_SOUP,    /* random triangles over few vertices: not manifold at all */
    SHAPE_PIECES,  /* many tetrahedra apart */
    SHAPE_COUNT
} shape_kind;

/* `size` grows the mesh; `seed` changes its bumps. */
shape_mesh *shape_make(shape_kind kind, uint32_t size, uint32_t seed);
void shape_free(shape_mesh *shape);

typedef struct shape_bytes {
    uint8_t *data;
    size_t size, capacity;
} shape_bytes;

/* pmesh_encode() into memory. */
pmesh_status shape_bake(const shape_mesh *shape,
                        const pmesh_encoder_config *config, shape_bytes *out,
                        pmesh_encode_report *report);

/* A decoder that was given the first `size` bytes, `piece` at a time; NULL if
 * none could be made. */
pmesh_decoder *shape_decode(const uint8_t *data, size_t size, size_t piece,
                            pmesh_status *status);

/* FNV-1a over all that the view shows. */
uint64_t shape_view_hash(const pmesh_decoder *dec);

/* Indices in range, no vertex twice in a face. */
bool shape_view_sound(const pmesh_decoder *dec);

uint32_t shape_random(uint32_t *seed, uint32_t below);

#endif
