/* SPDX-License-Identifier: MIT */
#include "tools/scene_info.h"

#include <inttypes.h>
#include <stdio.h>

#include "tools/cmd.h"
#include "tools/json.h"
#include "tools/levels.h"
#include "tools/report.h"
#include "tools/scene_file.h"

static uint64_t resource_bytes(const scene_file *file)
{
    uint64_t sum = 0;
    for (uint32_t i = 0; i < file->header.resource_count; i++)
        sum += pmesh_scene_resource(file->scene, i).size;
    return sum;
}

static uint32_t levels_present(const scene_file *file, uint64_t size)
{
    uint32_t n = 0;
    while (n < file->header.level_count && file->header.levels[n].bytes <= size)
        n++;
    return n;
}

static bool mesh_header(const scene_file *file, uint32_t i, pmesh_header *out)
{
    const pmesh_decoder *dec = pmesh_scene_mesh(file->scene, i);
    return dec && pmesh_decoder_header(dec, out) == PMESH_OK;
}

static void print_meshes(const scene_file *file)
{
    enum { SHOWN = 32 };
    const uint32_t count = file->header.mesh_count;
    pmesh_header mesh;

    printf("meshes       %" PRIu32 "\n", count);
    for (uint32_t i = 0; i < count && i < SHOWN; i++) {
        printf("  %4" PRIu32 "       ", i);
        if (!mesh_header(file, i, &mesh))
            printf("not there yet\n");
        else
            printf("%" PRIu32 " faces, %" PRIu32 " attributes, %" PRIu64
                   " bytes, scale %.4g\n",
                   mesh.faces, mesh.attribute_count, mesh.bytes,
                   (double)pmesh_scene_scale(file->scene, i));
    }
    if (count > SHOWN)
        printf("             and %" PRIu32 " more\n", count - SHOWN);
}

static void print_text(const char *path, const scene_file *file,
                       const file_data *data, bool levels)
{
    const pmesh_scene_header *h = &file->header;
    const pmesh_scene_level *all = &h->levels[h->level_count - 1];

    printf("file         ");
    report_put(stdout, file_input_name(path));
    printf("\nformat       scene %d, content %016" PRIx64 "\n",
           PMESH_FORMAT_VERSION, h->content_hash);
    printf("bytes        %zu%s: %" PRIu32 " of %" PRIu32 " levels\n",
           data->size, file->progress.complete ? "" : ", cut off",
           levels_present(file, data->size), h->level_count);
    printf("full detail  %" PRIu64 " faces, %" PRIu64 " output vertices\n",
           all->faces, all->vertices);
    printf("base meshes  %" PRIu64 " faces\n", h->levels[0].faces);
    printf("document     %" PRIu64 " bytes\n", h->document_bytes);
    printf("resources    %" PRIu32 ", %" PRIu64 " bytes\n", h->resource_count,
           resource_bytes(file));
    print_meshes(file);
    if (!levels)
        return;
    printf("\nlevel       bytes       faces    vertices       error\n");
    for (uint32_t i = 0; i < h->level_count; i++)
        printf("%5" PRIu32 " %11" PRIu64 " %11" PRIu64 " %11" PRIu64
               " %11.4g\n", i, h->levels[i].bytes, h->levels[i].faces,
               h->levels[i].vertices, (double)h->levels[i].error);
}

static void json_mesh(json *j, const scene_file *file, uint32_t i)
{
    pmesh_header mesh;

    json_open(j, NULL, '{');
    json_float(j, "scale", pmesh_scene_scale(file->scene, i));
    if (mesh_header(file, i, &mesh)) {
        json_count(j, "faces", mesh.faces);
        json_count(j, "vertices", mesh.mesh_vertices);
        json_count(j, "output_vertices", mesh.vertices);
        json_count(j, "base_faces", mesh.base_faces);
        json_count(j, "bytes", mesh.bytes);
        json_count(j, "materials", mesh.material_count);
        json_count(j, "attributes", mesh.attribute_count);
        json_number(j, "step", mesh.grid.step);
        levels_json(j, mesh.levels, mesh.level_count, mesh.measured);
    }
    json_close(j);
}

static void print_json(const char *path, const scene_file *file,
                       const file_data *data)
{
    const pmesh_scene_header *h = &file->header;
    const pmesh_scene_level *all = &h->levels[h->level_count - 1];
    char hash[20];
    json j;

    snprintf(hash, sizeof hash, "%016" PRIx64, h->content_hash);
    json_begin(&j, stdout);
    json_text(&j, "schema", "pmesh-scene-info-1");
    json_text(&j, "tool", "pmesh");
    json_text(&j, "version", pmesh_version());
    json_text(&j, "input", path);
    json_bool(&j, "scene", true);
    json_text(&j, "content_hash", hash);
    json_count(&j, "bytes_present", data->size);
    json_bool(&j, "complete", file->progress.complete);
    json_count(&j, "levels_present", levels_present(file, data->size));
    json_count(&j, "meshes", h->mesh_count);
    json_count(&j, "faces", all->faces);
    json_count(&j, "output_vertices", all->vertices);
    json_count(&j, "base_faces", h->levels[0].faces);
    json_count(&j, "document_bytes", h->document_bytes);
    json_count(&j, "resources", h->resource_count);
    json_count(&j, "resource_bytes", resource_bytes(file));
    json_open(&j, "levels", '[');
    for (uint32_t i = 0; i < h->level_count; i++) {
        json_open_flat(&j, NULL, '{');
        json_count(&j, "bytes", h->levels[i].bytes);
        json_count(&j, "faces", h->levels[i].faces);
        json_count(&j, "output_vertices", h->levels[i].vertices);
        json_float(&j, "error", h->levels[i].error);
        json_close(&j);
    }
    json_close(&j);
    json_open(&j, "mesh_list", '[');
    for (uint32_t i = 0; i < h->mesh_count; i++)
        json_mesh(&j, file, i);
    json_close(&j);
    json_end(&j);
}

int scene_info(const char *path, const file_data *data, bool as_json,
               bool levels)
{
    scene_file file;
    asset_error error;

    int code = scene_file_open(data, &file, &error);
    if (file.has_header)
        code = CMD_DONE; /* damage behind the header is not our question */
    else if (code == CMD_DONE) {
        asset_fail(&error, "", "cut off after %zu bytes, within the header",
                   data->size);
        code = CMD_STREAM;
    }
    if (code != CMD_DONE)
        report_asset_error(file_input_name(path), &error);
    else if (as_json)
        print_json(path, &file, data);
    else
        print_text(path, &file, data, levels);
    scene_file_close(&file);
    return code;
}
