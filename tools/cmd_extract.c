/* SPDX-License-Identifier: MIT */
/*
 * cmd_extract.c - a mesh of any size out of a .pmesh file or a part of one.
 */
#include <float.h>
#include <inttypes.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "tools/args.h"
#include "tools/cmd.h"
#include "tools/extract_scene.h"
#include "tools/file.h"
#include "tools/load.h"
#include "tools/report.h"
#include "tools/scene_file.h"
#include "tools/stream.h"

typedef struct options {
    const char *input, *output;
    int format; /* which of CMD_FORMATS; -1: OUT's name tells */
    uint32_t faces, mesh;
    uint64_t bytes;
    double ratio, error; /* negative: not given */
    const char *lods;
    bool meshopt, draco, inflate, strict, salvage, no_attributes, quiet;
} options;

static const args_option option_table[] = {
    { .name = "output", .letter = 'o', .kind = ARGS_TEXT, .value = "OUT",
      .offset = offsetof(options, output),
      .help = "mesh to write: .obj .ply .stl .off .gltf .glb .drc,\n"
              "\"-\" for standard output (needs --format)" },
    { .name = "faces", .letter = 'n', .kind = ARGS_COUNT, .value = "N",
      .min = 1, .max = UINT32_MAX, .offset = offsetof(options, faces),
      .help = "at most N faces" },
    { .name = "ratio", .kind = ARGS_RATIO, .value = "R", .min = 0, .max = 1,
      .offset = offsetof(options, ratio),
      .help = "at most this share of the faces: 25% or 0.25" },
    { .name = "error", .kind = ARGS_NUMBER, .value = "E", .min = 0,
      .max = DBL_MAX, .offset = offsetof(options, error),
      .help = "the coarsest level whose error is at most E\n"
              "(model units)" },
    { .name = "bytes", .kind = ARGS_SIZE, .value = "N", .min = 1,
      .max = FILE_LIMIT, .offset = offsetof(options, bytes),
      .help = "as if only the first N bytes had arrived" },
    { .name = "mesh", .kind = ARGS_COUNT, .value = "N", .min = 0,
      .max = UINT32_MAX - 1, .offset = offsetof(options, mesh),
      .help = "of a scene, mesh N only, from 0, in its own space" },
    { .name = "lods", .kind = ARGS_TEXT, .value = "R,R,...",
      .offset = offsetof(options, lods),
      .help = "of a scene, into .glb or .gltf, a chain of levels by\n"
              "MSFT_lod: 100%,25%,5% of the faces" },
    { .name = "meshopt", .kind = ARGS_FLAG,
      .offset = offsetof(options, meshopt),
      .help = "of a scene, into .glb or .gltf, geometry packed by\n"
              "EXT_meshopt_compression" },
    { .name = "draco", .kind = ARGS_FLAG, .offset = offsetof(options, draco),
      .help = "the same by KHR_draco_mesh_compression" },
    { .name = "inflate", .kind = ARGS_FLAG,
      .offset = offsetof(options, inflate),
      .help = "swell coarse levels to the full mesh's volume: closer\n"
              "to it, but vertices leave their places" },
    { .name = "strict", .kind = ARGS_FLAG, .offset = offsetof(options, strict),
      .help = "refuse a file that is cut off" },
    { .name = "salvage", .kind = ARGS_FLAG,
      .offset = offsetof(options, salvage),
      .help = "of a damaged file, take what precedes the damage" },
    { .name = "no-attributes", .kind = ARGS_FLAG,
      .offset = offsetof(options, no_attributes),
      .help = "write positions, faces and materials only" },
    { .name = "format", .kind = ARGS_CHOICE,
      .value = CMD_FORMATS, .offset = offsetof(options, format),
      .help = "format of OUT if its name does not tell" },
    { .name = "input", .letter = 'i', .kind = ARGS_TEXT, .value = "FILE",
      .offset = offsetof(options, input), .help = "the same as FILE" },
    { .name = "quiet", .letter = 'q', .kind = ARGS_FLAG,
      .offset = offsetof(options, quiet),
      .help = "no report and no warnings" },
};

static const args_command command = {
    .name = "extract",
    .summary = "Writes a mesh of any size out of a .pmesh file or a prefix of "
               "one.",
    .synopsis = "FILE -o OUT [options]",
    .options = option_table,
    .option_count = sizeof option_table / sizeof *option_table,
    .details =
        "Without a bound, all that the file holds; several bounds hold "
        "together.\nNothing is coarser than the base mesh: if fewer faces are "
        "asked, it is\nwritten with a warning. An error that a cut-off file "
        "does not reach is\nexit code 5, and nothing is written. Faces of a "
        "scene count as often as nodes\nshow them.\n\n"
        "A file that is cut off gives the best mesh it holds, with a warning; "
        "with\n--strict exit code 4. A damaged file is exit code 4; with "
        "--salvage the mesh\nbefore the damage is written, with a warning. "
        "FILE \"-\" is standard input.\n\n"
        "  pmesh extract bunny.pmesh -o bunny.obj\n"
        "  pmesh extract bunny.pmesh --faces 20k -o small.glb\n"
        "  head -c 64k bunny.pmesh | pmesh extract - -o early.ply\n",
};

/* The names of one call, and how the result is to be encoded. */
typedef struct extraction {
    const options *options;
    const char *input, *output;
    asset_format format;
} extraction;

static bool is_text(asset_format format)
{
    return format == ASSET_OBJ || format == ASSET_OFF || format == ASSET_GLTF;
}

static int input_failed(const extraction *job, int code,
                        const asset_error *error)
{
    report_asset_error(file_input_name(job->input), error);
    return code;
}

static int output_failed(const extraction *job, const asset_error *error)
{
    report_asset_error(file_output_name(job->output), error);
    return CMD_IO;
}

static uint32_t face_bound(const options *o, uint32_t all)
{
    return (uint32_t)extract_face_bound(o->faces, o->ratio, all);
}

/* Makes the bounded mesh visible. */
static int choose(const extraction *job, stream *s)
{
    const char *name = file_input_name(job->input);
    const options *o = job->options;
    pmesh_view view;
    /* Levels store floats: what info prints must be met when it is given. */
    const double bound = (double)(float)o->error;
    const pmesh_target target = {
        .faces = face_bound(o, s->header.faces),
        .error = o->error > 0 ? bound : 0,
    };

    if (pmesh_decoder_refine(s->decoder, &target, NULL) != PMESH_OK ||
        pmesh_decoder_mesh(s->decoder, &view) != PMESH_OK) {
        report_error(name, NULL, "there is no mesh to show");
        return CMD_IO;
    }
    if (o->error >= 0 && (double)view.error > bound) {
        report_error(name, NULL,
                     "cannot come within %g of the full mesh: what is there "
                     "reaches %g", o->error, (double)view.error);
        return CMD_BOUND;
    }
    return CMD_DONE;
}

static void print_result(const extraction *job, const stream *s,
                         const asset *mesh)
{
    /* Standard output may carry the mesh. */
    FILE *out = strcmp(job->output, "-") == 0 ? stderr : stdout;
    pmesh_view view;

    if (pmesh_decoder_mesh(s->decoder, &view) != PMESH_OK)
        return;
    report_put(out, file_output_name(job->output));
    fprintf(out, ": %zu of %" PRIu32 " faces, %zu vertices, error %.4g\n",
            mesh->face_count, s->header.faces, mesh->vertex_count,
            (double)view.error);
}

static int write_mesh(const extraction *job, const stream *s)
{
    asset mesh;
    asset_error error;
    asset_bytes bytes = { 0 };

    if (!asset_from_decoder(s->decoder, &mesh, &error))
        return input_failed(job, CMD_IO, &error);
    if (job->options->inflate && !asset_inflate(s->decoder, &mesh)) {
        asset_free(&mesh);
        asset_fail(&error, "", "out of memory");
        return input_failed(job, CMD_IO, &error);
    }
    asset shown = mesh; /* borrows all of it */
    if (job->options->no_attributes)
        shown.attribute_count = 0;
    bool good = asset_write(&shown, job->format, &bytes, &error);
    if (good && bytes.failed)
        good = asset_fail(&error, "", "out of memory");
    good = good && file_write(job->output, bytes.data, bytes.size, &error);
    if (good && !job->options->quiet)
        print_result(job, s, &shown);
    asset_bytes_free(&bytes);
    asset_free(&mesh);
    return good ? CMD_DONE : output_failed(job, &error);
}

/* Where the mesh written is not what was hoped for. */
static void warn(const extraction *job, const stream *s, const file_data *data,
                 const asset_error *damage)
{
    const char *name = file_input_name(job->input);
    const pmesh_header *h = &s->header;
    const uint32_t bound = face_bound(job->options, h->faces);

    if (job->options->quiet)
        return;
    if (bound > 0 && bound < h->base_faces)
        report_warning(name, "%" PRIu32 " faces were asked; the base mesh has "
                       "%" PRIu32 ", and there is no coarser one", bound,
                       h->base_faces);
    if (damage)
        report_warning(name, "%s%s%s; salvaged %" PRIu32 " of %" PRIu32
                       " faces", damage->where, *damage->where ? ": " : "",
                       damage->what, s->progress.faces, h->faces);
    else if (!s->progress.complete && !data->more)
        report_warning(name, "cut off: %zu of %" PRIu64 " bytes, %" PRIu32
                       " of %" PRIu32 " levels, %" PRIu32 " of %" PRIu32
                       " faces%s", data->size, h->bytes, s->progress.levels,
                       h->level_count, s->progress.faces, h->faces,
                       h->exact_bytes > 0 ? ", not all exact" : "");
}

static int extract_from(const extraction *job, const file_data *data)
{
    const options *o = job->options;
    asset_error error;
    stream s;

    if (scene_file_is(data))
        return extract_scene(&(extract_request){
                                 .input = job->input, .output = job->output,
                                 .format = job->format, .faces = o->faces,
                                 .ratio = o->ratio, .error = o->error,
                                 .mesh = o->mesh, .inflate = o->inflate,
                                 .lods = o->lods, .meshopt = o->meshopt,
                                 .draco = o->draco,
                                 .strict = o->strict,
                                 .salvage = o->salvage,
                                 .no_attributes = o->no_attributes,
                                 .quiet = o->quiet },
                             data);
    if (o->lods || o->meshopt || o->draco) {
        report_error(file_input_name(job->input), NULL, "is a single mesh; "
                     "--lods, --meshopt and --draco are for scenes");
        return CMD_USAGE;
    }
    if (o->mesh != EXTRACT_ALL_MESHES && o->mesh != 0) {
        report_error(file_input_name(job->input), NULL,
                     "is a single mesh, not a scene");
        return CMD_USAGE;
    }
    int code = stream_open(data, &s, &error);
    const bool salvaged = code == CMD_STREAM && o->salvage && s.shown;
    if (code == CMD_DONE && !s.shown) {
        asset_fail(&error, "", "cut off after %zu bytes, before the base mesh",
                   data->size);
        code = CMD_STREAM;
    } else if (code == CMD_DONE && !s.progress.complete && o->strict) {
        asset_fail(&error, "", "cut off after %zu of %" PRIu64 " bytes",
                   data->size, s.header.bytes);
        code = CMD_STREAM;
    }
    if (code != CMD_DONE && !salvaged) {
        input_failed(job, code, &error);
    } else {
        code = choose(job, &s);
        if (code == CMD_DONE)
            code = write_mesh(job, &s);
        if (code == CMD_DONE)
            warn(job, &s, data, salvaged ? &error : NULL);
    }
    stream_close(&s);
    return code;
}

static int usage(const char *what)
{
    args_complain(&command, "%s", what);
    return CMD_USAGE;
}

/* Fills the job from the command line; CMD_DONE if it makes sense. */
static int plan(const options *o, int count, char **operands, extraction *job)
{
    if (count + (o->input != NULL) != 1)
        return usage(count + (o->input != NULL) == 0 ? "no file is named"
                                                     : "takes one file");
    if (!o->output)
        return usage("no output is named (-o OUT)");
    if (o->meshopt && o->draco)
        return usage("takes one of --meshopt and --draco");
    job->options = o;
    job->input = o->input ? o->input : operands[0];
    job->output = o->output;
    job->format = asset_format_of(o->output);
    if (o->format >= 0)
        job->format = (asset_format)(ASSET_OBJ + o->format);
    if (job->format != ASSET_UNKNOWN)
        return CMD_DONE;
    if (strcmp(o->output, "-") == 0)
        return usage("standard output needs --format");
    args_complain(&command, "cannot tell the format of '%s' from its name "
                  "(--format)", o->output);
    return CMD_USAGE;
}

int cmd_extract(int argc, char **argv)
{
    options o = { .format = -1, .ratio = -1, .error = -1,
                  .mesh = EXTRACT_ALL_MESHES };
    int count;
    file_data data;
    asset_error error;
    extraction job;

    const args_result parsed = args_parse(&command, argc, argv, &o, &count);
    if (parsed != ARGS_RUN)
        return parsed == ARGS_HELP ? CMD_DONE : CMD_USAGE;
    int code = plan(&o, count, argv, &job);
    if (code != CMD_DONE)
        return code;
    const bool good =
        o.bytes > 0 ? file_read_prefix(job.input, o.bytes, &data, &error)
                    : file_read(job.input, FILE_LIMIT, &data, &error);
    if (!good)
        return input_failed(&job, CMD_IO, &error);
    scene_file_unwrap(&data);
    if (file_check_output(job.output, !is_text(job.format), &data, &error))
        code = extract_from(&job, &data);
    else
        code = output_failed(&job, &error);
    file_free(&data);
    return code;
}
