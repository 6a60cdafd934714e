/* SPDX-License-Identifier: MIT */
/*
 * hash.h - finds equal things among things numbered 0, 1, 2, ...
 *
 * The table holds numbers and hashes only; the owner compares:
 *
 *   if (!hash_reserve(&table))
 *       return no_memory;
 *   size_t i = hash_first(&table, hash);
 *   for (; table.slots[i].id != HASH_EMPTY; i = hash_next(&table, i))
 *       if (table.slots[i].hash == hash && same(table.slots[i].id, thing))
 *           return table.slots[i].id;
 *   hash_put(&table, i, hash, new_id);
 */
#ifndef HASH_H
#define HASH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define HASH_EMPTY UINT32_MAX

typedef struct hash_slot {
    uint32_t id, hash;
} hash_slot;

typedef struct hash_table {
    hash_slot *slots;
    size_t capacity; /* 0 or a power of two */
    size_t count;
} hash_table;

static inline size_t hash_first(const hash_table *table, uint32_t hash)
{
    return hash & (table->capacity - 1);
}

static inline size_t hash_next(const hash_table *table, size_t i)
{
    return (i + 1) & (table->capacity - 1);
}

static inline void hash_put(hash_table *table, size_t i, uint32_t hash,
                            uint32_t id)
{
    table->slots[i] = (hash_slot){ id, hash };
    table->count++;
}

/* Makes room for one more; at least half of the slots stay empty. */
static inline bool hash_reserve(hash_table *table)
{
    if (table->count < table->capacity / 2)
        return true;
    const size_t capacity = table->capacity ? table->capacity * 2 : 64;
    hash_table next = { .capacity = capacity };
    if (capacity > SIZE_MAX / sizeof *next.slots)
        return false;
    next.slots = malloc(next.capacity * sizeof *next.slots);
    if (!next.slots)
        return false;
    for (size_t i = 0; i < next.capacity; i++)
        next.slots[i].id = HASH_EMPTY;
    for (size_t i = 0; i < table->capacity; i++) {
        const hash_slot slot = table->slots[i];
        if (slot.id == HASH_EMPTY)
            continue;
        size_t to = hash_first(&next, slot.hash);
        while (next.slots[to].id != HASH_EMPTY)
            to = hash_next(&next, to);
        hash_put(&next, to, slot.hash, slot.id);
    }
    free(table->slots);
    *table = next;
    return true;
}

static inline uint32_t hash_bytes(const void *data, size_t size)
{
    const unsigned char *p = data;
    uint64_t h = 0x9E3779B97F4A7C15u ^ size;
    for (; size >= 8; p += 8, size -= 8) {
        uint64_t word;
        memcpy(&word, p, 8);
        h = (h ^ word) * 0xD6E8FEB86659FD93u;
        h ^= h >> 32;
    }
    for (; size; p++, size--)
        h = (h ^ *p) * 0xD6E8FEB86659FD93u;
    h ^= h >> 32;
    h *= 0xD6E8FEB86659FD93u;
    return (uint32_t)(h >> 32);
}

#endif
