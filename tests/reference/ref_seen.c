/* SPDX-License-Identifier: MIT */
#include "tests/reference/ref_seen.h"

#include <inttypes.h>
#include <stdio.h>

uint64_t ref_seen[REF_ELEMENT_COUNT];

#define REF_ELEMENT_NAME(section, name) { section, #name },
static const struct {
    const char *section, *name;
} elements[] = { REF_ELEMENTS(REF_ELEMENT_NAME) };

int ref_seen_print(int all)
{
    int missing = 0;
    for (int i = 0; i < REF_ELEMENT_COUNT; i++) {
        if (all)
            printf("  %s %-22s %12" PRIu64 "\n", elements[i].section,
                   elements[i].name, ref_seen[i]);
        else if (ref_seen[i] == 0)
            printf("  not met: SPEC %s, %s\n", elements[i].section,
                   elements[i].name);
        missing += ref_seen[i] == 0;
    }
    printf("  elements of the format that were met: %d of %d\n",
           REF_ELEMENT_COUNT - missing, REF_ELEMENT_COUNT);
    return missing;
}
