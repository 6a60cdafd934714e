/* SPDX-License-Identifier: MIT */
/*
 * cmd_simplify.c - a mesh file with fewer faces, without a .pmesh in between.
 */
#include <float.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "tools/args.h"
#include "tools/cmd.h"
#include "tools/file.h"
#include "tools/json.h"
#include "tools/load.h"
#include "tools/lod.h"
#include "tools/progress.h"
#include "tools/report.h"
#include "tools/trig.h"
#include "tools/triple.h"

typedef struct options {
    const char *input, *output, *camera;
    int format; /* which of CMD_FORMATS; -1: OUT's name tells */
    int placement, metric, cost;
    uint32_t faces, vertices;
    double ratio, error; /* negative: not given */
    double weld, threshold, memory;
    double turn; /* degrees; negative: not given */
    lod_weights weights;
    bool loose, no_attributes, json, quiet;
} options;

#define AT(member) .offset = offsetof(options, member)

/* The choices of --cost in the order of pmesh_cost; -1: not given. */
#define COSTS "quadric|length|camera|quadric-camera"
#define PLACEMENTS "optimal|line|midpoint|endpoint|volume|hull"

static const args_option option_table[] = {
    { .name = "output", .letter = 'o', .kind = ARGS_TEXT, .value = "OUT",
      AT(output),
      .help = "mesh to write: .obj .ply .stl .off .gltf .glb .drc,\n"
              "\"-\" for standard output (needs --format)" },
    { .name = "faces", .letter = 'n', .kind = ARGS_COUNT, .value = "N",
      .min = 1, .max = UINT32_MAX, AT(faces), .help = "at most N faces" },
    { .name = "ratio", .kind = ARGS_RATIO, .value = "R", .min = 0, .max = 1,
      AT(ratio), .help = "at most this share of the faces: 25% or 0.25" },
    { .name = "vertices", .kind = ARGS_COUNT, .value = "N", .min = 1,
      .max = UINT32_MAX, AT(vertices),
      .help = "at most N vertices (distinct positions)" },
    { .name = "error", .kind = ARGS_NUMBER, .value = "E", .min = 0,
      .max = DBL_MAX, AT(error),
      .help = "as far as the estimated distance stays below E\n"
              "(model units)" },
    { .name = "placement", .kind = ARGS_CHOICE, .value = PLACEMENTS,
      AT(placement),
      .help = "where a contracted edge goes: to the least error\n"
              "(default), on itself, its middle, its better end,\n"
              "where the volume stays, or outside of the surface:\n"
              "with hull the result encloses IN" },
    { .name = "cost", .kind = ARGS_CHOICE, .value = COSTS, AT(cost),
      .help = "what goes first: the least error (default), short\n"
              "edges, short ones as a camera sees them (both to\n"
              "the midpoint by default), or error as it sees it" },
    { .name = "camera", .kind = ARGS_TEXT, .value = "X,Y,Z", AT(camera),
      .help = "where it is (model units)" },
    { .name = "metric", .kind = ARGS_CHOICE,
      .value = "memoryless|accumulated", AT(metric),
      .help = "quadrics of the current surface (default) or\n"
              "summed from the original" },
    { .name = "memory", .kind = ARGS_NUMBER, .value = "W", .min = 0, .max = 1e6,
      AT(memory),
      .help = "how much the original counts beside the current\n"
              "surface (default 0.35); more lowers the largest error" },
    { .name = "normal-weight", .kind = ARGS_NUMBER, .value = "W", .min = 0,
      .max = 1e6, AT(weights.normal),
      .help = "how much a difference of 1 counts against the\n"
              "model's extent; 0: not at all" },
    { .name = "uv-weight", .kind = ARGS_NUMBER, .value = "W", .min = 0,
      .max = 1e6, AT(weights.texcoord),
      .help = "the same of texture coordinates" },
    { .name = "color-weight", .kind = ARGS_NUMBER, .value = "W", .min = 0,
      .max = 1e6, AT(weights.color), .help = "of colours" },
    { .name = "generic-weight", .kind = ARGS_NUMBER, .value = "W", .min = 0,
      .max = 1e6, AT(weights.generic),
      .help = "and of others: tangents, skin weights, your own" },
    { .name = "weld", .kind = ARGS_NUMBER, .value = "EPS", .min = 0,
      .max = DBL_MAX, AT(weld),
      .help = "join positions this close (model units);\n"
              "default 0: only equal ones" },
    { .name = "threshold", .kind = ARGS_NUMBER, .value = "T", .min = 0,
      .max = DBL_MAX, AT(threshold),
      .help = "also contract unconnected vertices closer than T\n"
              "(model units): parts grow together" },
    { .name = "turn", .kind = ARGS_NUMBER, .value = "DEG", .min = 1, .max = 180,
      AT(turn),
      .help = "turn no face further than this from how it was" },
    { .name = "loose", .kind = ARGS_FLAG, AT(loose),
      .help = "rather than stopping early, let pieces vanish and\n"
              "holes close" },
    { .name = "no-attributes", .kind = ARGS_FLAG, AT(no_attributes),
      .help = "leave out normals, texture coordinates and colours" },
    { .name = "format", .kind = ARGS_CHOICE, .value = CMD_FORMATS, AT(format),
      .help = "format of OUT if its name does not tell" },
    { .name = "input", .letter = 'i', .kind = ARGS_TEXT, .value = "IN",
      AT(input), .help = "the same as IN" },
    { .name = "json", .kind = ARGS_FLAG, AT(json),
      .help = "report as one JSON object on stdout" },
    { .name = "quiet", .letter = 'q', .kind = ARGS_FLAG, AT(quiet),
      .help = "no report and no warnings" },
};

static const args_command command = {
    .name = "simplify",
    .summary = "Writes a mesh with fewer faces.",
    .synopsis = "IN -o OUT --faces N [options]",
    .options = option_table,
    .option_count = sizeof option_table / sizeof *option_table,
    .details =
        "IN is a mesh file of any kind, or a .pmesh at full detail, or \"-\" "
        "for standard\ninput. Edges are contracted in the order of cost, one "
        "by one: the most accurate\nway there is here. Of several bounds the "
        "first that is reached ends it. If\nnothing more can be contracted "
        "before, the result is written with a warning\nthat says so.\n\n"
        "  pmesh simplify statue.ply -o small.glb --faces 5k\n"
        "  pmesh simplify cow.obj -o cow1.obj --ratio 10% --placement "
        "endpoint\n"
        "  pmesh simplify cow.obj -o seen.obj --faces 500 \\\n"
        "      --cost quadric-camera --camera 3,0,25\n",
};

static const char *const ends[] = { "faces", "vertices", "error",
                                    "exhausted" };

static bool is_text(asset_format format)
{
    return format == ASSET_OBJ || format == ASSET_OFF || format == ASSET_GLTF;
}

static int usage(const char *what)
{
    args_complain(&command, "%s", what);
    return CMD_USAGE;
}

static int find_format(const options *o, asset_format *format)
{
    *format = o->format >= 0 ? (asset_format)(ASSET_OBJ + o->format)
                             : asset_format_of(o->output);
    if (*format != ASSET_UNKNOWN)
        return CMD_DONE;
    if (strcmp(o->output, "-") == 0)
        return usage("standard output needs --format");
    args_complain(&command, "cannot tell the format of '%s' from its name "
                  "(--format)", o->output);
    return CMD_USAGE;
}

static int configure(const options *o, pmesh_simplify_options *to)
{
    *to = pmesh_simplify_options_default();
    to->faces = o->ratio >= 0 && o->faces == 0 ? 1 : o->faces;
    to->vertices = o->vertices;
    /* 29 % of 100 faces are 29, though 0.29 * 100 is a little less. */
    to->ratio = o->ratio > 0 ? o->ratio * (1 + DBL_EPSILON) : 0;
    if (o->error >= 0) /* the library takes 0 for no bound */
        to->error = o->error > 0 ? o->error : DBL_MIN;
    to->metric = (pmesh_metric)o->metric;
    to->cost = (pmesh_cost)o->cost;
    to->memory = o->memory;
    to->weld = o->weld;
    to->threshold = o->threshold;
    to->loose = o->loose;
    if (o->turn >= 0)
        to->turn_cosine = trig_cos(o->turn / 360);
    if (o->placement >= 0)
        to->placement = (pmesh_place)o->placement;
    else if (to->cost == PMESH_COST_LENGTH || to->cost == PMESH_COST_CAMERA)
        to->placement = PMESH_PLACE_MIDPOINT;
    const bool seen = to->cost == PMESH_COST_CAMERA ||
                      to->cost == PMESH_COST_QUADRIC_CAMERA;
    if (seen != (o->camera != NULL))
        return usage(seen ? "this cost needs --camera"
                          : "--camera is for a cost with camera");
    if (seen && !triple_parse(o->camera, to->camera))
        return usage("--camera takes three numbers: 3,0,25");
    return CMD_DONE;
}

static int plan(const options *o, int count)
{
    const int inputs = count + (o->input != NULL);

    if (inputs != 1)
        return usage(inputs == 0 ? "no input is named" : "takes one input");
    if (!o->output)
        return usage("no output is named (-o OUT)");
    if (o->json && strcmp(o->output, "-") == 0)
        return usage("--json and -o - both need standard output");
    if (o->faces == 0 && o->vertices == 0 && o->ratio < 0 && o->error < 0)
        return usage("no bound is given (--faces, --ratio, --vertices, "
                     "--error)");
    return CMD_DONE;
}

/* What is told in the end. */
typedef struct simplification {
    const options *options;
    const char *input;
    size_t input_faces;
    asset result;
    lod_report lod;
    double seconds;
} simplification;

static void print_json(const simplification *s)
{
    json j;

    json_begin(&j, stdout);
    json_text(&j, "schema", "pmesh-simplify-1");
    json_text(&j, "tool", "pmesh");
    json_text(&j, "version", pmesh_version());
    json_text(&j, "input", s->input);
    json_text(&j, "output", s->options->output);
    json_count(&j, "input_faces", s->input_faces);
    json_count(&j, "dropped_faces", s->lod.dropped_faces);
    json_count(&j, "faces", s->result.face_count);
    json_count(&j, "vertices", s->lod.vertices);
    json_count(&j, "joined", s->lod.joined);
    json_text(&j, "end", ends[s->lod.end]);
    json_number(&j, "error", s->lod.error);
    json_number(&j, "cost_min", s->lod.cost_least);
    json_number(&j, "cost_mean", s->lod.cost_mean);
    json_number(&j, "cost_max", s->lod.cost_most);
    json_number(&j, "seconds", s->seconds);
    json_end(&j);
}

static void tell(const simplification *s)
{
    const options *o = s->options;
    /* Standard output may carry the mesh. */
    FILE *out = strcmp(o->output, "-") == 0 ? stderr : stdout;
    const char *name = file_input_name(s->input);

    if (o->json) {
        print_json(s);
    } else if (!o->quiet) {
        report_put(out, file_output_name(o->output));
        fprintf(out, ": %zu of %zu faces, %zu vertices, error %.4g, %.2f s\n",
                s->result.face_count, s->input_faces, s->lod.vertices,
                s->lod.error, s->seconds);
    }
    if (o->quiet)
        return;
    if (s->lod.dropped_faces > 0)
        report_warning(name, "%zu faces are degenerate or not finite, left "
                       "out", s->lod.dropped_faces);
    if (s->lod.end == PMESH_END_EXHAUSTED &&
        (o->faces > 0 || o->vertices > 0 || o->ratio >= 0))
        report_warning(name, "stopped at %zu faces: nothing more can be "
                       "contracted%s", s->result.face_count,
                       o->loose ? "" : " without --loose");
}

static int failed(const char *name, pmesh_status status)
{
    report_error(name, NULL, "%s", pmesh_status_text(status));
    return status == PMESH_E_MEMORY     ? CMD_IO
           : status == PMESH_E_ARGUMENT ? CMD_USAGE
                                        : CMD_ASSET;
}

static int simplify(simplification *s, const pmesh_simplify_options *how,
                    const file_data *data, asset_format format)
{
    const options *o = s->options;
    const char *name = file_input_name(s->input);
    asset in;
    asset_error error;
    asset_bytes bytes = { 0 };

    int code = load_mesh_data(data, s->input, &in, &error);
    if (code != CMD_DONE) {
        report_asset_error(name, &error);
        return code;
    }
    report_notes notes = { 0 };
    report_note_lines(&notes, in.warnings);
    if (!o->quiet)
        report_notes_print(&notes, name);
    const size_t attribute_count = in.attribute_count;
    if (o->no_attributes)
        in.attribute_count = 0;
    s->input_faces = in.face_count;
    const double start = progress_clock();
    const pmesh_status status =
        lod_make(&in, how, &o->weights, &s->result, &s->lod);
    s->seconds = progress_clock() - start;
    in.attribute_count = attribute_count;
    asset_free(&in);
    if (status != PMESH_OK)
        return failed(name, status);
    bool good = asset_write(&s->result, format, &bytes, &error);
    if (good && bytes.failed)
        good = asset_fail(&error, "", "out of memory");
    good = good && file_write(o->output, bytes.data, bytes.size, &error);
    if (!good)
        report_asset_error(file_output_name(o->output), &error);
    asset_bytes_free(&bytes);
    return good ? CMD_DONE : CMD_IO;
}

int cmd_simplify(int argc, char **argv)
{
    options o = { .format = -1,
                  .placement = -1,
                  .ratio = -1,
                  .error = -1,
                  .turn = -1,
                  .memory = pmesh_simplify_options_default().memory,
                  .weights = { 0.01, 0.1, 0.03, 0.03 } };
    pmesh_simplify_options how;
    asset_format format;
    int count;
    file_data data;
    asset_error error;

    const args_result parsed = args_parse(&command, argc, argv, &o, &count);
    if (parsed != ARGS_RUN)
        return parsed == ARGS_HELP ? CMD_DONE : CMD_USAGE;
    int code = plan(&o, count);
    if (code == CMD_DONE)
        code = configure(&o, &how);
    if (code == CMD_DONE)
        code = find_format(&o, &format);
    if (code != CMD_DONE)
        return code;
    simplification s = { .options = &o,
                         .input = o.input ? o.input : argv[0] };
    if (!file_read(s.input, FILE_LIMIT, &data, &error)) {
        report_asset_error(file_input_name(s.input), &error);
        return CMD_IO;
    }
    if (file_check_output(o.output, !is_text(format), &data, &error)) {
        code = simplify(&s, &how, &data, format);
    } else {
        report_asset_error(file_output_name(o.output), &error);
        code = CMD_IO;
    }
    file_free(&data);
    if (code == CMD_DONE)
        tell(&s);
    asset_free(&s.result);
    return code;
}
