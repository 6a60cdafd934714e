/* SPDX-License-Identifier: MIT */
/*
 * models.h - every adaptive model of a stream. They start from tables and live
 * from the base mesh to the last block. Those of positions and of attributes are
 * apart, as many as a stream needs.
 */
#ifndef PMESH_MODELS_H
#define PMESH_MODELS_H

#include "format/coder.h"
#include "format/fit.h"
#include "format/pmesh.h"
#include "format/tables.h"

enum { PMESH_FAR = 4 }; /* how far off a coordinate was: octaves */

/* Signed residuals of an expected size (SPEC 6.5). */
typedef struct pmesh_residual_bits {
    pmesh_bit zero[PMESH_LEANS];
    pmesh_bit sign[PMESH_LEANS];
    pmesh_bit unary[PMESH_UNARY];
} pmesh_residual_bits; /* in the order of pmesh_tables.residual */

/* Of each bit there are two models: one for all coordinates, one for those at
 * this place (first, second, last) behind one that was as far off as this. */
typedef struct pmesh_residual_model {
    pmesh_residual_bits any[PMESH_SCALES];
    pmesh_residual_bits here[PMESH_SCALES][3][PMESH_FAR];
    pmesh_bit low[PMESH_SCALES][3];
    pmesh_number escape;
} pmesh_residual_model;

/* Mean size of residuals so far, as a fraction of the ring's size, in 1/4096;
 * `uses` as in pmesh_bit. */
typedef struct pmesh_mean {
    uint32_t value;
    uint32_t uses;
} pmesh_mean;

/* What is predicted: the row of the tables. */
typedef enum pmesh_predict_kind {
    PMESH_PREDICT_CHILD = 0,       /* its parent stays where it is */
    PMESH_PREDICT_MOVED_CHILD = 1, /* its parent is yet to move */
    PMESH_PREDICT_MOVED_PARENT = 2 /* its child is known */
} pmesh_predict_kind;

/* Of vertices of one kind. */
typedef struct pmesh_place_models {
    /* Weights of the predictor's terms, along the surface and across it; they
     * start from the tables. */
    pmesh_fit predict[PMESH_PREDICT_CLASSES][PMESH_UNKNOWN][2];
    pmesh_residual_model residual;
    pmesh_mean along[PMESH_PREDICT_CLASSES][PMESH_UNKNOWN][PMESH_IRREGULAR];
    pmesh_mean across[PMESH_ROUGH][PMESH_UNKNOWN];
} pmesh_place_models;

/* Attributes (SPEC 6.6). */
enum {
    PMESH_VALUE_SCALES = 40,
    PMESH_VALUE_CLASSES = 5,  /* known neighbours: 0, 1, 2, 3 or 4, more */
    PMESH_VALUE_SPREADS = 32, /* half octaves of how much they differ */
    PMESH_VALUE_FITS = 3,     /* 0 .. 2, 3 or 4, more neighbours */
    PMESH_SIBLINGS = 3        /* that a wedge is compared with */
};

/* Of an attribute: what its components share. */
typedef struct pmesh_channel_models {
    pmesh_residual_bits any[PMESH_VALUE_SCALES];
    pmesh_bit low[PMESH_VALUE_SCALES][3];
    pmesh_number escape;
    pmesh_bit differs[3][PMESH_SIBLINGS];
} pmesh_channel_models;

/* Of a component. */
typedef struct pmesh_value_models {
    pmesh_residual_bits here[PMESH_VALUE_SCALES];
    pmesh_mean by_spread[PMESH_VALUE_CLASSES][PMESH_VALUE_SPREADS];
    pmesh_mean by_far[PMESH_VALUE_CLASSES][PMESH_FAR + 1];
    pmesh_fit fit[PMESH_VALUE_FITS];
} pmesh_value_models;

typedef struct pmesh_wedge_models {
    pmesh_bit ordinary[3];
    /* By what is known at the other ends of the edges beside a corner. */
    pmesh_bit seam[3][3];
    pmesh_bit corner[4][9];
    pmesh_bit choice[2];
    pmesh_bit material[3];
    pmesh_number pick;
} pmesh_wedge_models;

/* Of joined meshes: see join.c and base.c. */
typedef struct pmesh_join_models {
    pmesh_bit whole[3];    /* a fan is not cut */
    pmesh_bit moves[2][3]; /* but goes to the child */
    pmesh_bit lone[3];     /* a lone face follows */
    pmesh_bit pair, turned, far;
    pmesh_number member;
    pmesh_bit known; /* a fan of the base belongs to a vertex before */
    pmesh_number back;
} pmesh_join_models;

/* What a cut's cost is made of (SPEC 6.4); learns from every cut. Shape in
 * 1/4096 bit, the rest in 1/65536. */
typedef struct pmesh_cut_weights {
    int32_t shape[3][2][PMESH_CUT_TERMS];
    int32_t reach[2][2];
    int32_t degree[PMESH_CUT_DEGREES][2]; /* as wing a, b */
    int32_t state[PMESH_STATES][PMESH_STATES][PMESH_STATES][2];
    int32_t span[2][PMESH_CUT_RINGS][PMESH_CUT_SPANS];
} pmesh_cut_weights;

typedef struct pmesh_models {
    pmesh_bit flag[PMESH_FLAG_CONTEXTS];
    pmesh_bit cut[2][PMESH_CUT_RANKS][PMESH_CUT_ODDS];
    pmesh_cut_weights cut_weights;
    pmesh_bit base[3][2];
    pmesh_number base_vertex;
    pmesh_number base_position;
    pmesh_bit base_sign;
    pmesh_wedge_models wedge;
    pmesh_join_models join;
} pmesh_models;

void pmesh_models_init(pmesh_models *m, const pmesh_tables *start);
void pmesh_place_models_init(pmesh_place_models *m, pmesh_predict_kind kind,
                             const pmesh_tables *start);
void pmesh_channel_models_init(pmesh_channel_models *m,
                               const pmesh_tables *start);
void pmesh_value_models_init(pmesh_value_models *m, const pmesh_tables *start);

#endif
