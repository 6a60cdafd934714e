/* SPDX-License-Identifier: MIT */
#include "tests/fuzz/fuzz.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/unit/shapes.h"

_Noreturn void fuzz_fail(const char *file, int line, const char *condition)
{
    fprintf(stderr, "%s:%d: not so: %s\n", file, line, condition);
    abort();
}

fuzz_dice fuzz_dice_of(const uint8_t *data, size_t size)
{
    fuzz_dice dice = { 0 };
    for (size_t i = size < 8 ? 0 : size - 8; i < size; i++)
        dice.state = dice.state << 8 | data[i];
    return dice;
}

/* splitmix64 (Steele and others 2014): equal states stay apart. */
uint32_t fuzz_draw(fuzz_dice *dice, uint32_t below)
{
    uint64_t z = dice->state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return (uint32_t)(((z ^ z >> 31) >> 32) * below >> 32);
}

void *fuzz_room(size_t size)
{
    void *room = malloc(size);
    FUZZ_CHECK(room || size == 0);
    return room;
}

void *fuzz_copy(const void *data, size_t size)
{
    void *copy = fuzz_room(size);
    if (size > 0)
        memcpy(copy, data, size);
    return copy;
}

/* Stands for Draco: numbers that begin as the bytes do. */
static pmesh_status invent_base(void *user, const void *data, size_t size,
                                uint32_t vertex_count, uint32_t face_count,
                                int32_t *positions, uint32_t *indices)
{
    const uint8_t *byte = data;
    (void)user;
    if (size == 0)
        return PMESH_E_CORRUPT;
    for (size_t i = 0; i < 3 * (size_t)vertex_count; i++)
        positions[i] = byte[i % size] < 250 ? byte[i % size] : -1;
    for (size_t i = 0; i < 3 * (size_t)face_count; i++)
        indices[i] = byte[i % size] < 250
                         ? (byte[i % size] + (uint32_t)(i / size)) % vertex_count
                         : UINT32_MAX - byte[i % size];
    return PMESH_OK;
}

pmesh_decoder_config fuzz_config(void)
{
    pmesh_decoder_config config = pmesh_decoder_config_default();
    config.max_memory = FUZZ_MEMORY;
    config.base_decoder = invent_base;
    return config;
}

pmesh_decoder *fuzz_decode(const uint8_t *data, size_t size,
                           pmesh_status *status)
{
    const pmesh_decoder_config config = fuzz_config();
    pmesh_decoder *dec;
    uint8_t *copy = fuzz_copy(data, size);
    FUZZ_CHECK(pmesh_decoder_create(&dec, &config) == PMESH_OK);
    *status = pmesh_decoder_feed(dec, copy, size);
    free(copy);
    return dec;
}

bool fuzz_same(pmesh_decoder *a, pmesh_decoder *b)
{
    pmesh_decoder_refine(a, NULL, NULL);
    pmesh_decoder_refine(b, NULL, NULL);
    return shape_view_hash(a) == shape_view_hash(b);
}

static void check_names(const pmesh_decoder *dec, uint32_t count)
{
    for (uint32_t i = 0; i < count && i < 100; i++)
        FUZZ_CHECK(strlen(pmesh_decoder_material_name(dec, i)) < SIZE_MAX);
}

static void check_header(const pmesh_header *h)
{
    FUZZ_CHECK(h->grid.step > 0 && h->grid.bits <= 24);
    FUZZ_CHECK(h->level_count > 0 && h->level_count <= PMESH_MAX_LEVELS);
    FUZZ_CHECK(h->attribute_count <= PMESH_MAX_ATTRIBUTES);
    FUZZ_CHECK(h->memory <= (uint64_t)4 << 30);
    FUZZ_CHECK(h->levels[0].faces == h->base_faces);
    for (uint32_t i = 1; i < h->level_count; i++) {
        const pmesh_level *low = &h->levels[i - 1], *high = &h->levels[i];
        FUZZ_CHECK(low->faces <= high->faces && low->bytes <= high->bytes);
        FUZZ_CHECK(low->mesh_vertices < high->mesh_vertices);
        FUZZ_CHECK(low->error >= high->error);
    }
}

void fuzz_sound(const pmesh_decoder *dec)
{
    const pmesh_decode_error error = pmesh_decoder_error(dec);
    const pmesh_progress_state p = pmesh_decoder_progress(dec);
    pmesh_header h;
    pmesh_view v;

    FUZZ_CHECK(error.rule && (error.status < 0) == (*error.rule != 0));
    FUZZ_CHECK(!p.complete || error.status == PMESH_OK);
    if (pmesh_decoder_header(dec, &h) != PMESH_OK) {
        FUZZ_CHECK(pmesh_decoder_mesh(dec, &v) != PMESH_OK && p.levels == 0);
        return;
    }
    check_header(&h);
    check_names(dec, h.material_count);
    FUZZ_CHECK(p.levels <= h.level_count && p.faces <= h.faces);
    FUZZ_CHECK(!p.complete || p.faces == h.faces);
    if (pmesh_decoder_mesh(dec, &v) != PMESH_OK) {
        FUZZ_CHECK(p.levels == 0);
        return;
    }
    FUZZ_CHECK(v.face_count >= h.base_faces && v.face_count <= p.faces);
    FUZZ_CHECK(v.vertex_count <= h.vertices);
    FUZZ_CHECK(v.mesh_vertex_count <= h.mesh_vertices);
    FUZZ_CHECK(shape_view_sound(dec));
}
