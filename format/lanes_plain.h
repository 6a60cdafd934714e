/* SPDX-License-Identifier: MIT */
/* lanes_plain.h - the same in plain C, which the others must equal. */
#ifndef PMESH_LANES_PLAIN_H
#define PMESH_LANES_PLAIN_H

#include <stdint.h>

typedef struct lanes {
    int16_t x[8];
} lanes;

typedef struct quads {
    int32_t x[4];
} quads;

#define PMESH_EACH(type, count, value)                                         \
    type out;                                                                  \
    for (int i = 0; i < (count); i++)                                          \
        out.x[i] = (value);                                                    \
    return out
#define PMESH_EIGHT(value) PMESH_EACH(lanes, 8, (int16_t)(value))
#define PMESH_FOUR(value)  PMESH_EACH(quads, 4, (int32_t)(value))

static inline lanes lanes_load(const int16_t *from)
{
    PMESH_EIGHT(from[i]);
}

static inline void lanes_store(int16_t *to, lanes a)
{
    for (int i = 0; i < 8; i++)
        to[i] = a.x[i];
}

static inline lanes lanes_of(int16_t x)
{
    PMESH_EIGHT(x);
}

static inline lanes lanes_add(lanes a, lanes b)
{
    PMESH_EIGHT(a.x[i] + b.x[i]);
}

static inline lanes lanes_sub(lanes a, lanes b)
{
    PMESH_EIGHT(a.x[i] - b.x[i]);
}

static inline lanes lanes_min(lanes a, lanes b)
{
    PMESH_EIGHT(a.x[i] < b.x[i] ? a.x[i] : b.x[i]);
}

static inline lanes lanes_max(lanes a, lanes b)
{
    PMESH_EIGHT(a.x[i] > b.x[i] ? a.x[i] : b.x[i]);
}

static inline lanes lanes_and(lanes a, lanes b)
{
    PMESH_EIGHT(a.x[i] & b.x[i]);
}

static inline lanes lanes_left(lanes a, int by)
{
    PMESH_EIGHT((uint32_t)a.x[i] << by);
}

static inline lanes lanes_right(lanes a, int by)
{
    PMESH_EIGHT(a.x[i] >> by);
}

static inline lanes lanes_times(lanes a, int16_t by)
{
    PMESH_EIGHT(a.x[i] * by);
}

static inline lanes lanes_half_unsigned(lanes a)
{
    PMESH_EIGHT((uint16_t)a.x[i] >> 1);
}

/* All bits where a < b, none elsewhere. */
static inline lanes lanes_less(lanes a, lanes b)
{
    PMESH_EIGHT(a.x[i] < b.x[i] ? -1 : 0);
}

static inline lanes lanes_high(lanes a, lanes b)
{
    PMESH_EIGHT(a.x[i] * b.x[i] >> 16);
}

static inline lanes lanes_high_unsigned(lanes a, lanes b)
{
    PMESH_EIGHT((uint32_t)(uint16_t)a.x[i] * (uint16_t)b.x[i] >> 16);
}

static inline int lanes_least(lanes a)
{
    int16_t least = a.x[0];
    for (int i = 1; i < 8; i++)
        least = a.x[i] < least ? a.x[i] : least;
    return least;
}

static inline int16_t lanes_total(lanes a)
{
    int32_t sum = 0;
    for (int i = 0; i < 8; i++)
        sum += a.x[i];
    return (int16_t)sum;
}

static inline quads quads_load(const int32_t *from)
{
    PMESH_FOUR(from[i]);
}

static inline void quads_store(int32_t *to, quads a)
{
    for (int i = 0; i < 4; i++)
        to[i] = a.x[i];
}

static inline quads quads_of(int32_t x)
{
    PMESH_FOUR(x);
}

static inline quads quads_add(quads a, quads b)
{
    PMESH_FOUR((uint32_t)a.x[i] + (uint32_t)b.x[i]);
}

static inline quads quads_sub(quads a, quads b)
{
    PMESH_FOUR((uint32_t)a.x[i] - (uint32_t)b.x[i]);
}

static inline quads quads_or(quads a, quads b)
{
    PMESH_FOUR(a.x[i] | b.x[i]);
}

static inline quads quads_left(quads a, int by)
{
    PMESH_FOUR((uint32_t)a.x[i] << by);
}

static inline quads quads_right(quads a, int by)
{
    PMESH_FOUR(a.x[i] >> by);
}

static inline quads quads_max(quads a, quads b)
{
    PMESH_FOUR(a.x[i] > b.x[i] ? a.x[i] : b.x[i]);
}

static inline quads quads_size(quads a)
{
    PMESH_FOUR(a.x[i] < 0 ? 0 - (uint32_t)a.x[i] : (uint32_t)a.x[i]);
}

static inline int32_t quads_total(quads a)
{
    uint32_t sum = 0;
    for (int i = 0; i < 4; i++)
        sum += (uint32_t)a.x[i];
    return (int32_t)sum;
}

static inline uint32_t quads_any(quads a)
{
    return (uint32_t)(a.x[0] | a.x[1] | a.x[2] | a.x[3]);
}

static inline quads quads_first(lanes a, lanes b, lanes c, lanes d)
{
    PMESH_FOUR((uint32_t)(a.x[i] * c.x[i]) + (uint32_t)(b.x[i] * d.x[i]));
}

static inline quads quads_last(lanes a, lanes b, lanes c, lanes d)
{
    PMESH_FOUR((uint32_t)(a.x[i + 4] * c.x[i + 4]) +
               (uint32_t)(b.x[i + 4] * d.x[i + 4]));
}

static inline quads quads_dot(lanes a, lanes b)
{
    PMESH_FOUR((uint32_t)(a.x[i] * b.x[i]) +
               (uint32_t)(a.x[i + 4] * b.x[i + 4]));
}

static inline int16_t pmesh_within_16(int32_t x)
{
    return (int16_t)(x > INT16_MAX    ? INT16_MAX
                     : x < -INT16_MAX ? -INT16_MAX
                                      : x);
}

static inline lanes lanes_within(quads first, quads last)
{
    PMESH_EIGHT(pmesh_within_16(i < 4 ? first.x[i] : last.x[i - 4]));
}

static inline quads quads_min(quads a, quads b)
{
    PMESH_FOUR(a.x[i] < b.x[i] ? a.x[i] : b.x[i]);
}

static inline quads quads_times(quads a, uint32_t by)
{
    PMESH_FOUR((uint32_t)a.x[i] * by);
}

static inline quads quads_high(quads a, uint32_t by)
{
    PMESH_FOUR((int64_t)a.x[i] * by >> 32);
}

static inline quads quads_triple(const int32_t *from)
{
    PMESH_FOUR(i < 3 ? from[i] : 0);
}

static inline void lanes_columns(const quads row[8], lanes column[3])
{
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 8; i++)
            column[k].x[i] = pmesh_within_16(row[i].x[k]);
}

#undef PMESH_EACH
#undef PMESH_EIGHT
#undef PMESH_FOUR

#endif
