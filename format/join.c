/* SPDX-License-Identifier: MIT */
#include "format/join.h"

#include <string.h>

#include "format/cut.h"
#include "format/star.h"
#include "format/wedge.h"

static pmesh_status corrupt(pmesh_codec *c, const char *rule)
{
    c->rule = rule;
    return PMESH_E_CORRUPT;
}

bool pmesh_fans_gather(const pmesh_mesh *m, uint32_t v, pmesh_fans *fans)
{
    fans->count = fans->members = 0;
    for (uint32_t h = m->first[v]; h != PMESH_NONE; h = m->fan[h]) {
        pmesh_ring *ring = &fans->ring[fans->count];
        if (fans->count++ == PMESH_MAX_PARTS ||
            !pmesh_ring_gather_fan(m, h, ring))
            return false;
        fans->members += ring->count + ring->open;
        if (fans->members > PMESH_MAX_RING)
            return false;
    }
    return true;
}

/* ---- coding -------------------------------------------------------------- */

static void code_ways(pmesh_codec *c, pmesh_coder *coder, uint32_t v,
                      const pmesh_fans *fans, pmesh_parting *p)
{
    pmesh_join_models *models = &c->models.join;
    unsigned any = 0, last = 0; /* was one cut; what the last whole one did */
    for (uint32_t i = 0; i < fans->count; i++) {
        pmesh_bit *whole = &models->whole[fans->count == 1 ? 0 : 1 + any];
        if (!pmesh_tell_bit(coder, whole, p->way[i] != PMESH_FAN_CUT)) {
            p->way[i] = PMESH_FAN_CUT;
            pmesh_cut_tell(c, coder, v, &fans->ring[i], &p->cut[i]);
            any = 1;
            continue;
        }
        const unsigned moves =
            pmesh_tell_bit(coder, &models->moves[any][last],
                           p->way[i] == PMESH_FAN_MOVES);
        p->way[i] = moves ? PMESH_FAN_MOVES : PMESH_FAN_STAYS;
        last = 1 + moves;
    }
}

/* Place among all members of all rings; PMESH_NONE if x is none. */
static uint32_t place_of(const pmesh_fans *fans, uint32_t x)
{
    uint32_t place = 0;
    for (uint32_t i = 0; i < fans->count; i++)
        for (uint32_t k = 0; k < fans->ring[i].count; k++, place++)
            if (fans->ring[i].vertex[k] == x)
                return place;
    return PMESH_NONE;
}

static uint32_t member_at(const pmesh_fans *fans, uint32_t place)
{
    for (uint32_t i = 0; i < fans->count; i++) {
        if (place < fans->ring[i].count)
            return fans->ring[i].vertex[place];
        place -= fans->ring[i].count;
    }
    return PMESH_NONE;
}

/* The third vertex of a lone face: a neighbour of v, or any. PMESH_NONE if
 * there is none such. */
static uint32_t code_third(pmesh_codec *c, pmesh_coder *coder,
                           const pmesh_fans *fans, uint32_t third)
{
    pmesh_join_models *models = &c->models.join;
    const uint32_t n = c->mesh.vertex_count;
    const uint32_t place = place_of(fans, third);
    if (!pmesh_tell_bit(coder, &models->far, place == PMESH_NONE))
        return member_at(fans,
                         pmesh_tell_number(coder, &models->member, place));
    third = pmesh_tell_raw(coder, pmesh_bit_length(n - 1), third);
    return third < n ? third : PMESH_NONE;
}

static pmesh_lone code_kind(pmesh_join_models *models, pmesh_coder *coder,
                            pmesh_lone kind)
{
    if (pmesh_tell_bit(coder, &models->pair, kind == PMESH_LONE_PAIR))
        return PMESH_LONE_PAIR;
    return pmesh_tell_bit(coder, &models->turned, kind == PMESH_LONE_TURNED)
               ? PMESH_LONE_TURNED
               : PMESH_LONE_FACE;
}

static bool code_lone(pmesh_codec *c, pmesh_coder *coder, uint32_t v,
                      const pmesh_fans *fans, pmesh_parting *p)
{
    pmesh_join_models *models = &c->models.join;
    const uint32_t wanted = p->lone_count;
    unsigned context = 0;
    for (uint32_t i = 0; i < fans->count; i++)
        context |= p->way[i] == PMESH_FAN_CUT;
    for (uint32_t i = 0; i < PMESH_MAX_LONE; i++, context = 2) {
        p->lone_count = i;
        if (!pmesh_tell_bit(coder, &models->lone[context], i < wanted))
            return true;
        p->lone[i] = code_kind(models, coder, p->lone[i]);
        p->third[i] = code_third(c, coder, fans, p->third[i]);
        if (p->third[i] == PMESH_NONE || p->third[i] == v)
            return false;
    }
    p->lone_count = PMESH_MAX_LONE;
    return true;
}

/* ---- checking ------------------------------------------------------------ */

static uint32_t faces_of(const pmesh_cut *cut)
{
    return cut->first != PMESH_NONE && cut->end != PMESH_NONE ? 2 : 1;
}

/* What the split makes must fit, and both vertices keep a fan. */
static pmesh_status check(pmesh_codec *c, const pmesh_fans *fans,
                          const pmesh_parting *p)
{
    const pmesh_mesh *m = &c->mesh;
    uint32_t faces = p->lone_count;
    for (uint32_t i = 0; i < p->lone_count; i++)
        faces += p->lone[i] == PMESH_LONE_PAIR;
    bool v_has = faces > 0, u_has = faces > 0;
    for (uint32_t i = 0; i < fans->count; i++) {
        if (p->way[i] == PMESH_FAN_CUT)
            faces += faces_of(&p->cut[i]);
        v_has |= p->way[i] != PMESH_FAN_MOVES;
        u_has |= p->way[i] != PMESH_FAN_STAYS;
    }
    if (!v_has || !u_has)
        return corrupt(c, "SPEC 6.3: a vertex without faces");
    if (m->vertex_count == m->vertex_capacity ||
        m->face_capacity - m->face_count < faces)
        return corrupt(c, "SPEC 6.3: more splits than the header declares");
    return c->sizes.block_faces - c->block.face_count >= faces
               ? PMESH_OK
               : corrupt(c, "SPEC 5.3: a block with more faces than declared");
}

/* ---- applying ------------------------------------------------------------ */

/* Neighbours that a fan gives to u: its members first .. first + count - 1,
 * cyclically. */
typedef struct gift {
    uint32_t first, count;
} gift;

static gift gift_of(const pmesh_ring *ring, const pmesh_parting *p, uint32_t i)
{
    const pmesh_cut cut = p->cut[i];
    if (p->way[i] == PMESH_FAN_MOVES)
        return (gift){ 0, ring->count };
    const uint32_t first = cut.first == PMESH_NONE ? 0 : cut.first;
    const uint32_t last = cut.end == PMESH_NONE ? ring->count - 1 : cut.end;
    return (gift){ first, 1 + (first <= last ? last - first
                                             : ring->count - first + last) };
}

static uint32_t given(const pmesh_ring *ring, gift g, uint32_t k)
{
    const uint32_t i = g.first + k;
    return ring->vertex[i < ring->count ? i : i - ring->count];
}

/* The fan of v that becomes u's first one: cut ones lead; PMESH_NONE if u gets
 * lone faces only. */
static uint32_t leading(const pmesh_fans *fans, const pmesh_parting *p)
{
    static const pmesh_way order[] = { PMESH_FAN_CUT, PMESH_FAN_MOVES };
    for (int k = 0; k < 2; k++)
        for (uint32_t i = 0; i < fans->count; i++)
            if (p->way[i] == order[k])
                return i;
    return PMESH_NONE;
}

/* u goes to the mean of v and of the neighbours that its first fan brings. */
static void place_provisionally(pmesh_codec *c, uint32_t u, uint32_t v,
                                const pmesh_fans *fans, const pmesh_parting *p)
{
    int32_t(*position)[3] = c->mesh.position;
    const uint32_t lead = leading(fans, p);
    uint32_t x = p->third[0], count = 1;
    int32_t sum[3] = { position[v][0], position[v][1], position[v][2] };
    gift g = { 0, 1 };
    if (lead != PMESH_NONE)
        g = gift_of(&fans->ring[lead], p, lead);
    for (uint32_t i = 0; i < g.count; i++, count++) {
        if (lead != PMESH_NONE)
            x = given(&fans->ring[lead], g, i);
        for (int k = 0; k < 3; k++)
            sum[k] += position[x][k];
    }
    for (int k = 0; k < 3; k++)
        position[u][k] = pmesh_share(sum[k], count);
}

static void meet(pmesh_codec *c, uint32_t a, uint32_t b)
{
    const uint32_t end[2] = { a, b };
    for (int i = 0; i < 2; i++) {
        const int32_t *other = c->mesh.position[end[1 - i]];
        c->near[end[i]].degree++;
        for (int k = 0; k < 3; k++)
            c->near[end[i]].sum[k] += (uint32_t)other[k];
    }
}

static void part(pmesh_codec *c, uint32_t a, uint32_t b)
{
    const uint32_t end[2] = { a, b };
    for (int i = 0; i < 2; i++) {
        const int32_t *other = c->mesh.position[end[1 - i]];
        c->near[end[i]].degree--;
        for (int k = 0; k < 3; k++)
            c->near[end[i]].sum[k] -= (uint32_t)other[k];
    }
}

/* Every edge counts for both its ends: what u is given leaves v, but for the
 * wings. */
static void count_neighbours(pmesh_codec *c, uint32_t v, uint32_t u,
                             const pmesh_fans *fans, const pmesh_parting *p)
{
    c->near[u].degree = 0;
    memset(c->near[u].sum, 0, sizeof c->near[u].sum);
    for (uint32_t i = 0; i < fans->count; i++) {
        const pmesh_ring *ring = &fans->ring[i];
        if (p->way[i] == PMESH_FAN_STAYS)
            continue;
        const bool cut = p->way[i] == PMESH_FAN_CUT;
        const gift g = gift_of(ring, p, i);
        for (uint32_t k = 0; k < g.count; k++) {
            const uint32_t x = given(ring, g, k);
            const bool wing =
                cut && ((k == 0 && p->cut[i].first != PMESH_NONE) ||
                        (k == g.count - 1 && p->cut[i].end != PMESH_NONE));
            meet(c, u, x);
            if (!wing)
                part(c, v, x);
        }
        if (cut)
            meet(c, u, v);
    }
    for (uint32_t i = 0; i < p->lone_count; i++) {
        meet(c, v, u);
        meet(c, u, p->third[i]);
        meet(c, p->third[i], v);
    }
}

static void move_fan(pmesh_mesh *m, const pmesh_ring *ring, uint32_t u)
{
    for (uint32_t i = 0; i < ring->face_count; i++)
        m->vertex[ring->edge[i]] = u;
}

/* Cut fans come first in the lists of both, whole ones follow. At most
 * PMESH_MAX_PARTS, so there is room. */
static void part_fans(pmesh_mesh *m, uint32_t v, uint32_t u,
                      const pmesh_fans *fans, const pmesh_parting *p,
                      pmesh_fresh *fresh)
{
    m->first[v] = m->first[u] = PMESH_NONE;
    fresh->count = 0;
    for (uint32_t i = 0; i < fans->count; i++) {
        const pmesh_cut cut = p->cut[i];
        uint32_t start[2], *face = fresh->face[fresh->count];
        if (p->way[i] != PMESH_FAN_CUT)
            continue;
        face[0] = cut.first == PMESH_NONE ? PMESH_NONE : 3 * m->face_count;
        face[1] = cut.end == PMESH_NONE ? PMESH_NONE
                                        : 3 * (m->face_count +
                                               (cut.first != PMESH_NONE));
        pmesh_mesh_cut(m, v, u, &fans->ring[i], cut, &start[0], &start[1]);
        fresh->start[fresh->count++] = start[1];
        pmesh_fan_append(m, v, start[0]);
        pmesh_fan_append(m, u, start[1]);
    }
    for (uint32_t i = 0; i < fans->count; i++) {
        const bool moves = p->way[i] == PMESH_FAN_MOVES;
        if (p->way[i] == PMESH_FAN_CUT)
            continue;
        if (moves)
            move_fan(m, &fans->ring[i], u);
        pmesh_fan_append(m, moves ? u : v, fans->ring[i].edge[0]);
    }
}

/* The sides of faces (v, u, w) and (u, v, w) at half-edges g and h. */
static void glue(pmesh_mesh *m, uint32_t g, uint32_t h)
{
    static const uint32_t across[] = { 0, 2, 1 };
    for (uint32_t k = 0; k < 3; k++) {
        m->twin[g + k] = h + across[k];
        m->twin[h + across[k]] = g + k;
    }
}

/* False if some third vertex has too many fans. */
static bool add_lone(pmesh_mesh *m, uint32_t v, uint32_t u,
                     const pmesh_parting *p)
{
    bool room = true;
    for (uint32_t i = 0; i < p->lone_count; i++) {
        const bool turned = p->lone[i] == PMESH_LONE_TURNED;
        const uint32_t w = p->third[i], x = turned ? u : v, y = turned ? v : u;
        const uint32_t h = pmesh_mesh_add_face(m, x, y, w);
        for (uint32_t k = h; k < h + 3; k++) {
            m->twin[k] = PMESH_NONE;
            room &= pmesh_fan_append(m, m->vertex[k], k);
        }
        if (p->lone[i] == PMESH_LONE_PAIR)
            glue(m, h, pmesh_mesh_add_face(m, y, x, w));
    }
    return room;
}

static pmesh_status apply(pmesh_codec *c, const pmesh_oracle *oracle,
                          uint32_t v, const pmesh_fans *fans,
                          const pmesh_parting *p, pmesh_fresh *fresh)
{
    pmesh_mesh *m = &c->mesh;
    const uint32_t u = m->vertex_count, face = m->face_count;
    const uint32_t index = u - c->block.vertex;
    c->child_face[index] = face;
    if (c->sizes.moves)
        memcpy(c->unsplit[index], m->position[v], sizeof *c->unsplit);
    place_provisionally(c, u, v, fans, p);
    count_neighbours(c, v, u, fans, p);
    m->vertex_count++;
    m->parent[u] = v;
    part_fans(m, v, u, fans, p, fresh);
    fresh->lone = 3 * m->face_count;
    if (!add_lone(m, v, u, p))
        return corrupt(c, "SPEC 6.3: a vertex with too many fans");
    fresh->lone_end = 3 * m->face_count;
    c->state[v] = PMESH_PARENT;
    c->state[u] = PMESH_NEWBORN;
    c->block.vertex_count++;
    c->block.face_count += m->face_count - face;
    if (oracle)
        oracle->split_done(oracle->user, u, face, m->face_count - face);
    return PMESH_OK;
}

pmesh_status pmesh_join_split(pmesh_codec *c, pmesh_coder *coder,
                              const pmesh_oracle *oracle, uint32_t v,
                              const pmesh_fans *fans)
{
    const uint32_t u = c->mesh.vertex_count;
    pmesh_parting p;
    pmesh_fresh fresh;
    memset(&p, 0, sizeof p);
    if (oracle)
        oracle->part(oracle->user, v, fans, &p);
    code_ways(c, coder, v, fans, &p);
    if (!code_lone(c, coder, v, fans, &p))
        return corrupt(c, "SPEC 6.3: no such vertex for a lone face");
    pmesh_status status = check(c, fans, &p);
    if (status == PMESH_OK)
        status = apply(c, oracle, v, fans, &p, &fresh);
    return status == PMESH_OK
               ? pmesh_wedge_split_code(c, coder, oracle, u, &fresh)
               : status;
}
