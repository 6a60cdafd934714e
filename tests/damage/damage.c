/* SPDX-License-Identifier: MIT */
/*
 * damage FLIPS EDITS FILE... - gives the decoder every prefix of each file, the
 * file with every bit flipped, one at a time (of a file with more than FLIPS
 * bits so many, evenly spread; 0: all), and EDITS times otherwise: words of it
 * are extreme, bytes missing, added, or from elsewhere in it. Promised, and
 * counted:
 *
 *   a flipped bit and an edit are noticed; a prefix asks for more
 *   what is shown then is what the good file shows at as many vertices (levels
 *   of scattered faces have many states of as many faces), no more of it than
 *   before the damage, and never fewer faces for a longer prefix
 *
 * Prints a line per file and the sums; fails if a promise was broken.
 */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "decoder/pmesh_decode.h"
#include "decoder/pmesh_scene.h"
#include "tests/unit/shapes.h"

typedef struct tally {
    uint64_t bytes, prefixes, shown, flips, noticed, still_shown;
    uint64_t edits, edits_noticed, wrong;
    uint64_t first; /* the shortest prefix that shows a mesh */
} tally;

/* A good file, and a hash of what it shows at each number of mesh vertices. */
typedef struct good {
    const char *name;
    uint8_t *data;
    size_t size;
    uint64_t *hash; /* 0: never shown */
    uint32_t vertices;
} good;

static void complain(const good *g, tally *t, const char *what, uint64_t where)
{
    if (t->wrong++ < 5)
        fprintf(stderr, "%s: %s at %" PRIu64 "\n", g->name, what, where);
}

/* ---- single meshes ------------------------------------------------------ */

/* What is shown, refined as far as it goes; without faces: nothing. */
static pmesh_view show(pmesh_decoder *dec)
{
    pmesh_view v;
    if (pmesh_decoder_refine(dec, NULL, NULL) != PMESH_OK ||
        pmesh_decoder_mesh(dec, &v) != PMESH_OK || !shape_view_sound(dec))
        v = (pmesh_view){ 0 };
    return v;
}

/* Walks up from the base mesh, a split at a time. */
static bool look_at_states(good *g)
{
    pmesh_status status;
    pmesh_decoder *dec = shape_decode(g->data, g->size, g->size, &status);
    pmesh_view v = show(dec);
    const pmesh_target base = { .faces = 1 }, next = { .max_ops = 1 };
    bool fine = status == PMESH_OK && v.face_count > 0;
    g->vertices = v.mesh_vertex_count;
    g->hash = calloc((size_t)g->vertices + 1, sizeof *g->hash);
    fine = fine && g->hash && pmesh_decoder_refine(dec, &base, NULL) == PMESH_OK;
    for (uint32_t n = 0; fine && n < g->vertices; n = v.mesh_vertex_count) {
        fine = pmesh_decoder_mesh(dec, &v) == PMESH_OK &&
               (n == 0 || v.mesh_vertex_count == n + 1);
        g->hash[v.mesh_vertex_count] = shape_view_hash(dec);
        pmesh_decoder_refine(dec, &next, NULL);
    }
    pmesh_decoder_destroy(dec);
    return fine;
}

/* As if the file ended behind `size` bytes. Returns the faces that are shown. */
static uint32_t try_mesh(const good *g, size_t size, tally *t, uint64_t where,
                         const char *what)
{
    pmesh_status status;
    pmesh_decoder *dec = shape_decode(g->data, size, size, &status);
    const pmesh_view v = show(dec);
    if (status == PMESH_OK)
        complain(g, t, what, where);
    if (v.face_count > 0 && (v.mesh_vertex_count > g->vertices ||
                             g->hash[v.mesh_vertex_count] !=
                                 shape_view_hash(dec)))
        complain(g, t, "a mesh that the file does not hold", where);
    pmesh_decoder_destroy(dec);
    return v.face_count;
}

static void cut_everywhere(const good *g, tally *t)
{
    uint32_t last = 0;
    for (size_t size = 0; size < g->size; size++) {
        const uint32_t faces =
            try_mesh(g, size, t, size, "a prefix that passes as whole");
        if (faces < last)
            complain(g, t, "fewer faces than before", size);
        if (faces > 0 && last == 0)
            t->first = size;
        t->shown += faces > 0;
        last = faces;
        t->prefixes++;
    }
}

/* ---- scenes ------------------------------------------------------------- */

static pmesh_status feed_scene(const good *g, size_t size)
{
    pmesh_scene *scene;
    uint8_t *copy = malloc(size + !size); /* exact: ASan sees its end */
    pmesh_status status = pmesh_scene_create(&scene, NULL);
    if (status == PMESH_OK && copy) {
        memcpy(copy, g->data, size);
        status = pmesh_scene_feed(scene, copy, size);
        pmesh_scene_refine(scene, NULL, NULL);
        pmesh_scene_destroy(scene);
    }
    free(copy);
    return status;
}

static uint32_t try_scene(const good *g, size_t size, tally *t, uint64_t where,
                          const char *what)
{
    if (feed_scene(g, size) == PMESH_OK)
        complain(g, t, what, where);
    return 0;
}

/* ---- files -------------------------------------------------------------- */

static bool is_scene(const good *g)
{
    return pmesh_scene_probe(g->data, g->size) == PMESH_OK;
}

static void flip_everywhere(const good *g, tally *t, uint64_t most)
{
    const uint64_t bits = 8 * (uint64_t)g->size;
    const uint64_t step = most > 0 && bits > most ? bits / most + 1 : 1;
    const bool scene = is_scene(g);
    for (uint64_t bit = 0; bit < bits; bit += step) {
        const uint64_t wrong = t->wrong;
        uint8_t *byte = &g->data[bit / 8];
        *byte ^= (uint8_t)(1u << bit % 8);
        const uint32_t faces =
            (scene ? try_scene : try_mesh)(g, g->size, t, bit,
                                           "a flipped bit that passes");
        *byte ^= (uint8_t)(1u << bit % 8);
        t->still_shown += faces > 0;
        t->noticed += t->wrong == wrong;
        t->flips++;
    }
}

/* ---- edits --------------------------------------------------------------- */

enum { MOST_ADDED = 64 };

static uint32_t draw(uint64_t *seed, size_t below)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)((*seed >> 33) % below);
}

/* Where something is done: every other time where headers are. */
static size_t draw_place(uint64_t *seed, size_t size)
{
    const size_t near = size < 200 ? size : 200;
    return draw(seed, draw(seed, 2) ? near : size);
}

static size_t put_word(uint64_t *seed, uint8_t *data, size_t size)
{
    static const uint32_t words[] = { 0, 1, 0x7f, 0x80, 0xff, 0xffff, 0x10000,
                                      0x7fffffff, 0x80000000, 0xfffffffe,
                                      0xffffffff };
    const uint32_t word = words[draw(seed, sizeof words / sizeof *words)];
    const size_t at = draw_place(seed, size);
    for (size_t i = 0; i < 4 && at + i < size; i++)
        data[at + i] = (uint8_t)(word >> 8 * i);
    return size;
}

static size_t remove_bytes(uint64_t *seed, uint8_t *data, size_t size)
{
    const size_t at = draw_place(seed, size);
    const size_t left = size - at;
    const size_t n = 1 + draw(seed, left < 64 ? left : 64);
    memmove(data + at, data + at + n, left - n);
    return size - n;
}

static size_t add_bytes(uint64_t *seed, uint8_t *data, size_t size)
{
    const size_t at = draw(seed, 4) ? draw_place(seed, size) : size;
    const size_t n = 1 + draw(seed, MOST_ADDED);
    const bool noise = draw(seed, 2);
    memmove(data + at + n, data + at, size - at);
    for (size_t i = 0; i < n; i++)
        data[at + i] = noise ? (uint8_t)draw(seed, 256) : 0;
    return size + n;
}

static size_t splice_bytes(uint64_t *seed, uint8_t *data, size_t size)
{
    const size_t from = draw(seed, size), to = draw(seed, size);
    const size_t room = size - (from > to ? from : to);
    memmove(data + to, data + from, 1 + draw(seed, room));
    return size;
}

static void edit(const good *g, tally *t, uint64_t times)
{
    static size_t (*const kinds[])(uint64_t *, uint8_t *, size_t) = {
        put_word, remove_bytes, add_bytes, splice_bytes
    };
    const bool scene = is_scene(g);
    uint64_t seed = g->size;
    good bad = *g;
    bad.data = malloc(g->size + MOST_ADDED);
    while (bad.data && t->edits < times) {
        const uint64_t wrong = t->wrong;
        memcpy(bad.data, g->data, g->size);
        bad.size = kinds[draw(&seed, 4)](&seed, bad.data, g->size);
        if (bad.size >= g->size && memcmp(bad.data, g->data, g->size) == 0)
            continue; /* what follows a file is ignored (SPEC 5.2) */
        (scene ? try_scene : try_mesh)(&bad, bad.size, t, t->edits,
                                       "an edit that passes");
        t->edits_noticed += t->wrong == wrong;
        t->edits++;
    }
    free(bad.data);
}

static void cut_scene(const good *g, tally *t)
{
    const size_t step = g->size / 2000 + 1; /* scenes are large */
    for (size_t size = 0; size < g->size; size += step) {
        try_scene(g, size, t, size, "a prefix that passes as whole");
        t->prefixes++;
    }
}

static bool read_file(const char *path, good *g)
{
    FILE *in = fopen(path, "rb");
    const size_t room = 1 << 24;
    *g = (good){ .name = path, .data = malloc(room) };
    if (!in || !g->data)
        return false;
    g->size = fread(g->data, 1, room, in);
    fclose(in);
    return g->size > 0 && (is_scene(g) ? feed_scene(g, g->size) == PMESH_OK
                                       : look_at_states(g));
}

static void print(const char *name, const tally *t)
{
    printf("%s: %" PRIu64 " bytes; %" PRIu64 " prefixes, %" PRIu64
           " show a mesh, from byte %" PRIu64 " on; %" PRIu64
           " bits flipped, %" PRIu64 " noticed, %" PRIu64
           " still show a coarser mesh; %" PRIu64 " edits, %" PRIu64
           " noticed; %" PRIu64 " promises broken\n",
           name, t->bytes, t->prefixes, t->shown, t->first, t->flips,
           t->noticed, t->still_shown, t->edits, t->edits_noticed, t->wrong);
}

static void add(tally *sum, const tally *t)
{
    sum->bytes += t->bytes;
    sum->prefixes += t->prefixes;
    sum->shown += t->shown;
    sum->flips += t->flips;
    sum->noticed += t->noticed;
    sum->still_shown += t->still_shown;
    sum->edits += t->edits;
    sum->edits_noticed += t->edits_noticed;
    sum->wrong += t->wrong;
    sum->first = sum->first > t->first ? sum->first : t->first;
}

int main(int argc, char **argv)
{
    tally sum = { 0 };
    if (argc < 4) {
        fprintf(stderr, "usage: damage FLIPS EDITS FILE...\n");
        return 2;
    }
    for (int i = 3; i < argc; i++) {
        good g;
        tally t = { 0 };
        if (!read_file(argv[i], &g)) {
            fprintf(stderr, "%s: is no good file\n", argv[i]);
            return 2;
        }
        t.bytes = g.size;
        if (is_scene(&g))
            cut_scene(&g, &t);
        else
            cut_everywhere(&g, &t);
        flip_everywhere(&g, &t, strtoull(argv[1], NULL, 10));
        edit(&g, &t, strtoull(argv[2], NULL, 10));
        print(argv[i], &t);
        add(&sum, &t);
        free(g.data);
        free(g.hash);
    }
    print("all", &sum);
    return sum.wrong > 0;
}
