/* SPDX-License-Identifier: MIT */
/*
 * agree FILES MENDED DAMAGED GOLDEN... - compares the decoder of this directory
 * with the library's: on the golden files, on as many random FILES and half as
 * many that no encoder makes, and on MENDED and DAMAGED mutations (with and
 * without good checksums).
 * Prints what was met, and each difference with the seed that makes it.
 */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/reference/author.h"
#include "tests/reference/compare.h"
#include "tests/reference/mutate.h"
#include "tests/reference/random_mesh.h"
#include "tests/reference/ref_seen.h"

typedef struct tally {
    uint64_t files, bytes, accepted, incomplete, rejected, too_large,
        other_reason, views, different;
} tally;

/* Which rules the files of all kinds broke, by the reference's words. */
enum { RULES = 100 };
static struct {
    const char *rule;
    uint64_t files;
} broken[RULES];

static void note_rule(const char *rule)
{
    int i = 0;
    while (i < RULES - 1 && broken[i].rule && strcmp(broken[i].rule, rule))
        i++;
    broken[i].rule = rule;
    broken[i].files++;
}

static int by_rule(const void *a, const void *b)
{
    const char *const *x = a, *const *y = b;
    return strcmp(*x, *y);
}

static void print_rules(bool all)
{
    size_t count = 0;
    while (count < RULES && broken[count].rule)
        count++;
    qsort(broken, count, sizeof *broken, by_rule);
    for (size_t i = 0; all && i < count; i++)
        printf("  %8" PRIu64 "  %s\n", broken[i].files, broken[i].rule);
    printf("  rules that were broken: %zu\n", count);
}

static void note(tally *t, const char *what, uint32_t seed, size_t size,
                 const comparison *c)
{
    if (*c->rule)
        note_rule(c->rule);
    t->files++;
    t->bytes += size;
    t->views += c->views;
    t->too_large += c->too_large;
    t->accepted += c->accepted;
    t->incomplete += c->readable && !c->accepted;
    t->rejected += !c->readable && !c->too_large;
    t->other_reason += c->other_reason;
    t->different += c->difference != NULL;
    if (c->difference && t->different <= 10)
        printf("  %s %" PRIu32 ": %s (%" PRIu32 " faces; \"%s\" / \"%s\")\n",
               what, seed, c->difference, c->faces, c->rule,
               c->library_rule);
}

static void print_tally(const char *what, const tally *t)
{
    printf("  %s: %" PRIu64 " files, %" PRIu64 " bytes: %" PRIu64
           " accepted, %" PRIu64 " incomplete, %" PRIu64 " rejected, %" PRIu64
           " too large, %" PRIu64 " for another reason; %" PRIu64
           " views; %" PRIu64 " differ\n",
           what, t->files, t->bytes, t->accepted, t->incomplete, t->rejected,
           t->too_large, t->other_reason, t->views, t->different);
}

static bool read_file(const char *path, shape_bytes *out)
{
    FILE *in = fopen(path, "rb");
    *out = (shape_bytes){ .capacity = 1 << 26 };
    if (!in)
        return false;
    out->data = malloc(out->capacity);
    out->size = out->data ? fread(out->data, 1, out->capacity, in) : 0;
    fclose(in);
    return out->size > 0;
}

/* A golden file at times, a random one else. */
static bool pick(uint32_t seed, char **golden, int count, shape_bytes *out)
{
    if (count > 0 && seed % 8 == 0)
        return read_file(golden[seed / 8 % (uint32_t)count], out);
    return random_file(seed, out) == PMESH_OK;
}

static void compare_golden(tally *t, char **golden, int count)
{
    for (int i = 0; i < count; i++) {
        shape_bytes file;
        comparison c = { .difference = "cannot be read" };
        if (read_file(golden[i], &file))
            c = compare_decoders(file.data, file.size, (uint32_t)i);
        if (!c.difference && !c.accepted)
            c.difference = "rejected";
        note(t, golden[i], (uint32_t)i, file.size, &c);
        free(file.data);
    }
}

/* And a prefix of each, which must be as good as far as it goes. */
static void compare_random(tally *t, tally *prefixes, uint32_t files)
{
    for (uint32_t seed = 1; t->files < files; seed++) {
        shape_bytes file;
        uint32_t cut = seed;
        if (random_file(seed, &file) != PMESH_OK) {
            free(file.data);
            continue;
        }
        comparison c = compare_decoders(file.data, file.size, seed);
        if (!c.difference && !c.accepted)
            c.difference = "rejected";
        note(t, "random", seed, file.size, &c);
        if (seed % 4 == 0) {
            const size_t size = shape_random(&cut, (uint32_t)file.size);
            c = compare_decoders(file.data, size, seed);
            note(prefixes, "prefix", seed, size, &c);
        }
        free(file.data);
    }
}

/* Half as many as there are random files. */
static void compare_authored(tally *t, uint32_t files)
{
    for (uint32_t seed = 1; t->files < files; seed++) {
        shape_bytes file;
        if (author_random_file(seed, &file)) {
            const comparison c = compare_decoders(file.data, file.size, seed);
            note(t, "authored", seed, file.size, &c);
        }
        free(file.data);
    }
}

/* Every cut of a ring as large as one may be, or some. */
static void compare_wide(tally *t, uint32_t ring, bool textured,
                         uint32_t step)
{
    for (uint32_t rank = 0; rank < ring * (ring - 1); rank += step) {
        shape_bytes file;
        comparison c = { .difference = "there is no such cut" };
        if (author_wide_split(ring, textured, rank, &file) > 0)
            c = compare_decoders(file.data, file.size, rank);
        if (!c.difference && !c.accepted)
            c.difference = "rejected";
        note(t, textured ? "wide, textured" : "wide", rank, file.size, &c);
        free(file.data);
    }
}

static void compare_mutations(tally *t, uint32_t files, bool mend,
                              char **golden, int count)
{
    for (uint32_t seed = 1; t->files < files; seed++) {
        shape_bytes file;
        if (pick(seed, golden, count, &file)) {
            const shape_bytes bad = mutate(&file, mend, seed);
            const comparison c = compare_decoders(bad.data, bad.size, seed);
            note(t, mend ? "mended" : "damaged", seed, bad.size, &c);
            free(bad.data);
        }
        free(file.data);
    }
}

int main(int argc, char **argv)
{
    tally golden = { 0 }, random = { 0 }, prefixes = { 0 }, authored = { 0 },
          wide = { 0 }, mended = { 0 }, damaged = { 0 };
    if (argc < 4) {
        fprintf(stderr, "usage: agree FILES MENDED DAMAGED GOLDEN...\n");
        return 2;
    }
    compare_golden(&golden, argv + 4, argc - 4);
    const uint32_t files = (uint32_t)strtoul(argv[1], NULL, 10);
    compare_random(&random, &prefixes, files);
    compare_wide(&wide, 48, false, files < 10000 ? 45 : 1);
    compare_wide(&wide, 48, true, files < 10000 ? 45 : 1);
    ref_seen_print(files >= 10000);
    compare_authored(&authored, files / 2);
    compare_mutations(&mended, (uint32_t)strtoul(argv[2], NULL, 10), true,
                      argv + 4, argc - 4);
    compare_mutations(&damaged, (uint32_t)strtoul(argv[3], NULL, 10), false,
                      argv + 4, argc - 4);
    print_rules(files >= 10000);
    print_tally("golden", &golden);
    print_tally("random", &random);
    print_tally("prefixes", &prefixes);
    print_tally("wide rings", &wide);
    print_tally("authored", &authored);
    print_tally("mutations, mended", &mended);
    print_tally("mutations, damaged", &damaged);
    return golden.different + random.different + prefixes.different +
               wide.different + authored.different + mended.different +
               damaged.different >
           0;
}
