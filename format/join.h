/* SPDX-License-Identifier: MIT */
/*
 * join.h - splits of joined meshes, whose vertices may have several fans
 * (SPEC 6.3; Popovic and Hoppe 1997 split vertices of any complex).
 *
 * Each fan of v is cut between v and the child u (SPEC 6.4), or stays with v,
 * or moves to u as a whole. Then there may be lone faces, each a fan of its own
 * at v, at u and at a third vertex: the last face of an open sheet, or the last
 * two of a closed one, back to back.
 */
#ifndef PMESH_JOIN_H
#define PMESH_JOIN_H

#include "format/codec.h"

/* The fans of a vertex, in order. */
struct pmesh_fans {
    uint32_t count;
    uint32_t members; /* of all rings, ghosts included */
    pmesh_ring ring[PMESH_MAX_PARTS];
};

typedef enum pmesh_way {
    PMESH_FAN_CUT = 0,
    PMESH_FAN_STAYS = 1,
    PMESH_FAN_MOVES = 2
} pmesh_way;

typedef enum pmesh_lone {
    PMESH_LONE_FACE = 0,   /* (v, u, third) */
    PMESH_LONE_TURNED = 1, /* (u, v, third) */
    PMESH_LONE_PAIR = 2    /* both, glued to each other on all sides */
} pmesh_lone;

/* Where the fans of a vertex go, and what is new between the two. */
struct pmesh_parting {
    pmesh_way way[PMESH_MAX_PARTS];
    pmesh_cut cut[PMESH_MAX_PARTS];
    uint32_t lone_count;
    pmesh_lone lone[PMESH_MAX_LONE];
    uint32_t third[PMESH_MAX_LONE]; /* their third vertex */
};

/* False, with `fans` unusable, if the rings have more than PMESH_MAX_RING
 * members in all. */
bool pmesh_fans_gather(const pmesh_mesh *m, uint32_t v, pmesh_fans *fans);

/* Codes a split of v and applies it, wedges and materials included. */
pmesh_status pmesh_join_split(pmesh_codec *c, pmesh_coder *coder,
                              const pmesh_oracle *oracle, uint32_t v,
                              const pmesh_fans *fans);

#endif
