/* SPDX-License-Identifier: MIT */
/*
 * enc_inflate.h - chooses each level's inflation (format/inflate.h).
 *
 * With heights d and normals S (twice the area), moving all vertices by t d
 * adds t (sum of d . S) / 6 to the volume, to first order. What is missing of
 * the original's volume so gives t. Three quarters of it come closest: RMS of
 * subset levels falls by 5 % at half, by 10 to 20 % at a tenth of the faces and
 * below, that of CAD not at all.
 */
#ifndef ENC_INFLATE_H
#define ENC_INFLATE_H

#include "encoder/enc_mesh.h"
#include "format/inflate.h"
#include "format/mesh.h"

typedef struct enc_inflate {
    const enc_mesh *mesh;
    double volume; /* of the original, times 6, about the middle of the grid */
    pmesh_bulge *bulge; /* per vertex */
} enc_inflate;

pmesh_status enc_inflate_create(const enc_mesh *mesh, enc_inflate *out);
void enc_inflate_destroy(enc_inflate *inflate);

/* Of a level that is not the last: 0 .. 255. */
uint8_t enc_inflate_level(enc_inflate *inflate, const pmesh_mesh *level);

#endif
