/* SPDX-License-Identifier: MIT */
#include "format/residual.h"

#include "format/star.h"

enum {
    FRACTION_BITS = 4,
    FRACTION = 16,
    ONE = 16384,     /* of normals and of variances relative to `along` */
    MEAN_ONE = 4096, /* of pmesh_mean */
    MEAN_USES = 60,
    LEAST_RATIO = 128, /* across is taken as along / 128 at least */
    LOW_MODELS = 3
};

#define LARGEST (1u << 24) /* of expected residuals */

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
    for (unsigned i = shift; i-- > 0;) {
        const unsigned bit = size >> i & 1;
        unsigned got;
        if (node < LOW_MODELS && shift - i <= 2) {
            got = pmesh_code_bit(coder, &at->low[node], bit);
            node = 1 + got;
        } else {
            got = pmesh_code_raw(coder, 1, bit);
        }
        result = result << 1 | got;
    }
    return result;
}

int64_t pmesh_code_near(pmesh_coder *coder, const pmesh_expectation *at,
                        int64_t value)
{
    const int64_t center = (at->mean + FRACTION / 2) >> FRACTION_BITS;
    const int64_t part = at->mean - center * FRACTION; /* -8 .. 7 */
    const unsigned lean = part < -2 ? 0 : part > 2 ? 2 : 1;
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
    return over < 2 ? 0 : over < 4 ? 1 : over < 6 ? 2 : PMESH_FAR - 1;
}

unsigned pmesh_deviation_scale(uint64_t deviation, unsigned count)
{
    const uint64_t square = deviation * deviation;
    const unsigned scale = square ? pmesh_bit_length(square) - 1 : 0;
    return scale < count ? scale : count - 1;
}

static uint32_t expected(const pmesh_mean *m, uint32_t size)
{
    const uint64_t e = (uint64_t)m->value * size / MEAN_ONE;
    return e < 1 ? 1 : e > LARGEST ? LARGEST : (uint32_t)e;
}

static void learn(pmesh_mean *m, uint64_t seen, uint32_t size)
{
    uint64_t ratio = seen * MEAN_ONE / size;
    if (ratio > 64 * MEAN_ONE)
        ratio = 64 * MEAN_ONE;
    const int64_t step =
        ((int64_t)ratio - (int64_t)m->value) * 2 / (2 * (int64_t)m->uses + 5);
    m->value = (uint32_t)((int64_t)m->value + step);
    if (m->uses < MEAN_USES)
        m->uses++;
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

/* Given deviations along and across the normal, in units of `along`: the
 * covariance is I - rho n n', its inverse I + kappa n n'. */
typedef struct gauss {
    int64_t n[3]; /* in coding order */
    int64_t rho, kappa;
    uint32_t along;
} gauss;

static gauss gauss_make(const int32_t normal[3], const int axis[3],
                        uint32_t along, uint32_t across)
{
    gauss g = { .along = along };
    if (across > 4 * along)
        across = 4 * along;
    const uint64_t ratio = (uint64_t)across * ONE / along; /* <= 4 * ONE */
    const uint64_t least = ONE / LEAST_RATIO;
    const int64_t q = (int64_t)(ratio < least ? least : ratio);
    g.rho = ONE - q * q / ONE;
    g.kappa = (int64_t)ONE * ONE / q * ONE / q - ONE; /* in 1/ONE */
    for (int k = 0; k < 3; k++)
        g.n[k] = normal[axis[k]];
    if (g.n[2] == 0)
        g.rho = g.kappa = 0;
    return g;
}

static unsigned scale_of(uint64_t square)
{
    const unsigned scale = square ? pmesh_bit_length(square) - 1 : 0;
    return scale < PMESH_SCALES ? scale : PMESH_SCALES - 1;
}

/* Mean and scale of coordinate k given the residuals d of those before;
 * everything in 1/16 grid steps. */
static int64_t gauss_given(const gauss *g, int k, const int64_t d[3],
                           unsigned *scale)
{
    const int64_t *n = g->n;
    const uint64_t along = (uint64_t)g->along * g->along; /* <= 2^48 */
    if (k == 2) {
        const int64_t t = (n[0] * d[0] + n[1] * d[1]) / ONE;
        const int64_t p = ONE + g->kappa * n[2] / ONE * n[2] / ONE;
        *scale = scale_of(along * ONE / (uint64_t)p);
        return -(g->kappa * n[2] / ONE * t) / p;
    }
    const int64_t least = ONE / 4096;
    int64_t variance = ONE - g->rho * n[0] / ONE * n[0] / ONE, mean = 0;
    if (variance < least)
        variance = least;
    if (k == 1) {
        const int64_t both = -(g->rho * n[0] / ONE * n[1] / ONE);
        mean = both * d[0] / variance;
        const int64_t given =
            ONE - g->rho * n[1] / ONE * n[1] / ONE - both * both / variance;
        variance = given < least ? least : given;
    }
    *scale = scale_of(along * (uint64_t)variance / ONE);
    return mean;
}

/* Learns from the outcome: d by coordinates, in coding order. */
static void learn_errors(const gauss *g, const int64_t d[3], pmesh_mean *along,
                         pmesh_mean *across, uint32_t size)
{
    int64_t height = 0, flat[3];
    for (int k = 0; k < 3; k++)
        height += d[k] * g->n[k];
    height /= ONE;
    for (int k = 0; k < 3; k++)
        flat[k] = d[k] - height * g->n[k] / ONE;
    learn(along, (uint64_t)pmesh_rough_length(flat) * 181 / 256, size);
    learn(across, (uint64_t)(height < 0 ? -height : height), size);
}

bool pmesh_residual_code(pmesh_codec *c, pmesh_coder *coder, int which,
                         pmesh_prediction *p, int32_t position[3])
{
    pmesh_models *m = &c->models;
    pmesh_mean *along =
        &m->along[which][p->ring_class][p->unknown][p->irregular];
    pmesh_mean *across = &m->across[which][p->rough][p->unknown];
    const uint32_t wide = expected(along, p->size);
    const uint32_t high = expected(across, p->size);
    coordinate at = { .far = 0 };
    int axis[3];
    int64_t d[3] = { 0, 0, 0 };

    axis_order(p->normal, axis);
    const gauss g = gauss_make(p->normal, axis, wide, high);
    for (int k = 0; k < 3; k++) {
        const int a = axis[k];
        at.place = (unsigned)k;
        at.mean = p->position[a] + gauss_given(&g, k, d, &at.scale);
        const int64_t value =
            code_coordinate(coder, &m->residual[which], &at, position[a]);
        if (value < 0 || value > c->bounds[a])
            return false;
        position[a] = (int32_t)value;
        d[k] = value * FRACTION - p->position[a];
        at.far = pmesh_how_far(value * FRACTION - at.mean, at.scale);
    }
    learn_errors(&g, d, along, across, p->size);
    pmesh_predict_learn(p, position, wide, high);
    return true;
}
