/* SPDX-License-Identifier: MIT */
/* SPEC 5.1, 5.2: signature, chunks, checksums, their order. */
#include "tests/reference/ref.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void ref_reject(ref *r, const char *rule)
{
    r->verdict = REF_REJECTED;
    r->rule = rule;
    longjmp(r->stop, 1);
}

void ref_check(ref *r, bool holds, const char *rule)
{
    if (!holds)
        ref_reject(r, rule);
}

void *ref_grow(ref *r, void *array, size_t *room, size_t count, size_t size)
{
    (void)r;
    if (count <= *room)
        return array;
    *room = 2 * count + 64;
    array = realloc(array, *room * size);
    if (!array) {
        fprintf(stderr, "reference: out of memory\n");
        exit(3);
    }
    return array;
}

/* ---- fields (2) --------------------------------------------------------- */

uint64_t ref_get(ref_bytes *in, int bytes)
{
    uint64_t value = 0;
    ref_check(in->r, in->end - in->next >= bytes, in->rule);
    for (int i = 0; i < bytes; i++)
        value |= (uint64_t)*in->next++ << (8 * i);
    return value;
}

uint64_t ref_get_varint(ref_bytes *in)
{
    uint64_t value = 0;
    for (int i = 0; i < 9; i++) {
        const uint64_t byte = ref_get(in, 1);
        value |= (byte & 127) << (7 * i);
        if (byte < 128) {
            ref_check(in->r, byte > 0 || i == 0, "2: a varint ends in 0");
            return value;
        }
    }
    ref_reject(in->r, "2: a varint is too long");
}

uint32_t ref_crc32c(uint32_t crc, const uint8_t *data, size_t size)
{
    crc = ~crc; /* 82f63b78 is 1edc6f41 reflected */
    for (size_t i = 0; i < size; i++) {
        crc ^= data[i];
        for (int k = 0; k < 8; k++)
            crc = crc >> 1 ^ (crc & 1 ? 0x82f63b78u : 0);
    }
    return ~crc;
}

uint64_t ref_hash_crc(uint64_t h, uint32_t crc)
{
    for (int i = 0; i < 4; i++)
        h = (h ^ (crc >> (8 * i) & 255)) * 0x100000001b3u;
    return h;
}

/* ---- chunks ------------------------------------------------------------- */

enum {
    HEADER = 1, BASE = 2, BLOCK = 3, BLOCK_LAST = 4, END = 5, NAMES = 6,
    POSITIONS = 7, SKIPPABLE = 128
};

typedef struct chunk {
    int type;
    const uint8_t *data;
    size_t size, crc_at; /* from the first byte of the chunk */
} chunk;

static _Noreturn void stop(ref *r, ref_verdict verdict, const char *rule)
{
    r->verdict = verdict;
    r->rule = rule;
    longjmp(r->stop, 1);
}

/* Type and size; needs only these to be there. */
static chunk read_frame(ref *r, const uint8_t *data, size_t size)
{
    chunk c = { 0 };
    size_t at = 1;
    uint64_t length = 0;
    if (size == 0)
        stop(r, REF_INCOMPLETE, "");
    c.type = data[0];
    for (int i = 0;; i++) {
        if (at == size)
            stop(r, REF_INCOMPLETE, "");
        const uint8_t byte = data[at++];
        length |= (uint64_t)(byte & 127) << (7 * i);
        if (byte < 128) {
            ref_check(r, byte > 0 || i == 0, "2: a varint ends in 0");
            break;
        }
        ref_check(r, i < 4, "5.2: the size takes more than 5 bytes");
    }
    ref_check(r, length <= 1u << 28, "5.2: the size is above 2^28");
    c.data = data + at;
    c.size = (size_t)length;
    c.crc_at = at + c.size;
    return c;
}

static bool all_there(const ref *r)
{
    return r->has_base && r->levels == r->header.level_count &&
           (!r->header.lossless || r->exact_count == r->vertex_count);
}

/* May this chunk come here? */
static void check_place(ref *r, const chunk *c, bool has_header)
{
    const ref_header *h = &r->header;
    if (!has_header) {
        ref_check(r, c->type == HEADER, "5.2: the header is not the first");
        ref_check(r, c->size <= 4096, "5.3: the header is too long");
        return;
    }
    if (c->type >= SKIPPABLE)
        return;
    if (c->type == 0 || c->type > POSITIONS)
        stop(r, REF_NEWER, "5.2: an unknown critical chunk");
    const bool levels = r->has_base && r->levels == h->level_count;
    switch (c->type) {
    case HEADER: ref_reject(r, "5.2: a second header");
    case NAMES:
        ref_check(r, !r->names && !r->has_base, "5.2: names come too late");
        ref_check(r, c->size == h->names_size, "5.2: the size of the names");
        return;
    case BASE: ref_check(r, !r->has_base, "5.2: a second base"); break;
    case BLOCK:
    case BLOCK_LAST:
        ref_check(r, r->has_base && !levels, "5.2: a block too many");
        break;
    case POSITIONS:
        ref_check(r, h->lossless && levels && !all_there(r),
                  "5.2: positions out of place");
        break;
    default:
        ref_check(r, all_there(r), "5.2: the end comes too early");
        ref_check(r, c->size == 0, "5.2: the end is not empty");
        return;
    }
    ref_check(r, c->size <= h->chunk_size, "5.2: above chunk_size");
}

static void read_names(ref *r, const chunk *c)
{
    REF_SEEN(names);
    r->names = calloc(c->size + 1, 1);
    if (c->size)
        memcpy(r->names, c->data, c->size);
}

const char *ref_name(const ref *r, uint64_t n)
{
    const char *at = r->names;
    const char *end = at ? at + r->header.names_size : NULL;
    for (; at && n > 0; n--) {
        at += strlen(at) + 1;
        if (at >= end)
            return "";
    }
    return at ? at : "";
}

static void read_payload(ref *r, const chunk *c)
{
    switch (c->type) {
    case HEADER: ref_read_header(r, c->data, c->size); break;
    case NAMES: read_names(r, c); break;
    case BASE:
        if (r->header.draco)
            stop(r, REF_UNSUPPORTED, "6.2: a Draco base");
        ref_read_base(r, c->data, c->size);
        r->has_base = true;
        r->levels = 1;
        break;
    case BLOCK:
    case BLOCK_LAST:
        if (c->type == BLOCK)
            REF_SEEN(block_goes_on);
        ref_read_block(r, c->data, c->size, c->type == BLOCK_LAST);
        break;
    case POSITIONS: ref_read_exact(r, c->data, c->size); break;
    default: REF_SEEN(skippable); break;
    }
}

static void read_chunks(ref *r, const uint8_t *data, size_t size)
{
    uint64_t hash = 0xcbf29ce484222325u;
    uint32_t before = 0;
    bool has_header = false;
    for (size_t at = 8;;) {
        const chunk c = read_frame(r, data + at, size - at);
        check_place(r, &c, has_header);
        if (size - at < c.crc_at + 4)
            stop(r, REF_INCOMPLETE, "");
        const bool goes_on = has_header && c.type < SKIPPABLE;
        const uint32_t crc =
            ref_crc32c(goes_on ? before : 0, data + at, c.crc_at);
        const uint8_t *stored = data + at + c.crc_at;
        for (int i = 0; i < 4; i++)
            ref_check(r, stored[i] == (crc >> (8 * i) & 255), "5.2: crc");
        if (c.type == END)
            break;
        if (goes_on)
            hash = ref_hash_crc(hash, before = crc);
        read_payload(r, &c);
        has_header = true;
        at += c.crc_at + 4;
    }
    ref_check(r, hash == r->header.content_hash, "5.3: content hash");
    r->verdict = REF_COMPLETE;
}

ref *ref_decode(const uint8_t *data, size_t size)
{
    static const uint8_t signature[] = { 0x89, 0x50, 0x4d, 0x53,
                                         0x48, 0x0d, 0x0a, 0x1a };
    ref *r = calloc(1, sizeof *r);
    if (!r)
        return NULL;
    r->rule = "";
    ref_models_start(r);
    if (!setjmp(r->stop)) {
        for (size_t i = 0; i < 8; i++) {
            if (i == size)
                stop(r, REF_INCOMPLETE, "");
            ref_check(r, data[i] == signature[i], "5.1: signature");
        }
        read_chunks(r, data, size);
    }
    return r;
}

void ref_free(ref *r)
{
    if (!r)
        return;
    free(r->names);
    free(r->vertex);
    free(r->edge);
    free(r->material);
    free(r->wedge);
    free(r->split);
    free(r->list.next);
    free(r->list.head);
    free(r->order);
    free(r);
}
