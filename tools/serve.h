/* SPDX-License-Identifier: MIT */
/*
 * serve.h - a web server for two files on this machine's loopback interface,
 * to look at a mesh while it arrives. Not for a network.
 */
#ifndef SERVE_H
#define SERVE_H

#include "tools/asset.h"

typedef struct serve_file {
    const char *path, *type; /* "/mesh.pmesh", "text/html" */
    const void *data;
    size_t size;
    const char *etag; /* with its quotes; NULL: none, and no ranges */
} serve_file;

/*
 * Serves the files until the process ends; `started` is told the port. port 0:
 * any that is free. rate: bits per second of each answer, 0: no limit. GET and
 * HEAD, single ranges "bytes=N-" and "bytes=N-M" with If-Range; connections are
 * closed behind each answer. Returns false if it cannot start.
 */
bool serve(const serve_file *files, size_t file_count, uint16_t port,
           uint64_t rate, void (*started)(uint16_t port), asset_error *error);

#endif
