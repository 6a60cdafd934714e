/* SPDX-License-Identifier: MIT */
#include "tools/bake_scene.h"

#include <stdlib.h>
#include <string.h>

#include "encoder/pmesh_scene_encode.h"
#include "tools/cmd.h"
#include "tools/progress.h"
#include "tools/scene_file.h"
#include "tools/scene_parts.h"
#include "tools/scene_write.h"
#include "tools/workers.h"

static int collect(void *user, const void *data, size_t size)
{
    asset_bytes *bytes = user;
    asset_put(bytes, data, size);
    return bytes->failed;
}

/* Attributes of one kind and set count together. */
static void add_attributes(pmesh_encode_report *sum,
                           const pmesh_encode_report *r)
{
    for (uint32_t i = 0; i < r->attribute_count; i++) {
        const pmesh_attribute_size *a = &r->attributes[i];
        uint32_t k = 0;
        while (k < sum->attribute_count &&
               (sum->attributes[k].kind != a->kind ||
                sum->attributes[k].set != a->set))
            k++;
        if (k == PMESH_MAX_ATTRIBUTES)
            continue;
        if (k == sum->attribute_count)
            sum->attributes[sum->attribute_count++] =
                (pmesh_attribute_size){ .kind = a->kind, .set = a->set };
        sum->attributes[k].bytes += a->bytes;
    }
}

/* What of one mesh counts for the scene. */
static void add_counts(pmesh_encode_report *sum, const pmesh_encode_report *r)
{
    sum->input_faces += r->input_faces;
    sum->input_vertices += r->input_vertices;
    sum->degenerate_faces += r->degenerate_faces;
    sum->duplicate_faces += r->duplicate_faces;
    sum->not_finite_faces += r->not_finite_faces;
    sum->not_finite_values += r->not_finite_values;
    sum->welded_vertices += r->welded_vertices;
    sum->unused_vertices += r->unused_vertices;
    sum->zero_twins += r->zero_twins;
    sum->cut_vertices += r->cut_vertices;
    sum->components += r->components;
    sum->faces += r->faces;
    sum->vertices += r->vertices;
    sum->wedges += r->wedges;
    sum->base_faces += r->base_faces;
    sum->base_vertices += r->base_vertices;
    sum->bytes_base += r->bytes_base;
    sum->bytes_connectivity += r->bytes_connectivity;
    sum->bytes_positions += r->bytes_positions;
    sum->bytes_attributes += r->bytes_attributes;
    sum->bytes_lossless += r->bytes_lossless;
    add_attributes(sum, r);
    sum->seconds_import += r->seconds_import;
    sum->seconds_contract += r->seconds_contract;
    sum->seconds_code += r->seconds_code;
    sum->end = r->end > sum->end ? r->end : sum->end;
    sum->grid = r->grid;
    sum->base_coder = r->base_coder;
}

static uint32_t count32(uint64_t value)
{
    return value < UINT32_MAX ? (uint32_t)value : UINT32_MAX;
}

/* The scene's own figures over the sums of its meshes. */
static void add_scene(bake_report *report, const pmesh_scene_report *scene,
                      const scene_parts *parts)
{
    pmesh_encode_report *e = &report->encode;

    e->bytes = scene->bytes;
    e->bytes_header = scene->bytes - scene->bytes_document -
                      scene->bytes_resources - e->bytes_base -
                      e->bytes_connectivity - e->bytes_positions -
                      e->bytes_attributes - e->bytes_lossless;
    e->level_count = scene->level_count;
    for (uint32_t i = 0; i < scene->level_count; i++) {
        const pmesh_scene_level *level = &scene->levels[i];
        e->levels[i] = (pmesh_level){
            .bytes = level->bytes, .faces = count32(level->faces),
            .mesh_vertices = count32(level->vertices),
            .vertices = count32(level->vertices), .error = level->error
        };
    }
    report->meshes = (uint32_t)parts->mesh_count;
    report->bytes_document = scene->bytes_document;
    report->bytes_resources = scene->bytes_resources;
}

/* `stream`, where the resources are at `offsets`, in a GLB of the base meshes. */
static bool wrap(const asset_bytes *stream, const uint64_t *offsets,
                 bake_report *report, asset_bytes *out)
{
    const scene_style style = { .glb = true, .stream = stream,
                                .resource_offsets = offsets };
    const file_data data = { .bytes = stream->data, .size = stream->size };
    asset notes = { 0 };
    asset_error error;
    scene_file file;

    bool good = scene_file_open(&data, &file, &error) == CMD_DONE;
    if (good) {
        pmesh_scene_refine(file.scene, &(pmesh_scene_target){ .faces = 1 },
                           NULL);
        good = scene_write(file.scene, style, out, &notes, &error);
    }
    scene_file_close(&file);
    if (!good)
        report_asset_error(file_output_name(report->output), &error);
    report->encode.bytes = out->size;
    return good;
}

static int put_together(const scene_parts *parts, const asset_bytes *streams,
                        uint64_t *offsets, bake_report *report,
                        asset_bytes *out)
{
    pmesh_scene_mesh_input *meshes = calloc(parts->mesh_count, sizeof *meshes);
    pmesh_scene_blob *resources =
        calloc(parts->resource_count + 1, sizeof *resources);
    pmesh_scene_report scene;
    pmesh_status status = PMESH_E_MEMORY;

    if (meshes && resources) {
        for (size_t i = 0; i < parts->mesh_count; i++)
            meshes[i] = (pmesh_scene_mesh_input){
                streams[i].data, streams[i].size, parts->meshes[i].scale
            };
        for (size_t i = 0; i < parts->resource_count; i++)
            resources[i] = (pmesh_scene_blob){ parts->resources[i].data,
                                               parts->resources[i].size };
        const pmesh_scene_input input = {
            .meshes = meshes, .mesh_count = parts->mesh_count,
            .document = { parts->document.data, parts->document.size },
            .document_form = parts->packed ? PMESH_DOCUMENT_ZLIB
                                           : PMESH_DOCUMENT_PLAIN,
            .resources = resources, .resource_count = parts->resource_count,
            .early_count = parts->early_count,
            .resource_offsets = offsets
        };
        status = pmesh_scene_encode(&input, NULL, collect, out, &scene);
    }
    free(meshes);
    free(resources);
    if (status == PMESH_OK) {
        add_scene(report, &scene, parts);
        return CMD_DONE;
    }
    report_error(file_input_name(report->input), NULL, "%s",
                 status == PMESH_E_LIMIT ? "too large for a scene"
                                         : pmesh_status_text(status));
    return status == PMESH_E_LIMIT ? CMD_ASSET : CMD_IO;
}

static int put_into_glb(const scene_parts *parts, const asset_bytes *streams,
                        bake_report *report, asset_bytes *out)
{
    uint64_t *offsets = calloc(parts->resource_count + 1, sizeof *offsets);
    asset_bytes scene = { 0 };
    int code = CMD_IO;

    if (!offsets)
        report_error(file_input_name(report->input), NULL, "out of memory");
    else
        code = put_together(parts, streams, offsets, report, &scene);
    if (code == CMD_DONE && !wrap(&scene, offsets, report, out))
        code = CMD_IO;
    asset_bytes_free(&scene);
    free(offsets);
    return code;
}

typedef struct baking {
    const scene_parts *parts;
    bake_mesh bake;
    void *user;
    const bake_report *report;
    asset_bytes *streams;
    size_t *order; /* of the meshes: those of most faces first */
    size_t alone;  /* of these so many, one after the other */
    struct {
        bake_report report;
        int code;
    } *made; /* per mesh */
    unsigned threads; /* for each of them */
} baking;

static void bake_in_order(void *user, size_t i)
{
    const baking *b = user;
    const size_t m = b->order[b->alone + i];

    b->made[m].report = (bake_report){ .input = b->report->input,
                                       .output = b->report->output };
    b->made[m].code = b->bake(b->user, b->parts->meshes[m].name,
                              &b->parts->meshes[m].mesh, b->threads,
                              &b->made[m].report, &b->streams[m]);
}

static size_t faces_of(const baking *b, size_t i)
{
    return b->parts->meshes[b->order[i]].mesh.face_count;
}

/* Returns the number of faces. */
static size_t sort_meshes(const baking *b)
{
    size_t sum = 0;

    for (size_t i = 0; i < b->parts->mesh_count; i++) {
        const size_t faces = b->parts->meshes[i].mesh.face_count;
        size_t at = i;
        for (; at > 0 && faces_of(b, at - 1) < faces; at--)
            b->order[at] = b->order[at - 1];
        b->order[at] = i;
        sum += faces;
    }
    return sum;
}

/* A mesh with more than a thread's share of the faces goes first and has all
 * the threads; the others get one each. */
static int bake_all(baking *b, unsigned threads)
{
    const size_t count = b->parts->mesh_count;
    size_t left = sort_meshes(b);

    b->threads = threads;
    while (b->alone < count &&
           (threads == 1 || faces_of(b, b->alone) > left / threads)) {
        left -= faces_of(b, b->alone);
        bake_in_order(b, 0);
        if (b->made[b->order[b->alone++]].code != CMD_DONE)
            break;
    }
    if (b->alone == 0 || b->made[b->order[b->alone - 1]].code == CMD_DONE) {
        b->threads = 1;
        workers_run(threads, count - b->alone, bake_in_order, b);
    }
    for (size_t i = 0; i < count; i++)
        if (b->made[i].code != CMD_DONE)
            return b->made[i].code;
    return CMD_DONE;
}

static int bake_meshes(const scene_parts *parts, unsigned threads,
                       bake_mesh bake, void *user, bake_report *report,
                       asset_bytes *streams)
{
    baking b = { .parts = parts, .bake = bake, .user = user,
                 .report = report, .streams = streams };
    int code = CMD_IO;

    b.order = calloc(parts->mesh_count, sizeof *b.order);
    b.made = calloc(parts->mesh_count, sizeof *b.made);
    if (b.order && b.made)
        code = bake_all(&b, threads);
    else
        report_error(file_input_name(report->input), NULL, "out of memory");
    for (size_t i = 0; code == CMD_DONE && i < parts->mesh_count; i++)
        add_counts(&report->encode, &b.made[i].report.encode);
    free(b.order);
    free(b.made);
    return code;
}

int bake_scene(const file_data *data, unsigned threads, bake_mesh bake,
               void *user, bool glb, bool leave_images, bake_report *report,
               asset_bytes *out)
{
    const bool standard = strcmp(report->input, "-") == 0;
    const double start = progress_clock();
    scene_parts parts;
    asset_error error;

    if (!scene_parts_read(data->bytes, data->size,
                          standard ? NULL : report->input, leave_images,
                          &parts, &error)) {
        report_asset_error(file_input_name(report->input), &error);
        return CMD_ASSET;
    }
    report->seconds_read += progress_clock() - start;
    report_note_lines(&report->notes, parts.notes.warnings);
    report_note_lines(&report->notes, (const char *)parts.outside.data);
    asset_bytes *streams = calloc(parts.mesh_count, sizeof *streams);
    int code = CMD_IO;
    if (!streams)
        report_error(file_input_name(report->input), NULL, "out of memory");
    else
        code = bake_meshes(&parts, threads, bake, user, report, streams);
    if (code == CMD_DONE && glb)
        code = put_into_glb(&parts, streams, report, out);
    else if (code == CMD_DONE)
        code = put_together(&parts, streams, NULL, report, out);
    for (size_t i = 0; streams && i < parts.mesh_count; i++)
        asset_bytes_free(&streams[i]);
    free(streams);
    scene_parts_free(&parts);
    return code;
}
