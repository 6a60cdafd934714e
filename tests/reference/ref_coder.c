/* SPDX-License-Identifier: MIT */
/* SPEC 2 and 6.1: integers, models, the range coder. */
#include "tests/reference/ref.h"

#include <stdlib.h>

/* ---- integers ----------------------------------------------------------- */

int ref_bits(uint64_t x)
{
    int n = 0;
    for (; x > 0; x /= 2)
        n++;
    return n;
}

int64_t ref_shift(int64_t a, int n)
{
    if (n > 62)
        return a < 0 ? -1 : 0;
    const int64_t d = (int64_t)1 << n;
    return a / d - (a % d < 0);
}

int64_t ref_scale(int64_t a, int s)
{
    return s >= 0 ? a * ((int64_t)1 << s) : ref_shift(a, -s);
}

int64_t ref_clamp(int64_t a, int64_t low, int64_t high)
{
    return a < low ? low : a > high ? high : a;
}

int64_t ref_within(int64_t a, int64_t limit)
{
    return ref_clamp(a, -limit, limit);
}

ref_vec ref_add(ref_vec a, ref_vec b)
{
    for (int i = 0; i < 3; i++)
        a.c[i] += b.c[i];
    return a;
}

ref_vec ref_sub(ref_vec a, ref_vec b)
{
    for (int i = 0; i < 3; i++)
        a.c[i] -= b.c[i];
    return a;
}

ref_vec ref_times(ref_vec a, int64_t k)
{
    for (int i = 0; i < 3; i++)
        a.c[i] *= k;
    return a;
}

ref_vec ref_over(ref_vec a, int64_t k)
{
    for (int i = 0; i < 3; i++)
        a.c[i] /= k;
    return a;
}

ref_vec ref_vshift(ref_vec a, int n)
{
    for (int i = 0; i < 3; i++)
        a.c[i] = ref_shift(a.c[i], n);
    return a;
}

ref_vec ref_vscale(ref_vec a, int s)
{
    for (int i = 0; i < 3; i++)
        a.c[i] = ref_scale(a.c[i], s);
    return a;
}

ref_vec ref_vwithin(ref_vec a, int64_t limit)
{
    for (int i = 0; i < 3; i++)
        a.c[i] = ref_within(a.c[i], limit);
    return a;
}

ref_vec ref_cross(ref_vec a, ref_vec b)
{
    return (ref_vec){ { a.c[1] * b.c[2] - a.c[2] * b.c[1],
                        a.c[2] * b.c[0] - a.c[0] * b.c[2],
                        a.c[0] * b.c[1] - a.c[1] * b.c[0] } };
}

int64_t ref_dot(ref_vec a, ref_vec b)
{
    return a.c[0] * b.c[0] + a.c[1] * b.c[1] + a.c[2] * b.c[2];
}

uint64_t ref_or(ref_vec a)
{
    uint64_t all = 0;
    for (int i = 0; i < 3; i++)
        all |= (uint64_t)(a.c[i] < 0 ? -a.c[i] : a.c[i]);
    return all;
}

/* ---- models ------------------------------------------------------------- */

void ref_model_load(ref_model *m, int entry)
{
    *m = entry > 0 ? (ref_model){ 16384 * entry + 8192, 12 }
                   : (ref_model){ 1 << 21, 0 };
}

void ref_model_start(ref_model *m, size_t count)
{
    for (size_t i = 0; i < count; i++)
        ref_model_load(&m[i], 0);
}

void ref_number_start(ref_number *n)
{
    ref_model_start(n->length, 32);
    ref_model_start(n->top[0], 32 * 3);
}

static void learn(ref_model *m, int bit)
{
    const int32_t target = bit ? 0 : (1 << 22) - 1;
    const int64_t rate = 16384 / (2 * m->uses + 3);
    m->p += (int32_t)ref_shift(ref_shift(target - m->p, 3) * rate, 10);
    m->uses = m->uses < 127 ? m->uses + 1 : 127;
}

/* ---- the coder ---------------------------------------------------------- */

static uint32_t next_byte(ref_coder *c)
{
    if (c->next < c->end)
        return *c->next++;
    REF_SEEN(byte_behind_end);
    return 0;
}

/* Four bytes of low leave it from the top. */
static void write_bytes(ref_author *a)
{
    for (int i = 0; i < 4; i++) {
        if (a->size == a->room) {
            a->room = 2 * a->room + 64;
            a->data = realloc(a->data, a->room);
        }
        a->data[a->size++] = (uint8_t)(a->low >> 56);
        a->low <<= 8;
    }
}

/* What carries over is added to the bytes that left. */
static void raise_low(ref_author *a, uint64_t by)
{
    a->low += by;
    if (a->low < by)
        for (size_t i = a->size; i-- > 0 && ++a->data[i] == 0;)
            ;
}

void ref_author_end(ref_author *a)
{
    write_bytes(a);
    write_bytes(a);
}

static void read_bytes(ref_coder *c)
{
    for (int i = 0; i < 4; i++)
        c->code = c->code * 256 + next_byte(c);
}

static void normalise(ref_coder *c)
{
    if (c->range >> 32)
        return;
    c->range <<= 32;
    if (c->author)
        write_bytes(c->author);
    read_bytes(c);
}

void ref_coder_start(ref_coder *c, const uint8_t *data, const uint8_t *end)
{
    *c = (ref_coder){ data, end, UINT64_MAX, 0, c->author };
    for (int i = 0; i < 2; i++)
        read_bytes(c);
}

/* Is code in the upper part, from `bound` on? Goes on with that part. */
static int above(ref_coder *c, uint64_t bound, const ref_model *m)
{
    const int given = c->code >= bound;
    const int bit =
        c->author ? c->author->choose(c->author->user, m, given) : given;
    if (bit && c->author)
        raise_low(c->author, bound);
    if (bit)
        c->code -= bound;
    return bit;
}

static int decide(ref_coder *c, int32_t p, const ref_model *m)
{
    const uint64_t bound = (c->range >> 16) * (uint32_t)(p | 1);
    const int bit = above(c, bound, m);
    c->range = bit ? c->range - bound : bound;
    normalise(c);
    return bit;
}

int ref_bit(ref_coder *c, ref_model *m)
{
    const int bit = decide(c, m->p / 64, m);
    learn(m, bit);
    return bit;
}

int ref_bit2(ref_coder *c, ref_model *m, ref_model *n)
{
    const int bit = decide(c, (m->p / 64 + n->p / 64) / 2, m);
    learn(m, bit);
    learn(n, bit);
    return bit;
}

uint64_t ref_raw(ref_coder *c, int bits)
{
    uint64_t value = 0;
    for (int i = 0; i < bits; i++) {
        c->range /= 2;
        const int bit = above(c, c->range, NULL);
        normalise(c);
        value = 2 * value + (uint64_t)bit;
    }
    return value;
}

uint64_t ref_read_number(ref_coder *c, ref_number *m)
{
    int n = 0, node = 0;
    uint64_t v = 1;
    while (n < 31 && ref_bit(c, &m->length[n]))
        n++;
    for (int i = 1; i <= n; i++) {
        int b;
        if (i <= 2) {
            b = ref_bit(c, &m->top[n][node]);
            node = 1 + b;
        } else {
            REF_SEEN(number_raw);
            b = (int)ref_raw(c, 1);
        }
        v = 2 * v + (uint64_t)b;
    }
    return v - 1;
}

uint64_t ref_uniform(ref_coder *c, uint64_t n)
{
    const int bits = ref_bits(n - 1);
    const int low = bits > 16 ? bits - 16 : 0;
    const uint64_t cells = ((n - 1) >> low) + 1;
    const uint64_t unit = c->range / cells;
    uint64_t high = c->code / unit;
    if (low > 0)
        REF_SEEN(uniform_raw);
    if (high > cells - 1) {
        REF_SEEN(uniform_beyond);
        high = cells - 1;
    }
    if (c->author && c->author->pick) {
        high = c->author->pick(c->author->user, (uint32_t)cells,
                               (uint32_t)high);
        raise_low(c->author, unit * high);
    }
    c->code -= unit * high;
    c->range = high < cells - 1 ? unit : c->range - unit * (cells - 1);
    normalise(c);
    return (high << low) + ref_raw(c, low);
}
