/* SPDX-License-Identifier: MIT */
#include "encoder/enc_join.h"

#include <string.h>

#include "encoder/enc_bits.h"
#include "encoder/enc_schedule.h"
#include "format/layout.h"

enum { MAX_FANS = ENC_MAX_STAR / 2 };

/* A fan: members first .. first + count - 1 of its star, the first `faces` of
 * them with the half-edge that leads there; and the fan of the other star that
 * it becomes one with. */
typedef struct fan {
    uint32_t first, count, faces;
    uint32_t to;   /* place of the other vertex in the ring, or ENC_NONE */
    uint32_t with; /* ENC_NONE: none */
} fan;

/* All fans of a vertex. */
typedef struct star {
    uint32_t fan_count, members; /* ghosts included */
    uint32_t count;
    fan fan[MAX_FANS];
    uint32_t vertex[ENC_MAX_STAR], edge[ENC_MAX_STAR];
} star;

static bool is_open(const fan *f)
{
    return f->faces < f->count;
}

/* False if there is no room; the members that are `other` are noted, and may
 * be one a fan. */
static bool gather_fan(const enc_surface *s, uint32_t start, uint32_t other,
                       star *out)
{
    fan *f = &out->fan[out->fan_count];
    uint32_t h = start, last;
    if (out->fan_count++ == MAX_FANS)
        return false;
    *f = (fan){ out->count, 0, 0, ENC_NONE, ENC_NONE };
    do {
        if (out->count == ENC_MAX_STAR)
            return false;
        out->edge[out->count] = h;
        out->vertex[out->count++] = s->vertex[enc_next(h)];
        f->faces++;
        last = enc_prev(h);
        h = s->twin[last];
    } while (h != ENC_NONE && h != start);
    f->count = f->faces;
    if (h == ENC_NONE) {
        if (out->count == ENC_MAX_STAR)
            return false;
        out->vertex[out->count++] = s->vertex[last];
        f->count++;
    }
    for (uint32_t i = 0; i < f->count; i++) {
        if (out->vertex[f->first + i] != other)
            continue;
        if (f->to != ENC_NONE)
            return false;
        f->to = i;
    }
    out->members += f->count + is_open(f);
    return true;
}

static bool gather(const enc_surface *s, uint32_t v, uint32_t other, star *out)
{
    out->fan_count = out->members = out->count = 0;
    for (uint32_t h = s->first[v]; h != ENC_NONE; h = enc_next_fan(s, h))
        if (!gather_fan(s, h, other, out))
            return false;
    return true;
}

/* The faces of a fan that have both vertices: the half-edges between the two,
 * behind the other's place and before it, or ENC_NONE. */
static void dying(const star *x, const fan *f, uint32_t out[2])
{
    out[0] = f->to < f->faces ? x->edge[f->first + f->to] : ENC_NONE;
    out[1] = ENC_NONE;
    if (f->to > 0)
        out[1] = enc_prev(x->edge[f->first + f->to - 1]);
    else if (!is_open(f))
        out[1] = enc_prev(x->edge[f->first + f->count - 1]);
}

/* The fan of y in which the face of half-edge d dies, too. */
static uint32_t partner(const star *y, uint32_t d)
{
    for (uint32_t j = 0; j < y->fan_count; j++) {
        uint32_t there[2];
        if (y->fan[j].to == ENC_NONE)
            continue;
        dying(y, &y->fan[j], there);
        for (int i = 0; i < 2; i++)
            if (there[i] != ENC_NONE && there[i] / 3 == d / 3)
                return j;
    }
    return ENC_NONE;
}

static uint32_t common_members(const star *x, const fan *f, const star *y,
                               const fan *g)
{
    uint32_t common = 0;
    for (uint32_t i = 0; i < f->count; i++)
        for (uint32_t k = 0; k < g->count; k++)
            common += x->vertex[f->first + i] == y->vertex[g->first + k];
    return common;
}

static bool wing_can_spare(const enc_surface *s, uint32_t d)
{
    bool open;
    const uint32_t faces = enc_surface_fan_faces(s, enc_prev(d), &open);
    return faces >= (open ? 2 : 3);
}

/* The link condition for two fans with an edge in common (the ghost being a
 * vertex), or one face that is all of both. */
static bool can_merge(const enc_surface *s, const star *x, const fan *f,
                      const star *y, const fan *g, enc_link *link)
{
    uint32_t edge[2];
    dying(x, f, edge);
    const bool inner = edge[0] != ENC_NONE && edge[1] != ENC_NONE;
    if (f->faces == 1 && g->faces == 1) {
        link->edge[link->count++] = edge[0] != ENC_NONE ? edge[0] : edge[1];
        return ++link->lone <= PMESH_MAX_LONE;
    }
    if (!is_open(f) && !is_open(g) && f->count == 2 && g->count == 2) {
        if (link->pair != ENC_NONE)
            return false;
        link->pair = link->count;
        link->edge[link->count++] = edge[0];
        link->edge[link->count++] = edge[1];
        return true;
    }
    if (common_members(x, f, y, g) != (inner ? 2 : 1) ||
        (inner && is_open(f) && is_open(g)))
        return false;
    const uint32_t merged =
        f->count + is_open(f) + g->count + is_open(g) - 4;
    if (merged < (is_open(f) || is_open(g) ? 3 : 2))
        return false;
    for (int i = 0; i < 2; i++) {
        if (edge[i] == ENC_NONE)
            continue;
        if (!wing_can_spare(s, edge[i]))
            return false;
        link->edge[link->count++] = edge[i];
    }
    link->merged++;
    link->held[0] |= inner && is_open(f);
    link->held[1] |= inner && is_open(g);
    return !inner || s->vertex[enc_prev(edge[0])] !=
                         s->vertex[enc_prev(edge[1])];
}

static bool is_lone(const enc_surface *s, uint32_t d)
{
    return s->twin[d] == ENC_NONE && s->twin[enc_next(d)] == ENC_NONE &&
           s->twin[enc_prev(d)] == ENC_NONE;
}

/* The wing's fan goes with the face; of a pair, with the first. */
static bool takes_fan(const enc_surface *s, const enc_link *link, uint32_t i)
{
    return i == link->pair || is_lone(s, link->edge[i]);
}

static bool in_one_fan(const enc_surface *s, uint32_t c, uint32_t other)
{
    uint32_t h = c;
    do {
        if (h == other)
            return true;
        h = enc_turn(s, h);
    } while (h != ENC_NONE && h != c);
    for (h = c; s->twin[h] != ENC_NONE && enc_next(s->twin[h]) != c;) {
        h = enc_next(s->twin[h]);
        if (h == other)
            return true;
    }
    return false;
}

/* No fan loses two faces, and no vertex its last fan. */
static bool wings_are_safe(const enc_surface *s, const enc_link *link)
{
    for (uint32_t i = 0; i < link->count; i++) {
        const uint32_t c = enc_prev(link->edge[i]), w = s->vertex[c];
        uint32_t fans = 0;
        for (uint32_t k = 0; k < i; k++) {
            const uint32_t other = enc_prev(link->edge[k]);
            if (s->vertex[other] == w && in_one_fan(s, c, other) &&
                k != link->pair)
                return false;
        }
        if (!takes_fan(s, link, i))
            continue;
        for (uint32_t h = s->first[w]; h != ENC_NONE; h = enc_next_fan(s, h))
            fans++;
        for (uint32_t k = 0; k < link->count; k++)
            fans -= s->vertex[enc_prev(link->edge[k])] == w &&
                    takes_fan(s, link, k);
        if (fans == 0)
            return false;
    }
    return true;
}

/* A face of each over the same two other vertices. */
static bool will_double(const enc_surface *s, const star *x, const star *y)
{
    for (uint32_t i = 0; i < x->fan_count; i++)
        for (uint32_t k = 0; k < x->fan[i].faces; k++) {
            const uint32_t h = x->edge[x->fan[i].first + k];
            const uint32_t a = s->vertex[enc_next(h)],
                           b = s->vertex[enc_prev(h)];
            for (uint32_t j = 0; j < y->fan_count; j++)
                for (uint32_t l = 0; l < y->fan[j].faces; l++) {
                    const uint32_t g = y->edge[y->fan[j].first + l];
                    const uint32_t c = s->vertex[enc_next(g)],
                                   d = s->vertex[enc_prev(g)];
                    if ((a == c && b == d) || (a == d && b == c))
                        return true;
                }
        }
    return false;
}

/* Of both rings: an edge's ends leave them, wings and ghosts were in both. */
static uint32_t lost_members(const enc_link *link)
{
    return 4 * (link->merged + (link->pair != ENC_NONE)) + 6 * link->lone;
}

bool enc_join_link(const enc_surface *s, uint32_t u, uint32_t v, enc_link *link)
{
    star x, y;
    link->count = link->merged = link->lone = 0;
    link->held[0] = link->held[1] = false;
    link->pair = ENC_NONE;
    if (!gather(s, u, v, &x) || !gather(s, v, u, &y))
        return false;
    for (uint32_t i = 0; i < x.fan_count; i++) {
        fan *f = &x.fan[i];
        uint32_t edge[2];
        if (f->to == ENC_NONE)
            continue;
        dying(&x, f, edge);
        const uint32_t j = partner(&y, edge[0] != ENC_NONE ? edge[0] : edge[1]);
        if (j == ENC_NONE || y.fan[j].with != ENC_NONE)
            return false;
        f->with = j;
        y.fan[j].with = i;
        if (!can_merge(s, &x, f, &y, &y.fan[j], link))
            return false;
    }
    for (uint32_t j = 0; j < y.fan_count; j++)
        if (y.fan[j].to != ENC_NONE && y.fan[j].with == ENC_NONE)
            return false;
    const uint32_t members = x.members + y.members - lost_members(link);
    if (members < 2 || members > ENC_MAX_RING || !wings_are_safe(s, link))
        return false;
    link->doubles = will_double(s, &x, &y);
    if (link->count == 0 && link->doubles)
        return false;
    return !link->held[0] || !link->held[1];
}

bool enc_join_is_general(const enc_surface *s, uint32_t h)
{
    const uint32_t u = s->vertex[h], v = s->vertex[enc_next(h)];
    uint32_t edges = 0, last;
    if (enc_next_fan(s, s->first[u]) != ENC_NONE ||
        enc_next_fan(s, s->first[v]) != ENC_NONE || is_lone(s, h))
        return true;
    h = s->first[u];
    do {
        edges += s->vertex[enc_next(h)] == v;
        last = enc_prev(h);
        h = s->twin[last];
    } while (h != ENC_NONE && h != s->first[u]);
    edges += h == ENC_NONE && s->vertex[last] == v;
    return edges != 1;
}

bool enc_join_is_lowest(const enc_surface *s, uint32_t h)
{
    const uint32_t u = s->vertex[h], v = s->vertex[enc_next(h)];
    uint32_t start = s->first[u];
    for (uint32_t k = start; k != ENC_NONE; k = enc_around(s, &start, k)) {
        const uint32_t last = enc_prev(k);
        if ((s->vertex[enc_next(k)] == v && k < h) ||
            (s->vertex[last] == v && last < h))
            return false;
    }
    return true;
}

/* ---- contraction --------------------------------------------------------- */

/* The start of the fan of corner c; of a closed one its lowest half-edge. */
static uint32_t start_of(const enc_surface *s, uint32_t c)
{
    uint32_t h = c, lowest = c;
    while (s->twin[h] != ENC_NONE) {
        h = enc_next(s->twin[h]);
        if (h == c)
            return lowest;
        lowest = h < lowest ? h : lowest;
    }
    return h;
}

static void add_start(enc_surface *s, uint32_t v, uint32_t start)
{
    uint32_t *at = &s->first[v];
    while (*at != ENC_NONE && *at != start)
        at = &s->fan[*at];
    if (*at == start)
        return;
    *at = start;
    s->fan[start] = ENC_NONE;
}

/* Two faces that are glued on all sides, by their half-edges between the two
 * vertices. */
static void remove_pair(enc_surface *s, const uint32_t edge[2])
{
    const uint32_t wing = s->vertex[enc_prev(edge[0])];
    uint32_t *at = &s->first[wing];
    while (*at / 3 != edge[0] / 3 && *at / 3 != edge[1] / 3)
        at = &s->fan[*at];
    *at = s->fan[*at];
    s->degree[wing] -= 2;
    for (int i = 0; i < 2; i++)
        enc_surface_bury_face(s, edge[i] / 3);
    s->face_count -= 2;
}

void enc_join_contract(enc_surface *s, uint32_t child, uint32_t parent,
                       const enc_link *link, const int32_t place[3],
                       const uint32_t *wedge_parent)
{
    const uint32_t vertex[2] = { parent, child };
    uint32_t corner[2 * ENC_MAX_STAR], count = 0;
    for (int i = 0; i < 2; i++) {
        uint32_t start = s->first[vertex[i]];
        for (uint32_t h = start; h != ENC_NONE; h = enc_around(s, &start, h))
            corner[count++] = h;
    }
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t h = corner[i];
        if (s->wedge && s->vertex[h] == child)
            s->wedge[h] = wedge_parent[s->wedge[h]];
        s->vertex[h] = parent;
        enc_bit_put(s->changed, h / 3);
    }
    if (link->pair != ENC_NONE)
        remove_pair(s, link->edge + link->pair);
    for (uint32_t i = 0; i < link->count; i++)
        if (s->vertex[link->edge[i]] != ENC_NONE)
            enc_surface_remove_face(s, link->edge[i]);
    s->first[child] = s->first[parent] = ENC_NONE;
    for (uint32_t i = 0; i < count; i++)
        if (s->vertex[corner[i]] != ENC_NONE)
            add_start(s, parent, start_of(s, corner[i]));
    s->degree[parent] += s->degree[child] - lost_members(link);
    memcpy(s->position[parent], place, sizeof s->position[0]);
    s->vertex_count--;
}
