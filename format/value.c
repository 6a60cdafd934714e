/* SPDX-License-Identifier: MIT */
#include "format/value.h"

#include <string.h>

#include "format/octant.h"
#include "format/residual.h"
#include "format/star.h"
#include "format/surround.h"
#include "format/tangent.h"

enum {
    FRACTION_BITS = 4, /* of predictions */
    FRACTION = 1 << FRACTION_BITS,
    WEIGHT_BITS = 16,
    TERM_BITS = 13, /* of terms while weights are learnt */
    ERROR_LIMIT = 1 << 14,
    LARGEST_WEIGHT = 1 << 18,
    WEIGHT_SCALE = 1 << 26,
    MEAN_USES = 60,
    FEW_USES = 2
};

#define PULL ((int64_t)1 << 26)

/* What is added to the neighbours' mean; the rest of the terms is 0. */
enum { AFFINE, CLOSE, SHAPE, BEFORE, BEFORE_THAT };

/* One attribute of a wedge, and what is known around. */
typedef struct subject {
    const pmesh_codec *c;
    const pmesh_surround *around;
    const pmesh_channel *channel;
    uint32_t w, sibling; /* PMESH_NONE: has none */
    bool mirrored;       /* codes of normals are seen from below */
    int32_t centre;      /* of codes of normals */
    bool shaped;         /* the surface tells something about the first */
    int64_t shape[3];    /* components: in 1/FRACTION */
    int32_t neighbour[PMESH_MAX_RING][PMESH_MAX_COMPONENTS];
} subject;

/* In 1/FRACTION: of a component. */
typedef struct guess {
    int64_t mean, value;
    int64_t term[PMESH_FIT_TERMS];
} guess;

static pmesh_status out_of_range(pmesh_codec *c)
{
    c->rule = "SPEC 6.6: an attribute value is out of range";
    return PMESH_E_CORRUPT;
}

static int64_t size_of(int64_t x)
{
    return x < 0 ? -x : x;
}

static const uint16_t *stored(const subject *s, uint32_t w)
{
    const pmesh_mesh *m = &s->c->mesh;
    return m->value + (size_t)w * m->value_count + s->channel->first;
}

static void look_at(const subject *s, const uint16_t *value, int32_t *out)
{
    for (uint32_t k = 0; k < s->channel->count; k++)
        out[k] = value[k];
    if (s->mirrored)
        pmesh_octant_mirror(s->centre, out);
}

/* Normals are seen from the side where most neighbours are. */
static void look_at_normal(subject *s)
{
    const pmesh_surround *a = s->around;
    int64_t below = 0, normal[3];
    for (uint32_t i = 0; i < a->count; i++)
        below += pmesh_octant_below(s->centre, stored(s, a->wedge[i]));
    s->mirrored = below > 0;
    pmesh_fan_normal(&s->c->mesh, s->c->wedge_corner[s->w], normal);
    pmesh_octant_fold(normal, s->centre, FRACTION, s->mirrored, s->shape);
    s->shaped = true;
}

/* Tangents are coded within about -1 .. 1. */
static void look_at_tangent(subject *s)
{
    int64_t tangent[3];
    pmesh_tangent(s->c, s->w, tangent);
    s->shaped = tangent[0] || tangent[1] || tangent[2];
    for (int k = 0; k < 3; k++) {
        const int64_t half =
            (int64_t)s->c->component_max[s->channel->first] * FRACTION / 2;
        s->shape[k] = half + tangent[k] * half / (1 << PMESH_TANGENT_BITS);
    }
}

static void look_around(subject *s)
{
    const pmesh_surround *a = s->around;
    s->mirrored = s->shaped = false;
    if (s->channel->normal)
        look_at_normal(s);
    if (s->channel->tangent && a->count)
        look_at_tangent(s);
    for (uint32_t i = 0; i < a->count; i++)
        look_at(s, stored(s, a->wedge[i]), s->neighbour[i]);
}

static pmesh_prospect prospect(const subject *s, uint32_t k)
{
    const pmesh_surround *a = s->around;
    const int64_t n = a->count;
    int64_t sum = 0, affine = 0, close = 0;
    pmesh_prospect p = { 0 };
    for (uint32_t i = 0; i < a->count; i++) {
        sum += s->neighbour[i][k];
        affine += (int64_t)s->neighbour[i][k] * a->affine[i];
        close += (int64_t)s->neighbour[i][k] * a->close[i];
    }
    p.mean = (sum * FRACTION + n / 2) / n;
    for (uint32_t i = 0; i < a->count; i++)
        p.spread += size_of(s->neighbour[i][k] * FRACTION - p.mean);
    p.spread /= n;
    p.affine = (affine >> (WEIGHT_BITS - FRACTION_BITS)) - p.mean;
    p.close = (close >> (WEIGHT_BITS - FRACTION_BITS)) - p.mean;
    if (s->shaped && k < 3)
        p.shape = s->shape[k] - p.mean;
    return p;
}

/* Where nothing around is known. */
static int64_t blind_guess(const subject *s, uint32_t k)
{
    const uint32_t parent = s->c->mesh.wedge_parent[s->w];
    if (s->sibling != PMESH_NONE)
        return stored(s, s->sibling)[k] * FRACTION;
    if (parent < s->w)
        return stored(s, parent)[k] * FRACTION;
    return (int64_t)s->c->component_max[s->channel->first + k] * FRACTION / 2;
}

/* ---- prediction ---------------------------------------------------------- */

/* error: of the components before. */
static guess predict(const pmesh_prospect *p, const int64_t error[2],
                     bool alone, int64_t limit, const pmesh_fit *fit)
{
    guess g = { .mean = p->mean };
    int64_t sum = 0;
    if (!alone) {
        g.term[AFFINE] = p->affine;
        g.term[CLOSE] = p->close;
        g.term[SHAPE] = p->shape;
        g.term[BEFORE] = error[0];
        g.term[BEFORE_THAT] = error[1];
    }
    for (int t = 0; t < PMESH_FIT_TERMS; t++)
        sum += g.term[t] * fit->weight[t];
    g.value = g.mean + (sum >> WEIGHT_BITS);
    g.value = g.value < 0 ? 0 : g.value > limit ? limit : g.value;
    return g;
}

/* ---- learning ------------------------------------------------------------ */

static void learn_mean(pmesh_mean *m, int64_t seen)
{
    const int64_t step =
        (seen - (int64_t)m->value) * 2 / (2 * (int64_t)m->uses + 3);
    m->value = (uint32_t)((int64_t)m->value + step);
    if (m->uses < MEAN_USES)
        m->uses++;
}

static int64_t limited(int64_t x, int64_t limit)
{
    return x < -limit ? -limit : x > limit ? limit : x;
}

/* Terms and target are scaled to below 2^13; a sample counts the less the more
 * it was off, or was expected to be. */
static void learn_fit(pmesh_fit *fit, const guess *g, int64_t value,
                      int64_t expected)
{
    const int64_t target = value - g->mean;
    uint64_t all = (uint64_t)size_of(target) | 1;
    pmesh_sample s;
    int32_t f[PMESH_FIT_TERMS];
    for (int t = 0; t < PMESH_FIT_TERMS; t++)
        all |= (uint64_t)size_of(g->term[t]);
    const int scale = TERM_BITS - (int)pmesh_bit_length(all);
    const int32_t y = (int32_t)pmesh_scale(target, scale);
    for (int t = 0; t < PMESH_FIT_TERMS; t++) {
        f[t] = (int32_t)pmesh_scale(g->term[t], scale);
        for (int j = 0; j <= t; j++)
            s.product[t][j] = f[t] * f[j];
        s.product[t][PMESH_FIT_TERMS] = f[t] * y;
    }
    const int64_t e = limited(pmesh_scale(expected, scale), ERROR_LIMIT);
    const int64_t o = limited(pmesh_scale(value - g->value, scale),
                              ERROR_LIMIT);
    const int64_t weight = WEIGHT_SCALE / (e * e + o * o + 1);
    pmesh_fit_learn(
        fit, &s, (int32_t)(weight < LARGEST_WEIGHT ? weight : LARGEST_WEIGHT),
        PULL);
}

/* ---- coding -------------------------------------------------------------- */

static unsigned count_class(uint32_t n)
{
    return n < 3 ? n : n < 5 ? 3 : 4;
}

static unsigned spread_class(int64_t spread)
{
    const unsigned bits = pmesh_bit_length((uint64_t)(spread * spread));
    return bits < PMESH_VALUE_SPREADS ? bits : PMESH_VALUE_SPREADS - 1;
}

/* What was coded of an attribute. */
typedef struct past {
    int64_t error[2]; /* of the last component and the one before it */
    unsigned far;     /* how far off the last was; 0: there is none */
} past;

/* Codes component k; false if it is out of range. */
static bool code_component(pmesh_codec *c, pmesh_coder *coder,
                           pmesh_outlook *o, uint32_t k, past *before)
{
    const pmesh_prospect *p = &o->of[k];
    const uint32_t component = c->channel[o->channel].first + k;
    pmesh_value_models *m = &c->value_models[component];
    pmesh_channel_models *all = &c->channel_models[o->channel];
    pmesh_fit *fit = &m->fit[o->group < 3 ? 0 : o->group - 2];
    const int64_t limit = c->component_max[component];
    const guess g =
        predict(p, before->error, o->group == 0, limit * FRACTION, fit);

    pmesh_mean *by_spread = &m->by_spread[o->group][spread_class(p->spread)];
    pmesh_mean *by_far = &m->by_far[o->group][before->far];
    const int64_t expected =
        by_spread->uses < FEW_USES
            ? by_far->value
            : ((int64_t)by_spread->value + by_far->value) / 2;
    const unsigned scale =
        pmesh_deviation_scale((uint64_t)expected, PMESH_VALUE_SCALES);
    const pmesh_expectation near = { &all->any[scale], &m->here[scale],
                              all->low[scale], &all->escape, scale, g.value };
    const int64_t result = pmesh_code_near(coder, &near, o->value[k]);
    if (result < 0 || result > limit)
        return false;

    const int64_t off = result * FRACTION - g.value;
    learn_mean(by_spread, size_of(off));
    learn_mean(by_far, size_of(off));
    if (o->group > 0)
        learn_fit(fit, &g, result * FRACTION, expected);
    before->error[1] = before->error[0];
    before->error[0] = off;
    before->far = 1 + pmesh_how_far(off, scale);
    o->value[k] = (int32_t)result;
    return true;
}

bool pmesh_outlook_code(pmesh_codec *c, pmesh_coder *coder, pmesh_outlook *o)
{
    past before = { .far = 0 };
    for (uint32_t k = 0; k < c->channel[o->channel].count; k++)
        if (!code_component(c, coder, o, k, &before))
            return false;
    return true;
}

static void look_out(const subject *s, pmesh_outlook *o)
{
    o->channel = (uint32_t)(s->channel - s->c->channel);
    o->group = count_class(s->around->count);
    for (uint32_t k = 0; k < s->channel->count; k++)
        o->of[k] = s->around->count
                       ? prospect(s, k)
                       : (pmesh_prospect){ .mean = blind_guess(s, k) };
}

static pmesh_status code_attribute(pmesh_codec *c, pmesh_coder *coder,
                                   subject *s, const uint16_t *truth,
                                   uint16_t *out)
{
    pmesh_outlook o;
    int32_t *value = o.value;
    look_around(s);
    look_out(s, &o);
    memset(value, 0, sizeof o.value);
    if (truth)
        look_at(s, truth, value);
    if (coder->relay)
        coder->relay->values(coder->relay->user, &o);
    else if (!pmesh_outlook_code(c, coder, &o))
        return out_of_range(c);
    if (s->mirrored) {
        if (value[0] > 2 * s->centre || value[1] > 2 * s->centre)
            return out_of_range(c);
        pmesh_octant_mirror(s->centre, value);
    }
    for (uint32_t k = 0; k < s->channel->count; k++)
        out[k] = (uint16_t)value[k];
    return PMESH_OK;
}

/* Whether a sibling, a lower wedge of the vertex, has the same; then it is
 * copied. `before`: 0 for the first attribute, else 1, or 2 if the one before
 * it was copied. */
static bool copy_sibling(pmesh_codec *c, pmesh_coder *coder, const subject *s,
                         unsigned before, const uint16_t *truth, uint16_t *out)
{
    pmesh_channel_models *m = &c->channel_models[s->channel - c->channel];
    const size_t size = s->channel->count * sizeof *out;
    uint32_t other = s->sibling;
    for (int i = 0; i < PMESH_SIBLINGS && other != PMESH_NONE; i++) {
        const uint16_t *from = stored(s, other);
        const bool differs = truth && memcmp(truth, from, size) != 0;
        if (!pmesh_tell_bit(coder, &m->differs[before][i], differs)) {
            memcpy(out, from, size);
            return true;
        }
        other = c->wedge_before[other];
    }
    return false;
}

void pmesh_values_spent(pmesh_codec *c, const pmesh_coder *coder,
                        uint32_t attribute, uint64_t *before)
{
    const uint64_t now = pmesh_coder_spent(coder);
    c->attribute_spent[attribute] += now - *before;
    *before = now;
}

/* What was spent since the last call counts as the given attribute's. */
static void count_spent(pmesh_codec *c, const pmesh_coder *coder, uint32_t i,
                        uint64_t *before)
{
    if (coder->relay)
        coder->relay->spent(coder->relay->user, i);
    else if (coder->encoding)
        pmesh_values_spent(c, coder, i, before);
}

pmesh_status pmesh_wedge_values_code(pmesh_codec *c, pmesh_coder *coder,
                                     const pmesh_oracle *oracle, uint32_t w)
{
    const uint16_t *truth = oracle ? oracle->values(oracle->user, w) : NULL;
    uint16_t *out = c->mesh.value + (size_t)w * c->mesh.value_count;
    uint64_t spent =
        coder->encoding && !coder->relay ? pmesh_coder_spent(coder) : 0;
    unsigned before = 0;
    pmesh_surround around;
    subject s = { .c = c, .around = &around, .w = w,
                  .sibling = c->wedge_before[w] };

    pmesh_surround_make(c, w, &around);
    for (uint32_t i = 0; i < c->sizes.attribute_count; i++) {
        s.channel = &c->channel[i];
        s.centre = (int32_t)(c->component_max[s.channel->first] / 2);
        const uint16_t *is = truth ? truth + s.channel->first : NULL;
        uint16_t *to = out + s.channel->first;
        const bool copied = copy_sibling(c, coder, &s, before, is, to);
        const pmesh_status status =
            copied ? PMESH_OK : code_attribute(c, coder, &s, is, to);
        if (status != PMESH_OK)
            return status;
        before = copied ? 2 : 1;
        count_spent(c, coder, i, &spent);
    }
    return PMESH_OK;
}
