/* SPDX-License-Identifier: MIT */
/*
 * enc_surface.h - the surface while it is being contracted: connectivity that
 * shrinks in place, with the numbers of the enc_mesh it was made from.
 *
 *          left               A pair is known by a half-edge h of it. The child
 *         /    \              vanishes into the parent, and with it the face on
 *     child -> parent         either side; across a boundary stands the ghost,
 *         \    /              one vertex joined to every boundary vertex. The
 *          right              outer vertices of the two faces are the wings.
 *
 * In a joined mesh a vertex may have several fans. Most of what follows is for
 * pairs of vertices with one fan and one edge; the others are for enc_join.h.
 */
#ifndef ENC_SURFACE_H
#define ENC_SURFACE_H

#include <stdbool.h>

#include "encoder/enc_mesh.h"
#include "encoder/enc_sign.h"

/* Instead of a half-edge: this and the number of a vertex. Half-edges are fewer
 * than 2^31. */
#define ENC_AT_VERTEX UINT32_C(0x80000000)

typedef struct enc_surface {
    const enc_mesh *mesh;
    uint32_t *vertex; /* per half-edge: its start; ENC_NONE in dead faces */
    uint32_t *twin;   /* per half-edge; in dead faces its heir, one with the same
                         start, or ENC_AT_VERTEX and that vertex */
    uint32_t *wedge;  /* per corner, NULL without attributes */
    uint32_t *first;  /* per vertex: a half-edge that leaves it, at a boundary
                         the one without twin; ENC_NONE if it is dead */
    uint32_t *fan;    /* per half-edge that starts a fan: where the next one of
                         the vertex starts, or ENC_NONE; NULL unless joined */
    uint32_t *degree; /* per vertex: members of its rings, ghosts included */
    int32_t (*position)[3];
    uint32_t *changed; /* bit per face: a corner of it has moved or become
                          another vertex; enc_reach.h clears them */
    uint32_t vertex_count, face_count; /* alive */
} enc_surface;

/* A directed pair: where the child goes, and the half-edges between the two. */
typedef struct enc_pair {
    uint32_t child, parent;
    uint32_t left;  /* child -> parent, or ENC_NONE at the boundary */
    uint32_t right; /* parent -> child, or ENC_NONE at the boundary */
} enc_pair;

pmesh_status enc_surface_create(const enc_mesh *mesh, enc_surface *out);
void enc_surface_destroy(enc_surface *surface);

static inline uint32_t enc_next(uint32_t h)
{
    return h % 3 == 2 ? h - 2 : h + 1;
}

static inline uint32_t enc_prev(uint32_t h)
{
    return h % 3 == 0 ? h + 2 : h - 1;
}

/*
 * Visits the half-edges that leave v, counter-clockwise:
 *
 *     uint32_t h = s->first[v];
 *     do {
 *         ...
 *         h = enc_turn(s, h);
 *     } while (h != ENC_NONE && h != s->first[v]);
 *
 * At a boundary the last face's enc_prev(h) comes from one more neighbour.
 */
static inline uint32_t enc_turn(const enc_surface *s, uint32_t h)
{
    return s->twin[enc_prev(h)];
}

/* The next corner of a vertex, fan by fan; ENC_NONE behind the last one:
 *
 *     uint32_t start = s->first[v];
 *     for (uint32_t h = start; h != ENC_NONE; h = enc_around(s, &start, h))
 */
static inline uint32_t enc_around(const enc_surface *s, uint32_t *start,
                                  uint32_t h)
{
    h = enc_turn(s, h);
    if (h == ENC_NONE || h == *start)
        *start = h = s->fan ? s->fan[*start] : ENC_NONE;
    return h;
}

static inline uint32_t enc_next_fan(const enc_surface *s, uint32_t start)
{
    return s->fan ? s->fan[start] : ENC_NONE;
}

/* A vertex with several fans counts as one of the boundary. */
static inline bool enc_on_boundary(const enc_surface *s, uint32_t v)
{
    const uint32_t first = s->first[v];
    return s->twin[first] == ENC_NONE || enc_next_fan(s, first) != ENC_NONE;
}

/* Loops over vertices or faces are shared among threads by blocks of so many;
 * small surfaces are not worth it. */
enum { ENC_BLOCK = 1024, ENC_SHARED_VERTICES = 1000 };

static inline uint32_t enc_blocks(const enc_mesh *mesh)
{
    return (mesh->vertex_count + ENC_BLOCK - 1) / ENC_BLOCK;
}

static inline uint32_t enc_block_end(const enc_mesh *mesh, uint32_t block)
{
    const uint32_t end = (block + 1) * ENC_BLOCK;
    return end < mesh->vertex_count ? end : mesh->vertex_count;
}

static inline enc_pool *enc_surface_pool(const enc_surface *s)
{
    return s->vertex_count < ENC_SHARED_VERTICES ? NULL : s->mesh->pool;
}

/* The pair of half-edge h; its child is the start of h, or the end. */
static inline enc_pair enc_surface_pair(const enc_surface *s, uint32_t h,
                                        bool child_is_end)
{
    const uint32_t start = s->vertex[h], end = s->vertex[enc_next(h)];

    if (child_is_end)
        return (enc_pair){ end, start, s->twin[h], h };
    return (enc_pair){ start, end, h, s->twin[h] };
}

/* The other direction of a pair. */
static inline enc_pair enc_pair_back(enc_pair pair)
{
    return (enc_pair){ pair.parent, pair.child, pair.right, pair.left };
}

/*
 * True if contracting h leaves an oriented manifold whose rings have 3 to
 * ENC_MAX_RING members: the two ends have no common neighbours but the wings
 * (link condition, the ghost being a vertex), and a wing has one to spare.
 *
 * What dies is never the last face of a piece, nor does a closed piece get
 * fewer than four: the wings' rings would be too small.
 */
bool enc_surface_can_join(const enc_surface *s, uint32_t h);

/* The same, sooner, if there are signatures of all rings and each vertex has one
 * fan. */
bool enc_surface_can_join_signed(const enc_surface *s, const enc_sign *sign,
                                 uint32_t h);

/* Faces of the fan of a corner, 4 standing for more; *open unless it is closed
 * or has 4. */
uint32_t enc_surface_fan_faces(const enc_surface *s, uint32_t corner,
                               bool *open);

/* Marks a face as dead, without heirs. */
void enc_surface_bury_face(enc_surface *s, uint32_t face);

/* Removes the face of h, gluing its two other sides together; the wing loses
 * its fan there if that was the only face of it. */
void enc_surface_remove_face(enc_surface *s, uint32_t h);

/* True if a face around the pair would turn over or lose its area, were both
 * ends moved to `place`. Faces that have no area already are free. */
bool enc_surface_flips(const enc_surface *s, const enc_pair *pair,
                       const int32_t place[3]);

/*
 * Contracts the pair, which must be one that can be joined; the parent moves
 * to `place`. With attributes, corners of the child get the wedge that
 * wedge_parent[] names for theirs.
 */
void enc_surface_contract(enc_surface *s, const enc_pair *pair,
                          const int32_t place[3], const uint32_t *wedge_parent);

/* Twice the area times the normal of the face of h, with `from` at the start
 * of h: exact up to 2^24 steps, so a face without area gives zeros. */
static inline void enc_surface_normal(const enc_surface *s, uint32_t h,
                                      const int32_t from[3], double out[3])
{
    const int32_t *p = s->position[s->vertex[enc_next(h)]];
    const int32_t *q = s->position[s->vertex[enc_prev(h)]];
    const double a[3] = { (double)(p[0] - from[0]), (double)(p[1] - from[1]),
                          (double)(p[2] - from[2]) };
    const double b[3] = { (double)(q[0] - from[0]), (double)(q[1] - from[1]),
                          (double)(q[2] - from[2]) };

    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

#endif
