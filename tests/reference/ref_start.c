/* SPDX-License-Identifier: MIT */
/* What the models start as: nothing, or the tables of SPEC appendix C. */
#include "tests/reference/ref.h"

static void load_weights(int32_t *w, const int *table, int count, int factor)
{
    for (int i = 0; i < count; i++)
        w[i] = factor * table[i];
}

static void load_models(ref_model *m, const int *table, int count)
{
    for (int i = 0; i < count; i++)
        ref_model_load(&m[i], table[i]);
}

static void load_fits(ref *r)
{
    const int *from = ref_PREDICT;
    for (int kind = 0; kind < 3; kind++)
        for (int class = 0; class < 9; class++)
            for (int unknown = 0; unknown < 3; unknown++) {
                ref_fit *fit = &r->fit[kind][class][unknown];
                for (int t = 0; t < REF_TERMS; t++)
                    for (int which = 0; which < 2; which++)
                        fit->w[which][t] = fit->start[which][t] =
                            256 * *from++;
            }
}

static void load_expected(ref_expected *e, const int *table, int count,
                          int fallback)
{
    for (int i = 0; i < count; i++)
        e[i].value = table[i] ? table[i] : fallback;
}

static void load_cell(ref_cell *c, int scale)
{
    const int *from = ref_RESIDUAL + 20 * scale;
    load_models(c->zero, from, 3);
    load_models(c->sign, from + 3, 3);
    load_models(c->unary, from + 6, 14);
}

static void load_residual(ref_residual_models *m, int which)
{
    load_expected(m->along[0][0], ref_ALONG + which * 135, 135, 900);
    load_expected(m->across[0], ref_ACROSS + which * 42, 42, 400);
    for (int scale = 0; scale < 60; scale++) {
        ref_cell *any = &m->any[scale];
        load_cell(any, scale);
        for (int k = 0; k < 3; k++)
            for (int far = 0; far < 4; far++)
                m->here[scale][k][far] = *any;
    }
    load_models(m->low[0], ref_LOW, 60 * 3);
    ref_number_start(&m->escape);
}

static void start_base(ref_base_models *m)
{
    ref_model_start(&m->boundary, 1);
    ref_model_start(&m->known, 1);
    ref_model_start(m->neighbour, 2);
    ref_model_start(&m->sign, 1);
    ref_number_start(&m->vertex);
    ref_number_start(&m->position);
}

static void start_wedges(ref_wedge_models *m)
{
    ref_model_start(m->material, 3);
    ref_model_start(m->ordinary, 3);
    ref_model_start(m->seam[0], 9);
    ref_model_start(m->corner[0][0], 36);
    ref_model_start(m->choice, 2);
    ref_number_start(&m->pick);
}

static void start_attributes(ref *r)
{
    for (int i = 0; i < REF_ATTRIBUTES; i++) {
        ref_channel_models *m = &r->channel_models[i];
        for (int scale = 0; scale < 40; scale++)
            load_cell(&m->any[scale], scale);
        load_models(m->low[0], ref_LOW, 40 * 3);
        ref_number_start(&m->escape);
        ref_model_start(m->differs[0], 9);
    }
    for (int i = 0; i < REF_VALUES; i++) {
        ref_value_models *m = &r->value_models[i];
        for (int scale = 0; scale < 40; scale++)
            load_cell(&m->here[scale], scale);
        for (int class = 0; class < 5; class++) {
            for (int k = 0; k < 32; k++)
                m->by_spread[class][k].value = 64;
            for (int k = 0; k < 5; k++)
                m->by_far[class][k].value = 64;
        }
        for (int k = 0; k < 3; k++)
            m->fit[k].w[0][0] = m->fit[k].start[0][0] = 32768;
    }
}

static void start_join(ref_join_models *m)
{
    ref_model_start(m->whole, 3);
    ref_model_start(m->moves[0], 6);
    ref_model_start(m->lone, 3);
    ref_model_start(&m->pair, 1);
    ref_model_start(&m->turned, 1);
    ref_model_start(&m->far, 1);
    ref_model_start(&m->known, 1);
    ref_number_start(&m->member);
    ref_number_start(&m->back);
}

void ref_models_start(ref *r)
{
    start_join(&r->join);
    start_base(&r->base_models);
    start_wedges(&r->wedge_models);
    start_attributes(r);
    load_models(r->flag, ref_FLAG, 1680);
    load_weights(r->cut.shape[0][0], ref_SHAPE, 12, 4);
    load_weights(r->cut.reach[0], ref_REACH, 4, 4);
    load_weights(r->cut.degree[0], ref_DEGREE, 24, 256);
    load_weights(r->cut.state[0][0][0], ref_STATE, 250, 256);
    load_weights(r->cut.span[0][0], ref_SPAN, 280, 256);
    load_models(r->cut.rank[0][0], ref_RANK, 256);
    load_fits(r);
    for (int which = 0; which < 2; which++)
        load_residual(&r->residual[which], which);
    ref_model_start(r->exact_models.same[0][0], 96);
    ref_model_start(r->exact_models.rare, 3);
    for (int axis = 0; axis < 3; axis++)
        for (int i = 0; i < 4096; i++)
            r->exact_last[axis][i] = REF_NONE;
}
