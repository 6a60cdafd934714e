/* SPDX-License-Identifier: MIT */
#include "format/fit.h"

#include <string.h>

enum {
    FORGET = 7,   /* a sample counts 1/128 less with each that follows */
    INTERVAL = 1, /* samples between rounds */
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

/* Sums stay below 2^28 x 2^18 x 2^7 = 2^53: shifted, times a weight, and all
 * of them, below 2^59. */
static void improve(pmesh_fit *f, int64_t pull)
{
    for (int t = 0; t < PMESH_FIT_TERMS; t++) {
        const int64_t own = f->pair[place[t][t]];
        int64_t rest = f->target[t];
        for (int j = 0; j < PMESH_FIT_TERMS; j++)
            rest -= (f->pair[place[t][j]] >> 16) * f->weight[j];
        rest += (pull >> 16) * (f->start[t] - f->weight[t]);
        const int64_t step = rest / (((own + pull) >> 16) + 1);
        const int64_t w = f->weight[t] + step;
        f->weight[t] = (int32_t)(w > LARGEST    ? LARGEST
                                 : w < -LARGEST ? -LARGEST
                                                : w);
    }
}

void pmesh_fit_learn(pmesh_fit *f, const pmesh_sample *s, int32_t weight,
                     int64_t pull)
{
    for (int i = 0; i < PMESH_FIT_PAIRS; i++)
        f->pair[i] += (int64_t)weight * s->pair[i] - (f->pair[i] >> FORGET);
    for (int t = 0; t < PMESH_FIT_TERMS; t++)
        f->target[t] +=
            (int64_t)weight * s->target[t] - (f->target[t] >> FORGET);
    f->count++;
    improve(f, pull);
}
