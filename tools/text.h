/* SPDX-License-Identifier: MIT */
/*
 * text.h - a cursor over text that has no terminator, for the mesh readers.
 *
 * Lines end with \n, \r\n or \r. Nothing here reads at or behind `end`.
 */
#ifndef TEXT_H
#define TEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "tools/asset.h"

typedef struct text_cursor {
    const char *p, *end;
    size_t line; /* the number of p's line, from 1 */
} text_cursor;

typedef struct text_word {
    const char *data;
    size_t size; /* 0: there was none on the line */
} text_word;

#define TEXT_BOM "\xEF\xBB\xBF"

static inline text_cursor text_open(const uint8_t *data, size_t size)
{
    const char *p = (const char *)data;
    if (size >= 3 && memcmp(p, TEXT_BOM, 3) == 0)
        return (text_cursor){ p + 3, p + size, 1 };
    return (text_cursor){ p, p + size, 1 };
}

static inline size_t text_left(const text_cursor *in)
{
    return (size_t)(in->end - in->p);
}

static inline bool text_is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

static inline bool text_is_eol(char c)
{
    return c == '\n' || c == '\r';
}

static inline bool text_at_eol(const text_cursor *in)
{
    return in->p == in->end || text_is_eol(*in->p);
}

/* Behind a number or word: a blank, a line end or the end. */
static inline bool text_at_gap(const text_cursor *in)
{
    return text_at_eol(in) || text_is_blank(*in->p);
}

static inline void text_skip_blanks(text_cursor *in)
{
    while (in->p < in->end && text_is_blank(*in->p))
        in->p++;
}

/* Takes the line end at p, if there is one. */
static inline void text_take_eol(text_cursor *in)
{
    if (in->p == in->end)
        return;
    if (*in->p == '\r' && text_left(in) > 1 && in->p[1] == '\n')
        in->p++;
    in->p++;
    in->line++;
}

static inline void text_skip_line(text_cursor *in)
{
    while (!text_at_eol(in))
        in->p++;
    text_take_eol(in);
}

/* Blanks and line ends. */
static inline void text_skip_space(text_cursor *in)
{
    for (;;) {
        text_skip_blanks(in);
        if (in->p == in->end || !text_is_eol(*in->p))
            return;
        text_take_eol(in);
    }
}

/* The next word of this line; p is left behind it. */
static inline text_word text_next_word(text_cursor *in)
{
    text_skip_blanks(in);
    const char *start = in->p;
    while (!text_at_gap(in))
        in->p++;
    return (text_word){ start, (size_t)(in->p - start) };
}

static inline bool text_equal(text_word word, const char *s)
{
    return word.size == strlen(s) && memcmp(word.data, s, word.size) == 0;
}

/* The same for any case of ASCII letters; `s` is in lower case. */
static inline bool text_equal_any_case(text_word word, const char *s)
{
    if (word.size != strlen(s))
        return false;
    for (size_t i = 0; i < word.size; i++) {
        char c = word.data[i];
        if (c >= 'A' && c <= 'Z')
            c = (char)(c - 'A' + 'a');
        if (c != s[i])
            return false;
    }
    return true;
}

/* A number with nothing but a gap behind it. */
static inline bool text_number(text_cursor *in, double *out)
{
    const char *start = in->p;
    in->p = asset_number_parse(in->p, in->end, out);
    return in->p != start && text_at_gap(in);
}

/* Digits and a gap; false as well above `max`. */
static inline bool text_count(text_cursor *in, uint64_t max, uint64_t *out)
{
    const char *start = in->p;
    uint64_t value = 0;
    for (; in->p < in->end && *in->p >= '0' && *in->p <= '9'; in->p++) {
        const uint64_t digit = (uint64_t)(*in->p - '0');
        if (digit > max || value > (max - digit) / 10)
            return false;
        value = value * 10 + digit;
    }
    *out = value;
    return in->p != start && text_at_gap(in);
}

static inline const char *text_where(const text_cursor *in, char where[48])
{
    snprintf(where, 48, "line %zu", in->line);
    return where;
}

/* The `where` of asset_fail for the cursor's line. */
#define TEXT_AT(in) text_where((in), (char[48]){ 0 })

#endif
