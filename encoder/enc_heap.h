/* SPDX-License-Identifier: MIT */
/*
 * enc_heap.h - a heap of numbered items whose costs may change. Equal costs
 * come in the order of the numbers, so the order is total.
 */
#ifndef ENC_HEAP_H
#define ENC_HEAP_H

#include <stdbool.h>

#include "format/pmesh.h"

typedef struct enc_heap_entry {
    double cost;
    uint32_t item;
} enc_heap_entry;

typedef struct enc_heap {
    pmesh_allocator allocator;
    uint32_t capacity, count;
    enc_heap_entry *entry;
    uint32_t *place; /* per item: its entry, or UINT32_MAX */
} enc_heap;

pmesh_status enc_heap_create(const pmesh_allocator *allocator,
                             uint32_t capacity, enc_heap *out);
void enc_heap_destroy(enc_heap *heap);

/* Puts the item in, or moves it if it is there. cost: not NaN. */
void enc_heap_put(enc_heap *heap, uint32_t item, double cost);
/* Nothing happens if it is not there. */
void enc_heap_remove(enc_heap *heap, uint32_t item);
/* Takes the cheapest; false if there is none. */
bool enc_heap_pop(enc_heap *heap, enc_heap_entry *out);

#endif
