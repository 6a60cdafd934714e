/* SPDX-License-Identifier: MIT */
#include "format/models.h"

/* Expected residuals before anything was seen, as fractions of 4096. */
enum { ALONG_START = 900, ACROSS_START = 400 };

#define INIT_BITS(array) \
    pmesh_bits_init((pmesh_bit *)(array), sizeof(array) / sizeof(pmesh_bit))

static void residual_init(pmesh_residual_model *m)
{
    INIT_BITS(m->zero);
    INIT_BITS(m->sign);
    INIT_BITS(m->unary);
    INIT_BITS(m->low);
    pmesh_number_init(&m->escape);
}

static void init_means(pmesh_mean *means, size_t size, uint32_t value)
{
    for (size_t i = 0; i < size / sizeof *means; i++)
        means[i] = (pmesh_mean){ value, 0 };
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

/* The tables are kept short; learning needs 8 bits more. */
#define INIT_WEIGHTS(to, from) \
    init_weights((int32_t *)(to), (const int16_t *)(from), \
                 sizeof(from) / sizeof(int16_t))

static void init_weights(int32_t *to, const int16_t *from, size_t count)
{
    for (size_t i = 0; i < count; i++)
        to[i] = from[i] * 256;
}

static void cut_weights_init(pmesh_cut_weights *w)
{
    INIT_WEIGHTS(w->shape, pmesh_cut_shape);
    INIT_WEIGHTS(w->degree, pmesh_cut_degree);
    INIT_WEIGHTS(w->state, pmesh_cut_state);
    INIT_WEIGHTS(w->span, pmesh_cut_span);
}

void pmesh_models_init(pmesh_models *m)
{
    INIT_BITS(m->flag);
    INIT_BITS(m->cut);
    cut_weights_init(&m->cut_weights);
    INIT_WEIGHTS(m->predict, pmesh_predict_weight);
    INIT_BITS(m->base);
    INIT_BITS(m->value_sign);
    pmesh_bits_init(&m->base_sign, 1);
    pmesh_number_init(&m->base_vertex);
    pmesh_number_init(&m->base_position);
    wedge_init(&m->wedge);
    for (int i = 0; i < PMESH_MAX_ATTRIBUTES * PMESH_MAX_COMPONENTS; i++)
        for (int k = 0; k < 2; k++)
            pmesh_number_init(&m->value[i][k]);
    for (int which = 0; which < 2; which++) {
        residual_init(&m->residual[which]);
        init_means((pmesh_mean *)m->along[which], sizeof m->along[which],
                   ALONG_START);
        init_means((pmesh_mean *)m->across[which], sizeof m->across[which],
                   ACROSS_START);
    }
}
