/* SPDX-License-Identifier: MIT */
/*
 * raster.h - draws a mesh into a picture, without a GPU.
 *
 * A depth buffer, several samples per pixel, light that follows from the
 * geometry alone. Coverage is decided by integer edge functions and the rest
 * by IEEE arithmetic in a fixed order: the same pixels on every machine.
 */
#ifndef RASTER_H
#define RASTER_H

#include <stdbool.h>
#include <stdint.h>

#include "tools/asset.h"
#include "tools/picture.h"

/* A parallel projection. A position p appears at rows * (p - center) / extent:
 * x right, y up, z towards the viewer, -1 .. 1 in the square drawn to. */
typedef struct raster_camera {
    double rows[3][3];
    double center[3];
    double extent;
} raster_camera;

typedef struct raster_style {
    bool wire;
    bool flat; /* one shade per face; else smooth where the surface is */
    const float *heat; /* per vertex: 0 .. 1 from blue to red; or NULL */
    size_t plain;      /* with heat: faces from this number on have none; 0:
                          all have it */
} raster_style;

/*
 * Fits the mesh into the square, seen from `yaw` turns to the right of +z and
 * `pitch` turns above it; y is up. False if no face has finite positions.
 */
bool raster_camera_fit(raster_camera *out, const asset *mesh, double yaw,
                       double pitch);

/* Draws into a square of `size` pixels. False when memory is out. */
bool raster_draw(picture *p, uint32_t x, uint32_t y, uint32_t size,
                 const asset *mesh, const raster_camera *camera,
                 const raster_style *style);

#endif
