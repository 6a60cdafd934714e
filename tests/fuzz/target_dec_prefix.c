/* SPDX-License-Identifier: MIT */
/* A cut anywhere: not more faces than with all bytes, and those that the rest
 * shows at that size. */
#include <stdlib.h>

#include "tests/fuzz/fuzz.h"
#include "tests/unit/shapes.h"

/* The whole at the cut's size is the cut. Where sheets join, a split may add no
 * face, so that the number of faces does not tell the size. */
static void is_genuine(pmesh_decoder *whole, pmesh_decoder *cut)
{
    pmesh_view v, w;
    pmesh_header h;
    pmesh_decoder_mesh(cut, &v);
    pmesh_decoder_header(cut, &h);
    const pmesh_target target = { .faces = v.face_count };
    FUZZ_CHECK(pmesh_decoder_refine(whole, &target, NULL) == PMESH_OK);
    pmesh_decoder_mesh(whole, &w);
    FUZZ_CHECK(w.face_count == v.face_count);
    if (w.mesh_vertex_count == v.mesh_vertex_count || !h.joined)
        FUZZ_CHECK(shape_view_hash(whole) == shape_view_hash(cut));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_dice dice = fuzz_dice_of(data, size);
    pmesh_status status, cut_status;
    pmesh_decoder *whole = fuzz_decode(data, size, &status);

    for (int i = 0; i < 3; i++) {
        const uint32_t at = fuzz_draw(&dice, (uint32_t)size + 1);
        pmesh_decoder *cut = fuzz_decode(data, at, &cut_status);
        FUZZ_CHECK(cut_status == PMESH_NEED_DATA || cut_status == status);
        FUZZ_CHECK(pmesh_decoder_progress(cut).faces <=
                   pmesh_decoder_progress(whole).faces);
        fuzz_sound(cut);
        if (pmesh_decoder_refine(cut, NULL, NULL) == PMESH_OK)
            is_genuine(whole, cut);
        pmesh_decoder_destroy(cut);
    }
    pmesh_decoder_destroy(whole);
    return 0;
}
