/* SPDX-License-Identifier: MIT */
/* Numbers taken by eights: every way of writing that gives the same bits. */
#include "tests/unit/lanes_ways.h"
#include "tests/unit/test.h"

#include <string.h>

/* Small, large and extreme numbers. Two of the smallest next to each other
 * would make a product's sum of 2^31, which no caller does. */
static int16_t random_short(uint32_t *state)
{
    static const int16_t extreme[] = { -32767, 32767, 0, -1, 1, 16384, -16384 };
    *state = *state * 1664525 + 1013904223;
    const uint32_t r = *state >> 8;
    return r % 4 == 0   ? extreme[r / 4 % 7]
           : r % 4 == 1 ? (int16_t)((int32_t)(r / 4 % 512) - 256)
                        : (int16_t)((int32_t)(r / 4 % 65535) - 32767);
}

TEST(all_ways_to_take_numbers_by_eights_agree)
{
    uint32_t state = 1;
    for (int round = 0; round < 20000; round++) {
        int16_t in[LANES_IN];
        int32_t a[LANES_OUT], b[LANES_OUT];
        for (int i = 0; i < LANES_IN; i++)
            in[i] = random_short(&state);
        const uint32_t count = lanes_plain(in, a);
        CHECK(count <= LANES_OUT);
        CHECK(lanes_vectors(in, b) == count);
        CHECK(memcmp(a, b, count * sizeof *a) == 0);
        CHECK(lanes_usual(in, b) == count);
        CHECK(memcmp(a, b, count * sizeof *a) == 0);
    }
}

TEST(numbers_by_eights_round_down_and_wrap)
{
    static const int16_t in[LANES_IN] = {
        -32767, 32767, -1, 3, 300, -300, 5, 0, -2, 2, 1, 3, 300, 300, 5, 9
    };
    int32_t out[LANES_OUT];
    lanes_usual(in, out);
    CHECK(out[0] == 32767 && out[1] == -32767 && out[2] == 0); /* sums */
    CHECK(out[8] == -32765 && out[10] == -2);                  /* differences */
    CHECK(out[48] == 0 && out[49] == 0 && out[50] == -1); /* high products */
    CHECK(out[52] == 1 && out[53] == -2);
}
