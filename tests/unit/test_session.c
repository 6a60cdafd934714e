/* SPDX-License-Identifier: MIT */
#include "encoder/pmesh_session.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "encoder/enc_session.h"
#include "tests/unit/lods.h"
#include "tests/unit/shapes.h"
#include "tests/unit/test.h"

static uint64_t add_hash(uint64_t h, const void *data, size_t size)
{
    const unsigned char *p = data;
    for (size_t i = 0; i < size; i++)
        h = (h ^ p[i]) * 1099511628211u;
    return h;
}

/* All that there is now: faces, places, quadrics, weights. */
static uint64_t hash_of(const pmesh_session *s)
{
    const size_t faces = pmesh_session_faces(s);
    uint32_t *indices = malloc((3 * faces + 1) * sizeof *indices);
    uint64_t h = 14695981039346656037u;

    pmesh_session_indices(s, indices);
    h = add_hash(h, indices, 3 * faces * sizeof *indices);
    for (size_t c = 0; c < 3 * faces; c++) {
        pmesh_session_node node;
        pmesh_session_look(s, indices[c], &node);
        h = add_hash(h, &node, sizeof node);
    }
    free(indices);
    return h;
}

/* Every edge has two faces, which run along it in opposite ways. */
static bool is_closed(const pmesh_session *s)
{
    const size_t n = 3 * pmesh_session_faces(s);
    uint32_t *v = malloc((n + 1) * sizeof *v);
    bool closed = true;

    pmesh_session_indices(s, v);
    for (size_t c = 0; c < n; c++) {
        const uint32_t a = v[c], b = v[c % 3 == 2 ? c - 2 : c + 1];
        unsigned same = 0, back = 0;
        for (size_t d = 0; d < n; d++) {
            const uint32_t e = v[d], f = v[d % 3 == 2 ? d - 2 : d + 1];
            same += e == a && f == b;
            back += e == b && f == a;
        }
        closed = closed && same == 1 && back == 1;
    }
    free(v);
    return closed;
}

static pmesh_session *session_of(shape_mesh *shape)
{
    pmesh_session *s;
    CHECK(pmesh_session_create(&s, &shape->input, NULL) == PMESH_OK);
    shape_free(shape);
    return s;
}

static void move(pmesh_session *s, size_t faces)
{
    CHECK(pmesh_session_move(s, faces) == PMESH_OK);
}

TEST(session_reaches_any_size_and_stays_closed)
{
    pmesh_session *s = session_of(shape_make(SHAPE_TORUS, 20, 3));
    static const size_t sizes[] = { 800, 500, 60, 799, 333, 20, 400 };
    for (int i = 0; i < 7; i++) {
        move(s, sizes[i]);
        CHECK(pmesh_session_faces(s) <= sizes[i]);
        CHECK(pmesh_session_faces(s) + 2 > sizes[i] || sizes[i] < 30);
        CHECK(is_closed(s));
    }
    pmesh_session_destroy(s);
}

TEST(session_walks_without_guidance_are_exact)
{
    for (int guided = 0; guided < 2; guided++) {
        pmesh_session *s = session_of(shape_make(SHAPE_TERRAIN, 16, 3));
        static const uint32_t some[] = { 30, 31, 48, 120 };
        uint64_t known[513] = { 0 };
        uint32_t seed = 9;
        if (guided) {
            move(s, 100);
            CHECK(pmesh_session_weigh(s, some, 4, 0.9) == PMESH_OK);
            CHECK(pmesh_session_constrain(s, PMESH_POINT, some, 4, 1) ==
                  PMESH_OK);
            move(s, 512); /* from here on nobody says anything */
        }
        for (int i = 0; i < 1000; i++) {
            move(s, 40 + shape_random(&seed, 473));
            const size_t faces = pmesh_session_faces(s);
            const uint64_t h = hash_of(s);
            CHECK(faces <= 512 && (known[faces] == 0 || known[faces] == h));
            known[faces] = h;
        }
        pmesh_session_destroy(s);
    }
}

/* Of the whole mesh: the sum of all living vertices'. */
static void sum_constraints(const pmesh_session *s, uint32_t count,
                            double out[10])
{
    memset(out, 0, 10 * sizeof *out);
    for (uint32_t v = 0; v < count; v++) {
        pmesh_session_node node;
        if (pmesh_session_vertex(s, v) != v)
            continue;
        pmesh_session_look(s, v, &node);
        for (int k = 0; k < 10; k++)
            out[k] += node.constraint[k];
    }
}

TEST(session_constraints_halve_to_children_and_sum_to_parents)
{
    pmesh_session *s = session_of(shape_make(SHAPE_TORUS, 16, 2));
    double before[10], after[10];
    uint32_t v = 0;

    move(s, 100);
    v = pmesh_session_vertex(s, v);
    CHECK(pmesh_session_constrain(s, PMESH_POINT, &v, 1, 1) == PMESH_OK);
    sum_constraints(s, 256, before);
    CHECK(before[0] > 0);
    for (size_t faces = 512; faces > 60; faces -= 77) {
        move(s, faces);
        sum_constraints(s, 256, after);
        for (int k = 0; k < 10; k++)
            CHECK(fabs(after[k] - before[k]) <= 1e-9 * before[0]);
    }
    /* One split: each child has a half. */
    pmesh_session_destroy(s);
    s = session_of(shape_make(SHAPE_TORUS, 16, 2));
    move(s, 510);
    uint32_t gone = 0;
    while (pmesh_session_vertex(s, gone) == gone)
        gone++;
    const uint32_t kept = pmesh_session_vertex(s, gone);
    pmesh_session_node parent, child[2];
    CHECK(pmesh_session_constrain(s, PMESH_POINT, &kept, 1, 1) == PMESH_OK);
    pmesh_session_look(s, kept, &parent);
    move(s, 512);
    pmesh_session_look(s, kept, &child[0]);
    pmesh_session_look(s, gone, &child[1]);
    for (int k = 0; k < 10; k++)
        for (int i = 0; i < 2; i++)
            CHECK(fabs(child[i].constraint[k] - parent.constraint[k] / 2) <=
                  1e-9 * parent.constraint[0]);
    pmesh_session_destroy(s);
}

/* Painted where they are coarse, leaves have what eager painting gives them. */
TEST(session_weights_reach_the_leaves_by_alpha)
{
    pmesh_session *s = session_of(shape_make(SHAPE_TORUS, 16, 2));
    pmesh_session_node plain[256], node;
    uint32_t in[256];
    const uint32_t painted[2] = { 10, 140 };

    for (uint32_t v = 0; v < 256; v++)
        pmesh_session_look(s, v, &plain[v]);
    move(s, 60);
    for (uint32_t v = 0; v < 256; v++)
        in[v] = pmesh_session_vertex(s, v);
    CHECK(in[10] != in[140]);
    CHECK(pmesh_session_weigh(s, painted, 2, 0.75) == PMESH_OK);
    move(s, 512);
    for (uint32_t v = 0; v < 256; v++) {
        const bool heavy = in[v] == in[10] || in[v] == in[140];
        pmesh_session_look(s, v, &node);
        CHECK(node.weight == (heavy ? 0.75 : 0.5));
        for (int k = 0; k < 6; k++)
            CHECK(fabs(node.quadric[k] -
                       (heavy ? 10 : 1) * plain[v].quadric[k]) <=
                  1e-9 * 10 * (plain[v].quadric[0] + plain[v].quadric[3] +
                               plain[v].quadric[5]));
    }
    pmesh_session_destroy(s);
}

TEST(session_representative_weights_are_means)
{
    pmesh_session *s = session_of(shape_make(SHAPE_TORUS, 16, 2));
    pmesh_session_node node;

    move(s, 510); /* which pair goes first */
    uint32_t gone = 0;
    while (pmesh_session_vertex(s, gone) == gone)
        gone++;
    const uint32_t kept = pmesh_session_vertex(s, gone);
    move(s, 512);
    /* A little, so that it is first again. */
    CHECK(pmesh_session_weigh(s, &gone, 1, 0.5001) == PMESH_OK);
    move(s, 510);
    CHECK(pmesh_session_vertex(s, gone) == kept);
    pmesh_session_look(s, kept, &node);
    CHECK(fabs(node.weight - 0.50005) < 1e-12);
    pmesh_session_destroy(s);
}

/* More of what is painted is left, once it was refined and simplified again;
 * and what is far from it is simplified as before. */
TEST(session_guidance_changes_the_way_down)
{
    pmesh_session *s = session_of(shape_make(SHAPE_TORUS, 20, 5));
    uint32_t some[400], count = 0, before = 0, after = 0;

    move(s, 160);
    for (uint32_t v = 0; v < 400; v++) {
        pmesh_session_node node;
        pmesh_session_look(s, pmesh_session_vertex(s, v), &node);
        if (node.position[0] > 0.8)
            some[count++] = v;
    }
    CHECK(count > 30);
    for (uint32_t i = 0; i < count; i++)
        before += pmesh_session_vertex(s, some[i]) == some[i];
    CHECK(pmesh_session_weigh(s, some, count, 1) == PMESH_OK);
    move(s, 800);
    move(s, 160);
    for (uint32_t i = 0; i < count; i++)
        after += pmesh_session_vertex(s, some[i]) == some[i];
    CHECK(after > before + before / 2);
    pmesh_session_destroy(s);
}

TEST(session_points_stay_where_they_are)
{
    double drift[2];
    for (int guided = 0; guided < 2; guided++) {
        pmesh_session *s = session_of(shape_make(SHAPE_TORUS, 20, 5));
        const uint32_t tip = 123;
        pmesh_session_node first, last;
        double sum = 0;
        pmesh_session_look(s, tip, &first);
        if (guided)
            CHECK(pmesh_session_constrain(s, PMESH_POINT, &tip, 1, 1) ==
                  PMESH_OK);
        move(s, 60);
        pmesh_session_look(s, pmesh_session_vertex(s, tip), &last);
        for (int k = 0; k < 3; k++)
            sum += (last.position[k] - first.position[k]) *
                   (last.position[k] - first.position[k]);
        drift[guided] = sqrt(sum);
        pmesh_session_destroy(s);
    }
    CHECK(drift[1] < 0.1 * drift[0] && drift[1] < 0.01);
}

TEST(session_undo_is_exact_and_the_log_tells)
{
    pmesh_session *s = session_of(shape_make(SHAPE_TORUS, 16, 8));
    static const uint32_t some[] = { 5, 6, 7, 90 };
    uint64_t known[6];
    size_t count;

    CHECK(pmesh_session_undo(s) == PMESH_E_ARGUMENT);
    for (int i = 0; i < 6; i++) {
        known[i] = hash_of(s);
        switch (i) {
        case 0: move(s, 200); break;
        case 1: CHECK(pmesh_session_weigh(s, some, 4, 0.8) == PMESH_OK); break;
        case 2: move(s, 400); break;
        case 3:
            CHECK(pmesh_session_constrain(s, PMESH_CONTOUR, some, 3, 1) ==
                  PMESH_OK);
            break;
        case 4:
            CHECK(pmesh_session_constrain(s, PMESH_PLANE, some, 4, 2) ==
                  PMESH_OK);
            break;
        case 5: move(s, 100); break;
        }
    }
    const pmesh_session_step *log = pmesh_session_log(s, &count);
    CHECK(count == 6 && log[1].action == PMESH_SESSION_WEIGH);
    CHECK(log[0].faces == 200 && log[2].faces == 400 && log[5].faces == 100);
    CHECK(log[5].error > log[2].error && log[2].error >= 0);
    for (int i = 5; i >= 0; i--) {
        CHECK(pmesh_session_undo(s) == PMESH_OK);
        CHECK(hash_of(s) == known[i]);
    }
    pmesh_session_destroy(s);
}

static size_t faces_of_cut(const shape_mesh *shape, const uint32_t *vertex_of)
{
    size_t faces = 0;
    for (size_t f = 0; f < shape->input.face_count; f++) {
        const uint32_t *v = &shape->indices[3 * f];
        const uint32_t a = vertex_of[v[0]], b = vertex_of[v[1]],
                       c = vertex_of[v[2]];
        faces += a != b && b != c && c != a;
    }
    return faces;
}

/* Equal thresholds give what the order gave; others what it never showed. */
TEST(session_cuts_by_error_by_region)
{
    shape_mesh *shape = shape_make(SHAPE_TORUS, 20, 5);
    double thresholds[400], positions[1200];
    uint32_t vertex_of[400];
    size_t forced, count;
    pmesh_session *s;

    CHECK(pmesh_session_create(&s, &shape->input, NULL) == PMESH_OK);
    move(s, 100);
    const double error = pmesh_session_log(s, &count)->error;
    for (int v = 0; v < 400; v++)
        thresholds[v] = error;
    CHECK(pmesh_session_cut(s, thresholds, vertex_of, positions, &forced) ==
          PMESH_OK);
    CHECK(forced == 0 && faces_of_cut(shape, vertex_of) == 100);
    for (uint32_t v = 0; v < 400; v++)
        CHECK(vertex_of[v] == pmesh_session_vertex(s, v));

    size_t fine = 0;
    for (int v = 0; v < 400; v++)
        if (shape->positions[3 * v] > 0) {
            thresholds[v] = 0;
            fine++;
        }
    CHECK(pmesh_session_cut(s, thresholds, vertex_of, positions, &forced) ==
          PMESH_OK);
    for (uint32_t v = 0; v < 400; v++)
        if (thresholds[v] == 0) /* exact there */
            CHECK(vertex_of[v] == v);
    const size_t faces = faces_of_cut(shape, vertex_of);
    CHECK(faces > 2 * fine - 100 && faces < 800 && forced > 0);
    CHECK(pmesh_session_faces(s) == 100); /* which went nowhere */
    pmesh_session_destroy(s);
    shape_free(shape);
}

TEST(session_refuses_what_makes_no_sense)
{
    shape_mesh *shape = shape_make(SHAPE_TORUS, 8, 1);
    pmesh_mesh_input in = shape->input;
    pmesh_session *s;
    const uint32_t far = 64;

    in.indices = NULL;
    CHECK(pmesh_session_create(&s, &in, NULL) == PMESH_E_ARGUMENT && !s);
    in.face_count = 0;
    CHECK(pmesh_session_create(&s, &in, NULL) == PMESH_E_NO_FACES);
    in = shape->input;
    in.vertex_count = 63;
    CHECK(pmesh_session_create(&s, &in, NULL) == PMESH_E_INDEX);
    in = shape->input;
    shape->positions[3] = NAN;
    CHECK(pmesh_session_create(&s, &in, NULL) == PMESH_E_NOT_FINITE);
    shape->positions[3] = 0;
    CHECK(pmesh_session_create(&s, &in, NULL) == PMESH_OK);
    CHECK(pmesh_session_weigh(s, &far, 1, 0.5) == PMESH_E_ARGUMENT);
    CHECK(pmesh_session_weigh(s, &far, 0, 1.5) == PMESH_E_ARGUMENT);
    CHECK(pmesh_session_weigh(s, &far, 0, NAN) == PMESH_E_ARGUMENT);
    CHECK(pmesh_session_constrain(s, PMESH_POINT, &far, 0, -1) ==
          PMESH_E_ARGUMENT);
    CHECK(pmesh_session_constrain(s, (pmesh_constraint_kind)3, &far, 0, 1) ==
          PMESH_E_ARGUMENT);
    size_t count;
    pmesh_session_log(s, &count);
    CHECK(count == 0);
    pmesh_session_destroy(s);
    pmesh_session_destroy(NULL);
    shape_free(shape);
}

/* Soup, faces without area, vertices of no face. */
TEST(session_survives_any_mesh)
{
    for (uint32_t seed = 1; seed < 12; seed++) {
        shape_mesh *soup = shape_make(SHAPE_SOUP, 20 + seed, seed);
        pmesh_session *s = session_of(soup);
        const size_t all = pmesh_session_faces(s);
        const uint64_t before = hash_of(s);
        move(s, 3);
        CHECK(pmesh_session_faces(s) <= all);
        move(s, all);
        CHECK(hash_of(s) == before);
        pmesh_session_destroy(s);
    }
}

TEST(session_survives_every_failure_of_memory)
{
    shape_mesh *shape = shape_make(SHAPE_TORUS, 8, 1);
    static const uint32_t some[] = { 1, 2, 3 };
    double thresholds[64] = { 0 };
    uint32_t vertex_of[64];
    size_t forced, n = 0;
    bool done = false;

    for (; !done; n++) {
        lods_budget budget = { .left = n };
        const pmesh_allocator a = lods_budget_allocator(&budget);
        pmesh_session *s;
        CHECK(n < 100);
        if (pmesh_session_create(&s, &shape->input, &a) == PMESH_OK) {
            done = pmesh_session_move(s, 60) == PMESH_OK;
            done &= pmesh_session_weigh(s, some, 3, 0.7) == PMESH_OK;
            done &= pmesh_session_constrain(s, PMESH_PLANE, some, 3, 1) ==
                    PMESH_OK;
            done &= pmesh_session_move(s, 128) == PMESH_OK;
            done &= pmesh_session_move(s, 30) == PMESH_OK;
            done &= pmesh_session_cut(s, thresholds, vertex_of, NULL,
                                      &forced) == PMESH_OK;
            CHECK(pmesh_session_faces(s) >= 4);
            budget.left = 100;
            CHECK(pmesh_session_move(s, 128) == PMESH_OK);
            CHECK(pmesh_session_faces(s) == 128);
            CHECK(pmesh_session_move(s, 30) == PMESH_OK);
            CHECK(pmesh_session_faces(s) == 30);
            pmesh_session_destroy(s);
        }
        CHECK(budget.bytes == 0);
    }
    CHECK(n > 15);
    shape_free(shape);
}
