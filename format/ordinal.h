/* SPDX-License-Identifier: MIT */
/*
 * ordinal.h - the numbers that a file's positions are made of, counted.
 *
 * Positions are seldom any floats: they were printed with so many digits, or
 * are multiples of some 2^-n. A form tells which numbers there are: those of
 * at most `digits` digits, the last of which stands for 10^-decimals (or
 * 2^-decimals) at the finest, each rounded to a float.
 *
 *     digits 2, decimals 1:  0 0.1 0.2 ... 9.9 10 11 ... 99 100 110 ...
 *     ordinal                0   1   2      99 100 101   189 190 191
 *
 * Negative numbers have negative ordinals; -1 is -0, -2 is the number below.
 * 24 binary digits, 149 of them decimals, are all the floats there are.
 *
 * As quantize.h: IEEE doubles, + - * / only, the same bits everywhere.
 */
#ifndef PMESH_ORDINAL_H
#define PMESH_ORDINAL_H

#include <stdbool.h>

#include "format/pmesh.h"

enum {
    PMESH_DECIMAL_DIGITS = 9,    /* the most of a form */
    PMESH_DECIMAL_DECIMALS = 22, /* 10^22 is the last exact double */
    PMESH_BINARY_DIGITS = 24,
    PMESH_BINARY_DECIMALS = 149
};

typedef struct pmesh_form {
    bool binary;
    uint8_t digits, decimals;
} pmesh_form;

/* At least one digit, at most those above. What follows needs a legal form. */
bool pmesh_form_legal(const pmesh_form *form);

/* Ordinals of the numbers next to a finite x: not below it, with -0 below 0,
 * and not above it. Beyond the largest number, that of the largest. */
int64_t pmesh_ordinal_from(const pmesh_form *form, double x);
int64_t pmesh_ordinal_to(const pmesh_form *form, double x);

/* The ordinal of x; false if the form does not have it, bit for bit. */
bool pmesh_ordinal_of(const pmesh_form *form, float x, int64_t *out);

/* The number of an ordinal that came from above, or of one between two. */
float pmesh_ordinal_value(const pmesh_form *form, int64_t ordinal);

/* Equal bits: unlike ==, tells -0 from 0. */
bool pmesh_float_same(float a, float b);

#endif
