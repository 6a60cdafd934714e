/* SPDX-License-Identifier: MIT */
/* Chunks that are lost, repeated or swapped, with a content hash that fits or
 * not: the file is refused, or good by its own right. */
#include <stdlib.h>

#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/pieces.h"

static void shuffle(pieces *p, fuzz_dice *dice)
{
    for (uint32_t n = 1 + fuzz_draw(dice, 3); n > 0 && p->count > 1; n--) {
        const uint32_t a = fuzz_draw(dice, p->count);
        const uint32_t b = fuzz_draw(dice, p->count);
        const piece keep = p->at[a];
        const uint32_t way = fuzz_draw(dice, 3);
        if (way == 0) {
            p->count--;
            for (uint32_t i = a; i < p->count; i++)
                p->at[i] = p->at[i + 1];
        } else if (way == 1 && p->count < PIECES) {
            for (uint32_t i = p->count++; i > b; i--)
                p->at[i] = p->at[i - 1];
            p->at[b] = keep;
        } else {
            p->at[a] = p->at[b];
            p->at[b] = keep;
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_dice dice = fuzz_dice_of(data, size);
    pmesh_status before, after;
    pieces p;

    if (!pieces_take_apart(data, size, &p) || p.count < 2)
        return 0;
    pmesh_decoder *dec = fuzz_decode(data, size, &before);
    const bool mend = fuzz_draw(&dice, 2);
    const uint64_t hash = pieces_hash(&p);
    shuffle(&p, &dice);
    const size_t room = 4 * size + 64;
    uint8_t *other = fuzz_room(room);
    const size_t made = pieces_put_together(&p, mend, other, room);
    pmesh_decoder *shuffled = fuzz_decode(other, made, &after);
    fuzz_use(shuffled, &dice);
    if (!mend && before == PMESH_OK && after == PMESH_OK)
        FUZZ_CHECK(pieces_hash(&p) == hash && fuzz_same(dec, shuffled));
    free(other);
    pmesh_decoder_destroy(shuffled);
    pmesh_decoder_destroy(dec);
    return 0;
}
