/* SPDX-License-Identifier: MIT */
/* SPEC 6.5: how far a position is from its prediction. */
#include "tests/reference/ref.h"

typedef struct axis_state {
    int axis[3]; /* in coding order */
    int64_t n[3], d[3];
    int64_t s, rho, left, lean, V;
} axis_state;

static int64_t absolute(int64_t a)
{
    return a < 0 ? -a : a;
}

static int64_t at_least(int64_t a, int64_t low)
{
    return a > low ? a : low;
}

static ref_expected *along_of(ref_residual_models *m, const ref_prediction *p)
{
    return &m->along[p->class][p->unknown][p->irregular];
}

static ref_expected *across_of(ref_residual_models *m,
                               const ref_prediction *p)
{
    return &m->across[p->rough][p->unknown];
}

static int64_t expected(const ref_expected *e, int64_t size)
{
    return ref_clamp(e->value * size / 4096, 1, 1 << 22);
}

static void order_axes(axis_state *a, ref_vec normal)
{
    int last = 0, k = 0;
    for (int i = 1; i < 3; i++)
        if (absolute(normal.c[i]) >= absolute(normal.c[last]))
            last = i;
    for (int i = 0; i < 3; i++)
        if (i != last)
            a->axis[k++] = i;
    a->axis[2] = last;
    for (k = 0; k < 3; k++)
        a->n[k] = normal.c[a->axis[k]];
}

static void set_ellipsoid(axis_state *a, const ref_prediction *p)
{
    const int64_t s = p->along;
    const int64_t c = ref_clamp(p->across, s / 128 + 1, 4 * s);
    const int64_t q = c * 16384 / s;
    a->s = s;
    a->left = c * c;
    a->rho = 16384 - q * q / 16384;
    if (a->n[2] == 0) {
        a->left = s * s;
        a->rho = 0;
    }
}

/* Mean, less the position, and square of axis k, given those before. */
static void expect(axis_state *a, int k, int64_t *mean, int64_t *square)
{
    const int64_t n = a->n[k];
    *mean = -ref_shift(a->lean * n, 14);
    *square = a->left;
    if (k == 2)
        return;
    a->V = at_least(16384 - ref_shift(ref_shift(a->rho * n, 14) * n, 14), 4096);
    *square = a->s * a->s * a->V / 16384;
}

/* Axis k was `off` its mean. */
static void condition(axis_state *a, int k, int64_t off)
{
    if (k == 2)
        return;
    const int64_t per = (1 << 28) / a->V;
    a->rho = ref_shift(a->rho * per, 14);
    a->left = ref_shift(a->left * per, 14);
    a->lean += ref_shift(ref_shift(a->rho * a->n[k], 14) * off, 14);
}

static int64_t read_size(ref *r, const ref_near *at)
{
    const int shift = at->scale > 11 ? at->scale / 2 - 5 : 0;
    uint64_t size = 0;
    while (size < 14 &&
           ref_bit2(&r->in, &at->any->unary[size], &at->here->unary[size]))
        size++;
    if (size == 14) {
        REF_SEEN(residual_escape);
        size += ref_read_number(&r->in, at->escape);
    }
    for (int i = 0, node = 0; i < shift; i++) {
        int b;
        if (i < 2) {
            REF_SEEN(residual_low);
            b = ref_bit(&r->in, &at->low[node]);
            node = 1 + b;
        } else {
            REF_SEEN(residual_raw);
            b = (int)ref_raw(&r->in, 1);
        }
        size = 2 * size + (uint64_t)b;
    }
    return (int64_t)size + 1;
}

int64_t ref_read_near(ref *r, const ref_near *at)
{
    const int64_t center = ref_shift(at->mean + 8, 4);
    const int64_t off = at->mean - 16 * center;
    const int lean = off < -2 ? 0 : off > 2 ? 2 : 1;
    ref_cell *any = at->any, *here = at->here;
    if (!ref_bit2(&r->in, &any->zero[lean], &here->zero[lean]))
        return center;
    const int minus = ref_bit2(&r->in, &any->sign[lean], &here->sign[lean]);
    const int64_t size = read_size(r, at);
    return minus ? center - size : center + size;
}

static int scale_of(int64_t square)
{
    const int scale = square > 0 ? ref_bits((uint64_t)square) - 1 : 0;
    return scale < 59 ? scale : 59;
}

int ref_how_far(int64_t coordinate, const ref_near *at)
{
    const int64_t z = absolute(16 * coordinate - at->mean);
    const int o =
        z == 0 ? 0 : ref_bits((uint64_t)z * (uint64_t)z) + 3 - at->scale;
    if (z > UINT32_MAX)
        return 3;
    return o < 2 ? 0 : o < 4 ? 1 : o < 6 ? 2 : 3;
}

static void adapt(ref_expected *e, int64_t seen, int64_t size)
{
    if (seen > 64 * size)
        REF_SEEN(ratio_limited);
    seen = seen < 64 * size ? seen : 64 * size;
    const int64_t ratio = seen * (((int64_t)1 << 32) / size) >> 20;
    const int64_t rate = 131072 / (2 * e->uses + 5);
    e->value += (ratio - e->value) * rate / 65536;
    e->uses = e->uses < 60 ? e->uses + 1 : 60;
}

static void adapt_both(ref_residual_models *m, const ref_prediction *p,
                       const axis_state *a)
{
    ref_vec f;
    int64_t dot = 0;
    for (int k = 0; k < 3; k++)
        dot += a->d[k] * a->n[k];
    const int64_t h = ref_shift(dot, 14);
    for (int k = 0; k < 3; k++)
        f.c[k] = a->d[k] - ref_shift(h * a->n[k], 14);
    adapt(across_of(m, p), absolute(h), p->size);
    adapt(along_of(m, p), ref_len(f) * 181 / 256, p->size);
}

ref_vec ref_read_residual(ref *r, ref_prediction *p)
{
    ref_residual_models *m = &r->residual[p->kind == 2];
    axis_state a = { 0 };
    ref_vec at = { 0 };
    int far = 0;
    p->along = expected(along_of(m, p), p->size);
    p->across = expected(across_of(m, p), p->size);
    order_axes(&a, p->normal);
    set_ellipsoid(&a, p);
    for (int k = 0; k < 3; k++) {
        const int axis = a.axis[k];
        int64_t mean, square;
        expect(&a, k, &mean, &square);
        const int scale = scale_of(square);
        const ref_near at_axis = { &m->any[scale], &m->here[scale][k][far],
                                   m->low[scale], &m->escape, scale,
                                   mean + p->position.c[axis] };
        const int64_t c = ref_read_near(r, &at_axis);
        ref_check(r, c >= 0 && c <= r->header.bounds[axis],
                  "6.5: a position out of bounds");
        far = ref_how_far(c, &at_axis);
        a.d[k] = 16 * c - p->position.c[axis];
        at.c[axis] = c;
        condition(&a, k, 16 * c - at_axis.mean);
    }
    adapt_both(m, p, &a);
    return at;
}
