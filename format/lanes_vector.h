/* SPDX-License-Identifier: MIT */
/* lanes_vector.h - the same by vectors of gcc and clang. */
#ifndef PMESH_LANES_VECTOR_H
#define PMESH_LANES_VECTOR_H

#include <stdint.h>
#include <string.h>

typedef int16_t lanes __attribute__((vector_size(16)));
typedef int32_t quads __attribute__((vector_size(16)));
typedef uint16_t pmesh_ulanes __attribute__((vector_size(16)));
typedef uint32_t pmesh_uquads __attribute__((vector_size(16)));
typedef int32_t pmesh_wide __attribute__((vector_size(32)));
typedef uint32_t pmesh_uwide __attribute__((vector_size(32)));

#define PMESH_WIDE(a) __builtin_convertvector((a), pmesh_wide)

static inline lanes lanes_load(const int16_t *from)
{
    lanes a;
    memcpy(&a, from, sizeof a);
    return a;
}

static inline void lanes_store(int16_t *to, lanes a)
{
    memcpy(to, &a, sizeof a);
}

static inline lanes lanes_of(int16_t x)
{
    return (lanes){ x, x, x, x, x, x, x, x };
}

static inline lanes lanes_add(lanes a, lanes b)
{
    return (lanes)((pmesh_ulanes)a + (pmesh_ulanes)b);
}

static inline lanes lanes_sub(lanes a, lanes b)
{
    return (lanes)((pmesh_ulanes)a - (pmesh_ulanes)b);
}

static inline lanes lanes_and(lanes a, lanes b)
{
    return a & b;
}

static inline lanes lanes_min(lanes a, lanes b)
{
    const lanes less = (lanes)(a < b);
    return (a & less) | (b & ~less);
}

static inline lanes lanes_max(lanes a, lanes b)
{
    const lanes more = (lanes)(a > b);
    return (a & more) | (b & ~more);
}

static inline lanes lanes_left(lanes a, int by)
{
    return (lanes)((pmesh_ulanes)a << (pmesh_ulanes)lanes_of((int16_t)by));
}

static inline lanes lanes_right(lanes a, int by)
{
    return a >> lanes_of((int16_t)by);
}

static inline lanes lanes_times(lanes a, int16_t by)
{
    return (lanes)((pmesh_ulanes)a * (pmesh_ulanes)lanes_of(by));
}

static inline lanes lanes_half_unsigned(lanes a)
{
    return (lanes)((pmesh_ulanes)a >> (pmesh_ulanes)lanes_of(1));
}

static inline lanes lanes_less(lanes a, lanes b)
{
    return (lanes)(a < b);
}

static inline lanes lanes_high(lanes a, lanes b)
{
    return __builtin_convertvector((PMESH_WIDE(a) * PMESH_WIDE(b)) >> 16,
                                   lanes);
}

static inline lanes lanes_high_unsigned(lanes a, lanes b)
{
    const pmesh_uwide x = __builtin_convertvector((pmesh_ulanes)a, pmesh_uwide);
    const pmesh_uwide y = __builtin_convertvector((pmesh_ulanes)b, pmesh_uwide);
    return (lanes) __builtin_convertvector((x * y) >> 16, pmesh_ulanes);
}

static inline int lanes_least(lanes a)
{
    int16_t least = a[0];
    for (int i = 1; i < 8; i++)
        least = a[i] < least ? a[i] : least;
    return least;
}

static inline int16_t lanes_total(lanes a)
{
    return (int16_t)(a[0] + a[1] + a[2] + a[3] + a[4] + a[5] + a[6] + a[7]);
}

static inline quads quads_load(const int32_t *from)
{
    quads a;
    memcpy(&a, from, sizeof a);
    return a;
}

static inline void quads_store(int32_t *to, quads a)
{
    memcpy(to, &a, sizeof a);
}

static inline quads quads_of(int32_t x)
{
    return (quads){ x, x, x, x };
}

static inline quads quads_add(quads a, quads b)
{
    return (quads)((pmesh_uquads)a + (pmesh_uquads)b);
}

static inline quads quads_sub(quads a, quads b)
{
    return (quads)((pmesh_uquads)a - (pmesh_uquads)b);
}

static inline quads quads_or(quads a, quads b)
{
    return a | b;
}

static inline quads quads_left(quads a, int by)
{
    return (quads)((pmesh_uquads)a << (pmesh_uquads)quads_of(by));
}

static inline quads quads_right(quads a, int by)
{
    return a >> quads_of(by);
}

static inline quads quads_max(quads a, quads b)
{
    const quads more = (quads)(a > b);
    return (a & more) | (b & ~more);
}

static inline quads quads_size(quads a)
{
    const quads sign = a >> 31;
    return quads_sub(a ^ sign, sign);
}

static inline int32_t quads_total(quads a)
{
    const pmesh_uquads u = (pmesh_uquads)a;
    return (int32_t)(u[0] + u[1] + u[2] + u[3]);
}

static inline uint32_t quads_any(quads a)
{
    return (uint32_t)(a[0] | a[1] | a[2] | a[3]);
}

static inline void pmesh_products(lanes a, lanes b, lanes c, lanes d,
                                  quads half[2])
{
    const pmesh_uwide all = (pmesh_uwide)(PMESH_WIDE(a) * PMESH_WIDE(c)) +
                            (pmesh_uwide)(PMESH_WIDE(b) * PMESH_WIDE(d));
    memcpy(half, &all, sizeof all);
}

static inline quads quads_first(lanes a, lanes b, lanes c, lanes d)
{
    quads half[2];
    pmesh_products(a, b, c, d, half);
    return half[0];
}

static inline quads quads_last(lanes a, lanes b, lanes c, lanes d)
{
    quads half[2];
    pmesh_products(a, b, c, d, half);
    return half[1];
}

static inline quads quads_dot(lanes a, lanes b)
{
    const pmesh_wide all = PMESH_WIDE(a) * PMESH_WIDE(b);
    quads half[2];
    memcpy(half, &all, sizeof all);
    return quads_add(half[0], half[1]);
}

static inline quads pmesh_within_16(quads a)
{
    const quads high = quads_of(INT16_MAX), below = (quads)(a < high);
    a = (a & below) | (high & ~below);
    return quads_max(a, quads_of(-INT16_MAX));
}

static inline lanes lanes_within(quads first, quads last)
{
    const quads both[2] = { pmesh_within_16(first), pmesh_within_16(last) };
    pmesh_wide all;
    memcpy(&all, both, sizeof all);
    return __builtin_convertvector(all, lanes);
}

static inline quads quads_min(quads a, quads b)
{
    const quads less = (quads)(a < b);
    return (a & less) | (b & ~less);
}

static inline quads quads_times(quads a, uint32_t by)
{
    return (quads)((pmesh_uquads)a * (pmesh_uquads)quads_of((int32_t)by));
}

static inline quads quads_high(quads a, uint32_t by)
{
    return (quads){ (int32_t)((int64_t)a[0] * by >> 32),
                    (int32_t)((int64_t)a[1] * by >> 32),
                    (int32_t)((int64_t)a[2] * by >> 32),
                    (int32_t)((int64_t)a[3] * by >> 32) };
}

static inline quads quads_triple(const int32_t *from)
{
    return (quads){ from[0], from[1], from[2], 0 };
}

static inline void lanes_columns(const quads row[8], lanes column[3])
{
    for (int k = 0; k < 3; k++) {
        const quads first = { row[0][k], row[1][k], row[2][k], row[3][k] };
        const quads last = { row[4][k], row[5][k], row[6][k], row[7][k] };
        column[k] = lanes_within(first, last);
    }
}

#undef PMESH_WIDE

#endif
