/* SPDX-License-Identifier: MIT */
#include "format/ordinal.h"

#include <string.h>

enum { LARGEST_EXPONENT = 128 }; /* floats are below 2^128 */

typedef enum rounding { DOWN, NEAREST, UP } rounding;

/*
 * Ordinals by decade k. Decade 0 are the multiples of the finest unit below
 * `full` of them; each decade behind it has a unit `radix` times as large and
 * counts from full / radix to full.
 *
 *     |0 1 2 ........ full|first ...... full|first ...... full| ...
 *     |     decade 0      |    decade 1     |    decade 2     |  last
 */
typedef struct scheme {
    int64_t full, first;
    int last; /* decade */
} scheme;

bool pmesh_form_legal(const pmesh_form *f)
{
    return f->digits >= 1 &&
           (f->binary ? f->digits <= PMESH_BINARY_DIGITS &&
                            f->decimals <= PMESH_BINARY_DECIMALS
                      : f->digits <= PMESH_DECIMAL_DIGITS &&
                            f->decimals <= PMESH_DECIMAL_DECIMALS);
}

static const double ten_to[PMESH_DECIMAL_DECIMALS + 1] = {
    1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
    1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22
};

static scheme scheme_of(const pmesh_form *f)
{
    if (f->binary) {
        const int64_t full = (int64_t)1 << f->digits;
        return (scheme){ full, full / 2,
                         f->decimals + LARGEST_EXPONENT - f->digits };
    }
    const int64_t full = (int64_t)ten_to[f->digits];
    return (scheme){ full, full / 10, f->decimals + PMESH_DECIMAL_DECIMALS };
}

/* x 2^n for -149 <= n <= 149, exact where nothing under- or overflows. */
static double times_two_to(double x, int n)
{
    const uint64_t bits = (uint64_t)(1023 + n) << 52;
    double power;
    memcpy(&power, &bits, sizeof power);
    return x * power;
}

/* x radix^n, rounded once. */
static double scaled(const pmesh_form *f, double x, int n)
{
    if (f->binary)
        return times_two_to(x, n);
    return n >= 0 ? x * ten_to[n] : x / ten_to[-n];
}

/* The ordinal next to x >= 0; of NaN that of the largest number. */
static int64_t ordinal_of_size(const pmesh_form *f, double x, rounding way)
{
    const scheme s = scheme_of(f);
    const int64_t most = s.full + s.last * (s.full - s.first) - 1;
    int k = 0;
    while (k <= s.last && !(scaled(f, x, f->decimals - k) < (double)s.full))
        k++;
    if (k > s.last)
        return most;
    const double t = scaled(f, x, f->decimals - k) + (way == NEAREST ? 0.5 : 0);
    int64_t m = (int64_t)t; /* at most `full`: 30 bits */
    m += way == UP && (double)m < t;
    m += k * (s.full - s.first);
    return m < most ? m : most;
}

static float value_of_size(const pmesh_form *f, int64_t ordinal)
{
    const scheme s = scheme_of(f);
    int64_t m = ordinal, k = 0;
    if (ordinal >= s.full) {
        k = 1 + (ordinal - s.full) / (s.full - s.first);
        m = s.first + (ordinal - s.full) % (s.full - s.first);
    }
    return (float)scaled(f, (double)m, (int)k - f->decimals);
}

int64_t pmesh_ordinal_from(const pmesh_form *f, double x)
{
    return x > 0 ? ordinal_of_size(f, x, UP)
                 : -1 - ordinal_of_size(f, -x, DOWN);
}

int64_t pmesh_ordinal_to(const pmesh_form *f, double x)
{
    return x < 0 ? -1 - ordinal_of_size(f, -x, UP)
                 : ordinal_of_size(f, x, DOWN);
}

float pmesh_ordinal_value(const pmesh_form *f, int64_t ordinal)
{
    return ordinal < 0 ? -value_of_size(f, -1 - ordinal)
                       : value_of_size(f, ordinal);
}

bool pmesh_float_same(float a, float b)
{
    return memcmp(&a, &b, sizeof a) == 0;
}

bool pmesh_ordinal_of(const pmesh_form *f, float x, int64_t *out)
{
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    const bool negative = bits >> 31;
    const int64_t size =
        ordinal_of_size(f, negative ? -(double)x : (double)x, NEAREST);
    *out = negative ? -1 - size : size;
    return pmesh_float_same(pmesh_ordinal_value(f, *out), x);
}
