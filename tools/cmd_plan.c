/* SPDX-License-Identifier: MIT */
/*
 * cmd_plan.c - how much of a file to load, from its level table alone.
 */
#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>

#include "decoder/pmesh_plan.h"
#include "tools/args.h"
#include "tools/cmd.h"
#include "tools/file.h"
#include "tools/json.h"
#include "tools/report.h"
#include "tools/stream.h"

typedef struct options {
    uint64_t bytes;
    uint32_t faces;
    double error, pixels, distance, fov, height; /* negative: not given */
    bool json;
} options;

static const args_option option_table[] = {
    { .name = "bytes", .kind = ARGS_SIZE, .value = "N", .min = 1,
      .max = FILE_LIMIT, .offset = offsetof(options, bytes),
      .help = "the finest level within the first N bytes" },
    { .name = "faces", .letter = 'n', .kind = ARGS_COUNT, .value = "N",
      .min = 1, .max = UINT32_MAX, .offset = offsetof(options, faces),
      .help = "the finest level of at most N faces" },
    { .name = "error", .kind = ARGS_NUMBER, .value = "E", .min = 0,
      .max = DBL_MAX, .offset = offsetof(options, error),
      .help = "the coarsest level within E (model units)" },
    { .name = "pixels", .kind = ARGS_NUMBER, .value = "P", .min = 0,
      .max = DBL_MAX, .offset = offsetof(options, pixels),
      .help = "the coarsest level whose error covers at most P pixels,\n"
              "seen from --distance" },
    { .name = "distance", .kind = ARGS_NUMBER, .value = "D", .min = 1e-300,
      .max = DBL_MAX, .offset = offsetof(options, distance),
      .help = "from the camera to the mesh (model units)" },
    { .name = "fov", .kind = ARGS_NUMBER, .value = "DEGREES", .min = 0.01,
      .max = 179, .offset = offsetof(options, fov),
      .help = "vertical field of view (default 45)" },
    { .name = "height", .kind = ARGS_NUMBER, .value = "PX", .min = 1,
      .max = 1e6, .offset = offsetof(options, height),
      .help = "of the image (default 1080)" },
    { .name = "json", .kind = ARGS_FLAG, .offset = offsetof(options, json),
      .help = "print one JSON object on stdout" },
};

static const args_command command = {
    .name = "plan",
    .summary = "Says how much of a .pmesh file to load for a purpose.",
    .synopsis = "FILE --bytes N|--faces N|--error E|--pixels P --distance D "
                "[options]",
    .options = option_table,
    .option_count = sizeof option_table / sizeof *option_table,
    .details =
        "Reads the level table only, so the first kilobytes of FILE are "
        "enough. Of several\nlimits the coarsest level wins. An error that "
        "covers less than a pixel cannot be\nseen; programs find the same rule, "
        "with hysteresis and for many meshes, in\npmesh_plan.h.\n\n"
        "  pmesh plan bunny.pmesh --pixels 1 --distance 3\n"
        "  head -c $(pmesh plan bunny.pmesh --error 0.01 | awk '/^bytes/ "
        "{print $2}') \\\n    bunny.pmesh >start.pmesh\n",
};

/* The answer, and what its error looks like if a camera was told. */
typedef struct answer {
    const pmesh_header *h;
    uint32_t level;
    double pixels_per_unit; /* 0: none */
} answer;

static uint32_t coarser(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

static answer choose(const options *o, const pmesh_header *h)
{
    const double half = o->fov * 3.14159265358979323846 / 360;
    const uint32_t count = h->level_count;
    answer a = { h, count - 1, 0 };

    if (o->bytes > 0)
        a.level = coarser(a.level, pmesh_plan_bytes(h->levels, count, o->bytes));
    if (o->faces > 0)
        a.level = coarser(a.level, pmesh_plan_faces(h->levels, count, o->faces));
    if (o->error >= 0) /* levels store floats: what info prints is met */
        a.level = coarser(a.level, pmesh_plan_error(h->levels, count,
                                                    (double)(float)o->error));
    if (o->distance > 0)
        a.pixels_per_unit = o->height / (2 * o->distance * tan(half));
    if (o->pixels >= 0)
        a.level = coarser(a.level,
                          pmesh_plan_pixels(h->levels, count, a.pixels_per_unit,
                                            o->pixels, UINT32_MAX));
    return a;
}

static void print_text(const answer *a)
{
    const pmesh_level *l = &a->h->levels[a->level];

    printf("level        %" PRIu32 " of %" PRIu32 "\n", a->level + 1,
           a->h->level_count);
    printf("bytes        %" PRIu64 " of %" PRIu64 "\n", l->bytes, a->h->bytes);
    printf("faces        %" PRIu32 " of %" PRIu32 "\n", l->faces, a->h->faces);
    printf("error        %.4g", (double)l->error);
    if (a->pixels_per_unit > 0)
        printf(", %.3g pixels", (double)l->error * a->pixels_per_unit);
    putchar('\n');
    if (a->h->measured)
        printf("measured     %.4g rms, %.4g at most\n", (double)l->rms,
               (double)l->furthest);
}

static void print_json(const char *path, const answer *a)
{
    const pmesh_level *l = &a->h->levels[a->level];
    json j;

    json_begin(&j, stdout);
    json_text(&j, "schema", "pmesh-plan-1");
    json_text(&j, "tool", "pmesh");
    json_text(&j, "version", pmesh_version());
    json_text(&j, "input", path);
    json_count(&j, "level", a->level);
    json_count(&j, "levels", a->h->level_count);
    json_count(&j, "bytes", l->bytes);
    json_count(&j, "faces", l->faces);
    json_count(&j, "vertices", l->mesh_vertices);
    json_count(&j, "output_vertices", l->vertices);
    json_float(&j, "error", l->error);
    if (a->h->measured) {
        json_float(&j, "rms", l->rms);
        json_float(&j, "furthest", l->furthest);
    }
    if (a->pixels_per_unit > 0)
        json_number(&j, "pixels", (double)l->error * a->pixels_per_unit);
    json_end(&j);
}

static int usage(const char *what)
{
    args_complain(&command, "%s", what);
    return CMD_USAGE;
}

int cmd_plan(int argc, char **argv)
{
    options o = { .error = -1, .pixels = -1, .distance = -1, .fov = 45,
                  .height = 1080 };
    int count;
    file_data data;
    asset_error error;
    stream s;

    const args_result parsed = args_parse(&command, argc, argv, &o, &count);
    if (parsed != ARGS_RUN)
        return parsed == ARGS_HELP ? CMD_DONE : CMD_USAGE;
    if (count != 1)
        return usage(count == 0 ? "no file is named" : "takes one file");
    if (o.bytes == 0 && o.faces == 0 && o.error < 0 && o.pixels < 0)
        return usage("needs --bytes, --faces, --error or --pixels");
    if (o.pixels >= 0 && o.distance < 0)
        return usage("--pixels needs --distance");
    if (!file_read(argv[0], FILE_LIMIT, &data, &error)) {
        report_asset_error(file_input_name(argv[0]), &error);
        return CMD_IO;
    }
    const int code = stream_open_header(&data, &s, &error);
    if (code == CMD_DONE) {
        const answer a = choose(&o, &s.header);
        if (o.json)
            print_json(argv[0], &a);
        else
            print_text(&a);
    } else {
        report_asset_error(file_input_name(argv[0]), &error);
    }
    stream_close(&s);
    file_free(&data);
    return code;
}
