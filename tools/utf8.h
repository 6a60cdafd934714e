/* SPDX-License-Identifier: MIT */
/*
 * utf8.h - reads text that may or may not be UTF-8.
 */
#ifndef UTF8_H
#define UTF8_H

#include <stddef.h>
#include <stdint.h>

#define UTF8_INVALID UINT32_MAX

/*
 * The first character of a terminated string. Returns its length in bytes and
 * sets *code; a byte that begins no valid sequence (overlong forms, surrogates
 * and values above U+10FFFF included) has length 1 and code UTF8_INVALID.
 * Returns 0 at the end.
 */
size_t utf8_next(const char *text, uint32_t *code);

#endif
