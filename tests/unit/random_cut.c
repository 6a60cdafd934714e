/* SPDX-License-Identifier: MIT */
#include "tests/unit/random_cut.h"

#include "tests/unit/shapes.h"

pmesh_cut random_cut(uint32_t *seed, const pmesh_ring *ring)
{
    for (;;) {
        pmesh_cut cut;
        cut.first = shape_random(seed, ring->count + 1);
        cut.end = shape_random(seed, ring->count + 1);
        if (cut.first == ring->count)
            cut.first = PMESH_NONE;
        if (cut.end == ring->count)
            cut.end = PMESH_NONE;
        if (pmesh_cut_legal(ring, cut))
            return cut;
    }
}
