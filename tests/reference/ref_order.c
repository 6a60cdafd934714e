/* SPDX-License-Identifier: MIT */
/* SPEC 6.7: what a block made is numbered anew by importance. */
#include "tests/reference/ref.h"

#include <stdlib.h>
#include <string.h>

/* New numbers by old ones, from the first of the block on. */
typedef struct numbering {
    uint32_t *old_split; /* by new number */
    uint32_t *vertex, *face, *wedge;
} numbering;

/* Insertion keeps equal keys in order; binary search for the place. */
static void sort_splits(const ref *r, uint32_t *old_split, uint32_t count)
{
    const ref_split *split =
        r->split + (r->block_vertex - r->base_vertices);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t low = 0, high = i;
        while (low < high) {
            const uint32_t middle = (low + high) / 2;
            if (split[old_split[middle]].key >= split[i].key)
                low = middle + 1;
            else
                high = middle;
        }
        memmove(old_split + low + 1, old_split + low,
                (i - low) * sizeof *old_split);
        old_split[low] = i;
    }
}

static void number_vertices_and_faces(const ref *r, numbering *n,
                                      uint32_t count)
{
    uint32_t face = r->block_face;
    for (uint32_t i = 0; i < count; i++) {
        const ref_split *s = &r->split[r->block_vertex - r->base_vertices +
                                       n->old_split[i]];
        n->vertex[n->old_split[i]] = r->block_vertex + i;
        for (uint32_t f = s->first_face; f < s->face_end; f++)
            n->face[f - r->block_face] = face++;
    }
}

static uint32_t new_vertex(const ref *r, const numbering *n, uint32_t v)
{
    return v < r->block_vertex || v == REF_NONE
               ? v
               : n->vertex[v - r->block_vertex];
}

static uint32_t new_face(const ref *r, const numbering *n, uint32_t f)
{
    return f < r->block_face ? f : n->face[f - r->block_face];
}

static uint32_t new_edge(const ref *r, const numbering *n, uint32_t h)
{
    return h == REF_NONE ? h : 3 * new_face(r, n, h / 3) + h % 3;
}

static uint32_t new_wedge(const ref *r, const numbering *n, uint32_t w)
{
    return w < r->block_wedge || w == REF_NONE
               ? w
               : n->wedge[w - r->block_wedge];
}

/* Vertices, splits and faces move to their new places. */
static void move_elements(ref *r, const numbering *n, uint32_t count)
{
    const uint32_t faces = r->face_count - r->block_face;
    ref_vertex *vertex = malloc(count * sizeof *vertex);
    ref_split *split = malloc(count * sizeof *split);
    ref_edge *edge = malloc(3 * faces * sizeof *edge);
    uint32_t *material = malloc(faces * sizeof *material);
    ref_split *splits = r->split + (r->block_vertex - r->base_vertices);
    for (uint32_t i = 0; i < count; i++) {
        vertex[i] = r->vertex[r->block_vertex + n->old_split[i]];
        split[i] = splits[n->old_split[i]];
    }
    for (uint32_t f = 0; f < faces; f++) {
        const uint32_t to = n->face[f] - r->block_face;
        memcpy(edge + 3 * to, r->edge + 3 * (r->block_face + f),
               3 * sizeof *edge);
        material[to] = r->material[r->block_face + f];
    }
    memcpy(r->vertex + r->block_vertex, vertex, count * sizeof *vertex);
    memcpy(splits, split, count * sizeof *split);
    memcpy(r->edge + 3 * r->block_face, edge, 3 * faces * sizeof *edge);
    memcpy(r->material + r->block_face, material, faces * sizeof *material);
    free(vertex);
    free(split);
    free(edge);
    free(material);
}

/* Everything that names vertices and faces follows. */
static void rename_elements(ref *r, const numbering *n, uint32_t count)
{
    for (uint32_t h = 0; h < 3 * r->face_count; h++) {
        r->edge[h].vertex = new_vertex(r, n, r->edge[h].vertex);
        r->edge[h].twin = new_edge(r, n, r->edge[h].twin);
    }
    for (uint32_t v = 0; v < r->vertex_count; v++) {
        ref_vertex *x = &r->vertex[v];
        x->first = new_edge(r, n, x->first);
        for (int i = 0; i < x->more; i++)
            x->later[i] = new_edge(r, n, x->later[i]);
    }
    for (uint32_t w = r->block_wedge; w < r->wedge_count; w++) {
        r->wedge[w].vertex = new_vertex(r, n, r->wedge[w].vertex);
        r->wedge[w].corner = new_edge(r, n, r->wedge[w].corner);
    }
    uint32_t face = r->block_face;
    for (uint32_t i = 0; i < count; i++) {
        ref_split *s = &r->split[r->block_vertex - r->base_vertices + i];
        const uint32_t faces = s->face_end - s->first_face;
        s->first_face = face;
        s->face_end = face += faces;
    }
}

/* ---- wedges ------------------------------------------------------------- */

typedef struct counter {
    uint32_t next;
} counter;

static void number_wedge(const ref *r, numbering *n, counter *c, uint32_t w)
{
    if (w == REF_NONE || w < r->block_wedge)
        return;
    uint32_t *number = &n->wedge[w - r->block_wedge];
    if (*number == REF_NONE)
        *number = c->next++;
}

/* The wedge a corner is born with: vertices above u are still their parents,
 * and wedges in step. */
static uint32_t born_with(const ref *r, uint32_t corner, uint32_t u)
{
    uint32_t v = r->edge[corner].vertex, w = r->edge[corner].wedge;
    while (v > u) {
        v = r->vertex[v].parent;
        w = w == REF_NONE ? w : r->wedge[w].from;
    }
    return w;
}

static void number_split(ref *r, numbering *n, counter *c, uint32_t u)
{
    ref_split *s = &r->split[u - r->base_vertices];
    for (uint32_t h = 3 * s->first_face; h < 3 * s->face_end; h++)
        number_wedge(r, n, c, born_with(r, h, u));
    for (ref_walk w = ref_walk_at(r, u); w.h != REF_NONE; ref_walk_on(r, &w))
        if (w.h / 3 < s->first_face)
            number_wedge(r, n, c, r->edge[w.h].wedge);
    s->wedge_end = c->next;
}

static void rename_wedges(ref *r, const numbering *n)
{
    const uint32_t count = r->wedge_count - r->block_wedge;
    ref_wedge *wedge = malloc((count + 1) * sizeof *wedge);
    for (uint32_t i = 0; i < count; i++) {
        const ref_wedge *w = &r->wedge[r->block_wedge + i];
        wedge[n->wedge[i] - r->block_wedge] = *w;
    }
    if (count)
        memcpy(r->wedge + r->block_wedge, wedge, count * sizeof *wedge);
    free(wedge);
    for (uint32_t w = r->block_wedge; w < r->wedge_count; w++)
        r->wedge[w].from = new_wedge(r, n, r->wedge[w].from);
    for (uint32_t h = 0; h < 3 * r->face_count; h++)
        r->edge[h].wedge = new_wedge(r, n, r->edge[h].wedge);
}

static void number_wedges(ref *r, numbering *n)
{
    counter c = { r->block_wedge };
    for (uint32_t u = r->block_vertex; u < r->vertex_count; u++)
        number_split(r, n, &c, u);
    for (uint32_t w = r->block_wedge; w < r->wedge_count; w++) {
        if (n->wedge[w - r->block_wedge] == REF_NONE)
            REF_SEEN(wedge_left_over);
        number_wedge(r, n, &c, w);
    }
    r->split[r->vertex_count - 1 - r->base_vertices].wedge_end = c.next;
    rename_wedges(r, n);
}

/* Corners of u in older faces, of all splits of the block (7). */
static void count_moved(ref *r)
{
    for (uint32_t u = r->block_vertex; u < r->vertex_count; u++) {
        const ref_split *s = &r->split[u - r->base_vertices];
        for (ref_walk w = ref_walk_at(r, u); w.h != REF_NONE;
             ref_walk_on(r, &w))
            r->moved_corners += w.h / 3 < s->first_face;
    }
    ref_check(r, r->moved_corners <= r->header.moved_corners,
              "7: moved_corners");
}

void ref_renumber(ref *r)
{
    const uint32_t count = r->vertex_count - r->block_vertex;
    const uint32_t wedges = r->wedge_count - r->block_wedge;
    numbering n = {
        malloc(count * sizeof *n.old_split), malloc(count * sizeof *n.vertex),
        malloc((r->face_count - r->block_face) * sizeof *n.face),
        malloc((wedges + 1) * sizeof *n.wedge)
    };
    for (uint32_t i = 0; i < wedges; i++)
        n.wedge[i] = REF_NONE;
    sort_splits(r, n.old_split, count);
    number_vertices_and_faces(r, &n, count);
    move_elements(r, &n, count);
    rename_elements(r, &n, count);
    number_wedges(r, &n);
    free(n.old_split);
    free(n.vertex);
    free(n.face);
    free(n.wedge);
    count_moved(r);
}
