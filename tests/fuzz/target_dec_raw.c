/* SPDX-License-Identifier: MIT */
/* Without the mutator that mends checksums: a file that is accepted as whole has
 * only right ones, by a count of its own. */
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/pieces.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    pmesh_status status;
    pmesh_decoder *dec = fuzz_decode(data, size, &status);
    pieces p;

    fuzz_sound(dec);
    pmesh_decoder_refine(dec, NULL, NULL);
    fuzz_sound(dec);
    if (status == PMESH_OK) {
        FUZZ_CHECK(pieces_take_apart(data, size, &p));
        FUZZ_CHECK(p.count == PIECES ||
                   (p.fit && pieces_hash(&p) == pieces_hash_stored(&p)));
    }
    pmesh_decoder_destroy(dec);
    return 0;
}
