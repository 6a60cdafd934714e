/* SPDX-License-Identifier: MIT */
#include "format/rank.h"

#include <string.h>

enum { DIGIT_BITS = 8, DIGITS = 1 << DIGIT_BITS };

uint64_t pmesh_rank_scratch(const pmesh_codec_sizes *sizes)
{
    const uint64_t faces = pmesh_block_faces(sizes);
    uint64_t most = sizes->block_splits;
    most = most > faces ? most : faces;
    return most > sizes->block_wedges ? most : sizes->block_wedges;
}

/* A 16-bit key that grows with value: 5 bits of exponent, 11 of mantissa. */
static uint32_t float_key(uint32_t value)
{
    uint32_t exponent = 0;
    while (value >= 4096) {
        value >>= 1;
        exponent++;
    }
    return value < 2048 ? value : ((exponent + 1) << 11) + (value - 2048);
}

/* child_order = the splits, most important first: a stable radix sort on the
 * complement of the key, two digits. */
static void sort_children(pmesh_codec *c)
{
    const uint32_t n = c->block.vertex_count;
    uint32_t *source = c->scratch, *target = c->child_order;
    for (uint32_t i = 0; i < n; i++) {
        c->importance[i] = 0xffff - float_key(c->importance[i]);
        source[i] = i;
    }
    for (unsigned shift = 0; shift < 2 * DIGIT_BITS; shift += DIGIT_BITS) {
        uint32_t start[DIGITS + 1] = { 0 };
        for (uint32_t i = 0; i < n; i++)
            start[(c->importance[i] >> shift & (DIGITS - 1)) + 1]++;
        for (uint32_t d = 0; d < DIGITS; d++)
            start[d + 1] += start[d];
        for (uint32_t i = 0; i < n; i++) {
            const uint32_t k = source[i];
            target[start[c->importance[k] >> shift & (DIGITS - 1)]++] = k;
        }
        uint32_t *swap = source;
        source = target;
        target = swap;
    }
    memcpy(c->child_order, source, n * sizeof *source);
}

/* Reorders `count` items of `size` bytes: item i comes from order[i]. By columns
 * of `unit` <= 4 bytes, by way of the scratch: no copy waits for another. */
static inline void permute(pmesh_codec *c, void *items, uint32_t count,
                           const uint32_t *order, size_t size, size_t unit)
{
    uint8_t *at = (uint8_t *)items, *spare = (uint8_t *)c->scratch;
    for (size_t k = 0; k < size; k += unit) {
        for (uint32_t i = 0; i < count; i++)
            memcpy(spare + i * unit, at + order[i] * size + k, unit);
        for (uint32_t i = 0; i < count; i++)
            memcpy(at + i * size + k, spare + i * unit, unit);
    }
}

/* `each` numbers make up an item. */
static inline void permute_numbers(pmesh_codec *c, uint32_t *items,
                                   uint32_t count, const uint32_t *order,
                                   size_t each)
{
    permute(c, items, count, order, each * sizeof *items, sizeof *items);
}

static void rename_corners(pmesh_codec *c, uint32_t v, uint32_t name)
{
    pmesh_mesh *m = &c->mesh;
    uint32_t start = m->first[v];
    pmesh_ring ring;
    if (!m->fan && pmesh_ring_list_edges(m, v, c->near[v].degree, &ring)) {
        for (uint32_t i = 0; i < ring.face_count; i++)
            m->vertex[ring.edge[i]] = name;
        return;
    }
    for (uint32_t h = start; h != PMESH_NONE;
         h = pmesh_corner_next(m, &start, h))
        m->vertex[h] = name;
}

/* Names the children by rank in every half-edge that starts at them. */
static void rename_children(pmesh_codec *c)
{
    pmesh_mesh *m = &c->mesh;
    const uint32_t first = c->block.vertex, n = c->block.vertex_count;
    uint32_t *rank = c->scratch;
    for (uint32_t i = 0; i < n; i++)
        rank[c->child_order[i]] = i;
    for (uint32_t k = 0; k < n; k++) /* in coding order lie the faces */
        rename_corners(c, first + k, first + rank[k]);
    permute_numbers(c, m->first + first, n, c->child_order, 1);
    permute_numbers(c, m->parent + first, n, c->child_order, 1);
    permute(c, c->near + first, n, c->child_order, sizeof *c->near, 4);
    permute(c, m->position + first, n, c->child_order, sizeof *m->position, 4);
    if (c->sizes.moves)
        permute(c, c->unsplit, n, c->child_order, sizeof *c->unsplit, 4);
}

static void mark_faces(pmesh_codec *c, uint32_t vertex, uint32_t faces)
{
    if (vertex % PMESH_FACE_MARK == 0)
        c->faces_before[vertex / PMESH_FACE_MARK] = faces;
}

/* face_order from child_order, and what each split makes; uses child_face in
 * coding order and leaves it in the new order and numbering. */
static void order_faces(pmesh_codec *c)
{
    const pmesh_block *b = &c->block;
    uint32_t face = 0, *start = c->scratch;
    for (uint32_t i = 0; i < b->vertex_count; i++) {
        const uint32_t k = c->child_order[i];
        const uint32_t end = k + 1 < b->vertex_count ? c->child_face[k + 1]
                                                     : b->face + b->face_count;
        start[i] = b->face + face;
        mark_faces(c, b->vertex + i, start[i]);
        c->made_faces[b->vertex + i] = (uint8_t)(end - c->child_face[k]);
        for (uint32_t f = c->child_face[k]; f < end; f++)
            c->face_order[face++] = f - b->face;
    }
    mark_faces(c, b->vertex + b->vertex_count, b->face + face);
    memcpy(c->child_face, start, b->vertex_count * sizeof *start);
}

/* Where the fans of the corners of new faces start: such a vertex may have
 * several, and several such corners, but is done once. */
static void rename_fans(pmesh_codec *c, const uint32_t *now)
{
    enum { DONE = 0x80 }; /* beside the state */
    pmesh_mesh *m = &c->mesh;
    const uint32_t edge = 3 * c->block.face, n = 3 * c->block.face_count;
    for (uint32_t h = edge; h < edge + n; h++) {
        const uint32_t v = m->vertex[h];
        uint32_t *at = &m->first[v];
        if (c->state[v] & DONE)
            continue;
        c->state[v] |= DONE;
        while (*at != PMESH_NONE) {
            const uint32_t old = *at;
            if (old >= edge)
                *at = 3 * now[(old - edge) / 3] + old % 3;
            at = &m->fan[old];
        }
    }
    for (uint32_t h = edge; h < edge + n; h++)
        c->state[m->vertex[h]] &= DONE - 1;
}

/* The same of vertices that have one: it starts at one of these corners or at
 * an older one. New numbers are marked until all are given. */
static void rename_starts(pmesh_codec *c, const uint32_t *now)
{
    const uint32_t given = UINT32_C(1) << 31;
    pmesh_mesh *m = &c->mesh;
    const uint32_t edge = 3 * c->block.face, n = 3 * c->block.face_count;
    for (uint32_t h = edge; h < edge + n; h++) {
        uint32_t *at = &m->first[m->vertex[h]];
        const uint32_t to = 3 * now[(h - edge) / 3] + h % 3;
        *at = *at == h ? to | given : *at;
    }
    for (uint32_t h = edge; h < edge + n; h++)
        m->first[m->vertex[h]] &= ~given;
}

static void rename_twins(pmesh_codec *c, const uint32_t *now)
{
    pmesh_mesh *m = &c->mesh;
    const uint32_t edge = 3 * c->block.face, n = 3 * c->block.face_count;
    for (uint32_t h = edge; h < edge + n; h++) {
        const uint32_t t = m->twin[h];
        if (t == PMESH_NONE)
            continue;
        const bool inside = t >= edge; /* as often as not */
        const uint32_t old = inside ? t : h;
        const uint32_t to = 3 * now[(old - edge) / 3] + old % 3;
        m->twin[inside ? h : t] = to;
    }
}

static void rename_faces(pmesh_codec *c)
{
    pmesh_mesh *m = &c->mesh;
    const uint32_t begin = c->block.face, n = c->block.face_count;
    const uint32_t edge = 3 * begin;
    const uint32_t *order = c->face_order;
    uint32_t *now = c->scratch;

    for (uint32_t i = 0; i < n; i++)
        now[order[i]] = begin + i;
    if (m->fan)
        rename_fans(c, now);
    else
        rename_starts(c, now);
    rename_twins(c, now);
    permute_numbers(c, m->vertex + edge, n, order, 3);
    permute_numbers(c, m->twin + edge, n, order, 3);
    if (m->fan)
        permute_numbers(c, m->fan + edge, n, order, 3);
    if (m->wedge)
        permute_numbers(c, m->wedge + edge, n, order, 3);
    if (m->material)
        permute_numbers(c, m->material + begin, n, order, 1);
}

/* Gives w a number if it is the block's and has none. */
static void count_wedge(uint32_t *number, const pmesh_block *b, uint32_t w,
                        uint32_t *next)
{
    if (w != PMESH_NONE && w >= b->wedge && number[w - b->wedge] == PMESH_NONE)
        number[w - b->wedge] = (*next)++;
}

/* Wedges in the order in which the splits, by rank, first show them. */
static void number_wedges(pmesh_codec *c, uint32_t *number)
{
    const pmesh_mesh *m = &c->mesh;
    const pmesh_block *b = &c->block;
    uint32_t next = b->wedge;
    for (uint32_t i = 0; i < b->wedge_count; i++)
        number[i] = PMESH_NONE;
    for (uint32_t u = b->vertex; u < b->vertex + b->vertex_count; u++) {
        const uint32_t face = c->child_face[u - b->vertex];
        const uint32_t end = face + c->made_faces[u];
        for (uint32_t h = 3 * face; h < 3 * end; h++)
            count_wedge(number, b, pmesh_birth_wedge(m, h, u), &next);
        uint32_t start = m->first[u];
        for (uint32_t h = start; h != PMESH_NONE;
             h = pmesh_corner_next(m, &start, h))
            if (h < 3 * face)
                count_wedge(number, b, m->wedge[h], &next);
        c->wedge_end[u] = next;
    }
    /* Some are seen only in orders that did not happen. */
    for (uint32_t i = 0; i < b->wedge_count; i++)
        count_wedge(number, b, b->wedge + i, &next);
    c->wedge_end[b->vertex + b->vertex_count - 1] = next;
}

static uint32_t renamed(const uint32_t *number, const pmesh_block *b,
                        uint32_t w)
{
    return w == PMESH_NONE || w < b->wedge ? w : number[w - b->wedge];
}

/* Takes the block's wedges out of their vertices' lists. */
static void unlist_wedges(pmesh_codec *c)
{
    const pmesh_mesh *m = &c->mesh;
    const pmesh_block *b = &c->block;
    for (uint32_t w = b->wedge; w < m->wedge_count; w++) {
        uint32_t *last = &c->wedge_last[m->wedge_vertex[w]];
        while (*last != PMESH_NONE && *last >= b->wedge)
            *last = c->wedge_before[*last];
    }
}

static void list_wedges(pmesh_codec *c)
{
    const pmesh_mesh *m = &c->mesh;
    for (uint32_t w = c->block.wedge; w < m->wedge_count; w++) {
        c->wedge_before[w] = c->wedge_last[m->wedge_vertex[w]];
        c->wedge_last[m->wedge_vertex[w]] = w;
    }
}

static void rename_wedges(pmesh_codec *c)
{
    pmesh_mesh *m = &c->mesh;
    const pmesh_block *b = &c->block;
    uint32_t *number = c->scratch;

    unlist_wedges(c);
    number_wedges(c, number);
    for (uint32_t i = 0; i < b->wedge_count; i++)
        c->wedge_order[number[i] - b->wedge] = i;
    /* Corners that may have a wedge of the block: those of its faces, and of
     * the faces around its vertices. */
    for (uint32_t h = 3 * b->face; h < 3 * (b->face + b->face_count); h++)
        m->wedge[h] = renamed(number, b, m->wedge[h]);
    for (uint32_t u = b->vertex; u < b->vertex + b->vertex_count; u++) {
        uint32_t start = m->first[u];
        for (uint32_t h = start; h != PMESH_NONE;
             h = pmesh_corner_next(m, &start, h))
            if (h < 3 * b->face)
                m->wedge[h] = renamed(number, b, m->wedge[h]);
    }
    for (uint32_t w = b->wedge; w < b->wedge + b->wedge_count; w++)
        m->wedge_parent[w] = renamed(number, b, m->wedge_parent[w]);
    permute_numbers(c, m->wedge_vertex + b->wedge, b->wedge_count,
                    c->wedge_order, 1);
    permute_numbers(c, m->wedge_parent + b->wedge, b->wedge_count,
                    c->wedge_order, 1);
    permute(c, m->value + (size_t)b->wedge * m->value_count, b->wedge_count,
            c->wedge_order, m->value_count * sizeof *m->value,
            sizeof *m->value);
}

void pmesh_block_rank(pmesh_codec *c)
{
    pmesh_block *b = &c->block;
    if (b->vertex_count == 0)
        return;
    sort_children(c);
    rename_children(c);
    order_faces(c);
    rename_faces(c);
    if (c->mesh.wedge) {
        rename_wedges(c);
        /* wedge_vertex named children in coding order. */
        for (uint32_t u = b->vertex; u < b->vertex + b->vertex_count; u++) {
            uint32_t start = c->mesh.first[u];
            for (uint32_t h = start; h != PMESH_NONE;
                 h = pmesh_corner_next(&c->mesh, &start, h))
                c->mesh.wedge_vertex[c->mesh.wedge[h]] = u;
        }
        list_wedges(c);
    }
}
