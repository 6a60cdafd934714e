/* SPDX-License-Identifier: MIT */
/*
 * mutator.c - libFuzzer's mutations, behind the checksums: changes the payload
 * of a chunk, or the chunks' order, and makes sizes, checksums and the content
 * hash right again. Of scenes it also changes a mesh or the document within.
 * Linked into the targets that decode streams, but for dec_raw.
 */
#include <stdlib.h>
#include <string.h>

#include <zlib.h>

#include "format/cursor.h"
#include "format/layout.h"
#include "format/scene.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/pieces.h"

enum { SPARE = 64, MAX_PARTS = 64, MAX_DOCUMENT = 1 << 16 };

size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t max_size);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size,
                               unsigned seed);

/* libFuzzer is built without MSan, which takes its words for never written. */
#if defined(__has_feature)
#if __has_feature(memory_sanitizer)
#include <sanitizer/msan_interface.h>
#define WRITTEN(data, size) __msan_unpoison(data, size)
#endif
#endif
#ifndef WRITTEN
#define WRITTEN(data, size) ((void)(data))
#endif

static size_t mutate(uint8_t *data, size_t size, size_t max_size)
{
    const size_t made = LLVMFuzzerMutate(data, size, max_size);
    WRITTEN(data, made);
    return made;
}

/* ---- chunks ------------------------------------------------------------- */

/* A copy of its bytes, changed; to free. */
static uint8_t *change(piece *p)
{
    uint8_t *copy = calloc(p->size + SPARE, 1);
    if (!copy)
        return NULL;
    if (p->size > 0)
        memcpy(copy, p->data, p->size);
    p->size = mutate(copy, p->size, p->size + SPARE);
    p->data = copy;
    return copy;
}

static void drop(pieces *p, uint32_t at)
{
    p->count--;
    memmove(p->at + at, p->at + at + 1, (p->count - at) * sizeof *p->at);
}

static void insert(pieces *p, uint32_t at, piece one)
{
    if (p->count == PIECES)
        return;
    memmove(p->at + at + 1, p->at + at, (p->count - at) * sizeof *p->at);
    p->at[at] = one;
    p->count++;
}

static void reorder(pieces *p, fuzz_dice *dice)
{
    static const uint8_t types[] = { 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 127,
                                     128, 255 };
    const uint32_t a = fuzz_draw(dice, p->count);
    const uint32_t b = fuzz_draw(dice, p->count);
    const piece keep = p->at[a];
    switch (fuzz_draw(dice, 5)) {
    case 0:
        drop(p, a);
        break;
    case 1:
        insert(p, b, keep);
        break;
    case 2:
        p->at[a] = p->at[b];
        p->at[b] = keep;
        break;
    case 3:
        p->at[a].type = types[fuzz_draw(dice, sizeof types)];
        break;
    default:
        insert(p, b, (piece){ 0x80, keep.data, fuzz_draw(dice, 4) %
                                                   (keep.size + 1) });
        break;
    }
}

/* ---- scenes ------------------------------------------------------------- */

typedef struct scene {
    pmesh_scene_head head;
    pmesh_scene_stream meshes[MAX_PARTS];
    uint64_t resources[MAX_PARTS];
} scene;

static bool scene_read(const piece *header, scene *s)
{
    pmesh_cursor in = pmesh_cursor_make(header->data, header->size);
    const char *rule;
    return pmesh_scene_head_read(&in, &s->head, &rule) == PMESH_OK &&
           s->head.mesh_count <= MAX_PARTS &&
           s->head.resource_count <= MAX_PARTS &&
           pmesh_scene_lists_read(&in, &s->head, s->meshes, s->resources,
                                  &rule) == PMESH_OK;
}

static bool part_of(const piece *p, uint64_t *number, piece *bytes)
{
    pmesh_cursor in = pmesh_cursor_make(p->data, p->size);
    *number = pmesh_get_varint(&in);
    *bytes = (piece){ 0, in.next, (size_t)(in.end - in.next) };
    return p->type == PMESH_CHUNK_PART && !in.overrun;
}

/* All bytes of a part, with room for `spare` more behind; its chunks are dropped but
 * for the first, whose place is *at. */
static uint8_t *gather(pieces *p, uint32_t part, size_t spare, size_t *size,
                       uint32_t *at)
{
    uint8_t *all = NULL;
    *size = 0;
    *at = 0;
    for (uint32_t i = 0; i < p->count;) {
        uint64_t number;
        piece bytes;
        if (!part_of(&p->at[i], &number, &bytes) || number != part) {
            i++;
            continue;
        }
        uint8_t *grown = realloc(all, *size + bytes.size + spare + 8);
        if (!grown)
            break;
        all = grown;
        memcpy(all + *size, bytes.data, bytes.size);
        *size += bytes.size;
        if (*at == 0)
            *at = i++;
        else
            drop(p, i);
    }
    return all;
}

/* The document as plain text, changed; *data has room for MAX_DOCUMENT. */
static size_t change_document(scene *s, uint8_t *data, size_t size)
{
    uint8_t *text = calloc(MAX_DOCUMENT, 1);
    uLongf length = MAX_DOCUMENT;
    if (text && s->head.document_form == PMESH_DOCUMENT_ZLIB &&
        uncompress(text, &length, data, (uLong)size) == Z_OK) {
        size = (size_t)length;
        memcpy(data, text, size);
        s->head.document_form = PMESH_DOCUMENT_PLAIN;
    }
    free(text);
    return mutate(data, size, size + SPARE);
}

/* Puts the part's new bytes and the header that tells their size in place;
 * returns what is to free. */
static uint8_t *put_back(pieces *p, scene *s, uint32_t part, uint32_t at,
                         const uint8_t *data, size_t size)
{
    const size_t room = p->at[0].size + 4096;
    uint8_t *block = malloc(room + size + 16);
    if (!block)
        return NULL;
    pmesh_writer body = { block + room, 0, 16, false };
    pmesh_put_varint(&body, part);
    memcpy(body.data + body.size, data, size);
    p->at[at].data = body.data;
    p->at[at].size = body.size + size;
    if (s->head.chunk_size < p->at[at].size)
        s->head.chunk_size = (uint32_t)p->at[at].size;
    pmesh_writer head = { block, 0, room, false };
    pmesh_scene_head_write(&head, &s->head, s->meshes, s->resources);
    p->at[0].data = block;
    p->at[0].size = head.size;
    return block;
}

static uint8_t *change_part(pieces *p, fuzz_dice *dice, size_t max_size)
{
    scene *s = calloc(1, sizeof *s);
    uint8_t *data = NULL, *block = NULL;
    if (s && scene_read(&p->at[0], s)) {
        const uint32_t part = fuzz_draw(dice, s->head.mesh_count + 1);
        uint32_t at;
        size_t size;
        data = gather(p, part, max_size + MAX_DOCUMENT + SPARE, &size, &at);
        if (data && part == 0)
            s->head.document_size = size = change_document(s, data, size);
        else if (data)
            s->meshes[part - 1].size = size = LLVMFuzzerCustomMutator(
                data, size, size + SPARE, fuzz_draw(dice, UINT32_MAX));
        if (data)
            block = put_back(p, s, part, at, data, size);
    }
    free(data);
    free(s);
    return block;
}

/* ---- libFuzzer's hook --------------------------------------------------- */

/* Returns what is to free. */
static uint8_t *change_something(pieces *p, fuzz_dice *dice, size_t max_size)
{
    const uint32_t way = fuzz_draw(dice, 16);
    if (p->at[0].type == PMESH_CHUNK_SCENE && way < 12)
        return change_part(p, dice, max_size);
    if (way < 10)
        return change(&p->at[fuzz_draw(dice, p->count)]);
    if (way < 12)
        return change(&p->at[0]);
    if (way < 13 && p->rest.size < SPARE)
        return change(&p->rest);
    if (way < 14)
        p->count = 1 + fuzz_draw(dice, p->count);
    else
        reorder(p, dice);
    return NULL;
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size,
                               unsigned seed)
{
    fuzz_dice dice = { seed };
    pieces p;
    if (fuzz_draw(&dice, 16) == 0 || !pieces_take_apart(data, size, &p) ||
        p.count == 0)
        return mutate(data, size, max_size);
    uint8_t *changed = change_something(&p, &dice, max_size);
    uint8_t *out = malloc(max_size);
    const size_t made =
        out ? pieces_put_together(&p, fuzz_draw(&dice, 16) != 0, out, max_size)
            : 0;
    if (made > 0)
        memcpy(data, out, made);
    free(out);
    free(changed);
    return made > 0 ? made : mutate(data, size, max_size);
}
