/* SPDX-License-Identifier: MIT */
/*
 * enc_relay.h - a block is coded by two threads.
 *
 * The encoder knows what the stream will say. So one thread can walk through
 * the mesh without a look at the models of what is coded there, and the other,
 * behind it, codes what that tells: bits and numbers; cuts, with what they need
 * of the mesh around; positions and attributes, with what is expected of them.
 * The bytes are those of one thread.
 */
#ifndef ENC_RELAY_H
#define ENC_RELAY_H

#include "encoder/enc_pool.h"
#include "format/codec.h"

typedef struct enc_relay enc_relay;

/* For blocks of `codec`, from now on all of them: it has the models of cuts.
 * NULL if there is no pool or no memory; it can be done without. */
enc_relay *enc_relay_create(const pmesh_allocator *allocator, enc_pool *pool,
                            pmesh_codec *codec);
void enc_relay_destroy(enc_relay *relay); /* or NULL */

/* pmesh_block_code(). Takes the pool meanwhile. */
pmesh_status enc_relay_block(enc_relay *relay, pmesh_coder *coder,
                             const pmesh_oracle *oracle, uint32_t splits);

#endif
