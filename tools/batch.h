/* SPDX-License-Identifier: MIT */
/*
 * batch.h - many files, each worked on in a process of its own.
 *
 * A process for each file costs a millisecond and buys a lot: what one file
 * does to memory, or a crash in somebody's library, ends with it.
 */
#ifndef BATCH_H
#define BATCH_H

#include <stdbool.h>
#include <stddef.h>

#include "tools/asset.h"
#include "tools/file.h"

typedef struct batch_job {
    char *input;
    char *output;
    size_t stem; /* of output: its length without the last ending */
} batch_job;

/* Start with zeros. */
typedef struct batch_list {
    batch_job *jobs;
    size_t count, capacity;
} batch_list;

/*
 * Adds what `operand` stands for: a folder is searched for mesh files, those
 * below it included, hidden ones not; a file whose name ends like that of a
 * mesh is taken itself; any other ("-": standard input) lists paths, one a
 * line. Outputs lie below `folder`: at the path below the operand of a folder,
 * else at the path as it was given without its leading "/" and ".." parts.
 * False: *error says why.
 */
bool batch_add(batch_list *list, const char *operand, const char *folder,
               asset_error *error);

/*
 * Sorts the jobs by output and gives each its own: NAME.pmesh, or where two
 * would share that, NAME.ENDING.pmesh. False: two jobs are the same even so,
 * or memory is out.
 */
bool batch_name_outputs(batch_list *list, asset_error *error);

void batch_list_free(batch_list *list);

/* Makes the folder that `path` is to lie in, and those above. */
bool batch_make_folder(const char *path, asset_error *error);

/* Whether `output` is a file not older than `input`. Outputs appear whole or
 * not at all, so that such a file is finished. */
bool batch_is_fresh(const char *input, const char *output);

/* ---- processes ---------------------------------------------------------- */

typedef struct batch_result {
    int code;       /* exit code; if signal is not 0, meaningless */
    int signal;     /* that ended the process */
    double seconds; /* from its start on */
    asset_bytes out, err; /* what it wrote, each with a 0 behind it */
} batch_result;

typedef struct batch_work {
    size_t count;
    unsigned processes; /* at once, at least 1 */
    /* In a new process: does job `i`; returns an exit code. */
    int (*run)(void *user, size_t i);
    /* Whenever one has ended, in no fixed order; false ends the batch once the
     * running ones have ended. May take over the bytes of the result. */
    bool (*done)(void *user, size_t i, batch_result *result);
    void *user;
} batch_work;

/* False: a process could not be started; *error says why. */
bool batch_run(const batch_work *work, asset_error *error);

#endif
