/* SPDX-License-Identifier: MIT */
/*
 * coder.h - a binary range coder that runs in either direction.
 *
 * Encoder and decoder must walk through exactly the same models in the same
 * order. So there is one walk: every pmesh_code_*() takes the value to be
 * written and returns the value that is in the stream, which when encoding is
 * the same. Codec code is written once, in format/, and calls these.
 *
 * The arithmetic is that of LZMA's coder (Pavlov), with carries, on numbers of
 * 64 bits: when the range falls below 2^32, 32 bits are shifted out at once, so
 * that most bits need no more than a comparison. (SPEC 6.1)
 */
#ifndef PMESH_CODER_H
#define PMESH_CODER_H

#include "format/cursor.h"

typedef struct pmesh_coder {
    bool encoding;
    const struct pmesh_relay *relay; /* encoding: see relay.h; or NULL */
    uint64_t range;
    uint64_t code;     /* decoding: offset into the range */
    uint64_t low;      /* encoding: where the range starts */
    pmesh_cursor in;   /* decoding: reads past the end give 0 and overrun */
    pmesh_writer *out; /* encoding */
    size_t start;      /* encoding: where in `out` the stream does */
} pmesh_coder;

/* The highest 22 bits are the probability that the bit is 0, the others how
 * often the model was used (capped): together they are loaded and stored at
 * once. */
typedef struct pmesh_bit {
    uint32_t state;
} pmesh_bit;

enum { PMESH_BIT_USES = 10, PMESH_BIT_MOST_USES = 127 };

/* Probability of a 0 in 1/65536; how often the model was used. */
static inline uint32_t pmesh_bit_odds(const pmesh_bit *m)
{
    return m->state >> 16;
}

static inline uint32_t pmesh_bit_uses(const pmesh_bit *m)
{
    return m->state & ((1u << PMESH_BIT_USES) - 1);
}

void pmesh_bits_init(pmesh_bit *bits, size_t count);

/* Starts from probabilities of a 0 in 1/256, as if each had been seen a few
 * times; even odds, never seen, where the table holds 0. */
void pmesh_bits_start(pmesh_bit *bits, size_t count, const uint8_t *table);

void pmesh_coder_encode(pmesh_coder *c, pmesh_writer *out);
void pmesh_coder_decode(pmesh_coder *c, const uint8_t *data, size_t size);

/* Encoding: writes the last bytes (trailing zeros are left out). Decoding:
 * true if all bytes were used and none was missing by more than the zeros that
 * the encoder leaves out. */
bool pmesh_coder_finish(pmesh_coder *c);

void pmesh_coder_shift(pmesh_coder *c); /* goes on by 32 bits */

/* Encoding: `low` has passed 2^64. */
void pmesh_coder_carry(pmesh_coder *c);

static inline void pmesh_coder_normalize(pmesh_coder *c)
{
    if (c->range < (UINT64_C(1) << 32))
        pmesh_coder_shift(c);
}

/* The range is now `range` from `skip` on. */
static inline void pmesh_coder_narrow(pmesh_coder *c, uint64_t skip,
                                      uint64_t range)
{
    if (c->encoding) {
        c->low += skip;
        if (c->low < skip)
            pmesh_coder_carry(c);
    } else {
        c->code -= skip;
    }
    c->range = range;
    pmesh_coder_normalize(c);
}

/* Encoding: what has been written so far, in 1/256 bit. */
uint64_t pmesh_coder_spent(const pmesh_coder *c);

/* How far an estimate goes towards a new bit: 2 / (2 uses + 3), in 1/8192; and
 * what is added to the uses. */
typedef struct pmesh_bit_rate {
    uint32_t rate, use;
} pmesh_bit_rate;

extern const pmesh_bit_rate pmesh_bit_rates[PMESH_BIT_MOST_USES + 1];

static inline void pmesh_bit_learn(pmesh_bit *m, unsigned bit)
{
    const pmesh_bit_rate *by = &pmesh_bit_rates[pmesh_bit_uses(m)];
    const uint32_t counted = 1u << PMESH_BIT_USES;
    const int32_t one = (1 << (32 - PMESH_BIT_USES)) - 1;
    const int32_t off =
        (((int32_t)bit - 1) & one) - (int32_t)(m->state >> PMESH_BIT_USES);
    const uint32_t step = (uint32_t)(off >> 3) * by->rate;
    m->state += (step & ~(counted - 1)) + by->use;
}

/* One bit that is 0 with probability p / 65536, 0 < p < 65536. Which way it
 * goes nobody can tell, so there is no branch. */
static inline unsigned pmesh_code_odds(pmesh_coder *c, uint32_t p, unsigned bit)
{
    const uint64_t bound = (c->range >> 16) * p;
    if (!c->encoding)
        bit = c->code >= bound;
    const uint64_t one = 0 - (uint64_t)bit;
    pmesh_coder_narrow(c, bound & one,
                       bound + ((c->range - 2 * bound) & one));
    return bit;
}

/* One adaptive bit. */
static inline unsigned pmesh_code_bit(pmesh_coder *c, pmesh_bit *m,
                                      unsigned bit)
{
    bit = pmesh_code_odds(c, pmesh_bit_odds(m) | 1, bit);
    pmesh_bit_learn(m, bit);
    return bit;
}

/* The same with the mean of two models, which both learn. */
static inline unsigned pmesh_code_bit_twice(pmesh_coder *c, pmesh_bit *m,
                                            pmesh_bit *n, unsigned bit)
{
    const uint32_t odds = (pmesh_bit_odds(m) + pmesh_bit_odds(n)) / 2;
    bit = pmesh_code_odds(c, odds | 1, bit);
    pmesh_bit_learn(m, bit);
    pmesh_bit_learn(n, bit);
    return bit;
}

/* `count` <= 32 bits of even odds, the most significant first. */
uint32_t pmesh_code_raw(pmesh_coder *c, unsigned count, uint32_t value);

/* A number of `count` bits by a binary tree of 2^count - 1 models. */
uint32_t pmesh_code_tree(pmesh_coder *c, pmesh_bit *tree, unsigned count,
                         uint32_t value);

/* Any 32-bit number, small ones cheap: adaptive Elias gamma (SPEC 6.1). */
typedef struct pmesh_number {
    pmesh_bit length[32];
    pmesh_bit top[32][3];
} pmesh_number;

void pmesh_number_init(pmesh_number *m);
uint32_t pmesh_code_number(pmesh_coder *c, pmesh_number *m, uint32_t value);

#endif
