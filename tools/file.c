/* SPDX-License-Identifier: MIT */
#include "tools/file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define FIRST_BLOCK ((size_t)64 << 10)
#define LARGEST_READ ((size_t)1 << 30) /* some systems stop at 2^31 */

const char *file_input_name(const char *path)
{
    return strcmp(path, "-") == 0 ? "standard input" : path;
}

const char *file_output_name(const char *path)
{
    return strcmp(path, "-") == 0 ? "standard output" : path;
}

void file_free(file_data *data)
{
    free(data->bytes);
    *data = (file_data){ 0 };
}

/* Reads until `size` bytes are there or the file ends; -1 and errno if not. */
static int read_fully(int fd, uint8_t *dst, size_t size, size_t *done)
{
    *done = 0;
    while (*done < size) {
        const size_t rest = size - *done;
        const ssize_t got = read(
            fd, dst + *done, rest < LARGEST_READ ? rest : LARGEST_READ);
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0)
            return -1;
        if (got == 0)
            return 0;
        *done += (size_t)got;
    }
    return 0;
}

/*
 * Reads at most limit + 1 bytes: the last one tells that there are more. The
 * size that the file system reports only sets the first block: it is 0 for
 * pipes and may be anything for special files.
 */
static bool read_descriptor(int fd, uint64_t limit, file_data *out,
                            asset_error *error)
{
    struct stat info;
    size_t capacity = FIRST_BLOCK;

    if (fstat(fd, &info) != 0)
        return asset_fail(error, "", "%s", strerror(errno));
    if (S_ISDIR(info.st_mode))
        return asset_fail(error, "", "%s", strerror(EISDIR));
    out->identified = S_ISREG(info.st_mode);
    out->device = (uint64_t)info.st_dev;
    out->inode = (uint64_t)info.st_ino;
    if (limit > SIZE_MAX / 2)
        limit = SIZE_MAX / 2;
    const size_t most = (size_t)limit + 1;
    if (out->identified && info.st_size > 0 &&
        (uint64_t)info.st_size < SIZE_MAX / 2)
        capacity = (size_t)info.st_size + 1; /* one more to meet the end */
    while (true) {
        if (capacity > most)
            capacity = most;
        uint8_t *grown = realloc(out->bytes, capacity);
        if (!grown)
            return asset_fail(error, "", "out of memory (%zu bytes)", capacity);
        out->bytes = grown;
        size_t got;
        if (read_fully(fd, grown + out->size, capacity - out->size, &got) != 0)
            return asset_fail(error, "", "%s", strerror(errno));
        out->size += got;
        if (out->size < capacity || out->size == most)
            return true;
        capacity *= 2;
    }
}

static bool read_path(const char *path, uint64_t limit, file_data *out,
                      asset_error *error)
{
    const bool standard = strcmp(path, "-") == 0;
    int fd = STDIN_FILENO;

    *out = (file_data){ 0 };
    if (!standard) {
        do
            fd = open(path, O_RDONLY | O_CLOEXEC | O_NOCTTY);
        while (fd < 0 && errno == EINTR);
        if (fd < 0)
            return asset_fail(error, "", "%s", strerror(errno));
    }
    const bool good = read_descriptor(fd, limit, out, error);
    if (!standard)
        close(fd);
    if (!good)
        file_free(out);
    return good;
}

bool file_read(const char *path, uint64_t limit, file_data *out,
               asset_error *error)
{
    if (!read_path(path, limit, out, error))
        return false;
    if (out->size > limit) {
        file_free(out);
        return asset_fail(error, "", "larger than %llu bytes",
                          (unsigned long long)limit);
    }
    return true;
}

bool file_read_prefix(const char *path, uint64_t size, file_data *out,
                      asset_error *error)
{
    if (!read_path(path, size, out, error))
        return false;
    out->more = out->size > size;
    if (out->more)
        out->size = (size_t)size;
    return true;
}
