/* SPDX-License-Identifier: MIT */
/*
 * compare.h - one file, two decoders: this directory's and the library's.
 */
#ifndef COMPARE_H
#define COMPARE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct comparison {
    const char *difference; /* NULL: they agree */
    uint32_t faces;         /* where, if in a view */
    bool accepted;          /* by the reference: complete */
    bool readable;          /* accepted, or complete as far as it goes */
    bool too_large;         /* for the library; nothing was compared */
    bool other_reason;      /* both reject it, as different kinds of files */
    const char *rule, *library_rule; /* why; "" if there is no reason */
    uint64_t views;         /* that were compared */
} comparison;

/* Decodes and looks at some numbers of faces that `seed` chooses. */
comparison compare_decoders(const uint8_t *data, size_t size, uint32_t seed);

#endif
