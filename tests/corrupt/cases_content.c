/* SPDX-License-Identifier: MIT */
/* SPEC 6: base meshes, blocks and exact positions in which one decision is
 * wrong. */
#include "tests/corrupt/script.h"

#include <stdlib.h>
#include <string.h>

enum { BASE = 2, LAST = 4, POSITIONS = 7, CHANGES = 5, MORE = 255 };

#define BOUNDS "SPEC 6.2: a base vertex is out of bounds"
#define NO_VERTEX "SPEC 6.2: no such base vertex"
#define TWICE "SPEC 6.2: a base face names a vertex twice"
#define LEAVES "SPEC 6.5: a vertex leaves the bounds"
#define VALUE "SPEC 6.6: an attribute value is out of range"
#define PARENTS "SPEC 6.6: a wedge comes from two wedges of the parent"
#define PLACE "SPEC 6.6: a wedge's place is out of range"
#define NO_WEDGE "SPEC 6.6: the vertex has no such wedge"
#define LONE "SPEC 6.3: no such vertex for a lone face"
#define REACH "SPEC 6.8: a position is out of reach"

typedef struct content_case {
    const char *name;
    base_file base;
    uint8_t type;
    uint8_t splits; /* of the block; 0: as many as it has; MORE: of the last
                       block, one more than the header allows in all */
    const char *rule;
    script script;
    struct {
        const char *field;
        uint64_t value;
    } change[CHANGES]; /* of the header */
} content_case;

/*
 * Base meshes are written from nothing: all vertices lie in the origin, all
 * half-edges are boundaries, unless the script says otherwise. A number n is
 * coded as the digits of n + 1: how many behind the first as ones and a zero,
 * then these.
 *
 *                 2
 *   of a strip:  / \     the first face, then those over its half-edges in
 *               0 - 1    their order; a new vertex is 3
 */
#define ORIGIN { "base.position", 0, "(0)" }

static const content_case bases[] = {
    { "base-vertex-below-0", PLAIN, BASE, 0, BOUNDS,
      { { { "base.position", 0, "100" }, { "base.sign", 0, "1" } }, 0 },
      { { NULL, 0 } } },
    { "base-vertex-above-bounds", PLAIN, BASE, 0, BOUNDS,
      { { { "base.position", 0, "(1)" }, { "base.sign", 0, "0" } }, 0 },
      { { NULL, 0 } } },
    { "base-vertex-later-below-0", PLAIN, BASE, 0, BOUNDS,
      { { { "base.position", 20, "(1)" }, { "base.sign", 12, "(1)" } }, 0 },
      { { NULL, 0 } } },
    { "base-vertex-that-is-not-there", PLAIN, BASE, 0, NO_VERTEX,
      { { ORIGIN, { "base.boundary", 0, "0" }, { "base.known", 0, "1" },
          { "base.neighbour", 0, "1" }, { "base.vertex", 0, "(1)" } }, 0 },
      { { NULL, 0 } } },
    { "base-vertex-one-too-far", PLAIN, BASE, 0, NO_VERTEX, /* 3 of 3 */
      { { ORIGIN, { "base.boundary", 0, "0" }, { "base.known", 0, "1" },
          { "base.neighbour", 0, "1" }, { "base.vertex", 0, "11000" } }, 0 },
      { { NULL, 0 } } },
    { "base-face-with-its-gate-x", PLAIN, BASE, 0, TWICE, /* 1 0 0 */
      { { ORIGIN, { "base.boundary", 0, "0" }, { "base.known", 0, "1" },
          { "base.neighbour", 0, "1" }, { "base.vertex", 0, "101" } }, 0 },
      { { NULL, 0 } } },
    { "base-face-with-its-gate-y", PLAIN, BASE, 0, TWICE, /* 1 0 1 */
      { { ORIGIN, { "base.boundary", 0, "0" }, { "base.known", 0, "1" },
          { "base.neighbour", 0, "1" }, { "base.vertex", 0, "100" } }, 0 },
      { { NULL, 0 } } },
    { "base-edge-twice", PLAIN, BASE, 0, /* 1 0 3, then 2 1 0 */
      "SPEC 6.2: two base faces run along an edge the same way",
      { { ORIGIN, { "base.boundary", 0, "00" }, { "base.known", 0, "01" },
          { "base.neighbour", 0, "0" } }, 0 },
      { { NULL, 0 } } },
    { "base-bow-tie", PLAIN, BASE, 0, /* 1 0 3, 1 3 4, 4 3 2: two fans at 2 */
      "SPEC 6.2: the base mesh is not a manifold",
      { { ORIGIN, { "base.boundary", 0, "011100111(1)" },
          { "base.known", 0, "001" }, { "base.neighbour", 0, "11" },
          { "base.vertex", 0, "101" } }, 0 },
      { { "level.0.vertices", 5 }, { "level.0.faces", 4 } } },
    { "base-one-face-too-many", PLAIN, BASE, 0,
      "SPEC 6.2: more base faces than declared",
      { { ORIGIN, { "base.boundary", 0, "(0)" }, { "base.known", 0, "(0)" } },
        0 },
      { { "level.0.vertices", 5 }, { "level.0.faces", 2 } } },
    { "base-face-too-many-for-its-vertices", PLAIN, BASE, 0,
      "SPEC 6.2: more base vertices than declared",
      { { ORIGIN, { "base.boundary", 0, "(0)" }, { "base.known", 0, "(0)" } },
        0 },
      { { "level.0.vertices", 3 }, { "level.0.faces", 9 } } },
    { "base-fan-of-a-vertex-that-is-not-there", SOUP, BASE, 0, NO_VERTEX,
      { { ORIGIN, { "join.known", 0, "1" }, { "join.back", 0, "(1)" } }, 0 },
      { { NULL, 0 } } },
    { "base-fan-of-a-vertex-one-too-far", SOUP, BASE, 0, NO_VERTEX,
      { { ORIGIN, { "join.known", 0, "1" }, { "join.back", 0, "100" } }, 0 },
      { { NULL, 0 } } },
    { "base-face-of-two-fans-of-a-vertex", SOUP, BASE, 0, TWICE,
      { { ORIGIN, { "base.boundary", 0, "(1)" }, { "join.known", 0, "10000" },
          { "join.back", 0, "0" } }, 0 },
      { { "level.0.vertices", 5 }, { "level.0.faces", 2 },
        { "base_fans", 6 } } },
    { "base-vertex-of-49-fans", SOUP, BASE, 0, /* 49 faces over 0, 1, 2 */
      "SPEC 6.2: a vertex with too many fans",
      { { ORIGIN, { "base.boundary", 0, "(1)" }, { "join.known", 0, "00(1)" },
          { "join.back", 0, "(1011000)" } }, 0 },
      { { "level.0.vertices", 3 }, { "level.0.faces", 49 },
        { "base_fans", 147 } } },
    { "base-material-that-is-not-there", FULL, BASE, 0,
      "SPEC 6.6: no such material",
      { { { "material", 0, "(1)" }, { "pick", 0, "(1)" } }, 0 },
      { { NULL, 0 } } },
    { "base-material-one-too-far", FULL, BASE, 0, "SPEC 6.6: no such material",
      { { { "material", 0, "1" }, { "pick", 0, "11000" } }, 0 },
      { { NULL, 0 } } },
    { "base-place-above-4095", FULL, BASE, 0, PLACE,
      { { { "corner", 1, "(1)" }, { "choice", 0, "(1)" },
          { "pick", 30, "(1)" } }, 0 },
      { { "material_count", 1 } } },
    { "base-value-below-0", FULL, BASE, 0, VALUE,
      { { { "value.zero", 3, "1" }, { "value.sign", 2, "(1)" },
          { "value.unary", 0, "(1)" }, { "value", 6, "(1)" } }, 0 },
      { { NULL, 0 } } },
    { "base-value-above-its-bits", FULL, BASE, 0, VALUE,
      { { { "value.sign", 2, "(0)" }, { "value", 6, "(1)" } }, 0 },
      { { NULL, 0 } } }
};

static const content_case blocks[] = {
    { "block-of-more-splits-than-vertices", PLAIN, LAST, 0,
      "SPEC 6.3: more splits than vertices",
      { { { "flag", 0, "(0)" } }, 0 }, { { NULL, 0 } } },
    { "joined-block-of-more-splits-than-vertices", SOUP, LAST, 0,
      "SPEC 6.3: more splits than vertices",
      { { { "flag", 0, "(0)" } }, 0 }, { { NULL, 0 } } },
    { "child-below-0", PLAIN, LAST, 0, LEAVES,
      { { { "child", 0, "(1)" } }, 0 }, { { NULL, 0 } } },
    { "child-above-bounds", PLAIN, LAST, 0, LEAVES,
      { { { "child.sign", 0, "(0)" }, { "child", 0, "(1)" } }, 0 },
      { { NULL, 0 } } },
    { "last-child-below-0", MOVING, LAST, 0, LEAVES,
      { { { "child", 40, "(1)" } }, 0 }, { { NULL, 0 } } },
    { "parent-below-0", MOVING, LAST, 0, LEAVES,
      { { { "parent", 0, "(1)" } }, 0 }, { { NULL, 0 } } },
    { "parent-above-bounds", MOVING, LAST, 0, LEAVES,
      { { { "parent.sign", 0, "(0)" }, { "parent", 0, "(1)" } }, 0 },
      { { NULL, 0 } } },
    { "material-that-is-not-there", FULL, LAST, 0,
      "SPEC 6.6: no such material",
      { { { "material", 0, "(1)" }, { "pick", 0, "(1)" } }, 0 },
      { { NULL, 0 } } },
    { "place-above-4095", FACETS, LAST, 0, PLACE,
      { { { "ordinary", 0, "(1)" }, { "seam", 0, "(1)" },
          { "choice", 0, "(1)" }, { "pick", 0, "(1)" } }, 0 },
      { { NULL, 0 } } },
    { "place-without-wedge", FACETS, LAST, 0, NO_WEDGE,
      { { { "ordinary", 0, "(1)" }, { "seam", 0, "(1)" },
          { "choice", 0, "(1)" }, { "pick", 0, "11011" } }, 0 },
      { { NULL, 0 } } },
    { "wedge-of-two-parents", FACETS, LAST, 0, PARENTS,
      { { { "ordinary", 0, "(0)" } }, 0 }, { { NULL, 0 } } },
    { "wedge-of-two-parents-by-seams", FACETS, LAST, 0, PARENTS,
      { { { "ordinary", 0, "(1)" }, { "seam", 0, "(0)" } }, 0 },
      { { NULL, 0 } } },
    { "value-below-0", MOVING, LAST, 0, VALUE,
      { { { "value", 0, "(1)" } }, 0 }, { { NULL, 0 } } },
    { "value-above-its-bits", MOVING, LAST, 0, VALUE,
      { { { "value.sign", 0, "(0)" }, { "value", 0, "(1)" } }, 0 },
      { { NULL, 0 } } },
    { "fans-that-all-move", SOUP, LAST, 0, "SPEC 6.3: a vertex without faces",
      { { { "flag", 0, "(1)" }, { "join.whole", 0, "(1)" },
          { "join.moves", 0, "(1)" }, { "join.lone", 0, "(0)" } }, 0 },
      { { NULL, 0 } } },
    { "fans-that-all-stay", SOUP, LAST, 0, "SPEC 6.3: a vertex without faces",
      { { { "flag", 0, "(1)" }, { "join.whole", 0, "(1)" },
          { "join.moves", 0, "(0)" }, { "join.lone", 0, "(0)" } }, 0 },
      { { NULL, 0 } } },
    { "lone-face-at-its-own-vertex", SOUP, LAST, 0, LONE,
      { { { "flag", 0, "(1)" }, { "join.lone", 0, "1" },
          { "join.far", 0, "1" }, { "raw", 0, "(0)" } }, 0 },
      { { NULL, 0 } } },
    { "lone-face-at-no-vertex", SOUP, LAST, 0, LONE,
      { { { "flag", 0, "(1)" }, { "join.lone", 0, "1" },
          { "join.far", 0, "1" }, { "raw", 0, "(1)" } }, 0 },
      { { NULL, 0 } } },
    { "lone-face-at-no-neighbour", SOUP, LAST, 0, LONE,
      { { { "flag", 0, "(1)" }, { "join.lone", 0, "1" },
          { "join.far", 0, "0" }, { "join.member", 0, "(1)" } }, 0 },
      { { NULL, 0 } } },
    { "vertex-of-too-many-fans", SOUP, LAST, 4, /* 16 at vertex 0, each time */
      "SPEC 6.3: a vertex with too many fans",
      { { { "flag", 0, "0(1)" }, { "join.lone", 0, "(1)" },
          { "join.pair", 0, "(0)" }, { "join.far", 0, "(1)" },
          { "raw", 0, "(0)" } }, 0 },
      { { "level.1.vertices", 10 }, { "level.1.faces", 300 },
        { "block_faces", 300 }, { "block_splits", 10 },
        { "moved_corners", 300 } } }
};

static const content_case totals[] = {
    { "vertices-above-the-header", PLAIN, LAST, MORE,
      "SPEC 6.3: more splits than the header declares",
      { { { "flag", 0, "(1)" } }, 0 }, { { "block_splits", 50 } } },
    { "faces-above-the-header", SOUP, LAST, MORE,
      "SPEC 6.3: more splits than the header declares",
      { { { "flag", 0, "(1)" }, { "join.lone", 0, "(1)" },
          { "join.far", 0, "(0)" }, { "join.member", 0, "(0)" } }, 0 },
      { { "block_splits", 20 }, { "block_faces", 22 } } },
    { "wedges-above-the-header", FACETS, LAST, MORE,
      "SPEC 6.6: more wedges than the header declares",
      { { { "flag", 0, "(1)" }, { "ordinary", 0, "(1)" }, { "seam", 0, "(1)" },
          { "corner", 0, "(1)" }, { "choice", 0, "(0)" } }, 0 },
      { { "block_splits", 20 }, { "block_wedges", 90 } } }
};

static const content_case exacts[] = {
    { "exact-float-not-finite", FULL, POSITIONS, 0, REACH,
      { { { "exact.same", 0, "1" }, { "exact.rare", 0, "1" },
          { "raw", 0, "(1)" } }, 0 },
      { { NULL, 0 } } },
    { "exact-float-infinite", COARSE, POSITIONS, 0, REACH,
      { { { "exact.same", 0, "1" }, { "exact.rare", 0, "1" },
          { "raw", 0, "011111111(0)" } }, 0 },
      { { NULL, 0 } } },
    { "exact-float-minus-infinite", COARSE, POSITIONS, 0, REACH,
      { { { "exact.same", 0, "1" }, { "exact.rare", 0, "1" },
          { "raw", 0, "111111111(0)" } }, 0 },
      { { NULL, 0 } } },
    { "exact-place-that-is-not-there", COARSE, POSITIONS, 0, REACH,
      { { { "exact.same", 0, "1" }, { "exact.rare", 0, "0" },
          { "raw", 0, "(1)" } }, UINT32_MAX },
      { { NULL, 0 } } }
};

/* "SPEC 6.2: ..." of the decoder, "6.2: ..." of the reference. */
static bool same_section(const char *rule, const char *reference)
{
    return !strncmp(rule + 5, reference, strcspn(reference, ":"));
}

static void break_content(const content_case *from)
{
    chunks c = take_base_file(from->base);
    for (int i = 0; i < CHANGES && from->change[i].field; i++)
        if (!field_set(&c.at[0], from->change[i].field, from->change[i].value))
            complain(from->name, "there is no such field");
    chunk *at = find_chunk(&c, from->type, from->splits == MORE ? -1 : 0);
    if (from->splits == MORE)
        at->data[0]++;
    else if (from->splits)
        at->data[0] = from->splits;
    field_set(&c.at[0], "chunk_size", 1 << 16);
    const size_t offset = chunk_offset(&c, at);
    const char *rule = script_write(&c, at, &from->script);
    if (!rule)
        complain(from->name, "breaks no rule");
    else if (!same_section(from->rule, rule))
        complain(from->name, rule);
    judge(from->name, chunks_put_together(&c),
          (verdict){ PMESH_E_CORRUPT, offset, from->rule });
}

/*
 * Where a normal is seen mirrored, its codes end one earlier: with 4 bits 14 is
 * the last one, and 15 is no code though it has 4 bits. Which normals are
 * mirrored, and how far their codes are from 15, is tried out.
 */
static const char *try_mirrored(chunks *c, chunk *at, uint32_t value,
                                int steps)
{
    char unary[16] = "11111111111111";
    unary[steps] = '0';
    unary[steps + 1] = '\0';
    const script s = { { { "value.zero", value, "1" },
                         { "value.sign", AFTERWARDS, "0" },
                         { "value.unary", AFTERWARDS, unary } },
                       0 };
    return script_write(c, at, &s);
}

static void break_mirrored(void)
{
    for (uint32_t i = 0; i < 14 * 200; i++) {
        chunks c = take_base_file(FULL);
        chunk *at = find_chunk(&c, BASE, 0);
        field_set(&c.at[0], "chunk_size", 1 << 16);
        const size_t offset = chunk_offset(&c, at);
        const char *rule = try_mirrored(&c, at, i / 14, (int)(i % 14));
        shape_bytes file = chunks_put_together(&c);
        if (rule && strstr(rule, "mirrored")) {
            judge("value-mirrored", file,
                  (verdict){ PMESH_E_CORRUPT, offset, VALUE });
            return;
        }
        free(file.data);
    }
    complain("value-mirrored", "no such value");
}

void content_cases(void)
{
    break_mirrored();
    for (size_t i = 0; i < sizeof bases / sizeof *bases; i++)
        break_content(&bases[i]);
    for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++)
        break_content(&blocks[i]);
    for (size_t i = 0; i < sizeof totals / sizeof *totals; i++)
        break_content(&totals[i]);
    for (size_t i = 0; i < sizeof exacts / sizeof *exacts; i++)
        break_content(&exacts[i]);
}
