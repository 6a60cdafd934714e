/* SPDX-License-Identifier: MIT */
/* The range coder gives back what it took. */
#include "format/coder.h"
#include "tests/unit/shapes.h"
#include "tests/unit/test.h"

enum { ROOM = 1 << 16, MODELS = 8 };

/* A walk through all kinds of symbols; decoding, values must be those that were
 * encoded. `skew`: how many of 256 bits are 1. */
static bool walk(pmesh_coder *c, uint32_t seed, uint32_t count, uint32_t skew)
{
    pmesh_bit bits[MODELS], tree[7];
    pmesh_number number;
    bool same = true;
    pmesh_bits_init(bits, MODELS);
    pmesh_bits_init(tree, 7);
    pmesh_number_init(&number);
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t kind = shape_random(&seed, 16);
        const uint32_t bit = shape_random(&seed, 256) < skew;
        const uint32_t more = shape_random(&seed, 1u << 16);
        const uint32_t wide = bit ? UINT32_MAX - more : more;
        if (kind == 0)
            same &= pmesh_code_raw(c, 32, c->encoding ? wide : 0) == wide;
        else if (kind == 1)
            same &= pmesh_code_number(c, &number, c->encoding ? wide : 0) ==
                    wide;
        else if (kind == 2)
            same &= pmesh_code_tree(c, tree, 3, c->encoding ? more % 8 : 0) ==
                    more % 8;
        else if (kind < 8)
            same &= pmesh_code_bit(c, &bits[kind % MODELS],
                                   c->encoding ? bit : 0) == bit;
        else
            same &= pmesh_code_bit_twice(c, &bits[more % MODELS],
                                         &bits[kind % 4],
                                         c->encoding ? bit : 0) == bit;
    }
    return same;
}

TEST(range_coder_gives_back_what_it_took)
{
    static const uint32_t skews[] = { 0, 1, 128, 255, 256 };
    static uint8_t data[ROOM];
    for (uint32_t seed = 0; seed < 400; seed++) {
        const uint32_t count = seed < 50 ? seed : 50 * (seed % 40);
        const uint32_t skew = skews[seed % 5];
        pmesh_writer out = { .data = data, .size = 3, .capacity = ROOM };
        pmesh_coder c;
        pmesh_coder_encode(&c, &out);
        CHECK(walk(&c, seed, count, skew));
        const double spent = (double)pmesh_coder_spent(&c) / (8 * 256);
        CHECK(pmesh_coder_finish(&c));
        CHECK(out.size == 3 || data[out.size - 1] != 0);
        CHECK((double)(out.size - 3) < spent + 2);
        pmesh_coder_decode(&c, data + 3, out.size - 3);
        CHECK(walk(&c, seed, count, skew));
        CHECK(pmesh_coder_finish(&c));
    }
}

/* Symbols that keep the middle of all in the range, then one that goes beyond:
 * it raises a byte and all the 0xff behind that. */
TEST(range_coder_carries_through_many_bytes)
{
    enum { ODDS = 30000, SYMBOLS = 300 };
    uint8_t data[256], bits[SYMBOLS + 100];
    pmesh_writer out = { .data = data, .capacity = sizeof data };
    uint64_t middle = (uint64_t)1 << 63;
    pmesh_coder c;
    int count = 0;
    pmesh_coder_encode(&c, &out);
    for (bool beyond = false; !beyond; count++) {
        const uint64_t bound = (c.range >> 16) * ODDS;
        beyond = count >= SYMBOLS && middle < bound;
        bits[count] = middle > bound || beyond;
        const uint64_t left = bits[count] ? c.range - bound : bound;
        middle = (middle - (bits[count] ? bound : 0)) << (left >> 32 ? 0 : 32);
        if (beyond)
            CHECK(data[0] == 0x7f && data[1] == 0xff && data[20] == 0xff);
        pmesh_code_odds(&c, ODDS, bits[count]);
    }
    CHECK(out.size > 20 && data[0] == 0x80 && data[1] == 0 && data[20] == 0);
    CHECK(pmesh_coder_finish(&c));
    pmesh_coder_decode(&c, data, out.size);
    for (int i = 0; i < count; i++)
        CHECK(pmesh_code_odds(&c, ODDS, 0) == bits[i]);
    CHECK(pmesh_coder_finish(&c));
}

TEST(range_coder_says_when_it_ran_out_of_room)
{
    uint8_t data[16];
    pmesh_writer out = { .data = data, .capacity = sizeof data };
    pmesh_coder c;
    pmesh_coder_encode(&c, &out);
    for (int i = 0; i < 20; i++)
        pmesh_code_raw(&c, 32, UINT32_MAX);
    CHECK(!pmesh_coder_finish(&c));
}
