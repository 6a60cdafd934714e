/* SPDX-License-Identifier: MIT */
/*
 * enc_measure.h - the two-sided distance of a level and the full mesh, at
 * points spread evenly over both: the same ones on every machine.
 */
#ifndef ENC_MEASURE_H
#define ENC_MEASURE_H

#include "encoder/enc_mesh.h"
#include "encoder/enc_nearest.h"

typedef struct enc_measure {
    enc_nearest full; /* empty: nothing is to be measured */
    double (*sample)[3];
    enc_pool *pool;
} enc_measure;

pmesh_status enc_measure_create(const enc_mesh *mesh, enc_measure *out);
void enc_measure_destroy(enc_measure *measure);

/* In 1 / PMESH_MEASURE_UNIT steps, rounded up: the root of the mean square, of
 * both sides together, and the largest distance. */
pmesh_status enc_measure_level(const enc_measure *measure,
                               const enc_triangles *level, uint32_t *rms,
                               uint32_t *most);

#endif
