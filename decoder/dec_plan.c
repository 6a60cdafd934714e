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

static double pixels_of(const pmesh_plan_item *item)
{
    return item->pixels_per_unit * (double)item->levels[item->level].error;
}

/* Whether the next level of the item fits into what is left; takes it. */
static bool advance(pmesh_plan_item *item, uint64_t *faces, uint64_t *bytes)
{
    const pmesh_level *now = &item->levels[item->level], *next = now + 1;
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

/* A mesh whose next level did not fit has the top bit of `level` set until
 * the end: others may still fit. */
#define STUCK 0x80000000u

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
    for (;;) {
        pmesh_plan_item *worst = NULL;
        for (uint32_t i = 0; i < count; i++)
            if (!(items[i].level & STUCK) &&
                items[i].level + 1 < items[i].level_count &&
                pixels_of(&items[i]) > (worst ? pixels_of(worst) : pixels))
                worst = &items[i];
        if (!worst)
            break;
        if (!advance(worst, &faces, &bytes))
            worst->level |= STUCK;
    }
    double largest = 0;
    for (uint32_t i = 0; i < count; i++) {
        items[i].level &= ~STUCK;
        const double p = pixels_of(&items[i]);
        largest = p > largest ? p : largest;
    }
    return largest;
}
