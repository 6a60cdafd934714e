/* SPDX-License-Identifier: MIT */
/* A whole file at once: whatever it is, the mesh is sound, budgets are kept, and
 * a second decoder comes to the same. */
#include <string.h>

#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_dice dice = fuzz_dice_of(data, size);
    pmesh_status status, again;
    pmesh_decoder *dec = fuzz_decode(data, size, &status);
    pmesh_decoder *twin = fuzz_decode(data, size, &again);

    const pmesh_decode_error a = pmesh_decoder_error(dec);
    const pmesh_decode_error b = pmesh_decoder_error(twin);
    FUZZ_CHECK(status == again && a.offset == b.offset && a.rule == b.rule);
    FUZZ_CHECK(pmesh_decoder_feed(dec, "more", 4) == status ||
               status == PMESH_NEED_DATA);
    if (status != PMESH_NEED_DATA) {
        fuzz_use(dec, &dice);
        FUZZ_CHECK(fuzz_same(dec, twin));
    }
    pmesh_decoder_destroy(dec);
    pmesh_decoder_destroy(twin);
    return 0;
}
