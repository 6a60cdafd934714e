/* SPDX-License-Identifier: MIT */
/* What the encoder asks of every edge, in two ways that must agree. */
#include <stdlib.h>
#include <string.h>

#include "encoder/enc_candidate.h"
#include "encoder/enc_quantile.h"
#include "tests/unit/import_trial.h"
#include "tests/unit/shapes.h"
#include "tests/unit/test.h"

typedef struct priced {
    shape_mesh *shape;
    trial trial;
    enc_surface surface;
    enc_pricing pricing;
    enc_sign *sign;
} priced;

static void survey(priced *p, enc_taste taste)
{
    p->pricing.sign = p->sign;
    enc_pricing_begin(&p->pricing, &p->surface, taste, true);
}

static void open_priced(priced *p, shape_kind kind, uint32_t size,
                        pmesh_metric metric, pmesh_placement placement)
{
    p->shape = shape_make(kind, size, 3);
    p->trial = import_trial_of(p->shape->input.positions,
                               p->shape->input.vertex_count,
                               p->shape->input.indices,
                               p->shape->input.face_count);
    p->trial.config.metric = metric;
    p->trial.config.placement = placement;
    p->trial.config.topology = PMESH_TOPOLOGY_KEEP;
    CHECK(import_run(&p->trial) == PMESH_OK);
    const enc_mesh *mesh = &p->trial.mesh;
    CHECK(enc_surface_create(mesh, &p->surface) == PMESH_OK);
    CHECK(enc_pricing_create(mesh, &p->trial.config, &p->pricing) == PMESH_OK);
    p->sign = malloc(mesh->vertex_count * sizeof *p->sign);
}

static void close_priced(priced *p)
{
    free(p->sign);
    enc_pricing_destroy(&p->trial.mesh, &p->pricing);
    enc_surface_destroy(&p->surface);
    import_finish(&p->trial);
    shape_free(p->shape);
}

/* How many vertices have edges to both u and v, by a look at all faces. */
static uint32_t count_common(const priced *p, uint32_t u, uint32_t v)
{
    const enc_surface *s = &p->surface;
    uint8_t *met = calloc(p->trial.mesh.vertex_count, 1);
    uint32_t common = 0;

    for (uint32_t h = 0; h < 3 * p->trial.mesh.face_count; h++) {
        const uint32_t from = s->vertex[h];
        if (from == ENC_NONE)
            continue;
        const uint32_t to = s->vertex[enc_next(h)];
        met[to] |= (from == u ? 1 : 0) | (from == v ? 2 : 0);
        met[from] |= (to == u ? 1 : 0) | (to == v ? 2 : 0);
    }
    for (uint32_t w = 0; w < p->trial.mesh.vertex_count; w++)
        common += met[w] == 3;
    free(met);
    return common;
}

/* Contracts whatever can be joined, until only that is left which cannot: few
 * vertices, and cycles of three edges around no face. Returns edges that the
 * rule forbids. */
static uint32_t compare_joins(priced *p, uint32_t seed)
{
    enc_surface *s = &p->surface;
    const uint32_t corners = 3 * p->trial.mesh.face_count;
    uint32_t forbidden = 0;

    for (int round = 0; round < 12; round++) {
        survey(p, (enc_taste){ 1, 0, 0 });
        for (uint32_t h = 0; h < corners; h++) {
            if (s->vertex[h] == ENC_NONE || h > s->twin[h])
                continue;
            const bool allowed = enc_surface_can_join(s, h);
            CHECK(enc_surface_can_join_signed(s, p->sign, h) == allowed);
            forbidden += !allowed;
            CHECK(!allowed ||
                  count_common(p, s->vertex[h], s->vertex[enc_next(h)]) ==
                      (s->twin[h] == ENC_NONE ? 1 : 2));
        }
        for (uint32_t h = 0; h < corners; h++) {
            if (shape_random(&seed, 4) > 0 || s->vertex[h] == ENC_NONE ||
                !enc_surface_can_join(s, h))
                continue;
            const enc_pair pair = enc_surface_pair(s, h, false);
            const int32_t *to = s->position[pair.parent];
            if (enc_on_boundary(s, pair.child) &&
                !enc_on_boundary(s, pair.parent))
                continue;
            enc_surface_contract(s, &pair, (int32_t[]){ to[0], to[1], to[2] },
                                 NULL);
        }
    }
    return forbidden;
}

TEST(signed_rings_may_be_joined_where_compared_ones_may)
{
    const shape_kind kind[] = { SHAPE_TORUS, SHAPE_TERRAIN, SHAPE_SOUP,
                                SHAPE_PIECES };
    for (uint32_t i = 0; i < sizeof kind / sizeof *kind; i++) {
        priced p;
        open_priced(&p, kind[i], 24, PMESH_MEMORYLESS, PMESH_SUBSET);
        CHECK(compare_joins(&p, 11 + i) > 0);
        close_priced(&p);
    }
}

/* Rings of all sizes over so few numbers that many are in both. */
TEST(signatures_never_hide_a_common_member)
{
    uint32_t seed = 5, told = 0, clear = 0;

    for (int i = 0; i < 200000; i++) {
        const uint32_t base = shape_random(&seed, 1u << 30);
        const uint32_t a = base, b = base + 1 + shape_random(&seed, 3);
        enc_sign ring[2] = { { { 0, 0 } }, { { 0, 0 } } };
        bool in[2][40] = { { false } }, common = false;
        for (int k = 0; k < 2; k++) {
            enc_sign_add(&ring[k], a);
            enc_sign_add(&ring[k], b);
            for (uint32_t n = shape_random(&seed, 8); n > 0; n--) {
                const uint32_t x = 4 + shape_random(&seed, 36);
                if (!in[k][x])
                    enc_sign_add(&ring[k], base + x);
                in[k][x] = true;
            }
        }
        for (int x = 0; x < 40; x++)
            common |= in[0][x] && in[1][x];
        const bool excluded = enc_sign_excludes(&ring[0], &ring[1], a, b);
        CHECK(!(excluded && common));
        told += excluded;
        clear += !common;
    }
    CHECK(told > clear / 10 * 8);
}

/* Some pairs go, so that quadrics are not about their own planes any more. */
static void contract_some(priced *p)
{
    enc_surface *s = &p->surface;

    for (uint32_t h = 0; h < 3 * p->trial.mesh.face_count; h += 7) {
        if (s->vertex[h] == ENC_NONE || s->twin[h] == ENC_NONE ||
            enc_on_boundary(s, s->vertex[h]) || !enc_surface_can_join(s, h))
            continue;
        const enc_pair pair = enc_surface_pair(s, h, false);
        const enc_offer offer = enc_pricing_offer(&p->pricing, s, &pair);
        enc_pricing_contract(&p->pricing, s, &pair, offer.place);
        enc_surface_contract(s, &pair, offer.place, NULL);
    }
}

TEST(both_directions_cost_what_each_does)
{
    uint32_t apart = 0;
    for (int way = 0; way < 8; way++) {
        priced p;
        open_priced(&p, way & 1 ? SHAPE_TERRAIN : SHAPE_TORUS, 20,
                    way & 2 ? PMESH_ACCUMULATED : PMESH_MEMORYLESS,
                    way & 4 ? PMESH_OPTIMAL : PMESH_SUBSET);
        enc_surface *s = &p.surface;
        survey(&p, (enc_taste){ 1, 0.01, 0.5 });
        contract_some(&p);
        for (uint32_t h = 0; h < 3 * p.trial.mesh.face_count; h++) {
            if (s->vertex[h] == ENC_NONE || s->twin[h] == ENC_NONE)
                continue;
            const enc_pair ways[2] = { enc_surface_pair(s, h, false),
                                       enc_surface_pair(s, h, true) };
            enc_offer both[2];
            enc_pricing_estimate_both(&p.pricing, s, ways, both);
            apart += both[0].quadric != both[1].quadric;
            for (int k = 0; k < 2; k++) {
                const enc_offer one =
                    enc_pricing_estimate(&p.pricing, s, &ways[k]);
                CHECK(memcmp(&one.cost, &both[k].cost, sizeof one.cost) == 0);
                CHECK(memcmp(&one.quadric, &both[k].quadric,
                             sizeof one.quadric) == 0);
            }
        }
        close_priced(&p);
    }
    CHECK(apart > 0);
}

TEST(quantiles_have_eight_bins_an_octave)
{
    static enc_quantile q;

    for (int exponent = -60; exponent < 110; exponent++) {
        for (int part = 16; part < 32; part++) {
            const int bin = 8 * (exponent + 1 - ENC_QUANTILE_LEAST) + part / 2 - 8;
            const int least = 0, most = ENC_QUANTILE_BINS - 1;
            enc_quantile_clear(&q);
            enc_quantile_add(&q, ldexp(part, exponent - 4));
            CHECK(q.bin[bin < least ? least : bin > most ? most : bin] == 1);
        }
    }
}
