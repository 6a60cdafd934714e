/* SPDX-License-Identifier: MIT */
/* A scene file, at once and in pieces: every mesh is sound, both come to the
 * same, budgets are kept. */
#include <stdlib.h>

#include "decoder/pmesh_scene.h"
#include "tests/fuzz/fuzz.h"
#include "tests/unit/shapes.h"

static pmesh_scene *decode(const uint8_t *data, size_t size, fuzz_dice *dice,
                           pmesh_status *status)
{
    const pmesh_scene_config config = { .decoder = fuzz_config() };
    const uint32_t most = dice ? 1 + fuzz_draw(dice, 5000) : 0;
    pmesh_scene *scene;

    FUZZ_CHECK(pmesh_scene_create(&scene, &config) == PMESH_OK);
    *status = PMESH_NEED_DATA;
    for (size_t at = 0; at < size;) {
        size_t part = dice ? 1 + fuzz_draw(dice, most) : size;
        part = part < size - at ? part : size - at;
        uint8_t *copy = fuzz_copy(data + at, part);
        *status = pmesh_scene_feed(scene, copy, part);
        free(copy);
        at += part;
    }
    return scene;
}

static void check_bytes(pmesh_scene_bytes b)
{
    uint64_t sum = 0; /* reads all of them */
    FUZZ_CHECK(b.arrived <= b.size);
    for (uint64_t i = 0; b.data && i < b.arrived; i++)
        sum += b.data[i];
    FUZZ_CHECK(sum <= 255 * b.arrived);
}

static void check_scene(pmesh_scene *scene, const pmesh_scene_header *h,
                        fuzz_dice *dice)
{
    const uint64_t all = pmesh_scene_get_progress(scene).faces;
    const pmesh_scene_target target = {
        .faces = 1 + fuzz_draw(dice, all < 100000 ? (uint32_t)all + 1 : 100000),
    };
    pmesh_scene_shown low, shown;
    uint64_t sum = 0;

    pmesh_scene_refine(scene, &(pmesh_scene_target){ .faces = 1 }, &low);
    pmesh_scene_refine(scene, &target, &shown);
    FUZZ_CHECK(shown.faces <= target.faces || shown.faces == low.faces);
    for (uint32_t i = 0; i < h->mesh_count; i++) {
        pmesh_decoder *dec = pmesh_scene_mesh(scene, i);
        pmesh_view v;
        if (!dec)
            continue;
        fuzz_sound(dec);
        if (pmesh_decoder_mesh(dec, &v) == PMESH_OK)
            sum += v.face_count;
        FUZZ_CHECK(pmesh_scene_scale(scene, i) >= 0);
    }
    FUZZ_CHECK(sum == shown.faces);
    check_bytes(pmesh_scene_document(scene));
    for (uint32_t i = 0; i < h->resource_count && i < 100; i++)
        check_bytes(pmesh_scene_resource(scene, i));
}

static void compare(pmesh_scene *a, pmesh_scene *b, uint32_t meshes)
{
    pmesh_scene_refine(a, NULL, NULL);
    pmesh_scene_refine(b, NULL, NULL);
    for (uint32_t i = 0; i < meshes && i < 100; i++) {
        const pmesh_decoder *x = pmesh_scene_mesh(a, i);
        const pmesh_decoder *y = pmesh_scene_mesh(b, i);
        FUZZ_CHECK(!x == !y);
        FUZZ_CHECK(!x || shape_view_hash(x) == shape_view_hash(y));
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_dice dice = fuzz_dice_of(data, size);
    pmesh_status whole, pieces;
    pmesh_scene_header h;
    pmesh_scene *scene = decode(data, size, NULL, &whole);
    pmesh_scene *twin = decode(data, size, &dice, &pieces);
    const pmesh_decode_error a = pmesh_scene_error(scene);
    const pmesh_decode_error b = pmesh_scene_error(twin);

    FUZZ_CHECK(whole == pieces && a.offset == b.offset && a.rule == b.rule);
    if (pmesh_scene_get_header(scene, &h) == PMESH_OK) {
        check_scene(scene, &h, &dice);
        compare(scene, twin, h.mesh_count);
    }
    pmesh_scene_destroy(scene);
    pmesh_scene_destroy(twin);
    return 0;
}
