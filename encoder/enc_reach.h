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
 * The bound that ends a search grows from vertex to vertex. Several threads
 * guess, with the bound as it is when they begin, where each search ends; the
 * few that would end elsewhere by now are made again, one after the other. So
 * the result is that of one thread.
 */
#ifndef ENC_REACH_H
#define ENC_REACH_H

#include "encoder/enc_schedule.h"
#include "encoder/enc_surface.h"

typedef struct enc_guess {
    uint32_t beside;
    float below; /* the guess is right as long as the bound is below this */
} enc_guess;

typedef struct enc_reach {
    const enc_mesh *mesh;
    uint32_t *beside; /* per vertex of the full mesh: a half-edge that leaves
                         one of the level, or ENC_AT_VERTEX and that one */
    enc_guess *guess; /* per vertex; NULL without helpers */
    bool later;       /* enc_reach_begin() may be called */
    enc_surface copy; /* then: of the surface */
    const enc_surface *from; /* what is searched: the surface, or the copy */
    double most;      /* squared, in steps: the bound of the last level */
} enc_reach;

/* later: the next batch does not depend on the bound. */
pmesh_status enc_reach_create(const enc_mesh *mesh, bool later, enc_reach *out);
void enc_reach_destroy(enc_reach *reach);

/* The bound for the surface as it is now, in steps; `made` led to it. */
double enc_reach_bound(enc_reach *reach, const enc_surface *s,
                       const enc_schedule *made);

/* The same in two steps, of which the first takes what it needs of the surface:
 * contractions may go on between them, while the others search. The pool is
 * taken until then. */
void enc_reach_begin(enc_reach *reach, const enc_surface *s,
                     const enc_schedule *made);
double enc_reach_end(enc_reach *reach);

/* How far the ends of a pair, where they are now, will be from the faces around
 * them when they are one at `place`; in steps. */
double enc_reach_of_pair(const enc_surface *s, const enc_pair *pair,
                         const int32_t place[3]);

#endif
