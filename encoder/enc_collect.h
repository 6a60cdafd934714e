/* SPDX-License-Identifier: MIT */
/*
 * enc_collect.h - the candidates of a batch: every edge that may be contracted
 * on the mesh before it, in its better direction.
 *
 * Blocks of vertices are looked at in parallel. A block lists the edges whose
 * lower half-edge leaves its vertices, and the lists come one after the other:
 * in the order of one thread that goes through all vertices.
 */
#ifndef ENC_COLLECT_H
#define ENC_COLLECT_H

#include "encoder/enc_batch.h"

/* What is known of an edge from before the batch, kept at the lower numbered
 * of its half-edges. "Forth" contracts its start into its end. */
enum {
    MAY_FORTH = 1,
    MAY_BACK = 2,
    UNCLEAN_FORTH = 4,
    UNCLEAN_BACK = 8,
    TURNED = 16, /* the second direction has been queued as well */
    GENERAL = 32, /* a pair for enc_join.h */
    LATE = 64     /* may spoil faces, when there is little else */
};

/* An id names a half-edge of the pair and which of its ends is the child. */
static inline uint32_t enc_entry_id(uint32_t h, bool back)
{
    return h << 1 | (uint32_t)back;
}

static inline bool may(uint8_t state, bool back)
{
    return state & (back ? MAY_BACK : MAY_FORTH);
}

static inline bool unclean(uint8_t state, bool back)
{
    return state & (back ? UNCLEAN_BACK : UNCLEAN_FORTH);
}

/* The pair of an entry. A number h beyond the half-edges stands for a pair
 * without edge. */
enc_pair enc_run_pair(const enc_run *run, uint32_t h, bool back);

/* Its estimated quadric goes to *quadric; the largest key: forbidden. */
enc_entry enc_run_entry(const enc_run *run, uint32_t h, bool back,
                        double *quadric);

/* Without it its segment would have less than its share of what is left. */
bool enc_run_has_to_stay(const enc_run *run, uint32_t v);

/* After so many more candidates; may cancel the run. */
void enc_run_progress(enc_run *run, uint32_t seen);

/* Fills the queue, and sets what depends on all of it: the guard and the limit
 * of parallel pairs. */
void enc_collect(enc_run *run, double guard);

#endif
