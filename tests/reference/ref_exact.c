/* SPDX-License-Identifier: MIT */
/* SPEC 6.8: exact positions. */
#include "tests/reference/ref.h"

#include <float.h>
#include <math.h>
#include <string.h>

static uint32_t bits_of(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

/* ---- forms and ordinals ------------------------------------------------- */

typedef struct counts {
    int64_t full, first, last, most;
} counts;

static counts counts_of(const ref_form *f)
{
    counts c = { .full = 1 };
    for (int i = 0; i < f->digits; i++)
        c.full *= f->radix;
    c.first = c.full / f->radix;
    c.last = f->radix == 10 ? f->decimals + 22
                            : f->decimals + 128 - f->digits;
    c.most = c.full + c.last * (c.full - c.first) - 1;
    return c;
}

/* 10^n is a binary64 up to 22. */
static double scaled(const ref_form *f, double x, int64_t n)
{
    double power = 1;
    if (f->radix == 2)
        return ldexp(x, (int)n);
    for (int64_t i = 0; i < (n < 0 ? -n : n); i++)
        power *= 10;
    return n >= 0 ? x * power : x / power;
}

typedef double rounding(double t);

static double near(double t)
{
    return floor(t + 0.5);
}

static int64_t ordinal(const ref_form *f, double x, rounding *to)
{
    const counts c = counts_of(f);
    int64_t k = 0;
    while (k <= c.last && scaled(f, x, f->decimals - k) >= (double)c.full)
        k++;
    if (k > c.last) {
        REF_SEEN(ordinal_most);
        return c.most;
    }
    const int64_t m = (int64_t)to(scaled(f, x, f->decimals - k));
    const int64_t o = k == 0 ? m : m + k * (c.full - c.first);
    return o < c.most ? o : c.most;
}

static float number_of(const ref_form *f, int64_t o)
{
    const counts c = counts_of(f);
    int64_t k = 0, m = o;
    if (o < 0)
        return -number_of(f, -1 - o);
    if (o >= c.full) {
        k = 1 + (o - c.full) / (c.full - c.first);
        m = c.first + (o - c.full) % (c.full - c.first);
    }
    return (float)scaled(f, (double)m, k - f->decimals);
}

/* ---- a coordinate ------------------------------------------------------- */

float ref_exact_start(const ref *r, int axis, int64_t q)
{
    double x = r->header.origin[axis] + r->header.step * (double)q;
    if (!(x >= -(double)FLT_MAX))
        x = -(double)FLT_MAX;
    return x > (double)FLT_MAX ? FLT_MAX : (float)x;
}

typedef struct cell {
    int64_t from, to; /* ordinals */
    float guess;      /* where none is known */
} cell;

static cell cell_of(const ref *r, int axis, int64_t q)
{
    const ref_header *h = &r->header;
    const ref_form *f = &h->form[axis];
    double x = h->origin[axis] + h->step * (double)q;
    if (!(x >= -(double)FLT_MAX))
        x = -(double)FLT_MAX;
    if (x > (double)FLT_MAX)
        x = (double)FLT_MAX;
    const double reach = h->step / 2 + fabs(x) / (1 << 24);
    const double low = x - reach, high = x + reach;
    return (cell){ low > 0 ? ordinal(f, low, ceil)
                           : -1 - ordinal(f, reach - x, floor),
                   high >= 0 ? ordinal(f, high, floor)
                             : -1 - ordinal(f, -x - reach, ceil),
                   (float)x };
}

static float read_stray(ref *r)
{
    const uint32_t bits = (uint32_t)ref_raw(&r->in, 32);
    float value;
    memcpy(&value, &bits, sizeof value);
    ref_check(r, isfinite(value), "6.8: a float that is not finite");
    return value;
}

static float read_coordinate(ref *r, uint32_t v, int axis)
{
    ref_exact_models *m = &r->exact_models;
    const ref_form *f = &r->header.form[axis];
    const int64_t q = r->vertex[v].at.c[axis];
    uint32_t *last = &r->exact_last[axis][q % 4096];
    cell c = cell_of(r, axis, q);
    int64_t count = c.to - c.from + 1;
    if (count < 0)
        count = 0;
    const bool known =
        *last != REF_NONE && r->vertex[*last].at.c[axis] == q;
    if (known)
        c.guess = r->vertex[*last].exact[axis];
    *last = v;

    const int64_t near_guess = ordinal(f, fabs((double)c.guess), near);
    const int64_t g = signbit(c.guess) ? -1 - near_guess : near_guess;
    const bool hole = c.from <= g && g <= c.to &&
                      bits_of(number_of(f, g)) == bits_of(c.guess);
    count -= hole;
    const int width = ref_bits((uint64_t)count);
    if (known)
        REF_SEEN(exact_known);
    if (hole)
        REF_SEEN(exact_hole);
    if (ref_bit(&r->in, &m->same[axis][known][width < 15 ? width : 15])) {
        REF_SEEN(exact_same);
        return c.guess;
    }
    if (count == 0) {
        REF_SEEN(exact_nothing_left);
        return read_stray(r);
    }
    if (ref_bit(&r->in, &m->rare[axis])) {
        REF_SEEN(exact_stray);
        return read_stray(r);
    }
    const uint64_t picked = ref_uniform(&r->in, (uint64_t)count);
    ref_check(r, picked < (uint64_t)count, "6.8: a place that is not there");
    const int64_t o = c.from + (int64_t)picked;
    REF_SEEN(exact_uniform);
    return number_of(f, hole && o >= g ? o + 1 : o);
}

void ref_read_exact(ref *r, const uint8_t *data, size_t size)
{
    ref_bytes in = { r, data, data + size, "6.8: the chunk is too short" };
    const uint64_t count = ref_get_varint(&in);
    ref_check(r, count >= 1 && count <= r->vertex_count - r->exact_count,
              "6.8: count");
    ref_coder_start(&r->in, in.next, in.end);
    for (uint64_t i = 0; i < count; i++) {
        const uint32_t v = r->exact_count + (uint32_t)i;
        for (int axis = 0; axis < 3; axis++)
            r->vertex[v].exact[axis] = read_coordinate(r, v, axis);
    }
    ref_check(r, r->in.next == r->in.end, "6.1: bytes that are not used");
    r->exact_count += (uint32_t)count;
}
