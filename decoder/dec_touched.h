/* SPDX-License-Identifier: MIT */
/*
 * dec_touched.h - which elements of a buffer changed: a bit each, and the few
 * ranges that cover them.
 */
#ifndef DEC_TOUCHED_H
#define DEC_TOUCHED_H

#include <stdbool.h>

#include "decoder/pmesh_decode.h"

typedef struct dec_touched {
    uint32_t *words;
    uint32_t count; /* of words */
} dec_touched;

/* Bytes for `items` bits, a multiple of 16. */
uint64_t dec_touched_size(uint32_t items);

/* Takes `block` of that size, or no memory and no items, and clears it. */
void dec_touched_bind(dec_touched *t, uint32_t items, void *block);

void dec_touched_clear(dec_touched *t);

static inline void dec_touch(dec_touched *t, uint32_t item)
{
    t->words[item >> 5] |= (uint32_t)1 << (item & 31);
}

static inline bool dec_is_touched(const dec_touched *t, uint32_t item)
{
    return t->words[item >> 5] >> (item & 31) & 1;
}

/* Touches first .. end - 1; nothing if end <= first. */
void dec_touch_range(dec_touched *t, uint32_t first, uint32_t end);

/* The first touched item from `from` on, or `end` if there is none below. */
uint32_t dec_touched_next(const dec_touched *t, uint32_t from, uint32_t end);

/* The runs of touched items below `end`; if they are more than
 * PMESH_MAX_RANGES, those with the narrowest gaps between are joined. */
uint32_t dec_touched_ranges(const dec_touched *t, uint32_t end,
                            pmesh_range *ranges);

#endif
