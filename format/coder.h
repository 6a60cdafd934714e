/* SPDX-License-Identifier: MIT */
/*
 * coder.h - a binary range coder that runs in either direction.
 *
 * Encoder and decoder must walk through exactly the same models in the same
 * order. So there is one walk: every pmesh_code_*() takes the value to be
 * written and returns the value that is in the stream, which when encoding is
 * the same. Codec code is written once, in format/, and calls these.
 *
 * The arithmetic is the carry-propagating coder of LZMA (Pavlov): 32-bit range,
 * bytes shifted out when it falls below 2^24. Probabilities have 16 bits and
 * are the mean of a fast and a slow estimate (SPEC 6.1).
 */
#ifndef PMESH_CODER_H
#define PMESH_CODER_H

#include "format/cursor.h"

typedef struct pmesh_coder {
    bool encoding;
    uint32_t range;
    uint32_t code;        /* decoding: offset into the range */
    pmesh_cursor in;      /* decoding: reads past the end give 0 and overrun */
    pmesh_writer *out;    /* encoding */
    uint64_t low;         /* encoding: 33 bits, the top one a carry */
    uint64_t pending;     /* encoding: bytes held back for a carry */
    uint8_t cache;        /* encoding: the first of them */
    bool started;         /* encoding: a cache was written out */
} pmesh_coder;

/* Probability that the bit is 0, as two estimates in 1/65536, and how often
 * the model was used (capped). */
typedef struct pmesh_bit {
    uint16_t fast, slow;
    uint16_t uses;
} pmesh_bit;

#define PMESH_BIT_INIT { 32768, 32768, 0 }

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

void pmesh_coder_shift(pmesh_coder *c); /* moves one byte out of `low` */

static inline void pmesh_coder_normalize(pmesh_coder *c)
{
    while (c->range < (1u << 24)) {
        c->range <<= 8;
        if (c->encoding) {
            pmesh_coder_shift(c);
        } else {
            c->code = c->code << 8 | pmesh_get_u8(&c->in);
        }
    }
}

/* Encoding: what has been written so far, in 1/256 bit. */
uint64_t pmesh_coder_spent(const pmesh_coder *c);

/* One adaptive bit. */
unsigned pmesh_code_bit(pmesh_coder *c, pmesh_bit *m, unsigned bit);

/* The same with the mean of two models, which both learn. */
unsigned pmesh_code_bit_twice(pmesh_coder *c, pmesh_bit *m, pmesh_bit *n,
                              unsigned bit);

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
