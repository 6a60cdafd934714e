/* SPDX-License-Identifier: MIT */
/*
 * report.h - messages on stderr, one line each:
 *
 *   pmesh: FILE:WHERE: what and why
 *   pmesh: FILE: warning: what
 *
 * File names and texts from files may hold anything: control characters and
 * bytes that are not UTF-8 are shown as '?'.
 */
#ifndef REPORT_H
#define REPORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "tools/asset.h"

#if defined(__GNUC__)
#define REPORT_FORMAT(form, first) __attribute__((format(printf, form, first)))
#else
#define REPORT_FORMAT(form, first)
#endif

/* `where` may be NULL or empty. */
void report_error(const char *file, const char *where, const char *form, ...)
    REPORT_FORMAT(3, 4);

void report_asset_error(const char *file, const asset_error *error);

void report_warning(const char *file, const char *form, ...)
    REPORT_FORMAT(2, 3);

/* Warnings kept until the work is done: lines of text. Start with zeros. */
typedef struct report_notes {
    char text[4096];
    size_t size;
    size_t count;
    size_t dropped; /* did not fit; part of count */
} report_notes;

void report_note(report_notes *notes, const char *form, ...)
    REPORT_FORMAT(2, 3);

/* Adds each line of `lines`. */
void report_note_lines(report_notes *notes, const char *lines);

/* Copies the note that begins at *at into `line` and moves on; false behind
 * the last one. Start with *at = 0. */
bool report_note_next(const report_notes *notes, size_t *at, char *line,
                      size_t capacity);

/* Prints every note as a warning, and how many did not fit. */
void report_notes_print(const report_notes *notes, const char *file);

/* Writes text for people with the same replacements. */
void report_put(FILE *out, const char *text);

#endif
