/* SPDX-License-Identifier: MIT */
#include "encoder/enc_session.h"

#include <math.h>
#include <string.h>

#include "format/alloc.h"

/* A best place further than this from the middle, in edges, is not trusted. */
#define REACH 2.0

/* Faces may turn by this cosine at most. */
#define LEAST_COSINE 0.1

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        out[k] = a[i] * b[j] - a[j] * b[i];
    }
}

static uint32_t beside(uint32_t c, uint32_t steps)
{
    return c - c % 3 + (c % 3 + steps) % 3;
}

static bool is_dead(const pmesh_session *s, uint32_t c)
{
    return s->end[c / 3] != ENC_NOBODY;
}

/* Twice the area times the normal of a corner's face, were its vertex at p. */
static void normal_at(const pmesh_session *s, uint32_t c, const double p[3],
                      double out[3])
{
    const double *q = s->node[s->vertex[beside(c, 1)]].position;
    const double *r = s->node[s->vertex[beside(c, 2)]].position;
    double a[3], b[3];

    for (int k = 0; k < 3; k++) {
        a[k] = q[k] - p[k];
        b[k] = r[k] - p[k];
    }
    cross(a, b, out);
}

double enc_session_area(const pmesh_session *s, uint32_t v)
{
    double area = 0;
    uint32_t c = s->first[v];

    if (c == ENC_NOBODY)
        return 0;
    do {
        double n[3];
        if (is_dead(s, c))
            continue;
        normal_at(s, c, s->node[v].position, n);
        area += 0.5 * sqrt(dot(n, n));
    } while ((c = s->next[c]) != s->first[v]);
    return area;
}

/* ---- price --------------------------------------------------------------- */

/* Where u and v would go, and what it costs: constraints have a say in the one
 * and none in the other. */
static double price(const pmesh_session *s, uint32_t u, uint32_t v,
                    double place[3], double *square)
{
    const enc_node *a = &s->node[u], *b = &s->node[v];
    double half[3], back[3], x[3];
    enc_quadric sum = { .c = 0 }, pull = { .c = 0 };

    for (int k = 0; k < 3; k++) {
        half[k] = (a->position[k] - b->position[k]) / 2;
        back[k] = -half[k];
    }
    enc_quadric_add(&sum, &a->quadric, half);
    enc_quadric_add(&sum, &b->quadric, back);
    enc_quadric_add(&pull, &a->pull, half);
    enc_quadric_add(&pull, &b->pull, back);
    const bool found = pull.weight > 0
                           ? enc_quadric_pulled_minimum(&sum, &pull, x)
                           : enc_quadric_minimum(&sum, NULL, x);
    if (!found || dot(x, x) > 4 * REACH * REACH * dot(half, half)) {
        enc_quadric both;
        double best = INFINITY;
        enc_quadric_add_here(&sum, &pull, &both);
        for (int side = -1; side <= 1; side++) {
            const double y[3] = { side * half[0], side * half[1],
                                  side * half[2] };
            const double value = enc_quadric_value(&both, y);
            if (value < best) {
                best = value;
                memcpy(x, y, sizeof y);
            }
        }
    }
    for (int k = 0; k < 3; k++)
        place[k] = b->position[k] + half[k] + x[k];
    const double cost = enc_quadric_value(&sum, x);
    *square = sum.weight > 0 ? cost / sum.weight : 0;
    return cost;
}

/* ---- queue --------------------------------------------------------------- */

/* A total order, so that the heap's own is of no consequence. */
static bool comes_first(const enc_choice *a, const enc_choice *b)
{
    if (a->cost != b->cost)
        return a->cost < b->cost;
    return a->ends[0] != b->ends[0] ? a->ends[0] < b->ends[0]
                                    : a->ends[1] < b->ends[1];
}

static bool push(pmesh_session *s, uint32_t u, uint32_t v)
{
    double place[3], square;
    enc_choice choice = { .ends = { u < v ? u : v, u < v ? v : u } };
    size_t i = s->heap_count;

    if (i == s->heap_room) {
        const size_t room = 2 * s->heap_room + 1024;
        enc_choice *heap = pmesh_alloc(&s->allocator, room, sizeof *heap);
        if (!heap)
            return false;
        if (i > 0)
            memcpy(heap, s->heap, i * sizeof *heap);
        pmesh_release(&s->allocator, s->heap, s->heap_room, sizeof *heap);
        s->heap = heap;
        s->heap_room = room;
    }
    choice.cost = price(s, choice.ends[0], choice.ends[1], place, &square);
    for (int k = 0; k < 2; k++)
        choice.age[k] = s->age[choice.ends[k]];
    s->heap_count++;
    for (; i > 0 && comes_first(&choice, &s->heap[(i - 1) / 2]);
         i = (i - 1) / 2)
        s->heap[i] = s->heap[(i - 1) / 2];
    s->heap[i] = choice;
    return true;
}

static enc_choice pop(pmesh_session *s)
{
    const enc_choice top = s->heap[0], moved = s->heap[--s->heap_count];
    size_t i = 0;

    for (size_t child = 1; child < s->heap_count; child = 2 * i + 1) {
        if (child + 1 < s->heap_count &&
            comes_first(&s->heap[child + 1], &s->heap[child]))
            child++;
        if (!comes_first(&s->heap[child], &moved))
            break;
        s->heap[i] = s->heap[child];
        i = child;
    }
    s->heap[i] = moved;
    return top;
}

static bool is_stale(const pmesh_session *s, const enc_choice *c)
{
    for (int k = 0; k < 2; k++)
        if (s->into[c->ends[k]] != ENC_NOBODY ||
            s->age[c->ends[k]] != c->age[k])
            return true;
    return false;
}

static bool fill(pmesh_session *s)
{
    s->heap_count = 0;
    memset(s->age, 0, s->vertex_count * sizeof *s->age);
    for (uint32_t c = 0; c < 3 * s->face_count; c++) {
        const uint32_t u = s->vertex[c], v = s->vertex[beside(c, 1)];
        /* Of an edge's two half-edges the other may be missing. */
        if (!is_dead(s, c) && !push(s, u, v))
            return false;
    }
    return s->fresh = true;
}

/* ---- contraction --------------------------------------------------------- */

static uint32_t new_stamp(pmesh_session *s)
{
    if (++s->stamp == 0) {
        memset(s->mark, 0, s->vertex_count * sizeof *s->mark);
        s->stamp = 1;
    }
    return s->stamp;
}

/* Marks the neighbours of v; *open if its faces are no closed fan. Returns the
 * number of faces. */
static uint32_t look_around(pmesh_session *s, uint32_t v, bool *open)
{
    const uint32_t stamp = new_stamp(s);
    uint32_t c = s->first[v], faces = 0, neighbours = 0;

    do {
        if (is_dead(s, c))
            continue;
        faces++;
        for (uint32_t k = 1; k < 3; k++) {
            const uint32_t w = s->vertex[beside(c, k)];
            neighbours += s->mark[w] != stamp;
            s->mark[w] = stamp;
        }
    } while ((c = s->next[c]) != s->first[v]);
    *open = neighbours != faces;
    return faces;
}

/* True if a wing would keep two faces back to back. */
static bool spoils_wing(pmesh_session *s, uint32_t u, uint32_t v)
{
    uint32_t c = s->first[u];

    do {
        bool open;
        if (is_dead(s, c))
            continue;
        for (uint32_t k = 1; k < 3; k++)
            if (s->vertex[beside(c, k)] == v &&
                look_around(s, s->vertex[beside(c, 3 - k)], &open) <= 3 &&
                !open)
                return true;
    } while ((c = s->next[c]) != s->first[u]);
    return false;
}

/* The link condition: only the wings are neighbours of both, and boundaries
 * do not meet. */
static bool keeps_topology(pmesh_session *s, uint32_t u, uint32_t v)
{
    uint32_t c = s->first[v], faces = 0, shared = 0;
    bool u_open, v_open;

    look_around(s, v, &v_open);
    look_around(s, u, &u_open);
    const uint32_t ring = s->stamp, seen = new_stamp(s);
    do {
        if (is_dead(s, c))
            continue;
        for (uint32_t k = 1; k < 3; k++) {
            const uint32_t w = s->vertex[beside(c, k)];
            faces += w == u;
            if (w == u || s->mark[w] != ring)
                continue;
            shared++;
            s->mark[w] = seen;
        }
    } while ((c = s->next[c]) != s->first[v]);
    if (shared != faces || faces == 0 || faces > 2 ||
        (faces == 2 && u_open && v_open))
        return false;
    return !spoils_wing(s, u, v);
}

static bool flips(const pmesh_session *s, uint32_t v, uint32_t other,
                  const double place[3])
{
    uint32_t c = s->first[v];

    do {
        double before[3], after[3];
        if (is_dead(s, c) || s->vertex[beside(c, 1)] == other ||
            s->vertex[beside(c, 2)] == other)
            continue;
        normal_at(s, c, s->node[v].position, before);
        normal_at(s, c, place, after);
        if (dot(before, after) <
            LEAST_COSINE * sqrt(dot(before, before) * dot(after, after)))
            return true;
    } while ((c = s->next[c]) != s->first[v]);
    return false;
}

static void splice(pmesh_session *s, const enc_merge *m)
{
    uint32_t *a = &s->next[s->first[m->gone]], *b = &s->next[s->first[m->kept]];
    const uint32_t other = *a;

    *a = *b;
    *b = other;
}

/* What is in the record becomes true. */
static void apply(pmesh_session *s, uint32_t index)
{
    enc_merge *m = &s->merge[index];
    uint32_t c = s->first[m->gone];

    m->faces = 0;
    do {
        if (!is_dead(s, c) && (s->vertex[beside(c, 1)] == m->kept ||
                               s->vertex[beside(c, 2)] == m->kept)) {
            s->end[c / 3] = index;
            m->faces++;
        }
        s->vertex[c] = m->kept;
    } while ((c = s->next[c]) != s->first[m->gone]);
    splice(s, m);
    s->into[m->gone] = m->kept;
    s->node[m->kept] = m->after;
    s->alive -= m->faces;
}

/* The child's part of what its node got since: alpha, and half of the rest. */
static void hand_down(const enc_node *now, const enc_node *after,
                      enc_node *child)
{
    const double was = enc_quadric_trace(&after->quadric);
    const double alpha = was > 0 ? enc_quadric_trace(&now->quadric) / was : 1;

    if (alpha != 1) {
        enc_quadric none = { .c = 0 };
        for (int i = 0; i < 6; i++)
            none.a[i] = alpha * child->quadric.a[i];
        for (int i = 0; i < 3; i++)
            none.b[i] = alpha * child->quadric.b[i];
        none.c = alpha * child->quadric.c;
        none.weight = alpha * child->quadric.weight;
        child->quadric = none;
    }
    if (now->weight != after->weight)
        child->weight = now->weight;
    if (memcmp(&now->pull, &after->pull, sizeof now->pull) == 0)
        return;
    enc_quadric extra = now->pull;
    double offset[3];
    for (int i = 0; i < 6; i++)
        extra.a[i] = (extra.a[i] - after->pull.a[i]) / 2;
    for (int i = 0; i < 3; i++)
        extra.b[i] = (extra.b[i] - after->pull.b[i]) / 2;
    extra.c = (extra.c - after->pull.c) / 2;
    extra.weight = (extra.weight - after->pull.weight) / 2;
    for (int k = 0; k < 3; k++)
        offset[k] = now->position[k] - child->position[k];
    enc_quadric_add(&child->pull, &extra, offset);
}

static void revert(pmesh_session *s)
{
    enc_merge *m = &s->merge[--s->done];
    const enc_node now = s->node[m->kept];
    uint32_t c;

    splice(s, m);
    s->into[m->gone] = ENC_NOBODY;
    c = s->first[m->gone];
    do {
        s->vertex[c] = m->gone;
        if (s->end[c / 3] == s->done)
            s->end[c / 3] = ENC_NOBODY;
    } while ((c = s->next[c]) != s->first[m->gone]);
    s->alive += m->faces;
    s->node[m->kept] = m->before;
    hand_down(&now, &m->after, &s->node[m->kept]);
    hand_down(&now, &m->after, &s->node[m->gone]);
}

static bool renew_around(pmesh_session *s, uint32_t v)
{
    const uint32_t stamp = new_stamp(s);
    uint32_t c = s->first[v];

    s->age[v]++;
    do {
        for (uint32_t k = 1; k < 3 && !is_dead(s, c); k++) {
            const uint32_t w = s->vertex[beside(c, k)];
            if (s->mark[w] == stamp)
                continue;
            s->mark[w] = stamp;
            if (!push(s, v, w))
                return false;
        }
    } while ((c = s->next[c]) != s->first[v]);
    return true;
}

static void sum_nodes(const enc_node *a, const enc_node *b,
                      const double place[3], enc_node *out)
{
    double from_a[3], from_b[3];

    *out = (enc_node){ .weight = (a->weight + b->weight) / 2 };
    for (int k = 0; k < 3; k++) {
        out->position[k] = place[k];
        from_a[k] = a->position[k] - place[k];
        from_b[k] = b->position[k] - place[k];
    }
    enc_quadric_add(&out->quadric, &a->quadric, from_a);
    enc_quadric_add(&out->quadric, &b->quadric, from_b);
    enc_quadric_add(&out->pull, &a->pull, from_a);
    enc_quadric_add(&out->pull, &b->pull, from_b);
}

/* One contraction that was not known; *found is false if there is none. */
static bool contract(pmesh_session *s, bool *found)
{
    *found = false;
    if (!s->fresh && !fill(s))
        return false;
    while (s->heap_count > 0) {
        const enc_choice choice = pop(s);
        const uint32_t u = choice.ends[1], v = choice.ends[0];
        double place[3], square;
        if (is_stale(s, &choice))
            continue;
        price(s, v, u, place, &square);
        if (!keeps_topology(s, u, v) || flips(s, u, v, place) ||
            flips(s, v, u, place))
            continue;
        enc_merge *m = &s->merge[s->done];
        *m = (enc_merge){ .gone = u, .kept = v, .before = s->node[v] };
        sum_nodes(&s->node[u], &s->node[v], place, &m->after);
        m->error = fmax(square, fmax(s->error[u], s->error[v]));
        s->error[v] = m->error;
        apply(s, s->done);
        s->known = ++s->done;
        *found = true;
        s->fresh = renew_around(s, v);
        return s->fresh;
    }
    return true;
}

bool enc_session_walk(pmesh_session *s, size_t faces)
{
    bool found = true;

    while (s->alive > faces && found) {
        if (s->done < s->known)
            apply(s, s->done++);
        else if (!contract(s, &found))
            return false;
    }
    while (s->done > 0 && s->alive + s->merge[s->done - 1].faces <= faces)
        revert(s);
    if (s->done < s->old) { /* what was made before the guidance */
        s->old = s->done;
        enc_session_forget(s);
    }
    return true;
}

/* ---- beginning ----------------------------------------------------------- */

void enc_session_forget(pmesh_session *s)
{
    s->known = s->done;
    s->fresh = false;
    memset(s->error, 0, s->vertex_count * sizeof *s->error);
    for (uint32_t i = 0; i < s->done; i++)
        s->error[s->merge[i].kept] = s->merge[i].error;
}

/* Boundaries are held by upright planes, as in enc_star.c. */
#define BOUNDARY_WEIGHT 10.0

static bool is_boundary(const pmesh_session *s, uint32_t h)
{
    const uint32_t v = s->vertex[beside(h, 1)];
    uint32_t c = s->first[s->vertex[h]], faces = 0;

    do
        for (uint32_t k = 1; k < 3; k++)
            faces += s->vertex[beside(c, k)] == v;
    while ((c = s->next[c]) != s->first[s->vertex[h]]);
    return faces == 1;
}

static void hold_edge(pmesh_session *s, uint32_t h, const double normal[3])
{
    enc_node *a = &s->node[s->vertex[h]], *b = &s->node[s->vertex[beside(h, 1)]];
    double along[3], upright[3];

    for (int k = 0; k < 3; k++)
        along[k] = b->position[k] - a->position[k];
    cross(along, normal, upright);
    if (!(dot(upright, upright) > 0))
        return;
    const double weight = BOUNDARY_WEIGHT * dot(along, along);
    enc_quadric_add_plane(&a->quadric, upright, weight);
    enc_quadric_add_plane(&b->quadric, upright, weight);
}

static void add_planes(pmesh_session *s, uint32_t face)
{
    double n[3];

    normal_at(s, 3 * face, s->node[s->vertex[3 * face]].position, n);
    const double square = dot(n, n);
    for (uint32_t k = 0; k < 3 && square > 0; k++)
        enc_quadric_add_plane(&s->node[s->vertex[3 * face + k]].quadric, n,
                              0.5 * sqrt(square));
    for (uint32_t h = 3 * face; h < 3 * face + 3; h++)
        if (is_boundary(s, h))
            hold_edge(s, h, n);
}

void enc_session_reset(pmesh_session *s)
{
    memset(s->first, 0xff, s->vertex_count * sizeof *s->first);
    memset(s->into, 0xff, s->vertex_count * sizeof *s->into);
    s->done = s->old = 0;
    s->alive = 0;
    for (uint32_t v = 0; v < s->vertex_count; v++) {
        s->node[v] = (enc_node){ .weight = 0.5 };
        memcpy(s->node[v].position, s->input + 3 * (size_t)v,
               3 * sizeof(double));
    }
    for (uint32_t c = 0; c < 3 * s->face_count; c++) {
        const uint32_t v = s->vertex[c] = s->original[c];
        if (s->first[v] == ENC_NOBODY) {
            s->first[v] = s->next[c] = c;
        } else {
            s->next[c] = s->next[s->first[v]];
            s->next[s->first[v]] = c;
        }
    }
    for (uint32_t f = 0; f < s->face_count; f++) {
        const uint32_t *v = &s->vertex[3 * f];
        const bool flat = v[0] == v[1] || v[1] == v[2] || v[2] == v[0];
        s->end[f] = flat ? ENC_NOBODY - 1 : ENC_NOBODY;
        s->alive += !flat;
        if (!flat)
            add_planes(s, f);
    }
    enc_session_forget(s);
}
