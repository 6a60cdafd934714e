/* SPDX-License-Identifier: MIT */
#include "tools/report.h"

#include <stdarg.h>
#include <string.h>

#include "tools/utf8.h"

/* One line goes out by one write, so that lines of several processes do not
 * mix. A longer one is cut. */
#define LINE_SIZE 6144

typedef struct line {
    char text[LINE_SIZE];
    size_t size;
} line;

static bool is_control(uint32_t code)
{
    return code < 0x20 || (code >= 0x7F && code < 0xA0) || code == 0x2028 ||
           code == 0x2029 || code == UTF8_INVALID;
}

/* Appends `text` with every control character replaced; the last byte of the
 * line stays free for the line break. */
static void put_clean(line *out, const char *text)
{
    uint32_t code;
    size_t length;

    for (; (length = utf8_next(text, &code)) > 0; text += length) {
        if (out->size + length >= LINE_SIZE - 1)
            return;
        if (is_control(code)) {
            out->text[out->size++] = '?';
        } else {
            memcpy(out->text + out->size, text, length);
            out->size += length;
        }
    }
}

static void put_format(line *out, const char *form, va_list args)
{
    char text[2048];
    vsnprintf(text, sizeof text, form, args);
    put_clean(out, text);
}

static void finish(line *out, FILE *file)
{
    out->text[out->size++] = '\n';
    /* Nothing can be done about a failing stderr. */
    (void)fwrite(out->text, 1, out->size, file);
}

static void put_file(line *out, const char *file)
{
    put_clean(out, "pmesh: ");
    if (file && *file) {
        put_clean(out, file);
        put_clean(out, ":");
    }
}

void report_error(const char *file, const char *where, const char *form, ...)
{
    line out = { .size = 0 };
    va_list args;

    put_file(&out, file);
    if (where && *where) {
        put_clean(&out, where);
        put_clean(&out, ":");
    }
    if ((file && *file) || (where && *where))
        put_clean(&out, " ");
    va_start(args, form);
    put_format(&out, form, args);
    va_end(args);
    finish(&out, stderr);
}

void report_asset_error(const char *file, const asset_error *error)
{
    report_error(file, error->where, "%s", error->what);
}

void report_warning(const char *file, const char *form, ...)
{
    line out = { .size = 0 };
    va_list args;

    put_file(&out, file);
    put_clean(&out, " warning: ");
    va_start(args, form);
    put_format(&out, form, args);
    va_end(args);
    finish(&out, stderr);
}

static void add_note(report_notes *notes, const char *text, size_t size)
{
    if (size == 0)
        return;
    notes->count++;
    if (size + 1 > sizeof notes->text - notes->size) {
        notes->dropped++;
        return;
    }
    memcpy(notes->text + notes->size, text, size);
    notes->size += size;
    notes->text[notes->size++] = '\n';
}

void report_note(report_notes *notes, const char *form, ...)
{
    char text[512];
    va_list args;

    va_start(args, form);
    vsnprintf(text, sizeof text, form, args);
    va_end(args);
    for (char *p = text; *p; p++)
        if (*p == '\n')
            *p = ' ';
    add_note(notes, text, strlen(text));
}

void report_note_lines(report_notes *notes, const char *lines)
{
    while (*lines) {
        const size_t size = strcspn(lines, "\n");
        add_note(notes, lines, size);
        lines += size + (lines[size] == '\n');
    }
}

bool report_note_next(const report_notes *notes, size_t *at, char *out,
                      size_t capacity)
{
    if (*at >= notes->size)
        return false;
    /* Every note in the text ends with a line break. */
    const char *begin = notes->text + *at;
    const char *end = memchr(begin, '\n', notes->size - *at);
    const size_t size = (size_t)(end - begin);
    const size_t copied = size < capacity ? size : capacity - 1;

    memcpy(out, begin, copied);
    out[copied] = '\0';
    *at += size + 1;
    return true;
}

void report_notes_print(const report_notes *notes, const char *file)
{
    char text[1024];
    size_t at = 0;

    while (report_note_next(notes, &at, text, sizeof text))
        report_warning(file, "%s", text);
    if (notes->dropped > 0)
        report_warning(file, "%zu further warnings", notes->dropped);
}

void report_put(FILE *out, const char *text)
{
    uint32_t code;
    size_t length;

    for (; (length = utf8_next(text, &code)) > 0; text += length) {
        if (is_control(code))
            putc('?', out);
        else
            fwrite(text, 1, length, out);
    }
}
