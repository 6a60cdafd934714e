/* SPDX-License-Identifier: MIT */
#include "tools/json.h"

#include <assert.h>
#include <inttypes.h>
#include <math.h>

#include "tools/asset.h"
#include "tools/utf8.h"

static void put_quoted(json *j, const char *text)
{
    uint32_t code;
    size_t length;

    putc('"', j->out);
    for (; (length = utf8_next(text, &code)) > 0; text += length) {
        if (code == '"' || code == '\\')
            fprintf(j->out, "\\%c", (char)code);
        else if (code == UTF8_INVALID)
            fputs("\\ufffd", j->out);
        else if (code < 0x20 || (code >= 0x7F && code < 0xA0))
            fprintf(j->out, "\\u%04x", (unsigned)code);
        else
            fwrite(text, 1, length, j->out);
    }
    putc('"', j->out);
}

static void indent(json *j)
{
    putc('\n', j->out);
    for (unsigned i = 0; i < j->depth; i++)
        fputs("  ", j->out);
}

/* Everything that stands before a value: comma, line break, key. */
static void lead_in(json *j, const char *key)
{
    const unsigned level = j->depth - 1;

    if (j->used[level])
        putc(',', j->out);
    if (!j->flat[level])
        indent(j);
    else if (j->used[level])
        putc(' ', j->out);
    j->used[level] = true;
    if (key) {
        put_quoted(j, key);
        fputs(": ", j->out);
    }
}

static void enter(json *j, char bracket, bool flat)
{
    assert(j->depth < JSON_MAX_DEPTH); /* our nesting, never a file's */
    putc(bracket, j->out);
    j->used[j->depth] = false;
    j->flat[j->depth] = flat;
    j->closer[j->depth] = bracket == '{' ? '}' : ']';
    j->depth++;
}

void json_begin(json *j, FILE *out)
{
    *j = (json){ .out = out };
    enter(j, '{', false);
}

void json_end(json *j)
{
    json_close(j);
    putc('\n', j->out);
}

void json_open(json *j, const char *key, char bracket)
{
    lead_in(j, key);
    enter(j, bracket, j->flat[j->depth - 1]);
}

void json_open_flat(json *j, const char *key, char bracket)
{
    lead_in(j, key);
    enter(j, bracket, true);
}

void json_close(json *j)
{
    j->depth--;
    if (j->used[j->depth] && !j->flat[j->depth])
        indent(j);
    putc(j->closer[j->depth], j->out);
}

void json_text(json *j, const char *key, const char *value)
{
    lead_in(j, key);
    put_quoted(j, value);
}

void json_count(json *j, const char *key, uint64_t value)
{
    lead_in(j, key);
    fprintf(j->out, "%" PRIu64, value);
}

void json_number(json *j, const char *key, double value)
{
    char digits[33] = "null";

    lead_in(j, key);
    if (isfinite(value))
        digits[asset_number_print(digits, value)] = '\0';
    fputs(digits, j->out);
}

void json_float(json *j, const char *key, float value)
{
    char digits[33] = "null";

    lead_in(j, key);
    if (isfinite(value))
        digits[asset_number_print_float(digits, value)] = '\0';
    fputs(digits, j->out);
}

void json_raw(json *j, const char *key, const char *value)
{
    lead_in(j, key);
    fputs(value, j->out);
}

void json_bool(json *j, const char *key, bool value)
{
    lead_in(j, key);
    fputs(value ? "true" : "false", j->out);
}
