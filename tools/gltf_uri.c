/* SPDX-License-Identifier: MIT */
/* gltf_uri.c - the bytes behind a buffer's URI: inline, or beside the asset. */
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tools/gltf.h"

#define MAX_PATH_BYTES 4096

static int hex(char c)
{
    if (c >= '0' && c <= '9')
        return c - '0';
    if (c >= 'a' && c <= 'f')
        return c - 'a' + 10;
    if (c >= 'A' && c <= 'F')
        return c - 'A' + 10;
    return -1;
}

static int sextet(char c)
{
    if (c >= 'A' && c <= 'Z')
        return c - 'A';
    if (c >= 'a' && c <= 'z')
        return c - 'a' + 26;
    if (c >= '0' && c <= '9')
        return c - '0' + 52;
    if (c == '+' || c == '/')
        return c == '+' ? 62 : 63;
    return -1;
}

static bool is_data_uri(const char *uri, size_t length)
{
    return length >= 5 && memcmp(uri, "data:", 5) == 0;
}

/* The base64 digits of a data URI, without padding. */
static bool find_digits(const char *uri, size_t length, const char **digits,
                        size_t *count, asset_error *error)
{
    static const char marker[] = ";base64";
    const char *comma = memchr(uri, ',', length);
    const size_t mark = sizeof marker - 1;

    if (!comma)
        return asset_fail(error, "", "a data URI has no comma");
    if ((size_t)(comma - uri) < mark || memcmp(comma - mark, marker, mark) != 0)
        return asset_fail(error, "", "a data URI is not base64");
    const char *end = uri + length;
    for (int i = 0; i < 2 && end > comma + 1 && end[-1] == '='; i++)
        end--;
    *digits = comma + 1;
    *count = (size_t)(end - *digits);
    for (size_t i = 0; i < *count; i++) {
        if (sextet((*digits)[i]) < 0)
            return asset_fail(error, "", "a data URI is not valid base64");
    }
    if (*count % 4 == 1)
        return asset_fail(error, "", "a data URI is not valid base64");
    return true;
}

/* Needs count * 6 >= size * 8; the digits are known to be valid. */
static void decode_digits(const char *digits, uint8_t *dst, uint64_t size)
{
    uint32_t acc = 0;
    unsigned bits = 0;

    for (uint64_t n = 0; n < size; digits++) {
        acc = (acc << 6 | (uint32_t)sextet(*digits)) & 0xFFFFu;
        bits += 6;
        if (bits >= 8) {
            bits -= 8;
            dst[n++] = (uint8_t)(acc >> bits);
        }
    }
}

static bool has_scheme(const char *uri, size_t length)
{
    for (size_t i = 0; i < length; i++) {
        if (uri[i] == ':')
            return true;
        if (uri[i] == '/')
            return false;
    }
    return false;
}

/* Decodes %XX; `path` holds `length` + 1 bytes. */
static bool decode_path(const char *uri, size_t length, char *path)
{
    size_t n = 0;

    for (size_t i = 0; i < length; i++) {
        unsigned char c = (unsigned char)uri[i];
        if (c == '%') {
            if (length - i < 3 || hex(uri[i + 1]) < 0 || hex(uri[i + 2]) < 0)
                return false;
            c = (unsigned char)(hex(uri[i + 1]) * 16 + hex(uri[i + 2]));
            i += 2;
        }
        if (c < 0x20 || c == 0x7F || c == '\\')
            return false;
        path[n++] = (char)c;
    }
    path[n] = '\0';
    return true;
}

static bool stays_below(const char *path)
{
    if (path[0] == '\0' || path[0] == '/')
        return false;
    for (const char *p = path; p;) {
        const char *slash = strchr(p, '/');
        const size_t n = slash ? (size_t)(slash - p) : strlen(p);
        if (n == 2 && p[0] == '.' && p[1] == '.')
            return false;
        p = slash ? slash + 1 : NULL;
    }
    return true;
}

bool gltf_uri_path(const char *uri, size_t length, char *path)
{
    return !has_scheme(uri, length) && decode_path(uri, length, path) &&
           stays_below(path);
}

/* The path of a side file, malloc'ed, or NULL. */
static char *side_path(const gltf_source *source, const char *uri,
                       size_t length, asset_error *error)
{
    if (length == 0 || length > MAX_PATH_BYTES) {
        asset_fail(error, "", "a buffer's URI is %s",
                   length == 0 ? "empty" : "too long");
        return NULL;
    }
    if (has_scheme(uri, length)) {
        asset_fail(error, "", "a buffer's URI has a scheme other than data: "
                   "(%.80s)", uri);
        return NULL;
    }
    if (!source->path) {
        asset_fail(error, "", "side file %.80s: there is no folder to look in",
                   uri);
        return NULL;
    }
    const char *slash = strrchr(source->path, '/');
    const size_t folder = slash ? (size_t)(slash - source->path) + 1 : 0;
    char *path = malloc(folder + length + 1);
    if (!path) {
        asset_fail(error, "", "out of memory");
        return NULL;
    }
    memcpy(path, source->path, folder);
    if (!decode_path(uri, length, path + folder) ||
        !stays_below(path + folder)) {
        asset_fail(error, "",
                   "side file %.80s is outside of the asset's folder", uri);
        free(path);
        return NULL;
    }
    return path;
}

static int open_side(const gltf_source *source, const char *uri, size_t length,
                     uint64_t *size, asset_error *error)
{
    struct stat info;
    char *path = side_path(source, uri, length, error);
    if (!path)
        return -1;

    /* Without O_NONBLOCK a FIFO of that name would stop us here. */
    const int file = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    free(path);
    if (file < 0) {
        asset_fail(error, "", "side file %.80s: %s", uri, strerror(errno));
        return -1;
    }
    if (fstat(file, &info) != 0 || !S_ISREG(info.st_mode)) {
        asset_fail(error, "", "side file %.80s is not a regular file", uri);
        close(file);
        return -1;
    }
    *size = (uint64_t)info.st_size;
    return file;
}

bool gltf_uri_size(const gltf_source *source, const char *uri, size_t length,
                   uint64_t *size, asset_error *error)
{
    if (is_data_uri(uri, length)) {
        const char *digits = NULL;
        size_t count = 0;
        if (!find_digits(uri, length, &digits, &count, error))
            return false;
        *size = (uint64_t)count / 4 * 3 + (uint64_t)count % 4 * 6 / 8;
        return true;
    }
    const int file = open_side(source, uri, length, size, error);
    if (file < 0)
        return false;
    close(file);
    return true;
}

bool gltf_uri_read(const gltf_source *source, const char *uri, size_t length,
                   uint8_t *dst, uint64_t size, asset_error *error)
{
    uint64_t available;
    if (!gltf_uri_size(source, uri, length, &available, error))
        return false;
    if (available < size)
        return asset_fail(error, "", "a buffer's data is cut off");
    if (is_data_uri(uri, length)) {
        decode_digits((const char *)memchr(uri, ',', length) + 1, dst, size);
        return true;
    }

    const int file = open_side(source, uri, length, &available, error);
    if (file < 0)
        return false;
    uint64_t done = 0;
    while (done < size) {
        const ssize_t n = read(file, dst + done, (size_t)(size - done));
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            break;
        done += (uint64_t)n;
    }
    close(file);
    if (done < size)
        return asset_fail(error, "", "side file %.80s cannot be read", uri);
    return true;
}
