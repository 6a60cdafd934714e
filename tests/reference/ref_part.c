/* SPDX-License-Identifier: MIT */
/* SPEC 6.3, joined files: how the fans of a vertex part. */
#include "tests/reference/ref.h"

enum { CUT, STAYS, MOVES };
enum { PLAIN, TURNED, PAIR };

typedef struct parting {
    int way[REF_PARTS];
    ref_cut cut[REF_PARTS];
    int lones;
    int kind[REF_LONE];
    uint32_t third[REF_LONE];
} parting;

ref_fans ref_fans_of(const ref *r, uint32_t v)
{
    ref_fans f = { 0 };
    for (uint32_t h = ref_fan(r, v, 0); h != REF_NONE;
         h = ref_fan(r, v, f.count)) {
        if (f.count == REF_PARTS) {
            f.large = true;
            break;
        }
        const ref_ring ring = ref_ring_from(r, h);
        f.ring[f.count++] = ring;
        f.members += ring.count + ring.open;
        f.large = f.large || ring.large || f.members > REF_MEMBERS;
        if (f.large)
            break;
    }
    return f;
}

static int read_ways(ref *r, uint32_t v, const ref_fans *fans, parting *p)
{
    ref_join_models *m = &r->join;
    int any = 0, last = 0;
    for (int i = 0; i < fans->count; i++) {
        if (!ref_bit(&r->in, &m->whole[fans->count == 1 ? 0 : 1 + any])) {
            p->way[i] = CUT;
            p->cut[i] = ref_read_cut(r, v, &fans->ring[i]);
            any = 1;
            continue;
        }
        last = 1 + ref_bit(&r->in, &m->moves[any][last]);
        p->way[i] = last == 1 ? STAYS : MOVES;
        if (last == 1)
            REF_SEEN(fan_stays);
        else
            REF_SEEN(fan_moves);
    }
    return any;
}

static uint32_t read_third(ref *r, uint32_t v, const ref_fans *fans)
{
    const uint32_t n = r->vertex_count - 1; /* u is none yet */
    if (ref_bit(&r->in, &r->join.far)) {
        const uint64_t w = ref_raw(&r->in, ref_bits(n - 1));
        REF_SEEN(third_far);
        ref_check(r, w < n && w != v, "6.3: third vertex");
        return (uint32_t)w;
    }
    uint64_t place = ref_read_number(&r->in, &r->join.member);
    REF_SEEN(third_member);
    for (int i = 0; i < fans->count; i++) {
        if (place < (uint64_t)fans->ring[i].count) {
            const uint32_t w = fans->ring[i].vertex[place];
            ref_check(r, w != v, "6.3: third vertex");
            return w;
        }
        place -= (uint64_t)fans->ring[i].count;
    }
    ref_reject(r, "6.3: third vertex");
}

static void read_lones(ref *r, uint32_t v, const ref_fans *fans, parting *p,
                       int any)
{
    ref_join_models *m = &r->join;
    while (p->lones < REF_LONE &&
           ref_bit(&r->in, &m->lone[p->lones > 0 ? 2 : any])) {
        int kind = PAIR;
        if (!ref_bit(&r->in, &m->pair))
            kind = ref_bit(&r->in, &m->turned) ? TURNED : PLAIN;
        p->kind[p->lones] = kind;
        p->third[p->lones++] = read_third(r, v, fans);
    }
}

static void add_fan(ref *r, uint32_t v, uint32_t start)
{
    ref_check(r, ref_add_fan(r, v, start), "6.3: too many fans");
}

/* Twins run opposite ways between the same two vertices. */
static void glue(ref *r, uint32_t f, uint32_t g)
{
    ref_join(r, f, g);         /* v-u */
    ref_join(r, f + 1, g + 2); /* u-w */
    ref_join(r, f + 2, g + 1); /* w-v */
}

static void add_lone(ref *r, uint32_t v, int kind, uint32_t w,
                     ref_fresh *fresh)
{
    const uint32_t u = fresh->u, x = kind == TURNED ? u : v,
                   y = kind == TURNED ? v : u;
    const uint32_t f = 3 * ref_new_face(r, x, y, w);
    fresh->lone[fresh->lones++] = f;
    add_fan(r, x, f);
    add_fan(r, y, f + 1);
    add_fan(r, w, f + 2);
    if (kind == TURNED)
        REF_SEEN(lone_turned);
    else if (kind == PLAIN)
        REF_SEEN(lone_plain);
    if (kind != PAIR)
        return;
    REF_SEEN(lone_pair);
    const uint32_t g = 3 * ref_new_face(r, y, x, w);
    fresh->lone[fresh->lones++] = g;
    glue(r, f, g);
}

static void part_whole(ref *r, uint32_t v, const ref_ring *ring, bool moves,
                       uint32_t u)
{
    for (int i = 0; moves && i < ring->faces; i++)
        r->edge[ring->edge[i]].vertex = u;
    add_fan(r, moves ? u : v, ring->edge[0]);
}

void ref_part(ref *r, uint32_t v, const ref_fans *fans, ref_fresh *fresh)
{
    parting p = { .lones = 0 };
    const int any = read_ways(r, v, fans, &p);
    read_lones(r, v, fans, &p, any);
    r->vertex[v].first = REF_NONE;
    r->vertex[v].more = 0;
    for (int i = 0; i < fans->count; i++) {
        uint32_t start;
        if (p.way[i] != CUT)
            continue;
        ref_cut_fan(r, v, &fans->ring[i], p.cut[i], fresh, &start);
        add_fan(r, v, start);
        add_fan(r, fresh->u, fresh->start[fresh->cuts - 1]);
    }
    if (fresh->cuts > 1)
        REF_SEEN(cut_several);
    for (int i = 0; i < fans->count; i++)
        if (p.way[i] != CUT)
            part_whole(r, v, &fans->ring[i], p.way[i] == MOVES, fresh->u);
    for (int i = 0; i < p.lones; i++)
        add_lone(r, v, p.kind[i], p.third[i], fresh);
    ref_check(r,
              r->vertex[v].first != REF_NONE &&
                  r->vertex[fresh->u].first != REF_NONE,
              "6.3: a vertex without faces");
}
