/* SPDX-License-Identifier: MIT */
#include "encoder/enc_schedule.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "tests/unit/test.h"

enum { MAX_VERTICES = 1200, MAX_FACES = 2400, MAX_CORNERS = 3 * MAX_FACES };

/* A mesh under construction: a height field or a torus, on a square lattice. */
typedef struct soup {
    uint32_t vertex_count, face_count;
    double position[MAX_VERTICES][3];
    uint32_t index[MAX_CORNERS];
    uint32_t material[MAX_FACES];
    float value[MAX_CORNERS][2]; /* per corner; equal ones make one wedge */
    uint32_t value_index[MAX_CORNERS];
} soup;

/* One schedule and all that it was made from. */
typedef struct trial {
    soup *soup;
    bool attributes;
    pmesh_encoder_config config;
    enc_mesh mesh;
    enc_schedule schedule;
} trial;

static uint32_t random_below(uint32_t *seed, uint32_t n)
{
    *seed = *seed * 1664525u + 1013904223u;
    return (uint32_t)((uint64_t)(*seed >> 8) * n >> 24);
}

static double noise(uint32_t *seed, double size)
{
    return size * (random_below(seed, 1000) / 500.0 - 1);
}

static void add_face(soup *s, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *corner = &s->index[3 * s->face_count++];

    corner[0] = a;
    corner[1] = b;
    corner[2] = c;
}

/* Two faces for each cell of a lattice, closed or open in either direction. */
static void add_cells(soup *s, uint32_t w, uint32_t h, bool round_w,
                      bool round_h)
{
    for (uint32_t j = 0; j + !round_h < h; j++) {
        for (uint32_t i = 0; i + !round_w < w; i++) {
            const uint32_t right = (i + 1) % w, up = (j + 1) % h;
            add_face(s, j * w + i, j * w + right, up * w + right);
            add_face(s, j * w + i, up * w + right, up * w + i);
        }
    }
}

static soup *field(uint32_t side, double bumps)
{
    soup *s = calloc(1, sizeof *s);
    uint32_t seed = side;

    s->vertex_count = side * side;
    for (uint32_t v = 0; v < s->vertex_count; v++) {
        s->position[v][0] = v % side;
        s->position[v][1] = (double)(v / side);
        s->position[v][2] = noise(&seed, bumps);
    }
    add_cells(s, side, side, false, false);
    return s;
}

/* Round both ways: a torus; one way: a tube with two rims. */
static soup *torus(uint32_t w, uint32_t h, bool closed)
{
    soup *s = calloc(1, sizeof *s);
    uint32_t seed = w;

    s->vertex_count = w * h;
    for (uint32_t v = 0; v < s->vertex_count; v++) {
        const double a = 6.2832 * (v % w) / w, b = 6.2832 * (v / w) / h;
        const double r = 3 + cos(b) + noise(&seed, 0.02);
        s->position[v][0] = r * cos(a);
        s->position[v][1] = r * sin(a);
        s->position[v][2] = sin(b);
    }
    add_cells(s, w, h, true, closed);
    return s;
}

/* Two cones base to base: the tips have rings of `spokes` members. Without
 * height only one, a flat wheel, whose hub costs nothing to contract. */
static soup *spindle(uint32_t spokes, double height)
{
    soup *s = calloc(1, sizeof *s);

    s->vertex_count = spokes + 1 + (height > 0);
    s->position[spokes][2] = height;
    s->position[spokes + 1][2] = -height;
    for (uint32_t v = 0; v < spokes; v++) {
        const uint32_t next = (v + 1) % spokes;
        s->position[v][0] = cos(6.2832 * v / spokes);
        s->position[v][1] = sin(6.2832 * v / spokes);
        add_face(s, v, next, spokes);
        if (height > 0)
            add_face(s, next, v, spokes + 1);
    }
    return s;
}

typedef enum look { PLAIN, SEAMED, FACETED } look;

/* Seamed: texture coordinates follow x and y, and jump at the middle of x.
 * Faceted: each corner has values of its own. */
static void paint(soup *s, look how)
{
    double middle = 0;

    for (uint32_t v = 0; v < s->vertex_count; v++)
        middle += s->position[v][0] / s->vertex_count;
    for (uint32_t c = 0; c < 3 * s->face_count; c++) {
        const uint32_t f = c / 3;
        double x = 0;
        for (uint32_t k = 3 * f; k < 3 * f + 3; k++)
            x += s->position[s->index[k]][0] / 3;
        s->value_index[c] = c;
        s->value[c][0] =
            (float)s->position[s->index[c]][0] + (x > middle ? 100.0f : 0.0f);
        s->value[c][1] = (float)s->position[s->index[c]][1];
        if (how == FACETED)
            s->value[c][0] += (float)(c * 7919 % 1000);
        s->material[f] = x > middle;
    }
}

static pmesh_status import(trial *t)
{
    const soup *s = t->soup;
    const pmesh_attribute_input attribute = { .kind = PMESH_TEXCOORD,
                                              .components = 2,
                                              .values = s->value[0],
                                              .count = 3 * s->face_count,
                                              .indices = s->value_index };
    const pmesh_mesh_input in = { .positions = s->position[0],
                                  .vertex_count = s->vertex_count,
                                  .indices = s->index,
                                  .face_count = s->face_count,
                                  .materials =
                                      t->attributes ? s->material : NULL,
                                  .material_count = t->attributes ? 2 : 1,
                                  .attributes = &attribute,
                                  .attribute_count = t->attributes };
    pmesh_encode_report report = { 0 };

    return enc_mesh_import(&in, &t->config, NULL, &t->mesh, &report);
}

static trial trial_of(soup *s, look how)
{
    trial t = { .soup = s, .attributes = how != PLAIN };

    if (how != PLAIN)
        paint(s, how);
    t.config = pmesh_encoder_config_default();
    t.config.profile = PMESH_QUALITY;
    return t;
}

static void run(trial *t)
{
    CHECK(import(t) == PMESH_OK);
    CHECK(enc_schedule_build(&t->mesh, &t->config, 0, &t->schedule) == PMESH_OK);
}

static void finish(trial *t)
{
    enc_schedule_destroy(&t->schedule);
    enc_mesh_destroy(&t->mesh);
    free(t->soup);
}

/* A mesh on the way: where each vertex has gone, and which faces are left. */
typedef struct state {
    const trial *trial;
    uint32_t label[MAX_VERTICES];
    uint32_t wedge[MAX_CORNERS];
    bool dead[MAX_FACES];
    uint32_t vertex_count, face_count;
} state;

static bool removes(const trial *t, uint32_t contraction, uint32_t face)
{
    return t->schedule.face_end[face] == contraction;
}

static void state_start(state *s, const trial *t)
{
    *s = (state){ .trial = t,
                  .vertex_count = t->mesh.vertex_count,
                  .face_count = t->mesh.face_count };
    for (uint32_t v = 0; v < t->mesh.vertex_count; v++)
        s->label[v] = v;
    for (uint32_t c = 0; t->mesh.wedge && c < 3 * t->mesh.face_count; c++)
        s->wedge[c] = t->mesh.wedge[c];
}

static void state_contract(state *s, uint32_t index)
{
    const trial *t = s->trial;
    const enc_contraction *c = &t->schedule.contraction[index];

    CHECK(s->label[c->child] == c->child && s->label[c->parent] == c->parent);
    for (uint32_t v = 0; v < t->mesh.vertex_count; v++)
        if (s->label[v] == c->child)
            s->label[v] = c->parent;
    for (uint32_t f = 0; f < t->mesh.face_count; f++) {
        if (removes(t, index, f)) {
            CHECK(!s->dead[f]);
            s->dead[f] = true;
            s->face_count--;
        }
    }
    for (uint32_t h = 0; t->mesh.wedge && h < 3 * t->mesh.face_count; h++)
        if (t->mesh.wedge_vertex[s->wedge[h]] == c->child)
            s->wedge[h] = t->schedule.wedge_parent[s->wedge[h]];
    s->vertex_count--;
}

static uint32_t state_vertex(const state *s, uint32_t corner)
{
    return s->label[s->trial->mesh.vertex[corner]];
}

typedef struct side {
    uint32_t from, to, corner;
} side;

static int compare_sides(const void *a, const void *b)
{
    const side *x = a, *y = b;

    if (x->from != y->from)
        return x->from < y->from ? -1 : 1;
    return x->to < y->to ? -1 : x->to > y->to;
}

/* The face at `from` behind the one with side from -> to: the side that leaves
 * from the same vertex, counter-clockwise. NULL at a boundary. */
static const side *turn(const state *s, const side *sides, uint32_t count,
                        const side *at)
{
    const uint32_t face = at->corner / 3;
    const side key = { at->from,
                       state_vertex(s, 3 * face + (at->corner + 2) % 3), 0 };

    return bsearch(&key, sides, count, sizeof *sides, compare_sides);
}

/* Independent of the encoder's own structures: half-edges that are unique, and
 * for each vertex one fan that holds all its faces, of a legal size. */
static void check_manifold(const state *s)
{
    static side sides[MAX_CORNERS];
    uint32_t count = 0, inner = 0, vertices = 0;

    for (uint32_t h = 0; h < 3 * s->trial->mesh.face_count; h++) {
        const uint32_t next = h - h % 3 + (h + 1) % 3;
        if (s->dead[h / 3])
            continue;
        sides[count++] = (side){ state_vertex(s, h), state_vertex(s, next), h };
        CHECK(sides[count - 1].from != sides[count - 1].to);
    }
    qsort(sides, count, sizeof *sides, compare_sides);
    for (uint32_t i = 1; i < count; i++)
        CHECK(compare_sides(&sides[i - 1], &sides[i]) < 0);

    for (uint32_t i = 0, faces; i < count; i += faces) {
        const side *start = &sides[i], *at;
        uint32_t met = 0, open = 0;

        for (faces = 0;
             i + faces < count && sides[i + faces].from == start->from;
             faces++) {
            const side back = { sides[i + faces].to, start->from, 0 };
            if (bsearch(&back, sides, count, sizeof *sides, compare_sides)) {
                inner++;
            } else {
                start = &sides[i + faces];
                open++;
            }
        }
        CHECK(open <= 1);
        at = start;
        do {
            met++;
            at = turn(s, sides, count, at);
        } while (at && at != start);
        CHECK(met == faces && (at == NULL) == (open == 1));
        CHECK(faces + 2 * open >= 3);
        vertices++;
    }
    CHECK(count == 3 * s->face_count && vertices == s->vertex_count);
    CHECK(inner % 2 == 0);
    /* V - E + F stays: one edge per side, but inner ones have two. */
    const trial *t = s->trial;
    uint32_t edges = 0;
    for (uint32_t h = 0; h < 3 * t->mesh.face_count; h++)
        edges += h < t->mesh.twin[h];
    CHECK(vertices + s->face_count + edges ==
          t->mesh.vertex_count + t->mesh.face_count + (count - inner / 2));
}

static void check_wedges(const state *s)
{
    const enc_mesh *mesh = &s->trial->mesh;

    for (uint32_t h = 0; mesh->wedge && h < 3 * mesh->face_count; h++)
        CHECK(s->dead[h / 3] ||
              mesh->wedge_vertex[s->wedge[h]] == state_vertex(s, h));
}

/* Applies random parts of every batch, one after the other, and then the rest
 * of it; every mesh on the way must be sound. */
static void check_batches(const trial *t)
{
    static state before, s;
    const enc_schedule *sch = &t->schedule;
    uint32_t seed = 1, order[MAX_VERTICES];

    CHECK(sch->batch_count > 0);
    state_start(&before, t);
    for (uint32_t b = 0; b < sch->batch_count; b++) {
        const uint32_t first = sch->batch_first[b];
        const uint32_t count = sch->batch_first[b + 1] - first;

        CHECK(count > 0);
        for (int round = 0; round < 4; round++) {
            s = before;
            for (uint32_t i = 0; i < count; i++) {
                const uint32_t k = random_below(&seed, i + 1);
                order[i] = order[k];
                order[k] = first + i;
            }
            const uint32_t part = random_below(&seed, count + 1);
            for (uint32_t i = 0; i < part; i++)
                state_contract(&s, order[i]);
            check_manifold(&s);
            check_wedges(&s);
        }
        for (uint32_t i = 0; i < count; i++)
            state_contract(&before, first + i);
        check_manifold(&before);
    }
    for (uint32_t f = 0; f < t->mesh.face_count; f++)
        CHECK((sch->face_end[f] == ENC_NONE) == !before.dead[f]);
}

/* All profiles and placements on one kind of mesh. */
static void check_profiles(soup *(*make)(void), look how)
{
    for (unsigned i = 0; i < 12; i++) {
        trial t = trial_of(make(), how);

        t.config.profile = (pmesh_profile)(i % 3);
        t.config.placement = i / 3 % 2 ? PMESH_OPTIMAL : PMESH_SUBSET;
        t.config.metric = i / 6 ? PMESH_ACCUMULATED : PMESH_MEMORYLESS;
        t.config.base_faces = 1;
        run(&t);
        check_batches(&t);
        finish(&t);
    }
}

static soup *some_torus(void)
{
    return torus(32, 16, true);
}
static soup *some_tube(void)
{
    return torus(24, 12, false);
}
static soup *some_field(void)
{
    return field(20, 0.3);
}
static soup *flat_field(void)
{
    return field(16, 0);
}
static soup *some_spindle(void)
{
    return spindle(200, 1);
}
static soup *some_wheel(void)
{
    return spindle(90, 0);
}

TEST(schedule_subsets_of_a_batch_are_manifolds)
{
    check_profiles(some_torus, PLAIN);
    check_profiles(some_tube, PLAIN);
    check_profiles(some_field, PLAIN);
    check_profiles(flat_field, PLAIN);
    check_profiles(some_spindle, PLAIN);
    check_profiles(some_wheel, PLAIN);
}

TEST(schedule_subsets_keep_wedges_at_their_vertices)
{
    check_profiles(some_torus, SEAMED);
    check_profiles(some_field, SEAMED);
    check_profiles(some_field, FACETED);
    check_profiles(some_spindle, FACETED);
}

TEST(schedule_batches_are_disjoint_pairs)
{
    trial t = trial_of(some_torus(), PLAIN);
    uint32_t used[MAX_VERTICES] = { 0 };

    run(&t);
    for (uint32_t b = 0; b < t.schedule.batch_count; b++) {
        for (uint32_t i = t.schedule.batch_first[b];
             i < t.schedule.batch_first[b + 1]; i++) {
            const enc_contraction *c = &t.schedule.contraction[i];
            CHECK(used[c->child] <= b && used[c->parent] <= b);
            used[c->child] = used[c->parent] = b + 1;
            CHECK(t.schedule.vertex_end[c->child] == i);
        }
    }
    finish(&t);
}

/* The ring that the decoder meets is largest if nothing else is contracted. */
static void check_rings(soup *made)
{
    static state s;
    trial t = trial_of(made, PLAIN);
    uint32_t ring[MAX_VERTICES];

    t.config.base_faces = 4;
    run(&t);
    state_start(&s, &t);
    for (uint32_t b = 0; b < t.schedule.batch_count; b++) {
        memset(ring, 0, sizeof ring);
        for (uint32_t h = 0; h < 3 * t.mesh.face_count; h++)
            ring[state_vertex(&s, h)] += !s.dead[h / 3];
        for (uint32_t i = t.schedule.batch_first[b];
             i < t.schedule.batch_first[b + 1]; i++) {
            const enc_contraction *c = &t.schedule.contraction[i];
            CHECK(ring[c->child] + ring[c->parent] <= ENC_MAX_RING + 4);
            state_contract(&s, i);
        }
    }
    CHECK(s.face_count <= 5);
    finish(&t);
}

TEST(schedule_rings_stay_within_the_bound)
{
    check_rings(spindle(300, 1));
    check_rings(spindle(300, 0));
}

TEST(schedule_stops_where_it_is_told)
{
    static const uint32_t targets[] = { 900, 333, 77 };

    for (unsigned i = 0; i < 3; i++) {
        trial t = trial_of(some_torus(), PLAIN);
        uint32_t faces = 0;

        t.config.base_faces = targets[i];
        run(&t);
        for (uint32_t f = 0; f < t.mesh.face_count; f++)
            faces += t.schedule.face_end[f] == ENC_NONE;
        CHECK(faces <= targets[i] && faces + 1 >= targets[i]);
        finish(&t);

        t = trial_of(some_torus(), PLAIN);
        t.config.base_vertices = targets[i] / 2;
        run(&t);
        CHECK(t.mesh.vertex_count - t.schedule.contraction_count ==
              targets[i] / 2);
        finish(&t);
    }
}

TEST(schedule_stops_at_the_ratio_and_the_error)
{
    trial t = trial_of(some_torus(), PLAIN);

    t.config.base_ratio = 0.5;
    run(&t);
    CHECK(t.schedule.contraction_count == t.mesh.vertex_count / 2);
    finish(&t);

    t = trial_of(field(16, 0.1), PLAIN);
    t.config.base_error = 0.1;
    run(&t);
    CHECK(t.schedule.contraction_count > 0);
    for (uint32_t b = 0; b < t.schedule.batch_count; b++) {
        const double error = t.schedule.batch_error[b];
        CHECK(error >= (b > 0 ? t.schedule.batch_error[b - 1] : 0));
        CHECK(error * t.mesh.grid.step <= 0.1);
    }
    finish(&t);
}

TEST(schedule_leaves_the_smallest_meshes_alone)
{
    for (unsigned i = 0; i < 2; i++) {
        soup *s = calloc(1, sizeof *s);
        s->vertex_count = 4;
        s->position[1][0] = s->position[2][1] = s->position[3][2] = 1;
        add_face(s, 0, 2, 1);
        if (i == 1) {
            add_face(s, 0, 1, 3);
            add_face(s, 1, 2, 3);
            add_face(s, 0, 3, 2);
        }
        trial t = trial_of(s, PLAIN);
        t.config.base_faces = 1;
        run(&t);
        CHECK(t.schedule.batch_count == 0);
        CHECK(t.schedule.batch_first[0] == 0);
        CHECK(t.schedule.contraction_count == 0);
        finish(&t);
    }
}

TEST(schedule_with_subset_placement_moves_no_vertex)
{
    trial t = trial_of(some_field(), SEAMED);

    run(&t);
    CHECK(memcmp(t.schedule.position, t.mesh.position,
                 t.mesh.vertex_count * sizeof *t.mesh.position) == 0);
    for (uint32_t i = 0; i < t.schedule.contraction_count; i++) {
        const enc_contraction *c = &t.schedule.contraction[i];
        CHECK(memcmp(c->before, t.mesh.position[c->parent], sizeof c->before) ==
              0);
    }
    finish(&t);
}

TEST(schedule_with_optimal_placement_undoes_to_the_input)
{
    trial t = trial_of(some_field(), PLAIN);

    t.config.placement = PMESH_OPTIMAL;
    run(&t);
    for (uint32_t v = 0; v < t.mesh.vertex_count; v++)
        for (int k = 0; k < 3; k++)
            CHECK(t.schedule.position[v][k] >= 0 &&
                  t.schedule.position[v][k] <= t.mesh.bounds[k]);
    for (uint32_t i = t.schedule.contraction_count; i-- > 0;) {
        const enc_contraction *c = &t.schedule.contraction[i];
        memcpy(t.schedule.position[c->parent], c->before, sizeof c->before);
    }
    CHECK(memcmp(t.schedule.position, t.mesh.position,
                 t.mesh.vertex_count * sizeof *t.mesh.position) == 0);
    finish(&t);
}

TEST(schedule_keeps_seams_as_long_as_it_can)
{
    trial t = trial_of(field(20, 0.05), SEAMED);

    t.config.base_faces = 100;
    run(&t);
    /* A wedge on one side of the jump never goes over to the other. */
    for (uint32_t w = 0; w < t.mesh.wedge_count; w++) {
        const uint32_t parent = t.schedule.wedge_parent[w];
        if (parent == ENC_NONE)
            continue;
        CHECK((t.mesh.value[2 * w] < 2048) ==
              (t.mesh.value[2 * parent] < 2048));
    }
    finish(&t);
}

TEST(schedule_gives_every_wedge_of_a_child_a_parent)
{
    trial t = trial_of(some_field(), FACETED);

    run(&t);
    CHECK(t.schedule.contraction_count > 0);
    for (uint32_t w = 0; w < t.mesh.wedge_count; w++) {
        const uint32_t end = t.schedule.vertex_end[t.mesh.wedge_vertex[w]];
        const uint32_t parent = t.schedule.wedge_parent[w];
        if (end == ENC_NONE)
            CHECK(parent == ENC_NONE);
        else
            CHECK(t.mesh.wedge_vertex[parent] ==
                  t.schedule.contraction[end].parent);
    }
    finish(&t);
}

/* Without attributes a flat square needs two faces; the rim must stay. */
TEST(schedule_keeps_corners_of_a_flat_square)
{
    static const int32_t ends[2] = { 0, (1 << 14) - 1 };
    trial t = trial_of(flat_field(), PLAIN);
    unsigned corners = 0;

    t.config.base_faces = 2;
    run(&t);
    CHECK(t.mesh.vertex_count - t.schedule.contraction_count == 4);
    for (uint32_t v = 0; v < t.mesh.vertex_count; v++) {
        const int32_t *p = t.schedule.position[v];
        corners += t.schedule.vertex_end[v] == ENC_NONE &&
                   (p[0] == ends[0] || p[0] == ends[1]) &&
                   (p[1] == ends[0] || p[1] == ends[1]);
    }
    CHECK(corners == 4);
    finish(&t);
}

typedef struct budget {
    size_t calls, allowed, blocks;
} budget;

static void *budget_alloc(void *user, size_t size)
{
    budget *b = user;

    if (b->calls++ >= b->allowed)
        return NULL;
    b->blocks++;
    return malloc(size);
}

static void budget_release(void *user, void *ptr, size_t size)
{
    (void)size;
    ((budget *)user)->blocks--;
    free(ptr);
}

TEST(schedule_survives_every_failure_of_memory)
{
    budget b = { 0, SIZE_MAX, 0 };
    trial t = trial_of(field(8, 0.1), SEAMED);
    pmesh_status status = PMESH_E_MEMORY;

    t.config.allocator = (pmesh_allocator){ budget_alloc, budget_release, &b };
    CHECK(import(&t) == PMESH_OK);
    const size_t blocks = b.blocks;
    for (size_t n = 0; n < 100 && status != PMESH_OK; n++) {
        b.calls = 0;
        b.allowed = n;
        status = enc_schedule_build(&t.mesh, &t.config, 0, &t.schedule);
        CHECK(status == PMESH_OK ||
              (status == PMESH_E_MEMORY && b.blocks == blocks));
    }
    CHECK(status == PMESH_OK && b.blocks > blocks);
    b.allowed = SIZE_MAX;
    finish(&t);
    CHECK(b.blocks == 0);
}

static int cancel_at_once(void *user, const char *stage, double done)
{
    (void)user;
    return stage && done >= 0 && done <= 1;
}

TEST(schedule_can_be_cancelled)
{
    trial t = trial_of(some_field(), PLAIN);

    t.config.progress = cancel_at_once;
    CHECK(import(&t) == PMESH_OK);
    CHECK(enc_schedule_build(&t.mesh, &t.config, 0, &t.schedule) ==
          PMESH_E_CANCELLED);
    CHECK(t.schedule.contraction == NULL);
    finish(&t);
}
