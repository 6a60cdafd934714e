/* SPDX-License-Identifier: MIT */
/* Any bytes as a guide file for a small mesh: an error with a reason, or a guide
 * that the encoder takes, and that is read again as it is written. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/fuzz/import.h"
#include "tools/guide.h"

/* A strip of quads with texture coordinates. */
static const char strip[] =
    "v 0 0 0\nv 0 1 0\nv 1 0 .1\nv 1 1 .2\nv 2 0 0\nv 2 1 .1\nv 3 0 .2\n"
    "v 3 1 0\nvt 0 0\nvt 0 1\nvt 1 0\nvt 1 1\nusemtl a\nf 1/1 3/3 4/4 2/2\n"
    "f 3/1 5/3 6/4 4/2\nusemtl b\nf 5/1 7/3 8/4 6/2\n";

static void check_guide(const pmesh_guide *g, size_t vertices)
{
    for (size_t i = 0; g->weights && i < vertices; i++)
        FUZZ_CHECK(isnan(g->weights[i]) ||
                   (g->weights[i] >= 0 && g->weights[i] <= 1));
    for (size_t i = 0; g->segments && i < vertices; i++)
        FUZZ_CHECK(g->segments[i] < g->segment_count);
    for (size_t i = 0; g->shares && i < g->segment_count; i++)
        FUZZ_CHECK(g->shares[i] >= 0 && g->shares[i] <= 1);
    for (size_t i = 0; i < g->constraint_count; i++)
        for (size_t k = 0; k < g->constraints[i].vertex_count; k++)
            FUZZ_CHECK(g->constraints[i].vertices[k] < vertices);
}

static int discard(void *user, const void *data, size_t size)
{
    (void)user;
    (void)data;
    (void)size;
    return 0;
}

static void bake(const pmesh_guide *g, const asset *mesh)
{
    pmesh_encoder_config config = pmesh_encoder_config_default();
    const pmesh_mesh_input input = {
        .positions = mesh->positions, .vertex_count = mesh->vertex_count,
        .indices = mesh->indices, .face_count = mesh->face_count
    };
    config.guide = g;
    config.base_faces = 1;
    const pmesh_status status =
        pmesh_encode(&input, &config, discard, NULL, NULL);
    FUZZ_CHECK(status == PMESH_OK || status == PMESH_E_ARGUMENT);
}

static void write_again(const guide *g, const asset *mesh)
{
    asset_bytes text = { 0 };
    asset_error error;
    guide again;

    FUZZ_CHECK(guide_write(g, mesh, &text) && guide_create(&again));
    FUZZ_CHECK(guide_read(&again, text.data, text.size, mesh, &error));
    guide_free(&again);
    asset_bytes_free(&text);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    uint8_t *copy = fuzz_copy(data, size);
    asset mesh;
    asset_error error = { "", "" };
    guide g;

    FUZZ_CHECK(asset_read((const uint8_t *)strip, sizeof strip - 1, ASSET_OBJ,
                          NULL, &mesh, &error));
    FUZZ_CHECK(guide_create(&g));
    if (guide_read(&g, copy, size, &mesh, &error)) {
        check_guide(&g.use, mesh.vertex_count);
        bake(&g.use, &mesh);
        write_again(&g, &mesh);
    } else {
        fuzz_error_sound(&error);
    }
    guide_free(&g);
    asset_free(&mesh);
    free(copy);
    return 0;
}
