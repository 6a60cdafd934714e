/* SPDX-License-Identifier: MIT */
/*
 * cmd_compare.c - how far two meshes are apart.
 */
#include <math.h>
#include <stddef.h>
#include <stdio.h>

#include "tools/args.h"
#include "tools/asset.h"
#include "tools/cmd.h"
#include "tools/digits.h"
#include "tools/distance.h"
#include "tools/json.h"
#include "tools/load.h"
#include "tools/report.h"
#include "tools/topology.h"

typedef struct options {
    uint32_t samples;
    double fail_above;
    bool json;
} options;

static const args_option option_table[] = {
    { .name = "samples", .kind = ARGS_COUNT, .value = "N",
      .min = 1, .max = 1e9, .offset = offsetof(options, samples),
      .help = "points taken on each surface (default 200k)" },
    { .name = "fail-above", .kind = ARGS_NUMBER, .value = "E", .min = 0,
      .max = 1e300, .offset = offsetof(options, fail_above),
      .help = "exit with 5 if the largest distance exceeds E\n"
              "(model units)" },
    { .name = "json", .kind = ARGS_FLAG, .offset = offsetof(options, json),
      .help = "report as JSON" },
};

static const args_command command = {
    .name = "compare",
    .summary = "Measures how far two meshes are apart.",
    .synopsis = "A B [options]",
    .options = option_table,
    .option_count = sizeof option_table / sizeof *option_table,
    .details =
        "A and B are mesh files or .pmesh files, which count at full detail;\n"
        "one of them may be - for standard input. Each surface is projected\n"
        "on the other. Lengths are in model units; names with _rel and\n"
        "percentages are fractions of the diagonal of A's bounding box. The\n"
        "maximum is the Hausdorff distance, at most 0.5 % too low as a rule.\n"
        "\n"
        "Examples:\n"
        "  pmesh compare statue.ply statue.pmesh\n"
        "  pmesh compare a.obj b.obj --fail-above 0.01 --json\n"
};

/* One of the two meshes. */
typedef struct side {
    const char *path;
    asset mesh;
    topology_report topology;
} side;

static int load_side(side *s)
{
    asset_error error;
    report_notes notes = { 0 };
    const char *name = file_input_name(s->path);

    const int code = load_mesh(s->path, &s->mesh, &error);
    if (code != CMD_DONE) {
        report_asset_error(name, &error);
        return code;
    }
    report_note_lines(&notes, s->mesh.warnings);
    report_notes_print(&notes, name);
    if (!distance_has_faces(&s->mesh)) {
        report_error(name, NULL, "no face has finite positions");
        return CMD_ASSET;
    }
    if (!topology_measure(&s->mesh, &s->topology)) {
        report_error(name, NULL, "out of memory");
        return CMD_IO;
    }
    return CMD_DONE;
}

/* A length by the diagonal, which is 0 if A is a point. */
static double relative(double length, double diagonal)
{
    return length > 0 ? length / diagonal : 0;
}

/* ---- JSON --------------------------------------------------------------- */

static void put_side(json *j, const char *key, const side *s)
{
    const topology_report *t = &s->topology;

    json_open(j, key, '{');
    json_text(j, "file", s->path);
    json_count(j, "faces", t->faces);
    json_count(j, "vertices", t->vertices);
    json_count(j, "boundary_edges", t->boundary_edges);
    json_count(j, "nonmanifold_edges", t->nonmanifold_edges);
    json_count(j, "misoriented_edges", t->misoriented_edges);
    json_count(j, "degenerate_faces", t->degenerate_faces);
    json_count(j, "folds", t->folds);
    json_count(j, "components", t->components);
    json_number(j, "euler", (double)t->euler);
    json_close(j);
}

static void put_stats(json *j, const char *suffix, const distance_stats *s,
                      double diagonal)
{
    const struct {
        const char *name;
        double length;
    } rows[] = { { "rms", s->rms }, { "mean", s->mean }, { "max", s->max } };
    char key[32];

    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        snprintf(key, sizeof key, "%s%s", rows[i].name, suffix);
        json_number(j, key, rows[i].length);
        snprintf(key, sizeof key, "%s%s_rel", rows[i].name, suffix);
        json_number(j, key, relative(rows[i].length, diagonal));
    }
    snprintf(key, sizeof key, "normal_deg%s", suffix);
    json_number(j, key, s->normal_deg);
}

static void print_json(const side sides[2], const distance_report *report)
{
    json j;

    json_begin(&j, stdout);
    json_text(&j, "schema", "pmesh-compare-1");
    json_text(&j, "tool", "pmesh");
    json_text(&j, "version", pmesh_version());
    put_side(&j, "a", &sides[0]);
    put_side(&j, "b", &sides[1]);
    json_number(&j, "diagonal", report->diagonal);
    json_count(&j, "samples", report->samples);
    put_stats(&j, "", &report->both, report->diagonal);
    put_stats(&j, "_ab", &report->a_to_b, report->diagonal);
    put_stats(&j, "_ba", &report->b_to_a, report->diagonal);
    json_end(&j);
}

/* ---- the table ---------------------------------------------------------- */

static void print_counts(const side sides[2])
{
    const topology_report *a = &sides[0].topology;
    const topology_report *b = &sides[1].topology;
    const struct {
        const char *name;
        size_t a, b;
        bool always; /* otherwise only if there is something to tell */
    } rows[] = {
        { "faces", a->faces, b->faces, true },
        { "vertices", a->vertices, b->vertices, true },
        { "components", a->components, b->components, true },
        { "boundary edges", a->boundary_edges, b->boundary_edges, true },
        { "non-manifold edges", a->nonmanifold_edges, b->nonmanifold_edges,
          true },
        { "misoriented edges", a->misoriented_edges, b->misoriented_edges,
          false },
        { "degenerate faces", a->degenerate_faces, b->degenerate_faces, false },
        { "folds", a->folds, b->folds, false },
    };

    for (size_t i = 0; i < 2; i++) {
        printf("%c  ", 'A' + (char)i);
        report_put(stdout, file_input_name(sides[i].path));
        printf("\n");
    }
    printf("\n%-20s %14s %14s\n", "", "A", "B");
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char left[32], right[32];
        if (!rows[i].always && rows[i].a == 0 && rows[i].b == 0)
            continue;
        digits_grouped(left, rows[i].a);
        digits_grouped(right, rows[i].b);
        printf("%-20s %14s %14s\n", rows[i].name, left, right);
    }
}

static void print_distances(const distance_report *r)
{
    const struct {
        const char *name;
        double values[3];
    } rows[] = {
        { "rms", { r->a_to_b.rms, r->b_to_a.rms, r->both.rms } },
        { "mean", { r->a_to_b.mean, r->b_to_a.mean, r->both.mean } },
        { "max", { r->a_to_b.max, r->b_to_a.max, r->both.max } },
    };

    printf("\n%-20s %14s %14s %14s %14s\n", "distance", "A to B", "B to A",
           "both", "of diagonal");
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        printf("%-20s", rows[i].name);
        for (size_t k = 0; k < 3; k++)
            printf(" %14.5g", rows[i].values[k]);
        printf(" %12.4g %%\n", 100 * relative(rows[i].values[2], r->diagonal));
    }
    printf("%-20s %14.2f %14.2f %14.2f degrees\n", "normals, rms",
           r->a_to_b.normal_deg, r->b_to_a.normal_deg, r->both.normal_deg);
}

/* ---- command ------------------------------------------------------------ */

static int compare(side sides[2], const options *opt)
{
    distance_report report;

    for (size_t i = 0; i < 2; i++) {
        const int code = load_side(&sides[i]);
        if (code != CMD_DONE)
            return code;
    }
    if (!distance_measure(&sides[0].mesh, &sides[1].mesh, opt->samples,
                          &report)) {
        report_error(NULL, NULL, "out of memory");
        return CMD_IO;
    }
    if (opt->json) {
        print_json(sides, &report);
    } else {
        print_counts(sides);
        print_distances(&report);
    }
    if (report.both.max > opt->fail_above) {
        report_error(file_input_name(sides[1].path), NULL,
                     "largest distance %g exceeds %g", report.both.max,
                     opt->fail_above);
        return CMD_BOUND;
    }
    return CMD_DONE;
}

int cmd_compare(int argc, char **argv)
{
    options opt = { .samples = DISTANCE_DEFAULT_SAMPLES,
                    .fail_above = HUGE_VAL };
    int operands;

    const args_result result =
        args_parse(&command, argc, argv, &opt, &operands);
    if (result == ARGS_HELP)
        return CMD_DONE;
    if (result == ARGS_BAD)
        return CMD_USAGE;
    if (operands != 2) {
        args_complain(&command, "two meshes are needed, there are %d",
                      operands);
        return CMD_USAGE;
    }
    side sides[2] = { { .path = argv[0] }, { .path = argv[1] } };
    const int code = compare(sides, &opt);
    asset_free(&sides[0].mesh);
    asset_free(&sides[1].mesh);
    return code;
}
