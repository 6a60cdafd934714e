/* SPDX-License-Identifier: MIT */
/*
 * What holds before, during and after single contractions: rings, pairs and
 * quadrics of the mesh behind pmesh_simplify_mesh().
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "encoder/enc_lod_guard.h"
#include "encoder/enc_lod_import.h"
#include "format/alloc.h"
#include "tests/unit/lods.h"
#include "tests/unit/shapes.h"
#include "tests/unit/test.h"

static const pmesh_allocator plain; /* malloc and free */

static enc_lod open_lod(const lods *l, const uint32_t (*more)[2],
                        uint32_t more_count)
{
    const uint32_t n = (uint32_t)l->in.vertex_count;
    const pmesh_allocator a = pmesh_allocator_resolve(plain);
    uint32_t *same = malloc(n * sizeof *same);
    enc_lod lod;

    for (uint32_t v = 0; v < n; v++)
        same[v] = v;
    CHECK(enc_lod_create(&a, l->tri, (uint32_t)l->in.face_count, NULL, n, same,
                         same, (const double (*)[3])l->xyz, &lod) == PMESH_OK);
    CHECK(enc_lod_add_pairs(&lod, more, more_count) == PMESH_OK);
    free(same);
    return lod;
}

static lods *some_mesh(uint32_t i)
{
    switch (i % 4) {
    case 0:
        return lods_sphere(4 + i);
    case 1:
        return lods_terrain(3 + i); /* with a boundary */
    case 2:
        return lods_tetrahedra(i);
    default:
        return lods_soup(20 + 10 * i, 10 + i, i); /* anything */
    }
}

/* ---- rings --------------------------------------------------------------- */

/* The corners and neighbours of v by its rings are those by a scan of all. */
static void check_ring(const enc_lod *lod, uint32_t v)
{
    bool *near = calloc(lod->vertex_count, sizeof *near);
    uint32_t scanned = 0, walked = 0;

    for (uint32_t c = 0; c < 3 * lod->face_count; c++) {
        if (lod->corner_vertex[c] != v)
            continue;
        scanned++;
        near[lod->corner_vertex[enc_lod_after(c)]] = true;
        near[lod->corner_vertex[enc_lod_before(c)]] = true;
    }
    uint32_t c = lod->first_corner[v];
    CHECK((c == ENC_NONE) == (scanned == 0));
    if (c == ENC_NONE) {
        free(near);
        return;
    }
    do {
        CHECK(lod->corner_vertex[c] == v);
        walked++;
    } while ((c = lod->corner_next[c]) != lod->first_corner[v]);
    CHECK(walked == scanned);

    /* Each neighbour has one pair with v, and nobody else has. */
    uint32_t end = lod->first_end[v];
    CHECK(end != ENC_NONE);
    do {
        CHECK(lod->end_vertex[end] == v);
        CHECK(near[lod->end_vertex[end ^ 1]]);
        near[lod->end_vertex[end ^ 1]] = false;
    } while ((end = lod->end_next[end]) != lod->first_end[v]);
    for (uint32_t w = 0; w < lod->vertex_count; w++)
        CHECK(!near[w]);
    free(near);
}

TEST(simplify_rings_are_what_a_scan_of_all_faces_finds)
{
    for (uint32_t i = 1; i <= 20; i++) {
        lods *l = some_mesh(i);
        enc_lod lod = open_lod(l, NULL, 0);
        for (uint32_t v = 0; v < lod.vertex_count; v++)
            check_ring(&lod, v);
        enc_lod_destroy(&lod);
        lods_free(l);
    }
}

/* ---- pairs --------------------------------------------------------------- */

/* Marks the partners of v; true if none of them was marked already. */
static bool mark_partners(const enc_lod *lod, uint32_t v, bool *mark)
{
    uint32_t end = lod->first_end[v];
    bool fresh = true;

    if (end == ENC_NONE)
        return true;
    do {
        const uint32_t w = lod->end_vertex[end ^ 1];
        fresh = fresh && !mark[w];
        mark[w] = true;
    } while ((end = lod->end_next[end]) != lod->first_end[v]);
    return fresh;
}

/* Contracts a pair; the pairs of the vertex that stays are the union of both
 * sets, without itself, and none is there twice. */
static void contract_and_check(enc_lod *lod, uint32_t pair)
{
    const uint32_t gone = lod->end_vertex[2 * pair];
    const uint32_t kept = lod->end_vertex[2 * pair + 1];
    const size_t n = lod->vertex_count;
    const uint32_t vertices = lod->vertices;
    bool *want = calloc(n, sizeof *want), *got = calloc(n, sizeof *got);

    mark_partners(lod, gone, want);
    mark_partners(lod, kept, want);
    want[gone] = want[kept] = false;
    enc_lod_contract(lod, pair, gone, kept);
    CHECK(lod->vertices == vertices - 1);
    CHECK(mark_partners(lod, kept, got));
    CHECK(memcmp(want, got, n * sizeof *want) == 0);
    CHECK(lod->first_end[gone] == ENC_NONE);
    for (uint32_t v = 0; v < n; v++) { /* and so everywhere */
        memset(got, 0, n * sizeof *got);
        CHECK(mark_partners(lod, v, got) && !got[v] && !got[gone]);
    }
    free(want);
    free(got);
}

TEST(simplify_pairs_of_what_two_become_are_the_union_of_theirs)
{
    /* Besides the edges: poles and others far apart. */
    static const uint32_t more[][2] = { { 0, 30 }, { 5, 40 }, { 12, 77 },
                                        { 3, 60 }, { 5, 60 }, { 30, 77 } };
    uint32_t seed = 4, contractions = 0;
    lods *l = lods_sphere(8);
    enc_lod lod = open_lod(l, more, sizeof more / sizeof *more);

    for (uint32_t tries = 0; tries < 4000; tries++) {
        const uint32_t pair = shape_random(&seed, lod.pair_count);
        if (lod.end_vertex[2 * pair] == ENC_NONE ||
            !enc_lod_can_join(&lod, lod.end_vertex[2 * pair],
                              lod.end_vertex[2 * pair + 1], ENC_LOD_TOPOLOGY))
            continue;
        contract_and_check(&lod, pair);
        contractions++;
    }
    CHECK(contractions > 80);
    enc_lod_destroy(&lod);
    lods_free(l);
}

/* ---- quadrics ------------------------------------------------------------ */

TEST(simplify_error_of_every_vertex_is_zero_before_the_first_contraction)
{
    const double here[3] = { 0, 0, 0 };
    const pmesh_allocator a = pmesh_allocator_resolve(plain);

    for (uint32_t i = 1; i <= 20; i++) {
        lods *l = some_mesh(i);
        enc_lod_channels channels;
        enc_lod_frame frame;
        enc_lod_pricer pricer;
        enc_lod lod;
        double *value;
        for (size_t k = 0; k < 3 * l->in.vertex_count; k++)
            l->xyz[k] = 1e5 + 1e3 * l->xyz[k]; /* of any size, anywhere */
        CHECK(enc_lod_import(&a, &l->in, 0, 0, false, &channels, &frame, &lod,
                             &value) == PMESH_OK);
        CHECK(enc_lod_pricer_create(&lod, &l->options, &frame,
                                    PMESH_PLACE_OPTIMAL, &channels, value,
                                    &pricer) == PMESH_OK);
        for (uint32_t v = 0; v < lod.vertex_count; v++) {
            if (lod.first_corner[v] == ENC_NONE)
                continue;
            enc_lod_renew(&pricer.wedges, v);
            enc_lod_pricer_remember(&pricer, v);
            CHECK(enc_quadric_value(&pricer.wedges.quadric[lod.lone[v]],
                                    here) == 0);
            CHECK(enc_quadric_value(&pricer.memory[v], here) == 0);
        }
        enc_lod_pricer_destroy(&pricer);
        enc_lod_destroy(&lod);
        lods_free(l);
    }
}

/* Squared distances of p to the planes of a set of faces: each once. */
static double by_planes(const enc_lod *lod, const bool *faces,
                        const double p[3])
{
    double sum = 0;

    for (uint32_t f = 0; f < lod->face_count; f++) {
        double n[3];
        if (!faces[f])
            continue;
        const double *at = lod->position[lod->corner_vertex[3 * f]];
        enc_lod_normal(lod, 3 * f, at, n);
        double rise = 0, square = 0;
        for (int i = 0; i < 3; i++) {
            rise += n[i] * (p[i] - at[i]);
            square += n[i] * n[i];
        }
        sum += rise * rise / square;
    }
    return sum;
}

/*
 * Sums of quadrics count a plane once for each of its corners that has gone
 * into the vertex: up to three times, where a set would have it once. That is
 * accepted, and this measures it: near random connected regions of 4 to 12
 * vertices the sum is 1.1 to 2.2 times the value of the set.
 */
TEST(quadric_sums_count_shared_planes_up_to_three_times)
{
    lods *l = lods_sphere(6);
    enc_lod lod = open_lod(l, NULL, 0);
    const size_t n = lod.vertex_count;
    bool *faces = malloc(lod.face_count * sizeof *faces);
    bool *inside = malloc(n * sizeof *inside);
    uint32_t seed = 8;
    double low = HUGE_VAL, high = 0;

    for (int trial = 0; trial < 200; trial++) {
        uint32_t v = shape_random(&seed, (uint32_t)n), count = 0;
        enc_quadric sum = { .c = 0 };
        double p[3];
        memset(faces, 0, lod.face_count * sizeof *faces);
        memset(inside, 0, n * sizeof *inside);
        for (int i = 0; i < 3; i++)
            p[i] = 1.2 * l->xyz[3 * v + (size_t)i];
        for (int step = 0; step < 12; step++) { /* a walk over edges */
            uint32_t c = lod.first_corner[v];
            if (!inside[v]) {
                inside[v] = true;
                count++;
                do {
                    const double away[3] = { lod.position[v][0] - p[0],
                                             lod.position[v][1] - p[1],
                                             lod.position[v][2] - p[2] };
                    enc_quadric plane = { .c = 0 };
                    double normal[3];
                    enc_lod_normal(&lod, c, lod.position[v], normal);
                    enc_quadric_add_plane(&plane, normal, 1);
                    enc_quadric_add(&sum, &plane, away);
                    faces[c / 3] = true;
                } while ((c = lod.corner_next[c]) != lod.first_corner[v]);
            }
            for (uint32_t k = shape_random(&seed, 5); k > 0; k--)
                c = lod.corner_next[c];
            v = lod.corner_vertex[enc_lod_after(c)];
        }
        const double here[3] = { 0, 0, 0 };
        const double ratio =
            enc_quadric_value(&sum, here) / by_planes(&lod, faces, p);
        CHECK(ratio > 1 - 1e-9 && ratio < 3 + 1e-9);
        if (count >= 4) {
            low = fmin(low, ratio);
            high = fmax(high, ratio);
        }
    }
    CHECK(low > 1.05 && high > 1.5 && high < 2.5);
    free(faces);
    free(inside);
    enc_lod_destroy(&lod);
    lods_free(l);
}
