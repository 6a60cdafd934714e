/* SPDX-License-Identifier: MIT */
/*
 * enc_looks.h - what attributes add to the costs of a bake.
 *
 * A face is a plane in 3 + m dimensions, position and m weighted attributes
 * (Garland and Heckbert 1998; see enc_joint.h). In a bake attributes never
 * change: a wedge that goes takes on those of a wedge of the parent, and the
 * parent keeps its own. So the distance from that plane, at a step d in the
 * attributes, is a quadric of the place x alone:
 *
 *     area (|x|^2 + |d|^2 - (e.(x, d))^2 - (f.(x, d))^2),  e, f along the plane
 *
 * What is given here is that without the squared distance from the face in
 * space, which is there already. It is never negative.
 *
 * No triangle of texture coordinates with weight turns over either.
 */
#ifndef ENC_LOOKS_H
#define ENC_LOOKS_H

#include <stdbool.h>

#include "encoder/enc_join.h"
#include "encoder/enc_quadric.h"

typedef struct enc_looks {
    unsigned count; /* m; 0: attributes have no say, and nothing is there */
    float *value;    /* per wedge, m: as lengths, in steps */
    double *frame;   /* per face, as it was when the batch began: area, matrix
                        of the quadric, e and f of 3 + m */
    uint32_t *stale; /* bit per face: it is not as it was then any more */
    uint32_t *fate;  /* per wedge: see enc_looks_expect() */
    bool turns[PMESH_MAX_ATTRIBUTES];    /* channels that must not turn over, */
    uint8_t first[PMESH_MAX_ATTRIBUTES]; /* and their first coded component */
    bool guarded;    /* there is one */
} enc_looks;

/* Takes the weights of the mesh. */
pmesh_status enc_looks_create(const enc_mesh *mesh, enc_looks *out);
void enc_looks_destroy(const enc_mesh *mesh, enc_looks *looks);

/* Another `fate` for a thread of its own: mesh->wedge_count long, or NULL if
 * attributes have no say. False if memory is out. */
bool enc_looks_fate(const enc_looks *looks, const enc_mesh *mesh,
                    uint32_t **fate);

/* Told behind a contraction. */
void enc_looks_contract(enc_looks *looks, const enc_surface *s,
                        uint32_t parent);

/* Takes the faces as they are now, part by part: in any order. */
uint32_t enc_looks_parts(const enc_looks *looks, const enc_mesh *mesh);
void enc_looks_begin(enc_looks *looks, const enc_surface *s, uint32_t part);

/* Finds out where the wedges of the pair's child will go: to be forgotten
 * before others are asked for. */
void enc_looks_expect(const enc_looks *looks, const enc_surface *s,
                      const enc_pair *pair);
void enc_looks_forget(const enc_looks *looks, const enc_surface *s,
                      const enc_pair *pair);

/* Adds what the faces around the child, whose wedges go where they are expected
 * to, say to its quadric; or around the parent, whose wedges stay. `now`: by
 * the surface as it is, else as it was when the batch began. */
void enc_looks_add_child(const enc_looks *looks, const enc_surface *s,
                         uint32_t child, bool now, enc_quadric *q);
void enc_looks_add_parent(const enc_looks *looks, const enc_surface *s,
                          uint32_t parent, bool now, enc_quadric *q);

/* True if texture coordinates around the expected pair's child turn over. */
bool enc_looks_turn(const enc_looks *looks, const enc_surface *s,
                    const enc_pair *pair);

#endif
