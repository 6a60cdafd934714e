/* SPDX-License-Identifier: MIT */
#include "tests/reference/mutate.h"

#include <stdlib.h>
#include <string.h>

#include "tests/reference/chunks.h"
/* ---- damage ------------------------------------------------------------- */

static void change_byte(chunk *c, uint32_t *seed)
{
    if (c->size == 0)
        return;
    uint8_t *byte = &c->data[shape_random(seed, (uint32_t)c->size)];
    switch (shape_random(seed, 4)) {
    case 0: *byte ^= (uint8_t)(1u << shape_random(seed, 8)); break;
    case 1: *byte = (uint8_t)(*byte + 1); break;
    case 2: *byte = (uint8_t)(*byte - 1); break;
    default: *byte = (uint8_t)shape_random(seed, 256); break;
    }
}

/* Makes the payload one byte longer or a few shorter. */
static void resize(chunk *c, uint32_t *seed)
{
    if (shape_random(seed, 2) && c->size > 0)
        c->size -= shape_random(seed, c->size < 5 ? (uint32_t)c->size : 5);
    else
        c->data[c->size++] = (uint8_t)(shape_random(seed, 3) ? 0 : 77);
}

static void insert(chunks *c, uint32_t at, chunk one)
{
    memmove(c->at + at + 1, c->at + at, (c->count - at) * sizeof *c->at);
    c->at[at] = one;
    c->count++;
}

static void drop(chunks *c, uint32_t at)
{
    free(c->at[at].data);
    c->count--;
    memmove(c->at + at, c->at + at + 1, (c->count - at) * sizeof *c->at);
}

static void change_order(chunks *c, uint32_t *seed)
{
    const uint32_t a = shape_random(seed, c->count);
    const uint32_t b = shape_random(seed, c->count);
    const chunk keep = c->at[a];
    switch (shape_random(seed, 4)) {
    case 0: drop(c, a); break;
    case 1: insert(c, b, chunk_make(keep.type, keep.data, keep.size)); break;
    case 2:
        c->at[a] = c->at[b];
        c->at[b] = keep;
        break;
    default: c->at[a].type = (uint8_t)(1 + shape_random(seed, 8)); break;
    }
}

static void change_chunks(chunks *c, uint32_t *seed)
{
    static const uint8_t odd[] = { 0, 8, 127, 128, 200, 255 };
    const uint32_t at = shape_random(seed, c->count);
    const uint32_t way = shape_random(seed, 20);
    if (way < 8)
        change_byte(&c->at[at], seed);
    else if (way < 11) /* a content, if there is one */
        change_byte(&c->at[at > 0 ? at : c->count / 2], seed);
    else if (way < 14)
        change_byte(&c->at[0], seed);
    else if (way < 17)
        resize(&c->at[at], seed);
    else if (way < 19)
        change_order(c, seed);
    else
        insert(c, at,
               chunk_make(odd[shape_random(seed, 6)], (const uint8_t *)"abc",
                          shape_random(seed, 4)));
}

static shape_bytes mutate_bytes(const shape_bytes *file, uint32_t *seed)
{
    shape_bytes out = { 0 };
    chunk all = { 0, NULL, file->size };
    bytes_put(&out, file->data, file->size);
    all.data = out.data;
    if (shape_random(seed, 4))
        change_byte(&all, seed);
    else
        out.size = shape_random(seed, (uint32_t)file->size + 1);
    return out;
}

shape_bytes mutate(const shape_bytes *file, bool mend, uint32_t seed)
{
    chunks c;
    if (!mend)
        return mutate_bytes(file, &seed);
    chunks_take_apart(file, &c);
    for (uint32_t n = 1 + shape_random(&seed, 2); n > 0 && c.count > 0; n--)
        change_chunks(&c, &seed);
    return chunks_put_together(&c);
}
