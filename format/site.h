/* SPDX-License-Identifier: MIT */
/*
 * site.h - where positions are predicted: rings and what lies beyond them
 * (SPEC 6.5).
 *
 * Once a block's connectivity is complete, no site depends on another. So
 * several are found at once: whatever one waits for in memory, the others go on
 * meanwhile, and what will be read of their rings is called into the cache.
 */
#ifndef PMESH_SITE_H
#define PMESH_SITE_H

#include "format/codec.h"

enum { PMESH_ABREAST = 8 }; /* sites at once */

/* What a prediction needs of connectivity. */
typedef struct pmesh_site {
    pmesh_ring ring;  /* no members: too large */
    uint32_t partner; /* place in the ring; the last if it is not there */
    /* Opposite of x in the rings of the partner and of the member that lies
     * opposite of the partner: two vertices, maybe the same, or PMESH_NONE. */
    uint32_t beyond[2][2];
} pmesh_site;

/* The rings of `count` <= PMESH_ABREAST vertices x alone. */
void pmesh_sites_rings(const pmesh_codec *c, const uint32_t *x, uint32_t count,
                       pmesh_site *s);

/* All of them, `partner` being the other vertex of the split of each. */
void pmesh_sites_find(const pmesh_codec *c, const uint32_t *x,
                      const uint32_t *partner, uint32_t count, pmesh_site *s);

#endif
