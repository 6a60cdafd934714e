/* SPDX-License-Identifier: MIT */
/*
 * cmd_sample.c - writes a detailed mesh to try the program with.
 */
#include <stddef.h>

#include "tools/args.h"
#include "tools/asset.h"
#include "tools/cmd.h"
#include "tools/file.h"
#include "tools/report.h"
#include "tools/sample.h"

typedef struct options {
    const char *output, *format;
    uint32_t faces;
} options;

static const args_option option_table[] = {
    { .name = "output", .letter = 'o', .kind = ARGS_TEXT, .value = "FILE",
      .offset = offsetof(options, output),
      .help = "the mesh file: .obj .ply .stl .off .gltf .glb .drc\n"
              "(required)" },
    { .name = "faces", .letter = 'n', .kind = ARGS_COUNT, .value = "N",
      .min = SAMPLE_MIN_FACES, .max = SAMPLE_MAX_FACES,
      .offset = offsetof(options, faces),
      .help = "about N faces (default 100k)" },
    { .name = "format", .kind = ARGS_TEXT, .value = "NAME",
      .offset = offsetof(options, format),
      .help = "obj, ply, ... whatever FILE is called" },
};

static const args_command command = {
    .name = "sample",
    .summary = "Writes a detailed mesh to try the program with.",
    .synopsis = "-o FILE [options]",
    .options = option_table,
    .option_count = sizeof option_table / sizeof *option_table,
    .details =
        "An ammonite: a closed surface with normals and texture coordinates, "
        "smooth and\nsharp parts, and the more detail the more faces it gets. "
        "The same bytes on every\nmachine.\n\n"
        "  pmesh sample -o shell.obj\n"
        "  pmesh sample -o shell.ply --faces 2M\n",
};

static int write_sample(const options *opt, asset_format format)
{
    const char *name = file_output_name(opt->output);
    asset_bytes bytes = { 0 };
    asset_error error;
    asset mesh;

    if (!file_check_output(opt->output, true, NULL, &error)) {
        report_asset_error(name, &error);
        return CMD_IO;
    }
    if (!sample_build(opt->faces, &mesh)) {
        report_error(name, NULL, "out of memory");
        return CMD_IO;
    }
    const bool ok =
        asset_write(&mesh, format, &bytes, &error) &&
        file_write(opt->output, bytes.data, bytes.size, &error);
    if (!ok)
        report_asset_error(name, &error);
    asset_bytes_free(&bytes);
    asset_free(&mesh);
    return ok ? CMD_DONE : CMD_IO;
}

int cmd_sample(int argc, char **argv)
{
    options opt = { .faces = 100000 };
    int operands;

    const args_result result =
        args_parse(&command, argc, argv, &opt, &operands);
    if (result == ARGS_HELP)
        return CMD_DONE;
    if (result == ARGS_BAD)
        return CMD_USAGE;
    if (operands != 0 || !opt.output) {
        args_complain(&command, operands != 0 ? "there is no input"
                                              : "-o FILE is needed");
        return CMD_USAGE;
    }
    const asset_format format =
        asset_format_of(opt.format ? opt.format : opt.output);
    if (format == ASSET_UNKNOWN) {
        args_complain(&command, "'%s' names no mesh format",
                      opt.format ? opt.format : opt.output);
        return CMD_USAGE;
    }
    return write_sample(&opt, format);
}
