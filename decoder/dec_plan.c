/* SPDX-License-Identifier: MIT */
/*
 * dec_plan.c - the choice of levels. Errors fall and sizes grow from level to
 * level, so the first or last that fits is the answer.
 */
#include <stdbool.h>

#include "decoder/pmesh_plan.h"

uint32_t pmesh_plan_error(const pmesh_level *levels, uint32_t count,
                          double error)
{
    uint32_t i = 0;
    while (i + 1 < count && !((double)levels[i].error <= error))
        i++;
    return i;
}

uint32_t pmesh_plan_bytes(const pmesh_level *levels, uint32_t count,
                          uint64_t bytes)
{
    uint32_t i = 0;
    while (i + 1 < count && levels[i + 1].bytes <= bytes)
        i++;
    return i;
}

uint32_t pmesh_plan_faces(const pmesh_level *levels, uint32_t count,
                          uint32_t faces)
{
    uint32_t i = 0;
    while (i + 1 < count && levels[i + 1].faces <= faces)
        i++;
    return i;
}

uint32_t pmesh_plan_pixels(const pmesh_level *levels, uint32_t count,
                           double pixels_per_unit, double pixels,
                           uint32_t current)
{
    if (!(pixels_per_unit > 0))
        return 0;
    const double error = pixels / pixels_per_unit;
    const uint32_t wanted = pmesh_plan_error(levels, count, error);
    if (current >= count || wanted >= current)
        return wanted;
    const uint32_t safe = pmesh_plan_error(levels, count, 0.75 * error);
    return safe < current ? safe : current;
}

/* ---- many meshes ---------------------------------------------------------- */

/*
 * What can still become finer is in a heap, whose head covers the most pixels.
 * It needs no memory: the upper bits of items[i].level are the number of the
 * item at place i of the heap, the lower ones the level of item i.
 */
enum { LEVEL_BITS = 8, MOST_LEVELS = 1 << LEVEL_BITS };
#define MOST_ITEMS (UINT32_MAX >> LEVEL_BITS)

static uint32_t level_of(const pmesh_plan_item *item)
{
    return item->level % MOST_LEVELS;
}

static uint32_t heap_at(const pmesh_plan_item *items, uint32_t place)
{
    return items[place].level >> LEVEL_BITS;
}

static void heap_put(pmesh_plan_item *items, uint32_t place, uint32_t number)
{
    items[place].level = number << LEVEL_BITS | level_of(&items[place]);
}

static double pixels_of(const pmesh_plan_item *item)
{
    return item->pixels_per_unit * (double)item->levels[level_of(item)].error;
}

/* Of equals the first; what covers no number of pixels is in no heap. */
static bool comes_first(const pmesh_plan_item *items, uint32_t a, uint32_t b)
{
    const double x = pixels_of(&items[a]), y = pixels_of(&items[b]);
    return x > y || (x >= y && a < b);
}

/* Moves the item at this place down to its own among the first `count`. */
static void sift(pmesh_plan_item *items, uint32_t place, uint32_t count)
{
    const uint32_t number = heap_at(items, place);
    for (;;) {
        uint32_t next = 2 * place + 1;
        if (next >= count)
            break;
        if (next + 1 < count && comes_first(items, heap_at(items, next + 1),
                                            heap_at(items, next)))
            next++;
        if (!comes_first(items, heap_at(items, next), number))
            break;
        heap_put(items, place, heap_at(items, next));
        place = next;
    }
    heap_put(items, place, number);
}

static bool wants_more(const pmesh_plan_item *item, double pixels)
{
    const uint32_t next = level_of(item) + 1;
    return next < item->level_count && next < MOST_LEVELS &&
           pixels_of(item) > pixels;
}

/* Whether the next level of the item fits into what is left; takes it. */
static bool advance(pmesh_plan_item *item, uint64_t *faces, uint64_t *bytes)
{
    const pmesh_level *now = &item->levels[level_of(item)], *next = now + 1;
    const uint64_t more_faces = next->faces - now->faces;
    const uint64_t more_bytes = next->bytes - now->bytes;
    if (more_faces > *faces || more_bytes > *bytes)
        return false;
    *faces -= more_faces;
    *bytes -= more_bytes;
    item->level++;
    return true;
}

/* What a budget leaves, once base meshes are paid; 0 stands for no limit. */
static uint64_t left_of(uint64_t budget, uint64_t spent)
{
    if (budget == 0)
        return UINT64_MAX;
    return budget > spent ? budget - spent : 0;
}

/* Puts those that want more into the heap; how many there are. */
static uint32_t make_heap(pmesh_plan_item *items, uint32_t count,
                          double pixels)
{
    uint32_t wanting = 0;
    for (uint32_t i = 0; i < count && i <= MOST_ITEMS; i++)
        if (wants_more(&items[i], pixels))
            heap_put(items, wanting++, i);
    for (uint32_t i = wanting / 2; i-- > 0;)
        sift(items, i, wanting);
    return wanting;
}

double pmesh_plan_scene(pmesh_plan_item *items, uint32_t count, double pixels,
                        uint64_t faces, uint64_t bytes)
{
    uint64_t base_faces = 0, base_bytes = 0;
    for (uint32_t i = 0; i < count; i++) {
        items[i].level = 0;
        base_faces += items[i].levels[0].faces;
        base_bytes += items[i].levels[0].bytes;
    }
    faces = left_of(faces, base_faces);
    bytes = left_of(bytes, base_bytes);
    for (uint32_t left = make_heap(items, count, pixels); left > 0;
         sift(items, 0, left)) {
        pmesh_plan_item *worst = &items[heap_at(items, 0)];
        /* One whose next level does not fit stays: others may still fit. */
        if (!advance(worst, &faces, &bytes) || !wants_more(worst, pixels))
            heap_put(items, 0, heap_at(items, --left));
    }
    double largest = 0;
    for (uint32_t i = 0; i < count; i++) {
        items[i].level = level_of(&items[i]);
        const double p = pixels_of(&items[i]);
        largest = p > largest ? p : largest;
    }
    return largest;
}
