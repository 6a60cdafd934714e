/* SPDX-License-Identifier: MIT */
/*
 * triple.h - three numbers on a command line: 3,0,25.
 */
#ifndef TRIPLE_H
#define TRIPLE_H

#include <stdbool.h>

/* False unless the text is three finite numbers and nothing else. */
bool triple_parse(const char *text, double out[3]);

#endif
