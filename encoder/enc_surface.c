/* SPDX-License-Identifier: MIT */
#include "encoder/enc_surface.h"

#include <string.h>

#include "encoder/enc_bits.h"
#include "encoder/enc_schedule.h"
#include "format/alloc.h"

/* A face may turn by up to about 78 degrees: cos^2 of it. */
#define MIN_COSINE_SQUARED 0.04

static void find_first(enc_surface *s)
{
    const uint32_t corner_count = 3 * s->face_count;

    memset(s->first, 0xff, s->vertex_count * sizeof *s->first);
    memset(s->degree, 0, s->vertex_count * sizeof *s->degree);
    for (uint32_t h = 0; h < corner_count; h++) {
        const uint32_t v = s->vertex[h];
        const bool boundary = s->twin[h] == ENC_NONE;

        if (s->first[v] == ENC_NONE || boundary)
            s->first[v] = h;
        /* An open fan has one neighbour more than faces, and the ghost. */
        s->degree[v] += boundary ? 3 : 1;
    }
}

/* Lists the fan of corner c, unless it was: `seen` has a bit a corner. */
static void add_fan(enc_surface *s, uint32_t c, uint32_t *seen, uint32_t *end)
{
    uint32_t start = c, count = 0;
    if (seen[c / 32] >> c % 32 & 1)
        return;
    while (s->twin[start] != ENC_NONE) {
        start = enc_next(s->twin[start]);
        if (start == c)
            break;
    }
    uint32_t h = start;
    do {
        seen[h / 32] |= UINT32_C(1) << h % 32;
        count++;
        h = enc_turn(s, h);
    } while (h != ENC_NONE && h != start);
    const uint32_t v = s->vertex[c];
    s->degree[v] += count + (h == ENC_NONE ? 2 : 0);
    s->fan[start] = ENC_NONE;
    if (s->first[v] == ENC_NONE)
        s->first[v] = start;
    else
        s->fan[end[v]] = start;
    end[v] = start;
}

/* The fans of each vertex, in the order of their first corners. */
static bool find_fans(enc_surface *s)
{
    const pmesh_allocator *a = &s->mesh->allocator;
    const size_t n = s->vertex_count, words = 3 * (size_t)s->face_count / 32 + 1;
    uint32_t *seen = pmesh_alloc_zero(a, words, sizeof *seen);
    uint32_t *end = pmesh_alloc(a, n, sizeof *end);
    const bool ready = seen && end;

    memset(s->first, 0xff, n * sizeof *s->first);
    memset(s->degree, 0, n * sizeof *s->degree);
    for (uint32_t c = 0; ready && c < 3 * s->face_count; c++)
        add_fan(s, c, seen, end);
    pmesh_release(a, seen, words, sizeof *seen);
    pmesh_release(a, end, n, sizeof *end);
    return ready;
}

pmesh_status enc_surface_create(const enc_mesh *mesh, enc_surface *out)
{
    const pmesh_allocator *a = &mesh->allocator;
    const size_t n = mesh->vertex_count, corners = 3 * (size_t)mesh->face_count;
    enc_surface s = { .mesh = mesh,
                      .vertex_count = mesh->vertex_count,
                      .face_count = mesh->face_count };

    s.vertex = pmesh_alloc(a, corners, sizeof *s.vertex);
    s.twin = pmesh_alloc(a, corners, sizeof *s.twin);
    if (mesh->wedge)
        s.wedge = pmesh_alloc(a, corners, sizeof *s.wedge);
    if (mesh->joined)
        s.fan = pmesh_alloc(a, corners, sizeof *s.fan);
    s.first = pmesh_alloc(a, n, sizeof *s.first);
    s.degree = pmesh_alloc(a, n, sizeof *s.degree);
    s.position = pmesh_alloc(a, n, sizeof *s.position);
    s.changed = pmesh_alloc_zero(a, enc_bit_words(mesh->face_count),
                                 sizeof *s.changed);
    *out = s;
    if (!s.vertex || !s.twin || (mesh->wedge && !s.wedge) || !s.first ||
        !s.degree || !s.position || !s.changed ||
        (mesh->joined && !s.fan)) {
        enc_surface_destroy(out);
        return PMESH_E_MEMORY;
    }
    memcpy(s.vertex, mesh->vertex, corners * sizeof *s.vertex);
    memcpy(s.twin, mesh->twin, corners * sizeof *s.twin);
    if (mesh->wedge)
        memcpy(s.wedge, mesh->wedge, corners * sizeof *s.wedge);
    memcpy(s.position, mesh->position, n * sizeof *s.position);
    if (!mesh->joined) {
        find_first(out);
    } else if (!find_fans(out)) {
        enc_surface_destroy(out);
        return PMESH_E_MEMORY;
    }
    return PMESH_OK;
}

void enc_surface_destroy(enc_surface *s)
{
    const enc_mesh *mesh = s->mesh;

    if (!mesh)
        return;
    const pmesh_allocator *a = &mesh->allocator;
    const size_t n = mesh->vertex_count, corners = 3 * (size_t)mesh->face_count;
    pmesh_release(a, s->vertex, corners, sizeof *s->vertex);
    pmesh_release(a, s->twin, corners, sizeof *s->twin);
    pmesh_release(a, s->wedge, corners, sizeof *s->wedge);
    pmesh_release(a, s->fan, corners, sizeof *s->fan);
    pmesh_release(a, s->first, n, sizeof *s->first);
    pmesh_release(a, s->degree, n, sizeof *s->degree);
    pmesh_release(a, s->position, n, sizeof *s->position);
    pmesh_release(a, s->changed, enc_bit_words(mesh->face_count),
                  sizeof *s->changed);
    *s = (enc_surface){ 0 };
}

uint32_t enc_surface_fan_faces(const enc_surface *s, uint32_t c, bool *open)
{
    uint32_t faces = 1, h = c;
    while (faces < 4 && (h = enc_turn(s, h)) != ENC_NONE && h != c)
        faces++;
    *open = h == ENC_NONE;
    for (h = c; *open && faces < 4 && s->twin[h] != ENC_NONE; faces++)
        h = enc_next(s->twin[h]);
    return faces;
}

/* Its fan has four members, the ghost included. */
static bool wing_can_spare(const enc_surface *s, uint32_t h)
{
    if (h == ENC_NONE)
        return true;
    const uint32_t corner = enc_prev(h);
    bool open;
    if (!s->fan)
        return s->degree[s->vertex[corner]] >= 4;
    return enc_surface_fan_faces(s, corner, &open) >= (open ? 2 : 4);
}

/* All that is asked for but the link condition. */
static inline bool rings_fit(const enc_surface *s, uint32_t h)
{
    const uint32_t u = s->vertex[h], v = s->vertex[enc_next(h)];
    const uint32_t twin = s->twin[h];
    /* Each end leaves the other's ring; two members were in both. */
    const uint64_t merged = (uint64_t)s->degree[u] + s->degree[v] - 4;

    if (merged < 3 || merged > ENC_MAX_RING)
        return false;
    if (!wing_can_spare(s, h) || !wing_can_spare(s, twin))
        return false;
    return twin == ENC_NONE || !enc_on_boundary(s, u) || !enc_on_boundary(s, v);
}

/* The neighbours of a vertex whose rings fit, in any order. */
typedef struct gathered {
    uint32_t count;
    uint32_t member[ENC_MAX_RING + 4];
    uint64_t some; /* bits of their numbers, to tell most others apart */
} gathered;

static void gather(gathered *ring, uint32_t v)
{
    ring->member[ring->count++] = v;
    ring->some |= UINT64_C(1) << v % 64;
}

static bool has(const gathered *ring, uint32_t v)
{
    if (!(ring->some >> v % 64 & 1))
        return false;
    for (uint32_t i = 0; i < ring->count; i++)
        if (ring->member[i] == v)
            return true;
    return false;
}

static void gather_fan(const enc_surface *s, uint32_t start, gathered *ring)
{
    uint32_t h = start, last;

    do {
        gather(ring, s->vertex[enc_next(h)]);
        last = enc_prev(h);
        h = s->twin[last];
    } while (h != ENC_NONE && h != start);
    if (h == ENC_NONE)
        gather(ring, s->vertex[last]);
}

/* The link condition; the ends' rings fit. */
static bool have_wings_alone(const enc_surface *s, uint32_t h)
{
    const uint32_t wings = s->twin[h] == ENC_NONE ? 1 : 2;
    const uint32_t start = s->first[s->vertex[enc_next(h)]];
    uint32_t common = 0, last;
    gathered ring; /* large: filled as far as needed */

    ring.count = 0;
    ring.some = 0;
    for (uint32_t fan = s->first[s->vertex[h]]; fan != ENC_NONE;
         fan = enc_next_fan(s, fan))
        gather_fan(s, fan, &ring);
    h = start;
    do {
        common += has(&ring, s->vertex[enc_next(h)]);
        last = enc_prev(h);
        h = s->twin[last];
    } while (h != ENC_NONE && h != start);
    if (h == ENC_NONE)
        common += has(&ring, s->vertex[last]);
    return common == wings;
}

bool enc_surface_can_join(const enc_surface *s, uint32_t h)
{
    return rings_fit(s, h) && have_wings_alone(s, h);
}

bool enc_surface_can_join_signed(const enc_surface *s, const enc_sign *sign,
                                 uint32_t h)
{
    const uint32_t u = s->vertex[h], v = s->vertex[enc_next(h)];
    const uint32_t twin = s->twin[h];

    if (!rings_fit(s, h))
        return false;
    const uint32_t left = s->vertex[enc_prev(h)];
    const uint32_t right =
        twin == ENC_NONE ? left : s->vertex[enc_prev(twin)];
    return enc_sign_excludes(&sign[u], &sign[v], left, right) ||
           have_wings_alone(s, h);
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The faces of v except those that contain `other`. */
static bool fan_flips(const enc_surface *s, uint32_t v, uint32_t other,
                      const int32_t place[3])
{
    uint32_t start = s->first[v];
    for (uint32_t h = start; h != ENC_NONE; h = enc_around(s, &start, h)) {
        if (s->vertex[enc_next(h)] != other &&
            s->vertex[enc_prev(h)] != other) {
            double before[3], after[3];
            enc_surface_normal(s, h, s->position[v], before);
            enc_surface_normal(s, h, place, after);

            const double old = dot(before, before), now = dot(after, after);
            const double turn = dot(before, after);
            if (old > 0 &&
                (turn <= 0 || turn * turn < MIN_COSINE_SQUARED * old * now))
                return true;
        }
    }
    return false;
}

bool enc_surface_flips(const enc_surface *s, const enc_pair *pair,
                       const int32_t place[3])
{
    const int32_t *stay = s->position[pair->parent];
    const bool moves = memcmp(stay, place, sizeof s->position[0]) != 0;

    return fan_flips(s, pair->child, pair->parent, place) ||
           (moves && fan_flips(s, pair->parent, pair->child, place));
}

/* The wing's fan that started at `old` starts at `now`, or is gone. */
static void restart(enc_surface *s, uint32_t wing, uint32_t old, uint32_t now)
{
    uint32_t *at = &s->first[wing];
    while (s->fan && *at != ENC_NONE && *at != old)
        at = &s->fan[*at];
    if (*at != old)
        return;
    if (s->fan && now != ENC_NONE)
        s->fan[now] = s->fan[old];
    *at = s->fan && now == ENC_NONE ? s->fan[old] : now;
}

/* h is dead; `heir`, in a face beside it, has the same start. */
static void bury(enc_surface *s, uint32_t h, uint32_t heir)
{
    s->twin[h] = heir != ENC_NONE ? heir : ENC_AT_VERTEX | s->vertex[h];
    s->vertex[h] = ENC_NONE;
}

void enc_surface_bury_face(enc_surface *s, uint32_t face)
{
    for (uint32_t h = 3 * face; h < 3 * face + 3; h++)
        bury(s, h, ENC_NONE);
}

void enc_surface_remove_face(enc_surface *s, uint32_t h)
{
    const uint32_t next = enc_next(h), prev = enc_prev(h);
    const uint32_t in = s->twin[next], out = s->twin[prev];
    const uint32_t wing = s->vertex[prev];

    if (in != ENC_NONE)
        s->twin[in] = out;
    if (out != ENC_NONE)
        s->twin[out] = in;
    restart(s, wing, prev, in);
    s->degree[wing] -= in == ENC_NONE && out == ENC_NONE ? 3 : 1;
    bury(s, h, out);
    bury(s, next, out);
    bury(s, prev, in);
    s->face_count--;
}

/* The half-edge from which the merged fan is to be turned. `next` lies in the
 * face that dies with its half-edge h and has the same start once merged. */
static uint32_t merged_first(const enc_surface *s, const enc_pair *pair)
{
    const uint32_t left = pair->left, right = pair->right;

    if (!enc_on_boundary(s, pair->parent))
        return s->twin[enc_prev(left)]; /* child -> left wing */
    if (left == ENC_NONE) {
        /* The boundary arrived by the dying edge, parent -> child. */
        const uint32_t first = s->first[pair->child];
        return first == enc_next(right) ? s->twin[enc_prev(right)] : first;
    }
    const uint32_t first = s->first[pair->parent];
    return first == enc_next(left) ? s->twin[enc_prev(left)] : first;
}

/* All faces around v have changed. */
static void change_star(enc_surface *s, uint32_t v)
{
    uint32_t start = s->first[v];
    for (uint32_t h = start; h != ENC_NONE; h = enc_around(s, &start, h))
        enc_bit_put(s->changed, h / 3);
}

void enc_surface_contract(enc_surface *s, const enc_pair *pair,
                          const int32_t place[3], const uint32_t *wedge_parent)
{
    const uint32_t u = pair->child, v = pair->parent;
    const uint32_t first = merged_first(s, pair);

    if (memcmp(s->position[v], place, sizeof s->position[0]) != 0)
        change_star(s, v);
    uint32_t h = s->first[u];
    do {
        s->vertex[h] = v;
        enc_bit_put(s->changed, h / 3);
        if (s->wedge)
            s->wedge[h] = wedge_parent[s->wedge[h]];
        h = enc_turn(s, h);
    } while (h != ENC_NONE && h != s->first[u]);

    if (pair->left != ENC_NONE)
        enc_surface_remove_face(s, pair->left);
    if (pair->right != ENC_NONE)
        enc_surface_remove_face(s, pair->right);
    s->first[u] = ENC_NONE;
    s->first[v] = first;
    if (s->fan)
        s->fan[first] = ENC_NONE;
    s->degree[v] += s->degree[u] - 4;
    memcpy(s->position[v], place, sizeof s->position[0]);
    s->vertex_count--;
}
