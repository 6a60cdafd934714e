/* SPDX-License-Identifier: MIT */
/*
 * enc_match.c - one face of each piece is found by its corners' positions, the
 * others follow over their edges. Where faces lie upon each other the first
 * find may be the wrong one: then the piece is taken back, and the next tried.
 */
#include "encoder/enc_match.h"

#include <string.h>

#include "format/alloc.h"

/* Faces and table slots looked at, per half-edge, before the search is given
 * up; without faces upon each other it takes about 2. */
enum { PATIENCE = 64 };

typedef struct match {
    const pmesh_mesh *mesh, *copy;
    uint32_t *edge_of; /* copy -> mesh */
    uint32_t *back;    /* mesh -> copy */
    uint32_t *queue;   /* the copy's faces of the piece */
    uint32_t count;    /* of them */
    uint32_t *table;   /* positions of a face -> half-edges of the mesh */
    uint64_t mask;
    uint64_t patience;
} match;

static const int32_t *start_of(const pmesh_mesh *m, uint32_t h)
{
    return m->position[m->vertex[h]];
}

static bool same_face(const match *m, uint32_t h, uint32_t o)
{
    for (int i = 0; i < 3; i++, h = pmesh_next(h), o = pmesh_next(o))
        if (memcmp(start_of(m->copy, h), start_of(m->mesh, o),
                   sizeof *m->copy->position) != 0)
            return false;
    return true;
}

static uint64_t slot_of(const match *m, const pmesh_mesh *mesh, uint32_t h)
{
    uint64_t key = 0;
    for (int i = 0; i < 3; i++, h = pmesh_next(h))
        for (int k = 0; k < 3; k++)
            key = (key ^ (uint32_t)start_of(mesh, h)[k]) *
                  0x9e3779b97f4a7c15u;
    return key >> 20 & m->mask;
}

static bool spend(match *m)
{
    if (m->patience == 0)
        return false;
    m->patience--;
    return true;
}

/* Lays the copy's face at half-edge h upon the mesh's at o. */
static bool lay(match *m, uint32_t h, uint32_t o)
{
    if (m->edge_of[h] != PMESH_NONE || m->back[o] != PMESH_NONE ||
        !same_face(m, h, o) || !spend(m))
        return false;
    m->queue[m->count++] = h / 3;
    for (int i = 0; i < 3; i++, h = pmesh_next(h), o = pmesh_next(o)) {
        m->edge_of[h] = o;
        m->back[o] = h;
    }
    return true;
}

/* Whether what lies across h fits what lies across its half-edge of the mesh;
 * faces not laid yet are. */
static bool cross(match *m, uint32_t h)
{
    const uint32_t twin = m->copy->twin[h];
    const uint32_t across = m->mesh->twin[m->edge_of[h]];
    if (twin == PMESH_NONE || across == PMESH_NONE)
        return twin == across;
    return m->edge_of[twin] == across || lay(m, twin, across);
}

static void take_back(match *m)
{
    for (uint32_t i = 0; i < m->count; i++)
        for (uint32_t h = 3 * m->queue[i]; h < 3 * m->queue[i] + 3; h++) {
            m->back[m->edge_of[h]] = PMESH_NONE;
            m->edge_of[h] = PMESH_NONE;
        }
}

/* The whole piece at h, upon the one at o. */
static bool match_piece(match *m, uint32_t h, uint32_t o)
{
    m->count = 0;
    bool fits = lay(m, h, o);
    for (uint32_t i = 0; fits && i < m->count; i++)
        for (uint32_t k = 0; fits && k < 3; k++)
            fits = cross(m, 3 * m->queue[i] + k);
    if (!fits)
        take_back(m);
    return fits;
}

static bool find_piece(match *m, uint32_t h)
{
    for (uint64_t slot = slot_of(m, m->copy, h);
         m->table[slot] != PMESH_NONE && spend(m);
         slot = (slot + 1) & m->mask)
        if (match_piece(m, h, m->table[slot]))
            return true;
    return false;
}

static bool list_faces(match *m)
{
    for (uint32_t h = 0; h < 3 * m->mesh->face_count; h++) {
        uint64_t slot = slot_of(m, m->mesh, h);
        while (m->table[slot] != PMESH_NONE) {
            slot = (slot + 1) & m->mask;
            if (!spend(m))
                return false;
        }
        m->table[slot] = h;
    }
    return true;
}

static bool match_all(match *m)
{
    if (!list_faces(m))
        return false;
    for (uint32_t h = 0; h < 3 * m->copy->face_count; h += 3)
        if (m->edge_of[h] == PMESH_NONE && !find_piece(m, h))
            return false;
    return true;
}

pmesh_status enc_match(const pmesh_allocator *a, const pmesh_mesh *mesh,
                       const pmesh_mesh *copy, uint32_t *edge_of, bool *same)
{
    const uint32_t faces = mesh->face_count;
    const size_t edges = 3 * (size_t)faces;
    size_t slots = 64;
    while (slots < 2 * edges)
        slots *= 2;
    *same = false;
    if (copy->face_count != faces || copy->vertex_count != mesh->vertex_count)
        return PMESH_OK;

    match m = { .mesh = mesh, .copy = copy, .edge_of = edge_of,
                .mask = slots - 1, .patience = PATIENCE * (uint64_t)edges };
    m.back = pmesh_alloc(a, edges, sizeof *m.back);
    m.queue = pmesh_alloc(a, faces, sizeof *m.queue);
    m.table = pmesh_alloc(a, slots, sizeof *m.table);
    const bool ready = m.back && m.queue && m.table;
    if (ready) {
        memset(edge_of, 0xff, edges * sizeof *edge_of);
        memset(m.back, 0xff, edges * sizeof *m.back);
        memset(m.table, 0xff, slots * sizeof *m.table);
        *same = match_all(&m);
    }
    pmesh_release(a, m.back, edges, sizeof *m.back);
    pmesh_release(a, m.queue, faces, sizeof *m.queue);
    pmesh_release(a, m.table, slots, sizeof *m.table);
    return ready ? PMESH_OK : PMESH_E_MEMORY;
}
