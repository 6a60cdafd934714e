/* SPDX-License-Identifier: MIT */
/*
 * cut.h - codes where a ring is cut (SPEC 6.4): every legal cut gets a cost
 * from the ring's shape and state, and the stream holds the rank of the true
 * one, cheapest first.
 */
#ifndef PMESH_CUT_H
#define PMESH_CUT_H

#include "format/codec.h"

/* Bytes of scratch that pmesh_cut_code() needs. */
uint64_t pmesh_cut_room(void);

/* Codes the cut of `v`, whose ring is given; what comes out is legal. */
void pmesh_cut_code(pmesh_codec *c, pmesh_coder *coder, uint32_t v,
                    const pmesh_ring *ring, pmesh_cut *cut);

/* The same, or the relay. */
static inline void pmesh_cut_tell(pmesh_codec *c, pmesh_coder *coder,
                                  uint32_t v, const pmesh_ring *ring,
                                  pmesh_cut *cut)
{
    if (coder->relay)
        coder->relay->cut(coder->relay->user, c, v, ring, cut);
    else
        pmesh_cut_code(c, coder, v, ring, cut);
}

#endif
