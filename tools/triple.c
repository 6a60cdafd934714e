/* SPDX-License-Identifier: MIT */
#include "tools/triple.h"

#include <math.h>
#include <string.h>

#include "tools/asset.h"

bool triple_parse(const char *text, double out[3])
{
    const char *const end = text + strlen(text);

    for (int i = 0; i < 3; i++) {
        const char *rest = asset_number_parse(text, end, &out[i]);
        if (rest == text || !isfinite(out[i]) ||
            (i < 2 ? *rest != ',' : rest != end))
            return false;
        text = rest + (i < 2);
    }
    return true;
}
