/* SPDX-License-Identifier: MIT */
/*
 * mesh.h - the mesh that encoder and decoder refine in step: half-edge
 * connectivity of an oriented 2-manifold with boundary, and the vertex split.
 *
 * Half-edge h = 3 * face + k runs from corner k to corner k + 1 (mod 3) of its
 * face; it starts at vertex[h]. twin[h] runs the other way in the neighbouring
 * face, or is PMESH_NONE at a boundary. first[v] is a half-edge that starts at
 * v: at a boundary the one without a twin, so that turning counter-clockwise
 * from it meets every face of v's fan.
 *
 *            x1                   turning counter-clockwise around v:
 *          / |                      h -> twin[prev(h)]
 *        x2--v--x0                clockwise:
 *                                   h -> next(twin[h])
 *
 * In a joined mesh a vertex may have several fans: sheets that meet in a point
 * or, vertex by vertex, in an edge. Twins stay in the sheet. Then fan[h] leads
 * from the half-edge where one fan starts to where the vertex' next one does.
 *
 * Storage belongs to the caller; nothing here allocates.
 */
#ifndef PMESH_MESH_H
#define PMESH_MESH_H

#include <stdbool.h>

#include "format/layout.h"
#include "format/pmesh.h"

typedef struct pmesh_mesh {
    uint32_t vertex_count, vertex_capacity;
    uint32_t face_count, face_capacity;
    uint32_t wedge_count, wedge_capacity;

    uint32_t *vertex; /* per half-edge */
    uint32_t *twin;   /* per half-edge */
    uint32_t *first;  /* per vertex */
    uint32_t *fan;    /* per half-edge that starts a fan: the start of the next
                         one, or PMESH_NONE. NULL: each vertex has one fan */
    uint32_t *parent; /* per vertex: split from, PMESH_NONE in the base */
    int32_t (*position)[3];

    /* Attributes: a wedge is a vertex with one tuple of values. Without
     * attributes (value_count 0) wedge is NULL and wedges are vertices. */
    uint32_t *wedge;        /* per half-edge */
    uint32_t *wedge_vertex; /* per wedge */
    uint32_t *wedge_parent; /* per wedge: takes its place one level coarser */
    uint16_t *value;        /* value_count per wedge */
    uint32_t value_count;
    uint32_t *material; /* per face, NULL if there is only one */
    uint32_t material_count;
} pmesh_mesh;

static inline uint32_t pmesh_next(uint32_t h)
{
    return h + 1 - 3 * (h % 3 >> 1);
}

static inline uint32_t pmesh_prev(uint32_t h)
{
    return h + 2 - 3 * ((h % 3 + 1) >> 1);
}

/* The next half-edge of the same start, counter-clockwise; PMESH_NONE behind
 * the last face of a boundary vertex. */
static inline uint32_t pmesh_turn_left(const pmesh_mesh *m, uint32_t h)
{
    return m->twin[pmesh_prev(h)];
}

/* A hash of a half-edge by its ends, for tables of any power of two: all of its
 * bits depend on both, or the edges of a vertex with many would lie in a few
 * runs. */
static inline uint64_t pmesh_edge_hash(uint32_t from, uint32_t to)
{
    uint64_t h = ((uint64_t)from << 32 | to) * 0x9e3779b97f4a7c15u;
    h = (h ^ h >> 32) * 0xd6e8feb86659fd93u;
    return h ^ h >> 32;
}

/*
 * The next corner of a vertex, fan by fan; PMESH_NONE behind the last one:
 *
 *     uint32_t start = m->first[v];
 *     for (uint32_t h = start; h != PMESH_NONE;
 *          h = pmesh_corner_next(m, &start, h))
 */
static inline uint32_t pmesh_corner_next(const pmesh_mesh *m, uint32_t *start,
                                         uint32_t h)
{
    h = pmesh_turn_left(m, h);
    if (h == PMESH_NONE || h == *start)
        *start = h = m->fan ? m->fan[*start] : PMESH_NONE;
    return h;
}

/*
 * The neighbours of v, counter-clockwise from first[v]. Face i lies between
 * neighbours i and i + 1. At a boundary the last neighbour has no face behind
 * it, and the ring is closed by the ghost, which is not listed but counts.
 */
typedef struct pmesh_ring {
    uint32_t count;      /* neighbours */
    uint32_t face_count; /* count, or count - 1 at a boundary */
    bool open;           /* v is on the boundary */
    uint32_t edge[PMESH_MAX_RING];   /* per face: the half-edge from v */
    uint32_t vertex[PMESH_MAX_RING]; /* per neighbour */
} pmesh_ring;

/* The ring of v's first fan. False, with the ring unusable, if neighbours and
 * ghost exceed the bound. */
bool pmesh_ring_gather(const pmesh_mesh *m, uint32_t v, pmesh_ring *ring);

/* The same of a vertex with one fan of which the number of neighbours is known:
 * it goes both ways at once, and what follows waits for neither. */
bool pmesh_ring_gather_known(const pmesh_mesh *m, uint32_t v, uint32_t count,
                             pmesh_ring *ring);

/* Its half-edges alone. */
bool pmesh_ring_list_edges(const pmesh_mesh *m, uint32_t v, uint32_t count,
                           pmesh_ring *ring);

/* The same of the fan that starts at half-edge `start`. */
bool pmesh_ring_gather_fan(const pmesh_mesh *m, uint32_t start,
                           pmesh_ring *ring);

/*
 * Where a ring is cut: the new vertex takes the faces first .. end - 1 (taken
 * cyclically), between the wings ring->vertex[first] and ring->vertex[end].
 * PMESH_NONE as a wing is the ghost: the split runs along the boundary and
 * adds one face instead of two.
 */
typedef struct pmesh_cut {
    uint32_t first, end;
} pmesh_cut;

/* True if the cut is one that SPEC 6.3 allows for this ring. */
bool pmesh_cut_legal(const pmesh_ring *ring, pmesh_cut cut);

/*
 * Splits v: appends vertex u = vertex_count, moves the faces of the cut to it,
 * and appends one face for each wing, (v, a, u) first, then (v, u, b).
 *
 *        b                b           u's ring is a, ..., b, v.
 *      / | \            / | \         Position, wedges and material of what is
 *     |  v  |    ->    |  v--u |      new are left to the caller.
 *      \ | /            \ | /
 *        a                a
 *
 * The ring must be v's, the cut legal, and the capacities sufficient.
 */
void pmesh_mesh_split(pmesh_mesh *m, uint32_t v, const pmesh_ring *ring,
                      pmesh_cut cut);

/*
 * Cuts one fan of v alone: u, not yet counted, gets its part of the faces. The
 * starts of both parts go to start_v and start_u; into the lists of v and u
 * they are left to the caller to put.
 */
void pmesh_mesh_cut(pmesh_mesh *m, uint32_t v, uint32_t u,
                    const pmesh_ring *ring, pmesh_cut cut, uint32_t *start_v,
                    uint32_t *start_u);

/* Appends a face and returns its first half-edge. Its twins are left to the
 * caller. */
uint32_t pmesh_mesh_add_face(pmesh_mesh *m, uint32_t a, uint32_t b, uint32_t c);

/* Appends the fan that starts at half-edge h to the list of vertex v; false,
 * with nothing done, if v has PMESH_MAX_FANS fans. Of joined meshes only. */
bool pmesh_fan_append(pmesh_mesh *m, uint32_t v, uint32_t h);

/* NULL if connectivity is sound, else the rule that is broken: twins mutual and
 * opposite, first[] and fan[] as promised, every face of a vertex in its one
 * fan, or in one of its fans, three different vertices per face. For tests and
 * for a decoded base mesh; `seen` holds 3 * face_count bytes. */
const char *pmesh_mesh_check(const pmesh_mesh *m, uint8_t *seen);

#endif
