/* SPDX-License-Identifier: MIT */
/*
 * tables.h - where the adaptive models of a stream start (SPEC appendix C).
 * Written by tests/train from what the models become on real meshes: a small
 * mesh would end before they had learnt it.
 */
#ifndef PMESH_TABLES_H
#define PMESH_TABLES_H

#include <stdint.h>

enum {
    /* Cuts. */
    PMESH_CUT_TERMS = 2,   /* off-centre, stray */
    PMESH_CUT_DEGREES = 12,
    PMESH_CUT_SPANS = 10,
    PMESH_CUT_RINGS = 14,
    PMESH_CUT_RANKS = 4,
    PMESH_CUT_ODDS = 32,   /* half octaves of a cut's odds against the rest */
    PMESH_STATES = 5,

    /* Flags: valence, neighbours that split, that did not, yet unvisited. */
    PMESH_FLAG_CONTEXTS = 8 * 6 * 5 * 7,

    /* Positions: subset child, moved child, moved parent; class of ring. */
    PMESH_PREDICT_KINDS = 3,
    PMESH_PREDICT_CLASSES = 9,
    PMESH_PREDICT_TERMS = 7,
    PMESH_UNKNOWN = 3,     /* provisional neighbours: 0, 1, more */
    PMESH_IRREGULAR = 5,   /* irregular neighbours: 0 .. 3, more */
    PMESH_ROUGH = 14,      /* how far a ring is from plane */
    PMESH_SCALES = 60,     /* half octaves of an expected residual */
    PMESH_LEANS = 3,       /* where in its cell an expectation lies */
    PMESH_UNARY = 14,
    PMESH_RESIDUAL_BITS = 2 * PMESH_LEANS + PMESH_UNARY
};

/* Innermost index last. Bit models: probability of a 0 in 1/256; 0 stands for
 * even odds, never seen. */
typedef struct pmesh_tables {
    /* Weights of a cut's shape in 1/1024 bit: [closed, open, ghost wing][no
     * newborn in the ring, some][term]. */
    int16_t shape[3 * 2 * PMESH_CUT_TERMS];
    int16_t reach[2 * 2]; /* of wings: [closed, open][..] */
    /* And of what it meets, in 1/256 bit: [wing a, b][...]; [ghost wing]. */
    int16_t degree[2 * PMESH_CUT_DEGREES];
    int16_t state[2 * PMESH_STATES * PMESH_STATES * PMESH_STATES];
    int16_t span[2 * PMESH_CUT_RINGS * PMESH_CUT_SPANS];
    /* Weights of the predictor's terms in 1/256: [kind][class][unknown][term]
     * [along the surface, across it]. */
    int16_t predict[PMESH_PREDICT_KINDS * PMESH_PREDICT_CLASSES *
                    PMESH_UNKNOWN * PMESH_PREDICT_TERMS * 2];
    /* Expected residuals: [child, parent][class][unknown][irregular], and
     * [child, parent][rough][unknown]. */
    uint16_t along[2 * PMESH_PREDICT_CLASSES * PMESH_UNKNOWN *
                   PMESH_IRREGULAR];
    uint16_t across[2 * PMESH_ROUGH * PMESH_UNKNOWN];
    uint8_t flag[PMESH_FLAG_CONTEXTS];
    uint8_t rank[2 * PMESH_CUT_RANKS * PMESH_CUT_ODDS];
    /* [scale][zero, sign by lean; unary]; [scale][node] */
    uint8_t residual[PMESH_SCALES * PMESH_RESIDUAL_BITS];
    uint8_t low[PMESH_SCALES * 3];
} pmesh_tables;

extern const pmesh_tables pmesh_start;

#endif
