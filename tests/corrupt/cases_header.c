/* SPDX-License-Identifier: MIT */
/* SPEC 5.3: a header with one wrong field. */
#include "tests/corrupt/corrupt.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LIMIT "SPEC 5.3: a limit is out of range"
#define LARGER "SPEC 5.3: a limit is larger than anything that needs it"
#define TABLE "SPEC 5.3: the level table is out of range"
#define BASE "SPEC 5.3: the base mesh has impossible counts"
#define FOLLOW "SPEC 5.3: a level's counts do not follow from the one before"
#define ERROR "SPEC 5.3: a level's error is not a distance"
#define FORM "SPEC 5.3: an unknown form of exact positions"
#define EXACT "SPEC 5.3: the size of the exact positions is out of range"
#define COMPONENTS "SPEC 5.3: components do not fit the attribute"
#define RANGE "SPEC 5.3: an attribute's range is not finite"
#define FIT "SPEC 5.3: the header's size does not fit its fields"
#define MODE "SPEC 5.3: an unknown mode"
#define POSITION "SPEC 5.3: position bits are 4 to 24"
#define BITS "SPEC 5.3: attribute bits are 4 to 16"
#define STEP "SPEC 5.3: the grid's step is not a length"
#define ORIGIN "SPEC 5.3: the grid's origin is not finite"

#define BIT(n) ((uint64_t)1 << (n))
#define F32_NAN 0x7fc00000
#define F32_INF 0x7f800000
#define F32_MINUS 0xbf800000 /* -1 */
#define F64_NAN 0x7ff8000000000000
#define F64_INF 0x7ff0000000000000
#define F64_MINUS 0xbff0000000000000

typedef struct field_case {
    const char *name;
    base_file base;
    const char *field;
    uint64_t value;
    const char *rule;
} field_case;

static const field_case cases[] = {
    { "modes-bit-7", PLAIN, "modes", 0x81, MODE },
    { "modes-profile-3", PLAIN, "modes", 3, MODE },
    { "modes-draco-and-joined", PLAIN, "modes", 1 + 8 + 32, MODE },
    { "position-bits-3", PLAIN, "position_bits", 3, POSITION },
    { "position-bits-25", PLAIN, "position_bits", 25, POSITION },
    { "position-bits-0", PLAIN, "position_bits", 0, POSITION },
    { "position-bits-255", PLAIN, "position_bits", 255, POSITION },
    { "origin-x-nan", PLAIN, "origin.0", F64_NAN, ORIGIN },
    { "origin-y-infinite", PLAIN, "origin.1", F64_INF, ORIGIN },
    { "origin-z-minus-infinite", PLAIN, "origin.2", F64_INF | BIT(63),
      ORIGIN },
    { "step-nan", PLAIN, "step", F64_NAN, STEP },
    { "step-infinite", PLAIN, "step", F64_INF, STEP },
    { "step-0", PLAIN, "step", 0, STEP },
    { "step-minus-0", PLAIN, "step", BIT(63), STEP },
    { "step-negative", PLAIN, "step", F64_MINUS, STEP },
    { "bounds-x", PLAIN, "bounds.0", 1024, LIMIT },
    { "bounds-y", PLAIN, "bounds.1", 1024, LIMIT },
    { "bounds-z", PLAIN, "bounds.2", BIT(62), LIMIT },
    { "material-count-0", PLAIN, "material_count", 0, LIMIT },
    { "material-count-65537", PLAIN, "material_count", 65537, LIMIT },
    { "chunk-size-large", PLAIN, "chunk_size", BIT(28) + 1, LIMIT },
    { "block-splits-32769", PLAIN, "block_splits", 32769, LIMIT },
    { "block-splits-above-all", PLAIN, "block_splits", 32768, LARGER },
    { "block-wedges-large", FULL, "block_wedges", BIT(30) + 1, LIMIT },
    { "block-wedges-above-all", FULL, "block_wedges", 10000, LARGER },
    { "moved-corners-large", PLAIN, "moved_corners", BIT(31) + 1, LIMIT },
    { "moved-corners-above-all", PLAIN, "moved_corners", 100000, LARGER },
    { "names-size-large", FULL, "names_size", BIT(20) + 1, LIMIT },
    { "base-fans-large", SOUP, "base_fans", 3 * BIT(28) + 1, LIMIT },
    { "base-fans-below-vertices", SOUP, "base_fans", 1, BASE },
    { "base-fans-above-corners", SOUP, "base_fans", 1000, BASE },
    { "block-faces-large", SOUP, "block_faces", BIT(28) + 1, LIMIT },
    { "block-faces-above-all", SOUP, "block_faces", 10000, LARGER },
    { "exact-size-0", FULL, "exact_size", 0, EXACT },
    { "exact-size-large", FULL, "exact_size", BIT(48) + 1, EXACT },
    { "form-0-digits", FULL, "form.0.digits", 0, FORM },
    { "form-10-digits", FULL, "form.1.digits", 10, FORM },
    { "form-127-digits", FULL, "form.1.digits", 127, FORM },
    { "form-no-binary-digits", FULL, "form.2.digits", 128, FORM },
    { "form-25-binary-digits", FULL, "form.2.digits", 128 + 25, FORM },
    { "form-150-decimals", COARSE, "form.0.decimals", 150, FORM },
    { "attribute-count-9", PLAIN, "attribute_count", 9,
      "SPEC 5.3: more than 8 attributes" },
    { "attribute-kind-4", FULL, "attribute.0.kind", 4,
      "SPEC 5.3: an unknown kind of attribute" },
    { "normal-of-2", FULL, "attribute.0.components", 2, COMPONENTS },
    { "normal-of-4", FULL, "attribute.0.components", 4, COMPONENTS },
    { "texture-of-1", FULL, "attribute.1.components", 1, COMPONENTS },
    { "texture-of-3", FULL, "attribute.1.components", 3, COMPONENTS },
    { "colour-of-2", MOVING, "attribute.0.components", 2, COMPONENTS },
    { "colour-of-5", MOVING, "attribute.0.components", 5, COMPONENTS },
    { "generic-of-0", JOINED, "attribute.2.components", 0, COMPONENTS },
    { "generic-of-5", JOINED, "attribute.2.components", 5, COMPONENTS },
    { "attribute-bits-3", FULL, "attribute.0.bits", 3, BITS },
    { "attribute-bits-17", FULL, "attribute.1.bits", 17, BITS },
    { "minimum-nan", FULL, "attribute.1.minimum", F32_NAN, RANGE },
    { "minimum-infinite", FULL, "attribute.1.minimum", F32_INF, RANGE },
    { "scale-nan", FULL, "attribute.1.scale", F32_NAN, RANGE },
    { "scale-infinite", FULL, "attribute.1.scale", F32_INF, RANGE },
    { "scale-negative", FULL, "attribute.1.scale", F32_MINUS, RANGE },
    { "level-count-0", PLAIN, "level_count", 0, "SPEC 5.3: 1 to 64 levels" },
    { "level-count-65", PLAIN, "level_count", 65, "SPEC 5.3: 1 to 64 levels" },
    { "level-count-too-many", PLAIN, "level_count", 64, FIT },
    { "level-count-too-few", COARSE, "level_count", 1, LARGER },
    { "level-bytes-large", PLAIN, "level.1.bytes", BIT(48), TABLE },
    { "level-bytes-huge", PLAIN, "level.0.bytes", BIT(62), TABLE },
    { "level-faces-large", PLAIN, "level.0.faces", BIT(28) + 1, TABLE },
    { "level-faces-sum", PLAIN, "level.1.faces", BIT(28), TABLE },
    { "level-vertices-large", PLAIN, "level.0.vertices", BIT(28) + 1, TABLE },
    { "level-vertices-sum", PLAIN, "level.1.vertices", BIT(28), TABLE },
    { "level-wedges-large", FULL, "level.0.wedges", BIT(30) + 1, TABLE },
    { "level-wedges-sum", FULL, "level.1.wedges", BIT(30), TABLE },
    { "base-no-face", PLAIN, "level.0.faces", 0, BASE },
    { "base-2-vertices", PLAIN, "level.0.vertices", 2, BASE },
    { "base-loose-vertices", PLAIN, "level.0.vertices", 1000, BASE },
    { "base-few-wedges", FULL, "level.0.wedges", 3, BASE },
    { "base-many-wedges", FULL, "level.0.wedges", 1000, BASE },
    { "level-no-vertex", PLAIN, "level.1.vertices", 0, FOLLOW },
    { "level-few-faces", PLAIN, "level.1.faces", 0, FOLLOW },
    { "level-many-faces", PLAIN, "level.1.faces", 1000, FOLLOW },
    { "level-few-wedges", FULL, "level.1.wedges", 0, FOLLOW },
    { "error-nan", PLAIN, "level.0.error", F32_NAN, ERROR },
    { "error-infinite", PLAIN, "level.0.error", F32_INF, ERROR },
    { "error-negative", PLAIN, "level.0.error", F32_MINUS, ERROR },
    { "error-rises", PLAIN, "level.1.error", 0x7f000000, FOLLOW },
    { "rms-above-most", FULL, "level.0.rms", BIT(30), ERROR },
    { "rms-large", FULL, "level.0.rms", BIT(30) + 1, TABLE },
    { "most-large", FULL, "level.0.most", BIT(30) + 1, TABLE }
};

/* Counts that are a little off: the first chunk of type `blamed` tells. Of two
 * levels the second makes up for the first, so that the sum is right. */
typedef struct count_case {
    const char *name;
    base_file base;
    uint8_t blamed;
    const char *rule;
    struct {
        const char *field;
        int more;
    } change[3];
} count_case;

static const count_case counts[] = {
    { "base-vertices-fewer", PLAIN, CHUNK_BASE,
      "SPEC 6.2: more base vertices than declared",
      { { "level.0.vertices", -1 }, { "level.1.vertices", 1 } } },
    { "base-vertices-more", PLAIN, CHUNK_BASE,
      "SPEC 6.2: fewer base vertices than declared",
      { { "level.0.vertices", 1 }, { "level.1.vertices", -1 },
        { "level.1.faces", -2 } } },
    { "base-faces-fewer", PLAIN, CHUNK_BASE,
      "SPEC 6.2: more base faces than declared",
      { { "level.0.faces", -1 } } },
    { "base-wedges-fewer", FULL, CHUNK_BASE,
      "SPEC 6.6: more wedges than the header declares",
      { { "level.0.wedges", -1 }, { "level.1.wedges", 1 } } },
    { "base-wedges-more", FULL, CHUNK_BASE,
      "SPEC 6.2: fewer base wedges than declared",
      { { "level.0.wedges", 1 } } },
    { "base-fans-fewer", SOUP, CHUNK_BASE,
      "SPEC 6.2: more base vertices than declared",
      { { "base_fans", -1 } } },
    { "base-fans-more", SOUP, CHUNK_BASE,
      "SPEC 6.2: fewer base vertices than declared",
      { { "base_fans", 1 } } },
    { "base-of-fans-vertices-more", SOUP, CHUNK_BASE,
      "SPEC 6.2: fewer base vertices than declared",
      { { "level.0.vertices", 1 }, { "level.1.vertices", -1 } } },
    { "draco-vertices-fewer", DRACO, CHUNK_BASE,
      "SPEC 6.2: the Draco buffer does not hold the base mesh",
      { { "level.0.vertices", -1 }, { "level.1.vertices", 1 } } },
    { "draco-faces-fewer", DRACO, CHUNK_BASE,
      "SPEC 6.2: the Draco buffer does not hold the base mesh",
      { { "level.0.faces", -1 } } },
    { "draco-out-of-bounds", DRACO, CHUNK_BASE,
      "SPEC 6.2: a base vertex is out of bounds",
      { { "bounds.0", -100 } } },
    { "level-vertices-fewer", SOUP, CHUNK_LAST,
      "SPEC 6.3: a level differs from the level table",
      { { "level.1.vertices", -1 }, { "level.2.vertices", 1 } } },
    { "level-vertices-more", PLAIN, CHUNK_LAST,
      "SPEC 6.3: a level differs from the level table",
      { { "level.1.vertices", 1 }, { "level.2.vertices", -1 },
        { "level.2.faces", -2 } } },
    { "level-wedges-fewer", FACETS, CHUNK_LAST,
      "SPEC 6.3: a level differs from the level table",
      { { "level.1.wedges", -1 }, { "level.2.wedges", 1 } } },
    { "level-wedges-more", FULL, CHUNK_LAST,
      "SPEC 6.3: a level differs from the level table",
      { { "level.1.wedges", 1 }, { "level.2.wedges", -1 } } },
    { "level-faces-more", SOUP, CHUNK_LAST,
      "SPEC 6.3: a level differs from the level table",
      { { "level.1.faces", 1 }, { "level.2.faces", -1 } } },
    { "level-faces-fewer", SOUP, CHUNK_LAST,
      "SPEC 6.3: a level differs from the level table",
      { { "level.1.faces", -1 }, { "level.2.faces", 1 } } },
    { "block-wedges-fewer", FULL, CHUNK_LAST,
      "SPEC 6.6: more wedges than the header declares",
      { { "block_wedges", -3 } } },
    { "block-splits-fewer", PLAIN, CHUNK_LAST,
      "SPEC 6.3: a block larger than the header declares",
      { { "block_splits", -3 } } },
    { "block-faces-fewer", SOUP, CHUNK_LAST,
      "SPEC 5.3: a block with more faces than declared",
      { { "block_faces", -3 } } },
    { "moved-corners-fewer", PLAIN, CHUNK_LAST,
      "SPEC 5.3: more moved corners than declared",
      { { "moved_corners", -1 } } },
    { "names-size-fewer", FULL, 6, "SPEC 5.2: a names chunk out of place",
      { { "names_size", -1 } } },
    { "names-size-more", FULL, 6, "SPEC 5.2: a names chunk out of place",
      { { "names_size", 1 } } },
    { "chunk-size-fewer", PLAIN, CHUNK_LAST,
      "SPEC 5.2: a chunk larger than the header declares",
      { { "chunk_size", -1 } } }
};

static void break_field(const field_case *f)
{
    chunks c = take_base_file(f->base);
    if (!field_set(&c.at[0], f->field, f->value))
        complain(f->name, "there is no such field");
    judge(f->name, chunks_put_together(&c),
          (verdict){ PMESH_E_CORRUPT, 8, f->rule });
}

/* The last chunk of that type, where the limits are reached. */
static void break_count(const count_case *from)
{
    chunks c = take_base_file(from->base);
    for (int i = 0; i < 3 && from->change[i].field; i++) {
        uint64_t value;
        if (!field_get(&c.at[0], from->change[i].field, &value))
            complain(from->name, "there is no such field");
        field_set(&c.at[0], from->change[i].field,
                  value + (uint64_t)from->change[i].more);
    }
    verdict v = { PMESH_E_CORRUPT, 0, from->rule };
    const bool first = strstr(from->name, "level-") == from->name;
    v.offset = chunk_offset(&c, find_chunk(&c, from->blamed, first ? 0 : -1));
    judge(from->name, chunks_put_together(&c), v);
}

/* The last level may not be inflated; it has no number that is known here. */
static void inflate_last(void)
{
    chunks c = take_base_file(PLAIN);
    field all[FIELDS];
    const int count = fields_of(&c.at[0], all);
    c.at[0].data[all[count - 1].at] = 1;
    judge("inflated-last-level", chunks_put_together(&c),
          (verdict){ PMESH_E_CORRUPT, 8,
                     "SPEC 5.3: the full mesh is inflated" });
}

static void break_version(void)
{
    static const uint8_t versions[] = { 1, 2, 255 };
    for (int i = 0; i < 3; i++) {
        char name[32];
        chunks c = take_base_file(PLAIN);
        snprintf(name, sizeof name, "version-%d", versions[i]);
        field_set(&c.at[0], "version", versions[i]);
        judge(name, chunks_put_together(&c),
              (verdict){ PMESH_E_VERSION, 8,
                         "SPEC 5.3: an unknown format version" });
    }
}

/* Varints that no writer makes, in fields of the header. */
static void break_varints(void)
{
    static const struct {
        const char *name, *field;
        uint8_t bytes[10];
        size_t size;
        const char *rule;
    } forms[] = {
        { "varint-ends-in-0", "chunk_size", { 0x80, 0x00 }, 2, LIMIT },
        { "varint-ends-in-two-0", "moved_corners", { 0x81, 0x80, 0 }, 3,
          LIMIT },
        { "varint-of-10-bytes", "level.0.bytes",
          { 255, 255, 255, 255, 255, 255, 255, 255, 255, 1 }, 10, TABLE },
        { "varint-of-9-bytes-open", "level.0.bytes",
          { 255, 255, 255, 255, 255, 255, 255, 255, 255 }, 9, TABLE }
    };
    for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
        chunks c = take_base_file(PLAIN);
        field_put(&c.at[0], forms[i].field, forms[i].bytes, forms[i].size);
        judge(forms[i].name, chunks_put_together(&c),
              (verdict){ PMESH_E_CORRUPT, 8, forms[i].rule });
    }
}

/* Each field may be the one that is cut off. */
static void cut_header(void)
{
    field all[FIELDS];
    chunks c = take_base_file(PLAIN);
    const int count = fields_of(&c.at[0], all);
    for (int i = 0; i < count; i++) {
        char name[64];
        snprintf(name, sizeof name, "header-ends-before-%.31s",
                 all[i].name);
        for (char *p = name; *p; p++)
            *p = *p == '.' || *p == '_' ? '-' : *p;
        if (i > 0)
            c = take_base_file(PLAIN);
        c.at[0].size = all[i].at;
        judge(name, chunks_put_together(&c),
              (verdict){ PMESH_E_CORRUPT, 8, FIT });
    }
    c = take_base_file(PLAIN);
    c.at[0].data[c.at[0].size++] = 0;
    judge("header-with-a-byte-more", chunks_put_together(&c),
          (verdict){ PMESH_E_CORRUPT, 8, FIT });
}

static void large_header(void)
{
    static const uint8_t zeros[4097];
    chunks c = take_base_file(PLAIN);
    chunk large = chunk_make(CHUNK_HEADER, zeros, sizeof zeros);
    memcpy(large.data, c.at[0].data, c.at[0].size);
    free(c.at[0].data);
    c.at[0] = large;
    judge("header-of-4097-bytes", chunks_put_together(&c),
          (verdict){ PMESH_E_CORRUPT, 8, "SPEC 5.3: the header is too large" });
}

void header_cases(void)
{
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        break_field(&cases[i]);
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        break_count(&counts[i]);
    inflate_last();
    break_version();
    break_varints();
    cut_header();
    large_header();
}
