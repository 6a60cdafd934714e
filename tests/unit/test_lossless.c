/* SPDX-License-Identifier: MIT */
/* From a file of any format through a lossless .pmesh into any other: the
 * same floats, of our own meshes and of real ones. */
#include <float.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/unit/float_faces.h"
#include "tests/unit/shapes.h"
#include "tests/unit/test.h"
#include "tools/asset.h"
#include "tools/load.h"

typedef struct face_set {
    float_face *faces;
    size_t count;
} face_set;

static face_set set_of(const asset *mesh)
{
    face_set s = { malloc((mesh->face_count + 1) * sizeof *s.faces), 0 };
    s.count = float_faces_of(mesh->positions, mesh->vertex_count,
                             mesh->indices, mesh->face_count, s.faces);
    return s;
}

static bool same_set(const asset *mesh, const face_set *want)
{
    const face_set s = set_of(mesh);
    const bool same =
        s.count == want->count &&
        memcmp(s.faces, want->faces, s.count * sizeof *s.faces) == 0;
    free(s.faces);
    return same;
}

/* A decoder with the whole of `mesh`, baked without attributes. */
static pmesh_decoder *bake(const asset *mesh, pmesh_placement placement)
{
    shape_mesh shape = { .input = { .positions = mesh->positions,
                                    .vertex_count = mesh->vertex_count,
                                    .indices = mesh->indices,
                                    .face_count = mesh->face_count } };
    pmesh_encoder_config config = pmesh_encoder_config_default();
    pmesh_encode_report report;
    pmesh_status status;
    shape_bytes bytes;
    config.lossless = 1;
    config.placement = placement;
    CHECK(shape_bake(&shape, &config, &bytes, &report) == PMESH_OK);
    pmesh_decoder *dec =
        shape_decode(bytes.data, bytes.size, bytes.size, &status);
    CHECK(status == PMESH_OK);
    CHECK(pmesh_decoder_refine(dec, NULL, NULL) == PMESH_OK);
    free(bytes.data);
    return dec;
}

static void check_formats(const asset *mesh, pmesh_placement placement,
                          asset_format first, asset_format last)
{
    const face_set want = set_of(mesh);
    pmesh_decoder *dec = bake(mesh, placement);
    asset whole, back;
    asset_error error;
    CHECK(asset_from_decoder(dec, &whole, &error));
    CHECK(same_set(&whole, &want));
    for (asset_format f = first; f <= last; f++) {
        asset_bytes bytes = { 0 };
        CHECK(asset_write(&whole, f, &bytes, &error));
        CHECK(asset_read(bytes.data, bytes.size, f, NULL, &back, &error));
        CHECK(same_set(&back, &want));
        asset_free(&back);
        asset_bytes_free(&bytes);
    }
    asset_free(&whole);
    pmesh_decoder_destroy(dec);
    free(want.faces);
}

TEST(every_format_but_drc_carries_every_bit)
{
    static double xyz[] = { 0.1,    -0.0,   1e-45, 3,     0,   1e-6,
                            -0.0,   2.5,    7e-39, 1e30,  1,   2,
                            1 / 3., 123456, 0,     -1e-7, 9e9, -5e-324 };
    static uint32_t tri[] = { 0, 1, 2, 0, 2, 3, 2, 1, 4, 3, 2, 5 };
    const asset mesh = { .positions = xyz, .vertex_count = 6,
                         .indices = tri, .face_count = 4 };
    check_formats(&mesh, PMESH_SUBSET, ASSET_OBJ, ASSET_GLB);
}

TEST(floats_far_from_the_origin_stay_where_they_are)
{
    static double xyz[] = { 70001, 80001, 90001, 70002.0078125, 80001, 90001,
                            70001, 80002, 90001.0078125 };
    static uint32_t tri[] = { 0, 1, 2 };
    const asset mesh = { .positions = xyz, .vertex_count = 3,
                         .indices = tri, .face_count = 1 };
    check_formats(&mesh, PMESH_SUBSET, ASSET_OBJ, ASSET_GLB);
}

TEST(real_models_come_back_bit_for_bit)
{
    static const char *const names[] = {
        "bunny.obj",     "fandisk.obj",
        "cow.obj",       "human.obj",
        "penguin.obj",   "CesiumMan.glb",
        "mountain.obj",  "FlightHelmet/FlightHelmet.gltf",
        "bridge-garden.glb"
    };
    const char *folder = getenv("PMESH_MODELS");
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        char path[1024];
        asset mesh;
        asset_error error;
        snprintf(path, sizeof path, "%s/%s",
                 folder ? folder : "../shared/models", names[i]);
        if (load_mesh(path, &mesh, &error) != 0)
            continue; /* not there */
        check_formats(&mesh, (pmesh_placement)(i & 1), ASSET_PLY, ASSET_STL);
        asset_free(&mesh);
    }
}
