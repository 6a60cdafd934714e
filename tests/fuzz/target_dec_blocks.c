/* SPDX-License-Identifier: MIT */
/* Chunks that are lost, repeated or swapped: as they were, that is noticed before
 * it shows. With checksums that are made right, and a content hash that fits or
 * not, the file is refused, or good by its own right. */
#include <stdlib.h>
#include <string.h>

#include "format/header.h"
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

/* The next critical chunk from `i` on, or the number of chunks. */
static uint32_t next_critical(const pieces *p, uint32_t i)
{
    while (i < p->count && p->at[i].type >= PMESH_CHUNK_SKIPPABLE)
        i++;
    return i;
}

/* Bytes of a good file up to the first critical chunk that the other has not in
 * its place. */
static size_t common_prefix(const pieces *good, const pieces *other)
{
    size_t size = PMESH_SIGNATURE_SIZE;
    uint32_t i = next_critical(good, 0), k = next_critical(other, 0);
    while (i < good->count && k < other->count &&
           good->at[i].frame == other->at[k].frame) {
        const piece *c = &good->at[i];
        size = (size_t)(c->frame + c->frame_size - good->at[0].frame) +
               PMESH_SIGNATURE_SIZE;
        i = next_critical(good, i + 1);
        k = next_critical(other, k + 1);
    }
    return size;
}

/* A good file's chunks in another order show what its prefix shows. */
static void reorder(const uint8_t *data, size_t size, const pieces *good,
                    fuzz_dice *dice)
{
    pmesh_status status, cut_status;
    pieces p = *good;
    shuffle(&p, dice);
    uint8_t *other = fuzz_room(4 * size + 64);
    size_t made = PMESH_SIGNATURE_SIZE;
    memcpy(other, data, made);
    for (uint32_t i = 0; i < p.count; i++) {
        memcpy(other + made, p.at[i].frame, p.at[i].frame_size);
        made += p.at[i].frame_size;
    }
    pmesh_decoder *shuffled = fuzz_decode(other, made, &status);
    pmesh_decoder *cut = fuzz_decode(data, common_prefix(good, &p), &cut_status);
    FUZZ_CHECK(cut_status >= 0 && (status != PMESH_OK || cut_status == status));
    FUZZ_CHECK(fuzz_same(cut, shuffled));
    pmesh_decoder_destroy(cut);
    pmesh_decoder_destroy(shuffled);
    free(other);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_dice dice = fuzz_dice_of(data, size);
    pmesh_status before, after;
    pieces p;

    if (!pieces_take_apart(data, size, &p) || p.count < 2)
        return 0;
    pmesh_decoder *dec = fuzz_decode(data, size, &before);
    if (before == PMESH_OK)
        reorder(data, size, &p, &dice);
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
