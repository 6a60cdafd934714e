/* SPDX-License-Identifier: MIT */
/*
 * cmd_stats.c - what contractions cost at a number of faces.
 */
#include <inttypes.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

#include "encoder/pmesh_simplify.h"
#include "tools/args.h"
#include "tools/budgets.h"
#include "tools/cmd.h"
#include "tools/file.h"
#include "tools/json.h"
#include "tools/load.h"
#include "tools/report.h"

typedef struct options {
    const char *faces;
    int metric;
    bool json;
} options;

static const args_option option_table[] = {
    { .name = "at-faces", .letter = 'n', .kind = ARGS_TEXT, .value = "LIST",
      .offset = offsetof(options, faces),
      .help = "face counts such as 10k,500 (default: all faces)" },
    { .name = "metric", .kind = ARGS_CHOICE, .value = "memoryless|accumulated",
      .offset = offsetof(options, metric),
      .help = "quadrics of the current surface (default) or\n"
              "summed from the original" },
    { .name = "json", .kind = ARGS_FLAG, .offset = offsetof(options, json),
      .help = "one JSON object on stdout" },
};

static const args_command command = {
    .name = "stats",
    .summary = "Prints what the next contractions cost at a number of faces.",
    .synopsis = "FILE [options]",
    .options = option_table,
    .option_count = sizeof option_table / sizeof *option_table,
    .details =
        "The mesh is simplified to each number of faces, in strict order of "
        "cost. Then come\nthe least, mean and largest cost of the contractions "
        "that may follow: squared\ndistance times area of the mesh scaled to an "
        "extent of 1, and the error so far in\nmodel units.\n\n"
        "  pmesh stats cow.obj --at-faces 5k,500,100\n",
};

typedef struct row {
    uint32_t asked;
    pmesh_simplify_output result;
} row;

static pmesh_status measure(const asset *mesh, const options *o, row *r)
{
    const pmesh_simplify_input input = { .indices = mesh->indices,
                                         .face_count = mesh->face_count,
                                         .vertex_count = mesh->vertex_count,
                                         .doubles = mesh->positions };
    pmesh_simplify_options how = pmesh_simplify_options_default();
    pmesh_simplify_output *out = &r->result;

    how.faces = r->asked;
    how.metric = (pmesh_metric)o->metric;
    *out = (pmesh_simplify_output){ 0 };
    out->indices = malloc(3 * mesh->face_count * sizeof *out->indices);
    out->positions = malloc(3 * mesh->vertex_count * sizeof *out->positions);
    const pmesh_status status = out->indices && out->positions
                                    ? pmesh_simplify_mesh(&input, &how, out)
                                    : PMESH_E_MEMORY;
    free(out->indices);
    free(out->positions);
    return status;
}

static void print_row(const row *r)
{
    printf("%10zu  %10.4g  %10.4g  %10.4g  %10.4g\n", r->result.face_count,
           r->result.cost_least, r->result.cost_mean, r->result.cost_most,
           r->result.error);
}

static void print_json(const char *input, const row *rows, uint32_t count)
{
    json j;

    json_begin(&j, stdout);
    json_text(&j, "schema", "pmesh-stats-1");
    json_text(&j, "input", input);
    json_open(&j, "levels", '[');
    for (uint32_t i = 0; i < count; i++) {
        const pmesh_simplify_output *r = &rows[i].result;
        json_open_flat(&j, NULL, '{');
        json_count(&j, "faces", r->face_count);
        json_number(&j, "cost_least", r->cost_least);
        json_number(&j, "cost_mean", r->cost_mean);
        json_number(&j, "cost_most", r->cost_most);
        json_number(&j, "error", r->error);
        json_close(&j);
    }
    json_close(&j);
    json_end(&j);
}

static int run(const options *o, const char *input, budgets *list)
{
    asset_error error;
    asset mesh;
    row rows[BUDGETS_MAX];

    int code = load_mesh(input, &mesh, &error);
    if (code != CMD_DONE) {
        report_asset_error(file_input_name(input), &error);
        return code;
    }
    if (list->count == 0)
        list->faces[list->count++] = (uint32_t)mesh.face_count;
    for (uint32_t i = 0; i < list->count && code == CMD_DONE; i++) {
        rows[i].asked = list->faces[i];
        const pmesh_status status = measure(&mesh, o, &rows[i]);
        if (status == PMESH_OK)
            continue;
        report_error(file_input_name(input), NULL, "%s",
                     pmesh_status_text(status));
        code = status == PMESH_E_MEMORY ? CMD_IO : CMD_ASSET;
    }
    asset_free(&mesh);
    if (code == CMD_DONE && o->json) {
        print_json(input, rows, list->count);
    } else if (code == CMD_DONE) {
        printf("     faces  least cost        mean        most       error\n");
        for (uint32_t i = 0; i < list->count; i++)
            print_row(&rows[i]);
    }
    return code;
}

int cmd_stats(int argc, char **argv)
{
    options o = { 0 };
    budgets list = { .count = 0 };
    int operands;

    const args_result result = args_parse(&command, argc, argv, &o, &operands);
    if (result != ARGS_RUN)
        return result == ARGS_HELP ? CMD_DONE : CMD_USAGE;
    if (operands != 1) {
        args_complain(&command, "one FILE is needed");
        return CMD_USAGE;
    }
    if (o.faces && !budgets_parse(o.faces, &list)) {
        args_complain(&command, "--at-faces: '%s' is no list of face counts",
                      o.faces);
        return CMD_USAGE;
    }
    return run(&o, argv[0], &list);
}
