/* SPDX-License-Identifier: MIT */
/*
 * predict.h - where a new vertex is expected, and how far off that may be
 * (SPEC 6.5).
 */
#ifndef PMESH_PREDICT_H
#define PMESH_PREDICT_H

#include "format/codec.h"

/* What is predicted: the row of pmesh_predict_weight. */
typedef enum pmesh_predict_kind {
    PMESH_PREDICT_CHILD = 0,       /* its parent stays where it is */
    PMESH_PREDICT_MOVED_CHILD = 1, /* its parent is yet to move */
    PMESH_PREDICT_MOVED_PARENT = 2 /* its child is known */
} pmesh_predict_kind;

typedef struct pmesh_prediction {
    int64_t position[3]; /* 1/16 grid steps */
    int32_t normal[3];   /* unit vector in 1/16384; zero if there is none */
    uint32_t size;       /* root mean square radius of the ring, 1/16 steps */
    uint8_t ring_class;  /* < PMESH_PREDICT_CLASSES */
    uint8_t unknown;     /* provisional members: 0, 1, 2 for more */
    uint8_t irregular;   /* neighbours with other than 6 neighbours, at most 4 */
    uint8_t rough;       /* how far the ring is from plane, log classes */
    /* What learning needs: the terms in 1/16 steps, their heights along the
     * normal, and their weights; NULL if the ring was too large. */
    int64_t term[PMESH_PREDICT_TERMS][3], height[PMESH_PREDICT_TERMS];
    int32_t (*weight)[2];
} pmesh_prediction;

/* Predicts the position of x. `partner` is the other vertex of its split, and
 * `partner_position` what is known of it; members of the ring from
 * `provisional` on (by number) have no final position yet. */
void pmesh_predict(pmesh_codec *c, pmesh_predict_kind kind, uint32_t x,
                   uint32_t partner, const int32_t partner_position[3],
                   uint32_t provisional, pmesh_prediction *out);

/* The position turned out to be this: one normalised step of the weights down
 * the gradient of the squared error, along and across the surface apart. */
void pmesh_predict_learn(pmesh_prediction *p, const int32_t position[3]);

/* Integer square root, rounded down. */
uint32_t pmesh_isqrt(uint64_t value);

#endif
