/* SPDX-License-Identifier: MIT */
/*
 * corners.h - one index per corner, as graphics APIs want it: distinct pairs
 * of a position and its attribute values become points.
 */
#ifndef CORNERS_H
#define CORNERS_H

#include "tools/asset.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct corners {
    uint32_t *points; /* per face corner, < count */
    uint32_t *first;  /* per point, a corner that shows it */
    size_t count;
} corners;

/* Positions are told apart by number, attributes by value. Points are numbered
 * in order of appearance. False (out empty): out of memory. */
bool corners_unify(const asset *mesh, corners *out);
void corners_free(corners *c);

/* The values of an attribute at a corner. */
const float *corners_values(const asset *mesh, const asset_attribute *attribute,
                            size_t corner);

#ifdef __cplusplus
}
#endif
#endif
