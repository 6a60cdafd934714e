/* SPDX-License-Identifier: MIT */
/*
 * enc_order.c - neighbours in space become neighbours in memory. Vertices are
 * numbered along a space-filling curve (Morton), faces by the least of their
 * vertices: whatever order the input has, the encoder's walks stay in the
 * cache.
 */
#include "encoder/enc_import.h"

#include <string.h>

#include "format/alloc.h"

/* Smaller meshes fit into the cache in any order. */
enum { LEAST_FACES = 16384 };

/* Bits of each coordinate that count, and of all three in a pass. */
enum { CURVE_BITS = 10, DIGIT_BITS = 10, DIGITS = 1 << DIGIT_BITS };

typedef struct place {
    uint32_t key, vertex;
} place;

typedef struct orderer {
    enc_importer *im;
    place *list, *spare; /* per vertex */
    uint32_t *vertex;    /* per vertex: its number to be */
    uint32_t *face;      /* likewise, per face */
    uint32_t *start;     /* per vertex and one more: its next face */
} orderer;

/* Two zeros between each bit and the next one. */
static uint32_t spread(uint32_t x)
{
    x = (x | x << 16) & 0x030000ff;
    x = (x | x << 8) & 0x0300f00f;
    x = (x | x << 4) & 0x030c30c3;
    return (x | x << 2) & 0x09249249;
}

static void list_places(orderer *o)
{
    const enc_mesh *mesh = o->im->mesh;
    const unsigned bits = mesh->grid.bits;
    const unsigned shift = bits > CURVE_BITS ? bits - CURVE_BITS : 0;

    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        const int32_t *p = mesh->position[v];
        uint32_t key = 0;
        for (int k = 0; k < 3; k++)
            key |= spread((uint32_t)p[k] >> shift) << k;
        o->list[v] = (place){ key, v };
    }
}

static void sort_digit(const orderer *o, unsigned shift)
{
    const uint32_t count = o->im->mesh->vertex_count;
    uint32_t start[DIGITS] = { 0 }, sum = 0;

    for (uint32_t i = 0; i < count; i++)
        start[o->list[i].key >> shift & (DIGITS - 1)]++;
    for (unsigned d = 0; d < DIGITS; d++) {
        const uint32_t n = start[d];
        start[d] = sum;
        sum += n;
    }
    for (uint32_t i = 0; i < count; i++)
        o->spare[start[o->list[i].key >> shift & (DIGITS - 1)]++] = o->list[i];
}

/* Vertices of one key stay in the order they have. */
static void rank_vertices(orderer *o)
{
    list_places(o);
    for (unsigned shift = 0; shift < 3 * CURVE_BITS; shift += DIGIT_BITS) {
        place *sorted = o->spare;
        sort_digit(o, shift);
        o->spare = o->list;
        o->list = sorted;
    }
    for (uint32_t i = 0; i < o->im->mesh->vertex_count; i++)
        o->vertex[o->list[i].vertex] = i;
}

static uint32_t least_vertex(const enc_mesh *mesh, uint32_t face)
{
    const uint32_t *v = mesh->vertex + 3 * (size_t)face;
    const uint32_t least = v[0] < v[1] ? v[0] : v[1];

    return least < v[2] ? least : v[2];
}

/* Faces of one vertex stay in the order they have. */
static void sort_faces(orderer *o)
{
    const enc_mesh *mesh = o->im->mesh;

    for (uint32_t c = 0; c < 3 * mesh->face_count; c++)
        mesh->vertex[c] = o->vertex[mesh->vertex[c]];
    memset(o->start, 0, (mesh->vertex_count + (size_t)1) * sizeof *o->start);
    for (uint32_t f = 0; f < mesh->face_count; f++)
        o->start[least_vertex(mesh, f) + 1]++;
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        o->start[v + 1] += o->start[v];
    for (uint32_t f = 0; f < mesh->face_count; f++)
        o->face[f] = o->start[least_vertex(mesh, f)]++;
}

/* Releases `items`, of which the i-th becomes the one of number to[i]; NULL if
 * memory is out, or there were none. */
static void *move_items(const pmesh_allocator *a, void *items, size_t size,
                        uint32_t count, const uint32_t *to)
{
    unsigned char *moved = items ? pmesh_alloc(a, count, size) : NULL;

    for (uint32_t i = 0; moved && i < count; i++)
        memcpy(moved + to[i] * size, (unsigned char *)items + i * size, size);
    pmesh_release(a, items, count, size);
    return moved;
}

static bool move_all(const orderer *o)
{
    enc_importer *im = o->im;
    enc_mesh *m = im->mesh;
    const pmesh_allocator *a = &m->allocator;
    const uint32_t n = m->vertex_count, faces = m->face_count;
    const bool exact = m->exact, asked = m->source, dyed = m->material;

    for (uint32_t v = 0; v < im->in->vertex_count; v++)
        if (im->number[v] != ENC_NONE)
            im->number[v] = o->vertex[im->number[v]];
    m->position = move_items(a, m->position, sizeof *m->position, n, o->vertex);
    m->exact = move_items(a, m->exact, sizeof *m->exact, n, o->vertex);
    m->source = move_items(a, m->source, sizeof *m->source, n, o->vertex);
    m->vertex = move_items(a, m->vertex, 3 * sizeof *m->vertex, faces, o->face);
    m->material =
        move_items(a, m->material, sizeof *m->material, faces, o->face);
    im->source = move_items(a, im->source, sizeof *im->source, faces, o->face);
    return m->position && m->vertex && im->source && exact == !!m->exact &&
           asked == !!m->source && dyed == !!m->material;
}

pmesh_status enc_order(enc_importer *im)
{
    const pmesh_allocator *a = &im->mesh->allocator;
    const size_t n = im->mesh->vertex_count, faces = im->mesh->face_count;
    orderer o = { .im = im };
    bool good = true;

    if (faces < LEAST_FACES)
        return PMESH_OK;
    o.list = pmesh_alloc(a, n, sizeof *o.list);
    o.spare = pmesh_alloc(a, n, sizeof *o.spare);
    o.vertex = pmesh_alloc(a, n, sizeof *o.vertex);
    o.face = pmesh_alloc(a, faces, sizeof *o.face);
    o.start = pmesh_alloc(a, n + 1, sizeof *o.start);
    good = o.list && o.spare && o.vertex && o.face && o.start;
    if (good) {
        rank_vertices(&o);
        sort_faces(&o);
        good = move_all(&o);
    }
    pmesh_release(a, o.list, n, sizeof *o.list);
    pmesh_release(a, o.spare, n, sizeof *o.spare);
    pmesh_release(a, o.vertex, n, sizeof *o.vertex);
    pmesh_release(a, o.face, faces, sizeof *o.face);
    pmesh_release(a, o.start, n + 1, sizeof *o.start);
    return good ? PMESH_OK : PMESH_E_MEMORY;
}
