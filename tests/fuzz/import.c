/* SPDX-License-Identifier: MIT */
#include "tests/fuzz/import.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Meshes above this are only read: baking them tests nothing else. */
enum { SMALL = 300 };

/* MSan takes what C++ has written, in libraries built without it, for never
 * written: the formats after OFF are written through such. */
#if defined(__has_feature)
#if __has_feature(memory_sanitizer)
#define LAST_FORMAT ASSET_OFF
#endif
#endif
#ifndef LAST_FORMAT
#define LAST_FORMAT ASSET_DRC
#endif

static void check_text(const char *text, size_t room)
{
    const size_t size = strnlen(text, room);
    FUZZ_CHECK(size < room);
    for (size_t i = 0; i < size; i++)
        FUZZ_CHECK(((unsigned char)text[i] >= 0x20 && text[i] != 0x7f) ||
                   text[i] == '\n');
}

void fuzz_error_sound(const asset_error *error)
{
    check_text(error->where, sizeof error->where);
    check_text(error->what, sizeof error->what);
    FUZZ_CHECK(*error->what && !strchr(error->what, '\n'));
}

static void check_attribute(const asset *mesh, const asset_attribute *a)
{
    const uint8_t least = a->kind == PMESH_NORMAL || a->kind == PMESH_COLOR
                              ? 3
                          : a->kind == PMESH_TEXCOORD ? 2
                                                      : 1;
    FUZZ_CHECK(a->components >= least &&
               a->components <= PMESH_MAX_COMPONENTS);
    FUZZ_CHECK(a->indices || a->count == mesh->vertex_count);
    for (size_t i = 0; a->indices && i < 3 * mesh->face_count; i++)
        FUZZ_CHECK(a->indices[i] < a->count);
}

void fuzz_asset_sound(const asset *mesh)
{
    FUZZ_CHECK(mesh->face_count > 0 && mesh->vertex_count > 0);
    for (size_t i = 0; i < 3 * mesh->face_count; i++)
        FUZZ_CHECK(mesh->indices[i] < mesh->vertex_count);
    for (size_t i = 0; mesh->materials && i < mesh->face_count; i++)
        FUZZ_CHECK(mesh->materials[i] < mesh->material_count);
    for (size_t i = 0; mesh->material_names && i < mesh->material_count; i++)
        FUZZ_CHECK(mesh->material_names[i] &&
                   strlen(mesh->material_names[i]) < SIZE_MAX);
    FUZZ_CHECK(mesh->attribute_count <= PMESH_MAX_ATTRIBUTES);
    for (size_t i = 0; i < mesh->attribute_count; i++)
        check_attribute(mesh, &mesh->attributes[i]);
    check_text(mesh->warnings, sizeof mesh->warnings);
}

/* What asset_read() repairs; a scene leaves it to the encoder. */
static void check_repaired(const asset *mesh)
{
    for (size_t i = 0; i < mesh->attribute_count; i++) {
        const asset_attribute *a = &mesh->attributes[i];
        for (size_t k = 0; k < a->components * a->count; k++)
            FUZZ_CHECK(isfinite(a->values[k]));
    }
}

static int collect(void *user, const void *data, size_t size)
{
    asset_put(user, data, size);
    return ((asset_bytes *)user)->failed;
}

pmesh_status fuzz_bake(const asset *mesh, fuzz_dice *dice, asset_bytes *out,
                       pmesh_encode_report *report)
{
    pmesh_attribute_input attributes[PMESH_MAX_ATTRIBUTES];
    pmesh_encoder_config config = pmesh_encoder_config_default();

    for (size_t i = 0; i < mesh->attribute_count; i++) {
        const asset_attribute *a = &mesh->attributes[i];
        attributes[i] = (pmesh_attribute_input){
            .kind = a->kind, .set = a->set, .components = a->components,
            .bits = a->bits, .values = a->values, .count = a->count,
            .indices = a->indices
        };
    }
    const pmesh_mesh_input input = {
        .positions = mesh->positions, .vertex_count = mesh->vertex_count,
        .indices = mesh->indices, .face_count = mesh->face_count,
        .materials = mesh->materials, .material_count = mesh->material_count,
        .material_names = (const char *const *)mesh->material_names,
        .attributes = attributes, .attribute_count = mesh->attribute_count
    };
    config.profile = (pmesh_profile)fuzz_draw(dice, 3);
    config.placement = (pmesh_placement)fuzz_draw(dice, 2);
    config.lossless = (int)fuzz_draw(dice, 2);
    config.base_faces = 1 + fuzz_draw(dice, 20);
    *report = (pmesh_encode_report){ 0 };
    return pmesh_encode(&input, &config, collect, out, report);
}

/* What was baked is a whole file of as many faces as the report says. */
static void check_baked(const asset *mesh, fuzz_dice *dice)
{
    asset_bytes file = { 0 };
    pmesh_encode_report report;
    pmesh_status status = fuzz_bake(mesh, dice, &file, &report);

    FUZZ_CHECK(status == PMESH_OK || status == PMESH_E_NO_FACES ||
               status == PMESH_E_NOT_FINITE);
    if (status == PMESH_OK) {
        pmesh_header h;
        FUZZ_CHECK(report.bytes == file.size);
        pmesh_decoder *dec = fuzz_decode(file.data, file.size, &status);
        FUZZ_CHECK(status == PMESH_OK);
        pmesh_decoder_header(dec, &h);
        FUZZ_CHECK(h.faces == report.faces && h.bytes == file.size);
        fuzz_use(dec, dice);
        pmesh_decoder_destroy(dec);
    }
    asset_bytes_free(&file);
}

/* Every format can hold its positions; glTF leaves room to compute. */
static bool is_moderate(const asset *mesh)
{
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
        if (!(fabs(mesh->positions[i]) < 1e30))
            return false;
    return true;
}

/* Draco takes differences of values as floats. */
static bool draco_can_hold(const asset *mesh)
{
    for (size_t i = 0; i < mesh->attribute_count; i++) {
        const asset_attribute *a = &mesh->attributes[i];
        for (size_t k = 0; k < a->count * a->components; k++)
            if (fabsf(a->values[k]) > FLT_MAX / 2)
                return false;
    }
    return true;
}

/* What our writers write our readers read. */
static void check_written(const asset *mesh, asset_format format)
{
    asset_bytes file = { 0 };
    asset_error error;
    asset back;

    if (!asset_write(mesh, format, &file, &error)) {
        FUZZ_CHECK(format == ASSET_DRC && !draco_can_hold(mesh));
        fuzz_error_sound(&error);
        asset_bytes_free(&file);
        return;
    }
    FUZZ_CHECK(asset_read(file.data, file.size, format, NULL, &back, &error));
    fuzz_asset_sound(&back);
    FUZZ_CHECK(back.face_count == mesh->face_count);
    asset_free(&back);
    asset_bytes_free(&file);
}

void fuzz_import(const uint8_t *data, size_t size, asset_format format)
{
    fuzz_dice dice = fuzz_dice_of(data, size);
    uint8_t *copy = fuzz_copy(data, size);
    asset mesh;
    asset_error error = { "", "" };

    const bool good = asset_read(copy, size, format, NULL, &mesh, &error);
    free(copy);
    if (!good) {
        fuzz_error_sound(&error);
        FUZZ_CHECK(!mesh.positions && !mesh.indices && !mesh.face_count);
        return;
    }
    fuzz_asset_sound(&mesh);
    check_repaired(&mesh);
    if (mesh.face_count <= SMALL && mesh.vertex_count <= 10 * SMALL) {
        check_baked(&mesh, &dice);
        if (is_moderate(&mesh))
            for (asset_format f = ASSET_OBJ; f <= LAST_FORMAT; f++)
                check_written(&mesh, f);
    }
    asset_free(&mesh);
}
