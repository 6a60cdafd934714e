/* SPDX-License-Identifier: MIT */
#include "tools/extract_scene.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "tools/cmd.h"
#include "tools/extract_library.h"
#include "tools/load.h"
#include "tools/report.h"
#include "tools/scene_budget.h"
#include "tools/scene_file.h"
#include "tools/scene_write.h"

enum { MAX_LODS = 8 };

typedef struct job {
    const extract_request *request;
    const file_data *data;
    scene_file file;
    scene_budget budget; /* unless one mesh is asked for */
    uint64_t all_faces; /* as drawn */
    uint64_t stored_faces;
    pmesh_scene_shown shown;
    asset notes; /* its warnings */
    extract_library library; /* of an OBJ in a file */
    uint64_t lod_faces[MAX_LODS];
    size_t lod_count;
} job;

uint64_t extract_face_bound(uint32_t faces, double ratio, uint64_t all)
{
    uint64_t bound = faces;

    if (ratio >= 0) {
        /* 29 % of 100 faces are 29, though 0.29 * 100 is a little less. */
        const double share = floor(ratio * (double)all * (1 + DBL_EPSILON));
        const uint64_t most = share < 1        ? 1
                              : share < 0x1p64 ? (uint64_t)share
                                               : UINT64_MAX;
        if (bound == 0 || most < bound)
            bound = most;
    }
    return bound;
}

static int input_failed(const job *j, int code, const asset_error *error)
{
    report_asset_error(file_input_name(j->request->input), error);
    return code;
}

/* All meshes, or all but the others as they are. */
static int choose(job *j)
{
    const extract_request *r = j->request;
    const char *name = file_input_name(r->input);
    asset_error error;
    /* Levels store floats: what info prints must be met when it is given. */
    const double bound = (double)(float)r->error * (1 + 1e-6);

    if (!scene_budget_open(j->file.scene, &j->budget, &error))
        return input_failed(
            j, j->file.progress.complete ? CMD_IO : CMD_STREAM, &error);
    j->all_faces = j->budget.all;
    j->stored_faces = j->budget.stored;
    const pmesh_scene_target target = {
        .faces = scene_budget_stored(
            &j->budget, extract_face_bound(r->faces, r->ratio, j->all_faces)),
        .error = r->error > 0 ? bound : 0
    };
    if (pmesh_scene_refine(j->file.scene, &target, &j->shown) != PMESH_OK) {
        report_error(name, NULL, "there is no mesh to show");
        return CMD_IO;
    }
    if (r->error >= 0 && j->shown.error > bound) {
        report_error(name, NULL, "cannot come within %g of the full scene: "
                     "what is there reaches %g", r->error, j->shown.error);
        return CMD_BOUND;
    }
    j->shown.faces = scene_budget_drawn(&j->budget);
    return CMD_DONE;
}

/* The one mesh that was asked for, in its own space and units. */
static int choose_mesh(job *j, pmesh_decoder **out)
{
    const extract_request *r = j->request;
    const char *name = file_input_name(r->input);
    pmesh_header h;
    pmesh_view view;

    *out = NULL;
    if (r->mesh >= j->file.header.mesh_count) {
        report_error(name, NULL, "has no mesh %" PRIu32 ": there are %" PRIu32
                     ", counted from 0", r->mesh, j->file.header.mesh_count);
        return CMD_USAGE;
    }
    pmesh_decoder *dec = pmesh_scene_mesh(j->file.scene, r->mesh);
    const double bound = (double)(float)r->error;
    if (!dec || pmesh_decoder_header(dec, &h) != PMESH_OK ||
        pmesh_decoder_refine(dec, NULL, NULL) != PMESH_OK) {
        report_error(name, NULL, "cut off before the base mesh of mesh %"
                     PRIu32, r->mesh);
        return CMD_STREAM;
    }
    const pmesh_target target = {
        .faces = (uint32_t)extract_face_bound(r->faces, r->ratio, h.faces),
        .error = r->error > 0 ? bound : 0
    };
    pmesh_decoder_refine(dec, &target, NULL);
    pmesh_decoder_mesh(dec, &view);
    j->all_faces = j->stored_faces = h.faces;
    j->shown = (pmesh_scene_shown){ view.face_count, 1, (double)view.error };
    if (r->error >= 0 && (double)view.error > bound) {
        report_error(name, NULL, "cannot come within %g of the full mesh: what "
                     "is there reaches %g", r->error, (double)view.error);
        return CMD_BOUND;
    }
    *out = dec;
    return CMD_DONE;
}

static bool encode_asset(const job *j, const asset *mesh, asset_bytes *out,
                         asset_error *error)
{
    asset shown = *mesh; /* borrows all of it */
    if (j->request->no_attributes)
        shown.attribute_count = 0;
    return asset_write(&shown, j->request->format, out, error);
}

/* In OBJ texture coordinates run up the picture, in glTF down. */
static void turn_texcoords(asset *mesh)
{
    for (size_t i = 0; i < mesh->attribute_count; i++) {
        asset_attribute *a = &mesh->attributes[i];
        for (size_t k = 0; a->kind == PMESH_TEXCOORD && k < a->count; k++)
            a->values[k * a->components + 1] =
                1 - a->values[k * a->components + 1];
    }
}

/* All meshes as one, with what an OBJ needs beside it. */
static bool merge(job *j, asset_bytes *out, asset *mesh, asset_error *error)
{
    const extract_request *r = j->request;
    const bool obj = r->format == ASSET_OBJ;
    const bool library = obj && strcmp(r->output, "-") != 0;

    if (library && !extract_library_open(r->output, &j->library, error))
        return false;
    if (!scene_file_merge(&j->file, r->inflate,
                          library ? &j->library.content : NULL, mesh, error))
        return false;
    if (j->library.content.missing)
        asset_warn(&j->notes, "some images are not there, and the .mtl does "
                   "without them");
    if (obj)
        turn_texcoords(mesh);
    if (j->library.content.mtl.size > 0)
        extract_library_put_name(&j->library, out);
    return true;
}

/* "100%,25%,5%" as face budgets, each below the one before. */
static bool read_lods(job *j, asset_error *error)
{
    double last = 2;

    for (const char *at = j->request->lods; at; at = strchr(at, ',')) {
        double share = -1;
        at += *at == ',';
        const char *end = asset_number_parse(at, at + strcspn(at, ","), &share);
        if (end > at && *end == '%') {
            share /= 100;
            end++;
        }
        if (end == at || (*end != ',' && *end != '\0') || !(share > 0) ||
            !(share <= 1) || !(share < last) || j->lod_count == MAX_LODS)
            return asset_fail(error, "", "--lods are up to %d falling shares "
                              "of the faces: 100%%,25%%,5%%", MAX_LODS);
        last = share;
        j->lod_faces[j->lod_count++] = scene_budget_stored(
            &j->budget, extract_face_bound(0, share, j->all_faces));
    }
    return true;
}

static bool encode(job *j, const pmesh_decoder *one, asset_bytes *out,
                   asset_error *error)
{
    const extract_request *r = j->request;
    const bool gltf = r->format == ASSET_GLB || r->format == ASSET_GLTF;
    asset mesh;

    if (!one && gltf && !r->no_attributes)
        return read_lods(j, error) &&
               scene_write(j->file.scene,
                           (scene_style){ .glb = r->format == ASSET_GLB,
                                          .inflate = r->inflate,
                                          .meshopt = r->meshopt,
                                          .draco = r->draco,
                                          .lod_faces = j->lod_faces,
                                          .lod_count = j->lod_count },
                           out, &j->notes, error);
    if (r->lods || r->meshopt || r->draco)
        return asset_fail(error, "", "--lods, --meshopt and --draco need a "
                          "whole scene in a .glb or .gltf");
    if (!(one ? asset_from_decoder(one, &mesh, error)
              : merge(j, out, &mesh, error)))
        return false;
    bool good = !one || !r->inflate || asset_inflate(one, &mesh);
    if (good)
        good = encode_asset(j, &mesh, out, error);
    else
        asset_fail(error, "", "out of memory");
    asset_free(&mesh);
    return good;
}

static void print_result(const job *j)
{
    /* Standard output may carry the scene. */
    const extract_request *r = j->request;
    FILE *out = strcmp(r->output, "-") == 0 ? stderr : stdout;

    report_put(out, file_output_name(r->output));
    fprintf(out, ": %" PRIu64 " of %" PRIu64 " faces, %" PRIu32
            " meshes, error %.4g\n",
            j->shown.faces, j->all_faces, j->shown.meshes, j->shown.error);
}

static int write_out(job *j, const pmesh_decoder *one)
{
    const extract_request *r = j->request;
    asset_bytes bytes = { 0 };
    asset_error error;
    int code = CMD_DONE;

    if (!encode(j, one, &bytes, &error)) {
        code = input_failed(j, j->file.progress.complete ? CMD_IO : CMD_STREAM,
                            &error);
    } else if (bytes.failed) {
        asset_fail(&error, "", "out of memory");
        code = input_failed(j, CMD_IO, &error);
    } else if (j->library.content.mtl.size > 0 &&
               !extract_library_write(&j->library, &error)) {
        report_asset_error(j->library.path, &error);
        code = CMD_IO;
    } else if (!file_write(r->output, bytes.data, bytes.size, &error)) {
        report_asset_error(file_output_name(r->output), &error);
        code = CMD_IO;
    }
    asset_bytes_free(&bytes);
    if (code == CMD_DONE && !r->quiet)
        print_result(j);
    return code;
}

/* Where what was written is not what was hoped for. */
static void warn(const job *j, const asset_error *damage)
{
    const extract_request *r = j->request;
    const char *name = file_input_name(r->input);
    const uint64_t bound =
        extract_face_bound(r->faces, r->ratio, j->all_faces);
    report_notes notes = { 0 };

    if (r->quiet)
        return;
    report_note_lines(&notes, j->notes.warnings);
    if (bound > 0 && bound < j->shown.faces)
        report_note(&notes, "%" PRIu64 " faces were asked; the base meshes have "
                    "%" PRIu64 ", and there are no coarser ones", bound,
                    j->shown.faces);
    if (damage)
        report_note(&notes, "%s%s%s; salvaged %" PRIu64 " of %" PRIu64
                    " faces", damage->where, *damage->where ? ": " : "",
                    damage->what, j->file.progress.faces, j->stored_faces);
    else if (!j->file.progress.complete && !j->data->more)
        report_note(&notes, "cut off after %zu bytes: %" PRIu64 " of %" PRIu64
                    " faces", j->data->size, j->file.progress.faces,
                    j->stored_faces);
    report_notes_print(&notes, name);
}

static int run(job *j)
{
    const extract_request *r = j->request;
    pmesh_decoder *one = NULL;
    asset_error error;

    int code = scene_file_open(j->data, &j->file, &error);
    const bool any = j->file.progress.bases > 0;
    const bool salvaged = code == CMD_STREAM && r->salvage && any;
    if (code == CMD_DONE && !any) {
        asset_fail(&error, "", "cut off after %zu bytes, before the base "
                   "meshes", j->data->size);
        code = CMD_STREAM;
    } else if (code == CMD_DONE && !j->file.progress.complete && r->strict) {
        asset_fail(&error, "", "cut off after %zu bytes", j->data->size);
        code = CMD_STREAM;
    }
    if (code != CMD_DONE && !salvaged)
        return input_failed(j, code, &error);
    code = r->mesh == EXTRACT_ALL_MESHES ? choose(j) : choose_mesh(j, &one);
    if (code == CMD_DONE)
        code = write_out(j, one);
    if (code == CMD_DONE)
        warn(j, salvaged ? &error : NULL);
    return code;
}

int extract_scene(const extract_request *request, const file_data *data)
{
    job j = { .request = request, .data = data };
    const int code = run(&j);
    extract_library_close(&j.library);
    scene_budget_close(&j.budget);
    scene_file_close(&j.file);
    return code;
}
