/* SPDX-License-Identifier: MIT */
#include "format/residual.h"

#include "format/star.h"

enum {
    FRACTION_BITS = 4,
    FRACTION = 16,
    ONE_BITS = 14, /* of normals and of variances relative to `along` */
    ONE = 1 << ONE_BITS,
    MEAN_BITS = 12, /* of pmesh_mean */
    MEAN_USES = 60,
    MOST_SEEN = 64,  /* times the size of the ring */
    FLATTEST = 7,    /* across is taken as along / 2^7 at least */
    LOW_MODELS = 3
};

#define LARGEST (1u << 22) /* of expected residuals */

/* Half octaves: 2 log2(value), rounded down; for value >= 1. */
static unsigned half_octave(uint64_t value)
{
    return pmesh_bit_length(value * value) - 1;
}

/* What a coordinate is coded with: its place among the three, how far off the
 * one before was, its mean (1/16 steps) and the scale of what is left. */
typedef struct coordinate {
    unsigned place, far, scale;
    int64_t mean;
} coordinate;

/* Of Golomb's bins, half a deviation wide; the rest of the bits below. */
static uint64_t code_size(pmesh_coder *coder, const pmesh_expectation *at,
                          uint64_t size)
{
    /* The deviation is 2^(scale/2 - 4) steps. */
    const unsigned shift = at->scale > 11 ? at->scale / 2 - 5 : 0;
    const uint64_t bin = size >> shift;
    uint32_t q = 0, node = 0;
    while (q < PMESH_UNARY &&
           pmesh_code_bit_twice(coder, &at->any->unary[q], &at->here->unary[q],
                                bin > q))
        q++;
    if (q == PMESH_UNARY)
        q += pmesh_code_number(coder, at->escape,
                               (uint32_t)(bin - PMESH_UNARY));
    uint64_t result = q;
    unsigned i = shift;
    for (; i > 0 && i + 2 > shift; i--) {
        const unsigned got =
            pmesh_code_bit(coder, &at->low[node], size >> (i - 1) & 1);
        node = 1 + got;
        result = result << 1 | got;
    }
    const uint32_t rest = (uint32_t)(size & (((uint64_t)1 << i) - 1));
    return result << i | pmesh_code_raw(coder, i, rest);
}

int64_t pmesh_code_near(pmesh_coder *coder, const pmesh_expectation *at,
                        int64_t value)
{
    const int64_t center = (at->mean + FRACTION / 2) >> FRACTION_BITS;
    const int64_t part = at->mean - center * FRACTION; /* -8 .. 7 */
    const unsigned lean = (unsigned)(part >= -2) + (part > 2);
    const int64_t r = value - center;

    if (!pmesh_code_bit_twice(coder, &at->any->zero[lean],
                              &at->here->zero[lean], r != 0))
        return center;
    const unsigned negative = pmesh_code_bit_twice(
        coder, &at->any->sign[lean], &at->here->sign[lean], r < 0);
    const int64_t size =
        1 + (int64_t)code_size(coder, at, (uint64_t)(r < 0 ? -r : r) - 1);
    return negative ? center - size : center + size;
}

/* Codes the difference from the rounded mean. */
static int64_t code_coordinate(pmesh_coder *coder, pmesh_residual_model *m,
                               const coordinate *at, int64_t value)
{
    const pmesh_expectation near = { &m->any[at->scale],
                              &m->here[at->scale][at->place][at->far],
                              m->low[at->scale], &m->escape, at->scale,
                              at->mean };
    return pmesh_code_near(coder, &near, value);
}

unsigned pmesh_how_far(int64_t off, unsigned scale)
{
    const uint64_t size = (uint64_t)(off < 0 ? -off : off);
    const int over = size ? (int)half_octave(size) - (int)scale + 4 : 0;
    return (unsigned)(over >= 2) + (over >= 4) + (over >= 6);
}

unsigned pmesh_deviation_scale(uint64_t deviation, unsigned count)
{
    const uint64_t square = deviation * deviation;
    const unsigned scale = square ? pmesh_bit_length(square) - 1 : 0;
    return scale < count ? scale : count - 1;
}

static uint32_t expected(const pmesh_mean *m, uint32_t size)
{
    const uint64_t e = (uint64_t)m->value * size >> MEAN_BITS;
    return e < 1 ? 1 : e > LARGEST ? LARGEST : (uint32_t)e;
}

/* 2 / (2 uses + 5) in 1/65536. */
#define R(n)  (131072 / (2 * (n) + 5))
#define R4(n) R(n), R((n) + 1), R((n) + 2), R((n) + 3)
#define R20(n)                                                                 \
    R4(n), R4((n) + 4), R4((n) + 8), R4((n) + 12), R4((n) + 16)
static const uint16_t mean_rate[MEAN_USES + 1] = { R20(0), R20(20), R20(40),
                                                   R(60) };

/* `per` is 2^32 / size. */
static void learn(pmesh_mean *m, uint64_t seen, uint32_t size, uint64_t per)
{
    const uint64_t most = (uint64_t)MOST_SEEN * size;
    const uint64_t ratio =
        (seen < most ? seen : most) * per >> (32 - MEAN_BITS);
    const int64_t off = (int64_t)ratio - (int64_t)m->value;
    m->value += (uint32_t)(off * mean_rate[m->uses] / 65536);
    m->uses += m->uses < MEAN_USES;
}

/* The axis with the largest normal component last. */
static void axis_order(const int32_t n[3], int axis[3])
{
    int last = 2;
    int32_t largest = -1;
    for (int k = 2; k >= 0; k--) {
        const int32_t size = n[k] < 0 ? -n[k] : n[k];
        if (size > largest) {
            largest = size;
            last = k;
        }
    }
    axis[0] = last == 0 ? 1 : 0;
    axis[1] = last == 2 ? 1 : 2;
    axis[2] = last;
}

/* Residuals are a Gaussian with deviation `along` in the plane and `across`
 * along the normal n: in units of `along` their covariance is I - rho n n'.
 * Given some of the coordinates that of the others is the same with another
 * rho, and their means are multiples of n. The product of all variances is the
 * determinant: from it the last, which may be tiny, keeps its digits. */
typedef struct gauss {
    int64_t n[3]; /* in coding order */
    int64_t rho;
    int64_t lean;  /* means are -lean n, in 1/16 */
    uint64_t wide; /* square of `along` */
    uint64_t left; /* square of `across`, over the variances so far */
} gauss;

static gauss gauss_make(const int32_t normal[3], const int axis[3],
                        uint32_t along, uint32_t across)
{
    gauss g = { .wide = (uint64_t)along * along };
    if (across > 4 * along)
        across = 4 * along;
    if (across <= along >> FLATTEST)
        across = (along >> FLATTEST) + 1;
    for (int k = 0; k < 3; k++)
        g.n[k] = normal[axis[k]];
    g.left = g.n[2] ? (uint64_t)across * across : g.wide;
    const int64_t ratio =
        (int64_t)(((uint64_t)across << ONE_BITS) / along); /* <= 2 ONE */
    g.rho = g.n[2] ? ONE - (ratio * ratio >> ONE_BITS) : 0;
    return g;
}

static unsigned scale_of(uint64_t square)
{
    const unsigned scale = square ? pmesh_bit_length(square) - 1 : 0;
    return scale < PMESH_SCALES ? scale : PMESH_SCALES - 1;
}

/* Mean and scale of coordinate k, in 1/16 steps. */
static int64_t gauss_expect(const gauss *g, int k, int64_t variance,
                            unsigned *scale)
{
    *scale = scale_of(k == 2 ? g->left
                             : g->wide * (uint64_t)variance >> ONE_BITS);
    return -(g->lean * g->n[k] >> ONE_BITS);
}

/* Of coordinate k, at least 1/4: normals may be a bit too long. */
static int64_t gauss_variance(const gauss *g, int k)
{
    const int64_t n = g->n[k];
    const int64_t v = ONE - ((g->rho * n >> ONE_BITS) * n >> ONE_BITS);
    return v < ONE / 4 ? ONE / 4 : v;
}

/* It turned out to be `off` its mean. */
static void gauss_given(gauss *g, int k, int64_t variance, int64_t off)
{
    const int64_t per = ONE * ONE / (int32_t)variance; /* <= 4 ONE */
    g->rho = g->rho * per >> ONE_BITS;
    g->left = g->left * (uint64_t)per >> ONE_BITS;
    g->lean += (g->rho * g->n[k] >> ONE_BITS) * off >> ONE_BITS;
}

/* Learns from the outcome: d by coordinates, in coding order. */
static void learn_errors(const gauss *g, const int64_t d[3], pmesh_mean *along,
                         pmesh_mean *across, uint32_t size)
{
    const uint64_t per = UINT64_C(0x100000000) / size;
    int64_t height = 0, flat[3];
    for (int k = 0; k < 3; k++)
        height += d[k] * g->n[k];
    height >>= ONE_BITS;
    for (int k = 0; k < 3; k++)
        flat[k] = d[k] - (height * g->n[k] >> ONE_BITS);
    learn(along, (uint64_t)pmesh_rough_length(flat) * 181 >> 8, size, per);
    learn(across, (uint64_t)(height < 0 ? -height : height), size, per);
}

/* The coordinates, by axes in coding order. */
static inline bool code_axes(pmesh_coder *coder, pmesh_residual_model *m,
                             const int32_t bounds[3], const int64_t mean[3],
                             const int axis[3], gauss g, int32_t position[3])
{
    coordinate at = { .far = 0 };
    for (int k = 0; k < 3; k++) {
        const int a = axis[k];
        at.place = (unsigned)k;
        const int64_t variance = k < 2 ? gauss_variance(&g, k) : ONE;
        at.mean = mean[a] + gauss_expect(&g, k, variance, &at.scale);
        const int64_t value = code_coordinate(coder, m, &at, position[a]);
        if (value < 0 || value > bounds[a])
            return false;
        position[a] = (int32_t)value;
        at.far = pmesh_how_far(value * FRACTION - at.mean, at.scale);
        if (k < 2)
            gauss_given(&g, k, variance, value * FRACTION - at.mean);
    }
    return true;
}

bool pmesh_residual_code(pmesh_coder *coder, pmesh_place_models *m,
                         const int32_t bounds[3], pmesh_prediction *p,
                         int32_t position[3])
{
    pmesh_mean *along = &m->along[p->ring_class][p->unknown][p->irregular];
    pmesh_mean *across = &m->across[p->rough][p->unknown];
    const uint32_t wide = expected(along, p->size);
    const uint32_t high = expected(across, p->size);
    int axis[3];
    int64_t d[3];

    pmesh_predict_weigh(m, bounds, p);
    axis_order(p->normal, axis);
    const gauss g = gauss_make(p->normal, axis, wide, high);
    if (!code_axes(coder, &m->residual, bounds, p->position, axis, g, position))
        return false;
    for (int k = 0; k < 3; k++)
        d[k] = (int64_t)position[axis[k]] * FRACTION - p->position[axis[k]];
    learn_errors(&g, d, along, across, p->size);
    pmesh_predict_learn(m, p, position, wide, high);
    return true;
}
