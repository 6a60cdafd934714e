/* SPDX-License-Identifier: MIT */
/* Any bytes as .drc. */
#include "tests/fuzz/import.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_import(data, size, ASSET_DRC);
    return 0;
}
