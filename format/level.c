/* SPDX-License-Identifier: MIT */
/*
 * level.c - codes a level of vertex splits, block by block (SPEC 6.3 to 6.6).
 */
#include <string.h>

#include "format/codec.h"
#include "format/cut.h"
#include "format/join.h"
#include "format/lanes.h"
#include "format/predict.h"
#include "format/rank.h"
#include "format/residual.h"
#include "format/star.h"
#include "format/value.h"
#include "format/wedge.h"

static pmesh_status corrupt(pmesh_codec *c, const char *rule)
{
    c->rule = rule;
    return PMESH_E_CORRUPT;
}

/* The first vertices of `order` wait for their visit, or had it. */
static void queue_vertex(pmesh_codec *c, uint32_t x)
{
    const uint8_t state = c->state[x];
    const bool is_new = state == PMESH_UNVISITED; /* nobody can tell */
    c->order[c->level_queued] = x;
    c->level_queued += is_new;
    c->state[x] = (uint8_t)(state | is_new * PMESH_QUEUED);
}

/* How many neighbours there are of each state: counts of 12 bits, more than
 * rings ever need, in a register, as they are wanted at once. */
enum { COUNT_BITS = 12 };

static uint64_t count_one(const pmesh_codec *c, uint32_t x)
{
    return UINT64_C(1) << COUNT_BITS * pmesh_state(c, x);
}

static uint32_t counted(uint64_t counts, pmesh_visit state)
{
    return (uint32_t)(counts >> COUNT_BITS * state) & ((1u << COUNT_BITS) - 1);
}

/* Queues a ring and counts it. */
static uint64_t queue_ring(pmesh_codec *c, const pmesh_ring *ring)
{
    uint64_t counts = 0;
    for (uint32_t i = 0; i < ring->count; i++) {
        const uint32_t x = ring->vertex[i];
        counts += count_one(c, x);
        queue_vertex(c, x);
        pmesh_prefetch(&c->mesh.position[x]); /* a cut will want both */
        pmesh_prefetch(&c->near[x]);
    }
    return counts;
}

/* The members of v's rings, of any size. */
static void queue_rings(pmesh_codec *c, uint32_t v)
{
    const pmesh_mesh *m = &c->mesh;
    uint32_t start = m->first[v];
    for (uint32_t h = start; h != PMESH_NONE;
         h = pmesh_corner_next(m, &start, h)) {
        queue_vertex(c, m->vertex[pmesh_next(h)]);
        if (pmesh_turn_left(m, h) == PMESH_NONE)
            queue_vertex(c, m->vertex[pmesh_prev(h)]);
    }
}

/* Of a vertex that the visit comes to later on: its first face, where known. */
static void prefetch_visit(const pmesh_codec *c)
{
    enum { AHEAD = 6, FAR_AHEAD = 12 };
    const pmesh_mesh *m = &c->mesh;
    const uint32_t place = c->level_next;
    if (place + FAR_AHEAD >= c->level_queued)
        return;
    const uint32_t h = m->first[c->order[place + AHEAD]];
    pmesh_prefetch(&m->first[c->order[place + FAR_AHEAD]]);
    pmesh_prefetch(&m->twin[h]);
    pmesh_prefetch(&m->vertex[h]);
}

void pmesh_level_begin(pmesh_codec *c)
{
    const uint32_t n = c->mesh.vertex_count;
    memset(c->state, PMESH_UNVISITED, n);
    c->level_vertex_count = n;
    c->level_seed = c->level_queued = c->level_next = 0;
}

/* Breadth first over the rings, from vertex 0 and again from the lowest vertex
 * not seen; PMESH_NONE behind the last. A split changes the ring of no vertex
 * that is yet to be visited but for newborn members and their place in it: the
 * order is that of the mesh before the level. */
static uint32_t next_vertex(pmesh_codec *c)
{
    if (c->level_next == c->level_queued) {
        while (c->level_seed < c->level_vertex_count &&
               c->state[c->level_seed] != PMESH_UNVISITED)
            c->level_seed++;
        if (c->level_seed == c->level_vertex_count)
            return PMESH_NONE;
        queue_vertex(c, c->level_seed);
    }
    prefetch_visit(c);
    return c->order[c->level_next++];
}

static uint32_t at_most(uint32_t value, uint32_t limit)
{
    return value < limit ? value : limit;
}

/* Whether v splits is likely told by which of its neighbours did; `size`: how
 * many there are, and ghosts. */
static uint32_t flag_context(uint64_t seen, uint32_t size)
{
    const uint32_t valence = size < 4 ? 0 : at_most(size - 3, 7);
    const uint32_t split = at_most(
        counted(seen, PMESH_PARENT) + counted(seen, PMESH_NEWBORN), 5);
    const uint32_t kept = at_most(counted(seen, PMESH_KEPT), 4);
    const uint32_t unvisited = at_most(counted(seen, PMESH_UNVISITED), 6);
    return ((valence * 6 + split) * 5 + kept) * 7 + unvisited;
}

/* What the cut hands over to u: members first .. last, cyclically. */
static uint32_t handed_over(const pmesh_ring *ring, pmesh_cut cut,
                            uint32_t *first)
{
    const uint32_t last = cut.end == PMESH_NONE ? ring->count - 1 : cut.end;
    *first = cut.first == PMESH_NONE ? 0 : cut.first;
    return (*first <= last ? last - *first : ring->count - *first + last) + 1;
}

static uint32_t member(const pmesh_ring *ring, uint32_t i)
{
    return ring->vertex[i < ring->count ? i : i - ring->count];
}

/* The mean of the members that the cut gives u, and v: u's ring. */
static void place_provisionally(pmesh_codec *c, uint32_t u, uint32_t v,
                                const pmesh_ring *ring, uint32_t first,
                                uint32_t count)
{
    const int32_t(*position)[3] = (const int32_t(*)[3])c->mesh.position;
    quads sum = quads_triple(position[v]);
    for (uint32_t i = first; i < first + count; i++)
        sum = quads_add(sum, quads_triple(position[member(ring, i)]));
    int32_t sums[QUADS];
    quads_store(sums, sum);
    pmesh_near_store(&c->near[u], sum);
    c->near[u].degree = count + 1;
    for (int k = 0; k < 3; k++)
        c->mesh.position[u][k] = pmesh_share(sums[k], count + 1);
}

/* Members that are no wings change their neighbour v for u; wings gain u. */
static void count_neighbours(pmesh_codec *c, uint32_t v, uint32_t u,
                             const pmesh_ring *ring, pmesh_cut cut)
{
    const int32_t(*position)[3] = (const int32_t(*)[3])c->mesh.position;
    uint32_t first;
    const uint32_t count = handed_over(ring, cut, &first);
    place_provisionally(c, u, v, ring, first, count);
    const quads at_u = quads_triple(position[u]);
    const quads instead = quads_sub(at_u, quads_triple(position[v]));
    quads near_v = quads_add(pmesh_near_load(&c->near[v]), at_u);
    for (uint32_t i = first; i < first + count; i++) {
        const uint32_t x = member(ring, i);
        const bool wing = (i == first && cut.first != PMESH_NONE) ||
                          (i == first + count - 1 && cut.end != PMESH_NONE);
        const quads near_x = pmesh_near_load(&c->near[x]);
        if (wing) {
            pmesh_near_store(&c->near[x], quads_add(near_x, at_u));
            c->near[x].degree++;
            continue;
        }
        pmesh_near_store(&c->near[x], quads_add(near_x, instead));
        near_v = quads_sub(near_v, quads_triple(position[x]));
    }
    pmesh_near_store(&c->near[v], near_v);
    c->near[v].degree = ring->count - count + 1 + (cut.first != PMESH_NONE) +
                        (cut.end != PMESH_NONE);
}

static pmesh_status split(pmesh_codec *c, pmesh_coder *coder,
                          const pmesh_oracle *oracle, uint32_t v,
                          const pmesh_ring *ring)
{
    pmesh_mesh *m = &c->mesh;
    pmesh_cut cut = { 0, 0 };
    if (oracle)
        oracle->cut(oracle->user, v, ring, &cut);
    pmesh_cut_tell(c, coder, v, ring, &cut);

    const uint32_t faces =
        cut.first != PMESH_NONE && cut.end != PMESH_NONE ? 2 : 1;
    if (m->vertex_count == m->vertex_capacity ||
        m->face_capacity - m->face_count < faces)
        return corrupt(c, "SPEC 6.3: more splits than the header declares");

    const uint32_t u = m->vertex_count, index = u - c->block.vertex;
    c->child_face[index] = m->face_count;
    if (c->sizes.moves)
        memcpy(c->unsplit[index], m->position[v], sizeof *c->unsplit);
    count_neighbours(c, v, u, ring, cut);
    pmesh_mesh_split(m, v, ring, cut);
    c->state[v] = PMESH_PARENT;
    c->state[u] = PMESH_NEWBORN;
    c->block.vertex_count++;
    c->block.face_count += faces;
    if (oracle)
        oracle->split_done(oracle->user, u, m->face_count - faces, faces);
    if (!m->material && !m->value_count)
        return PMESH_OK;
    const uint32_t h = 3 * (m->face_count - faces);
    const bool a = cut.first != PMESH_NONE, b = cut.end != PMESH_NONE;
    const pmesh_fresh fresh = { .count = 1,
                                .face = { { a ? h : PMESH_NONE, !b  ? PMESH_NONE
                                                                : a ? h + 3
                                                                    : h } },
                                .start = { m->first[u] } };
    return pmesh_wedge_split_code(c, coder, oracle, u, &fresh);
}

static bool code_flag(pmesh_codec *c, pmesh_coder *coder,
                      const pmesh_oracle *oracle, uint32_t v, uint64_t seen,
                      uint32_t size)
{
    pmesh_bit *flag = &c->models.flag[flag_context(seen, size)];
    return pmesh_tell_bit(coder, flag,
                          oracle && oracle->splits(oracle->user, v));
}

static pmesh_status visit(pmesh_codec *c, pmesh_coder *coder,
                          const pmesh_oracle *oracle, uint32_t v)
{
    pmesh_ring ring;
    if (!pmesh_codec_ring(c, v, &ring)) {
        queue_rings(c, v);
        return PMESH_OK;
    }
    const uint64_t seen = queue_ring(c, &ring);
    return code_flag(c, coder, oracle, v, seen, ring.count + ring.open)
               ? split(c, coder, oracle, v, &ring)
               : PMESH_OK;
}

static pmesh_status visit_joined(pmesh_codec *c, pmesh_coder *coder,
                                 const pmesh_oracle *oracle, uint32_t v)
{
    pmesh_fans fans;
    uint64_t seen = 0;
    queue_rings(c, v);
    if (!pmesh_fans_gather(&c->mesh, v, &fans))
        return PMESH_OK;
    for (uint32_t k = 0; k < fans.count; k++)
        for (uint32_t i = 0; i < fans.ring[k].count; i++)
            seen += count_one(c, fans.ring[k].vertex[i]);
    return code_flag(c, coder, oracle, v, seen, fans.members)
               ? pmesh_join_split(c, coder, oracle, v, &fans)
               : PMESH_OK;
}

static pmesh_status code_connectivity(pmesh_codec *c, pmesh_coder *coder,
                                      const pmesh_oracle *oracle,
                                      uint32_t split_count)
{
    pmesh_status status = PMESH_OK;
    while (c->block.vertex_count < split_count && status == PMESH_OK) {
        const uint32_t v = next_vertex(c);
        if (v == PMESH_NONE)
            return corrupt(c, "SPEC 6.3: more splits than vertices");
        c->state[v] = PMESH_KEPT;
        status = c->sizes.joined ? visit_joined(c, coder, oracle, v)
                                 : visit(c, coder, oracle, v);
    }
    return status;
}

static int32_t clamp(int64_t value, int32_t limit)
{
    return value < 0 ? 0 : value > limit ? limit : (int32_t)value;
}

/* Up to PMESH_ABREAST children from u on, and their parents. */
static uint32_t next_family(const pmesh_codec *c, uint32_t u,
                            uint32_t child[PMESH_ABREAST],
                            uint32_t parent[PMESH_ABREAST])
{
    const uint32_t end = c->block.vertex + c->block.vertex_count;
    uint32_t count = 0;
    for (; u < end && count < PMESH_ABREAST; u++, count++) {
        child[count] = u;
        parent[count] = c->mesh.parent[u];
    }
    return count;
}

/* Connectivity is complete now: a better guess where every child will be. */
static void guess_positions(pmesh_codec *c)
{
    uint32_t child[PMESH_ABREAST], parent[PMESH_ABREAST], count;
    pmesh_site site[PMESH_ABREAST];
    for (uint32_t u = c->block.vertex;
         (count = next_family(c, u, child, parent)) > 0; u += count) {
        pmesh_sites_rings(c, child, count, site);
        for (uint32_t i = 0; i < count; i++) {
            const pmesh_ring *ring = &site[i].ring;
            int32_t position[3];
            if (ring->count == 0)
                continue;
            pmesh_guess(c, u + i, ring, position);
            pmesh_place(c, u + i, ring, position);
        }
    }
}

/* How far, in 1/16 steps, u lies above or below its parent: what the surface
 * loses without it. */
static uint32_t importance_of(const pmesh_mesh *m, uint32_t u,
                              const int32_t parent[3],
                              const pmesh_prediction *p)
{
    int64_t height = 0;
    for (int k = 0; k < 3; k++)
        height += (int64_t)(m->position[u][k] - parent[k]) * p->normal[k];
    const uint64_t size = (uint64_t)(height < 0 ? -height : height) / 1024;
    return size > UINT32_MAX ? UINT32_MAX : (uint32_t)size;
}

/* Codes the final position of x, a child or a moved parent. */
static bool code_position(pmesh_codec *c, pmesh_coder *coder,
                          const pmesh_oracle *oracle,
                          pmesh_place_models *models, uint32_t x,
                          const pmesh_ring *ring, pmesh_prediction *p)
{
    int32_t position[3] = { 0, 0, 0 };
    if (oracle)
        oracle->position(oracle->user, x, position);
    if (coder->relay)
        coder->relay->place(coder->relay->user, models, p, position);
    else if (!pmesh_residual_code(coder, models, c->bounds, p, position))
        return false;
    pmesh_place(c, x, ring, position);
    return true;
}

static bool code_moved_parent(pmesh_codec *c, pmesh_coder *coder,
                              const pmesh_oracle *oracle, uint32_t u,
                              const pmesh_site *site)
{
    pmesh_mesh *m = &c->mesh;
    const uint32_t v = m->parent[u];
    const int32_t *before = c->unsplit[u - c->block.vertex];
    int32_t mirrored[3];
    pmesh_prediction p;
    for (int k = 0; k < 3; k++) /* parent and child part about evenly */
        mirrored[k] =
            clamp(2 * (int64_t)before[k] - m->position[u][k], c->bounds[k]);
    pmesh_predict(c, v, site, mirrored, u + 1, &p);
    return code_position(c, coder, oracle, &c->place[1], v, &site->ring, &p);
}

static bool code_child(pmesh_codec *c, pmesh_coder *coder,
                       const pmesh_oracle *oracle, uint32_t u,
                       const pmesh_site *site)
{
    const pmesh_mesh *m = &c->mesh;
    const int32_t *parent = m->position[m->parent[u]];
    pmesh_prediction p;
    pmesh_predict(c, u, site, parent, u, &p);
    if (!code_position(c, coder, oracle, &c->place[0], u, &site->ring, &p))
        return false;
    c->importance[u - c->block.vertex] = importance_of(m, u, parent, &p);
    return true;
}

static pmesh_status code_positions(pmesh_codec *c, pmesh_coder *coder,
                                   const pmesh_oracle *oracle)
{
    uint32_t child[PMESH_ABREAST], parent[PMESH_ABREAST], count;
    pmesh_site site[PMESH_ABREAST], moved[PMESH_ABREAST];
    for (uint32_t u = c->block.vertex;
         (count = next_family(c, u, child, parent)) > 0; u += count) {
        pmesh_sites_find(c, child, parent, count, site);
        if (c->sizes.moves)
            pmesh_sites_find(c, parent, child, count, moved);
        for (uint32_t i = 0; i < count; i++)
            if (!code_child(c, coder, oracle, u + i, &site[i]) ||
                (c->sizes.moves &&
                 !code_moved_parent(c, coder, oracle, u + i, &moved[i])))
                return corrupt(c, "SPEC 6.5: a vertex leaves the bounds");
    }
    return PMESH_OK;
}

/* What was written since the last call counts as the given part. */
static void count_part(pmesh_codec *c, const pmesh_coder *coder, int part,
                       size_t *written)
{
    if (!coder->encoding)
        return;
    if (coder->relay) {
        coder->relay->part(coder->relay->user, part);
        return;
    }
    c->part_size[part] += coder->out->size - *written;
    *written = coder->out->size;
}

pmesh_status pmesh_block_code(pmesh_codec *c, pmesh_coder *coder,
                              const pmesh_oracle *oracle, uint32_t split_count)
{
    pmesh_mesh *m = &c->mesh;
    if (split_count > c->sizes.block_splits)
        return corrupt(c, "SPEC 6.3: a block larger than the header declares");
    c->block = (pmesh_block){ .vertex = m->vertex_count,
                              .face = m->face_count,
                              .wedge = m->wedge_count };
    c->wedge_limit = c->sizes.block_wedges;
    size_t written = coder->encoding ? coder->out->size : 0;

    pmesh_status status = code_connectivity(c, coder, oracle, split_count);
    if (status != PMESH_OK)
        return status;
    count_part(c, coder, 0, &written);
    guess_positions(c);
    status = code_positions(c, coder, oracle);
    if (status != PMESH_OK)
        return status;
    count_part(c, coder, 1, &written);
    if (!m->value_count)
        m->wedge_count = m->vertex_count;
    c->block.wedge_count = m->wedge_count - c->block.wedge;
    for (uint32_t i = 0; i < c->block.wedge_count && m->value_count; i++) {
        status = pmesh_wedge_values_code(c, coder, oracle, c->block.wedge + i);
        if (status != PMESH_OK)
            return status;
    }
    count_part(c, coder, 2, &written);
    pmesh_block_rank(c);
    return PMESH_OK;
}
