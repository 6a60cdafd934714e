/* SPDX-License-Identifier: MIT */
/*
 * enc_batch.h - one batch of contractions: disjoint pairs, cheapest first.
 *
 * The order. All edges that may be joined on the mesh before the batch are
 * sorted by their cost there. A pair is taken if both ends are still free and
 * it may be joined on the mesh as it is now, too. Together the two tests make
 * the pairs independent: whether two disturb each other (opposite sides of a
 * quad that has no diagonal; a ring that would get too small) shows in the one
 * that comes last, and never depends on a third.
 *
 * Of a joined mesh, a pair that enc_join.h is for and the others of the batch
 * share no face, neither one that dies nor one at an end: what dies of the one
 * is not at an end of the other. Then the fans of its ends, all that it depends
 * on, are the same whether others are contracted or not. Only vertices that
 * become one without a face that dies are content with less.
 */
#ifndef ENC_BATCH_H
#define ENC_BATCH_H

#include "encoder/enc_candidate.h"
#include "encoder/enc_join.h"
#include "encoder/enc_near.h"
#include "encoder/enc_quantile.h"
#include "encoder/enc_queue.h"
#include "encoder/enc_reach.h"
#include "encoder/enc_schedule.h"
#include "encoder/enc_surface.h"

typedef struct enc_batch_plan {
    enc_taste taste;
    double share;   /* of the vertices to go, at most */
    uint32_t limit; /* the same as a number */
    bool coherent;  /* prefer pairs parallel to those taken; */
    double turn;    /* what another direction counts, in squared mean edges */
    double guard;   /* take only pairs whose quadric is among this share of
                       the smallest; 1: any */
} enc_batch_plan;

/* What a vertex is in the batch, of a joined mesh: batch_count + 1 if it is. */
typedef struct enc_role {
    uint8_t general;      /* in a general pair, of which a face dies */
    uint8_t wing;         /* of a face that dies, */
    uint8_t general_wing; /* of such a pair */
} enc_role;

/* What another worker than the calling thread writes to. */
typedef struct enc_scratch {
    uint32_t *mark; /* per vertex: see enc_surface */
    uint32_t *fate; /* per wedge: see enc_looks; NULL if that is */
} enc_scratch;

/* A contraction run; batches leave their mark in `out`. */
typedef struct enc_run {
    const enc_mesh *mesh;
    const pmesh_encoder_config *config;
    enc_schedule *out;
    enc_surface surface;
    enc_pricing pricing;
    enc_queue queue;
    enc_quantile quadrics; /* of the edges, the better direction */
    double guard;
    uint8_t *edge_state; /* per half-edge, and then per pair of `near`: what
                            collecting found */
    enc_near near;       /* pairs without an edge; the first `within` of them
                            by the vertices of the mesh */
    uint32_t within;
    bool joins_sheets;   /* edges alone do not lead much further: closest
                            vertices of small sheets are pairs, too */
    bool lets_turn;      /* texture coordinates may turn over: nothing else is
                            left */
    uint8_t *taken;      /* per vertex: batch_count when last in a pair, + 1 */
    enc_role *role;      /* per vertex; NULL unless joined */
    float *drift;        /* per vertex: how far pairs have led from the
                            original there; NULL unless there is a limit */
    uint32_t face_target, vertex_target;
    uint32_t *segment_size; /* per segment of the guide: its vertices; NULL
                               unless segments have shares */
    double error_limit;    /* of a level, in steps */
    bool undone;           /* a batch exceeded it */
    bool too_far;          /* the batch left out a pair because of it */
    double parallel_limit; /* cost up to which parallel pairs are preferred */
    uint32_t tick;         /* candidates seen, for progress */
    bool cancelled;
    bool starved; /* out of memory */
    enc_scratch *scratch;  /* per worker but the first; NULL: there is none */
    struct enc_run *views; /* likewise: see enc_collect.c */
} enc_run;

/* True once the base mesh is reached, the caller has cancelled, or there is no
 * memory left. */
bool enc_run_done(const enc_run *run);

/* Contracts up to plan->limit pairs; appends them to the schedule's list, but
 * not to its batches. Returns their number. */
uint32_t enc_batch_contract(enc_run *run, const enc_batch_plan *plan);

#endif
