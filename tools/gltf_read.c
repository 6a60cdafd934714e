/* SPDX-License-Identifier: MIT */
/* gltf_read.c - the stages of the glTF reader in their order. */
#include <stdlib.h>

#include "tools/gltf.h"

static bool build(gltf_model *model, gltf_budget *budget, asset *out,
                  asset_error *error)
{
    gltf_instance *instances;
    size_t count;

    for (size_t i = 0; i < model->accessor_count; i++) {
        if (!gltf_accessor_prepare(&model->accessors[i], budget, error))
            return false;
    }
    if (!gltf_scene_walk(model, &instances, &count, error))
        return false;
    const bool ok = gltf_merge(model, instances, count, out, error);
    free(instances);
    return ok;
}

bool asset_read_gltf(const uint8_t *data, size_t size, const char *path,
                     asset *out, asset_error *error)
{
    gltf_source source = { .path = path };
    gltf_budget budget = gltf_budget_for(size);
    gltf_model model;

    *out = (asset){ 0 };
    if (!gltf_open(data, size, &source, out, error) ||
        !gltf_load(&source, &budget, &model, out, error)) {
        *out = (asset){ 0 };
        return false;
    }
    const bool ok = build(&model, &budget, out, error);
    for (size_t i = 0; i < model.accessor_count; i++)
        free(model.accessors[i].expanded);
    gltf_unload(&model);
    if (!ok) {
        asset_free(out);
        *out = (asset){ 0 };
    }
    return ok;
}
