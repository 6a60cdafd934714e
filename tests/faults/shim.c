/* SPDX-License-Identifier: MIT */
/*
 * shim.c - preloaded into the program, makes the n-th call of a kind fail, or
 * kills the process there. Environment:
 *
 *   FAULT        "memory": malloc, calloc, realloc; "disk": what writes files;
 *                "kill": the same calls, each with SIGKILL before it
 *   FAULT_AT     n, from 1 on; 0 or none: no call
 *   FAULT_ON     not empty: all calls behind it fail, too
 *   FAULT_COUNT  name of a file that gets the number of calls
 *
 * A write that fails has written half.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* glibc's own, which dlsym() may call malloc() to find. */
void *__libc_malloc(size_t);
void *__libc_calloc(size_t, size_t);
void *__libc_realloc(void *, size_t);

enum { UNKNOWN, NOTHING, MEMORY, DISK, KILL };

static int kind;
static long at, calls;
static int on;

static void look(void)
{
    const char *fault = getenv("FAULT"), *n = getenv("FAULT_AT");
    kind = !fault                     ? NOTHING
           : !strcmp(fault, "memory") ? MEMORY
           : !strcmp(fault, "disk")   ? DISK
           : !strcmp(fault, "kill")   ? KILL
                                      : NOTHING;
    at = n ? atol(n) : 0;
    on = getenv("FAULT_ON") && *getenv("FAULT_ON");
}

/* Threads wait for each other in no test: a race costs a count at most. */
static int hit(int memory)
{
    if (kind == UNKNOWN)
        look();
    if (kind == NOTHING || memory != (kind == MEMORY))
        return 0;
    calls++;
    const int now = at > 0 && (calls == at || (on && calls > at));
    if (now && kind == KILL)
        kill(getpid(), SIGKILL);
    return now;
}

static int fails(int reason)
{
    const int now = hit(0);
    if (now)
        errno = reason;
    return now;
}

__attribute__((destructor)) static void tell(void)
{
    const char *name = getenv("FAULT_COUNT");
    const long seen = calls;
    FILE *out = name ? fopen(name, "w") : NULL;
    if (out) {
        fprintf(out, "%ld\n", seen);
        fclose(out);
    }
}

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

/* POSIX asks for the reason, and glibc's own threads assert it. */
static int starves(void)
{
    const int now = hit(1);
    if (now)
        errno = ENOMEM;
    return now;
}

void *malloc(size_t size)
{
    return starves() ? NULL : __libc_malloc(size);
}

void *calloc(size_t count, size_t size)
{
    return starves() ? NULL : __libc_calloc(count, size);
}

void *realloc(void *old, size_t size)
{
    return starves() ? NULL : __libc_realloc(old, size);
}

int mkstemp(char *name)
{
    return fails(EROFS) ? -1 : REAL(mkstemp)(name);
}

ssize_t write(int fd, const void *data, size_t size)
{
    if (fd <= 2)
        return REAL(write)(fd, data, size);
    if (!fails(ENOSPC))
        return REAL(write)(fd, data, size);
    if (REAL(write)(fd, data, size / 2) < 0)
        return -1;
    errno = ENOSPC;
    return -1;
}

int fchmod(int fd, mode_t mode)
{
    return fails(EIO) ? -1 : REAL(fchmod)(fd, mode);
}

int fsync(int fd)
{
    return fails(EIO) ? -1 : REAL(fsync)(fd);
}

int close(int fd)
{
    const int bad = fails(EIO);
    const int result = REAL(close)(fd);
    if (bad)
        errno = EIO;
    return bad ? -1 : result;
}

int rename(const char *from, const char *to)
{
    return fails(EXDEV) ? -1 : REAL(rename)(from, to);
}
