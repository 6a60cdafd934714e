/* SPDX-License-Identifier: MIT */
/*
 * cmd_guide.c - begins a guide file for a mesh.
 */
#include <stddef.h>

#include "tools/args.h"
#include "tools/cmd.h"
#include "tools/file.h"
#include "tools/guide.h"
#include "tools/load.h"
#include "tools/report.h"

typedef struct options {
    const char *output, *weights, *guide;
} options;

static const args_option option_table[] = {
    { .name = "output", .letter = 'o', .kind = ARGS_TEXT, .value = "FILE",
      .offset = offsetof(options, output),
      .help = "the guide file, NAME.guide.json (required)" },
    { .name = "weights", .kind = ARGS_TEXT, .value = "SOURCE",
      .offset = offsetof(options, weights),
      .help = "write these weights into it: color:r, color:r-b,\n"
              "attr:NAME, texture:MASK.png" },
    { .name = "guide", .kind = ARGS_TEXT, .value = "FILE",
      .offset = offsetof(options, guide),
      .help = "and those of another guide file, carried over" },
};

static const args_command command = {
    .name = "guide",
    .summary = "Begins a guide file, which says what matters of a mesh.",
    .synopsis = "MESH -o NAME.guide.json [options]",
    .options = option_table,
    .option_count = sizeof option_table / sizeof *option_table,
    .details =
        "The file has the places of the mesh's vertices, so that it serves "
        "other versions\nof the mesh, too; weights; and empty lists of locks, "
        "contours, planes, points,\nsegments and cameras to fill. guide.md "
        "describes them.\n\n"
        "  pmesh guide cow.obj -o cow.guide.json\n"
        "  pmesh bake cow.obj --guide cow.guide.json -o cow.pmesh\n",
};

static bool fill(const options *o, const asset *mesh, guide *g,
                 const char **name, asset_error *error)
{
    file_data data;

    if (o->weights && !guide_take_weights(g, mesh, o->weights, error))
        return false;
    if (!o->weights && !guide_take_own_weights(g, mesh, error))
        return false;
    if (!o->guide)
        return true;
    *name = file_input_name(o->guide);
    if (!file_read(o->guide, FILE_LIMIT, &data, error))
        return false;
    const bool ok = guide_read(g, data.bytes, data.size, mesh, error);
    file_free(&data);
    return ok;
}

static int run(const options *o, const char *input)
{
    const char *name = file_input_name(input);
    asset_bytes text = { 0 };
    asset_error error;
    asset mesh;
    guide g;

    int code = load_mesh(input, &mesh, &error);
    if (code != CMD_DONE) {
        report_asset_error(name, &error);
        return code;
    }
    if (!guide_create(&g)) {
        report_error(name, NULL, "out of memory");
        code = CMD_IO;
    } else if (!fill(o, &mesh, &g, &name, &error)) {
        report_asset_error(name, &error);
        code = CMD_ASSET;
    } else if (!guide_write(&g, &mesh, &text) ||
               !file_write(o->output, text.data, text.size, &error)) {
        if (text.failed)
            report_error(name, NULL, "out of memory");
        else
            report_asset_error(file_output_name(o->output), &error);
        code = CMD_IO;
    }
    asset_bytes_free(&text);
    guide_free(&g);
    asset_free(&mesh);
    return code;
}

int cmd_guide(int argc, char **argv)
{
    options o = { 0 };
    int operands;

    const args_result result = args_parse(&command, argc, argv, &o, &operands);
    if (result != ARGS_RUN)
        return result == ARGS_HELP ? CMD_DONE : CMD_USAGE;
    if (operands != 1 || !o.output) {
        args_complain(&command, "one MESH and -o FILE are needed");
        return CMD_USAGE;
    }
    return run(&o, argv[0]);
}
