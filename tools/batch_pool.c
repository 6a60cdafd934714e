/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tools/batch.h"
#include "tools/progress.h"

/* A running process. What it writes goes to files without a name, which take
 * any amount without anybody reading meanwhile. */
typedef struct runner {
    pid_t pid; /* 0: free */
    size_t job;
    double began;
    FILE *out, *err;
} runner;

static void close_files(runner *r)
{
    if (r->out)
        fclose(r->out);
    if (r->err)
        fclose(r->err);
    r->out = r->err = NULL;
}

static void run_child(const batch_work *work, const runner *r)
{
    int code = 1;

    if (dup2(fileno(r->out), STDOUT_FILENO) >= 0 &&
        dup2(fileno(r->err), STDERR_FILENO) >= 0)
        code = work->run(work->user, r->job);
    if (fflush(stdout) != 0 && code == 0)
        code = 1;
    fflush(stderr);
    _exit(code); /* not exit(): buffers and handlers are the parent's */
}

static bool start(const batch_work *work, runner *r, size_t job,
                  asset_error *error)
{
    *r = (runner){ .job = job, .began = progress_clock(), .out = tmpfile(),
                   .err = tmpfile() };
    fflush(stdout);
    fflush(stderr);
    r->pid = r->out && r->err ? fork() : -1;
    if (r->pid == 0)
        run_child(work, r);
    if (r->pid > 0)
        return true;
    asset_fail(error, "", "cannot start a process: %s", strerror(errno));
    close_files(r);
    r->pid = 0;
    return false;
}

static void collect(FILE *file, asset_bytes *out)
{
    char block[4096];
    size_t got;

    rewind(file);
    while ((got = fread(block, 1, sizeof block, file)) > 0)
        asset_put(out, block, got);
    asset_put(out, "", 1);
}

static bool finish(const batch_work *work, runner *r, int status)
{
    batch_result result = {
        .code = WIFEXITED(status) ? WEXITSTATUS(status) : 0,
        .signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0,
        .seconds = progress_clock() - r->began,
    };

    collect(r->out, &result.out);
    collect(r->err, &result.err);
    close_files(r);
    r->pid = 0;
    const bool go_on = work->done(work->user, r->job, &result);
    asset_bytes_free(&result.out);
    asset_bytes_free(&result.err);
    return go_on;
}

static runner *runner_of(runner *runners, unsigned count, pid_t pid)
{
    for (unsigned i = 0; i < count; i++)
        if (runners[i].pid == pid)
            return &runners[i];
    return NULL;
}

bool batch_run(const batch_work *work, asset_error *error)
{
    runner *runners = calloc(work->processes, sizeof *runners);
    bool started = runners != NULL, go_on = started;
    unsigned running = 0;
    size_t next = 0;

    if (!runners)
        return asset_fail(error, "", "out of memory");
    while (true) {
        while (go_on && next < work->count && running < work->processes) {
            runner *idle = runner_of(runners, work->processes, 0);
            started = go_on = start(work, idle, next, error);
            running += started;
            next++;
        }
        if (running == 0)
            break;
        int status;
        const pid_t pid = waitpid(-1, &status, 0);
        if (pid < 0 && errno == EINTR)
            continue;
        runner *ended = runner_of(runners, work->processes, pid);
        if (ended) {
            running--;
            go_on &= finish(work, ended, status);
        }
    }
    free(runners);
    return started;
}
