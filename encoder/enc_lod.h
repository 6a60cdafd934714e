/* SPDX-License-Identifier: MIT */
/*
 * enc_lod.h - the mesh of pmesh_simplify(): any triangles, in double precision,
 * contracted in place. Nothing is cut: an edge may have any number of faces,
 * a vertex any number of fans.
 *
 * Corner 3 * face + k. The corners of one vertex form a ring of links in no
 * particular order, and so do the ends of its pairs: end 2 * pair + k. Merging
 * two vertices splices rings. Pairs are the edges, one each, however many
 * faces there are.
 *
 * Vertices have the numbers of the input; of those at one position only the
 * least, the root, is alive. The others live on as wedges: a wedge is the input
 * vertex whose attributes a corner has.
 */
#ifndef ENC_LOD_H
#define ENC_LOD_H

#include <stdbool.h>

#include "encoder/enc_mesh.h"

/* A neighbour of the vertex that was surveyed last. */
typedef struct enc_lod_mark {
    uint32_t stamp; /* of the survey; others are stale */
    uint32_t faces; /* over the edge */
    uint32_t wedge_near, wedge_far, material; /* of the first of them */
    bool breaks;    /* wedges or materials differ across the edge */
    bool wing;      /* of the pair in question; see enc_lod_can_join() */
} enc_lod_mark;

/* What a vertex lies on; its pairs along these lines are special. */
enum {
    ENC_LOD_RIM = 1, /* an edge without exactly two faces */
    ENC_LOD_SEAM = 2 /* attributes or materials break */
};

typedef struct enc_lod {
    pmesh_allocator allocator;
    uint32_t vertex_count;    /* of the input */
    uint32_t face_count;      /* of the input */
    uint32_t vertices, faces; /* alive */

    double (*position)[3];
    uint32_t *first_corner;  /* per vertex; ENC_NONE: dead */
    uint32_t *corner_vertex; /* ENC_NONE: dead */
    uint32_t *corner_wedge;
    uint32_t *corner_next;
    const uint32_t *material; /* per face, or NULL; borrowed */

    uint32_t pair_count;
    uint32_t *end_vertex; /* ENC_NONE: dead */
    uint32_t *end_next;
    uint32_t *first_end; /* per vertex; ENC_NONE: none */

    uint8_t *lines; /* per vertex: ENC_LOD_RIM, ENC_LOD_SEAM */
    uint32_t *lone; /* per vertex: its only wedge, or ENC_NONE */
    double (*normal)[3]; /* per vertex: of its faces, summed; see
                            enc_lod_sum_normals() */
    enc_lod_mark *mark;
    uint32_t stamp;
} enc_lod;

/*
 * Takes ownership of nothing, and makes no pairs. `root` names the least vertex
 * at the position of each; `wedge` the input vertex whose attributes count, in
 * place of each. Faces with a root ENC_NONE or two equal ones are left out.
 */
pmesh_status enc_lod_create(const pmesh_allocator *allocator,
                            const uint32_t *indices, uint32_t face_count,
                            const uint32_t *material, uint32_t vertex_count,
                            const uint32_t *root, const uint32_t *wedge,
                            const double (*position)[3], enc_lod *out);

/* Makes pairs of the edges, and `more`, which are no edges. On failure the
 * mesh is still to be destroyed. */
pmesh_status enc_lod_add_pairs(enc_lod *lod, const uint32_t (*more)[2],
                               uint32_t more_count);
void enc_lod_destroy(enc_lod *lod);

static inline uint32_t enc_lod_after(uint32_t corner)
{
    return corner % 3 == 2 ? corner - 2 : corner + 1;
}

static inline uint32_t enc_lod_before(uint32_t corner)
{
    return corner % 3 == 0 ? corner + 2 : corner - 1;
}

/* The corner of vertex v in the face of `corner`, or ENC_NONE. */
static inline uint32_t enc_lod_corner_of(const enc_lod *lod, uint32_t corner,
                                         uint32_t v)
{
    const uint32_t after = enc_lod_after(corner);
    const uint32_t before = enc_lod_before(corner);

    if (lod->corner_vertex[corner] == v)
        return corner;
    if (lod->corner_vertex[after] == v)
        return after;
    return lod->corner_vertex[before] == v ? before : ENC_NONE;
}

/* Twice the area times the normal of a face, with `from` at the corner. */
static inline void enc_lod_normal(const enc_lod *lod, uint32_t corner,
                                  const double from[3], double out[3])
{
    const double *p = lod->position[lod->corner_vertex[enc_lod_after(corner)]];
    const double *q = lod->position[lod->corner_vertex[enc_lod_before(corner)]];
    const double a[3] = { p[0] - from[0], p[1] - from[1], p[2] - from[2] };
    const double b[3] = { q[0] - from[0], q[1] - from[1], q[2] - from[2] };

    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* Walks the corners of v, which must be alive; the body may not change rings:
 *     uint32_t c = lod->first_corner[v];
 *     do { ... } while ((c = lod->corner_next[c]) != lod->first_corner[v]);
 * and so with the ends of its pairs; end ^ 1 is the other end. */

/* Brings normal[v] up to date. */
void enc_lod_sum_normals(enc_lod *lod, uint32_t v);

/* Marks the neighbours of v and brings lines[v] and lone[v] up to date. */
void enc_lod_survey(enc_lod *lod, uint32_t v);

/* The neighbour's mark if it is one of the vertex surveyed last, else NULL. */
static inline const enc_lod_mark *enc_lod_marked(const enc_lod *lod, uint32_t v)
{
    return lod->mark[v].stamp == lod->stamp ? &lod->mark[v] : NULL;
}

/*
 * Contracts a pair: `gone` vanishes into `kept` with the faces and pairs
 * between them. Positions, wedges, lines are the caller's to renew.
 */
void enc_lod_contract(enc_lod *lod, uint32_t pair, uint32_t gone,
                      uint32_t kept);

/* Takes out pairs of faces of v over the same vertices that face opposite
 * ways: what is left of a volume once it is flat. */
void enc_lod_cancel(enc_lod *lod, uint32_t v);

#endif
