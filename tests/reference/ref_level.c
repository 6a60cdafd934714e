/* SPDX-License-Identifier: MIT */
/* SPEC 6.3: the visit of a level, its blocks, the splits. */
#include "tests/reference/ref.h"

#include <stdlib.h>

/* ---- the visit ---------------------------------------------------------- */

static void visit(ref *r, bool *seen, uint32_t v)
{
    if (!seen[v]) {
        seen[v] = true;
        r->order[r->order_count++] = v;
    }
}

/* Breadth first over whole rings, however large. */
static void start_level(ref *r)
{
    bool *seen = calloc(r->vertex_count, sizeof *seen);
    uint32_t done = 0;
    r->order = ref_grow(r, r->order, &r->order_room, r->vertex_count,
                        sizeof *r->order);
    r->order_count = r->order_at = 0;
    for (uint32_t v = 0; v < r->vertex_count; v++) {
        r->vertex[v].state = REF_UNVISITED;
        if (!seen[v] && v > 0)
            REF_SEEN(visit_again);
        visit(r, seen, v);
        for (; done < r->order_count; done++) {
            const uint32_t first = r->vertex[r->order[done]].first;
            uint32_t h = first, left;
            do {
                visit(r, seen, ref_end_of(r, h));
                left = ref_left(r, h);
                if (left == REF_NONE)
                    visit(r, seen, ref_start_of(r, ref_prev(h)));
                h = left;
            } while (left != REF_NONE && left != first);
        }
    }
    free(seen);
    r->in_level = true;
}

static int least(int a, int b)
{
    return a < b ? a : b;
}

static int flag_context(const ref *r, const ref_ring *ring)
{
    const int size = ring->count + ring->open;
    int parents = 0, kept = 0, unvisited = 0;
    for (int i = 0; i < ring->count; i++) {
        const int state = r->vertex[ring->vertex[i]].state;
        parents += state == REF_PARENT || state == REF_NEWBORN;
        kept += state == REF_KEPT;
        unvisited += state == REF_UNVISITED;
    }
    const int a = size < 4 ? 0 : least(size - 3, 7);
    return ((a * 6 + least(parents, 5)) * 5 + least(kept, 4)) * 7 +
           least(unvisited, 6);
}

/* ---- a split ------------------------------------------------------------ */

/* What is there of a's and b's surroundings before the split. */
typedef struct place {
    uint32_t v, u, a, b;      /* NONE: the ghost */
    uint32_t before_a, behind_a; /* half-edges a-v, u-a */
    uint32_t before_b, behind_b; /* b-u, v-b */
    uint32_t v_first;
} place;

/* Face i of the ring, NONE beyond the ends. */
static uint32_t ring_edge(const ref_ring *ring, int i)
{
    if (!ring->open)
        return ring->edge[(i + ring->count) % ring->count];
    return i >= 0 && i < ring->faces ? ring->edge[i] : REF_NONE;
}

static uint32_t prev_or_none(uint32_t h)
{
    return h == REF_NONE ? h : ref_prev(h);
}

static place find_place(const ref *r, uint32_t v, const ref_ring *ring,
                        ref_cut cut)
{
    place p = { v, r->vertex_count, REF_NONE, REF_NONE,
                REF_NONE, REF_NONE, REF_NONE, REF_NONE, r->vertex[v].first };
    if (cut.first != REF_GHOST_WING) {
        p.a = ring->vertex[cut.first];
        p.before_a = prev_or_none(ring_edge(ring, cut.first - 1));
        p.behind_a = ring_edge(ring, cut.first);
    }
    if (cut.end != REF_GHOST_WING) {
        p.b = ring->vertex[cut.end];
        p.before_b = prev_or_none(ring_edge(ring, cut.end - 1));
        p.behind_b = ring_edge(ring, cut.end);
    }
    return p;
}

/* The faces from a to b go to u. u starts at the mean of what is around. */
static void move_faces(ref *r, const place *p, const ref_ring *ring,
                       ref_cut cut)
{
    const int n = ring->count;
    const int first = cut.first == REF_GHOST_WING ? 0 : cut.first;
    int span = cut.end == REF_GHOST_WING ? n - 1 - first : cut.end - first;
    ref_vec sum = r->vertex[p->v].at;
    if (span < 0)
        span += n;
    if (span == 0)
        REF_SEEN(cut_without_faces);
    for (int i = 0; i <= span; i++)
        sum = ref_add(sum, r->vertex[ring->vertex[(first + i) % n]].at);
    for (int i = 0; i < span; i++)
        r->edge[ring->edge[(first + i) % n]].vertex = p->u;
    r->vertex[p->u].at = ref_over(sum, span + 2);
}

static uint32_t add_face_a(ref *r, const place *p)
{
    const uint32_t f = 3 * ref_new_face(r, p->v, p->a, p->u);
    ref_join(r, f, p->before_a);
    ref_join(r, f + 1, p->behind_a);
    if (p->behind_a == REF_NONE)
        r->vertex[p->a].first = f + 1;
    return f;
}

static uint32_t add_face_b(ref *r, const place *p)
{
    const uint32_t f = 3 * ref_new_face(r, p->v, p->u, p->b);
    ref_join(r, f + 1, p->before_b);
    ref_join(r, f + 2, p->behind_b);
    if (p->behind_b == REF_NONE)
        r->vertex[p->b].first = f + 2;
    return f;
}

static void set_first(ref *r, const place *p, const ref_ring *ring,
                      ref_cut cut, uint32_t a, uint32_t b)
{
    uint32_t *u_first = &r->vertex[p->u].first;
    uint32_t *v_first = &r->vertex[p->v].first;
    if (p->a != REF_NONE) {
        *u_first = a + 2;
        if (cut.first == 0 || (p->b != REF_NONE && !ring->open))
            *v_first = a;
    } else {
        *u_first = cut.end == 0 ? b + 1 : p->v_first;
        *v_first = b;
    }
}

static void note_cut(const ref_ring *ring, ref_cut cut)
{
    if (!ring->open)
        REF_SEEN(cut_closed);
    else if (cut.first == REF_GHOST_WING)
        REF_SEEN(cut_ghost_first);
    else if (cut.end == REF_GHOST_WING)
        REF_SEEN(cut_ghost_end);
    else
        REF_SEEN(cut_open);
}

static void split(ref *r, uint32_t v, const ref_ring *ring, ref_cut cut)
{
    const ref_level *level = &r->header.level[r->levels];
    uint32_t a = REF_NONE, b = REF_NONE;
    const place p = find_place(r, v, ring, cut);
    note_cut(ring, cut);
    ref_check(r, r->vertex_count < level->vertices, "6.3: vertices");
    ref_new_vertex(r);
    r->vertex[p.u].parent = v;
    const uint32_t first_face = r->face_count;
    move_faces(r, &p, ring, cut);
    if (p.a != REF_NONE)
        a = add_face_a(r, &p);
    if (p.b != REF_NONE)
        b = add_face_b(r, &p);
    ref_check(r, r->face_count <= level->faces, "6.3: faces");
    if (a != REF_NONE && b != REF_NONE)
        ref_join(r, a + 2, b);
    set_first(r, &p, ring, cut, a, b);
    r->vertex[v].state = REF_PARENT;
    r->vertex[p.u].state = REF_NEWBORN;

    const size_t index = p.u - r->base_vertices;
    r->split = ref_grow(r, r->split, &r->split_room, index + 1,
                        sizeof *r->split);
    r->split[index] = (ref_split){ .parent = v,
                                   .first_face = first_face,
                                   .face_end = r->face_count };
    if (r->header.material_count > 1)
        ref_read_split_materials(r, a, b);
    if (r->header.attribute_count > 0)
        ref_read_split_wedges(r, p.u, a, b);
}

/* ---- a block ------------------------------------------------------------ */

static void read_splits(ref *r, uint64_t splits)
{
    for (uint64_t done = 0; done < splits;) {
        ref_check(r, r->order_at < r->order_count,
                  "6.3: more splits than vertices");
        const uint32_t v = r->order[r->order_at++];
        const ref_ring ring = ref_ring_of(r, v);
        r->vertex[v].state = REF_KEPT;
        if (ring.large) {
            REF_SEEN(visit_large_ring);
            continue;
        }
        if (!ref_bit(&r->in, &r->flag[flag_context(r, &ring)])) {
            REF_SEEN(flag_kept);
            continue;
        }
        split(r, v, &ring, ref_read_cut(r, v, &ring));
        done++;
    }
}

void ref_read_block(ref *r, const uint8_t *data, size_t size, bool last)
{
    ref_bytes in = { r, data, data + size, "6.3: the block is too short" };
    const ref_level *level = &r->header.level[r->levels];
    const uint64_t splits = ref_get_varint(&in);
    ref_check(r, splits >= 1 && splits <= r->header.block_splits,
              "6.3: splits");
    if (!r->in_level)
        start_level(r);
    r->block_vertex = r->vertex_count;
    r->block_face = r->face_count;
    r->block_wedge = r->wedge_count;
    ref_coder_start(&r->in, in.next, in.end);
    read_splits(r, splits);
    ref_read_positions(r);
    if (r->header.attribute_count > 0)
        ref_read_values(r);
    ref_check(r, r->in.next == r->in.end, "6.1: bytes that are not used");
    ref_renumber(r);
    if (!last)
        return;
    ref_check(r,
              r->vertex_count == level->vertices &&
                  r->face_count == level->faces &&
                  (r->header.attribute_count == 0 ||
                   r->wedge_count == level->wedges),
              "6.3: counts that differ from the table");
    r->levels++;
    r->in_level = false;
}
