/* SPDX-License-Identifier: MIT */
/*
 * cmd_batch.c - many meshes into .pmesh files.
 */
#include <errno.h>
#include <inttypes.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "tools/args.h"
#include "tools/batch.h"
#include "tools/cmd.h"
#include "tools/json.h"
#include "tools/progress.h"
#include "tools/report.h"
#include "tools/workers.h"

typedef struct options {
    const char *output, *report;
    uint32_t jobs;
    bool resume, json, quiet, progress;
} options;

#define AT(member) .offset = offsetof(options, member)

static const args_option option_table[] = {
    { .name = "output", .letter = 'o', .kind = ARGS_TEXT, .value = "FOLDER",
      AT(output), .help = "where the .pmesh files go; made if missing" },
    { .name = "jobs", .letter = 'j', .kind = ARGS_COUNT, .value = "N",
      .min = 1, .max = 256, AT(jobs),
      .help = "files at a time; default: the processors" },
    { .name = "resume", .kind = ARGS_FLAG, AT(resume),
      .help = "skip files whose output is there and not older" },
    { .name = "report", .kind = ARGS_TEXT, .value = "FILE", AT(report),
      .help = "append a line of JSON for each file" },
    { .name = "json", .kind = ARGS_FLAG, AT(json),
      .help = "summary as one JSON object on stdout" },
    { .name = "progress", .kind = ARGS_FLAG, AT(progress),
      .help = "show progress even if stderr is no terminal" },
    { .name = "quiet", .letter = 'q', .kind = ARGS_FLAG, AT(quiet),
      .help = "no summary and no progress; failures are still named" },
};

static const args_command command = {
    .name = "batch",
    .summary = "Bakes many meshes, each into a .pmesh file of its own.",
    .synopsis = "FOLDER|FILE|LIST... -o FOLDER [options] [-- bake options]",
    .options = option_table,
    .option_count = sizeof option_table / sizeof *option_table,
    .details =
        "A folder is searched for mesh files, a file that is no mesh lists "
        "paths, one a\nline (\"-\": standard input). a/b.obj becomes "
        "FOLDER/a/b.pmesh, b.obj.pmesh if\nthere is a b.ply beside it. A file "
        "that fails is named and does not stop the\nothers; the exit code is "
        "then that of the first in the list. Outputs appear whole\nor not at "
        "all: after an interruption, --resume goes on with the rest.\n\n"
        "  pmesh batch assets -o baked -j 4 --report baked.jsonl\n"
        "  find . -name '*.glb' | pmesh batch - -o out -- --profile quality\n",
};

typedef struct batch {
    const options *options;
    batch_list list;
    size_t *todo; /* jobs that are not skipped */
    size_t todo_count;
    int *codes;   /* by job */
    char **bake_arguments;
    int bake_argument_count;
    FILE *report;
    progress bar;
    size_t done, failed, fresh;
    uint64_t bytes_in, bytes_out;
} batch;

/* ---- one file ----------------------------------------------------------- */

/* In a process of its own, and so in one thread unless the user wants more:
 * bake -j1 [what the user gave] -q --json -o OUT -- IN */
static int run_job(void *user, size_t k)
{
    const batch *b = user;
    const batch_job *job = &b->list.jobs[b->todo[k]];
    char name[] = "bake", quiet[] = "--quiet", as_json[] = "--json";
    char output[] = "--output", end[] = "--", thread[] = "-j1";
    char **argv =
        calloc((size_t)b->bake_argument_count + 9, sizeof *argv);
    asset_error error;
    int argc = 0;

    if (!argv) {
        report_error(job->input, NULL, "out of memory");
        return CMD_IO;
    }
    if (!batch_make_folder(job->output, &error)) {
        report_asset_error(job->output, &error);
        return CMD_IO;
    }
    argv[argc++] = name;
    argv[argc++] = thread;
    for (int a = 0; a < b->bake_argument_count; a++)
        argv[argc++] = b->bake_arguments[a];
    argv[argc++] = quiet;
    argv[argc++] = as_json;
    argv[argc++] = output;
    argv[argc++] = job->output;
    argv[argc++] = end;
    argv[argc++] = job->input;
    return cmd_bake(argc, argv);
}

/* JSON without line breaks and indentation, in place: a text holds no raw line
 * break, so these are all between values. */
static void squeeze(char *text)
{
    char *to = text;

    while (*text) {
        if (*text == '\n')
            text += 1 + strspn(text + 1, " ");
        else
            *to++ = *text++;
    }
    *to = '\0';
}

static const char *text_of(const asset_bytes *bytes)
{
    return bytes->failed ? "" : (const char *)bytes->data;
}

/* Appends a line; `result` is NULL for a job that is skipped. */
static bool report_job(batch *b, size_t i, const batch_result *result)
{
    const batch_job *job = &b->list.jobs[i];
    char *line = NULL;
    size_t size;
    json j;

    FILE *out = b->report ? open_memstream(&line, &size) : NULL;
    if (!out)
        return !b->report;
    json_begin(&j, out);
    json_text(&j, "schema", "pmesh-batch-1");
    json_text(&j, "input", job->input);
    json_text(&j, "output", job->output);
    json_text(&j, "status", !result                   ? "skipped"
                            : b->codes[i] == CMD_DONE ? "done"
                                                      : "failed");
    if (result) {
        json_count(&j, "exit", (uint64_t)result->code);
        json_count(&j, "signal", (uint64_t)result->signal);
        json_number(&j, "seconds", result->seconds);
        if (b->codes[i] != CMD_DONE)
            json_text(&j, "message", text_of(&result->err));
        else
            json_raw(&j, "bake", text_of(&result->out));
    }
    json_end(&j);
    bool written = fclose(out) == 0;
    if (written)
        squeeze(line);
    written = written && fprintf(b->report, "%s\n", line) > 0 &&
              fflush(b->report) == 0; /* a line at a time, even if killed */
    free(line);
    if (!written)
        report_error(b->options->report, NULL, "cannot write: %s",
                     strerror(errno));
    return written;
}

static void tell_failure(batch *b, size_t i, const batch_result *result)
{
    const char *message = text_of(&result->err);

    progress_pause(&b->bar);
    if (result->signal != 0)
        report_error(b->list.jobs[i].input, NULL,
                     "the process ended by signal %d", result->signal);
    else if (*message)
        fputs(message, stderr); /* of report_error(): clean already */
    else
        report_error(b->list.jobs[i].input, NULL, "failed with exit code %d",
                     result->code);
}

static uint64_t size_of(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0 && info.st_size > 0 ? (uint64_t)info.st_size
                                                      : 0;
}

static bool end_job(void *user, size_t k, batch_result *result)
{
    batch *b = user;
    const size_t i = b->todo[k];
    const batch_job *job = &b->list.jobs[i];

    b->codes[i] = result->signal != 0 ? CMD_IO : result->code;
    if (b->codes[i] == CMD_DONE) {
        b->done++;
        b->bytes_in += size_of(job->input);
        b->bytes_out += size_of(job->output);
    } else {
        b->failed++;
        tell_failure(b, i, result);
    }
    progress_update(&b->bar, "baking",
                    (double)(b->done + b->failed) / (double)b->todo_count);
    /* Options that are wrong for one file are so for all. */
    return report_job(b, i, result) && b->codes[i] != CMD_USAGE;
}

/* ---- all of them -------------------------------------------------------- */

static void tell(const batch *b, double seconds)
{
    json j;

    if (b->options->json) {
        json_begin(&j, stdout);
        json_text(&j, "schema", "pmesh-batch-summary-1");
        json_count(&j, "files", b->list.count);
        json_count(&j, "done", b->done);
        json_count(&j, "skipped", b->fresh);
        json_count(&j, "failed", b->failed);
        json_count(&j, "input_bytes", b->bytes_in);
        json_count(&j, "bytes", b->bytes_out);
        json_number(&j, "seconds", seconds);
        json_end(&j);
    } else if (!b->options->quiet) {
        printf("%zu of %zu files baked, %zu skipped, %zu failed\n"
               "%" PRIu64 " -> %" PRIu64 " bytes in %.1f s\n",
               b->done, b->list.count, b->fresh, b->failed, b->bytes_in,
               b->bytes_out, seconds);
    }
}

static int run(batch *b)
{
    const options *o = b->options;
    const double start = progress_clock();
    const batch_work work = {
        .count = b->todo_count,
        .processes = o->jobs ? o->jobs : workers_available(),
        .run = run_job, .done = end_job, .user = b,
    };
    asset_error error;

    progress_begin(&b->bar, o->quiet      ? PROGRESS_OFF
                            : o->progress ? PROGRESS_ON
                                          : PROGRESS_AUTO);
    const bool ran = batch_run(&work, &error);
    progress_end(&b->bar);
    if (!ran)
        report_asset_error("batch", &error);
    tell(b, progress_clock() - start);
    for (size_t i = 0; i < b->list.count; i++)
        if (b->codes[i] > 0)
            return b->codes[i];
    return ran && b->done == b->todo_count ? CMD_DONE : CMD_IO;
}

/* Jobs whose output is there are done with, the others are to do. */
static bool choose(batch *b)
{
    for (size_t i = 0; i < b->list.count; i++) {
        const batch_job *job = &b->list.jobs[i];
        if (!b->options->resume ||
            !batch_is_fresh(job->input, job->output)) {
            b->todo[b->todo_count++] = i;
            continue;
        }
        b->fresh++;
        if (!report_job(b, i, NULL))
            return false;
    }
    return true;
}

static int prepare(batch *b, char **operands, int count)
{
    const options *o = b->options;
    asset_error error;

    for (int i = 0; i < count; i++)
        if (!batch_add(&b->list, operands[i], o->output, &error)) {
            report_asset_error(file_input_name(operands[i]), &error);
            return CMD_IO;
        }
    if (!batch_name_outputs(&b->list, &error)) {
        report_asset_error("batch", &error);
        return CMD_USAGE;
    }
    b->todo = calloc(b->list.count + 1, sizeof *b->todo);
    b->codes = calloc(b->list.count + 1, sizeof *b->codes);
    if (!b->todo || !b->codes) {
        report_error("batch", NULL, "out of memory");
        return CMD_IO;
    }
    if (o->report && !(b->report = fopen(o->report, "a"))) {
        report_error(o->report, NULL, "cannot write: %s", strerror(errno));
        return CMD_IO;
    }
    return choose(b) ? CMD_DONE : CMD_IO;
}

/* What stands behind "--" is bake's. Cuts it off *argc. */
static void split(int *argc, char **argv, batch *b)
{
    for (int i = 1; i < *argc; i++) {
        if (strcmp(argv[i], "--") != 0)
            continue;
        b->bake_arguments = argv + i + 1;
        b->bake_argument_count = *argc - i - 1;
        *argc = i;
    }
}

int cmd_batch(int argc, char **argv)
{
    options o = { 0 };
    batch b = { .options = &o };
    int count;

    split(&argc, argv, &b);
    const args_result parsed = args_parse(&command, argc, argv, &o, &count);
    if (parsed != ARGS_RUN)
        return parsed == ARGS_HELP ? CMD_DONE : CMD_USAGE;
    if (count == 0 || !o.output) {
        args_complain(&command, "%s", count == 0
                                          ? "nothing to bake is named"
                                          : "no folder is named (-o FOLDER)");
        return CMD_USAGE;
    }
    int code = prepare(&b, argv, count);
    if (code == CMD_DONE)
        code = run(&b);
    if (b.report && fclose(b.report) != 0 && code == CMD_DONE) {
        report_error(o.report, NULL, "cannot write: %s", strerror(errno));
        code = CMD_IO;
    }
    free(b.todo);
    free(b.codes);
    batch_list_free(&b.list);
    return code;
}
