/* SPDX-License-Identifier: MIT */
/*
 * heat.h - numbers at the vertices of a mesh, to be drawn as colours: blue for
 * the least, through green and yellow, to red for the most.
 */
#ifndef HEAT_H
#define HEAT_H

#include <stdbool.h>

#include "tools/asset.h"
#include "tools/guide.h"

typedef enum heat_kind {
    HEAT_NONE,
    HEAT_COST,   /* the least cost of contracting an edge, logarithmic */
    HEAT_ERROR,  /* distance from a level, as a share of the diagonal */
    HEAT_WEIGHTS /* what a guide says, 0 to 1 */
} heat_kind;

typedef struct heat {
    float *value;   /* per vertex, 0 .. 1; NULL: none */
    char blue[24], red[24]; /* what the ends of the scale stand for */
} heat;

/* False when memory is out. A hundredth of the vertices may be beyond red. */
bool heat_of_costs(const asset *mesh, heat *out);
bool heat_of_errors(const asset *mesh, const asset *level, heat *out);
bool heat_of_weights(const asset *mesh, const guide *g, heat *out);
void heat_free(heat *h);

/* Mean and largest distance of the vertices of the mesh from a level, by the
 * area around each. False when memory is out. */
bool heat_distances(const asset *mesh, const asset *level, float *out,
                    double *diagonal);

#endif
