/* SPDX-License-Identifier: MIT */
/* A scene whose document may say anything, written as glTF in every style; what
 * was written without compression is read again. */
#include <stdlib.h>

#include "tests/fuzz/import.h"
#include "tools/cmd.h"
#include "tools/scene_file.h"

enum { LODS = 3 };

static scene_style style_of(fuzz_dice *dice, uint64_t *faces)
{
    const uint32_t packing = fuzz_draw(dice, 6);
    scene_style style = { .glb = fuzz_draw(dice, 2) != 0,
                          .inflate = fuzz_draw(dice, 4) == 0,
                          .meshopt = packing == 1, .draco = packing == 2 };
    for (int i = 0; i < LODS; i++)
        faces[i] = 1000u >> 3 * i;
    if (fuzz_draw(dice, 4) == 0) {
        style.lod_faces = faces;
        style.lod_count = LODS;
    }
    return style;
}

static void write_scene(scene_file *file, fuzz_dice *dice)
{
    const pmesh_scene_target target = { .faces = 1 + fuzz_draw(dice, 2000) };
    uint64_t faces[LODS];
    const scene_style style = style_of(dice, faces);
    asset notes = { 0 }, mesh;
    asset_bytes out = { 0 };
    asset_error error = { "", "" };

    pmesh_scene_refine(file->scene, &target, NULL);
    const bool good = scene_write(file->scene, style, &out, &notes, &error);
    if (!good)
        fuzz_error_sound(&error);
    else if (asset_read(out.data, out.size, style.glb ? ASSET_GLB : ASSET_GLTF,
                        NULL, &mesh, &error))
        asset_free(&mesh);
    asset_bytes_free(&out);
}

static void merge_scene(const scene_file *file)
{
    scene_library library = { .stem = "x" };
    asset mesh;
    asset_error error = { "", "" };

    if (scene_file_merge(file, false, &library, &mesh, &error)) {
        fuzz_asset_sound(&mesh);
        asset_free(&mesh);
    } else {
        fuzz_error_sound(&error);
    }
    scene_library_free(&library);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    fuzz_dice dice = fuzz_dice_of(bytes, size);
    uint8_t *owned = fuzz_copy(bytes, size);
    file_data data = { .bytes = owned, .size = size };
    scene_file file;
    asset_error error = { "", "" };

    scene_file_unwrap(&data);
    if (scene_file_is(&data)) {
        if (scene_file_open(&data, &file, &error) != CMD_DONE)
            fuzz_error_sound(&error);
        if (file.progress.bases > 0) {
            write_scene(&file, &dice);
            merge_scene(&file);
        }
        scene_file_close(&file);
    }
    free(owned);
    return 0;
}
