/* SPDX-License-Identifier: MIT */
#include "encoder/enc_queue.h"

#include <float.h>
#include <string.h>

#include "format/alloc.h"

enum { DIGIT_BITS = 11, DIGITS = 1 << DIGIT_BITS };

uint32_t enc_key(double cost)
{
    const float value = cost < (double)FLT_MAX ? (float)cost : FLT_MAX;
    uint32_t key;

    memcpy(&key, &value, sizeof key);
    return key;
}

double enc_key_cost(uint32_t key)
{
    float value;

    key &= ~ENC_KEY_LAST;
    memcpy(&value, &key, sizeof value);
    return (double)value;
}

pmesh_status enc_queue_create(const pmesh_allocator *allocator,
                              uint32_t capacity, enc_queue *out)
{
    *out = (enc_queue){ .allocator = *allocator, .capacity = capacity };
    out->list = pmesh_alloc(allocator, capacity, sizeof *out->list);
    out->heap = pmesh_alloc(allocator, capacity, sizeof *out->heap);
    if (!out->list || !out->heap) {
        enc_queue_destroy(out);
        return PMESH_E_MEMORY;
    }
    return PMESH_OK;
}

void enc_queue_destroy(enc_queue *q)
{
    pmesh_release(&q->allocator, q->list, q->capacity, sizeof *q->list);
    pmesh_release(&q->allocator, q->heap, q->capacity, sizeof *q->heap);
    *q = (enc_queue){ 0 };
}

void *enc_queue_scratch(enc_queue *q, size_t size)
{
    return size <= q->capacity * sizeof *q->heap ? q->heap : NULL;
}

void enc_queue_clear(enc_queue *q)
{
    q->list_count = q->list_next = q->heap_count = 0;
}

void enc_queue_add(enc_queue *q, enc_entry entry)
{
    q->list[q->list_count++] = entry;
}

static void sort_digit(const enc_entry *from, enc_entry *to, uint32_t count,
                       unsigned shift)
{
    uint32_t start[DIGITS] = { 0 }, sum = 0;

    for (uint32_t i = 0; i < count; i++)
        start[from[i].key >> shift & (DIGITS - 1)]++;
    for (unsigned d = 0; d < DIGITS; d++) {
        const uint32_t n = start[d];
        start[d] = sum;
        sum += n;
    }
    for (uint32_t i = 0; i < count; i++)
        to[start[from[i].key >> shift & (DIGITS - 1)]++] = from[i];
}

void enc_queue_sort(enc_queue *q)
{
    for (unsigned shift = 0; shift < 32; shift += DIGIT_BITS) {
        enc_entry *sorted = q->heap;
        sort_digit(q->list, sorted, q->list_count, shift);
        q->heap = q->list;
        q->list = sorted;
    }
}

double enc_queue_median(const enc_queue *q)
{
    return q->list_count ? enc_key_cost(q->list[q->list_count / 2].key) : 0;
}

static bool less(enc_entry a, enc_entry b)
{
    return a.key != b.key ? a.key < b.key : a.id < b.id;
}

void enc_queue_push(enc_queue *q, enc_entry entry)
{
    if (q->heap_count == q->capacity)
        return;
    uint32_t i = q->heap_count++;
    while (i > 0 && less(entry, q->heap[(i - 1) / 2])) {
        q->heap[i] = q->heap[(i - 1) / 2];
        i = (i - 1) / 2;
    }
    q->heap[i] = entry;
}

static enc_entry heap_take(enc_queue *q)
{
    const enc_entry top = q->heap[0], moved = q->heap[--q->heap_count];
    const uint32_t count = q->heap_count;
    uint32_t i = 0;

    for (;;) {
        uint32_t child = 2 * i + 1;
        if (child >= count)
            break;
        if (child + 1 < count && less(q->heap[child + 1], q->heap[child]))
            child++;
        if (!less(q->heap[child], moved))
            break;
        q->heap[i] = q->heap[child];
        i = child;
    }
    q->heap[i] = moved;
    return top;
}

bool enc_queue_pop(enc_queue *q, enc_entry *out)
{
    const bool listed = q->list_next < q->list_count;

    if (q->heap_count > 0 &&
        (!listed || less(q->heap[0], q->list[q->list_next]))) {
        *out = heap_take(q);
        return true;
    }
    if (listed)
        *out = q->list[q->list_next++];
    return listed;
}
