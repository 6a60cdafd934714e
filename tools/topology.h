/* SPDX-License-Identifier: MIT */
/* topology.h - counts that tell whether a surface is closed, whole and sane. */
#ifndef TOPOLOGY_H
#define TOPOLOGY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tools/asset.h"

/* Vertices of equal position count as one; faces with two equal corners are
 * counted as degenerate and then left out. */
typedef struct topology_report {
    size_t faces;             /* as stored */
    size_t vertices;          /* distinct positions in use */
    size_t boundary_edges;    /* edges of one face */
    size_t nonmanifold_edges; /* edges of three faces or more */
    size_t misoriented_edges; /* both faces run along them the same way */
    size_t components;        /* pieces, connected through vertices */
    size_t degenerate_faces;
    size_t folds; /* edges whose two faces look apart by over 150 degrees */
    long long euler; /* vertices - edges + faces */
} topology_report;

/* For every vertex the first one of the same position. NULL when memory is
 * out; the caller frees it. */
uint32_t *topology_join(const asset *mesh);

/* False when memory is out. */
bool topology_measure(const asset *mesh, topology_report *out);

#endif
