/* SPDX-License-Identifier: MIT */
#include "format/models.h"

/* What was never seen while the tables were made. */
enum { ALONG_START = 900, ACROSS_START = 400 };

/* An attribute's expected error, in 1/16, and the weights of its terms, in
 * 1/256: the affine map's. */
enum { ERROR_START = 64, AFFINE_START = 128 };

#define COUNT(array, item) (sizeof(array) / sizeof(item))
#define INIT_BITS(array)                                                       \
    pmesh_bits_init((pmesh_bit *)(array), COUNT(array, pmesh_bit))

static void residual_bits_init(pmesh_residual_bits *b, const uint8_t *from)
{
    pmesh_bits_start(b->zero, PMESH_LEANS, from);
    pmesh_bits_start(b->sign, PMESH_LEANS, from + PMESH_LEANS);
    pmesh_bits_start(b->unary, PMESH_UNARY, from + 2 * PMESH_LEANS);
}

static void residual_init(pmesh_residual_model *m, const pmesh_tables *start)
{
    for (int scale = 0; scale < PMESH_SCALES; scale++) {
        const uint8_t *from = start->residual + scale * PMESH_RESIDUAL_BITS;
        residual_bits_init(&m->any[scale], from);
        for (int place = 0; place < 3; place++)
            for (int far = 0; far < PMESH_FAR; far++)
                residual_bits_init(&m->here[scale][place][far], from);
    }
    pmesh_bits_start((pmesh_bit *)m->low, COUNT(m->low, pmesh_bit), start->low);
    pmesh_number_init(&m->escape);
}

static void means_init(pmesh_mean *to, const uint16_t *from, size_t count,
                       uint32_t otherwise)
{
    for (size_t i = 0; i < count; i++)
        to[i] = (pmesh_mean){ from[i] ? from[i] : otherwise, 0 };
}

static void wedge_init(pmesh_wedge_models *m)
{
    INIT_BITS(m->ordinary);
    INIT_BITS(m->seam);
    INIT_BITS(m->corner);
    INIT_BITS(m->choice);
    INIT_BITS(m->material);
    pmesh_number_init(&m->pick);
}

static void join_init(pmesh_join_models *m)
{
    INIT_BITS(m->whole);
    INIT_BITS(m->moves);
    INIT_BITS(m->lone);
    pmesh_bits_init(&m->pair, 1);
    pmesh_bits_init(&m->turned, 1);
    pmesh_bits_init(&m->far, 1);
    pmesh_bits_init(&m->known, 1);
    pmesh_number_init(&m->member);
    pmesh_number_init(&m->back);
}

static void weights_init(int32_t *to, const int16_t *from, size_t count,
                         int32_t unit)
{
    for (size_t i = 0; i < count; i++)
        to[i] = from[i] * unit;
}

static void cut_init(pmesh_cut_weights *w, const pmesh_tables *start)
{
    weights_init((int32_t *)w->shape, start->shape, COUNT(w->shape, int32_t),
                 4);
    weights_init((int32_t *)w->reach, start->reach, COUNT(w->reach, int32_t),
                 4);
    weights_init((int32_t *)w->degree, start->degree, COUNT(w->degree, int32_t),
                 256);
    weights_init((int32_t *)w->state, start->state, COUNT(w->state, int32_t),
                 256);
    weights_init((int32_t *)w->span, start->span, COUNT(w->span, int32_t), 256);
}

static void predict_init(pmesh_place_models *m, const int16_t *from)
{
    pmesh_fit(*fit)[2] = (pmesh_fit(*)[2])m->predict;
    for (size_t i = 0; i < COUNT(m->predict, *fit); i++) {
        pmesh_fit_init(&fit[i][0], from, 2);
        pmesh_fit_init(&fit[i][1], from + 1, 2);
        from += 2 * PMESH_FIT_TERMS;
    }
}

void pmesh_models_init(pmesh_models *m, const pmesh_tables *start)
{
    pmesh_bits_start(m->flag, PMESH_FLAG_CONTEXTS, start->flag);
    pmesh_bits_start((pmesh_bit *)m->cut, COUNT(m->cut, pmesh_bit),
                     start->rank);
    cut_init(&m->cut_weights, start);
    INIT_BITS(m->base);
    pmesh_bits_init(&m->base_sign, 1);
    pmesh_number_init(&m->base_vertex);
    pmesh_number_init(&m->base_position);
    wedge_init(&m->wedge);
    join_init(&m->join);
}

void pmesh_place_models_init(pmesh_place_models *m, pmesh_predict_kind kind,
                             const pmesh_tables *start)
{
    enum {
        FITS = COUNT(m->predict, pmesh_fit),
        ALONG = COUNT(m->along, pmesh_mean),
        ACROSS = COUNT(m->across, pmesh_mean)
    };
    const bool parent = kind == PMESH_PREDICT_MOVED_PARENT;
    predict_init(m, start->predict + (size_t)kind * FITS * PMESH_FIT_TERMS);
    residual_init(&m->residual, start);
    means_init((pmesh_mean *)m->along, start->along + (parent ? ALONG : 0),
               ALONG, ALONG_START);
    means_init((pmesh_mean *)m->across, start->across + (parent ? ACROSS : 0),
               ACROSS, ACROSS_START);
}

void pmesh_channel_models_init(pmesh_channel_models *m,
                               const pmesh_tables *start)
{
    for (int scale = 0; scale < PMESH_VALUE_SCALES; scale++)
        residual_bits_init(&m->any[scale],
                           start->residual + scale * PMESH_RESIDUAL_BITS);
    pmesh_bits_start((pmesh_bit *)m->low, COUNT(m->low, pmesh_bit), start->low);
    pmesh_number_init(&m->escape);
    INIT_BITS(m->differs);
}

void pmesh_value_models_init(pmesh_value_models *m, const pmesh_tables *start)
{
    static const int16_t weight[PMESH_FIT_TERMS] = { AFFINE_START };
    pmesh_mean *mean = (pmesh_mean *)m->by_spread;
    for (int scale = 0; scale < PMESH_VALUE_SCALES; scale++)
        residual_bits_init(&m->here[scale],
                           start->residual + scale * PMESH_RESIDUAL_BITS);
    for (size_t i = 0; i < COUNT(m->by_spread, pmesh_mean); i++)
        mean[i] = (pmesh_mean){ ERROR_START, 0 };
    mean = (pmesh_mean *)m->by_far;
    for (size_t i = 0; i < COUNT(m->by_far, pmesh_mean); i++)
        mean[i] = (pmesh_mean){ ERROR_START, 0 };
    for (int i = 0; i < PMESH_VALUE_FITS; i++)
        pmesh_fit_init(&m->fit[i], weight, 1);
}
