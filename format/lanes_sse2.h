/* SPDX-License-Identifier: MIT */
/* lanes_sse2.h - what lanes.h promises, by SSE2. */
#ifndef PMESH_LANES_SSE2_H
#define PMESH_LANES_SSE2_H

#include <emmintrin.h>
#include <stdint.h>

typedef __m128i lanes;
typedef __m128i quads;

static inline lanes lanes_load(const int16_t *from)
{
    return _mm_loadu_si128((const __m128i *)from);
}

static inline void lanes_store(int16_t *to, lanes a)
{
    _mm_storeu_si128((__m128i *)to, a);
}

static inline lanes lanes_of(int16_t x)
{
    return _mm_set1_epi16(x);
}

static inline lanes lanes_add(lanes a, lanes b)
{
    return _mm_add_epi16(a, b);
}

static inline lanes lanes_sub(lanes a, lanes b)
{
    return _mm_sub_epi16(a, b);
}

static inline lanes lanes_min(lanes a, lanes b)
{
    return _mm_min_epi16(a, b);
}

static inline lanes lanes_max(lanes a, lanes b)
{
    return _mm_max_epi16(a, b);
}

static inline lanes lanes_and(lanes a, lanes b)
{
    return _mm_and_si128(a, b);
}

static inline lanes lanes_left(lanes a, int by)
{
    return _mm_sll_epi16(a, _mm_cvtsi32_si128(by));
}

static inline lanes lanes_right(lanes a, int by)
{
    return _mm_sra_epi16(a, _mm_cvtsi32_si128(by));
}

/* Modulo 2^16. */
static inline lanes lanes_times(lanes a, int16_t by)
{
    return _mm_mullo_epi16(a, _mm_set1_epi16(by));
}

/* Of numbers without sign. */
static inline lanes lanes_half_unsigned(lanes a)
{
    return _mm_srli_epi16(a, 1);
}

/* a b / 2^16 */
static inline lanes lanes_high(lanes a, lanes b)
{
    return _mm_mulhi_epi16(a, b);
}

/* The same of numbers without sign. */
static inline lanes lanes_high_unsigned(lanes a, lanes b)
{
    return _mm_mulhi_epu16(a, b);
}

static inline int lanes_least(lanes a)
{
    a = _mm_min_epi16(a, _mm_srli_si128(a, 8));
    a = _mm_min_epi16(a, _mm_srli_si128(a, 4));
    a = _mm_min_epi16(a, _mm_srli_si128(a, 2));
    return (int16_t)_mm_extract_epi16(a, 0);
}

/* All bits where a < b, none elsewhere. */
static inline lanes lanes_less(lanes a, lanes b)
{
    return _mm_cmplt_epi16(a, b);
}

/* Modulo 2^16. */
static inline int16_t lanes_total(lanes a)
{
    a = _mm_add_epi16(a, _mm_srli_si128(a, 8));
    a = _mm_add_epi16(a, _mm_srli_si128(a, 4));
    a = _mm_add_epi16(a, _mm_srli_si128(a, 2));
    return (int16_t)_mm_extract_epi16(a, 0);
}

static inline quads quads_load(const int32_t *from)
{
    return _mm_loadu_si128((const __m128i *)from);
}

static inline void quads_store(int32_t *to, quads a)
{
    _mm_storeu_si128((__m128i *)to, a);
}

static inline quads quads_of(int32_t x)
{
    return _mm_set1_epi32(x);
}

static inline quads quads_add(quads a, quads b)
{
    return _mm_add_epi32(a, b);
}

static inline quads quads_sub(quads a, quads b)
{
    return _mm_sub_epi32(a, b);
}

static inline quads quads_or(quads a, quads b)
{
    return _mm_or_si128(a, b);
}

static inline quads quads_left(quads a, int by)
{
    return _mm_sll_epi32(a, _mm_cvtsi32_si128(by));
}

static inline quads quads_right(quads a, int by)
{
    return _mm_sra_epi32(a, _mm_cvtsi32_si128(by));
}

static inline quads quads_max(quads a, quads b)
{
    const __m128i more = _mm_cmpgt_epi32(a, b);
    return _mm_or_si128(_mm_and_si128(more, a), _mm_andnot_si128(more, b));
}

static inline quads quads_size(quads a)
{
    const __m128i sign = _mm_srai_epi32(a, 31);
    return _mm_sub_epi32(_mm_xor_si128(a, sign), sign);
}

static inline int32_t quads_total(quads a)
{
    a = _mm_add_epi32(a, _mm_srli_si128(a, 8));
    return _mm_cvtsi128_si32(_mm_add_epi32(a, _mm_srli_si128(a, 4)));
}

static inline uint32_t quads_any(quads a)
{
    a = _mm_or_si128(a, _mm_srli_si128(a, 8));
    return (uint32_t)_mm_cvtsi128_si32(_mm_or_si128(a, _mm_srli_si128(a, 4)));
}

/* a c + b d of the first four lanes, and of the others. */
static inline quads quads_first(lanes a, lanes b, lanes c, lanes d)
{
    return _mm_madd_epi16(_mm_unpacklo_epi16(a, b), _mm_unpacklo_epi16(c, d));
}

static inline quads quads_last(lanes a, lanes b, lanes c, lanes d)
{
    return _mm_madd_epi16(_mm_unpackhi_epi16(a, b), _mm_unpackhi_epi16(c, d));
}

/* Products added up in pairs: which with which is not said. */
static inline quads quads_dot(lanes a, lanes b)
{
    return _mm_madd_epi16(a, b);
}

/* Each within 2^15 - 1. */
static inline lanes lanes_within(quads first, quads last)
{
    return _mm_max_epi16(_mm_packs_epi32(first, last),
                         _mm_set1_epi16(-INT16_MAX));
}

static inline quads quads_min(quads a, quads b)
{
    const __m128i more = _mm_cmpgt_epi32(a, b);
    return _mm_or_si128(_mm_and_si128(more, b), _mm_andnot_si128(more, a));
}

/* Modulo 2^32. */
static inline quads quads_times(quads a, uint32_t by)
{
    const __m128i b = _mm_set1_epi32((int32_t)by);
    const __m128i even = _mm_mul_epu32(a, b);
    const __m128i odd = _mm_mul_epu32(_mm_srli_epi64(a, 32), b);
    return _mm_unpacklo_epi32(_mm_shuffle_epi32(even, 8),
                              _mm_shuffle_epi32(odd, 8));
}

/* a by / 2^32 */
static inline quads quads_high(quads a, uint32_t by)
{
    const __m128i b = _mm_set1_epi32((int32_t)by);
    const __m128i even = _mm_mul_epu32(a, b);
    const __m128i odd = _mm_mul_epu32(_mm_srli_epi64(a, 32), b);
    const __m128i high = _mm_unpacklo_epi32(_mm_shuffle_epi32(even, 13),
                                            _mm_shuffle_epi32(odd, 13));
    return _mm_sub_epi32(high, _mm_and_si128(_mm_srai_epi32(a, 31), b));
}

/* Three numbers in a row, and 0. */
static inline quads quads_triple(const int32_t *from)
{
    return _mm_unpacklo_epi64(_mm_loadl_epi64((const __m128i *)from),
                              _mm_cvtsi32_si128(from[2]));
}

/* The first three columns of eight rows, each within 2^15 - 1. */
static inline void lanes_columns(const quads row[8], lanes column[3])
{
    const __m128i a = lanes_within(row[0], row[1]);
    const __m128i b = lanes_within(row[2], row[3]);
    const __m128i c = lanes_within(row[4], row[5]);
    const __m128i d = lanes_within(row[6], row[7]);
    const __m128i ab = _mm_unpacklo_epi16(a, b), ab2 = _mm_unpackhi_epi16(a, b);
    const __m128i cd = _mm_unpacklo_epi16(c, d), cd2 = _mm_unpackhi_epi16(c, d);
    const __m128i first = _mm_unpacklo_epi16(ab, ab2);
    const __m128i last = _mm_unpacklo_epi16(cd, cd2);
    column[0] = _mm_unpacklo_epi64(first, last);
    column[1] = _mm_unpackhi_epi64(first, last);
    column[2] = _mm_unpacklo_epi64(_mm_unpackhi_epi16(ab, ab2),
                                   _mm_unpackhi_epi16(cd, cd2));
}

#endif
