/* SPDX-License-Identifier: MIT */
#define _XOPEN_SOURCE 700 /* realpath */
#include "tools/file.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define LARGEST_WRITE ((size_t)1 << 30) /* some systems stop at 2^31 */

/* ---- the temporary file and signals ------------------------------------- */

/* What a signal has to remove. The name is set and freed only while the
 * signals are blocked. */
static char *pending;

static const int fatal_signals[] = { SIGINT, SIGTERM, SIGHUP };
#define FATAL_SIGNAL_COUNT (sizeof fatal_signals / sizeof *fatal_signals)

static void remove_pending(int number)
{
    if (pending)
        unlink(pending);
    /* The handler was reset on entry: this ends the process on return. */
    raise(number);
}

void file_catch_signals(void)
{
    struct sigaction ignore = { .sa_handler = SIG_IGN };
    struct sigaction fatal = { .sa_handler = remove_pending,
                               .sa_flags = (int)SA_RESETHAND };

    sigemptyset(&ignore.sa_mask);
    sigaction(SIGPIPE, &ignore, NULL);
    sigaction(SIGXFSZ, &ignore, NULL);
    sigemptyset(&fatal.sa_mask);
    for (size_t i = 0; i < FATAL_SIGNAL_COUNT; i++)
        sigaddset(&fatal.sa_mask, fatal_signals[i]);
    for (size_t i = 0; i < FATAL_SIGNAL_COUNT; i++) {
        struct sigaction old;
        /* What the parent ignores (nohup) stays ignored. */
        if (sigaction(fatal_signals[i], NULL, &old) == 0 &&
            old.sa_handler != SIG_IGN)
            sigaction(fatal_signals[i], &fatal, NULL);
    }
}

static void block_signals(sigset_t *old)
{
    sigset_t set;
    sigemptyset(&set);
    for (size_t i = 0; i < FATAL_SIGNAL_COUNT; i++)
        sigaddset(&set, fatal_signals[i]);
    sigprocmask(SIG_BLOCK, &set, old);
}

/* Makes the file that `name` (a template of mkstemp, taken over) stands for,
 * readable by its owner only. Returns -1 and errno on failure. */
static int begin_temporary(char *name)
{
    sigset_t old;
    block_signals(&old);
    const int fd = mkstemp(name);
    const int reason = errno;
    if (fd >= 0)
        pending = name;
    else
        free(name);
    sigprocmask(SIG_SETMASK, &old, NULL);
    errno = reason;
    return fd;
}

/* Renames the temporary file to `target`, or removes it if `target` is NULL.
 * Keeps errno of a failure. */
static bool end_temporary(const char *target)
{
    sigset_t old;
    block_signals(&old);
    const bool renamed = target && rename(pending, target) == 0;
    const int reason = errno;
    if (!renamed)
        unlink(pending);
    free(pending);
    pending = NULL;
    sigprocmask(SIG_SETMASK, &old, NULL);
    errno = reason;
    return renamed;
}

/* ---- writing ------------------------------------------------------------ */

static bool write_fully(int fd, const uint8_t *data, size_t size)
{
    while (size > 0) {
        const ssize_t put =
            write(fd, data, size < LARGEST_WRITE ? size : LARGEST_WRITE);
        if (put < 0 && errno == EINTR)
            continue;
        if (put < 0)
            return false;
        data += put;
        size -= (size_t)put;
    }
    return true;
}

/* Some file systems cannot: that is no failure of ours. */
static bool flush_to_disk(int fd)
{
    return fsync(fd) == 0 || errno == EINVAL || errno == ENOTSUP ||
           errno == EROFS;
}

/* The folder of `path` with its slash, "./" if there is none, and room for
 * `extra` more bytes. NULL: out of memory. */
static char *folder_of(const char *path, size_t extra)
{
    const char *slash = strrchr(path, '/');
    const size_t size = slash ? (size_t)(slash - path) + 1 : 2;
    char *folder = malloc(size + extra + 1);

    if (folder) {
        memcpy(folder, slash ? path : "./", size);
        folder[size] = '\0';
    }
    return folder;
}

static bool flush_folder(const char *folder)
{
    const int fd = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (fd < 0)
        return errno == EACCES; /* may be written but not read */
    const bool good = flush_to_disk(fd);
    const int reason = errno;
    close(fd);
    errno = reason;
    return good;
}

static mode_t final_mode(void)
{
    const mode_t mask = umask(0);
    umask(mask);
    return 0666 & ~mask;
}

static bool fill_temporary(int fd, const void *data, size_t size)
{
    const bool good = write_fully(fd, data, size) &&
                      fchmod(fd, final_mode()) == 0 && flush_to_disk(fd);
    const int reason = errno;
    const bool closed = close(fd) == 0;
    if (!good)
        errno = reason;
    return good && closed;
}

/* All memory is taken before the rename: behind it, only the disk can fail. */
static bool replace_in(const char *folder, const char *path, const void *data,
                       size_t size)
{
    static const char template[] = ".pmesh-XXXXXX";
    char *name = folder_of(path, sizeof template);
    if (!name)
        return false;
    strcat(name, template);
    const int fd = begin_temporary(name);
    if (fd < 0)
        return false;
    if (!fill_temporary(fd, data, size)) {
        end_temporary(NULL);
        return false;
    }
    return end_temporary(path) && flush_folder(folder);
}

static bool replace_file(const char *path, const void *data, size_t size)
{
    char *folder = folder_of(path, 0);
    const bool good = folder && replace_in(folder, path, data, size);
    const int reason = errno;
    free(folder);
    errno = reason;
    return good;
}

static bool write_in_place(const char *path, const void *data, size_t size)
{
    int fd;
    do
        fd = open(path, O_WRONLY | O_CLOEXEC | O_NOCTTY);
    while (fd < 0 && errno == EINTR);
    if (fd < 0)
        return false;
    const bool good = write_fully(fd, data, size);
    const int reason = errno;
    const bool closed = close(fd) == 0;
    if (!good)
        errno = reason;
    return good && closed;
}

/* The path behind symbolic links, or a copy if the file does not exist. */
static char *resolve(const char *path)
{
    char *real = realpath(path, NULL);
    if (!real && errno == ENOENT)
        real = strdup(path);
    return real;
}

bool file_write(const char *path, const void *data, size_t size,
                asset_error *error)
{
    struct stat info;
    bool good;

    errno = 0;
    if (strcmp(path, "-") == 0) {
        good = write_fully(STDOUT_FILENO, data, size);
    } else if (stat(path, &info) == 0 && !S_ISREG(info.st_mode)) {
        good = write_in_place(path, data, size); /* a folder: EISDIR */
    } else {
        char *real = resolve(path);
        good = real && replace_file(real, data, size);
        const int reason = errno;
        free(real);
        errno = reason;
    }
    if (!good)
        return asset_fail(error, "", "cannot write: %s", strerror(errno));
    return true;
}

static bool check_folder(const char *path, asset_error *error)
{
    struct stat info;
    char *folder = folder_of(path, 0);
    if (!folder)
        return asset_fail(error, "", "%s", strerror(ENOMEM));
    int reason = stat(folder, &info) != 0 ? errno : 0;
    if (reason == 0 && !S_ISDIR(info.st_mode))
        reason = ENOTDIR;
    free(folder);
    if (reason != 0)
        return asset_fail(error, "", "cannot write: %s", strerror(reason));
    return true;
}

bool file_check_output(const char *path, bool binary, const file_data *input,
                       asset_error *error)
{
    struct stat info;
    const bool standard = strcmp(path, "-") == 0;
    const bool exists = standard ? fstat(STDOUT_FILENO, &info) == 0
                                 : stat(path, &info) == 0;

    if (standard && binary && isatty(STDOUT_FILENO))
        return asset_fail(error, "", "binary data is not for a terminal");
    if (!exists)
        return standard || check_folder(path, error);
    if (S_ISDIR(info.st_mode))
        return asset_fail(error, "", "cannot write: %s", strerror(EISDIR));
    if (input && input->identified && S_ISREG(info.st_mode) &&
        input->device == (uint64_t)info.st_dev &&
        input->inode == (uint64_t)info.st_ino)
        return asset_fail(error, "", "is the input file itself");
    return true;
}
