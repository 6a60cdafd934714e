/* SPDX-License-Identifier: MIT */
/* The integer mathematics that predictions stand on. */
#include "encoder/enc_quantile.h"
#include "format/coder.h"
#include "format/fit.h"
#include "format/star.h"
#include "format/tables.h"
#include "tests/unit/test.h"

#include <stdlib.h>

static uint64_t next_random(uint64_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    return *state;
}

static void check_root(uint32_t value)
{
    const uint64_t root = pmesh_isqrt(value);
    CHECK(root * root <= value && (root + 1) * (root + 1) > value);
}

TEST(square_roots_are_rounded_down)
{
    uint64_t state = 1;
    for (uint32_t value = 0; value < 100000; value++)
        check_root(value);
    for (uint32_t root = UINT16_MAX; root > UINT16_MAX - 1000; root--) {
        check_root(root * root - 1);
        check_root(root * root);
        check_root(root * root + 1);
    }
    check_root(UINT32_MAX);
    for (int i = 0; i < 100000; i++)
        check_root((uint32_t)next_random(&state) >> (i % 32));
}

TEST(shares_of_a_ring_are_quotients)
{
    for (int32_t value = -(1 << 26); value <= 1 << 26; value += 4099)
        for (uint32_t count = 1; count <= PMESH_MAX_RING; count++) {
            const int32_t share = pmesh_share(value, count);
            const int32_t exact = value / (int32_t)count;
            CHECK(share <= exact && share >= exact - 1);
        }
}

/* Random terms, and the sum that the weights make of them. */
static void make_sample(uint64_t *state, const int32_t weight[PMESH_FIT_TERMS],
                        pmesh_sample *out)
{
    int32_t term[PMESH_FIT_TERMS];
    int64_t target = 0;
    for (int t = 0; t < PMESH_FIT_TERMS; t++) {
        term[t] = (int32_t)(next_random(state) % 4096) - 2048;
        target += (int64_t)term[t] * weight[t];
    }
    target >>= 16;
    for (int t = 0; t < PMESH_FIT_TERMS; t++) {
        for (int j = 0; j < PMESH_FIT_TERMS; j++)
            out->product[t][j] = term[t] * term[j];
        out->product[t][PMESH_FIT_TERMS] = (int32_t)(term[t] * target);
    }
}

TEST(a_fit_finds_the_weights_of_its_samples)
{
    static const int32_t wanted[PMESH_FIT_TERMS] = { 30000, -70000, 0,   65536,
                                                     -1000, 12345,  9999 };
    static const int16_t start[2 * PMESH_FIT_TERMS] = { 256, 0, -256, 0 };
    uint64_t state = 7;
    pmesh_fit fit;
    pmesh_sample sample;
    pmesh_fit_init(&fit, start, 2);
    CHECK(fit.weight[0] == 65536 && fit.weight[1] == -65536);
    for (int i = 0; i < 2000; i++) {
        make_sample(&state, wanted, &sample);
        pmesh_fit_learn(&fit, &sample, 1 << 10, 1 << 24);
    }
    for (int t = 0; t < PMESH_FIT_TERMS; t++)
        CHECK(abs(fit.weight[t] - wanted[t]) < 200);
}

TEST(a_fit_stays_within_its_bounds)
{
    static const int16_t start[2 * PMESH_FIT_TERMS] = { 0 };
    uint64_t state = 11;
    pmesh_fit fit;
    pmesh_sample sample;
    pmesh_fit_init(&fit, start, 2);
    for (int i = 0; i < 5000; i++) {
        const int32_t extreme = i % 3 ? (1 << 28) - 1 : -(1 << 28) + 1;
        for (int t = 0; t < PMESH_FIT_TERMS; t++) {
            for (int j = 0; j < t; j++)
                sample.product[t][j] = next_random(&state) & 1 ? extreme : 1;
            sample.product[t][t] = (1 << 28) - 1; /* a square */
            sample.product[t][PMESH_FIT_TERMS] = extreme;
        }
        pmesh_fit_learn(&fit, &sample, 1 << 18, 1 << 24);
        for (int t = 0; t < PMESH_FIT_TERMS; t++)
            CHECK(abs(fit.weight[t]) <= 1 << 19);
    }
}

TEST(bit_models_start_from_tables)
{
    static const uint8_t table[3] = { 0, 200, 1 };
    pmesh_bit bits[3];
    pmesh_bits_start(bits, 3, table);
    CHECK(pmesh_bit_odds(&bits[0]) == 32768 && pmesh_bit_uses(&bits[0]) == 0);
    CHECK(pmesh_bit_odds(&bits[1]) == 200 * 256 + 128);
    CHECK(pmesh_bit_uses(&bits[1]) == 12);
    CHECK(pmesh_bit_odds(&bits[2]) == 384);
}

TEST(quantiles_are_upper_ends_of_bins)
{
    static enc_quantile q;
    enc_quantile_clear(&q);
    for (int i = 1; i <= 1000; i++)
        enc_quantile_add(&q, i);
    enc_quantile_add(&q, 0);
    CHECK(enc_quantile_at(&q, 1) > 1e300);
    for (int share = 1; share < 10; share++) {
        const double at = enc_quantile_at(&q, share / 10.0);
        CHECK(at >= 100 * share - 1 && at <= 100 * share * 1.13 + 1);
    }
}
