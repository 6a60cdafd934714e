/* SPDX-License-Identifier: MIT */
/* Decimal text to double, to the last bit as strtod in the C locale; and bits of
 * doubles and floats to text and back. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/fuzz/fuzz.h"
#include "tools/asset.h"

static bool is_digit(const char *p, const char *end)
{
    return p < end && *p >= '0' && *p <= '9';
}

/* How many characters at the start are a decimal number: 0 if none. */
static size_t decimal_length(const char *start, const char *end)
{
    const char *p = start;
    size_t digits = 0;
    if (p < end && (*p == '+' || *p == '-'))
        p++;
    for (; is_digit(p, end); p++)
        digits++;
    if (p < end && *p == '.')
        for (p++; is_digit(p, end); p++)
            digits++;
    if (digits == 0)
        return 0;
    if (p < end && (*p == 'e' || *p == 'E')) {
        const char *q = p + 1;
        if (q < end && (*q == '+' || *q == '-'))
            q++;
        if (is_digit(q, end))
            for (p = q; is_digit(p, end);)
                p++;
    }
    return (size_t)(p - start);
}

static void check_text(const uint8_t *data, size_t size)
{
    char *text = fuzz_copy(data, size);
    double value = 0;
    const char *end = asset_number_parse(text, text + size, &value);
    const size_t used = (size_t)(end - text);
    const size_t decimal = decimal_length(text, text + size);

    if (decimal > 0 && used <= decimal) {
        char *copy = fuzz_room(used + 1), *stop;
        FUZZ_CHECK(used == decimal);
        memcpy(copy, text, used);
        copy[used] = '\0';
        const double expected = strtod(copy, &stop);
        FUZZ_CHECK(stop == copy + used);
        FUZZ_CHECK(memcmp(&value, &expected, sizeof value) == 0);
        free(copy);
    } else { /* nan, inf, and 1.#INF as Windows prints it */
        FUZZ_CHECK(used == 0 || !isfinite(value));
        FUZZ_CHECK(decimal == 0 || memchr(text, '#', used));
    }
    free(text);
}

static void check_value(double value, bool as_float)
{
    char text[33];
    double back = 0;
    if (!isfinite(value))
        return;
    const size_t size = as_float ? asset_number_print_float(text, (float)value)
                                 : asset_number_print(text, value);
    FUZZ_CHECK(size > 0 && size <= 32);
    FUZZ_CHECK(asset_number_parse(text, text + size, &back) == text + size);
    text[size] = '\0';
    FUZZ_CHECK(as_float ? (float)back == (float)value
                        : memcmp(&back, &value, sizeof value) == 0);
    FUZZ_CHECK(signbit(back) == signbit(value));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    check_text(data, size);
    if (size >= 8) {
        double value;
        float small;
        memcpy(&value, data, sizeof value);
        memcpy(&small, data, sizeof small);
        check_value(value, false);
        check_value((double)small, true);
    }
    return 0;
}
