/* SPDX-License-Identifier: MIT */
/*
 * enc_reach.h - how far the vertices of the full mesh are from a level.
 *
 * Each is followed from level to level: it was close to a vertex of the finer
 * one, and the faces around the vertex that this has become, or around those
 * from there on that are closer, are where it looks for one that is near
 * enough. What it finds is never closer than the surface is. So the largest of
 * all these distances is a bound for all the vertices, and tight but where the
 * nearest face is not to be reached that way.
 *
 * A vertex need not look on once it is closer than another one, or than the
 * bound of the level before: bounds shall not fall. So it is kept with the face
 * that was close enough, which still is if it has not changed, and mostly is if
 * it has: few look at more than one face.
 *
 * In a joined mesh, vertices of pieces that have vanished do not count.
 *
 * The bound that ends a search grows from vertex to vertex. With several
 * threads there are two ways to the result of one. If nothing depends on a
 * bound, it is found aside, while batches are made and coded, on a copy of the
 * surface where the contractions are done again. If something does, all guess,
 * with the bound as it is when they begin, where each search ends; the few that
 * would end elsewhere by now are made again, one after the other.
 */
#ifndef ENC_REACH_H
#define ENC_REACH_H

#include "encoder/enc_schedule.h"
#include "encoder/enc_surface.h"

typedef struct enc_guess {
    uint32_t beside;
    float below; /* the guess is right as long as the bound is below this */
} enc_guess;

/* A contraction, to be done again: two half-edges, none of a pair for
 * enc_join.h; where the parent goes. */
typedef struct enc_redo {
    uint32_t left, right;
    int32_t place[3];
} enc_redo;

typedef struct enc_reach {
    const enc_mesh *mesh;
    uint32_t *beside; /* per vertex of the full mesh: a half-edge that leaves
                         one of the level, or ENC_AT_VERTEX and that one */
    enc_guess *guess; /* per vertex; NULL without helpers, or if `later` */
    const enc_surface *from; /* what is searched */
    double most;      /* squared, in steps: the bound of the last level */

    bool later;       /* bounds are found later on: enc_reach_later() */
    enc_surface copy; /* then: follows the surface, one level after the other; */
    enc_redo *redo;   /* per contraction; */
    uint32_t *into;   /* per vertex: its parent, once it is none of the copy,
                         or ENC_NONE; */
    enc_schedule made; /* its arrays: the schedule itself may go elsewhere */
} enc_reach;

/* later: no batch depends on the bound of the one before. The surface has no
 * contractions yet. */
pmesh_status enc_reach_create(const enc_surface *surface, bool later,
                              const enc_schedule *made, enc_reach *out);
void enc_reach_destroy(enc_reach *reach);

/* The bound for the surface as it is now, in steps; `made` led to it. Not if
 * bounds are found later. */
double enc_reach_bound(enc_reach *reach, const enc_surface *s,
                       const enc_schedule *made);

/* Only if they are: the next contraction of the schedule. */
void enc_reach_note(enc_reach *reach, uint32_t index, const enc_pair *pair,
                    bool general, const int32_t place[3]);

/* The next batch of the schedule is complete. Its bound will be there when
 * enc_reach_settle() returns. */
void enc_reach_later(enc_reach *reach);
void enc_reach_settle(enc_reach *reach);

/* How far the ends of a pair, where they are now, will be from the faces around
 * them when they are one at `place`; in steps. */
double enc_reach_of_pair(const enc_surface *s, const enc_pair *pair,
                         const int32_t place[3]);

#endif
