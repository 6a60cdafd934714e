/* SPDX-License-Identifier: MIT */
/*
 * distance.h - how far two surfaces are apart, and what their topology is.
 *
 * Both surfaces get points spread evenly over their area; each is projected on
 * the other surface by an exact search. The points depend on nothing but the
 * mesh and their number. The maximum is then raised to that of all points of
 * the surface (tools/farthest.h).
 */
#ifndef DISTANCE_H
#define DISTANCE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tools/asset.h"

#define DISTANCE_DEFAULT_SAMPLES 200000u

/* Lengths in model units. What lies below the rounding of the arithmetic
 * (1e-14 of the extent, 1e-5 degrees) is 0. */
typedef struct distance_stats {
    double rms, mean;
    double max; /* one-sided Hausdorff distance; as a rule to 0.5 %, and never
                   more than the true one */
    double normal_deg; /* root of the mean squared angle between the face
                          normals; of faces equally close the best counts */
} distance_stats;

typedef struct distance_report {
    double diagonal; /* of A's bounding box */
    size_t samples;  /* per surface */
    distance_stats a_to_b, b_to_a;
    distance_stats both; /* mean of the two (of the squares for rms and
                            normal_deg), and the larger maximum */
} distance_report;

/* Whether any face has three finite positions; others do not take part. */
bool distance_has_faces(const asset *mesh);

/* Both meshes must have faces to measure. False when memory is out. */
bool distance_measure(const asset *a, const asset *b, size_t samples,
                      distance_report *out);

#endif
