/* SPDX-License-Identifier: MIT */
/* SPEC 6.2: the base mesh, grown over open half-edges. */
#include "tests/reference/ref.h"

#include <stdlib.h>
#include <string.h>

/* Joined: the vertex that fan v is one of; false if it has a position. */
static bool read_point(ref *r, uint32_t v)
{
    const uint32_t points = r->point_count;
    r->vertex[v].point = points;
    if (v == 0 || !ref_bit(&r->in, &r->join.known)) {
        r->point_count++;
        return true;
    }
    const uint64_t back = ref_read_number(&r->in, &r->join.back);
    REF_SEEN(fan_known);
    ref_check(r, back < points, "6.2: a vertex that is not there");
    const uint32_t point = r->vertex[v].point = points - 1 - (uint32_t)back;
    uint32_t first = 0;
    while (r->vertex[first].point != point)
        first++;
    r->vertex[v].at = r->vertex[v].born = r->vertex[first].at;
    return false;
}

static uint32_t read_vertex(ref *r, ref_vec predicted)
{
    ref_base_models *m = &r->base_models;
    const ref_header *h = &r->header;
    ref_check(r,
              r->vertex_count <
                  (h->joined ? h->base_fans : h->level[0].vertices),
              "6.2: too many vertices");
    const uint32_t v = ref_new_vertex(r);
    if (h->joined && !read_point(r, v))
        return v;
    for (int i = 0; i < 3; i++) {
        const int64_t size = (int64_t)ref_read_number(&r->in, &m->position);
        const bool minus = size > 0 && ref_bit(&r->in, &m->sign);
        predicted.c[i] += minus ? -size : size;
        ref_check(r,
                  predicted.c[i] >= 0 && predicted.c[i] <= r->header.bounds[i],
                  "6.2: a position out of bounds");
    }
    r->vertex[v].at = r->vertex[v].born = predicted;
    return v;
}

/* Half-edges are listed per vertex, so that large bases end. */
static uint32_t find_edge(const ref *r, uint32_t x, uint32_t y)
{
    for (uint32_t h = r->list.head[x]; h != REF_NONE; h = r->list.next[h])
        if (ref_end_of(r, h) == y)
            return h;
    return REF_NONE;
}

static void add_face(ref *r, uint32_t a, uint32_t b, uint32_t c)
{
    const uint32_t at[3] = { a, b, c };
    ref_check(r, a != b && b != c && c != a, "6.2: a vertex twice in a face");
    ref_check(r, r->face_count < r->header.level[0].faces,
              "6.2: too many faces");
    ref_edge_list *l = &r->list;
    const size_t known = l->head_room;
    l->head = ref_grow(r, l->head, &l->head_room, r->vertex_count,
                       sizeof *l->head);
    for (size_t i = known; i < l->head_room; i++)
        l->head[i] = REF_NONE;
    const uint32_t f = ref_new_face(r, a, b, c);
    l->next = ref_grow(r, l->next, &l->next_room, 3 * (size_t)r->face_count,
                       sizeof *l->next);
    for (uint32_t k = 0; k < 3; k++) {
        const uint32_t x = at[k], y = at[(k + 1) % 3], h = 3 * f + k;
        ref_check(r, find_edge(r, x, y) == REF_NONE,
                  "6.2: a directed pair twice");
        ref_join(r, find_edge(r, y, x), h);
        if (r->vertex[x].first == REF_NONE)
            r->vertex[x].first = h;
    }
    for (uint32_t k = 0; k < 3; k++) {
        l->next[3 * f + k] = l->head[at[k]];
        l->head[at[k]] = 3 * f + k;
    }
}

/* Around y = end of g for candidate 0, around its start for 1. */
static uint32_t candidate(const ref *r, uint32_t g, int which)
{
    uint32_t h = which == 0 ? ref_next(g) : ref_prev(g);
    for (int seen = 1;; seen++) {
        const uint32_t twin = r->edge[h].twin;
        if (twin == REF_NONE)
            return which == 0 ? ref_end_of(r, h) : ref_start_of(r, h);
        if (seen == 48) {
            REF_SEEN(candidate_far);
            return REF_NONE;
        }
        h = which == 0 ? ref_next(twin) : ref_prev(twin);
    }
}

static uint32_t read_known(ref *r, uint32_t g, uint32_t x, uint32_t y)
{
    ref_base_models *m = &r->base_models;
    uint32_t before = REF_NONE;
    for (int i = 0; i < 2; i++) {
        const uint32_t c = candidate(r, g, i);
        if (c != REF_NONE && c != x && c != y && !(i == 1 && c == before)) {
            if (!ref_bit(&r->in, &m->neighbour[i])) {
                if (i == 0)
                    REF_SEEN(neighbour_0);
                else
                    REF_SEEN(neighbour_1);
                return c;
            }
        }
        before = c;
    }
    const uint64_t back = ref_read_number(&r->in, &m->vertex);
    ref_check(r, back < r->vertex_count, "6.2: a vertex that is not there");
    REF_SEEN(base_vertex_number);
    return r->vertex_count - 1 - (uint32_t)back;
}

static void read_gate(ref *r, uint32_t g)
{
    ref_base_models *m = &r->base_models;
    const uint32_t x = ref_start_of(r, g), y = ref_end_of(r, g);
    uint32_t z;
    if (ref_bit(&r->in, &m->boundary)) {
        REF_SEEN(gate_boundary);
        return;
    }
    if (!ref_bit(&r->in, &m->known)) {
        const uint32_t w = ref_start_of(r, ref_prev(g));
        REF_SEEN(gate_new);
        z = read_vertex(r, ref_sub(ref_add(r->vertex[x].at, r->vertex[y].at),
                                   r->vertex[w].at));
    } else {
        z = read_known(r, g, x, y);
    }
    add_face(r, y, x, z);
}

static void read_seed(ref *r)
{
    uint32_t v[3];
    REF_SEEN(seed);
    if (r->face_count > 0)
        REF_SEEN(seed_again);
    for (int i = 0; i < 3; i++) {
        const uint32_t n = r->vertex_count;
        v[i] = read_vertex(r, n > 0 ? r->vertex[n - 1].at : (ref_vec){ 0 });
    }
    add_face(r, v[0], v[1], v[2]);
}

static void read_faces(ref *r)
{
    for (uint32_t gate = 0;;) {
        if (gate == 3 * r->face_count) {
            if (r->face_count == r->header.level[0].faces)
                return;
            read_seed(r);
        } else {
            if (r->edge[gate].twin == REF_NONE)
                read_gate(r, gate);
            gate++;
        }
    }
}

/* The first half-edges; and whether all faces of a vertex are in one fan. */
static void close_mesh(ref *r)
{
    uint32_t *starts = calloc(r->vertex_count, sizeof *starts);
    for (uint32_t h = 0; h < 3 * r->face_count; h++) {
        const uint32_t v = ref_start_of(r, h);
        starts[v]++;
        if (r->edge[h].twin == REF_NONE)
            r->vertex[v].first = h;
    }
    bool fans = true;
    for (uint32_t v = 0; v < r->vertex_count; v++) {
        const uint32_t first = r->vertex[v].first;
        uint32_t n = 0, h = first;
        if (first == REF_NONE) {
            fans = false;
            break;
        }
        do {
            n++;
            h = ref_left(r, h);
        } while (h != REF_NONE && h != first);
        fans = fans && n == starts[v];
    }
    free(starts);
    ref_check(r, fans, "6.2: a vertex without one fan");
}

/* Fans become those of their vertices. */
static void join_fans(ref *r)
{
    ref_vertex *point = calloc(r->point_count, sizeof *point);
    bool room = true;
    for (uint32_t p = 0; p < r->point_count; p++)
        point[p] = (ref_vertex){ .first = REF_NONE, .parent = REF_NONE };
    for (uint32_t h = 0; h < 3 * r->face_count; h++)
        r->edge[h].vertex = r->vertex[r->edge[h].vertex].point;
    for (uint32_t v = 0; v < r->vertex_count; v++) {
        const ref_vertex *fan = &r->vertex[v];
        ref_vertex *to = &point[fan->point];
        if (to->first == REF_NONE) {
            to->first = fan->first;
            to->at = to->born = fan->at;
        } else if (to->more < REF_FANS - 1) {
            to->later[to->more++] = fan->first;
        } else {
            room = false;
        }
    }
    memcpy(r->vertex, point, r->point_count * sizeof *point);
    free(point);
    r->vertex_count = r->point_count;
    ref_check(r, room, "6.2: too many fans");
    for (uint32_t h = 0; h < 3 * r->face_count; h++)
        ref_check(r, ref_start_of(r, h) != ref_end_of(r, h),
                  "6.2: a vertex twice in a face");
}

void ref_read_base(ref *r, const uint8_t *data, size_t size)
{
    const ref_level *level = &r->header.level[0];
    ref_coder_start(&r->in, data, data + size);
    read_faces(r);
    if (r->header.joined)
        ref_check(r,
                  r->vertex_count == r->header.base_fans &&
                      r->point_count == level->vertices,
                  "6.2: fans, vertices");
    else
        ref_check(r, r->vertex_count == level->vertices, "6.2: vertices");
    close_mesh(r);
    if (r->header.joined)
        join_fans(r);
    r->base_vertices = r->vertex_count;
    r->base_faces = r->face_count;
    ref_read_base_materials(r);
    if (r->header.attribute_count > 0) {
        ref_read_base_wedges(r);
        ref_check(r, r->wedge_count == level->wedges, "6.2: wedges");
        ref_read_values(r);
    }
    r->base_wedges = r->wedge_count;
    ref_check(r, r->in.next == r->in.end, "6.1: bytes that are not used");
}
