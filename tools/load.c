/* SPDX-License-Identifier: MIT */
#include "tools/load.h"

#include <stdlib.h>
#include <string.h>

#include "tools/cmd.h"
#include "tools/scene_file.h"
#include "tools/stream.h"

/* Enough for the decoder to tell a .pmesh from anything else. */
#define PROBE_BYTES 16u

static bool ends_in_pmesh(const char *path)
{
    static const char ending[] = ".pmesh";
    const size_t size = path ? strlen(path) : 0;
    const size_t n = sizeof ending - 1;

    if (size < n)
        return false;
    for (size_t i = 0; i < n; i++) {
        char c = path[size - n + i];
        if (c >= 'A' && c <= 'Z')
            c = (char)(c - 'A' + 'a');
        if (c != ending[i])
            return false;
    }
    return true;
}

bool load_is_stream(const file_data *data, const char *path)
{
    pmesh_decoder *dec;

    if (ends_in_pmesh(path))
        return true;
    if (data->size < PROBE_BYTES || pmesh_decoder_create(&dec, NULL) < 0)
        return false;
    const pmesh_status status =
        pmesh_decoder_feed(dec, data->bytes, PROBE_BYTES);
    pmesh_decoder_destroy(dec);
    return status != PMESH_E_MAGIC;
}

/* ---- the visible mesh --------------------------------------------------- */

static bool copy_faces(const pmesh_view *view, const pmesh_grid *grid,
                       asset *out)
{
    const size_t corners = (size_t)view->face_count * 3;
    const size_t values = (size_t)view->mesh_vertex_count * 3;

    out->positions = malloc((values + 1) * sizeof *out->positions);
    out->indices = malloc((corners + 1) * sizeof *out->indices);
    if (!out->positions || !out->indices)
        return false;
    for (size_t i = 0; i < values; i++)
        out->positions[i] =
            grid->origin[i % 3] + grid->step * view->positions[i];
    for (size_t i = 0; i < corners; i++) {
        const uint32_t v = view->indices[i];
        out->indices[i] = view->positions_of ? view->positions_of[v] : v;
    }
    out->vertex_count = view->mesh_vertex_count;
    out->face_count = view->face_count;
    return true;
}

/* From output vertices to mesh vertices. */
static void set_positions(const pmesh_view *view, const float *xyz, asset *out)
{
    for (uint32_t i = 0; i < view->vertex_count; i++) {
        const size_t v = view->positions_of ? view->positions_of[i] : i;
        for (size_t k = 0; k < 3; k++)
            out->positions[3 * v + k] = (double)xyz[3 * (size_t)i + k];
    }
    out->floats = true;
}

/* As copy_faces() left them, on the grid, unless there are exact ones. */
static bool copy_exact(const pmesh_decoder *dec, const pmesh_view *view,
                       asset *out)
{
    if (pmesh_decoder_progress(dec).exact_vertices == 0)
        return true;
    float *xyz = malloc((3 * (size_t)view->vertex_count + 1) * sizeof *xyz);
    const bool good =
        xyz && pmesh_decoder_copy_positions(dec, xyz, 0) == PMESH_OK;
    if (good)
        set_positions(view, xyz, out);
    free(xyz);
    return good;
}

bool asset_inflate(const pmesh_decoder *dec, asset *mesh)
{
    pmesh_view view;
    if (pmesh_decoder_mesh(dec, &view) != PMESH_OK)
        return false;
    float *xyz = malloc((3 * (size_t)view.vertex_count + 1) * sizeof *xyz);
    void *room = malloc(pmesh_decoder_inflate_room(dec));
    const bool good =
        xyz && room &&
        pmesh_decoder_copy_inflated(dec, xyz, 0, room) == PMESH_OK;
    if (good)
        set_positions(&view, xyz, mesh);
    free(room);
    free(xyz);
    return good;
}

static bool copy_attribute(const pmesh_decoder *dec, const pmesh_view *view,
                           const pmesh_attribute *from, uint32_t number,
                           asset_attribute *to)
{
    const size_t corners = (size_t)view->face_count * 3;
    const size_t values = (size_t)view->vertex_count * from->components;

    to->kind = from->kind;
    to->set = from->set;
    to->components = from->components;
    to->count = view->vertex_count;
    to->values = malloc((values + 1) * sizeof *to->values);
    to->indices = malloc((corners + 1) * sizeof *to->indices);
    if (!to->values || !to->indices)
        return false;
    memcpy(to->indices, view->indices, corners * sizeof *to->indices);
    return pmesh_decoder_copy_attribute(dec, number, to->values, 0) == PMESH_OK;
}

static bool copy_materials(const pmesh_decoder *dec, const pmesh_view *view,
                           uint32_t count, asset *out)
{
    bool named = false;
    for (uint32_t i = 0; i < count; i++)
        named = named || *pmesh_decoder_material_name(dec, i) != '\0';

    out->material_count = count;
    if (view->materials) {
        const size_t size = (size_t)view->face_count * sizeof *out->materials;
        out->materials = malloc(size + 1);
        if (!out->materials)
            return false;
        memcpy(out->materials, view->materials, size);
    }
    if (!named)
        return true;
    out->material_names = calloc(count, sizeof *out->material_names);
    if (!out->material_names)
        return false;
    for (uint32_t i = 0; i < count; i++) {
        out->material_names[i] = strdup(pmesh_decoder_material_name(dec, i));
        if (!out->material_names[i])
            return false;
    }
    return true;
}

bool asset_from_decoder(const pmesh_decoder *dec, asset *out,
                        asset_error *error)
{
    pmesh_header header;
    pmesh_view view;

    *out = (asset){ 0 };
    if (pmesh_decoder_header(dec, &header) != PMESH_OK ||
        pmesh_decoder_mesh(dec, &view) != PMESH_OK)
        return asset_fail(error, "", "the base mesh is not there yet");
    bool ok = copy_faces(&view, &header.grid, out) &&
              copy_exact(dec, &view, out) &&
              copy_materials(dec, &view, header.material_count, out);
    for (uint32_t i = 0; ok && i < header.attribute_count; i++) {
        out->attribute_count++;
        ok = copy_attribute(dec, &view, &header.attributes[i], i,
                            &out->attributes[i]);
    }
    if (!ok) {
        asset_free(out);
        *out = (asset){ 0 };
        return asset_fail(error, "", "out of memory");
    }
    return true;
}

/* ---- anything ----------------------------------------------------------- */

static int load_decoded(const file_data *data, asset *out, asset_error *error)
{
    stream s;
    int code = stream_open(data, &s, error);

    if (code == CMD_DONE && !s.shown) {
        asset_fail(error, "", "cut off after %zu bytes, before the base mesh",
                   data->size);
        code = CMD_STREAM;
    }
    if (code == CMD_DONE && !asset_from_decoder(s.decoder, out, error))
        code = CMD_IO;
    if (code == CMD_DONE && !s.progress.complete)
        asset_warn(out, "cut off: %zu of %llu bytes, %zu of %lu faces",
                   data->size, (unsigned long long)s.header.bytes,
                   out->face_count, (unsigned long)s.header.faces);
    stream_close(&s);
    return code;
}

int load_mesh_data(const file_data *data, const char *path, asset *out,
                   asset_error *error)
{
    *out = (asset){ 0 };
    if (scene_file_is(data))
        return scene_file_load(data, out, error);
    if (load_is_stream(data, path))
        return load_decoded(data, out, error);
    const bool standard = strcmp(path, "-") == 0;
    const asset_format format =
        standard ? ASSET_UNKNOWN : asset_format_of(path);
    return asset_read(data->bytes, data->size, format, standard ? NULL : path,
                      out, error)
               ? CMD_DONE
               : CMD_ASSET;
}

int load_mesh(const char *path, asset *out, asset_error *error)
{
    file_data data;

    *out = (asset){ 0 };
    if (!file_read(path, FILE_LIMIT, &data, error))
        return CMD_IO;
    scene_file_unwrap(&data);
    const int code = load_mesh_data(&data, path, out, error);
    file_free(&data);
    return code;
}
