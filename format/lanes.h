/* SPDX-License-Identifier: MIT */
/*
 * lanes.h - eight 16-bit or four 32-bit numbers at a time.
 *
 * Rings have six or seven members, and compilers make poor code of loops as
 * short as that. So loops over members take them by eights, in these terms:
 * with SSE2, which every x86-64 has, each is an instruction or a few; elsewhere
 * gcc and clang know vectors (NEON, WebAssembly), and plain C is for all
 * others. All give the same bits: sums and differences are modulo 2^16 or 2^32,
 * right shifts round down. PMESH_LANES chooses one (0 plain, 1 vectors, 2
 * SSE2).
 */
#ifndef PMESH_LANES_H
#define PMESH_LANES_H

#include <stdint.h>

#ifndef PMESH_LANES
#if defined(__SSE2__)
#define PMESH_LANES 2
#elif defined(__GNUC__) && (defined(__ARM_NEON) || defined(__wasm_simd128__))
#define PMESH_LANES 1
#else
#define PMESH_LANES 0
#endif
#endif

enum { LANES = 8, QUADS = 4 };

/* Tells the cache what will be read soon. */
static inline void pmesh_prefetch(const void *at)
{
#if defined(__GNUC__)
    __builtin_prefetch(at);
#else
    (void)at;
#endif
}

#if PMESH_LANES == 2
#include "format/lanes_sse2.h"
#elif PMESH_LANES == 1
#include "format/lanes_vector.h"
#else
#include "format/lanes_plain.h"
#endif

static inline lanes lanes_size(lanes a)
{
    return lanes_max(a, lanes_sub(lanes_of(0), a));
}

/* The place of the first of the least of `count` numbers, which are a multiple
 * of LANES below 2^15 and not all INT16_MAX. Nobody can tell where it is: each
 * lane keeps its own, and there is no branch. */
static inline uint32_t lanes_first_least(const int16_t *x, uint32_t count,
                                         int16_t *least)
{
    static const int16_t lane[LANES] = { 0, 1, 2, 3, 4, 5, 6, 7 };
    lanes low = lanes_load(x), at = lanes_load(lane), here = at;
    for (uint32_t k = LANES; k < count; k += LANES) {
        const lanes next = lanes_load(x + k);
        here = lanes_add(here, lanes_of(LANES));
        at = lanes_max(at, lanes_and(lanes_less(next, low), here));
        low = lanes_min(low, next);
    }
    *least = (int16_t)lanes_least(low);
    const lanes more = lanes_less(lanes_of(*least), low);
    at = lanes_max(at, lanes_and(more, lanes_of(INT16_MAX)));
    return (uint32_t)lanes_least(at);
}

#endif
