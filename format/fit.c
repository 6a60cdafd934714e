/* SPDX-License-Identifier: MIT */
#include "format/fit.h"

#include <string.h>

enum {
    INTERVAL = 4, /* samples between rounds; a power of two */
    FORGET = 5,   /* what a sample counts for falls by 1/32 with each round */
    LARGEST = 1 << 19
};

void pmesh_fit_init(pmesh_fit *f, const int16_t *start, int stride)
{
    memset(f, 0, sizeof *f);
    for (int t = 0; t < PMESH_FIT_TERMS; t++)
        f->weight[t] = f->start[t] = start[t * stride] * 256;
}

/* Where in `pair` (t, j) is; a table, so that loops have constant lengths. */
static const uint8_t place[PMESH_FIT_TERMS][PMESH_FIT_TERMS] = {
    { 0, 1, 3, 6, 10, 15, 21 },     { 1, 2, 4, 7, 11, 16, 22 },
    { 3, 4, 5, 8, 12, 17, 23 },     { 6, 7, 8, 9, 13, 18, 24 },
    { 10, 11, 12, 13, 14, 19, 25 }, { 15, 16, 17, 18, 19, 20, 26 },
    { 21, 22, 23, 24, 25, 26, 27 },
};

/* One row of the sample, which has its first pair at `at`. */
static inline void take_row(pmesh_fit *f, const int32_t *product, int i, int at,
                            int64_t weight)
{
    for (int j = 0; j <= i; j++)
        f->pair[at + j] += weight * product[j];
    f->target[i] += weight * product[PMESH_FIT_TERMS];
}

/* Row by row, so that each has a constant length. */
static void take_in(pmesh_fit *f, const pmesh_sample *s, int64_t weight)
{
    take_row(f, s->product[0], 0, 0, weight);
    take_row(f, s->product[1], 1, 1, weight);
    take_row(f, s->product[2], 2, 3, weight);
    take_row(f, s->product[3], 3, 6, weight);
    take_row(f, s->product[4], 4, 10, weight);
    take_row(f, s->product[5], 5, 15, weight);
    take_row(f, s->product[6], 6, 21, weight);
}

/* `pair` gets the new sums / 2^16. */
static void forget(pmesh_fit *f, int64_t pair[PMESH_FIT_PAIRS])
{
    for (int i = 0; i < PMESH_FIT_PAIRS; i++) {
        f->pair[i] -= f->pair[i] >> FORGET;
        pair[i] = f->pair[i] >> 16;
    }
    for (int i = 0; i < PMESH_FIT_TERMS; i++)
        f->target[i] -= f->target[i] >> FORGET;
}

/* Sums stay below 2^28 x 2^18 x 2^7 = 2^53: shifted, times a weight, and all
 * of them, below 2^59. */
static void improve(pmesh_fit *f, const int64_t pair[PMESH_FIT_PAIRS],
                    int64_t pull)
{
    int64_t weight[PMESH_FIT_TERMS];
    for (int t = 0; t < PMESH_FIT_TERMS; t++)
        weight[t] = f->weight[t];
    for (int t = 0; t < PMESH_FIT_TERMS; t++) {
        const int64_t own = f->pair[place[t][t]];
        int64_t rest = f->target[t];
        for (int j = 0; j < PMESH_FIT_TERMS; j++)
            rest -= pair[place[t][j]] * weight[j];
        rest += (pull >> 16) * (f->start[t] - weight[t]);
        const int64_t step = rest / (((own + pull) >> 16) + 1);
        const int64_t w = weight[t] + step;
        weight[t] = w > LARGEST ? LARGEST : w < -LARGEST ? -LARGEST : w;
        f->weight[t] = (int32_t)weight[t];
    }
}

void pmesh_fit_learn(pmesh_fit *f, const pmesh_sample *s, int32_t weight,
                     int64_t pull)
{
    int64_t pair[PMESH_FIT_PAIRS];
    take_in(f, s, weight);
    if (++f->count % INTERVAL)
        return;
    forget(f, pair);
    improve(f, pair, pull);
}
