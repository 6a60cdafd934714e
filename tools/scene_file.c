/* SPDX-License-Identifier: MIT */
#include "tools/scene_file.h"

#include <string.h>

#include "tools/cmd.h"
#include "tools/draco_base.h"
#include "tools/scene_write.h"
#include "tools/stream.h"

bool scene_file_is(const file_data *data)
{
    return data->size > 0 &&
           pmesh_scene_probe(data->bytes, data->size) == PMESH_OK;
}

void scene_file_unwrap(file_data *data)
{
    size_t offset, size;

    if (!scene_find_stream(data->bytes, data->size, &offset, &size))
        return;
    memmove(data->bytes, data->bytes + offset, size);
    data->size = size;
}

static void look(scene_file *file)
{
    file->has_header =
        pmesh_scene_get_header(file->scene, &file->header) == PMESH_OK;
    file->progress = pmesh_scene_get_progress(file->scene);
}

int scene_file_open(const file_data *data, scene_file *out, asset_error *error)
{
    const pmesh_scene_config config = {
        .decoder = { .max_memory = stream_memory(data->size) + data->size,
                     .base_decoder = draco_base_decode }
    };

    *out = (scene_file){ 0 };
    const pmesh_status made = pmesh_scene_create(&out->scene, &config);
    if (made != PMESH_OK) {
        asset_fail(error, "", "%s", pmesh_status_text(made));
        return CMD_IO;
    }
    const pmesh_status status =
        pmesh_scene_feed(out->scene, data->bytes, data->size);
    look(out);
    if (status >= 0)
        return CMD_DONE;
    const pmesh_decode_error damage = pmesh_scene_error(out->scene);
    return stream_explain(&damage, data->size, error);
}

void scene_file_close(scene_file *file)
{
    pmesh_scene_destroy(file->scene);
    *file = (scene_file){ 0 };
}

bool scene_file_merge(const scene_file *file, bool inflate,
                      scene_library *library, asset *out, asset_error *error)
{
    asset_bytes glb = { 0 };
    asset notes = { 0 };

    *out = (asset){ 0 };
    const bool ok =
        scene_write(file->scene,
                    (scene_style){ .glb = true, .inflate = inflate,
                                   .library = library },
                    &glb, &notes, error) &&
        asset_read(glb.data, glb.size, ASSET_GLB, NULL, out, error);
    asset_bytes_free(&glb);
    return ok;
}

int scene_file_load(const file_data *data, asset *out, asset_error *error)
{
    scene_file file;
    int code = scene_file_open(data, &file, error);

    if (code == CMD_DONE && file.progress.bases == 0) {
        asset_fail(error, "", "cut off after %zu bytes, before the base meshes",
                   data->size);
        code = CMD_STREAM;
    }
    if (code == CMD_DONE) {
        pmesh_scene_refine(file.scene, NULL, NULL);
        if (!scene_file_merge(&file, false, NULL, out, error))
            code = file.progress.complete ? CMD_ASSET : CMD_STREAM;
    }
    if (code == CMD_DONE && !file.progress.complete)
        asset_warn(out, "cut off after %zu bytes", data->size);
    scene_file_close(&file);
    return code;
}
