/* SPDX-License-Identifier: MIT */
/* The same bytes in pieces, with moves between budgets on the way: at every
 * border the decoder is where one that got all at once is. */
#include <stdlib.h>

#include "tests/fuzz/fuzz.h"

enum { BORDERS = 4 }; /* that are compared */

/* Pieces of all sizes: single bytes, a few, many. */
static size_t piece(fuzz_dice *dice, size_t left)
{
    static const uint32_t most[] = { 1, 8, 300, 70000 };
    const size_t size = 1 + fuzz_draw(dice, most[fuzz_draw(dice, 4)]);
    return size < left ? size : left;
}

static void compare(pmesh_decoder *dec, pmesh_status status,
                    const uint8_t *data, size_t size)
{
    pmesh_status at_once;
    pmesh_decoder *whole = fuzz_decode(data, size, &at_once);
    const pmesh_progress_state a = pmesh_decoder_progress(dec);
    const pmesh_progress_state b = pmesh_decoder_progress(whole);
    const pmesh_decode_error x = pmesh_decoder_error(dec);
    const pmesh_decode_error y = pmesh_decoder_error(whole);

    FUZZ_CHECK(status == at_once);
    FUZZ_CHECK(a.bytes == b.bytes && a.faces == b.faces);
    FUZZ_CHECK(a.levels == b.levels && a.complete == b.complete);
    FUZZ_CHECK(a.exact_vertices == b.exact_vertices);
    FUZZ_CHECK(x.offset == y.offset && x.rule == y.rule);
    FUZZ_CHECK(fuzz_same(dec, whole));
    pmesh_decoder_destroy(whole);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const pmesh_decoder_config config = fuzz_config();
    fuzz_dice dice = fuzz_dice_of(data, size);
    pmesh_decoder *dec;
    pmesh_status status = PMESH_NEED_DATA;
    uint32_t borders = BORDERS;

    FUZZ_CHECK(pmesh_decoder_create(&dec, &config) == PMESH_OK);
    for (size_t at = 0; at < size;) {
        const size_t part = piece(&dice, size - at);
        uint8_t *copy = fuzz_copy(data + at, part);
        status = pmesh_decoder_feed(dec, copy, part);
        free(copy);
        at += part;
        if (at == size || (borders > 0 && fuzz_draw(&dice, 8) == 0)) {
            compare(dec, status, data, at);
            borders -= at < size;
        } else if (fuzz_draw(&dice, 16) == 0) {
            const pmesh_target target = { .faces = 1 + fuzz_draw(&dice, 3000),
                                          .max_ops = fuzz_draw(&dice, 100) };
            pmesh_changes changes;
            pmesh_decoder_refine(dec, &target, &changes);
            fuzz_sound(dec);
        }
    }
    fuzz_use(dec, &dice);
    pmesh_decoder_destroy(dec);
    return 0;
}
