/* SPDX-License-Identifier: MIT */
/*
 * file.h - whole files in, whole files out.
 *
 * Reading copes with pipes, short reads and signals. Writing is all or
 * nothing: whatever happens, the target holds its old content or the new one,
 * and no temporary file stays behind unless the process is killed outright.
 *
 * The path "-" is standard input or output. Failures fill *error (its `where`
 * stays empty); the caller reports it with the file's name.
 */
#ifndef FILE_H
#define FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tools/asset.h"

/* No mesh file above this is read. */
#define FILE_LIMIT ((uint64_t)8 << 30)

typedef struct file_data {
    uint8_t *bytes; /* NULL if size is 0 */
    size_t size;
    bool more;                /* file_read_prefix: the file goes on */
    bool identified;          /* device and inode are known */
    uint64_t device, inode;
} file_data;

/* Reads all of `path`; fails if it holds more than `limit` bytes. On failure
 * *out is empty. */
bool file_read(const char *path, uint64_t limit, file_data *out,
               asset_error *error);

/* Reads the first `size` bytes, or all if there are fewer. */
bool file_read_prefix(const char *path, uint64_t size, file_data *out,
                      asset_error *error);

void file_free(file_data *data);

/*
 * Whether file_write() has a chance: to be called before long work. Refuses a
 * folder, a missing folder, the file that `input` (NULL: none) was read from,
 * and binary data on a terminal.
 */
bool file_check_output(const char *path, bool binary, const file_data *input,
                       asset_error *error);

/*
 * Writes `size` bytes to `path`. A regular or new file: a temporary file in
 * the same folder, made for its owner only, gets the bytes, is flushed to the
 * disk, takes its final mode from the umask and is renamed. A device or pipe
 * is written in place. A symbolic link is followed.
 */
bool file_write(const char *path, const void *data, size_t size,
                asset_error *error);

/* Sets the signals of the process: SIGPIPE and SIGXFSZ are ignored, so that
 * writing fails with EPIPE and EFBIG; SIGINT, SIGTERM and SIGHUP remove the
 * temporary file, then end the process as they would have. */
void file_catch_signals(void);

/* The path, or "standard input" ("standard output") for "-". */
const char *file_input_name(const char *path);
const char *file_output_name(const char *path);

#endif
