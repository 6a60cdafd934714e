/* SPDX-License-Identifier: MIT */
#include "format/exact.h"

#include <float.h>
#include <string.h>

#include "format/quantize.h"

enum { UNIFORM_BITS = 16 }; /* leaves 8 bits of the range for the quotient */

#define HALF_ULP 0x1p-24 /* of a float, relative: it may lie just outside */

uint64_t pmesh_exact_bind(pmesh_exact *e, const pmesh_grid *grid,
                          const pmesh_form form[3], uint32_t vertices,
                          void *block)
{
    const uint64_t last = 3 * PMESH_EXACT_LAYERS * sizeof *e->last;
    if (!block)
        return last + (uint64_t)vertices * sizeof *e->position;
    *e = (pmesh_exact){ .grid = *grid,
                        .position = (void *)((uint8_t *)block + last),
                        .last = (void *)block };
    memcpy(e->form, form, sizeof e->form);
    memset(e->last, 0, (size_t)last);
    pmesh_bits_init(e->same[0][0], sizeof e->same / sizeof(pmesh_bit));
    pmesh_bits_init(e->raw, sizeof e->raw / sizeof(pmesh_bit));
    return last + (uint64_t)vertices * sizeof *e->position;
}

static unsigned bits_of(uint64_t x)
{
    unsigned bits = 0;
    for (; x > 0; x >>= 1)
        bits++;
    return bits;
}

/* One of n equally likely values, 1 <= n < 2^38. Of many the highest 16 bits
 * are; those below may lead to n or beyond. */
static uint64_t code_uniform(pmesh_coder *c, uint64_t n, uint64_t value)
{
    const unsigned bits = bits_of(n - 1);
    const unsigned low = bits > UNIFORM_BITS ? bits - UNIFORM_BITS : 0;
    const uint32_t count = (uint32_t)((n - 1) >> low) + 1;
    const uint64_t unit = c->range / count;
    uint64_t high = value >> low;

    if (!c->encoding)
        high = c->code / unit < count ? c->code / unit : count - 1;
    pmesh_coder_narrow(c, unit * high,
                       high + 1 < count ? unit
                                        : c->range - unit * (count - 1));
    const uint64_t mask = ((uint64_t)1 << low) - 1;
    return high << low |
           pmesh_code_raw(c, low, (uint32_t)(value & mask));
}

/* The numbers that a coordinate can be: those of its cell, without one that
 * was guessed in vain. */
typedef struct choice {
    int64_t from;
    int64_t count; /* 0 also if the cell has none */
    int64_t hole;  /* place of the guess among them; `count` if it is not */
} choice;

static choice choice_of(const pmesh_form *f, double cell, double step,
                        float guess)
{
    const double reach = step * 0.5 + (cell < 0 ? -cell : cell) * HALF_ULP;
    const int64_t to = pmesh_ordinal_to(f, cell + reach);
    choice c = { .from = pmesh_ordinal_from(f, cell - reach) };
    c.count = to >= c.from ? to - c.from + 1 : 0;
    c.hole = c.count;
    int64_t place;
    if (pmesh_ordinal_of(f, guess, &place) && place >= c.from && place <= to) {
        c.count--;
        c.hole = place - c.from;
    }
    return c;
}

/* The place of `value` in a choice; false if it has none. */
static bool place_of(const choice *c, const pmesh_form *f, float value,
                     int64_t *place)
{
    if (!pmesh_ordinal_of(f, value, place))
        return false;
    *place -= c->from;
    *place -= *place > c->hole;
    return *place >= 0 && *place < c->count;
}

/* 32 bits as they are. */
static bool code_raw(pmesh_coder *coder, float *value)
{
    uint32_t bits;
    memcpy(&bits, value, sizeof bits);
    bits = pmesh_code_raw(coder, 32, bits);
    memcpy(value, &bits, sizeof bits);
    return *value >= -FLT_MAX && *value <= FLT_MAX;
}

static bool code_choice(pmesh_coder *coder, pmesh_bit *raw, const choice *c,
                        const pmesh_form *f, float *value)
{
    int64_t place = 0;
    const bool has_none = coder->encoding && !place_of(c, f, *value, &place);
    if (c->count == 0 || pmesh_code_bit(coder, raw, has_none))
        return code_raw(coder, value);
    place = (int64_t)code_uniform(coder, (uint64_t)c->count, (uint64_t)place);
    *value = pmesh_ordinal_value(f, c->from + place + (place >= c->hole));
    return place < c->count;
}

/* The middle of a cell. A hostile grid may leave the floats. */
static double middle(const pmesh_grid *grid, int axis, int32_t q)
{
    const double x = pmesh_grid_dequantize(grid, axis, q);
    return x >= -FLT_MAX ? x <= FLT_MAX ? x : FLT_MAX : -FLT_MAX;
}

static bool code_axis(pmesh_exact *e, pmesh_coder *coder, int axis,
                      const pmesh_mesh *m)
{
    const pmesh_form *f = &e->form[axis];
    const int32_t q = m->position[e->count][axis];
    const double cell = middle(&e->grid, axis, q);
    uint32_t *last = &e->last[axis * PMESH_EXACT_LAYERS +
                              q % PMESH_EXACT_LAYERS];
    const bool known = *last && m->position[*last - 1][axis] == q;
    const float guess =
        known ? e->position[*last - 1][axis] : (float)cell;
    const choice c = choice_of(f, cell, e->grid.step, guess);
    const unsigned octave = bits_of((uint64_t)c.count);
    pmesh_bit *same = &e->same[axis][known][octave < PMESH_EXACT_CHOICES
                                                ? octave
                                                : PMESH_EXACT_CHOICES - 1];
    float *value = &e->position[e->count][axis];

    *last = e->count + 1;
    if (pmesh_code_bit(coder, same,
                       coder->encoding && pmesh_float_same(*value, guess))) {
        *value = guess;
        return true;
    }
    return code_choice(coder, &e->raw[axis], &c, f, value);
}

bool pmesh_exact_code(pmesh_exact *e, pmesh_coder *coder, const pmesh_mesh *m)
{
    for (int axis = 0; axis < 3; axis++)
        if (!code_axis(e, coder, axis, m))
            return false;
    e->count++;
    return true;
}
