/* SPDX-License-Identifier: MIT */
/*
 * script.h - a range-coded chunk with wrong decisions: the decoder of
 * tests/reference follows the chunk of a good file and writes what it reads,
 * until the script wants something else.
 */
#ifndef SCRIPT_H
#define SCRIPT_H

#include "tests/corrupt/corrupt.h"

enum { AFTERWARDS = -1 };

/*
 * From the n-th decision with the named models on (counted from 0; AFTERWARDS:
 * from when the turn before began), they are `bits`: "0110", and then what is likeliest; what stands in brackets goes on
 * for ever. All other decisions are those of the file before the first turn,
 * and the likeliest ones behind it.
 */
typedef struct turn {
    const char *models;
    int64_t from;
    const char *bits;
} turn;

enum { TURNS = 6 };

typedef struct script {
    turn turns[TURNS];
    uint32_t pick; /* of exact positions: this cell, if not 0 */
} script;

/*
 * Replaces the coded part of `at`, a base, block or positions chunk. Returns the
 * rule that breaks by the reference, or NULL: there is none.
 */
const char *script_write(const chunks *c, chunk *at, const script *s);

#endif
