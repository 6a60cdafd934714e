/* SPDX-License-Identifier: MIT */
/*
 * enc_lod_delay.h - contractions of an enc_lod that are legal but had better
 * wait, and by how much dearer that makes them.
 *
 * A quadric is a mean over many planes: a lost horn tip or a dented edge hardly
 * shows there, and a fold not at all. So what comes first by its quadric is
 * looked at once more: how far the surface would be at most from the places
 * around that it has left behind, and what its triangles would look like.
 */
#ifndef ENC_LOD_DELAY_H
#define ENC_LOD_DELAY_H

#include "encoder/enc_lod.h"

/* Places that a vertex remembers: those farthest from the surface. */
#define ENC_LOD_LEFT 2

typedef struct enc_lod_left {
    double place[ENC_LOD_LEFT][3];
    uint32_t count;
} enc_lod_left;

typedef struct enc_lod_delay {
    const enc_lod *lod;
    float (*normal)[3]; /* per face: in the input, unit length, or 0 */
    enc_lod_left *left; /* per vertex: former places of vertices near it */
    double usual;       /* mean over recent contractions of `far` */
    double most;        /* `far` may be so many times that */

    /* Of the pair that was looked at last. */
    double far;          /* squared: the largest distance nearby */
    double least_cosine; /* of the angle between a face and the input's */
    enc_lod_left next;
} enc_lod_delay;

/* at_ends: vertices go nowhere but to the other end. */
pmesh_status enc_lod_delay_create(const enc_lod *lod, bool at_ends,
                                  enc_lod_delay *out);
void enc_lod_delay_destroy(enc_lod_delay *d);

/* How much dearer the contraction of u and v to `place` is to be: at least 1.
 * Looks at the stars of both, and must come before they change. */
double enc_lod_delay_factor(enc_lod_delay *d, uint32_t u, uint32_t v,
                            const double place[3]);

/* The pair that was looked at last becomes `kept`. */
void enc_lod_delay_move(enc_lod_delay *d, uint32_t kept);

#endif
