/* SPDX-License-Identifier: MIT */
/* SPEC 6.6: materials and wedges. */
#include "tests/reference/ref.h"

/* ---- materials ---------------------------------------------------------- */

static uint32_t read_material(ref *r, uint32_t g, uint32_t s)
{
    ref_wedge_models *m = &r->wedge_models;
    const int differ = g != s;
    if (!ref_bit(&r->in, &m->material[differ]))
        return g;
    if (differ && !ref_bit(&r->in, &m->material[2])) {
        REF_SEEN(material_second);
        return s;
    }
    const uint64_t picked = ref_read_number(&r->in, &m->pick);
    REF_SEEN(material_picked);
    ref_check(r, picked < r->header.material_count, "6.6: material");
    return (uint32_t)picked;
}

void ref_read_base_materials(ref *r)
{
    if (r->header.material_count == 1)
        return;
    for (uint32_t f = 0; f < r->face_count; f++) {
        const uint32_t guess = f > 0 ? r->material[f - 1] : 0;
        r->material[f] = read_material(r, guess, guess);
    }
}

static uint32_t material_across(const ref *r, uint32_t g, uint32_t h)
{
    const uint32_t twin = r->edge[g].twin;
    if (twin != REF_NONE)
        return r->material[twin / 3];
    const uint32_t other = r->edge[h].twin;
    return other != REF_NONE ? r->material[other / 3] : 0;
}

/* Of a face over its outer edges g, h. */
static void read_over(ref *r, uint32_t g, uint32_t h)
{
    r->material[g / 3] = read_material(r, material_across(r, g, h),
                                       material_across(r, h, g));
}

/* The first corner of v in a face older than the split, or NONE. */
static uint32_t older_corner(const ref *r, uint32_t v, const ref_fresh *fresh)
{
    ref_walk w = ref_walk_at(r, v);
    while (w.h != REF_NONE && w.h / 3 >= fresh->first_face)
        ref_walk_on(r, &w);
    return w.h;
}

static uint32_t older_of_both(const ref *r, const ref_fresh *fresh)
{
    const uint32_t corner =
        older_corner(r, r->vertex[fresh->u].parent, fresh);
    if (corner != REF_NONE)
        return corner;
    REF_SEEN(lone_like_child);
    return older_corner(r, fresh->u, fresh);
}

void ref_read_split_materials(ref *r, const ref_fresh *fresh)
{
    for (int i = 0; i < fresh->cuts; i++) {
        const uint32_t a = fresh->a[i], b = fresh->b[i];
        if (a != REF_NONE)
            read_over(r, a, a + 1); /* v-a, a-u */
        if (b != REF_NONE)
            read_over(r, b + 2, b + 1); /* b-v, u-b */
    }
    for (int i = 0; i < fresh->lones; i++) {
        const uint32_t like = r->material[older_of_both(r, fresh) / 3];
        r->material[fresh->lone[i] / 3] = read_material(r, like, like);
    }
}

/* ---- corners ------------------------------------------------------------ */

static void new_wedge(ref *r, uint32_t corner)
{
    const ref_level *level = &r->header.level[r->levels];
    ref_check(r, r->wedge_count < level->wedges, "6.6: too many wedges");
    ref_check(r,
              !r->has_base || r->wedge_count - r->block_wedge <
                                  r->header.block_wedges,
              "6.6: more than block_wedges");
    ref_new_wedge(r, corner);
}

/* Of the vertex' wedges, from the highest number down. */
static void read_place(ref *r, uint32_t corner)
{
    uint64_t over = ref_read_number(&r->in, &r->wedge_models.pick);
    REF_SEEN(place);
    ref_check(r, over < 4096, "6.6: place");
    for (uint32_t w = r->wedge_count; w-- > 0;)
        if (r->wedge[w].vertex == r->edge[corner].vertex && over-- == 0) {
            r->edge[corner].wedge = w;
            return;
        }
    ref_reject(r, "6.6: a place without wedge");
}

/* Of the edge of half-edge h, at its end x. */
static int seam(const ref *r, uint32_t h, uint32_t x)
{
    if (h == REF_NONE || r->edge[h].twin == REF_NONE)
        return 2;
    const uint32_t twin = r->edge[h].twin;
    uint32_t w[2] = { r->edge[h].wedge, r->edge[ref_next(twin)].wedge };
    if (ref_end_of(r, h) == x) {
        w[0] = r->edge[ref_next(h)].wedge;
        w[1] = r->edge[twin].wedge;
    }
    return w[0] == REF_NONE || w[1] == REF_NONE ? 2 : w[0] != w[1];
}

/* Returns whether the corner got a new wedge. */
static bool read_corner(ref *r, uint32_t corner, uint32_t g, uint32_t s, int E,
                        int F)
{
    ref_wedge_models *m = &r->wedge_models;
    if (g == REF_NONE) {
        g = s;
        s = REF_NONE;
    }
    if (g != REF_NONE) {
        const int agree = s == REF_NONE ? 0 : g == s ? 1 : 2;
        if (!ref_bit(&r->in, &m->corner[agree][E][F])) {
            r->edge[corner].wedge = g;
            return false;
        }
        if (agree == 2 && !ref_bit(&r->in, &m->corner[3][E][F])) {
            REF_SEEN(corner_second);
            r->edge[corner].wedge = s;
            return false;
        }
    }
    if (ref_bit(&r->in, &m->choice[0])) {
        REF_SEEN(corner_place);
        read_place(r, corner);
        return false;
    }
    REF_SEEN(corner_new);
    new_wedge(r, corner);
    return true;
}

void ref_read_base_wedges(ref *r)
{
    for (uint32_t v = 0; v < r->vertex_count; v++) {
        uint32_t before = REF_NONE;
        for (ref_walk w = ref_walk_at(r, v); w.h != REF_NONE;
             ref_walk_on(r, &w)) {
            if (before == REF_NONE)
                new_wedge(r, w.h);
            else
                read_corner(r, w.h, before, REF_NONE, 2, 2);
            before = r->edge[w.h].wedge;
        }
    }
}

/* ---- a split ------------------------------------------------------------ */

typedef struct other {
    uint32_t corner, guess[2];
    uint32_t e, f; /* edges at u and at v, or NONE */
} other;

typedef struct change {
    uint32_t corner[REF_CORNERS], coarse[REF_CORNERS]; /* of u */
    int count;
    other other[REF_CORNERS];
    int others;
    uint32_t first_wedge; /* that the split makes */
} change;

static uint32_t wedge_or_none(const ref *r, uint32_t corner)
{
    return corner == REF_NONE ? REF_NONE : r->edge[corner].wedge;
}

static uint32_t next_or_none(uint32_t h)
{
    return h == REF_NONE ? h : ref_next(h);
}

static void add_other(change *c, uint32_t corner, uint32_t g, uint32_t s,
                      uint32_t e, uint32_t f)
{
    c->other[c->others++] = (other){ corner, { g, s }, e, f };
}

/* The corners of u, whose wedges of before go to coarse[]. */
static void list_corners(const ref *r, change *c, uint32_t u)
{
    for (ref_walk w = ref_walk_at(r, u); w.h != REF_NONE;
         ref_walk_on(r, &w)) {
        c->corner[c->count] = w.h;
        c->coarse[c->count++] = r->edge[w.h].wedge;
    }
}

static void clear_corners(ref *r, const change *c)
{
    for (int i = 0; i < c->count; i++)
        r->edge[c->corner[i]].wedge = REF_NONE;
}

static uint32_t first_coarse(const change *c)
{
    for (int i = 0; i < c->count; i++)
        if (c->coarse[i] != REF_NONE)
            return c->coarse[i];
    return REF_NONE;
}

/* The first coarse wedge of u's part of a fan that was cut. */
static uint32_t coarse_of_part(const ref *r, const ref_fresh *fresh, int i)
{
    uint32_t h = fresh->start[i];
    while (h != REF_NONE && h / 3 >= fresh->first_face)
        h = ref_left(r, h);
    return wedge_or_none(r, h);
}

static void list_lones(const ref *r, change *c, const ref_fresh *fresh)
{
    for (int i = 0; i < fresh->lones; i++) {
        const uint32_t f = fresh->lone[i];
        const uint32_t at_v = ref_start_of(r, f) == fresh->u ? f + 1 : f;
        const uint32_t w = ref_start_of(r, f + 2);
        add_other(c, at_v, wedge_or_none(r, older_of_both(r, fresh)),
                  REF_NONE, REF_NONE, REF_NONE);
        add_other(c, f + 2, wedge_or_none(r, older_corner(r, w, fresh)),
                  REF_NONE, REF_NONE, REF_NONE);
    }
}

/* Guesses come over the outer edges: v-a, a-u, u-b, b-v. */
static void list_others(const ref *r, change *c, const ref_fresh *fresh, int i)
{
    const uint32_t a = fresh->a[i], b = fresh->b[i];
    uint32_t va = REF_NONE, au = REF_NONE, ub = REF_NONE, bv = REF_NONE;
    if (a != REF_NONE) {
        va = r->edge[a].twin;
        au = r->edge[a + 1].twin;
    }
    if (b != REF_NONE) {
        ub = r->edge[b + 1].twin;
        bv = r->edge[b + 2].twin;
    }
    uint32_t v_at_a = wedge_or_none(r, next_or_none(va));
    const uint32_t v_at_b = wedge_or_none(r, bv);
    if (v_at_a == REF_NONE && v_at_b == REF_NONE) {
        REF_SEEN(v_without_guess);
        v_at_a = coarse_of_part(r, fresh, i);
    }
    if (a != REF_NONE) {
        add_other(c, a, v_at_a, v_at_b, a + 1, REF_NONE);
        add_other(c, a + 1, wedge_or_none(r, next_or_none(au)),
                  wedge_or_none(r, va), a + 1, a);
    }
    if (b != REF_NONE) {
        add_other(c, b, v_at_b, v_at_a, b + 1, REF_NONE);
        add_other(c, b + 2, wedge_or_none(r, ub),
                  wedge_or_none(r, next_or_none(bv)), b + 1, b + 2);
    }
}

static uint32_t only_guess(const other *o)
{
    return o->guess[0] != REF_NONE ? o->guess[0] : o->guess[1];
}

static int ordinary_context(const change *c)
{
    uint32_t before = REF_NONE;
    for (int i = 0; i < c->count; i++) {
        if (c->coarse[i] == REF_NONE)
            continue;
        if (before != REF_NONE && c->coarse[i] != before)
            return 2;
        before = c->coarse[i];
    }
    for (int i = 0; i < c->others; i++)
        if (c->other[i].guess[1] != REF_NONE &&
            c->other[i].guess[0] != c->other[i].guess[1])
            return 1;
    return 0;
}

static void take_ordinary(ref *r, const change *c)
{
    new_wedge(r, c->corner[0]);
    for (int i = 1; i < c->count; i++)
        r->edge[c->corner[i]].wedge = c->first_wedge;
    for (int i = 0; i < c->others; i++) {
        const uint32_t guess = only_guess(&c->other[i]);
        ref_check(r, guess != REF_NONE, "6.6: a missing guess");
        r->edge[c->other[i].corner].wedge = guess;
    }
}

static void read_child_corners(ref *r, const change *c)
{
    ref_wedge_models *m = &r->wedge_models;
    new_wedge(r, c->corner[0]);
    for (int i = 1; i < c->count; i++) {
        const uint32_t here = c->coarse[i], before = c->coarse[i - 1];
        const int s =
            here == REF_NONE || before == REF_NONE ? 2 : here != before;
        const int x =
            seam(r, c->corner[i], ref_end_of(r, c->corner[i]));
        if (!ref_bit(&r->in, &m->seam[s][x])) {
            r->edge[c->corner[i]].wedge = r->edge[c->corner[i - 1]].wedge;
        } else if (ref_bit(&r->in, &m->choice[1])) {
            REF_SEEN(child_place);
            read_place(r, c->corner[i]);
        } else {
            REF_SEEN(child_seam);
            new_wedge(r, c->corner[i]);
        }
    }
}

/* The first at the vertex' corners, if one has one. */
static uint32_t first_wedge_of(const ref *r, uint32_t v, uint32_t but)
{
    for (ref_walk w = ref_walk_at(r, v); w.h != REF_NONE;
         ref_walk_on(r, &w)) {
        const uint32_t wedge = r->edge[w.h].wedge;
        if (wedge != REF_NONE && wedge != but)
            return wedge;
    }
    return REF_NONE;
}

static void read_others(ref *r, const change *c, uint32_t u)
{
    const uint32_t v = r->vertex[u].parent;
    for (int i = 0; i < c->others; i++) {
        const other *o = &c->other[i];
        if (!read_corner(r, o->corner, o->guess[0], o->guess[1],
                         seam(r, o->e, u), seam(r, o->f, v)))
            continue;
        const uint32_t made = r->edge[o->corner].wedge;
        uint32_t like = only_guess(o);
        if (like == REF_NONE) /* not with manifolds: a face is beside it */
            like = first_wedge_of(r, r->edge[o->corner].vertex, made);
        if (like != REF_NONE)
            r->wedge[made].from = r->wedge[like].from;
    }
}

static void set_parents(ref *r, const change *c)
{
    for (int i = 0; i < c->count; i++) {
        uint32_t *from = &r->wedge[r->edge[c->corner[i]].wedge].from;
        if (c->coarse[i] == REF_NONE)
            continue;
        ref_check(r, *from == REF_NONE || *from == c->coarse[i],
                  "6.6: two parents of a wedge");
        *from = c->coarse[i];
    }
    for (int i = 0; i < c->count; i++) {
        uint32_t *from = &r->wedge[r->edge[c->corner[i]].wedge].from;
        if (*from != REF_NONE)
            continue;
        REF_SEEN(wedge_without_coarse);
        if (c->others > 0)
            *from = only_guess(&c->other[0]);
        if (*from == REF_NONE)
            *from = first_coarse(c);
    }
}

void ref_read_split_wedges(ref *r, const ref_fresh *fresh)
{
    change c = { .first_wedge = r->wedge_count };
    list_corners(r, &c, fresh->u);
    for (int i = 0; i < fresh->cuts; i++)
        list_others(r, &c, fresh, i);
    list_lones(r, &c, fresh);
    clear_corners(r, &c);
    const int context = ordinary_context(&c);
    if (!ref_bit(&r->in, &r->wedge_models.ordinary[context])) {
        REF_SEEN(ordinary);
        take_ordinary(r, &c);
        set_parents(r, &c);
    } else {
        REF_SEEN(not_ordinary);
        read_child_corners(r, &c);
        set_parents(r, &c);
        read_others(r, &c, fresh->u);
    }
}
