/* SPDX-License-Identifier: MIT */
/*
 * models.h - every adaptive model of a stream. They start as pmesh_models_init
 * leaves them and live from the base mesh to the last block.
 */
#ifndef PMESH_MODELS_H
#define PMESH_MODELS_H

#include "format/coder.h"
#include "format/pmesh.h"
#include "format/tables.h"

enum {
    PMESH_FLAG_CONTEXTS = 8 * 6 * 5 * 7,
    PMESH_CUT_RANKS = 4,
    PMESH_CUT_ODDS = 32,  /* half octaves of a cut's odds against the rest */
    PMESH_SCALES = 60,    /* half octaves of an expected residual */
    PMESH_UNARY = 14,
    PMESH_IRREGULAR = 5,  /* irregular neighbours: 0 .. 3, more */
    PMESH_ROUGH = 14      /* how far a ring is from plane */
};

/* Signed residuals of an expected size (SPEC 6.5). */
typedef struct pmesh_residual_model {
    pmesh_bit zero[PMESH_SCALES][3];
    pmesh_bit sign[PMESH_SCALES][3];
    pmesh_bit unary[PMESH_SCALES][PMESH_UNARY];
    pmesh_bit low[PMESH_SCALES][3];
    pmesh_number escape;
} pmesh_residual_model;

/* Mean size of residuals so far, as a fraction of the ring's size, in 1/4096;
 * `uses` as in pmesh_bit. */
typedef struct pmesh_mean {
    uint32_t value;
    uint32_t uses;
} pmesh_mean;

typedef struct pmesh_wedge_models {
    pmesh_bit ordinary[3];
    pmesh_bit seam[4];
    pmesh_bit corner[4];
    pmesh_bit choice[8];
    pmesh_bit material[4];
    pmesh_number pick;
} pmesh_wedge_models;

/* What a cut's cost is made of (SPEC 6.4), in 1/4096 bit; starts from the
 * tables and learns from every cut. */
typedef struct pmesh_cut_weights {
    int32_t shape[3][2][5];
    int32_t degree[PMESH_CUT_DEGREES];
    int32_t state[PMESH_STATES][PMESH_STATES][PMESH_STATES];
    int32_t span[2][PMESH_CUT_RINGS][PMESH_CUT_SPANS];
} pmesh_cut_weights;

typedef struct pmesh_models {
    pmesh_bit flag[PMESH_FLAG_CONTEXTS];
    pmesh_bit cut[2][PMESH_CUT_RANKS][PMESH_CUT_ODDS];
    pmesh_cut_weights cut_weights;
    /* Weights of the predictor's terms in 1/65536, see pmesh_predict_weight;
     * they start there and learn from every position. */
    int32_t predict[PMESH_PREDICT_KINDS][PMESH_PREDICT_CLASSES][3]
                   [PMESH_PREDICT_TERMS][2];
    pmesh_residual_model residual[2]; /* of a child, of a moved parent */
    pmesh_mean along[2][PMESH_PREDICT_CLASSES][3][PMESH_IRREGULAR];
    pmesh_mean across[2][PMESH_ROUGH][3];
    pmesh_bit base[3][2];
    pmesh_number base_vertex;
    pmesh_number base_position;
    pmesh_bit base_sign;
    pmesh_wedge_models wedge;
    pmesh_number value[PMESH_MAX_ATTRIBUTES * PMESH_MAX_COMPONENTS][2];
    pmesh_bit value_sign[PMESH_MAX_ATTRIBUTES * PMESH_MAX_COMPONENTS][2];
} pmesh_models;

void pmesh_models_init(pmesh_models *m);

#endif
