/* SPDX-License-Identifier: MIT */
#include "tools/serve.h"

#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

enum {
    REQUEST_SIZE = 8192, /* the longest head of a request */
    PIECE = 16384,       /* written at a time */
    PATIENCE = 30        /* seconds a client may keep silent */
};

typedef struct site {
    const serve_file *files;
    size_t file_count;
    uint64_t rate;
} site;

typedef struct connection {
    const site *site;
    int socket;
    char request[REQUEST_SIZE + 1];
} connection;

/* The whole head of the request, as text; false if there is none. */
static bool read_request(connection *c)
{
    size_t size = 0;
    while (size < REQUEST_SIZE) {
        const ssize_t got =
            recv(c->socket, c->request + size, REQUEST_SIZE - size, 0);
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            return false;
        size += (size_t)got;
        c->request[size] = 0;
        if (strlen(c->request) < size)
            return false; /* no text */
        if (strstr(c->request, "\r\n\r\n"))
            return true;
    }
    return false;
}

/* Value of a header field, up to the line's end; "" if it is not there. */
static const char *field(const connection *c, const char *name)
{
    const size_t size = strlen(name);
    const char *line = strstr(c->request, "\r\n");
    for (; line; line = strstr(line, "\r\n")) {
        line += 2;
        if (strncasecmp(line, name, size) == 0 && line[size] == ':')
            return line + size + 1 + strspn(line + size + 1, " \t");
    }
    return "";
}

static bool starts(const char *text, const char *with)
{
    return strncmp(text, with, strlen(with)) == 0;
}

/* A page elsewhere could reach this server by a name of its own. */
static bool host_is_us(const connection *c)
{
    const char *host = field(c, "Host");
    return starts(host, "127.0.0.1") || starts(host, "localhost");
}

static bool write_all(int socket, const char *data, size_t size)
{
    while (size > 0) {
        const ssize_t done = send(socket, data, size, MSG_NOSIGNAL);
        if (done < 0 && errno == EINTR)
            continue;
        if (done <= 0)
            return false;
        data += done;
        size -= (size_t)done;
    }
    return true;
}

static void pause_for(uint64_t bytes, uint64_t rate)
{
    const uint64_t ns = bytes * 8 * 1000000000u / rate;
    struct timespec left = { (time_t)(ns / 1000000000u),
                             (long)(ns % 1000000000u) };
    while (nanosleep(&left, &left) < 0 && errno == EINTR)
        ;
}

/* At a rate, pieces are small: some 20 in a second. */
static void write_body(const connection *c, const char *data, size_t size)
{
    const uint64_t rate = c->site->rate;
    const uint64_t tick = rate / 8 / 20 + 1;
    const size_t piece = rate && tick < PIECE ? (size_t)tick : PIECE;
    while (size > 0) {
        const size_t part = size < piece ? size : piece;
        if (!write_all(c->socket, data, part))
            return;
        if (rate)
            pause_for(part, rate);
        data += part;
        size -= part;
    }
}

static void refuse(const connection *c, const char *status)
{
    char text[160];
    const int size = snprintf(text, sizeof text,
                              "HTTP/1.1 %s\r\nContent-Length: 0\r\n"
                              "Connection: close\r\n\r\n", status);
    write_all(c->socket, text, (size_t)size);
}

/* The range asked for, if it is one and its condition holds; else all. False
 * if it lies behind the end. */
static bool find_range(const connection *c, const serve_file *file,
                       size_t *first, size_t *end)
{
    const char *range = field(c, "Range"), *condition = field(c, "If-Range");
    char *stop;
    *first = 0;
    *end = file->size;
    if (!file->etag || !starts(range, "bytes=") || range[6] < '0' ||
        range[6] > '9' || (*condition && !starts(condition, file->etag)))
        return true;
    const unsigned long long a = strtoull(range + 6, &stop, 10);
    if (*stop != '-')
        return true;
    if (a >= file->size)
        return false;
    if (stop[1] >= '0' && stop[1] <= '9') {
        const unsigned long long b = strtoull(stop + 1, &stop, 10);
        if (b < a)
            return true;
        if (b < file->size - 1)
            *end = (size_t)b + 1;
    }
    *first = (size_t)a;
    return true;
}

static void answer(const connection *c, const serve_file *file, bool body)
{
    char head[512];
    size_t first, end;
    if (!find_range(c, file, &first, &end)) {
        refuse(c, "416 Range Not Satisfiable");
        return;
    }
    const bool part = first > 0 || end < file->size;
    int size = snprintf(head, sizeof head,
                        "HTTP/1.1 %s\r\nContent-Type: %s\r\n"
                        "Content-Length: %zu\r\nConnection: close\r\n"
                        "Cache-Control: no-store\r\n"
                        "X-Content-Type-Options: nosniff\r\n",
                        part ? "206 Partial Content" : "200 OK", file->type,
                        end - first);
    if (file->etag)
        size += snprintf(head + size, sizeof head - (size_t)size,
                         "Accept-Ranges: bytes\r\nETag: %s\r\n", file->etag);
    if (part)
        size += snprintf(head + size, sizeof head - (size_t)size,
                         "Content-Range: bytes %zu-%zu/%zu\r\n", first, end - 1,
                         file->size);
    size += snprintf(head + size, sizeof head - (size_t)size, "\r\n");
    if (write_all(c->socket, head, (size_t)size) && body)
        write_body(c, (const char *)file->data + first, end - first);
}

static void handle(connection *c)
{
    if (!read_request(c))
        return;
    const bool get = starts(c->request, "GET ");
    if (!get && !starts(c->request, "HEAD ")) {
        refuse(c, "405 Method Not Allowed");
        return;
    }
    if (!host_is_us(c)) {
        refuse(c, "403 Forbidden");
        return;
    }
    const char *path = strchr(c->request, ' ') + 1;
    const size_t size = strcspn(path, " ?\r\n");
    for (size_t i = 0; i < c->site->file_count; i++) {
        const serve_file *file = &c->site->files[i];
        if (strlen(file->path) == size && strncmp(file->path, path, size) == 0) {
            answer(c, file, get);
            return;
        }
    }
    refuse(c, "404 Not Found");
}

static void *run(void *argument)
{
    connection *c = argument;
    handle(c);
    shutdown(c->socket, SHUT_WR);
    close(c->socket);
    free(c);
    return NULL;
}

static void start_connection(const site *s, int socket)
{
    const struct timeval patience = { PATIENCE, 0 };
    pthread_t thread;
    connection *c = malloc(sizeof *c);
    if (c) {
        c->site = s;
        c->socket = socket;
        setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
        setsockopt(socket, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
        if (pthread_create(&thread, NULL, run, c) == 0) {
            pthread_detach(thread);
            return;
        }
    }
    free(c);
    close(socket);
}

/* A socket that listens on loopback, and its port. */
static int listen_on(uint16_t *port)
{
    struct sockaddr_in at = { .sin_family = AF_INET,
                              .sin_port = htons(*port),
                              .sin_addr.s_addr = htonl(INADDR_LOOPBACK) };
    socklen_t size = sizeof at;
    const int on = 1;
    const int fd = socket(AF_INET, SOCK_STREAM, 0);
    if (fd < 0)
        return -1;
    setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    if (bind(fd, (struct sockaddr *)&at, size) < 0 || listen(fd, 16) < 0 ||
        getsockname(fd, (struct sockaddr *)&at, &size) < 0) {
        close(fd);
        return -1;
    }
    *port = ntohs(at.sin_port);
    return fd;
}

bool serve(const serve_file *files, size_t file_count, uint16_t port,
           uint64_t rate, void (*started)(uint16_t port), asset_error *error)
{
    const site s = { files, file_count, rate };
    const int fd = listen_on(&port);
    if (fd < 0)
        return asset_fail(error, "", "cannot listen on port %u: %s",
                          (unsigned)port, strerror(errno));
    started(port);
    for (;;) {
        const int socket = accept(fd, NULL, NULL);
        if (socket >= 0)
            start_connection(&s, socket);
        else if (errno != EINTR && errno != ECONNABORTED)
            break;
    }
    close(fd);
    return asset_fail(error, "", "cannot accept connections: %s",
                      strerror(errno));
}
