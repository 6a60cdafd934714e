/* SPDX-License-Identifier: MIT */
#include "encoder/enc_replay.h"

#include <string.h>

#include "format/alloc.h"

/* Levels of fewer splits are not worth two threads. */
enum { RELAYED_SPLITS = 500 };

static uint32_t next_corner(uint32_t c)
{
    return c % 3 == 2 ? c - 2 : c + 1;
}

/* ---- the oracle -------------------------------------------------------- */

static bool in_batch(const enc_replay *r, uint32_t t)
{
    const uint32_t *first = r->schedule->batch_first + r->batch;
    return t != ENC_NONE && t >= first[0] && t < first[1];
}

static const enc_contraction *contraction_of(const enc_replay *r, uint32_t v)
{
    const uint32_t t = r->split_of[r->vertex_of[v]];
    return in_batch(r, t) ? &r->schedule->contraction[t] : NULL;
}

/* Numbers of the codec and of the import have nothing to do with each other:
 * asks for what the answers about vertices that the visit comes to need. */
static void prefetch_answers(const enc_replay *r)
{
    enum { SPLIT = 4, OF = 8, VERTEX = 12 }; /* so many visits ahead */
    const pmesh_codec *c = &r->codec;
    const uint32_t *coming = c->order + c->level_next;
    if (c->level_queued - c->level_next <= VERTEX)
        return;
    pmesh_prefetch(&r->vertex_of[coming[VERTEX]]);
    pmesh_prefetch(&r->split_of[r->vertex_of[coming[OF]]]);
    const uint32_t t = r->split_of[r->vertex_of[coming[SPLIT]]];
    if (!in_batch(r, t))
        return;
    pmesh_prefetch(&r->schedule->contraction[t]);
    pmesh_prefetch(&r->wings[t]);
}

static bool answer_splits(void *user, uint32_t v)
{
    prefetch_answers(user);
    return contraction_of(user, v) != NULL;
}

/* The corner of the parent in the removed face at wing a, and at wing b. */
static const uint32_t *wings_of(const enc_replay *r, const enc_contraction *t)
{
    return r->wings[t - r->schedule->contraction];
}

static void answer_cut(void *user, uint32_t v, const pmesh_ring *ring,
                       pmesh_cut *cut)
{
    const enc_replay *r = user;
    const enc_contraction *t = contraction_of(r, v);
    const uint32_t n = ring->face_count;
    const uint32_t *at_wing = wings_of(r, t);

    /* The faces of the child are one run; it starts behind one of v's. */
    bool childs[PMESH_MAX_RING];
    for (uint32_t i = 0; i < n; i++)
        childs[i] = enc_replay_label_at(r, r->corner_of[ring->edge[i]]) ==
                    t->child;
    uint32_t first = ring->open ? 0 : n, end = ring->open ? 0 : n;
    for (uint32_t i = 0; i < n; i++) {
        const bool before = i > 0 ? childs[i - 1]
                                  : !ring->open && childs[n - 1];
        if (childs[i] && !before)
            first = i;
        if (!childs[i] && before)
            end = i;
    }
    if (ring->open && n > 0 && childs[n - 1])
        end = n;
    if (at_wing[0] == ENC_NONE)
        *cut = (pmesh_cut){ PMESH_NONE, end };
    else if (at_wing[1] == ENC_NONE)
        *cut = (pmesh_cut){ end == 0 ? n : first, PMESH_NONE };
    else
        *cut = (pmesh_cut){ first, end };
}

static void answer_part(void *user, uint32_t v, const pmesh_fans *fans,
                        pmesh_parting *out)
{
    enc_part_answer(user, contraction_of(user, v), v, fans, out);
}

static void answer_joined_split_done(void *user, uint32_t child, uint32_t face,
                                     uint32_t count)
{
    enc_replay *r = user;
    const enc_contraction *t = contraction_of(r, r->codec.mesh.parent[child]);
    r->vertex_of[child] = t->child;
    r->born[t->child] = child;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t c = r->part_corner[i];
        for (uint32_t k = 0; k < 3; k++, c = next_corner(c))
            r->corner_of[3 * (face + i) + k] = c;
    }
    enc_part_number(r, face, count);
}

static void answer_split_done(void *user, uint32_t child, uint32_t face,
                              uint32_t count)
{
    enc_replay *r = user;
    const enc_contraction *t =
        contraction_of(r, r->codec.mesh.parent[child]);
    const uint32_t *at_wing = wings_of(r, t);
    r->vertex_of[child] = t->child;
    r->born[t->child] = child;

    uint32_t h = 3 * face;
    for (int i = 0; i < 2; i++) {
        if (at_wing[i] == ENC_NONE)
            continue;
        r->corner_of[h] = at_wing[i];
        r->corner_of[h + 1] = next_corner(at_wing[i]);
        r->corner_of[h + 2] = next_corner(next_corner(at_wing[i]));
        h += 3;
    }
    (void)count;
}

static void answer_position(void *user, uint32_t v, int32_t out[3])
{
    enum { AHEAD = 8 }; /* they are asked for in order */
    const enc_replay *r = user;
    if (v + AHEAD < r->codec.mesh.vertex_count)
        pmesh_prefetch(&r->position[r->vertex_of[v + AHEAD]]);
    memcpy(out, r->position[r->vertex_of[v]], sizeof *r->position);
}

/* A wedge whose vertex is not split off yet is still its parent's. */
static uint32_t answer_key(void *user, uint32_t h)
{
    const enc_replay *r = user;
    const uint32_t w = r->wedge_label[r->mesh->wedge[r->corner_of[h]]];
    return r->born[r->mesh->wedge_vertex[w]] == ENC_NONE
               ? r->schedule->wedge_parent[w]
               : w;
}

static uint32_t answer_number(void *user, uint32_t key)
{
    const enc_replay *r = user;
    return r->wedge_number[key];
}

static void answer_set_number(void *user, uint32_t key, uint32_t wedge)
{
    enc_replay *r = user;
    r->wedge_number[key] = wedge;
    r->wedge_of[wedge] = key;
}

static const uint16_t *answer_values(void *user, uint32_t wedge)
{
    const enc_replay *r = user;
    return r->mesh->value + (size_t)r->wedge_of[wedge] * r->mesh->value_count;
}

static uint32_t answer_material(void *user, uint32_t face)
{
    const enc_replay *r = user;
    return r->mesh->material[r->corner_of[3 * face] / 3];
}

/* ---- set-up ------------------------------------------------------------ */

static void count_base(enc_replay *r)
{
    const enc_schedule *s = r->schedule;
    r->base_faces = r->base_vertices = 0;
    for (uint32_t f = 0; f < r->mesh->face_count; f++)
        r->base_faces += s->face_end[f] == ENC_NONE;
    for (uint32_t v = 0; v < r->mesh->vertex_count; v++)
        r->base_vertices += s->vertex_end[v] == ENC_NONE;
}

/* Wedges made twice (see find_place() in wedge.c) are rare; room for a few. */
static uint32_t wedge_room(const enc_mesh *mesh)
{
    return mesh->value_count ? mesh->wedge_count + mesh->wedge_count / 4 + 1024
                             : mesh->vertex_count;
}

static bool allocate_maps(enc_replay *r)
{
    const pmesh_allocator *a = &r->allocator;
    const enc_mesh *m = r->mesh;
    const size_t n = m->vertex_count, w = m->wedge_count;
    r->corner_of = pmesh_alloc(a, 3 * (size_t)m->face_count, 4);
    r->vertex_of = pmesh_alloc(a, n, 4);
    r->born = pmesh_alloc(a, n, 4);
    r->label = pmesh_alloc(a, n, 4);
    r->split_of = pmesh_alloc(a, n, 4);
    r->wings = pmesh_alloc(a, r->schedule->contraction_count, 8);
    r->position = pmesh_alloc(a, n, sizeof *r->position);
    if (!r->corner_of || !r->vertex_of || !r->born || !r->label ||
        !r->split_of || !r->wings || !r->position ||
        (m->joined && !enc_part_allocate(r)))
        return false;
    if (!m->value_count)
        return true;
    r->wedge_of = pmesh_alloc(a, wedge_room(m), 4);
    r->wedge_number = pmesh_alloc(a, w, 4);
    r->wedge_label = pmesh_alloc(a, w, 4);
    r->wedge_list = pmesh_alloc(a, w, 4);
    r->wedge_first = pmesh_alloc(a, n + 1, 4);
    return r->wedge_of && r->wedge_number && r->wedge_label &&
           r->wedge_list && r->wedge_first;
}

static bool allocate_codec(enc_replay *r)
{
    const enc_mesh *m = r->mesh;
    const uint32_t splits = r->schedule->contraction_count;
    const pmesh_codec_sizes sizes = {
        .vertices = m->vertex_count,
        .faces = m->face_count,
        .wedges = wedge_room(m),
        .base_faces = r->base_faces,
        .attribute_count = m->attribute_count,
        .value_count = m->value_count,
        .material_count = m->material_count,
        .moves = r->moves,
        .joined = m->joined,
        .base_fans = m->joined ? 3 * r->base_faces : 0,
        .block_faces = m->joined ? m->face_count : 0,
        .block_splits =
            splits < PMESH_MAX_BLOCK_SPLITS ? splits : PMESH_MAX_BLOCK_SPLITS,
        .block_wedges = m->value_count ? wedge_room(m) : 0
    };
    r->block_size = pmesh_codec_bind(&r->codec, &sizes, NULL);
    r->block = pmesh_alloc(&r->allocator, 1, (size_t)r->block_size);
    if (!r->block)
        return false;
    pmesh_codec_bind(&r->codec, &sizes, r->block);
    memcpy(r->codec.bounds, m->bounds, sizeof m->bounds);
    return true;
}

static void list_wedges(enc_replay *r)
{
    const enc_mesh *m = r->mesh;
    uint32_t *first = r->wedge_first;
    memset(first, 0, ((size_t)m->vertex_count + 1) * sizeof *first);
    for (uint32_t w = 0; w < m->wedge_count; w++)
        first[m->wedge_vertex[w]]++;
    uint32_t sum = 0;
    for (uint32_t v = 0; v <= m->vertex_count; v++) {
        sum += v < m->vertex_count ? first[v] : 0;
        first[v] = sum;
    }
    for (uint32_t w = m->wedge_count; w-- > 0;)
        r->wedge_list[--first[m->wedge_vertex[w]]] = w;
}

static void fill_maps(enc_replay *r)
{
    const enc_mesh *m = r->mesh;
    const enc_schedule *s = r->schedule;
    for (uint32_t v = 0; v < m->vertex_count; v++)
        r->born[v] = r->split_of[v] = ENC_NONE;
    memset(r->wings, 0xff, s->contraction_count * sizeof *r->wings);
    if (m->joined)
        enc_part_fill(r);
    for (uint32_t f = 0; f < m->face_count && !m->joined; f++)
        if (s->face_end[f] != ENC_NONE) {
            uint32_t *faces = r->wings[s->face_end[f]];
            faces[faces[0] != ENC_NONE] = f;
        }
    memcpy(r->position, s->position, m->vertex_count * sizeof *r->position);
    if (m->value_count) {
        for (uint32_t w = 0; w < m->wedge_count; w++)
            r->wedge_number[w] = ENC_NONE;
        list_wedges(r);
    }
}

pmesh_status enc_replay_create(enc_replay *r, const enc_mesh *mesh,
                               const enc_schedule *schedule, bool moves)
{
    *r = (enc_replay){ .mesh = mesh,
                       .schedule = schedule,
                       .allocator = mesh->allocator,
                       .moves = moves };
    count_base(r);
    if (!allocate_maps(r) || !allocate_codec(r)) {
        enc_replay_destroy(r);
        return PMESH_E_MEMORY;
    }
    fill_maps(r);
    pmesh_codec_limit_values(&r->codec, mesh->attribute, mesh->attribute_count);
    r->oracle = (pmesh_oracle){ .user = r,
                                .splits = answer_splits,
                                .cut = answer_cut,
                                .part = answer_part,
                                .split_done = mesh->joined
                                                  ? answer_joined_split_done
                                                  : answer_split_done,
                                .position = answer_position,
                                .key = answer_key,
                                .number = answer_number,
                                .set_number = answer_set_number,
                                .values = answer_values,
                                .material = answer_material };
    return PMESH_OK;
}

void enc_replay_destroy(enc_replay *r)
{
    const pmesh_allocator *a = &r->allocator;
    const enc_mesh *m = r->mesh;
    if (!m)
        return;
    const size_t n = m->vertex_count, w = m->wedge_count;
    pmesh_release(a, r->corner_of, 3 * (size_t)m->face_count, 4);
    pmesh_release(a, r->vertex_of, n, 4);
    pmesh_release(a, r->born, n, 4);
    pmesh_release(a, r->label, n, 4);
    pmesh_release(a, r->split_of, n, 4);
    pmesh_release(a, r->wings, r->schedule->contraction_count, 8);
    enc_part_release(r);
    pmesh_release(a, r->position, n, sizeof *r->position);
    pmesh_release(a, r->wedge_of, wedge_room(m), 4);
    pmesh_release(a, r->wedge_number, w, 4);
    pmesh_release(a, r->wedge_label, w, 4);
    pmesh_release(a, r->wedge_list, w, 4);
    pmesh_release(a, r->wedge_first, n + 1, 4);
    pmesh_release(a, r->block, 1, (size_t)r->block_size);
    enc_relay_destroy(r->relay);
    *r = (enc_replay){ 0 };
}

/* ---- levels ------------------------------------------------------------ */

void enc_replay_label(enc_replay *r, uint32_t done)
{
    const enc_mesh *m = r->mesh;
    const enc_schedule *s = r->schedule;
    for (uint32_t v = 0; v < m->vertex_count; v++)
        r->label[v] = v;
    for (uint32_t w = 0; w < m->wedge_count && m->value_count; w++)
        r->wedge_label[w] = w;
    for (uint32_t t = done; t-- > 0;) {
        const uint32_t child = s->contraction[t].child;
        r->label[child] = r->label[s->contraction[t].parent];
        if (!m->value_count)
            continue;
        for (uint32_t i = r->wedge_first[child]; i < r->wedge_first[child + 1];
             i++) {
            const uint32_t w = r->wedge_list[i];
            r->wedge_label[w] = r->wedge_label[s->wedge_parent[w]];
        }
    }
}

/* The corner of `vertex` in a face of the import, by the fine mesh's labels. */
static uint32_t corner_with(const enc_replay *r, uint32_t face, uint32_t vertex)
{
    uint32_t c = 3 * face;
    while (enc_replay_label_at(r, c) != vertex)
        c++;
    return c;
}

/* From the faces that the contraction removed to the corner of its parent in
 * each: of the one that runs v -> a -> u, at wing a, first; then of the one that
 * runs v -> u -> b, at wing b. All at once, for they wait for memory. */
static void find_wings(enc_replay *r, uint32_t t)
{
    const enc_contraction *c = &r->schedule->contraction[t];
    uint32_t *face = r->wings[t];
    uint32_t at_wing[2] = { ENC_NONE, ENC_NONE };
    for (int i = 0; i < 2 && face[i] != ENC_NONE; i++) {
        const uint32_t k = corner_with(r, face[i], c->parent);
        at_wing[enc_replay_label_at(r, next_corner(k)) == c->child] = k;
    }
    memcpy(face, at_wing, sizeof at_wing);
}

void enc_replay_begin(enc_replay *r, uint32_t batch)
{
    const enc_schedule *s = r->schedule;
    r->batch = batch;
    r->splits_left = s->batch_first[batch + 1] - s->batch_first[batch];
    enc_replay_label(r, s->batch_first[batch]);
    for (uint32_t t = s->batch_first[batch]; t < s->batch_first[batch + 1];
         t++) {
        const uint32_t parent = s->contraction[t].parent;
        r->split_of[parent] = t;
        memcpy(r->position[parent], s->contraction[t].before,
               sizeof *r->position);
        if (!r->mesh->joined)
            find_wings(r, t);
    }
    pmesh_level_begin(&r->codec);
    if (!r->relay && r->splits_left >= RELAYED_SPLITS)
        r->relay = enc_relay_create(&r->allocator, r->mesh->pool,
                                    &r->codec);
}

/* The block's numbers were changed: follow. */
static bool renumber(enc_replay *r)
{
    const pmesh_codec *c = &r->codec;
    const pmesh_block *b = &c->block;
    const size_t largest =
        3 * (size_t)b->face_count + 2 * (size_t)b->wedge_count;
    uint32_t *copy = pmesh_alloc(&r->allocator, largest, sizeof *copy);
    if (!copy)
        return false;

    memcpy(copy, r->vertex_of + b->vertex, b->vertex_count * sizeof *copy);
    for (uint32_t i = 0; i < b->vertex_count; i++) {
        r->vertex_of[b->vertex + i] = copy[c->child_order[i]];
        r->born[copy[c->child_order[i]]] = b->vertex + i;
    }
    memcpy(copy, r->corner_of + 3 * (size_t)b->face,
           3 * (size_t)b->face_count * sizeof *copy);
    for (uint32_t i = 0; i < b->face_count; i++)
        memcpy(r->corner_of + 3 * ((size_t)b->face + i),
               copy + 3 * (size_t)c->face_order[i], 3 * sizeof *copy);
    if (r->face_of)
        enc_part_number(r, b->face, b->face_count);
    if (r->wedge_of) {
        uint32_t *now = copy + b->wedge_count;
        memcpy(copy, r->wedge_of + b->wedge, b->wedge_count * sizeof *copy);
        for (uint32_t i = 0; i < b->wedge_count; i++) {
            r->wedge_of[b->wedge + i] = copy[c->wedge_order[i]];
            now[c->wedge_order[i]] = b->wedge + i;
        }
        /* A wedge can have been made twice (the first has left the ring by
         * then): the later one counts, so go in coding order. */
        for (uint32_t k = 0; k < b->wedge_count; k++)
            r->wedge_number[copy[k]] = now[k];
    }
    pmesh_release(&r->allocator, copy, largest, sizeof *copy);
    return true;
}

pmesh_status enc_replay_block(enc_replay *r, pmesh_coder *coder,
                              uint32_t splits)
{
    const pmesh_status status =
        r->relay ? enc_relay_block(r->relay, coder, &r->oracle, splits)
                 : pmesh_block_code(&r->codec, coder, &r->oracle, splits);
    if (r->lost)
        return PMESH_E_CORRUPT;
    if (status != PMESH_OK)
        return status;
    r->splits_left -= splits;
    return renumber(r) ? PMESH_OK : PMESH_E_MEMORY;
}
