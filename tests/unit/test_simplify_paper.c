/* SPDX-License-Identifier: MIT */
/*
 * Pictures and remarks of Garland and Heckbert's papers that a simplifier can
 * be held to.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "encoder/enc_lod_guard.h"
#include "encoder/enc_lod_place.h"
#include "format/alloc.h"
#include "tests/unit/lods.h"
#include "tests/unit/test.h"

static uint32_t next_random(uint32_t *seed, uint32_t below)
{
    *seed = *seed * 1664525 + 1013904223;
    return (uint32_t)(((uint64_t)*seed * below) >> 32);
}

/* Contracts edges at random to anywhere within an edge length of the middle, if
 * nothing turns over, to half the faces; the result replaces l->out's. */
static void contract_at_random(lods *l)
{
    const uint32_t n = (uint32_t)l->in.vertex_count;
    const uint32_t faces = (uint32_t)l->in.face_count;
    const pmesh_allocator a = pmesh_allocator_resolve(l->options.allocator);
    uint32_t *same = malloc(n * sizeof *same), seed = 1;
    enc_lod lod;

    for (uint32_t v = 0; v < n; v++)
        same[v] = v;
    CHECK(enc_lod_create(&a, l->tri, faces, NULL, n, same, same,
                         (const double(*)[3])l->xyz, &lod) == PMESH_OK);
    CHECK(enc_lod_add_pairs(&lod, NULL, 0) == PMESH_OK);
    for (uint32_t tries = 0; tries < 100000 && lod.faces > faces / 2; tries++) {
        const uint32_t pair = next_random(&seed, lod.pair_count);
        const uint32_t u = lod.end_vertex[2 * pair];
        const uint32_t v = lod.end_vertex[2 * pair + 1];
        double place[3], length = 0;
        if (u == ENC_NONE)
            continue;
        for (int i = 0; i < 3; i++)
            length += pow(lod.position[u][i] - lod.position[v][i], 2);
        for (int i = 0; i < 3; i++) {
            const double t = next_random(&seed, 2001) / 1000.0 - 1;
            place[i] = 0.5 * (lod.position[u][i] + lod.position[v][i]) +
                       t * sqrt(length / 3);
        }
        if (!enc_lod_can_join(&lod, u, v, ENC_LOD_TOPOLOGY) ||
            enc_lod_flips(&lod, u, v, place))
            continue;
        memcpy(lod.position[v], place, sizeof place);
        enc_lod_contract(&lod, pair, u, v);
    }
    l->out.face_count = 0;
    for (uint32_t f = 0; f < faces; f++) {
        if (lod.corner_vertex[3 * f] == ENC_NONE)
            continue;
        memcpy(&l->out.indices[3 * l->out.face_count++],
               &lod.corner_vertex[3 * f], 3 * sizeof *l->out.indices);
    }
    memcpy(l->out.positions, lod.position, n * sizeof *lod.position);
    enc_lod_destroy(&lod);
    free(same);
}

TEST(bad_places_ruin_the_shape_that_optimal_ones_keep)
{
    lods *l = lods_sphere(24);

    l->options.faces = l->in.face_count / 2;
    CHECK(lods_run(l) == PMESH_OK);
    const double optimal = lods_sphere_rms(l);
    contract_at_random(l);
    CHECK(l->out.face_count <= l->in.face_count / 2);
    CHECK(lods_sphere_rms(l) >= 5 * optimal);
    lods_free(l);
}

/* ---- contours of a pair's quadric ---------------------------------------- */

enum { SIDE = 65, BANDS = 12 };

/* The quadric of two vertices that four lines cut in a plane, as extruded
 * walls: its contours are ellipses. */
static enc_quadric pair_quadric(void)
{
    static const double walls[4][3] = {
        { 0.2, 1, 0 }, { -0.4, 1, 0 }, { 0.6, 1, 0 }, { -0.1, 1, 0 }
    };
    const double ends[2][3] = { { -0.5, 0.1, 0 }, { 0.5, -0.1, 0 } };
    const double up[3] = { 0, 0, 1 };
    enc_quadric sum = { .c = 0 };

    for (int v = 0; v < 2; v++) {
        enc_quadric q = { .c = 0 };
        enc_quadric_add_plane(&q, walls[2 * v], 1);
        enc_quadric_add_plane(&q, walls[2 * v + 1], 1);
        enc_quadric_add_plane(&q, up, 1);
        enc_quadric_add(&sum, &q, ends[v]);
    }
    return sum;
}

/* Which band between two contours each pixel is in; equal steps of the root. */
static void draw_bands(const enc_quadric *q, const double about[3],
                       uint8_t band[SIDE][SIDE])
{
    const double least = enc_quadric_value(q, about);

    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++) {
            const double at[3] = { about[0] + (x - SIDE / 2) / 32.0,
                                   about[1] - (y - SIDE / 2) / 32.0, 0 };
            const double root = sqrt(enc_quadric_value(q, at) - least + 1e-12);
            band[y][x] = (uint8_t)fmin(BANDS - 1, root * 8);
        }
}

/* A picture for the eye: PMESH_CONTOURS names the file, PGM. */
static void show(uint8_t band[SIDE][SIDE])
{
    const char *name = getenv("PMESH_CONTOURS");
    FILE *file = name ? fopen(name, "wb") : NULL;

    if (!file)
        return;
    fprintf(file, "P5 %d %d %d\n", SIDE, SIDE, BANDS - 1);
    fwrite(band, 1, (size_t)SIDE * SIDE, file);
    fclose(file);
}

TEST(contours_of_a_pair_are_ellipses_around_its_place)
{
    const enc_quadric q = pair_quadric();
    const double half[3] = { 0.5, -0.1, 0 };
    uint8_t band[SIDE][SIDE];
    double place[3];

    enc_lod_place(PMESH_PLACE_OPTIMAL, &q, half, NULL, place);
    draw_bands(&q, place, band);
    show(band);
    /* The middle is in the innermost band; outwards no band comes again; and
     * opposite pixels are in the same one. */
    const int middle = SIDE / 2;
    CHECK(band[middle][middle] == 0);
    CHECK(band[0][middle] > 3);
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++) {
            const int in_y = y + (y < middle) - (y > middle);
            const int in_x = x + (x < middle) - (x > middle);
            CHECK(abs(band[y][x] - band[SIDE - 1 - y][SIDE - 1 - x]) <= 1);
            if (x == middle)
                CHECK(band[in_y][x] <= band[y][x]);
            if (y == middle)
                CHECK(band[y][in_x] <= band[y][x]);
        }
    /* Longer along the walls than across. */
    CHECK(band[middle][0] < band[0][middle]);
}
