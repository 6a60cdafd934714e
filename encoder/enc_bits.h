/* SPDX-License-Identifier: MIT */
/*
 * enc_bits.h - sets of small integers, a bit each.
 */
#ifndef ENC_BITS_H
#define ENC_BITS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

static inline size_t enc_bit_words(size_t count)
{
    return (count + 31) / 32;
}

static inline bool enc_bit_get(const uint32_t *set, size_t i)
{
    return set[i / 32] >> (i % 32) & 1;
}

static inline void enc_bit_put(uint32_t *set, size_t i)
{
    set[i / 32] |= UINT32_C(1) << (i % 32);
}

#endif
