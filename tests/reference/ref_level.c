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
        for (; done < r->order_count; done++)
            for (ref_walk w = ref_walk_at(r, r->order[done]); w.h != REF_NONE;
                 ref_walk_on(r, &w)) {
                visit(r, seen, ref_end_of(r, w.h));
                if (ref_left(r, w.h) == REF_NONE)
                    visit(r, seen, ref_start_of(r, ref_prev(w.h)));
            }
    }
    free(seen);
    r->in_level = true;
}

static int least(int a, int b)
{
    return a < b ? a : b;
}

static int flag_context(const ref *r, const ref_ring *ring, int rings)
{
    int size = 0, parents = 0, kept = 0, unvisited = 0;
    for (int k = 0; k < rings; k++) {
        size += ring[k].count + ring[k].open;
        for (int i = 0; i < ring[k].count; i++) {
            const int state = r->vertex[ring[k].vertex[i]].state;
            parents += state == REF_PARENT || state == REF_NEWBORN;
            kept += state == REF_KEPT;
            unvisited += state == REF_UNVISITED;
        }
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

static place find_place(uint32_t v, uint32_t u, const ref_ring *ring,
                        ref_cut cut)
{
    place p = { v, u, REF_NONE, REF_NONE,
                REF_NONE, REF_NONE, REF_NONE, REF_NONE, ring->edge[0] };
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

/* The faces from a to b go to u. */
static void move_faces(ref *r, const place *p, const ref_ring *ring,
                       ref_cut cut)
{
    const int n = ring->count;
    const int first = cut.first == REF_GHOST_WING ? 0 : cut.first;
    int span = cut.end == REF_GHOST_WING ? n - 1 - first : cut.end - first;
    if (span < 0)
        span += n;
    if (span == 0)
        REF_SEEN(cut_without_faces);
    for (int i = 0; i < span; i++)
        r->edge[ring->edge[(first + i) % n]].vertex = p->u;
}

static uint32_t add_face_a(ref *r, const place *p)
{
    const uint32_t f = 3 * ref_new_face(r, p->v, p->a, p->u);
    ref_join(r, f, p->before_a);
    ref_join(r, f + 1, p->behind_a);
    if (p->behind_a == REF_NONE)
        ref_restart(r, p->a, p->before_a, f + 1);
    return f;
}

static uint32_t add_face_b(ref *r, const place *p)
{
    const uint32_t f = 3 * ref_new_face(r, p->v, p->u, p->b);
    ref_join(r, f + 1, p->before_b);
    ref_join(r, f + 2, p->behind_b);
    if (p->behind_b == REF_NONE)
        ref_restart(r, p->b, p->before_b, f + 2);
    return f;
}

static void set_first(const place *p, const ref_ring *ring, ref_cut cut,
                      uint32_t a, uint32_t b, uint32_t *v_first,
                      uint32_t *u_first)
{
    *v_first = p->v_first;
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

void ref_cut_fan(ref *r, uint32_t v, const ref_ring *ring, ref_cut cut,
                 ref_fresh *fresh, uint32_t *start_v)
{
    const int i = fresh->cuts++;
    const place p = find_place(v, fresh->u, ring, cut);
    uint32_t a = REF_NONE, b = REF_NONE;
    note_cut(ring, cut);
    move_faces(r, &p, ring, cut);
    if (p.a != REF_NONE)
        a = add_face_a(r, &p);
    if (p.b != REF_NONE)
        b = add_face_b(r, &p);
    if (a != REF_NONE && b != REF_NONE)
        ref_join(r, a + 2, b);
    set_first(&p, ring, cut, a, b, start_v, &fresh->start[i]);
    fresh->a[i] = a;
    fresh->b[i] = b;
}

/* u starts at the mean of what is around, v included. */
static void place_child(ref *r, uint32_t v, uint32_t u)
{
    const ref_ring ring = ref_ring_of(r, u);
    ref_vec sum = r->vertex[v].at;
    int count = 1;
    for (int i = 0; i < ring.count; i++) {
        if (ring.vertex[i] == v)
            continue;
        sum = ref_add(sum, r->vertex[ring.vertex[i]].at);
        count++;
    }
    r->vertex[u].at = ref_vshare(sum, count);
}

static ref_fresh start_split(ref *r, uint32_t v)
{
    const ref_level *level = &r->header.level[r->levels];
    ref_check(r, r->vertex_count < level->vertices, "6.3: vertices");
    const ref_fresh fresh = { .u = ref_new_vertex(r),
                              .first_face = r->face_count };
    r->vertex[fresh.u].parent = v;
    return fresh;
}

static void finish_split(ref *r, uint32_t v, const ref_fresh *fresh)
{
    const ref_level *level = &r->header.level[r->levels];
    ref_check(r, r->face_count <= level->faces, "6.3: faces");
    ref_check(r,
              !r->header.joined ||
                  r->face_count - r->block_face <= r->header.block_faces,
              "6.3: more than block_faces");
    place_child(r, v, fresh->u);
    r->vertex[v].state = REF_PARENT;
    r->vertex[fresh->u].state = REF_NEWBORN;

    const size_t index = fresh->u - r->base_vertices;
    r->split = ref_grow(r, r->split, &r->split_room, index + 1,
                        sizeof *r->split);
    r->split[index] = (ref_split){ .parent = v,
                                   .first_face = fresh->first_face,
                                   .face_end = r->face_count };
    if (r->header.material_count > 1)
        ref_read_split_materials(r, fresh);
    if (r->header.attribute_count > 0)
        ref_read_split_wedges(r, fresh);
}

static void split(ref *r, uint32_t v, const ref_ring *ring, ref_cut cut)
{
    ref_fresh fresh = start_split(r, v);
    uint32_t start;
    ref_cut_fan(r, v, ring, cut, &fresh, &start);
    r->vertex[v].first = start;
    r->vertex[fresh.u].first = fresh.start[0];
    finish_split(r, v, &fresh);
}

/* ---- a block ------------------------------------------------------------ */

static void read_splits(ref *r, uint64_t splits)
{
    for (uint64_t done = 0; done < splits;) {
        ref_check(r, r->order_at < r->order_count,
                  "6.3: more splits than vertices");
        const uint32_t v = r->order[r->order_at++];
        const ref_fans fans = ref_fans_of(r, v);
        r->vertex[v].state = REF_KEPT;
        if (fans.large) {
            REF_SEEN(visit_large_ring);
            continue;
        }
        const int context = flag_context(r, fans.ring, fans.count);
        if (!ref_bit(&r->in, &r->flag[context])) {
            REF_SEEN(flag_kept);
            continue;
        }
        if (r->header.joined) {
            ref_fresh fresh = start_split(r, v);
            ref_part(r, v, &fans, &fresh);
            finish_split(r, v, &fresh);
        } else {
            split(r, v, fans.ring, ref_read_cut(r, v, fans.ring));
        }
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
