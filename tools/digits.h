/* SPDX-License-Identifier: MIT */
/* digits.h - numbers for people. */
#ifndef DIGITS_H
#define DIGITS_H

#include <stdint.h>

/* 69451 as "69,451"; `dst` holds 32 bytes. */
void digits_grouped(char *dst, uint64_t value);

/* 105231 as "105 kB": three digits, decimal units; `dst` holds 32 bytes. */
void digits_bytes(char *dst, uint64_t bytes);

#endif
