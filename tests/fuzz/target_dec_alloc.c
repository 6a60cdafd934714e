/* SPDX-License-Identifier: MIT */
/* An allocation fails, once or from then on: an error, no leak, no harm. Takes
 * scenes, too. */
#include <stdlib.h>

#include "decoder/pmesh_scene.h"
#include "tests/fuzz/fuzz.h"

typedef struct purse {
    uint64_t calls, fails_at, bytes;
    bool for_ever, failed;
} purse;

static void *take(void *user, size_t size)
{
    purse *p = user;
    const uint64_t call = p->calls++;
    if (call == p->fails_at || (call > p->fails_at && p->for_ever)) {
        p->failed = true;
        return NULL;
    }
    p->bytes += size;
    return fuzz_room(size);
}

static void give_back(void *user, void *block, size_t size)
{
    purse *p = user;
    FUZZ_CHECK(block && size <= p->bytes);
    p->bytes -= size;
    free(block);
}

static void decode_mesh(pmesh_decoder_config config, purse *p,
                        const uint8_t *data, size_t size, fuzz_dice *dice)
{
    pmesh_decoder *dec;
    pmesh_status status = pmesh_decoder_create(&dec, &config);
    FUZZ_CHECK(status == (p->failed ? PMESH_E_MEMORY : PMESH_OK));
    FUZZ_CHECK(!dec == p->failed);
    if (!dec)
        return;
    status = pmesh_decoder_feed(dec, data, size);
    FUZZ_CHECK((status == PMESH_E_MEMORY) == p->failed);
    FUZZ_CHECK(pmesh_decoder_feed(dec, data, size) == status ||
               status == PMESH_NEED_DATA);
    fuzz_use(dec, dice);
    pmesh_decoder_destroy(dec);
    FUZZ_CHECK(p->calls <= 2);
}

static void decode_scene(pmesh_decoder_config config, purse *p,
                         const uint8_t *data, size_t size)
{
    const pmesh_scene_config c = { .decoder = config };
    pmesh_scene *scene;
    pmesh_status status = pmesh_scene_create(&scene, &c);
    FUZZ_CHECK(status == (p->failed ? PMESH_E_MEMORY : PMESH_OK));
    FUZZ_CHECK(!scene == p->failed);
    if (!scene)
        return;
    status = pmesh_scene_feed(scene, data, size);
    FUZZ_CHECK((status == PMESH_E_MEMORY) == p->failed);
    pmesh_scene_refine(scene, NULL, NULL);
    pmesh_scene_destroy(scene);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_dice dice = fuzz_dice_of(data, size);
    purse p = { 0 };
    pmesh_decoder_config config = fuzz_config();
    const bool scene = pmesh_scene_probe(data, size) == PMESH_OK;

    p.fails_at = fuzz_draw(&dice, scene ? 12 : 4);
    p.for_ever = fuzz_draw(&dice, 2);
    config.allocator = (pmesh_allocator){ take, give_back, &p };
    uint8_t *copy = fuzz_copy(data, size);
    if (scene)
        decode_scene(config, &p, copy, size);
    else
        decode_mesh(config, &p, copy, size, &dice);
    FUZZ_CHECK(p.bytes == 0);
    free(copy);
    return 0;
}
