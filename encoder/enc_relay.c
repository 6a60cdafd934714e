/* SPDX-License-Identifier: MIT */
#include "encoder/enc_relay.h"

#include <string.h>

#include "encoder/enc_pipe.h"
#include "format/alloc.h"
#include "format/cut.h"
#include "format/residual.h"
#include "format/value.h"

/* Where cuts are coded: the vertex, its ring, and the ring's parents. */
enum {
    MEMBER = 1,
    PARENT = MEMBER + PMESH_MAX_RING,
    AROUND = PARENT + PMESH_MAX_RING
};

struct enc_relay {
    pmesh_allocator allocator;
    enc_pool *pool;
    enc_pipe *pipe;
    pmesh_codec *codec;
    pmesh_relay front; /* what the walk talks to */

    /* Of the thread behind. */
    pmesh_coder *coder;
    size_t written;     /* up to the last part */
    uint64_t spent;     /* up to the last attribute, or part */
    pmesh_codec around; /* stands for the codec's surroundings of a cut */
    pmesh_ring ring;
    int32_t position[AROUND + 1][3];
    uint32_t parent[AROUND];
    uint8_t state[AROUND];
    pmesh_near near[AROUND];
};

/* ---- what is told -------------------------------------------------------- */

typedef enum kind {
    BIT,
    NUMBER,
    RAW,
    CUT,
    PLACE,
    VALUES,
    SPENT,
    PART
} kind;

/* Without more to them: bits and numbers, attributes and parts. */
typedef struct plain {
    kind kind;
    uint32_t value;
    union {
        pmesh_bit *bit;
        pmesh_number *number;
        unsigned count; /* of bits */
    } by;
} plain;

typedef struct place {
    kind kind;
    int32_t is[3];
    pmesh_place_models *models;
    pmesh_prediction expected;
} place;

typedef struct values {
    kind kind;
    pmesh_outlook outlook;
} values;

typedef struct member {
    int32_t position[3];
    uint16_t degree, state;
} member;

/* Behind it come `count` members, then where the parents of those are that are
 * newborn. */
typedef struct cut {
    kind kind;
    uint32_t count;
    bool open;
    pmesh_cut cut;
    int32_t position[3];
} cut;

static void copy(int32_t to[3], const int32_t from[3])
{
    memcpy(to, from, 3 * sizeof *to);
}

static void tell_plain(const enc_relay *r, plain what)
{
    plain *p = enc_pipe_room(r->pipe, sizeof *p);
    *p = what;
}

static void tell_bit(void *user, pmesh_bit *model, unsigned bit)
{
    tell_plain(user, (plain){ BIT, bit, { .bit = model } });
}

static void tell_number(void *user, pmesh_number *model, uint32_t value)
{
    tell_plain(user, (plain){ NUMBER, value, { .number = model } });
}

static void tell_raw(void *user, unsigned count, uint32_t value)
{
    tell_plain(user, (plain){ RAW, value, { .count = count } });
}

static void tell_place(void *user, pmesh_place_models *models,
                       const pmesh_prediction *expected, const int32_t is[3])
{
    const enc_relay *r = user;
    place *t = enc_pipe_room(r->pipe, sizeof *t);
    t->kind = PLACE;
    t->models = models;
    t->expected = *expected;
    copy(t->is, is);
}

static void tell_values(void *user, const pmesh_outlook *outlook)
{
    const enc_relay *r = user;
    values *t = enc_pipe_room(r->pipe, sizeof *t);
    t->kind = VALUES;
    t->outlook = *outlook;
}

static void tell_spent(void *user, uint32_t attribute)
{
    tell_plain(user, (plain){ SPENT, attribute, { NULL } });
}

static void tell_part(void *user, int part)
{
    const enc_relay *r = user;
    tell_plain(r, (plain){ PART, (uint32_t)part, { NULL } });
    enc_pipe_flush(r->pipe);
}

static bool is_newborn(const pmesh_codec *c, uint32_t v)
{
    return c->state[v] == PMESH_NEWBORN;
}

static void tell_cut(void *user, const pmesh_codec *c, uint32_t v,
                     const pmesh_ring *ring, const pmesh_cut *given)
{
    const enc_relay *r = user;
    const int32_t(*position)[3] = (const int32_t(*)[3])c->mesh.position;
    const uint32_t n = ring->count;
    uint32_t newborn = 0;
    for (uint32_t i = 0; i < n; i++)
        newborn += is_newborn(c, ring->vertex[i]);
    cut *t = enc_pipe_room(r->pipe, sizeof *t + n * sizeof(member) +
                                        newborn * sizeof *position);
    member *m = (member *)(void *)(t + 1);
    int32_t *parent = (int32_t *)(void *)(m + n);
    *t = (cut){ .kind = CUT, .count = n, .open = ring->open, .cut = *given };
    copy(t->position, position[v]);
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t x = ring->vertex[i], degree = c->near[x].degree;
        m[i].degree = (uint16_t)(degree < UINT16_MAX ? degree : UINT16_MAX);
        m[i].state = c->state[x];
        copy(m[i].position, position[x]);
        if (!is_newborn(c, x))
            continue;
        copy(parent, position[c->mesh.parent[x]]);
        parent += 3;
    }
}

/* ---- what is coded ------------------------------------------------------- */

static void code_cut(enc_relay *r, const cut *t)
{
    const member *m = (const member *)(const void *)(t + 1);
    const int32_t *parent = (const int32_t *)(const void *)(m + t->count);
    pmesh_cut same = t->cut;
    r->ring.count = t->count;
    r->ring.open = t->open;
    copy(r->position[0], t->position);
    for (uint32_t i = 0; i < t->count; i++) {
        copy(r->position[MEMBER + i], m[i].position);
        r->state[MEMBER + i] = (uint8_t)m[i].state;
        r->near[MEMBER + i].degree = m[i].degree;
        if (!is_newborn(&r->around, MEMBER + i))
            continue;
        copy(r->position[PARENT + i], parent);
        parent += 3;
    }
    pmesh_cut_code(&r->around, r->coder, 0, &r->ring, &same);
}

static void code_place(enc_relay *r, const place *t)
{
    pmesh_prediction expected = t->expected;
    int32_t same[3];
    copy(same, t->is);
    pmesh_residual_code(r->coder, t->models, r->codec->bounds, &expected, same);
}

static void code_values(enc_relay *r, const values *t)
{
    pmesh_outlook same = t->outlook;
    pmesh_outlook_code(r->codec, r->coder, &same);
}

static void count_part(enc_relay *r, uint32_t part)
{
    r->codec->part_size[part] += r->coder->out->size - r->written;
    r->written = r->coder->out->size;
    r->spent = pmesh_coder_spent(r->coder);
}

static void code_plain(enc_relay *r, const plain *p)
{
    if (p->kind == BIT)
        pmesh_code_bit(r->coder, p->by.bit, p->value);
    else if (p->kind == NUMBER)
        pmesh_code_number(r->coder, p->by.number, p->value);
    else if (p->kind == RAW)
        pmesh_code_raw(r->coder, p->by.count, p->value);
    else if (p->kind == SPENT)
        pmesh_values_spent(r->codec, r->coder, p->value, &r->spent);
    else
        count_part(r, p->value);
}

static void follow(void *user, uint32_t whole, unsigned worker)
{
    enc_relay *r = user;
    const void *told;
    (void)whole;
    (void)worker;
    while ((told = enc_pipe_next(r->pipe))) {
        const kind *what = told;
        if (*what == CUT)
            code_cut(r, told);
        else if (*what == PLACE)
            code_place(r, told);
        else if (*what == VALUES)
            code_values(r, told);
        else
            code_plain(r, told);
    }
}

pmesh_status enc_relay_block(enc_relay *r, pmesh_coder *coder,
                             const pmesh_oracle *oracle, uint32_t splits)
{
    pmesh_coder front = *coder;
    front.relay = &r->front;
    r->coder = coder;
    r->written = coder->out->size;
    enc_pipe_open(r->pipe);
    enc_pool_begin(r->pool, 1, follow, r);
    const pmesh_status status =
        pmesh_block_code(r->codec, &front, oracle, splits);
    enc_pipe_close(r->pipe);
    enc_pool_end(r->pool);
    return status;
}

/* ---- set-up -------------------------------------------------------------- */

/* The ring is the same numbers always, and so are its parents. */
static bool lay_around(enc_relay *r)
{
    r->around.models = r->codec->models;
    r->around.scratch =
        pmesh_alloc(&r->allocator, 1, (size_t)pmesh_cut_room());
    r->around.mesh.position = r->position;
    r->around.mesh.parent = r->parent;
    r->around.state = r->state;
    r->around.near = r->near;
    for (uint32_t i = 0; i < PMESH_MAX_RING; i++) {
        r->ring.vertex[i] = MEMBER + i;
        r->parent[MEMBER + i] = PARENT + i;
    }
    return r->around.scratch;
}

enc_relay *enc_relay_create(const pmesh_allocator *a, enc_pool *pool,
                            pmesh_codec *codec)
{
    enc_relay *r = pool ? pmesh_alloc_zero(a, 1, sizeof *r) : NULL;
    if (!r)
        return NULL;
    r->allocator = *a;
    r->pool = pool;
    r->codec = codec;
    r->front = (pmesh_relay){ r,           tell_bit,   tell_number,
                              tell_raw,    tell_cut,   tell_place,
                              tell_values, tell_spent, tell_part };
    r->pipe = enc_pipe_create(a);
    if (r->pipe && lay_around(r))
        return r;
    enc_relay_destroy(r);
    return NULL;
}

void enc_relay_destroy(enc_relay *r)
{
    if (!r)
        return;
    const pmesh_allocator a = r->allocator;
    pmesh_release(&a, r->around.scratch, 1, (size_t)pmesh_cut_room());
    enc_pipe_destroy(r->pipe);
    pmesh_release(&a, r, 1, sizeof *r);
}
