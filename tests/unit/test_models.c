/* SPDX-License-Identifier: MIT */
/*
 * The promises on real models: those of PMESH_MODELS, or ../shared/models; no
 * models, nothing to test. With PMESH_LONG set every model is baked with every
 * profile at every depth, otherwise with each of them once.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/unit/faces.h"
#include "tests/unit/shapes.h"
#include "tests/unit/test.h"
#include "tools/load.h"

static const char *const models[] = {
    "armadillo.obj",  "bunny.obj",         "cow.obj",
    "fandisk.obj",    "human.obj",         "koala.obj",
    "mountain.obj",   "penguin.obj",       "pizza.obj",
    "spot.obj",       "CesiumMan.glb",     "bridge-garden.glb",
    "FlightHelmet/FlightHelmet.gltf"
};
enum { MODELS = sizeof models / sizeof models[0] };

typedef struct model {
    asset mesh;
    shape_mesh shape; /* views of the asset */
} model;

static bool model_load(model *m, const char *name)
{
    const char *folder = getenv("PMESH_MODELS");
    char path[4096];
    asset_error error;
    snprintf(path, sizeof path, "%s/%s", folder ? folder : "../shared/models",
             name);
    if (load_mesh(path, &m->mesh, &error) != 0)
        return false;
    memset(&m->shape, 0, sizeof m->shape);
    pmesh_mesh_input *in = &m->shape.input;
    *in = (pmesh_mesh_input){ .positions = m->mesh.positions,
                              .vertex_count = m->mesh.vertex_count,
                              .indices = m->mesh.indices,
                              .face_count = m->mesh.face_count,
                              .materials = m->mesh.materials,
                              .material_count = m->mesh.material_count };
    for (size_t i = 0; i < m->mesh.attribute_count && i < SHAPE_ATTRIBUTES;
         i++) {
        const asset_attribute *a = &m->mesh.attributes[i];
        m->shape.attributes[i] =
            (pmesh_attribute_input){ .kind = a->kind,
                                     .set = a->set,
                                     .components = a->components,
                                     .values = a->values,
                                     .count = a->count,
                                     .indices = a->indices };
        in->attribute_count++;
    }
    in->attributes = m->shape.attributes;
    return true;
}

static void model_bake(const model *m, pmesh_profile profile,
                       pmesh_placement placement, uint8_t bits,
                       shape_bytes *bytes)
{
    pmesh_encoder_config config = pmesh_encoder_config_default();
    pmesh_encode_report report;
    config.profile = profile;
    config.placement = placement;
    config.position_bits = bits;
    CHECK(shape_bake(&m->shape, &config, bytes, &report) == PMESH_OK);
}

static pmesh_decoder *decode_all(const shape_bytes *bytes)
{
    pmesh_status status;
    pmesh_decoder *dec =
        shape_decode(bytes->data, bytes->size, bytes->size, &status);
    CHECK(status == PMESH_OK);
    return dec;
}

TEST(full_detail_of_every_model_is_its_input)
{
    static const uint8_t bits[] = { 10, 12, 14, 16, 21 };
    for (unsigned i = 0; i < MODELS; i++) {
        model m;
        if (!model_load(&m, models[i]))
            continue;
        for (unsigned k = 0; k < 15; k++) {
            if (!getenv("PMESH_LONG") && k % 5 != (k / 5 + i) % 5 && k > 4)
                continue;
            shape_bytes bytes;
            model_bake(&m, (pmesh_profile)((k / 5 + k % 5) % 3),
                       k % 5 == 3 ? PMESH_OPTIMAL : PMESH_SUBSET, bits[k % 5],
                       &bytes);
            pmesh_decoder *dec = decode_all(&bytes);
            CHECK(faces_match(&m.shape.input, dec));
            pmesh_decoder_destroy(dec);
            free(bytes.data);
        }
        asset_free(&m.mesh);
    }
}

/* 200 budgets from base to full, then 1,000 random ones. */
static void budgets_are_met(const char *name)
{
    model m;
    shape_bytes bytes;
    if (!model_load(&m, name))
        return;
    model_bake(&m, PMESH_BALANCED, PMESH_SUBSET, 12, &bytes);
    pmesh_decoder *dec = decode_all(&bytes);
    pmesh_header h;
    pmesh_view v;
    uint32_t seed = 3;
    pmesh_decoder_header(dec, &h);
    pmesh_decoder_refine(dec, NULL, NULL);
    const uint64_t hash = shape_view_hash(dec);
    for (uint32_t i = 0; i <= 1200; i++) {
        const uint32_t range = h.faces - h.base_faces;
        const pmesh_target target = {
            .faces = h.base_faces +
                     (i <= 200 ? (uint32_t)((uint64_t)range * i / 200)
                               : shape_random(&seed, range))
        };
        pmesh_decoder_refine(dec, &target, NULL);
        pmesh_decoder_mesh(dec, &v);
        CHECK(v.face_count <= target.faces &&
              (h.joined || v.face_count + 2 > target.faces));
    }
    pmesh_decoder_refine(dec, NULL, NULL);
    CHECK(shape_view_hash(dec) == hash);
    pmesh_decoder_destroy(dec);
    free(bytes.data);
    asset_free(&m.mesh);
}

TEST(models_meet_face_budgets_and_return_from_walks)
{
    budgets_are_met("bunny.obj");
    budgets_are_met("cow.obj");
    budgets_are_met("human.obj");
    budgets_are_met("FlightHelmet/FlightHelmet.gltf");
}

/* 500 cuts, the ends included. One decoder is fed on, others start anew at
 * every tenth cut: both must show the same. */
static void cuts_are_meshes(const char *name)
{
    model m;
    shape_bytes bytes;
    pmesh_decoder *dec;
    if (!model_load(&m, name))
        return;
    model_bake(&m, PMESH_BALANCED, PMESH_SUBSET, 12, &bytes);
    CHECK(pmesh_decoder_create(&dec, NULL) == PMESH_OK);
    uint32_t faces = 0;
    size_t fed = 0;
    for (size_t i = 0; i <= 500; i++) {
        const size_t size = bytes.size * i / 500;
        pmesh_view v;
        const pmesh_status status =
            pmesh_decoder_feed(dec, bytes.data + fed, size - fed);
        fed = size;
        CHECK(status == (i < 500 ? PMESH_NEED_DATA : PMESH_OK));
        if (pmesh_decoder_refine(dec, NULL, NULL) != PMESH_OK)
            continue;
        pmesh_decoder_mesh(dec, &v);
        CHECK(v.face_count >= faces && shape_view_sound(dec));
        faces = v.face_count;
        if (i % 10 == 0) {
            pmesh_status again;
            pmesh_decoder *other =
                shape_decode(bytes.data, size, 4096, &again);
            pmesh_decoder_refine(other, NULL, NULL);
            CHECK(again == status);
            CHECK(shape_view_hash(other) == shape_view_hash(dec));
            pmesh_decoder_destroy(other);
        }
    }
    pmesh_decoder_destroy(dec);
    free(bytes.data);
    asset_free(&m.mesh);
}

TEST(models_cut_anywhere_are_meshes)
{
    cuts_are_meshes("cow.obj");
    cuts_are_meshes("human.obj");
    cuts_are_meshes("CesiumMan.glb");
}
