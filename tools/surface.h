/* SPDX-License-Identifier: MIT */
/*
 * surface.h - exact closest-point search on a triangle mesh.
 *
 * Coordinates live in a frame that several surfaces share: shifted and scaled
 * by a power of two so that all of them lie in -1 .. 1. That keeps squares in
 * range for any finite input, costs no rounding but that of the shift, and
 * makes equal input equal here.
 */
#ifndef SURFACE_H
#define SURFACE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tools/asset.h"

/* local = (model - center) * 2^-exponent */
typedef struct surface_frame {
    double center[3];
    int exponent;
} surface_frame;

typedef struct surface_node {
    float low[3], high[3];
} surface_node;

/* Faces in the order of the tree: nodes[1] is the root, node k has the
 * children 2k and 2k + 1, the last row holds leaves of at most four faces. */
typedef struct surface {
    double *points;    /* xyz, local; of faces only those count */
    uint32_t *corners; /* 3 per face */
    size_t face_count;
    size_t point_count;
    surface_node *nodes;
    unsigned depth;  /* of the leaves; the root has 0 */
    double diagonal; /* of the bounding box of the faces, local */
} surface;

/* A frame around all finite faces of `count` meshes; false if there is none. */
bool surface_frame_of(const asset *const *meshes, size_t count,
                      surface_frame *out);

/*
 * Copies the faces whose positions are finite and builds the tree over them.
 * False when memory is out; free with surface_free(), which accepts a zeroed
 * struct.
 */
bool surface_build(surface *out, const asset *mesh, const surface_frame *frame);
void surface_free(surface *s);

/* Squared distance from p to one face. */
double surface_face_distance2(const surface *s, size_t face, const double p[3]);

/* Squared distance from p to the surface. *hint is a face to try first, any
 * value < face_count, and becomes the closest one. */
double surface_closest(const surface *s, const double p[3], uint32_t *hint);

/*
 * The largest cosine between the unit vector n and the normals of the faces
 * that are as close to p as the closest one, up to rounding; `distance2` is
 * what surface_closest() returned. -1 if none of them has a normal. At most
 * some hundreds of faces are looked at.
 */
double surface_alignment(const surface *s, const double p[3],
                         const double n[3], double distance2);

#endif
