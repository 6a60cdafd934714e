/* SPDX-License-Identifier: MIT */
/*
 * relay.h - what an encoding coder is given may be taken by somebody else, so
 * that another thread codes it: the walk does not look into models, and knows
 * what the stream will say.
 *
 * Calls come in the order of the stream. What is pointed at may change behind a
 * call, but for models.
 */
#ifndef PMESH_RELAY_H
#define PMESH_RELAY_H

#include "format/coder.h"
#include "format/mesh.h"

struct pmesh_codec;
struct pmesh_place_models; /* see models.h */
struct pmesh_prediction;   /* see predict.h */
struct pmesh_outlook;      /* see value.h */

typedef struct pmesh_relay {
    void *user;
    void (*bit)(void *user, pmesh_bit *model, unsigned bit);
    void (*number)(void *user, pmesh_number *model, uint32_t value);
    void (*raw)(void *user, unsigned count, uint32_t value);
    void (*cut)(void *user, const struct pmesh_codec *c, uint32_t v,
                const pmesh_ring *ring, const pmesh_cut *cut);
    void (*place)(void *user, struct pmesh_place_models *models,
                  const struct pmesh_prediction *expected,
                  const int32_t position[3]);
    void (*values)(void *user, const struct pmesh_outlook *outlook);
    void (*spent)(void *user, uint32_t attribute); /* on that, so far */
    void (*part)(void *user, int part); /* ends here: see part_size */
} pmesh_relay;

/* pmesh_code_bit(), pmesh_code_number() and pmesh_code_raw(), or the relay. */
static inline unsigned pmesh_tell_bit(pmesh_coder *c, pmesh_bit *m,
                                      unsigned bit)
{
    if (!c->relay)
        return pmesh_code_bit(c, m, bit);
    c->relay->bit(c->relay->user, m, bit);
    return bit;
}

static inline uint32_t pmesh_tell_number(pmesh_coder *c, pmesh_number *m,
                                         uint32_t value)
{
    if (!c->relay)
        return pmesh_code_number(c, m, value);
    c->relay->number(c->relay->user, m, value);
    return value;
}

static inline uint32_t pmesh_tell_raw(pmesh_coder *c, unsigned count,
                                      uint32_t value)
{
    if (!c->relay)
        return pmesh_code_raw(c, count, value);
    c->relay->raw(c->relay->user, count, value);
    return value;
}

#endif
