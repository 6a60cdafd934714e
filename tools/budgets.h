/* SPDX-License-Identifier: MIT */
/* budgets.h - lists of face counts. */
#ifndef BUDGETS_H
#define BUDGETS_H

#include <stdbool.h>
#include <stdint.h>

#define BUDGETS_MAX 64

typedef struct budgets {
    uint32_t faces[BUDGETS_MAX];
    uint32_t count;
} budgets;

/* Reads "200,2k,1.5M"; false if the text is no such list. */
bool budgets_parse(const char *text, budgets *out);

/* Up to `count` >= 2 budgets from `base` to `full` in equal ratios; fewer if
 * some would be equal. */
void budgets_spread(uint32_t base, uint32_t full, uint32_t count, budgets *out);

#endif
