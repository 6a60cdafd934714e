/* SPDX-License-Identifier: MIT */
#include "tools/digits.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

void digits_grouped(char *dst, uint64_t value)
{
    char plain[24];
    const size_t size =
        (size_t)snprintf(plain, sizeof plain, "%" PRIu64, value);

    for (size_t i = 0; i < size; i++) {
        if (i > 0 && (size - i) % 3 == 0)
            *dst++ = ',';
        *dst++ = plain[i];
    }
    *dst = '\0';
}

void digits_bytes(char *dst, uint64_t bytes)
{
    static const char *const units[] = { "kB", "MB", "GB", "TB", "PB", "EB" };
    double value = (double)bytes;
    size_t unit = 0;

    if (bytes < 1000) {
        snprintf(dst, 32, "%" PRIu64 " B", bytes);
        return;
    }
    /* What would print as 1000 takes the next unit. */
    for (value /= 1000; value >= 999.5 && unit < 5; unit++)
        value /= 1000;
    snprintf(dst, 32, "%.*f %s", value < 9.995 ? 2 : value < 99.95 ? 1 : 0,
             value, units[unit]);
}
