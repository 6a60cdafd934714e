/* SPDX-License-Identifier: MIT */
#include "tools/progress.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define BAR_WIDTH 30
#define SECONDS_BETWEEN_DRAWS 0.1
#define PERCENT_BETWEEN_LINES 25

double progress_clock(void)
{
    struct timespec now;
    if (clock_gettime(CLOCK_MONOTONIC, &now) != 0)
        return 0;
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void progress_begin(progress *p, progress_mode mode)
{
    const char *term = getenv("TERM");
    const bool terminal =
        isatty(STDERR_FILENO) && !(term && strcmp(term, "dumb") == 0);

    *p = (progress){ .shown = -1 };
    p->bar = mode != PROGRESS_OFF && terminal;
    p->lines = mode == PROGRESS_ON && !terminal;
}

static void draw_bar(const progress *p, int percent)
{
    char bar[BAR_WIDTH + 1];

    for (int i = 0; i < BAR_WIDTH; i++)
        bar[i] = i < percent * BAR_WIDTH / 100 ? '#' : '.';
    bar[BAR_WIDTH] = '\0';
    fprintf(stderr, "\r%-12s [%s] %3d %%", p->stage, bar, percent);
}

int progress_update(void *user, const char *stage, double done)
{
    progress *p = user;
    if (!p->bar && !p->lines)
        return 0;

    if (strncmp(p->stage, stage, sizeof p->stage - 1) != 0) {
        snprintf(p->stage, sizeof p->stage, "%s", stage);
        p->shown = -1;
    }
    const int percent = done >= 1 ? 100 : done > 0 ? (int)(100 * done) : 0;
    if (p->lines) {
        if (p->shown < 0 || percent >= p->shown + PERCENT_BETWEEN_LINES) {
            p->shown = percent - percent % PERCENT_BETWEEN_LINES;
            fprintf(stderr, "pmesh: %s %d %%\n", p->stage, p->shown);
        }
        return 0;
    }
    const double now = progress_clock();
    if (percent == p->shown || now < p->next)
        return 0;
    p->shown = percent;
    p->next = now + SECONDS_BETWEEN_DRAWS;
    draw_bar(p, percent);
    return 0;
}

void progress_pause(progress *p)
{
    if (p->bar)
        fputs("\r\033[K", stderr);
    p->shown = -1;
    p->next = 0;
}

void progress_end(progress *p)
{
    progress_pause(p);
    p->bar = p->lines = false;
}
