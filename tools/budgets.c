/* SPDX-License-Identifier: MIT */
#include "tools/budgets.h"

#include <string.h>

#include "tools/asset.h"

bool budgets_parse(const char *text, budgets *out)
{
    const char *end = text + strlen(text);

    out->count = 0;
    while (out->count < BUDGETS_MAX) {
        double value;
        const char *rest = asset_number_parse(text, end, &value);
        if (rest == text)
            return false;
        if (*rest == 'k' || *rest == 'M')
            value *= *rest++ == 'M' ? 1e6 : 1e3;
        if (!(value >= 1 && value < UINT32_MAX))
            return false;
        out->faces[out->count++] = (uint32_t)(value + 0.5);
        if (*rest == '\0')
            return true;
        if (*rest != ',')
            return false;
        text = rest + 1;
    }
    return false;
}

/* x with x^n = value >= 1, by bisection: pow() differs between machines. */
static double root(double value, uint32_t n)
{
    double low = 1, high = value;
    for (int i = 0; i < 100; i++) {
        const double middle = (low + high) / 2;
        double power = 1;
        for (uint32_t k = 0; k < n; k++)
            power *= middle;
        if (power < value)
            low = middle;
        else
            high = middle;
    }
    return high;
}

void budgets_spread(uint32_t base, uint32_t full, uint32_t count, budgets *out)
{
    double at = base > 0 ? base : 1;
    const double ratio = full > at ? root(full / at, count - 1) : 1;

    out->count = 0;
    for (uint32_t i = 0; i < count; i++, at *= ratio) {
        const uint32_t faces = i + 1 < count ? (uint32_t)(at + 0.5) : full;
        if (out->count == 0 || faces > out->faces[out->count - 1])
            out->faces[out->count++] = faces;
    }
}
