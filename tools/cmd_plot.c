/* SPDX-License-Identifier: MIT */
/*
 * cmd_plot.c - draws bytes against distance of the levels of files.
 */
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "tools/args.h"
#include "tools/cmd.h"
#include "tools/distance.h"
#include "tools/file.h"
#include "tools/load.h"
#include "tools/plot.h"
#include "tools/report.h"
#include "tools/scene_file.h"
#include "tools/stream.h"

/* Points per surface when a distance is measured. */
#define SAMPLES 20000u

typedef struct options {
    const char *output;
    bool measure;
} options;

static const args_option option_table[] = {
    { .name = "output", .letter = 'o', .kind = ARGS_TEXT, .value = "FILE",
      .offset = offsetof(options, output),
      .help = "the SVG file (required); \"-\": standard output" },
    { .name = "measure", .kind = ARGS_FLAG,
      .offset = offsetof(options, measure),
      .help = "measure each level's RMS distance from full detail\n"
              "(by default: what the file says of it)" },
};

static const args_command command = {
    .name = "plot",
    .summary = "Draws bytes against distance of .pmesh files into an SVG file.",
    .synopsis = "FILE... -o RATE.svg [options]",
    .options = option_table,
    .option_count = sizeof option_table / sizeof *option_table,
    .details =
        "One curve for each file, one point for each level but the last: the "
        "bytes from the\nstart of the file that it needs, and its distance from "
        "full detail as a share of\nthe bounding box's diagonal, both "
        "logarithmic.\n\n"
        "  pmesh plot compact.pmesh quality.pmesh -o rate.svg --measure\n",
};

static double diagonal_of(const pmesh_header *header)
{
    double sum = 0;
    for (size_t k = 0; k < 3; k++)
        sum += (double)header->bounds[k] * header->bounds[k];
    return sqrt(sum) * header->grid.step;
}

/* The RMS distance of a level, in diagonals; negative when memory is out. */
static double measure_level(const stream *s, const asset *full,
                            const pmesh_level *level)
{
    const pmesh_target target = { .faces = level->faces };
    distance_report report;
    asset mesh;
    asset_error error;

    pmesh_decoder_refine(s->decoder, &target, NULL);
    if (!asset_from_decoder(s->decoder, &mesh, &error))
        return -1;
    const bool ok = distance_measure(full, &mesh, SAMPLES, &report);
    asset_free(&mesh);
    return ok ? report.both.rms / report.diagonal : -1;
}

static int add_levels(const options *o, const stream *s, plot_curve *curve,
                      asset_error *error)
{
    asset full = { 0 };
    int code = CMD_DONE;

    if (o->measure && !asset_from_decoder(s->decoder, &full, error))
        return CMD_IO;
    for (uint32_t i = 0; i + 1 < s->header.level_count; i++) {
        const pmesh_level *level = &s->header.levels[i];
        if (level->faces > s->progress.faces)
            break;
        const double y = o->measure ? measure_level(s, &full, level)
                                    : (double)level->error /
                                          diagonal_of(&s->header);
        if (y < 0) {
            asset_fail(error, "", "out of memory");
            code = CMD_IO;
            break;
        }
        plot_add(curve, (double)level->bytes, y);
    }
    asset_free(&full);
    return code;
}

static int read_curve(const options *o, const char *path, plot_curve *curve)
{
    const char *slash = strrchr(path, '/');
    asset_error error;
    file_data data;
    stream s;

    *curve = (plot_curve){ .count = 0 };
    snprintf(curve->name, sizeof curve->name, "%s",
             slash ? slash + 1 : file_input_name(path));
    if (!file_read(path, FILE_LIMIT, &data, &error)) {
        report_asset_error(file_input_name(path), &error);
        return CMD_IO;
    }
    int code = CMD_ASSET;
    if (!load_is_stream(&data, path) || scene_file_is(&data)) {
        asset_fail(&error, "", "no .pmesh file of one mesh");
    } else {
        code = stream_open(&data, &s, &error);
        if (code == CMD_DONE)
            code = add_levels(o, &s, curve, &error);
        stream_close(&s);
    }
    if (code != CMD_DONE)
        report_asset_error(file_input_name(path), &error);
    file_free(&data);
    return code;
}

int cmd_plot(int argc, char **argv)
{
    options o = { 0 };
    plot_curve curves[PLOT_CURVES];
    asset_bytes svg = { 0 };
    asset_error error;
    int count;

    const args_result result = args_parse(&command, argc, argv, &o, &count);
    if (result != ARGS_RUN)
        return result == ARGS_HELP ? CMD_DONE : CMD_USAGE;
    if (count < 1 || count > PLOT_CURVES || !o.output) {
        args_complain(&command, "one to %d FILEs and -o RATE.svg are needed",
                      PLOT_CURVES);
        return CMD_USAGE;
    }
    if (!file_check_output(o.output, false, NULL, &error)) {
        report_asset_error(file_output_name(o.output), &error);
        return CMD_IO;
    }
    for (int i = 0; i < count; i++) {
        const int code = read_curve(&o, argv[i], &curves[i]);
        if (code != CMD_DONE)
            return code;
    }
    bool ok = plot_write(curves, (size_t)count, "bytes",
                         o.measure ? "RMS distance / diagonal"
                                   : "distance / diagonal",
                         &svg);
    if (!ok)
        asset_fail(&error, "", "out of memory");
    ok = ok && file_write(o.output, svg.data, svg.size, &error);
    if (!ok)
        report_asset_error(file_output_name(o.output), &error);
    asset_bytes_free(&svg);
    return ok ? CMD_DONE : CMD_IO;
}
