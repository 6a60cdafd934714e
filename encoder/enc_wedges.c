/* SPDX-License-Identifier: MIT */
#include "encoder/enc_wedges.h"

#include "format/alloc.h"
#include "format/quantize.h"

/* Wedges without a corner are matched with at most so many of the parent's: a
 * vertex may have lost any number of them, and nobody sees which is taken. */
enum { MAX_TRIES = 64 };

/* The wedges of child and parent in the faces that die, left and right; both
 * sides the same at a boundary. */
typedef struct bridge {
    uint32_t child[2], parent[2];
} bridge;

static bridge find_bridge(const enc_surface *s, const enc_pair *pair)
{
    const uint32_t left = pair->left, right = pair->right;
    bridge b;

    if (left != ENC_NONE) {
        b.child[0] = b.child[1] = s->wedge[left];
        b.parent[0] = b.parent[1] = s->wedge[enc_next(left)];
    }
    if (right != ENC_NONE) {
        b.child[1] = s->wedge[enc_next(right)];
        b.parent[1] = s->wedge[right];
    }
    if (left == ENC_NONE) {
        b.child[0] = b.child[1];
        b.parent[0] = b.parent[1];
    }
    return b;
}

bool enc_wedges_clean(const enc_surface *s, const enc_pair *pair)
{
    if (!s->wedge)
        return true;
    const bridge b = find_bridge(s, pair);
    if (b.child[0] == b.child[1] && b.parent[0] != b.parent[1])
        return false;

    const uint32_t start = s->first[pair->child];
    uint32_t h = start;
    do {
        if (s->wedge[h] != b.child[0] && s->wedge[h] != b.child[1])
            return false;
        h = enc_turn(s, h);
    } while (h != ENC_NONE && h != start);
    return true;
}

/* Sum of squares of the differences, each relative to its range. */
static uint64_t unlikeness(const enc_mesh *mesh, uint32_t a, uint32_t b)
{
    const uint16_t *x = mesh->value + (size_t)a * mesh->value_count;
    const uint16_t *y = mesh->value + (size_t)b * mesh->value_count;
    uint64_t sum = 0;

    for (uint32_t i = 0; i < mesh->attribute_count; i++) {
        const unsigned shift = 16u - mesh->attribute[i].bits;
        for (uint32_t k = pmesh_coded_components(&mesh->attribute[i]); k > 0;
             k--) {
            const int64_t d = ((int64_t)*x++ - *y++) * (1 << shift);
            sum += (uint64_t)(d * d);
        }
    }
    return sum;
}

/* Of the wedges at v's corners the one most like w, of equals the lowest. */
static uint32_t most_similar(const enc_surface *s, uint32_t w, uint32_t v)
{
    uint32_t start = s->first[v], best = s->wedge[start];
    uint64_t least = unlikeness(s->mesh, w, best);

    for (uint32_t h = start; h != ENC_NONE; h = enc_around(s, &start, h)) {
        const uint32_t x = s->wedge[h];
        if (x != best) {
            const uint64_t value = unlikeness(s->mesh, w, x);
            if (value < least || (value == least && x < best)) {
                least = value;
                best = x;
            }
        }
    }
    return best;
}

void enc_wedges_map(const enc_surface *s, const enc_pair *pair,
                    uint32_t *wedge_parent)
{
    const uint32_t start = s->first[pair->child];
    const bridge b = find_bridge(s, pair);
    const bool torn = b.child[0] == b.child[1] && b.parent[0] != b.parent[1];

    uint32_t h = start;
    do {
        const uint32_t w = s->wedge[h];
        if (wedge_parent[w] == ENC_NONE) {
            if (torn || (w != b.child[0] && w != b.child[1]))
                wedge_parent[w] = most_similar(s, w, pair->parent);
            else
                wedge_parent[w] = b.parent[w == b.child[0] ? 0 : 1];
        }
        h = enc_turn(s, h);
    } while (h != ENC_NONE && h != start);
}

/* What it has in a face that dies, of several the one in the first; or else
 * the most similar one. */
void enc_wedges_map_link(const enc_surface *s, const enc_pair *pair,
                         const enc_link *link, uint32_t *wedge_parent)
{
    for (uint32_t i = 0; i < link->count; i++) {
        const uint32_t h = link->edge[i], next = enc_next(h);
        const bool forth = s->vertex[h] == pair->child;
        const uint32_t w = s->wedge[forth ? h : next];
        if (wedge_parent[w] == ENC_NONE)
            wedge_parent[w] = s->wedge[forth ? next : h];
    }
    uint32_t start = s->first[pair->child];
    for (uint32_t h = start; h != ENC_NONE; h = enc_around(s, &start, h))
        if (wedge_parent[s->wedge[h]] == ENC_NONE)
            wedge_parent[s->wedge[h]] =
                most_similar(s, s->wedge[h], pair->parent);
}

/* Chains the wedges of each vertex, the lowest first. */
static void chain_wedges(const enc_mesh *mesh, uint32_t *head, uint32_t *next)
{
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        head[v] = ENC_NONE;
    for (uint32_t w = mesh->wedge_count; w-- > 0;) {
        next[w] = head[mesh->wedge_vertex[w]];
        head[mesh->wedge_vertex[w]] = w;
    }
}

pmesh_status enc_wedges_finish(const enc_mesh *mesh,
                               const uint32_t *vertex_parent,
                               uint32_t *wedge_parent)
{
    const pmesh_allocator *a = &mesh->allocator;
    uint32_t *head = pmesh_alloc(a, mesh->vertex_count, sizeof *head);
    uint32_t *next = pmesh_alloc(a, mesh->wedge_count, sizeof *next);
    const bool ready = head && next;

    if (ready)
        chain_wedges(mesh, head, next);
    for (uint32_t w = 0; ready && w < mesh->wedge_count; w++) {
        const uint32_t parent = vertex_parent[mesh->wedge_vertex[w]];
        uint64_t least = UINT64_MAX;
        unsigned tries = 0;

        if (parent == ENC_NONE || wedge_parent[w] != ENC_NONE)
            continue;
        for (uint32_t x = head[parent]; x != ENC_NONE && tries < MAX_TRIES;
             x = next[x], tries++) {
            const uint64_t value = unlikeness(mesh, w, x);
            if (value < least) {
                least = value;
                wedge_parent[w] = x;
            }
        }
    }
    pmesh_release(a, head, mesh->vertex_count, sizeof *head);
    pmesh_release(a, next, mesh->wedge_count, sizeof *next);
    return ready ? PMESH_OK : PMESH_E_MEMORY;
}
