/* SPDX-License-Identifier: MIT */
/*
 * predict.h - where a new vertex is expected, and how far off that may be
 * (SPEC 6.5).
 *
 * The prediction is the mean of the ring, corrected by a weighted sum of
 * vectors, the terms, that tell how the surface bends around here; along the
 * surface and across it the weights are others. They follow the stream by least
 * squares (fit.h), apart for each size of ring and number of neighbours that
 * have no final position yet.
 */
#ifndef PMESH_PREDICT_H
#define PMESH_PREDICT_H

#include "format/site.h"

typedef struct pmesh_prediction {
    int64_t position[3]; /* 1/16 grid steps */
    int32_t normal[3];   /* unit vector in 1/16384; zero if there is none */
    uint32_t size;       /* mean radius of the ring, 1/16 steps, at least 16 */
    uint8_t ring_class;  /* < PMESH_PREDICT_CLASSES */
    uint8_t unknown;     /* provisional members: 0, 1, 2 for more */
    uint8_t irregular; /* neighbours with other than 6 neighbours, at most 4 */
    uint8_t rough;     /* how far the ring is from plane, log classes */

    bool blind; /* the ring was too large: there is nothing to weigh or learn */

    /* What is weighed and learnt; in the coordinates of the star (star.h). */
    int shift;
    int32_t base[3];
    int32_t mean[3], corrected[3];
    int16_t term[3][PMESH_FIT_TERMS + 1]; /* by axis; behind them comes what */
    int32_t height[PMESH_FIT_TERMS + 1];  /* they should have added up to */
} pmesh_prediction;

/* A guess at the position of x while its neighbours' are guesses, too. */
void pmesh_guess(const pmesh_codec *c, uint32_t x, const pmesh_ring *ring,
                 int32_t position[3]);

/* What the site of x tells of its position; the ring may be too large. Of its
 * partner, the other vertex of its split, this position is known; members of the
 * ring from `provisional` on (by number) have no final position yet; no partner
 * is. Models are not looked at: the position itself is left to
 * pmesh_predict_weigh(). */
void pmesh_predict(const pmesh_codec *c, uint32_t x, const pmesh_site *site,
                   const int32_t partner_position[3], uint32_t provisional,
                   pmesh_prediction *out);

/* Sums the terms up by their weights so far: the position, within the bounds. */
void pmesh_predict_weigh(const pmesh_place_models *models,
                         const int32_t bounds[3], pmesh_prediction *p);

/* The position turned out to be this, where errors of `along` and `across`
 * (1/16 steps) were expected. */
void pmesh_predict_learn(pmesh_place_models *models, pmesh_prediction *p,
                         const int32_t position[3], uint32_t along,
                         uint32_t across);

/* Moves x, whose ring is given (no members: too large), to a position and
 * corrects its neighbours' sums. */
void pmesh_place(pmesh_codec *c, uint32_t x, const pmesh_ring *ring,
                 const int32_t position[3]);

#endif
