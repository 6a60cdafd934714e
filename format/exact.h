/* SPDX-License-Identifier: MIT */
/*
 * exact.h - the positions of the input, bit for bit: the last layer of a
 * lossless file (SPEC 6.8).
 *
 * The mesh is complete by then, so of every coordinate the grid cell is known,
 * and with it a run of the numbers that the form of its axis allows: often few.
 * Which one of them is it? A guess comes first, the number that the last vertex
 * in the same layer of cells had: parts made by hand lie in planes.
 */
#ifndef PMESH_EXACT_H
#define PMESH_EXACT_H

#include "format/coder.h"
#include "format/mesh.h"
#include "format/ordinal.h"

enum {
    PMESH_EXACT_LAYERS = 4096, /* of each axis: remembered modulo this */
    PMESH_EXACT_CHOICES = 16   /* octaves of how many numbers are possible */
};

typedef struct pmesh_exact {
    pmesh_grid grid;
    pmesh_form form[3];
    pmesh_bit same[3][2][PMESH_EXACT_CHOICES]; /* [axis][layer is known] */
    pmesh_bit raw[3];
    uint32_t count;       /* vertices coded */
    float (*position)[3]; /* per vertex; when encoding, filled beforehand */
    uint32_t *last;       /* per axis and layer: a vertex and 1, or 0 */
} pmesh_exact;

/* Lays the arrays out in `block` (aligned for any object), with no vertex
 * coded, and returns the bytes needed; with block NULL does nothing else. */
uint64_t pmesh_exact_bind(pmesh_exact *e, const pmesh_grid *grid,
                          const pmesh_form form[3], uint32_t vertices,
                          void *block);

/* Codes the next vertex of a complete mesh. False if the stream gives a number
 * that is out of reach or not finite. */
bool pmesh_exact_code(pmesh_exact *e, pmesh_coder *coder, const pmesh_mesh *m);

#endif
