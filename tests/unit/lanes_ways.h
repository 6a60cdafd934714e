/* SPDX-License-Identifier: MIT */
/*
 * lanes_ways.h - what every operation of format/lanes.h makes of some input,
 * compiled once for each way in which that header is written.
 */
#ifndef PMESH_TEST_LANES_WAYS_H
#define PMESH_TEST_LANES_WAYS_H

#include <stdint.h>

enum {
    LANES_IN = 32,  /* four times eight numbers of 16 bits */
    LANES_OUT = 400 /* room for all results */
};

typedef uint32_t lanes_way(const int16_t in[LANES_IN], int32_t out[LANES_OUT]);

/* Return how many results there are. */
lanes_way lanes_usual, lanes_plain, lanes_vectors;

#endif
