/* SPDX-License-Identifier: MIT */
/* workers.h - things to do that do not depend on each other, in threads. */
#ifndef WORKERS_H
#define WORKERS_H

#include <stddef.h>

/* What the system has; at least 1. */
unsigned workers_available(void);

/*
 * Calls work(user, i) for i in 0 .. count - 1, in this order but up to
 * `threads` at a time, the calling one among them. Returns when all are done.
 * If no more threads are to be had, there are fewer.
 */
void workers_run(unsigned threads, size_t count,
                 void (*work)(void *user, size_t i), void *user);

#endif
