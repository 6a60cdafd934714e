/* SPDX-License-Identifier: MIT */
#include "tools/scene_budget.h"

#include <stdlib.h>

/* Adds instances x faces. A document may name a mesh often enough for a sum of
 * such to pass 2^64, where no budget would be too small. */
static void add_drawn(uint64_t *drawn, uint64_t instances, uint64_t faces)
{
    const uint64_t left = UINT64_MAX - *drawn;
    *drawn = faces > 0 && instances > left / faces
                 ? UINT64_MAX
                 : *drawn + instances * faces;
}

/* What is not known yet counts once. */
static void count_all(scene_budget *b, const pmesh_scene_header *h)
{
    pmesh_header mesh;

    b->all = b->stored = h->levels[h->level_count - 1].faces;
    for (uint32_t i = 0; i < b->mesh_count; i++) {
        const pmesh_decoder *dec = pmesh_scene_mesh(b->scene, i);
        if (dec && pmesh_decoder_header(dec, &mesh) == PMESH_OK)
            add_drawn(&b->all, b->instances[i] - 1, mesh.faces);
    }
}

bool scene_budget_open(pmesh_scene *scene, scene_budget *out,
                       asset_error *error)
{
    pmesh_scene_header h;

    *out = (scene_budget){ .scene = scene };
    if (pmesh_scene_get_header(scene, &h) != PMESH_OK)
        return asset_fail(error, "", "cut off within the header");
    out->mesh_count = h.mesh_count;
    out->instances = calloc((size_t)h.mesh_count + 1, sizeof *out->instances);
    out->share = calloc((size_t)h.mesh_count + 1, sizeof *out->share);
    if (!out->instances || !out->share)
        return asset_fail(error, "", "out of memory");
    if (!scene_instances(scene, h.mesh_count, out->instances, error))
        return false;
    for (uint32_t i = 0; i < h.mesh_count; i++)
        out->instances[i] += out->instances[i] == 0;
    count_all(out, &h);
    return true;
}

void scene_budget_close(scene_budget *budget)
{
    free(budget->instances);
    free(budget->share);
    *budget = (scene_budget){ 0 };
}

uint64_t scene_budget_drawn(const scene_budget *b)
{
    uint64_t drawn = 0;
    pmesh_view view;

    for (uint32_t i = 0; i < b->mesh_count; i++) {
        const pmesh_decoder *dec = pmesh_scene_mesh(b->scene, i);
        if (dec && pmesh_decoder_mesh(dec, &view) == PMESH_OK)
            add_drawn(&drawn, b->instances[i], view.face_count);
    }
    return drawn;
}

/* Faces drawn at most if the decoder may show `stored` of them. */
static uint64_t most_drawn(const scene_budget *b, uint64_t stored)
{
    const pmesh_scene_target target = { .faces = stored };
    uint64_t drawn = 0;

    pmesh_scene_share(b->scene, &target, b->share);
    for (uint32_t i = 0; i < b->mesh_count; i++)
        add_drawn(&drawn, b->instances[i], b->share[i]);
    return drawn;
}

/* A larger budget takes no face from any mesh, so halving finds it. */
uint64_t scene_budget_stored(const scene_budget *b, uint64_t faces)
{
    uint64_t fits = 1, over = b->stored + 1;

    if (faces == 0)
        return 0;
    while (over - fits > 1) {
        const uint64_t middle = fits + (over - fits) / 2;
        if (most_drawn(b, middle) <= faces)
            fits = middle;
        else
            over = middle;
    }
    return fits;
}
