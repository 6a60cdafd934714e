/* SPDX-License-Identifier: MIT */
/*
 * tables.h - trained constants of the predictors (SPEC appendix C).
 */
#ifndef PMESH_TABLES_H
#define PMESH_TABLES_H

#include <stdint.h>

enum {
    PMESH_CUT_DEGREES = 12,
    PMESH_CUT_SPANS = 10,
    PMESH_CUT_RINGS = 14,
    PMESH_STATES = 5
};

/* Costs in 1/16 bit. Shape: [closed, open, ghost wing][no newborn in the ring,
 * some][spread, off-centre, reach, wing angle, stray]. */
extern const int16_t pmesh_cut_shape[3][2][5];
extern const int16_t pmesh_cut_degree[PMESH_CUT_DEGREES];
extern const int16_t
    pmesh_cut_state[PMESH_STATES][PMESH_STATES][PMESH_STATES];
extern const int16_t
    pmesh_cut_span[2][PMESH_CUT_RINGS][PMESH_CUT_SPANS];

/* 65536 x 2^(-i / 16), rounded. */
extern const uint32_t pmesh_cut_share[16];

/* Weights in 1/256 of the terms that correct a ring's mean to a position
 * (SPEC 6.5): [subset child, moved child, moved parent][class of ring]
 * [provisional members 0, 1, more][term][along the surface, across it]. */
enum { PMESH_PREDICT_KINDS = 3, PMESH_PREDICT_CLASSES = 9,
       PMESH_PREDICT_TERMS = 6 };
extern const int16_t pmesh_predict_weight[PMESH_PREDICT_KINDS]
                                         [PMESH_PREDICT_CLASSES][3]
                                         [PMESH_PREDICT_TERMS][2];

#endif
