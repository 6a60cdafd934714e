/* SPDX-License-Identifier: MIT */
/* Any bytes as a glTF scene, .gltf or .glb: baked with all that is in it, decoded,
 * written again, and read again. */
#include <stdlib.h>

#include "tests/fuzz/import.h"
#include "tools/bake_scene.h"
#include "tools/cmd.h"
#include "tools/scene_file.h"

enum { MOST_FACES = 1000 };

static int bake(void *user, const char *name, const asset *mesh,
                unsigned threads, bake_report *report, asset_bytes *out)
{
    (void)name;
    (void)threads;
    fuzz_asset_sound(mesh);
    if (mesh->face_count > MOST_FACES)
        return CMD_ASSET;
    return fuzz_bake(mesh, user, out, &report->encode) == PMESH_OK ? CMD_DONE
                                                                   : CMD_ASSET;
}

static void check_scene(const asset_bytes *baked)
{
    const file_data data = { .bytes = baked->data, .size = baked->size };
    asset notes = { 0 }, mesh;
    asset_bytes out = { 0 };
    asset_error error;
    scene_file file;

    FUZZ_CHECK(scene_file_open(&data, &file, &error) == CMD_DONE);
    FUZZ_CHECK(file.progress.complete);
    pmesh_scene_refine(file.scene, NULL, NULL);
    FUZZ_CHECK(scene_write(file.scene, (scene_style){ .glb = true }, &out,
                           &notes, &error));
    if (asset_read(out.data, out.size, ASSET_GLB, NULL, &mesh, &error))
        asset_free(&mesh); /* what no node shows is no mesh */
    asset_bytes_free(&out);
    scene_file_close(&file);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    fuzz_dice dice = fuzz_dice_of(bytes, size);
    uint8_t *copy = fuzz_copy(bytes, size);
    const file_data data = { .bytes = copy, .size = size };
    bake_report report = { .input = "-", .output = "-" };
    asset_bytes out = { 0 };

    if (bake_scene(&data, 1, bake, &dice, false, false, &report, &out) ==
        CMD_DONE)
        check_scene(&out);
    asset_bytes_free(&out);
    free(copy);
    return 0;
}
