/* SPDX-License-Identifier: MIT */
/*
 * cmd_verify.c - decodes whole files and says whether they are good.
 */
#include <inttypes.h>
#include <stddef.h>
#include <stdio.h>

#include "tools/args.h"
#include "tools/cmd.h"
#include "tools/file.h"
#include "tools/json.h"
#include "tools/report.h"
#include "tools/scene_file.h"
#include "tools/stream.h"

typedef struct options {
    bool json, quiet;
} options;

static const args_option option_table[] = {
    { .name = "json", .kind = ARGS_FLAG, .offset = offsetof(options, json),
      .help = "print one JSON object on stdout" },
    { .name = "quiet", .letter = 'q', .kind = ARGS_FLAG,
      .offset = offsetof(options, quiet),
      .help = "print nothing for good files" },
};

static const args_command command = {
    .name = "verify",
    .summary = "Decodes .pmesh files completely and checks every byte.",
    .synopsis = "FILE... [options]",
    .options = option_table,
    .option_count = sizeof option_table / sizeof *option_table,
    .details =
        "Exit code 0: every file is complete and undamaged. 4: one is cut off "
        "or\ndamaged; the message names the byte, the rule of the format that "
        "it breaks and\nthe last good level. 1: one cannot be read. \"-\" is "
        "standard input.\n\n"
        "  pmesh verify *.pmesh\n"
        "  pmesh verify --json bunny.pmesh\n",
};

/* What became of one file. */
typedef struct verdict {
    int code;
    asset_error error; /* unless CMD_DONE */
    uint64_t bytes, behind; /* its end, which are ignored */
    bool has_header;
    pmesh_header header;
    pmesh_progress_state progress;
    /* Of a scene; its levels and faces are put into `progress`. */
    bool is_scene;
    uint32_t meshes, level_count;
} verdict;

static void judge_scene(const file_data *data, verdict *v)
{
    scene_file s;

    v->is_scene = true;
    v->code = scene_file_open(data, &s, &v->error);
    v->meshes = s.header.mesh_count;
    v->level_count = s.header.level_count;
    v->progress.bytes = s.progress.bytes;
    v->progress.faces = s.progress.faces < UINT32_MAX
                            ? (uint32_t)s.progress.faces
                            : UINT32_MAX;
    while (v->progress.levels < v->level_count &&
           s.header.levels[v->progress.levels].bytes <= s.progress.bytes)
        v->progress.levels++;
    if (v->code == CMD_DONE && !s.progress.complete) {
        asset_fail(&v->error, "", "cut off after %zu bytes", data->size);
        v->code = CMD_STREAM;
    }
    scene_file_close(&s);
}

static void judge_mesh(const file_data *data, verdict *v)
{
    stream s;

    v->code = stream_open(data, &s, &v->error);
    v->has_header = s.has_header;
    v->header = s.header;
    v->progress = s.progress;
    v->level_count = s.header.level_count;
    if (v->code == CMD_DONE && !s.progress.complete) {
        char total[48] = "";
        if (s.has_header)
            snprintf(total, sizeof total, " of %" PRIu64, s.header.bytes);
        asset_fail(&v->error, "", "cut off after %zu%s bytes", data->size,
                   total);
        v->code = CMD_STREAM;
    }
    stream_close(&s);
}

static void judge(const char *path, verdict *v)
{
    file_data data;

    *v = (verdict){ .code = CMD_IO };
    if (!file_read(path, FILE_LIMIT, &data, &v->error))
        return;
    v->bytes = data.size;
    scene_file_unwrap(&data);
    if (scene_file_is(&data))
        judge_scene(&data, v);
    else
        judge_mesh(&data, v);
    if (v->code == CMD_DONE)
        v->behind = data.size - v->progress.bytes;
    file_free(&data);
}

static void print_verdict(const char *path, const verdict *v)
{
    const char *name = file_input_name(path);

    if (v->code == CMD_DONE) {
        report_put(stdout, name);
        printf(": good, %" PRIu64 " bytes, %" PRIu32 " levels, %" PRIu32
               " faces%s",
               v->bytes, v->progress.levels, v->progress.faces,
               v->header.exact_bytes > 0 ? ", exact positions" : "");
        if (v->is_scene)
            printf(", a scene of %" PRIu32 " meshes", v->meshes);
        if (v->behind > 0)
            printf(", and %" PRIu64 " bytes behind its end", v->behind);
        putchar('\n');
    } else if (v->progress.levels > 0) {
        report_error(name, v->error.where,
                     "%s; last good level %" PRIu32 " of 0..%" PRIu32
                     ", %" PRIu32 " faces",
                     v->error.what, v->progress.levels - 1,
                     v->level_count - 1, v->progress.faces);
    } else if (v->code == CMD_STREAM) {
        report_error(name, v->error.where, "%s; no level is good",
                     v->error.what);
    } else {
        report_asset_error(name, &v->error);
    }
}

static void json_verdict(json *j, const char *path, const verdict *v)
{
    json_open(j, NULL, '{');
    json_text(j, "file", path);
    json_bool(j, "good", v->code == CMD_DONE);
    json_count(j, "exit_code", (uint64_t)v->code);
    json_count(j, "bytes", v->bytes);
    if (v->has_header)
        json_count(j, "bytes_expected", v->header.bytes);
    json_count(j, "good_bytes", v->progress.bytes);
    json_count(j, "good_levels", v->progress.levels);
    json_count(j, "good_faces", v->progress.faces);
    if (v->is_scene)
        json_count(j, "meshes", v->meshes);
    if (v->has_header && v->header.exact_bytes > 0)
        json_count(j, "exact_vertices", v->progress.exact_vertices);
    if (v->code != CMD_DONE) {
        json_text(j, "where", v->error.where);
        json_text(j, "error", v->error.what);
    }
    json_close(j);
}

int cmd_verify(int argc, char **argv)
{
    options o = { 0 };
    int count;
    int result = CMD_DONE;
    json j;

    const args_result parsed = args_parse(&command, argc, argv, &o, &count);
    if (parsed != ARGS_RUN)
        return parsed == ARGS_HELP ? CMD_DONE : CMD_USAGE;
    if (count == 0) {
        args_complain(&command, "no file is named");
        return CMD_USAGE;
    }
    if (o.json) {
        json_begin(&j, stdout);
        json_text(&j, "schema", "pmesh-verify-1");
        json_text(&j, "tool", "pmesh");
        json_text(&j, "version", pmesh_version());
        json_open(&j, "files", '[');
    }
    for (int i = 0; i < count; i++) {
        verdict v;
        judge(argv[i], &v);
        if (o.json)
            json_verdict(&j, argv[i], &v);
        if (v.code != CMD_DONE || !(o.json || o.quiet))
            print_verdict(argv[i], &v);
        /* That a file could not be judged outranks a bad verdict. */
        if (v.code == CMD_IO || result == CMD_DONE)
            result = v.code;
    }
    if (o.json) {
        json_close(&j);
        json_bool(&j, "good", result == CMD_DONE);
        json_end(&j);
    }
    return result;
}
