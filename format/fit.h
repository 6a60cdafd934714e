/* SPDX-License-Identifier: MIT */
/*
 * fit.h - weights that follow a stream of samples by least squares (SPEC 6.5).
 *
 * The weights w shall bring sum w_t f_t close to a target. The sums of f_t f_j
 * and of f_t times the target are kept and forgotten slowly; with each sample
 * each weight in turn is set to what is best given the others (Gauss-Seidel).
 * The weights change so little from sample to sample that one round is as good
 * as solving the equations. A pull towards the starting weights keeps
 * directions that were never seen at rest.
 */
#ifndef PMESH_FIT_H
#define PMESH_FIT_H

#include <stdint.h>

enum {
    PMESH_FIT_TERMS = 7,
    PMESH_FIT_PAIRS = PMESH_FIT_TERMS * (PMESH_FIT_TERMS + 1) / 2
};

typedef struct pmesh_fit {
    int32_t weight[PMESH_FIT_TERMS + 1]; /* in 1/65536, |weight| <= 8; and 0 */
    int32_t start[PMESH_FIT_TERMS];
    int64_t pair[PMESH_FIT_PAIRS]; /* (0,0) (1,0) (1,1) (2,0) ... */
    int64_t target[PMESH_FIT_TERMS];
    uint32_t count; /* samples so far */
} pmesh_fit;

/* A sample: products of its terms (those of term i and j <= i count) and, last,
 * of term and target; below 2^28. */
typedef struct pmesh_sample {
    int32_t product[PMESH_FIT_TERMS][PMESH_FIT_TERMS + 1];
} pmesh_sample;

/* Starts at the given weights, in 1/256, `stride` numbers apart. */
void pmesh_fit_init(pmesh_fit *f, const int16_t *start, int stride);

/* Takes a sample in that counts `weight` <= 2^18; the pull to the start counts
 * `pull` < 2^32. */
void pmesh_fit_learn(pmesh_fit *f, const pmesh_sample *s, int32_t weight,
                     int64_t pull);

#endif
