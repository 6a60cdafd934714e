/* SPDX-License-Identifier: MIT */
/*
 * number.c - decimal text to double and back, exact and without locale.
 *
 * Reading has three gears, each exact where it is used:
 *   1. digits and power of ten are both doubles: one rounded operation;
 *   2. up to 19 digits and 10^-27 .. 10^27: a 128-bit product or quotient;
 *   3. anything else: long division of big integers.
 * Printing takes 17 digits of the value and of the ends of its rounding
 * interval in 128 bits, then drops digits while the interval allows it.
 */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "tools/asset.h"

#define MAX_POWER 27 /* 5^27 is the last power of five below 2^64 */

typedef struct wide {
    uint64_t hi, lo;
} wide;

static wide wide_product(uint64_t a, uint64_t b)
{
    const uint64_t al = (uint32_t)a, ah = a >> 32;
    const uint64_t bl = (uint32_t)b, bh = b >> 32;
    const uint64_t low = al * bl;
    const uint64_t mid = ah * bl + (low >> 32);
    const uint64_t cross = al * bh + (uint32_t)mid;
    return (wide){ ah * bh + (mid >> 32) + (cross >> 32),
                   cross << 32 | (uint32_t)low };
}

static int leading_zeros(uint64_t x)
{
    int n = 0;
    for (int step = 32; step; step /= 2) {
        if (x >> (64 - step) == 0) {
            x <<= step;
            n += step;
        }
    }
    return n;
}

static uint64_t power_of_five(int n)
{
    uint64_t x = 1;
    for (; n > 0; n--)
        x *= 5;
    return x;
}

static double from_bits(uint64_t bits)
{
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* q * 2^exponent, rounded to even; q has its top bit set, and `sticky` tells
 * that the true value is a little larger. */
static double round_to_double(uint64_t q, bool sticky, int exponent)
{
    const int top = exponent + 63; /* the value is in [2^top, 2^(top + 1)) */
    if (top > 1023)
        return (double)INFINITY;
    const int keep = top >= -1022 ? 53 : 53 - (-1022 - top);
    if (keep < 0)
        return 0;
    const int drop = 64 - keep;
    uint64_t kept = drop == 64 ? 0 : q >> drop;
    const uint64_t half = (uint64_t)1 << (drop - 1);
    const uint64_t rest = drop == 64 ? q : q & (half * 2 - 1);
    if (rest > half || (rest == half && (sticky || (kept & 1))))
        kept++;
    /* A carry out of the mantissa raises the exponent, as it should. */
    if (keep == 53)
        kept += (uint64_t)(top + 1022) << 52;
    return from_bits(kept);
}

/* One 32-bit digit of a long division; *rest < d, and d's top bit is set. */
static uint64_t divide_digit(uint64_t *rest, uint32_t next, uint64_t d)
{
    const uint64_t high = d >> 32, low = (uint32_t)d;
    uint64_t q = *rest / high, r = *rest % high;
    while (q >> 32 || q * low > (r << 32 | next)) {
        q--;
        r += high;
        if (r >> 32)
            break;
    }
    *rest = (*rest << 32 | next) - q * d;
    return q;
}

/* digits * 10^exponent for digits > 0, -MAX_POWER <= exponent <= MAX_POWER. */
static double scale_exactly(uint64_t digits, int exponent)
{
    if (exponent >= 0) {
        wide p = wide_product(digits, power_of_five(exponent));
        int shift = 64 + exponent;
        if (!p.hi) {
            p = (wide){ p.lo, 0 };
            shift -= 64;
        }
        const int zeros = leading_zeros(p.hi);
        if (zeros)
            p = (wide){ p.hi << zeros | p.lo >> (64 - zeros), p.lo << zeros };
        return round_to_double(p.hi, p.lo != 0, shift - zeros);
    }
    uint64_t d = power_of_five(-exponent);
    const int digit_zeros = leading_zeros(digits), d_zeros = leading_zeros(d);
    digits <<= digit_zeros;
    d <<= d_zeros;
    /* digits * 2^63 / d lies in [2^62, 2^64). */
    uint64_t rest = digits >> 1;
    uint64_t q = divide_digit(&rest, (uint32_t)(digits << 31 & 0x80000000u), d);
    q = q << 32 | divide_digit(&rest, 0, d);
    const int zeros = leading_zeros(q);
    return round_to_double(q << zeros, rest != 0,
                           d_zeros - digit_zeros - 63 + exponent - zeros);
}

/* ---- big integers -------------------------------------------------------- */

/* The longest is 10^1126 (3741 bits), shifted left by at most one. */
#define BIG_WORDS 128
/* 768 digits decide any rounding; what follows only says "a little more". */
#define BIG_DIGITS 780

typedef struct big {
    uint32_t words[BIG_WORDS]; /* lowest first */
    int count;                 /* without leading zeros */
} big;

static void big_multiply_add(big *a, uint32_t factor, uint32_t add)
{
    uint64_t carry = add;
    for (int i = 0; i < a->count; i++) {
        carry += (uint64_t)a->words[i] * factor;
        a->words[i] = (uint32_t)carry;
        carry >>= 32;
    }
    if (carry)
        a->words[a->count++] = (uint32_t)carry;
}

static void big_times_ten_to(big *a, int power)
{
    for (; power >= 9; power -= 9)
        big_multiply_add(a, 1000000000u, 0);
    for (; power > 0; power--)
        big_multiply_add(a, 10, 0);
}

static int big_bits(const big *a)
{
    return a->count * 32 - (leading_zeros(a->words[a->count - 1]) - 32);
}

static void big_shift_left(big *a, int bits)
{
    const int words = bits / 32;
    bits %= 32;
    if (words) {
        memmove(a->words + words, a->words,
                (size_t)a->count * sizeof a->words[0]);
        memset(a->words, 0, (size_t)words * sizeof a->words[0]);
        a->count += words;
    }
    big_multiply_add(a, (uint32_t)1 << bits, 0);
}

/* If a >= b, takes b from a and returns true. */
static bool big_subtract_if(big *a, const big *b)
{
    if (a->count < b->count)
        return false;
    if (a->count == b->count) {
        int i = a->count - 1;
        while (i >= 0 && a->words[i] == b->words[i])
            i--;
        if (i >= 0 && a->words[i] < b->words[i])
            return false;
    }
    uint64_t borrow = 0;
    for (int i = 0; i < a->count; i++) {
        const uint64_t take = borrow + (i < b->count ? b->words[i] : 0);
        borrow = a->words[i] < take;
        a->words[i] = (uint32_t)(a->words[i] - take);
    }
    while (a->count && !a->words[a->count - 1])
        a->count--;
    return true;
}

/* a / b, both > 0. */
static double big_quotient(big *a, big *b)
{
    const int shift = big_bits(a) - big_bits(b);
    big_shift_left(shift > 0 ? b : a, shift > 0 ? shift : -shift);
    /* Now a / b lies in (1/2, 2): the first or second bit of 64 is set. */
    uint64_t q = 0;
    for (int i = 0; i < 64; i++) {
        if (i)
            big_multiply_add(a, 2, 0);
        q = q << 1 | big_subtract_if(a, b);
    }
    const int zeros = leading_zeros(q);
    return round_to_double(q << zeros, a->count != 0, shift - 63 - zeros);
}

/* ---- reading ------------------------------------------------------------- */

typedef struct decimal {
    const char *first, *last; /* the digits and their point */
    int64_t power;            /* as written behind the e */
    uint64_t digits;          /* the first 19 significant ones */
    int64_t exponent;         /* of `digits` */
    bool cut;                 /* the digits behind those are not all 0 */
} decimal;

static bool is_digit(const char *p, const char *end)
{
    return p < end && *p >= '0' && *p <= '9';
}

static bool is_letter(char c)
{
    return (c | 0x20) >= 'a' && (c | 0x20) <= 'z';
}

static const char *scan_exponent(const char *p, const char *end, int64_t *out)
{
    const char *start = p;
    if (p == end || (*p != 'e' && *p != 'E'))
        return start;
    p++;
    const bool negative = p < end && *p == '-';
    if (p < end && (*p == '-' || *p == '+'))
        p++;
    if (!is_digit(p, end))
        return start;
    int64_t value = 0;
    for (; is_digit(p, end); p++)
        if (value < INT64_MAX / 100) /* far above any count of digits */
            value = value * 10 + (*p - '0');
    *out = negative ? -value : value;
    return p;
}

static const char *scan_decimal(const char *p, const char *end, decimal *d)
{
    const uint64_t full = 1000000000000000000u; /* no room for another digit */
    const char *start = p;
    *d = (decimal){ .first = p };
    for (; is_digit(p, end); p++) {
        if (d->digits < full) {
            d->digits = d->digits * 10 + (uint64_t)(*p - '0');
        } else {
            d->exponent++;
            d->cut |= *p != '0';
        }
    }
    bool any = p != start;
    if (p < end && *p == '.' && (any || is_digit(p + 1, end))) {
        for (p++; is_digit(p, end); p++) {
            if (d->digits < full) {
                d->digits = d->digits * 10 + (uint64_t)(*p - '0');
                d->exponent--;
            } else {
                d->cut |= *p != '0';
            }
        }
        any = true;
    }
    if (!any)
        return start;
    d->last = p;
    p = scan_exponent(p, end, &d->power);
    d->exponent += d->power;
    return p;
}

static double decimal_slowly(const decimal *d)
{
    big a = { .count = 0 }, b = { .words = { 1 }, .count = 1 };
    int64_t exponent = d->power;
    int count = 0;
    bool fraction = false, rest = false;
    for (const char *p = d->first; p < d->last; p++) {
        if (*p == '.') {
            fraction = true;
            continue;
        }
        if (count < BIG_DIGITS) {
            big_multiply_add(&a, 10, (uint32_t)(*p - '0'));
            count += a.count != 0;
            exponent -= fraction;
        } else {
            rest |= *p != '0';
            exponent += !fraction;
        }
    }
    if (rest) {
        big_multiply_add(&a, 10, 1);
        exponent--;
    }
    big_times_ten_to(exponent > 0 ? &a : &b,
                     (int)(exponent > 0 ? exponent : -exponent));
    return big_quotient(&a, &b);
}

static double decimal_to_double(const decimal *d)
{
    static const double powers[] = {
        1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
        1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
        1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22
    };
    const int64_t e = d->exponent;
    if (!d->digits || e < -345) /* digits < 10^20; half the least is 2e-324 */
        return 0;
    if (e > 308)
        return (double)INFINITY;
    /* Where doubles are evaluated wider, the result would be rounded twice. */
    if (FLT_EVAL_METHOD == 0 && !d->cut && d->digits >> 53 == 0 && e >= -22 &&
        e <= 22) {
        const double digits = (double)d->digits;
        return e < 0 ? digits / powers[-e] : digits * powers[e];
    }
    if (e >= -MAX_POWER && e <= MAX_POWER) {
        const double low = scale_exactly(d->digits, (int)e);
        if (!d->cut || low == scale_exactly(d->digits + 1, (int)e))
            return low;
    }
    return decimal_slowly(d);
}

/* `word` in lower case at p, in any case. */
static bool has_word(const char *p, const char *end, const char *word)
{
    for (; *word; word++, p++)
        if (p == end || (*p | 0x20) != *word)
            return false;
    return true;
}

/* nan, inf, infinity; what Windows libraries print: nan(ind), 1.#IND, 1.#INF.
 * A sign has been taken. Returns p if it is none of these. */
static const char *scan_special(const char *p, const char *end, double *out)
{
    if (has_word(p, end, "nan")) {
        *out = (double)NAN;
        p += 3;
        const char *close = p < end && *p == '(' ? p + 1 : end;
        while (close < end && is_letter(*close))
            close++;
        return close < end && *close == ')' ? close + 1 : p;
    }
    if (has_word(p, end, "inf")) {
        *out = (double)INFINITY;
        return p + (has_word(p, end, "infinity") ? 8 : 3);
    }
    if (end - p < 6 || memcmp(p, "1.#", 3) != 0)
        return p;
    const char *word = p + 3;
    const bool infinite = has_word(word, end, "inf");
    if (!infinite && !has_word(word, end, "ind") &&
        !has_word(word, end, "qnan") && !has_word(word, end, "snan"))
        return p; /* 1. and a comment */
    *out = infinite ? (double)INFINITY : (double)NAN;
    for (p = word; p < end && is_letter(*p); p++)
        ;
    while (is_digit(p, end))
        p++;
    return p;
}

const char *asset_number_parse(const char *p, const char *end, double *out)
{
    const char *start = p;
    const bool negative = p < end && *p == '-';
    if (p < end && (*p == '-' || *p == '+'))
        p++;
    double value = 0;
    const char *next = scan_special(p, end, &value);
    if (next == p) {
        decimal d;
        next = scan_decimal(p, end, &d);
        if (next == p)
            return start;
        value = decimal_to_double(&d);
    }
    *out = negative ? -value : value;
    return next;
}

/* ---- printing ------------------------------------------------------------ */

/* digits * 10^exponent in plain or scientific notation. */
static size_t put_decimal(char *dst, uint64_t digits, int exponent)
{
    char text[20];
    int n = 0;
    for (uint64_t rest = digits; rest; rest /= 10)
        n++;
    for (int i = n - 1; i >= 0; i--, digits /= 10)
        text[i] = (char)('0' + digits % 10);

    char *p = dst;
    int point = n + exponent; /* digits before the decimal point */
    const bool plain = point > -5 && point <= 17;
    if (!plain)
        point = 1;
    if (point <= 0) {
        *p++ = '0';
        *p++ = '.';
        for (int i = point; i < 0; i++)
            *p++ = '0';
    }
    for (int i = 0; i < n; i++) {
        if (i == point && point > 0)
            *p++ = '.';
        *p++ = text[i];
    }
    for (int i = n; i < point; i++)
        *p++ = '0';
    if (!plain) {
        int power = n + exponent - 1;
        *p++ = 'e';
        *p++ = power < 0 ? '-' : '+';
        if (power < 0)
            power = -power;
        if (power >= 100)
            *p++ = (char)('0' + power / 100);
        *p++ = (char)('0' + power / 10 % 10);
        *p++ = (char)('0' + power % 10);
    }
    return (size_t)(p - dst);
}

/* Doubles out of shortest()'s reach: printf finds the digits. */
static size_t put_by_trial(char *dst, double value, bool is_float)
{
    /* Every decimal of 15 (6) digits is a normal double (float), or prints
     * with zeros behind; denormals may have any shorter length. */
    const bool normal = value >= (is_float ? (double)FLT_MIN : DBL_MIN);
    uint64_t digits = 0;
    int exponent = 0;
    for (int n = !normal ? 1 : is_float ? 6 : 15; n <= 17; n++) {
        char text[48];
        snprintf(text, sizeof text, "%.*e", n - 1, value);
        digits = 0;
        const char *p = text;
        for (; *p && *p != 'e'; p++) /* steps over the locale's point */
            if (*p >= '0' && *p <= '9')
                digits = digits * 10 + (uint64_t)(*p - '0');
        int64_t power = 0;
        scan_exponent(p, text + sizeof text, &power);
        exponent = (int)power - n + 1;
        double back;
        const size_t size = put_decimal(dst, digits, exponent);
        asset_number_parse(dst, dst + size, &back);
        if (is_float ? (float)back == (float)value : back == value)
            break;
    }
    for (; digits % 10 == 0; exponent++)
        digits /= 10;
    return put_decimal(dst, digits, exponent);
}

/* floor(a * b / 2^shift), shift in 0 .. 127; *exact: nothing was cut off. */
static uint64_t product_shifted(uint64_t a, uint64_t b, int shift, bool *exact)
{
    const wide p = wide_product(a, b);
    if (shift >= 64) {
        const int s = shift - 64;
        *exact = !p.lo && (p.hi & (((uint64_t)1 << s) - 1)) == 0;
        return p.hi >> s;
    }
    *exact = (p.lo & (((uint64_t)1 << shift) - 1)) == 0;
    return shift ? p.hi << (64 - shift) | p.lo >> shift : p.lo;
}

/*
 * The shortest decimal in the rounding interval of m * 2^exponent (m > 0),
 * the closest to it if there are several. false: out of reach.
 *
 *   low          value          high        in units of 10^-power: integers
 *    (-----|-------+------|------)          in between are candidates
 */
static bool shortest(uint64_t m, int exponent, bool narrow_below,
                     uint64_t *digits, int *power)
{
    const int top = exponent + 63 - leading_zeros(m);
    /* 0.30103 is log10 2: the value has 17 or 18 digits before the point. */
    int k = 16 - (int)floor(top * 0.30103);
    if (k < 0)
        return false;
    if (k > MAX_POWER)
        k = MAX_POWER;
    const int shift = 2 - exponent - k;
    if (shift < 0 || shift > 127)
        return false;
    const uint64_t five = power_of_five(k);
    const bool closed = (m & 1) == 0; /* ties round to this value */
    bool exact;
    uint64_t low =
        product_shifted(4 * m - (narrow_below ? 1 : 2), five, shift, &exact);
    low += !(exact && closed);
    uint64_t high = product_shifted(4 * m + 2, five, shift, &exact);
    high -= exact && !closed;
    const uint64_t value = product_shifted(4 * m, five, shift, &exact);
    if (low > high)
        return false;

    uint64_t unit = 1;
    int dropped = 0;
    for (;;) {
        const uint64_t next_low = low / 10 + (low % 10 != 0);
        const uint64_t next_high = high / 10;
        if (next_low > next_high)
            break;
        low = next_low;
        high = next_high;
        unit *= 10;
        dropped++;
    }
    uint64_t best = value / unit;
    if (unit > 1)
        best += value % unit >= unit / 2;
    if (best < low)
        best = low;
    if (best > high)
        best = high;
    *digits = best;
    *power = dropped - k;
    return true;
}

static size_t put_special(char *dst, double value)
{
    const char *text = isnan(value) ? "nan" : isinf(value) ? "inf" : "0";
    const size_t size = strlen(text);
    memcpy(dst, text, size);
    return size;
}

size_t asset_number_print(char *dst, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    size_t sign = 0;
    if (bits >> 63 && !isnan(value))
        dst[sign++] = '-';
    value = fabs(value);
    if (!(value > 0) || isinf(value))
        return sign + put_special(dst + sign, value);

    const uint64_t fraction = bits & (((uint64_t)1 << 52) - 1);
    const int field = (int)(bits >> 52 & 0x7FF);
    const uint64_t m = field ? fraction | (uint64_t)1 << 52 : fraction;
    uint64_t digits;
    int power;
    if (shortest(m, (field ? field : 1) - 1075, !fraction && field > 1, &digits,
                 &power))
        return sign + put_decimal(dst + sign, digits, power);
    return sign + put_by_trial(dst + sign, value, false);
}

size_t asset_number_print_float(char *dst, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    size_t sign = 0;
    if (bits >> 31 && !isnan(value))
        dst[sign++] = '-';
    value = fabsf(value);
    if (!(value > 0) || isinf(value))
        return sign + put_special(dst + sign, (double)value);

    const uint32_t fraction = bits & 0x7FFFFF;
    const int field = (int)(bits >> 23 & 0xFF);
    const uint64_t m = field ? fraction | (uint32_t)1 << 23 : fraction;
    uint64_t digits;
    int power;
    if (shortest(m, (field ? field : 1) - 150, !fraction && field > 1, &digits,
                 &power))
        return sign + put_decimal(dst + sign, digits, power);
    return sign + put_by_trial(dst + sign, (double)value, true);
}
