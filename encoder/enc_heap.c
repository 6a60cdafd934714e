/* SPDX-License-Identifier: MIT */
#include "encoder/enc_heap.h"

#include <string.h>

#include "format/alloc.h"

#define ABSENT UINT32_MAX

pmesh_status enc_heap_create(const pmesh_allocator *allocator,
                             uint32_t capacity, enc_heap *out)
{
    *out = (enc_heap){ .allocator = *allocator, .capacity = capacity };
    out->entry = pmesh_alloc(allocator, capacity, sizeof *out->entry);
    out->place = pmesh_alloc(allocator, capacity, sizeof *out->place);
    if (!out->entry || !out->place) {
        enc_heap_destroy(out);
        return PMESH_E_MEMORY;
    }
    memset(out->place, 0xff, capacity * sizeof *out->place);
    return PMESH_OK;
}

void enc_heap_destroy(enc_heap *heap)
{
    if (!heap->allocator.release)
        return;
    pmesh_release(&heap->allocator, heap->entry, heap->capacity,
                  sizeof *heap->entry);
    pmesh_release(&heap->allocator, heap->place, heap->capacity,
                  sizeof *heap->place);
    *heap = (enc_heap){ 0 };
}

static bool less(enc_heap_entry a, enc_heap_entry b)
{
    return a.cost < b.cost || (!(b.cost < a.cost) && a.item < b.item);
}

static void settle(enc_heap *heap, uint32_t at, enc_heap_entry entry)
{
    heap->entry[at] = entry;
    heap->place[entry.item] = at;
}

static void sift(enc_heap *heap, uint32_t at, enc_heap_entry entry)
{
    while (at > 0 && less(entry, heap->entry[(at - 1) / 2])) {
        settle(heap, at, heap->entry[(at - 1) / 2]);
        at = (at - 1) / 2;
    }
    for (;;) {
        uint32_t child = 2 * at + 1;
        if (child >= heap->count)
            break;
        if (child + 1 < heap->count &&
            less(heap->entry[child + 1], heap->entry[child]))
            child++;
        if (!less(heap->entry[child], entry))
            break;
        settle(heap, at, heap->entry[child]);
        at = child;
    }
    settle(heap, at, entry);
}

void enc_heap_put(enc_heap *heap, uint32_t item, double cost)
{
    uint32_t at = heap->place[item];

    if (at == ABSENT)
        at = heap->count++;
    sift(heap, at, (enc_heap_entry){ cost, item });
}

void enc_heap_remove(enc_heap *heap, uint32_t item)
{
    const uint32_t at = heap->place[item];

    if (at == ABSENT)
        return;
    heap->place[item] = ABSENT;
    const enc_heap_entry moved = heap->entry[--heap->count];
    if (moved.item != item)
        sift(heap, at, moved);
}

bool enc_heap_pop(enc_heap *heap, enc_heap_entry *out)
{
    if (heap->count == 0)
        return false;
    *out = heap->entry[0];
    enc_heap_remove(heap, out->item);
    return true;
}
