/* SPDX-License-Identifier: MIT */
/*
 * enc_join.h - contractions of any two vertices of a joined mesh: with several
 * fans, with several edges between them, or with none (Popovic, Hoppe 1997).
 *
 * Every face with both vertices dies. A fan of one vertex and a fan of the
 * other that share an edge become one, by the rules of enc_surface.h; all other
 * fans are the parent's as they are. A face that is a fan of its own at all
 * three corners, a lone one, vanishes altogether; so do two that are glued to
 * each other on all sides. A closed fan may come down to two faces here.
 */
#ifndef ENC_JOIN_H
#define ENC_JOIN_H

#include "encoder/enc_surface.h"

enum {
    ENC_MAX_STAR = 64, /* members of all rings of a vertex that takes part */
    ENC_MAX_DYING = ENC_MAX_STAR
};

/* What dies. */
typedef struct enc_link {
    uint32_t count, merged, lone; /* faces; pairs of fans; faces alone */
    uint32_t pair;                /* place of two that are glued, or ENC_NONE */
    uint32_t edge[ENC_MAX_DYING]; /* of each face: between the two vertices */
    bool held[2];  /* the first, the second vertex cannot be the child: a fan of
                      it is open that becomes one with a closed one */
    bool doubles;  /* faces that stay would lie upon each other */
} enc_link;

/* True if the pair of half-edge h is none for enc_surface_can_join(): other
 * fans or edges have to do with it. */
bool enc_join_is_general(const enc_surface *s, uint32_t h);

/* True if h is the lowest half-edge between its two vertices. */
bool enc_join_is_lowest(const enc_surface *s, uint32_t h);

/* True if u and v may become one, and one of them be the child; the edges
 * between them, if any, go to *link. */
bool enc_join_link(const enc_surface *s, uint32_t u, uint32_t v,
                   enc_link *link);

/* As enc_surface_contract(), for a pair with this link. */
void enc_join_contract(enc_surface *s, uint32_t child, uint32_t parent,
                       const enc_link *link, const int32_t place[3],
                       const uint32_t *wedge_parent);

#endif
