/* SPDX-License-Identifier: MIT */
/*
 * enc_sign.h - signatures of rings: a quick answer to "have two neighbours any
 * others in common than these?", which for nearly all edges is no.
 *
 * A ring is two sets of 63 bits, a bit for each member by two ways of hashing;
 * the topmost one tells that two members share a bit. Say the bits that both
 * rings have are those of the wings, and the topmost one is not: then one ring
 * has a bit for each member, and another common member would be another bit.
 * Otherwise nothing is known, as for one edge in fifteen at six neighbours.
 */
#ifndef ENC_SIGN_H
#define ENC_SIGN_H

#include <stdbool.h>
#include <stdint.h>

typedef struct enc_sign {
    uint64_t way[2];
} enc_sign;

#define ENC_SIGN_CLASH (UINT64_C(1) << 63)

/* By the fractional part of v times an irrational number: successive numbers
 * are far from each other. */
static inline enc_sign enc_sign_of(uint32_t v)
{
    const uint64_t a = v * UINT32_C(0x9e3779b1), b = v * UINT32_C(0xb504f333);
    enc_sign sign;

    sign.way[0] = UINT64_C(1) << (a * 63 >> 32);
    sign.way[1] = UINT64_C(1) << (b * 63 >> 32);
    return sign;
}

static inline void enc_sign_add(enc_sign *ring, uint32_t v)
{
    const enc_sign sign = enc_sign_of(v);

    for (int i = 0; i < 2; i++) {
        if (ring->way[i] & sign.way[i])
            ring->way[i] |= ENC_SIGN_CLASH;
        ring->way[i] |= sign.way[i];
    }
}

/* True: rings that both have the members a and b have no others in common; b
 * may be a. */
static inline bool enc_sign_excludes(const enc_sign *ring,
                                     const enc_sign *other, uint32_t a,
                                     uint32_t b)
{
    const enc_sign x = enc_sign_of(a), y = enc_sign_of(b);

    return (ring->way[0] & other->way[0]) == (x.way[0] | y.way[0]) ||
           (ring->way[1] & other->way[1]) == (x.way[1] | y.way[1]);
}

#endif
