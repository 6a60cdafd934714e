/* SPDX-License-Identifier: MIT */
/*
 * enc_quantile.h - "what do so many of these stay below", from a histogram of
 * eight bins an octave. Exact arithmetic: the same on every machine.
 */
#ifndef ENC_QUANTILE_H
#define ENC_QUANTILE_H

#include <math.h>
#include <stdint.h>
#include <string.h>

enum { ENC_QUANTILE_LEAST = -40, ENC_QUANTILE_BINS = 8 * 140 };

typedef struct enc_quantile {
    uint32_t count;
    uint32_t bin[ENC_QUANTILE_BINS]; /* from 2^-40 on; all below in the first */
} enc_quantile;

static inline void enc_quantile_clear(enc_quantile *q)
{
    memset(q, 0, sizeof *q);
}

static inline void enc_quantile_add(enc_quantile *q, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    /* Of a positive double: the exponent and the first three bits of what
     * stands behind the point. */
    const int64_t bin =
        (int64_t)(bits >> 49) - 8 * (1022 + ENC_QUANTILE_LEAST);
    q->bin[value > 0 && bin > 0
               ? (bin < ENC_QUANTILE_BINS ? bin : ENC_QUANTILE_BINS - 1)
               : 0]++;
    q->count++;
}

static inline void enc_quantile_merge(enc_quantile *q, const enc_quantile *more)
{
    for (int i = 0; i < ENC_QUANTILE_BINS; i++)
        q->bin[i] += more->bin[i];
    q->count += more->count;
}

/* The upper end of the bin in which `share` of all values is reached; infinite
 * for share >= 1. */
static inline double enc_quantile_at(const enc_quantile *q, double share)
{
    double seen = 0;
    int bin = 0;
    if (share >= 1)
        return INFINITY;
    for (; bin < ENC_QUANTILE_BINS - 1; bin++) {
        seen += q->bin[bin];
        if (seen >= share * q->count)
            break;
    }
    return ldexp((bin % 8 + 9) / 16.0, bin / 8 + ENC_QUANTILE_LEAST);
}

#endif
