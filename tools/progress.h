/* SPDX-License-Identifier: MIT */
/*
 * progress.h - a progress bar on stderr, and the clock.
 */
#ifndef PROGRESS_H
#define PROGRESS_H

#include <stdbool.h>

typedef enum progress_mode {
    PROGRESS_AUTO, /* a bar if stderr is a terminal */
    PROGRESS_ON,   /* a bar, or lines if stderr is none */
    PROGRESS_OFF
} progress_mode;

typedef struct progress {
    bool bar, lines;
    char stage[32];
    int shown;       /* percent; -1: nothing of this stage yet */
    double next;     /* draw no earlier than this, seconds */
} progress;

void progress_begin(progress *p, progress_mode mode);

/* A pmesh_progress callback; `user` is the progress. Never cancels. */
int progress_update(void *user, const char *stage, double done);

/* Clears the bar for a line of text; the next update draws it again. */
void progress_pause(progress *p);

/* Clears the bar: call before any other output. */
void progress_end(progress *p);

/* Seconds since some point in the past; never runs backwards. */
double progress_clock(void);

#endif
