/* SPDX-License-Identifier: MIT */
/*
 * enc_queue.h - the candidates of a batch in the order of their keys: a list,
 * sorted once, and beside it a heap for those whose key changes later.
 */
#ifndef ENC_QUEUE_H
#define ENC_QUEUE_H

#include <stdbool.h>

#include "format/pmesh.h"

typedef struct enc_entry {
    uint32_t key; /* see enc_key() */
    uint32_t id;
} enc_entry;

typedef struct enc_queue {
    pmesh_allocator allocator;
    enc_entry *list;
    enc_entry *heap; /* the sort's second buffer, until the list is sorted */
    uint32_t capacity, list_count, list_next, heap_count;
} enc_queue;

/* Bits of a float order like unsigned integers if it is not negative; the sign
 * is free to mean "behind all others". */
#define ENC_KEY_LAST 0x80000000u

uint32_t enc_key(double cost); /* cost >= 0, not NaN; saturates */
double enc_key_cost(uint32_t key);

pmesh_status enc_queue_create(const pmesh_allocator *allocator,
                              uint32_t capacity, enc_queue *out);
void enc_queue_destroy(enc_queue *queue);

/* So many bytes that nobody else needs until the list is sorted, or NULL if
 * that is too much. What they held is lost. */
void *enc_queue_scratch(enc_queue *queue, size_t size);

void enc_queue_clear(enc_queue *queue);
/* At most `capacity` of these between clear and sort. */
void enc_queue_add(enc_queue *queue, enc_entry entry);
/* Equal keys stay in the order in which they were added. */
void enc_queue_sort(enc_queue *queue);
/* The cost in the middle of the sorted list; 0 if it is empty. */
double enc_queue_median(const enc_queue *queue);
/* From then on; the entry is dropped if the heap is full. */
void enc_queue_push(enc_queue *queue, enc_entry entry);
/* Takes the entry of the least key; false if there is none. */
bool enc_queue_pop(enc_queue *queue, enc_entry *out);

#endif
