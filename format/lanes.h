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

#endif
