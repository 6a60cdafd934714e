/* SPDX-License-Identifier: MIT */
#include "decoder/dec_touched.h"

#include <string.h>

uint64_t dec_touched_size(uint32_t items)
{
    return ((uint64_t)items + 127) / 128 * 16;
}

void dec_touched_bind(dec_touched *t, uint32_t items, void *block)
{
    t->words = (uint32_t *)block;
    t->count = block ? (items + 31) / 32 : 0;
    dec_touched_clear(t);
}

void dec_touched_clear(dec_touched *t)
{
    if (t->count > 0)
        memset(t->words, 0, t->count * sizeof *t->words);
}

void dec_touch_range(dec_touched *t, uint32_t first, uint32_t end)
{
    for (; first < end && first % 32 > 0; first++)
        dec_touch(t, first);
    for (; first < end && end - first >= 32; first += 32)
        t->words[first / 32] = UINT32_MAX;
    for (; first < end; first++)
        dec_touch(t, first);
}

/* The first item from `from` on whose bit, changed by `flip`, is set. */
static uint32_t next_bit(const dec_touched *t, uint32_t from, uint32_t end,
                         uint32_t flip)
{
    while (from < end) {
        uint32_t rest = (t->words[from >> 5] ^ flip) >> (from & 31);
        if (rest == 0) {
            const uint32_t step = 32 - (from & 31);
            if (step >= end - from)
                return end;
            from += step;
            continue;
        }
        for (; !(rest & 1); rest >>= 1)
            from++;
        return from < end ? from : end;
    }
    return end;
}

uint32_t dec_touched_next(const dec_touched *t, uint32_t from, uint32_t end)
{
    return next_bit(t, from, end, 0);
}

static uint32_t gap_before(const pmesh_range *r)
{
    return r->first - (r - 1)->first - (r - 1)->count;
}

/* Which of the ranges behind the first follows the narrowest gap. */
static uint32_t narrowest(const pmesh_range *ranges, uint32_t count)
{
    uint32_t best = 1;
    for (uint32_t i = 2; i < count; i++)
        if (gap_before(ranges + i) < gap_before(ranges + best))
            best = i;
    return best;
}

static void join(pmesh_range *ranges, uint32_t count, uint32_t i)
{
    ranges[i - 1].count =
        ranges[i].first + ranges[i].count - ranges[i - 1].first;
    memmove(ranges + i, ranges + i + 1, (count - i - 1) * sizeof *ranges);
}

/* The widest gaps stay: a run whose gap is no wider than all that are kept is
 * joined at once, so that the search for the narrowest is rare. */
uint32_t dec_touched_ranges(const dec_touched *t, uint32_t end,
                            pmesh_range *ranges)
{
    uint32_t count = 0, least = 0;
    for (uint32_t at = dec_touched_next(t, 0, end); at < end;) {
        const uint32_t stop = next_bit(t, at, end, UINT32_MAX);
        pmesh_range *last = ranges + count - 1; /* if count > 0 */
        const bool full = count == PMESH_MAX_RANGES;
        if (full && at - last->first - last->count <=
                        gap_before(ranges + least)) {
            last->count = stop - last->first;
        } else {
            if (full)
                join(ranges, count--, least);
            ranges[count++] = (pmesh_range){ at, stop - at };
            if (count == PMESH_MAX_RANGES)
                least = narrowest(ranges, count);
        }
        at = dec_touched_next(t, stop, end);
    }
    return count;
}
