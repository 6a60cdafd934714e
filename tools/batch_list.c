/* SPDX-License-Identifier: MIT */
#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "tools/batch.h"

#define MAX_DEPTH 64 /* of folders: ends loops that links make */

static bool out_of_memory(asset_error *error)
{
    return asset_fail(error, "", "out of memory");
}

/* "a/b", allocated; `a` or `b` alone if the other is empty. */
static char *join(const char *a, const char *b)
{
    const size_t size = strlen(a) + strlen(b) + 2;
    char *path = malloc(size);

    if (path)
        snprintf(path, size, "%s%s%s", a,
                 *a && *b && a[strlen(a) - 1] != '/' ? "/" : "", b);
    return path;
}

/* Length of a path without the ending of its last part. */
static size_t stem_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    const char *name = slash ? slash + 1 : path;
    const char *dot = strrchr(name, '.');

    return dot && dot > name ? (size_t)(dot - path) : strlen(path);
}

/* Takes `input` over; `below` is where its output belongs below `folder`. */
static bool add_job(batch_list *list, char *input, const char *folder,
                    const char *below, asset_error *error)
{
    char *output = join(folder, below);

    if (list->count == list->capacity) {
        const size_t capacity = list->capacity ? 2 * list->capacity : 64;
        batch_job *jobs = realloc(list->jobs, capacity * sizeof *jobs);
        if (jobs) {
            list->jobs = jobs;
            list->capacity = capacity;
        }
    }
    if (!input || !output || list->count == list->capacity) {
        free(input);
        free(output);
        return out_of_memory(error);
    }
    list->jobs[list->count++] = (batch_job){ .input = input, .output = output,
                                             .stem = stem_of(output) };
    return true;
}

/* Leaves out what would lead out of a folder: "/a/../b/./c" is "a/b/c". */
static char *keep_inside(const char *path)
{
    char *kept = malloc(strlen(path) + 1);
    size_t size = 0;

    while (kept && *path) {
        const size_t part = strcspn(path, "/");
        const bool plain = part > 0 && !(part == 1 && path[0] == '.') &&
                           !(part == 2 && path[0] == '.' && path[1] == '.');
        if (plain) {
            if (size > 0)
                kept[size++] = '/';
            memcpy(kept + size, path, part);
            size += part;
        }
        path += part;
        path += *path == '/';
    }
    if (kept)
        kept[size] = '\0';
    return kept;
}

static bool add_file(batch_list *list, const char *path, const char *folder,
                     asset_error *error)
{
    char *below = keep_inside(path);
    const bool added =
        below ? add_job(list, strdup(path), folder, below, error)
              : out_of_memory(error);

    free(below);
    return added;
}

static bool is_mesh(const char *path)
{
    return asset_format_of(path) != ASSET_UNKNOWN;
}

static bool add_folder(batch_list *list, const char *root, const char *below,
                       const char *folder, unsigned depth, asset_error *error);

static bool add_entry(batch_list *list, const char *root, char *below,
                      const char *folder, unsigned depth, asset_error *error)
{
    char *path = join(root, below);
    struct stat info;
    bool added = true;

    if (!path)
        return out_of_memory(error);
    if (stat(path, &info) == 0) { /* a link to nothing is passed over */
        if (S_ISDIR(info.st_mode))
            added = add_folder(list, root, below, folder, depth + 1, error);
        else if (S_ISREG(info.st_mode) && is_mesh(below))
            added = add_job(list, strdup(path), folder, below, error);
    }
    free(path);
    return added;
}

static bool add_folder(batch_list *list, const char *root, const char *below,
                       const char *folder, unsigned depth, asset_error *error)
{
    char *path = join(root, below);
    DIR *dir = path ? opendir(path) : NULL;
    bool added = true;

    if (!dir)
        added = asset_fail(error, below, "cannot read the folder: %s",
                           strerror(errno));
    else if (depth > MAX_DEPTH)
        added = asset_fail(error, below, "more than %d folders deep",
                           MAX_DEPTH);
    for (const struct dirent *entry;
         added && (entry = readdir(dir)) != NULL;) {
        char *name = entry->d_name[0] == '.' ? NULL
                                             : join(below, entry->d_name);
        if (entry->d_name[0] != '.')
            added = name ? add_entry(list, root, name, folder, depth, error)
                         : out_of_memory(error);
        free(name);
    }
    if (dir)
        closedir(dir);
    free(path);
    return added;
}

static bool add_lines(batch_list *list, const char *path, const char *folder,
                      asset_error *error)
{
    file_data data;
    bool added = true;

    if (!file_read(path, FILE_LIMIT, &data, error))
        return false;
    for (size_t at = 0; added && at < data.size;) {
        const char *line = (const char *)data.bytes + at;
        const char *end = memchr(line, '\n', data.size - at);
        size_t size = end ? (size_t)(end - line) : data.size - at;
        at += size + 1;
        if (size > 0 && line[size - 1] == '\r')
            size--;
        if (size == 0)
            continue;
        if (memchr(line, '\0', size)) {
            added = asset_fail(error, "", "is neither a mesh nor a list of "
                                          "paths");
            continue;
        }
        char *name = strndup(line, size);
        added = name ? add_file(list, name, folder, error)
                     : out_of_memory(error);
        free(name);
    }
    file_free(&data);
    return added;
}

bool batch_add(batch_list *list, const char *operand, const char *folder,
               asset_error *error)
{
    struct stat info;
    const bool standard = strcmp(operand, "-") == 0;

    if (!standard && stat(operand, &info) == 0 && S_ISDIR(info.st_mode))
        return add_folder(list, operand, "", folder, 0, error);
    if (!standard && is_mesh(operand))
        return add_file(list, operand, folder, error);
    return add_lines(list, operand, folder, error);
}

/* ---- outputs ------------------------------------------------------------ */

/* By output without its ending, then with it, then by input: a total order of
 * different jobs, whatever the order of the folder's entries. */
static int by_output(const void *a, const void *b)
{
    const batch_job *x = a, *y = b;
    const size_t shorter = x->stem < y->stem ? x->stem : y->stem;
    int order = memcmp(x->output, y->output, shorter);

    if (order == 0 && x->stem != y->stem)
        return x->stem < y->stem ? -1 : 1;
    if (order == 0)
        order = strcmp(x->output, y->output);
    return order != 0 ? order : strcmp(x->input, y->input);
}

static bool same_stem(const batch_job *a, const batch_job *b)
{
    return a->stem == b->stem && memcmp(a->output, b->output, a->stem) == 0;
}

/* The first `size` bytes of the job's output, and ".pmesh". */
static bool rename_output(batch_job *job, size_t size)
{
    char *output = malloc(size + sizeof ".pmesh");

    if (!output)
        return false;
    snprintf(output, size + sizeof ".pmesh", "%.*s.pmesh", (int)size,
             job->output);
    free(job->output);
    job->output = output;
    job->stem = size;
    return true;
}

bool batch_name_outputs(batch_list *list, asset_error *error)
{
    bool shared = false; /* by the job before */

    if (list->count > 0)
        qsort(list->jobs, list->count, sizeof *list->jobs, by_output);
    for (size_t i = 0; i < list->count; i++) {
        batch_job *job = &list->jobs[i];
        const bool shares = i + 1 < list->count && same_stem(job, job + 1);
        if (!rename_output(job, shares || shared ? strlen(job->output)
                                                 : job->stem))
            return out_of_memory(error);
        shared = shares;
    }
    if (list->count > 0)
        qsort(list->jobs, list->count, sizeof *list->jobs, by_output);
    for (size_t i = 1; i < list->count; i++) {
        const batch_job *job = &list->jobs[i];
        if (strcmp(job->output, job[-1].output) == 0)
            return asset_fail(error, "", "%s and %s would both become %s",
                              job[-1].input, job->input, job->output);
    }
    return true;
}

void batch_list_free(batch_list *list)
{
    for (size_t i = 0; i < list->count; i++) {
        free(list->jobs[i].input);
        free(list->jobs[i].output);
    }
    free(list->jobs);
    *list = (batch_list){ 0 };
}

bool batch_make_folder(const char *path, asset_error *error)
{
    char *copy = strdup(path);
    bool made = copy != NULL;

    if (!copy)
        return out_of_memory(error);
    for (char *p = copy + 1; made && *p; p++) {
        if (*p != '/')
            continue;
        *p = '\0';
        if (mkdir(copy, 0777) != 0 && errno != EEXIST)
            made = asset_fail(error, "", "cannot make the folder %s: %s", copy,
                              strerror(errno));
        *p = '/';
    }
    free(copy);
    return made;
}

static bool older(const struct timespec *a, const struct timespec *b)
{
    return a->tv_sec != b->tv_sec ? a->tv_sec < b->tv_sec
                                  : a->tv_nsec < b->tv_nsec;
}

bool batch_is_fresh(const char *input, const char *output)
{
    struct stat from, to;

    return stat(input, &from) == 0 && stat(output, &to) == 0 &&
           S_ISREG(to.st_mode) && to.st_size > 0 &&
           !older(&to.st_mtim, &from.st_mtim);
}
