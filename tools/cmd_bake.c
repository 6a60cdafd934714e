/* SPDX-License-Identifier: MIT */
/*
 * cmd_bake.c - a triangle mesh into a .pmesh file.
 */
#include <float.h>
#include <inttypes.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "tools/args.h"
#include "tools/bake_report.h"
#include "tools/bake_scene.h"
#include "tools/cmd.h"
#include "tools/draco_base.h"
#include "tools/file.h"
#include "tools/guide.h"
#include "tools/load.h"
#include "tools/progress.h"
#include "tools/scene_parts.h"
#include "tools/triple.h"
#include "tools/workers.h"

typedef struct options {
    const char *input, *output, *camera;
    int textures; /* which of embed, external */
    int profile, placement, metric, cost, base, topology;
    int format; /* which of CMD_FORMATS; -1: not given */
    uint32_t position_bits, normal_bits, uv_bits, color_bits, generic_bits;
    uint32_t base_faces, base_vertices, threads;
    const char *guide, *weights;
    int contours; /* which of none, seams, borders, all */
    double base_ratio, max_error, weld, threshold, crease;
    double normal_weight, uv_weight, color_weight, generic_weight;
    file_data guide_data;
    bool lossless, measure, no_attributes, merge, json, quiet, verbose;
    bool progress;
} options;

#define AT(member) .offset = offsetof(options, member)

static const args_option option_table[] = {
    { .name = "output", .letter = 'o', .kind = ARGS_TEXT, .value = "OUT",
      AT(output),
      .help = ".pmesh to write, \"-\" for standard output; of a glTF\n"
              "scene a .glb that any viewer shows coarsely" },
    { .name = "profile", .kind = ARGS_CHOICE,
      .value = "compact|balanced|quality", AT(profile),
      .help = "smallest file, best levels, or (default) balanced" },
    { .name = "placement", .kind = ARGS_CHOICE, .value = "subset|optimal",
      AT(placement),
      .help = "vertices of coarse levels: vertices of the input\n"
              "(default), or moved to where the error is least" },
    { .name = "position-bits", .kind = ARGS_COUNT, .value = "N", .min = 4,
      .max = 24, AT(position_bits),
      .help = "bits per coordinate of the largest extent,\n"
              "4 to 24; default 14" },
    { .name = "lossless", .kind = ARGS_FLAG, AT(lossless),
      .help = "positions come back as the input's floats, bit for\n"
              "bit, from a last layer; doubles are rounded first" },
    { .name = "normal-bits", .kind = ARGS_COUNT, .value = "N", .min = 4,
      .max = 16, AT(normal_bits),
      .help = "per component of a normal, 4 to 16; default 10" },
    { .name = "uv-bits", .kind = ARGS_COUNT, .value = "N", .min = 4, .max = 16,
      AT(uv_bits),
      .help = "per texture coordinate, 4 to 16; default 12" },
    { .name = "color-bits", .kind = ARGS_COUNT, .value = "N", .min = 4,
      .max = 16, AT(color_bits),
      .help = "per colour component, 4 to 16; default 8" },
    { .name = "generic-bits", .kind = ARGS_COUNT, .value = "N", .min = 4,
      .max = 16, AT(generic_bits),
      .help = "per component of tangents, skin weights, morph\n"
              "targets and others, 4 to 16; default 12" },
    { .name = "merge", .kind = ARGS_FLAG, AT(merge),
      .help = "one mesh of all meshes of a glTF scene, without\n"
              "textures, nodes, skins and animations" },
    { .name = "textures", .kind = ARGS_CHOICE, .value = "embed|external",
      AT(textures),
      .help = "images of a glTF scene that are files: copied into\n"
              "the scene (default), or left where they are" },
    { .name = "no-attributes", .kind = ARGS_FLAG, AT(no_attributes),
      .help = "leave out normals, texture coordinates and colours" },
    { .name = "base-faces", .kind = ARGS_COUNT, .value = "N", .min = 1,
      .max = 1 << 28, AT(base_faces),
      .help = "size of the coarsest level; default about 200. Of\n"
              "it and the next three the first one counts" },
    { .name = "base-vertices", .kind = ARGS_COUNT, .value = "N", .min = 1,
      .max = 1 << 28, AT(base_vertices), .help = "the same in vertices" },
    { .name = "base-ratio", .kind = ARGS_RATIO, .value = "R", .min = 0,
      .max = 1, AT(base_ratio),
      .help = "the same as a share of the faces: 1% or 0.01" },
    { .name = "base", .kind = ARGS_CHOICE, .value = "native|draco", AT(base),
      .help = "who codes it: native (default), or draco, often\n"
              "smaller from about 10000 base faces on" },
    { .name = "max-error", .kind = ARGS_NUMBER, .value = "E", .min = 0,
      .max = DBL_MAX, AT(max_error),
      .help = "no vertex of the full mesh is further than E from\n"
              "any level (model units); default 0: no bound" },
    { .name = "measure", .kind = ARGS_FLAG, AT(measure),
      .help = "measure the distance of each level to the full\n"
              "mesh, both ways, for the level table" },
    { .name = "metric", .kind = ARGS_CHOICE,
      .value = "memoryless|accumulated", AT(metric),
      .help = "quadrics of the current surface (default) or\n"
              "summed from the original" },
    { .name = "normal-weight", .kind = ARGS_NUMBER, .value = "W", .min = 0,
      .max = 1e6, AT(normal_weight),
      .help = "how much a difference of 1 counts against the\n"
              "model's extent (default 0.01); 0: not at all" },
    { .name = "uv-weight", .kind = ARGS_NUMBER, .value = "W", .min = 0,
      .max = 1e6, AT(uv_weight),
      .help = "the same of texture coordinates (default 0.1)" },
    { .name = "color-weight", .kind = ARGS_NUMBER, .value = "W", .min = 0,
      .max = 1e6, AT(color_weight), .help = "of colours (default 0.03)" },
    { .name = "generic-weight", .kind = ARGS_NUMBER, .value = "W", .min = 0,
      .max = 1e6, AT(generic_weight), .help = "and of others (default 0)" },
    { .name = "cost", .kind = ARGS_CHOICE,
      .value = "quadric|length|camera|quadric-camera", AT(cost),
      .help = "what goes first: the least error (default), short\n"
              "edges, short ones as a camera sees them, or error\n"
              "as it sees it" },
    { .name = "camera", .kind = ARGS_TEXT, .value = "X,Y,Z", AT(camera),
      .help = "where it is (model units)" },
    { .name = "guide", .kind = ARGS_TEXT, .value = "FILE", AT(guide),
      .help = "what matters: weights, locks, contours, planes,\n"
              "points and segments from a guide file" },
    { .name = "weights", .kind = ARGS_TEXT, .value = "SOURCE", AT(weights),
      .help = "where detail stays longest, 0 to 1 per vertex:\n"
              "color:r, color:r-b, attr:NAME, texture:MASK.png;\n"
              "default the attribute _LOD_WEIGHT, if any" },
    { .name = "crease", .kind = ARGS_NUMBER, .value = "DEGREES", .min = 0,
      .max = 180, AT(crease),
      .help = "edges that bend more are contours: vertices stay\n"
              "on them; default 0: none" },
    { .name = "contours", .kind = ARGS_CHOICE,
      .value = "none|seams|borders|all", AT(contours),
      .help = "and so are seams of attributes, or borders of\n"
              "materials; default none" },
    { .name = "weld", .kind = ARGS_NUMBER, .value = "EPS", .min = 0,
      .max = DBL_MAX, AT(weld),
      .help = "join positions this close (model units);\n"
              "default 0: only equal ones" },
    { .name = "threshold", .kind = ARGS_NUMBER, .value = "T", .min = 0,
      .max = DBL_MAX, AT(threshold),
      .help = "also contract unconnected vertices closer than T\n"
              "(model units); default 0: none" },
    { .name = "topology", .kind = ARGS_CHOICE, .value = "auto|keep|join",
      AT(topology),
      .help = "where coarse levels are not manifold or in pieces:\n"
              "keep parts sheets and keeps every piece, join lets\n"
              "both meet; auto (default) joins where it helps" },
    { .name = "format", .kind = ARGS_CHOICE, .value = CMD_FORMATS, AT(format),
      .help = "format of IN; default by its name or its bytes" },
    { .name = "input", .letter = 'i', .kind = ARGS_TEXT, .value = "IN",
      AT(input), .help = "the same as IN" },
    { .name = "threads", .letter = 'j', .kind = ARGS_COUNT, .value = "N",
      .min = 1, .max = 256, AT(threads),
      .help = "at most N threads (default: the processors); the file is\n"
              "the same with any number" },
    { .name = "json", .kind = ARGS_FLAG, AT(json),
      .help = "report as one JSON object on stdout" },
    { .name = "progress", .kind = ARGS_FLAG, AT(progress),
      .help = "show progress even if stderr is no terminal" },
    { .name = "quiet", .letter = 'q', .kind = ARGS_FLAG, AT(quiet),
      .help = "no report, no warnings, no progress" },
    { .name = "verbose", .letter = 'v', .kind = ARGS_FLAG, AT(verbose),
      .help = "report the parts of the file and its levels" },
};

static const args_command command = {
    .name = "bake",
    .summary = "Turns a triangle mesh into a progressive .pmesh file.",
    .synopsis = "IN -o OUT.pmesh [options]",
    .options = option_table,
    .option_count = sizeof option_table / sizeof *option_table,
    .details =
        "IN is an OBJ, PLY, STL, OFF, glTF, GLB, DRC or .pmesh file, or \"-\" "
        "for standard\ninput. Exact copies of faces, and faces with two "
        "corners at one position, are\nleft out and counted in a warning; no "
        "other face is lost. The same input and\noptions give the same "
        "bytes.\n\n"
        "  pmesh bake bunny.obj -o bunny.pmesh\n"
        "  pmesh bake scan.ply -o scan.pmesh --position-bits 16\n"
        "  xz -dc part.stl.xz | pmesh bake - --format stl -o part.pmesh\n",
};

static int usage(const char *what)
{
    args_complain(&command, "%s", what);
    return CMD_USAGE;
}

static int check_options(const options *o, int operand_count)
{
    const int inputs = operand_count + (o->input != NULL);

    if (o->threshold > 0 && o->topology == PMESH_TOPOLOGY_KEEP)
        return usage("--threshold joins pieces, --topology keep does not");
    if (inputs != 1)
        return usage(inputs == 0 ? "no input is named"
                                 : "takes one input; merging is not in this "
                                   "version");
    if (!o->output)
        return usage("no output is named (-o OUT.pmesh)");
    if (o->json && strcmp(o->output, "-") == 0)
        return usage("--json and -o - both need standard output");
    switch (asset_format_of(o->output)) {
    case ASSET_UNKNOWN:
        return CMD_DONE;
    case ASSET_GLB:
        return CMD_DONE;
    default:
        return usage("writes .pmesh and .glb files only; see pmesh extract");
    }
}

static int check_camera(const options *o)
{
    const bool seen = o->cost == PMESH_COST_CAMERA ||
                      o->cost == PMESH_COST_QUADRIC_CAMERA;
    double camera[3];

    if (seen != (o->camera != NULL))
        return usage(seen ? "this cost needs --camera"
                          : "--camera is for a cost with camera");
    if (seen && !triple_parse(o->camera, camera))
        return usage("--camera takes three numbers: 3,0,25");
    return CMD_DONE;
}

static void configure(const options *o, pmesh_encoder_config *config)
{
    config->profile = (pmesh_profile)o->profile;
    config->placement = (pmesh_placement)o->placement;
    config->metric = (pmesh_metric)o->metric;
    config->position_bits = (uint8_t)o->position_bits;
    config->normal_bits = (uint8_t)o->normal_bits;
    config->texcoord_bits = (uint8_t)o->uv_bits;
    config->color_bits = (uint8_t)o->color_bits;
    config->generic_bits = (uint8_t)o->generic_bits;
    config->base_faces = o->base_faces;
    config->base_vertices = o->base_vertices;
    /* 29 % of 100 faces are 29, though 0.29 * 100 is a little less. */
    config->base_ratio = o->base_ratio * (1 + DBL_EPSILON);
    config->base_error = o->max_error;
    config->normal_weight = o->normal_weight;
    config->texcoord_weight = o->uv_weight;
    config->color_weight = o->color_weight;
    config->generic_weight = o->generic_weight;
    config->cost = (pmesh_cost)o->cost;
    if (o->camera)
        triple_parse(o->camera, config->camera);
    config->base_coder = (pmesh_base_coder)o->base;
    config->base_encoder = draco_base_encode;
    config->base_decoder = draco_base_decode;
    config->weld = o->weld;
    config->lossless = o->lossless;
    config->measure = o->measure;
    config->threshold = o->threshold;
    config->topology = (pmesh_topology)o->topology;
}

static int collect(void *user, const void *data, size_t size)
{
    asset_bytes *bytes = user;
    asset_put(bytes, data, size);
    return bytes->failed;
}

/* The guide of a mesh by file, weights and creases; an exit code. */
static int guide_of(const options *o, const char *name, const asset *mesh,
                    report_notes *notes, guide *out)
{
    enum { SEAMS = 1, BORDERS, ALL };
    asset_error error;
    bool ok;

    if (!guide_create(out)) {
        report_error(name, NULL, "out of memory");
        return CMD_IO;
    }
    if (o->weights)
        ok = guide_take_weights(out, mesh, o->weights, &error);
    else
        ok = guide_take_own_weights(out, mesh, &error);
    if (!ok) {
        report_asset_error(name, &error);
        return CMD_ASSET;
    }
    if (o->guide && !guide_read(out, o->guide_data.bytes, o->guide_data.size,
                                mesh, &error)) {
        report_asset_error(file_input_name(o->guide), &error);
        return CMD_ASSET;
    }
    if (out->warning[0])
        report_note(notes, "%s", out->warning);
    if (o->crease > 0)
        out->use.crease = o->crease;
    out->use.seams |= o->contours == SEAMS || o->contours == ALL;
    out->use.borders |= o->contours == BORDERS || o->contours == ALL;
    return CMD_DONE;
}

static bool guide_says_something(const pmesh_guide *g)
{
    return g->weights || g->locks || g->segments || g->constraint_count > 0 ||
           g->crease > 0 || g->seams || g->borders;
}

static int encode_failed(const char *name, pmesh_status status,
                         const pmesh_encode_report *report)
{
    switch (status) {
    case PMESH_E_ARGUMENT:
        report_error("bake", NULL, "the options do not go together");
        return CMD_USAGE;
    case PMESH_E_MEMORY:
    case PMESH_E_WRITE: /* collect() fails for want of memory only */
        report_error(name, NULL, "out of memory");
        return CMD_IO;
    case PMESH_E_INDEX:
    case PMESH_E_NOT_FINITE: {
        char where[48];
        snprintf(where, sizeof where, "face %" PRIu64, report->error_index);
        report_error(name, where, "%s", pmesh_status_text(status));
        return CMD_ASSET;
    }
    case PMESH_E_LIMIT:
        report_error(name, NULL, "more than 2^30 corners");
        return CMD_ASSET;
    default:
        report_error(name, NULL, "%s", pmesh_status_text(status));
        return status == PMESH_E_NO_FACES ? CMD_ASSET : CMD_IO;
    }
}

/* Encodes `mesh`; its bytes go to `out`. */
static int encode(const options *o, const char *name, const asset *mesh,
                  unsigned threads, const guide *wish, bake_report *report,
                  asset_bytes *out)
{
    pmesh_attribute_input attributes[PMESH_MAX_ATTRIBUTES];
    pmesh_encoder_config config = pmesh_encoder_config_default();
    progress bar;

    for (size_t i = 0; i < mesh->attribute_count; i++) {
        const asset_attribute *a = &mesh->attributes[i];
        attributes[i] = (pmesh_attribute_input){
            .kind = a->kind, .set = a->set, .components = a->components,
            .bits = a->bits, .values = a->values, .count = a->count, .indices = a->indices,
        };
    }
    const pmesh_mesh_input input = {
        .positions = mesh->positions,
        .vertex_count = mesh->vertex_count,
        .indices = mesh->indices,
        .face_count = mesh->face_count,
        .materials = mesh->materials,
        .material_count = mesh->material_count,
        .material_names = (const char *const *)mesh->material_names,
        .attributes = attributes,
        .attribute_count = o->no_attributes ? 0 : mesh->attribute_count,
    };
    configure(o, &config);
    config.threads = threads;
    if (guide_says_something(&wish->use))
        config.guide = &wish->use;
    /* With a thread it may be one mesh of several at a time: no bar. */
    progress_begin(&bar, o->quiet || threads < o->threads ? PROGRESS_OFF
                         : o->progress ? PROGRESS_ON
                                       : PROGRESS_AUTO);
    config.progress = progress_update;
    config.progress_user = &bar;
    report->encode.clock = progress_clock;
    const pmesh_status status =
        pmesh_encode(&input, &config, collect, out, &report->encode);
    progress_end(&bar);
    return status == PMESH_OK ? CMD_DONE
                              : encode_failed(name, status, &report->encode);
}

static int bake_guided(const options *o, const char *name, const asset *mesh,
                       unsigned threads, bake_report *report,
                       asset_bytes *out)
{
    guide wish;
    int code = guide_of(o, name, mesh, &report->notes, &wish);
    if (code == CMD_DONE)
        code = encode(o, name, mesh, threads, &wish, report, out);
    guide_free(&wish);
    return code;
}

static int read_asset(const options *o, const char *path,
                      const file_data *data, asset *mesh)
{
    const bool standard = strcmp(path, "-") == 0;
    asset_error error;
    int code = CMD_DONE;

    if (o->format < 0)
        code = load_mesh_data(data, path, mesh, &error);
    else if (!asset_read(data->bytes, data->size,
                         (asset_format)(ASSET_OBJ + o->format),
                         standard ? NULL : path, mesh, &error))
        code = CMD_ASSET;
    if (code != CMD_DONE)
        report_asset_error(file_input_name(path), &error);
    return code;
}

static int bake_merged(const options *o, const file_data *data,
                       bake_report *report, asset_bytes *bytes)
{
    asset mesh;

    const double start = progress_clock();
    int code = read_asset(o, report->input, data, &mesh);
    if (code != CMD_DONE)
        return code;
    report->seconds_read += progress_clock() - start;
    report_note_lines(&report->notes, mesh.warnings);
    code = bake_guided(o, file_input_name(report->input), &mesh, o->threads,
                       report, bytes);
    asset_free(&mesh);
    if (code == CMD_DONE && (int)report->encode.base_coder != o->base)
        report_note(&report->notes,
                    report->encode.joined
                        ? "a base mesh whose sheets may join is coded "
                          "natively (see --topology)"
                        : "Draco cannot hold this base mesh, which is coded "
                          "natively instead");
    return code;
}

static int bake_one(void *user, const char *name, const asset *mesh,
                    unsigned threads, bake_report *report, asset_bytes *out)
{
    return bake_guided(user, name, mesh, threads, report, out);
}

static bool wants_glb(const options *o)
{
    return asset_format_of(o->output) == ASSET_GLB;
}

/* A glTF file with more in it than one mesh can hold, or that is to be one
 * again. */
static bool is_scene(const options *o, const file_data *data, const char *path)
{
    const asset_format format = o->format < 0
                                    ? asset_format_of(path)
                                    : (asset_format)(ASSET_OBJ + o->format);
    return !o->merge && !o->no_attributes && !o->guide &&
           (format == ASSET_GLB || format == ASSET_GLTF ||
            format == ASSET_UNKNOWN) &&
           !load_is_stream(data, path) &&
           (wants_glb(o) || scene_is_worth_it(data->bytes, data->size));
}

static int bake(options *o, const file_data *data, bake_report *report)
{
    asset_error error;
    asset_bytes bytes = { 0 };
    int code = CMD_USAGE;

    if (is_scene(o, data, report->input))
        code = bake_scene(data, o->threads, bake_one, o, wants_glb(o),
                          o->textures == 1, report, &bytes);
    else if (wants_glb(o))
        report_error(file_input_name(report->input), NULL,
                     "only a glTF scene can be baked into a .glb");
    else
        code = bake_merged(o, data, report, &bytes);

    if (code == CMD_DONE) {
        const double written = progress_clock();
        if (!file_write(o->output, bytes.data, bytes.size, &error)) {
            report_asset_error(file_output_name(o->output), &error);
            code = CMD_IO;
        }
        report->seconds_write = progress_clock() - written;
    }
    asset_bytes_free(&bytes);
    return code;
}

static void tell(const options *o, bake_report *report)
{
    bake_report_note_losses(report);
    if (report->encode.end == PMESH_END_EXHAUSTED &&
        (o->base_faces > 0 || o->base_vertices > 0 || o->base_ratio > 0))
        report_note(&report->notes,
                    "the base mesh has %" PRIu32
                    " faces: nothing more can be contracted",
                    report->encode.base_faces);
    if (o->json)
        bake_report_json(report, stdout);
    else if (!o->quiet) /* standard output may carry the file */
        bake_report_print(report,
                          strcmp(o->output, "-") == 0 ? stderr : stdout,
                          o->verbose);
    if (!o->quiet)
        report_notes_print(&report->notes, file_input_name(report->input));
}

int cmd_bake(int argc, char **argv)
{
    const pmesh_encoder_config defaults = pmesh_encoder_config_default();
    options o = {
        .profile = (int)defaults.profile,
        .placement = (int)defaults.placement,
        .metric = (int)defaults.metric,
        .format = -1,
        .position_bits = defaults.position_bits,
        .normal_bits = defaults.normal_bits,
        .uv_bits = defaults.texcoord_bits,
        .color_bits = defaults.color_bits,
        .generic_bits = defaults.generic_bits,
        .normal_weight = defaults.normal_weight,
        .uv_weight = defaults.texcoord_weight,
        .color_weight = defaults.color_weight,
        .generic_weight = defaults.generic_weight,
        .threads = workers_available(),
    };
    int count;
    file_data data;
    asset_error error;

    const args_result parsed = args_parse(&command, argc, argv, &o, &count);
    if (parsed != ARGS_RUN)
        return parsed == ARGS_HELP ? CMD_DONE : CMD_USAGE;
    int code = check_options(&o, count);
    if (code == CMD_DONE)
        code = check_camera(&o);
    if (code != CMD_DONE)
        return code;

    const double start = progress_clock();
    bake_report report = { .input = o.input ? o.input : argv[0],
                           .output = o.output,
                           .profile = (pmesh_profile)o.profile,
                           .placement = (pmesh_placement)o.placement };
    if (!file_read(report.input, FILE_LIMIT, &data, &error)) {
        report_asset_error(file_input_name(report.input), &error);
        return CMD_IO;
    }
    if (o.guide && !file_read(o.guide, FILE_LIMIT, &o.guide_data, &error)) {
        report_asset_error(file_input_name(o.guide), &error);
        file_free(&data);
        return CMD_IO;
    }
    report.input_bytes = data.size;
    report.seconds_read = progress_clock() - start;
    if (file_check_output(o.output, true, &data, &error)) {
        code = bake(&o, &data, &report);
    } else {
        report_asset_error(file_output_name(o.output), &error);
        code = CMD_IO;
    }
    file_free(&data);
    file_free(&o.guide_data);
    report.seconds_total = progress_clock() - start;
    if (code == CMD_DONE)
        tell(&o, &report);
    return code;
}
