/* SPDX-License-Identifier: MIT */
/* string.h - what the decoder needs of a C library, for WebAssembly without
 * one: clang turns these calls into instructions (-mbulk-memory). */
#ifndef PMESH_WEB_STRING_H
#define PMESH_WEB_STRING_H

#include <stddef.h>

#define memcpy(to, from, size) __builtin_memcpy(to, from, size)
#define memmove(to, from, size) __builtin_memmove(to, from, size)
#define memset(to, value, size) __builtin_memset(to, value, size)
int memcmp(const void *a, const void *b, size_t size);

#endif
