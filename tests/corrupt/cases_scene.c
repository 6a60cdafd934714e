/* SPDX-License-Identifier: MIT */
/* SPEC 11: scenes with one wrong field, or one wrong part. */
#include "tests/corrupt/corrupt.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/reference/ref.h"

enum { SCENE_HEADER = 8, PART = 9, END = 5 };

#define COUNT "SPEC 11.2: a count is out of range"
#define LEVELS "SPEC 11.2: 1 to 64 levels"
#define ERROR "SPEC 11.2: a level's error is not a distance that falls"
#define SCALE "SPEC 11.2: a mesh's scale is not a factor"
#define FIT "SPEC 11.2: the header's size does not fit its fields"
#define MORE "SPEC 11.3: more bytes than the part has"
#define NO_PART "SPEC 11.3: a part that is not there, or no bytes"
#define NOT_ALL "SPEC 11.3: the end comes before all parts"
#define UNKNOWN "SPEC 11.1: an unknown critical chunk"

#define BIT(n) ((uint64_t)1 << (n))
#define F32_NAN 0x7fc00000
#define F32_INF 0x7f800000
#define F32_MINUS 0xbf800000 /* -1 */

typedef struct field_case {
    const char *name, *field;
    uint64_t value;
    const char *rule;
} field_case;

static const field_case fields[] = {
    { "scene-chunk-size-large", "chunk_size", BIT(28) + 1, COUNT },
    { "scene-document-form-2", "document_form", 2,
      "SPEC 11.2: an unknown form of the document" },
    { "scene-document-form-255", "document_form", 255,
      "SPEC 11.2: an unknown form of the document" },
    { "scene-document-size-large", "document_size", BIT(28) + 1, COUNT },
    { "scene-mesh-count-0", "mesh_count", 0, COUNT },
    { "scene-mesh-count-65537", "mesh_count", 65537, COUNT },
    { "scene-resource-count-65537", "resource_count", 65537, COUNT },
    { "scene-level-count-0", "level_count", 0, LEVELS },
    { "scene-level-count-65", "level_count", 65, LEVELS },
    { "scene-level-bytes-sum", "level.1.bytes", BIT(48), COUNT },
    { "scene-level-faces-sum", "level.1.faces", BIT(48), COUNT },
    { "scene-level-vertices-sum", "level.1.vertices", BIT(48), COUNT },
    { "scene-error-nan", "level.0.error", F32_NAN, ERROR },
    { "scene-error-infinite", "level.0.error", F32_INF, ERROR },
    { "scene-error-negative", "level.0.error", F32_MINUS, ERROR },
    { "scene-error-rises", "level.1.error", 0x7f000000, ERROR },
    { "scene-scale-nan", "mesh.0.scale", F32_NAN, SCALE },
    { "scene-scale-infinite", "mesh.1.scale", F32_INF, SCALE },
    { "scene-scale-negative", "mesh.1.scale", F32_MINUS, SCALE },
    { "scene-mesh-size-large", "mesh.0.size", BIT(48) + 1, FIT },
    { "scene-sizes-sum", "mesh.1.size", BIT(48), FIT },
    { "scene-mesh-count-too-many", "mesh_count", 3, FIT },
    { "scene-resource-count-too-few", "resource_count", 1, FIT }
};

static void break_field(const field_case *f)
{
    chunks c = take_base_file(SCENE);
    if (!field_set(&c.at[0], f->field, f->value))
        complain(f->name, "there is no such field");
    judge(f->name, chunks_put_together(&c),
          (verdict){ PMESH_E_CORRUPT, 8, f->rule });
}

static void break_header(void)
{
    static const size_t cuts[] = { 0, 1, 8, 9, 12, 40 };
    chunks c = take_base_file(SCENE);
    field_set(&c.at[0], "version", 1);
    judge("scene-version-1", chunks_put_together(&c),
          (verdict){ PMESH_E_VERSION, 8,
                     "SPEC 11.2: an unknown version of scenes" });
    for (size_t i = 0; i < sizeof cuts / sizeof *cuts; i++) {
        char name[40];
        c = take_base_file(SCENE);
        c.at[0].size = cuts[i];
        snprintf(name, sizeof name, "scene-header-of-%u-bytes",
                 (unsigned)cuts[i]);
        judge(name, chunks_put_together(&c),
              (verdict){ PMESH_E_CORRUPT, 8, FIT });
    }
    c = take_base_file(SCENE);
    c.at[0].data[c.at[0].size++] = 0;
    judge("scene-header-with-a-byte-more", chunks_put_together(&c),
          (verdict){ PMESH_E_CORRUPT, 8, FIT });
}

/* The sizes of parts, and the last chunk but the end, or the end, tells. */
static void break_sizes(void)
{
    static const struct {
        const char *name, *field;
        int more;
        bool at_end;
    } sizes[] = { { "scene-mesh-longer", "mesh.0.size", 1, true },
                  { "scene-mesh-shorter", "mesh.1.size", -1, false },
                  { "scene-resource-longer", "resource.1", 1, true },
                  { "scene-resource-shorter", "resource.1", -1, false },
                  { "scene-document-longer", "document_size", 1, true } };
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        chunks c = take_base_file(SCENE);
        uint64_t value = 0;
        field_get(&c.at[0], sizes[i].field, &value);
        field_set(&c.at[0], sizes[i].field, value + (uint64_t)sizes[i].more);
        /* Which part comes last is the encoder's choice. */
        const chunk *at = find_chunk(&c, sizes[i].at_end ? END : PART, -1);
        const uint8_t part = sizes[i].field[0] == 'm' ? 2 : 4;
        while (!sizes[i].at_end && at->data[0] != part)
            at--;
        const size_t offset = chunk_offset(&c, at);
        judge(sizes[i].name, chunks_put_together(&c),
              (verdict){ PMESH_E_CORRUPT, offset,
                         sizes[i].at_end ? NOT_ALL : MORE });
    }
}

/* A chunk behind the last part. */
static void add_chunks(void)
{
    static const struct {
        const char *name;
        uint8_t type, bytes[4];
        size_t size;
        pmesh_status status;
        const char *rule;
    } added[] = {
        { "scene-header-twice", SCENE_HEADER, { 0 }, 1, PMESH_E_CORRUPT,
          "SPEC 11.1: a second header" },
        { "scene-end-not-empty", END, { 0 }, 1, PMESH_E_CORRUPT,
          "SPEC 11.1: the end is not empty" },
        { "scene-unknown-type-0", 0, { 0 }, 0, PMESH_E_VERSION, UNKNOWN },
        { "scene-with-a-header", 1, { 0 }, 1, PMESH_E_VERSION, UNKNOWN },
        { "scene-with-a-base", 2, { 0 }, 1, PMESH_E_VERSION, UNKNOWN },
        { "scene-with-positions", 7, { 0 }, 1, PMESH_E_VERSION, UNKNOWN },
        { "scene-unknown-type-10", 10, { 0 }, 1, PMESH_E_VERSION, UNKNOWN },
        { "scene-unknown-type-127", 127, { 0 }, 0, PMESH_E_VERSION, UNKNOWN },
        { "scene-part-empty", PART, { 0 }, 0, PMESH_E_CORRUPT, NO_PART },
        { "scene-part-of-no-bytes", PART, { 1 }, 1, PMESH_E_CORRUPT, NO_PART },
        { "scene-part-5-of-4", PART, { 5, 'x' }, 2, PMESH_E_CORRUPT,
          NO_PART },
        { "scene-part-ends-in-0", PART, { 0x81, 0, 'x' }, 3, PMESH_E_CORRUPT,
          NO_PART },
        { "scene-document-goes-on", PART, { 0, 'x' }, 2, PMESH_E_CORRUPT,
          MORE },
        { "scene-mesh-goes-on", PART, { 1, 'x' }, 2, PMESH_E_CORRUPT, MORE },
        { "scene-resource-goes-on", PART, { 3, 'x' }, 2, PMESH_E_CORRUPT,
          MORE }
    };
    for (size_t i = 0; i < sizeof added / sizeof *added; i++) {
        chunks c = take_base_file(SCENE);
        const uint32_t at = c.count - 1;
        insert_chunk(&c, at,
                     chunk_make(added[i].type, added[i].bytes, added[i].size));
        const size_t offset = chunk_offset(&c, &c.at[at]);
        judge(added[i].name, chunks_put_together(&c),
              (verdict){ added[i].status, offset, added[i].rule });
    }
}

static void drop_chunks(void)
{
    chunks c = take_base_file(SCENE);
    drop_chunk(&c, find_chunk(&c, PART, 0)); /* the document */
    size_t offset = chunk_offset(&c, find_chunk(&c, END, 0));
    judge("scene-without-its-document", chunks_put_together(&c),
          (verdict){ PMESH_E_CORRUPT, offset, NOT_ALL });
    c = take_base_file(SCENE);
    field_set(&c.at[0], "chunk_size", 20);
    chunk *large = find_chunk(&c, PART, 0);
    while (large->size <= 20)
        large++;
    offset = chunk_offset(&c, large);
    judge("scene-chunk-above-chunk-size", chunks_put_together(&c),
          (verdict){ PMESH_E_CORRUPT, offset,
                     "SPEC 11.2: a chunk larger than the header declares" });
}

/* The scene is right, a mesh in it is not: its signature, its first checksum. */
static void break_meshes(void)
{
    static const struct {
        const char *name;
        size_t at;
        pmesh_status status;
        const char *rule;
    } broken[] = { { "scene-mesh-without-signature", 1, PMESH_E_MAGIC,
                     "SPEC 5.1: the signature is missing" },
                   { "scene-mesh-with-a-flipped-bit", 20, PMESH_E_CHECKSUM,
                     "SPEC 5.2: a chunk's checksum does not match" } };
    for (size_t i = 0; i < sizeof broken / sizeof *broken; i++) {
        chunks c = take_base_file(SCENE);
        chunk *part = find_chunk(&c, PART, 0);
        while (part->data[0] != 1)
            part++;
        part->data[1 + broken[i].at] ^= 4;
        const size_t offset = chunk_offset(&c, part);
        judge(broken[i].name, chunks_put_together(&c),
              (verdict){ broken[i].status, offset, broken[i].rule });
    }
}

static void break_hash(void)
{
    chunks c = take_base_file(SCENE);
    const size_t end = chunk_offset(&c, find_chunk(&c, END, 0));
    const size_t framed = chunk_framed_size(&c.at[0]);
    const size_t payload = c.at[0].size;
    shape_bytes file = chunks_put_together(&c);
    uint8_t *crc = file.data + 8 + framed - 4;
    crc[-(ptrdiff_t)payload + 1] ^= 1; /* behind the version */
    const uint32_t now = ref_crc32c(0, file.data + 8, framed - 4);
    for (size_t i = 0; i < 4; i++)
        crc[i] = (uint8_t)(now >> (8 * i));
    judge("scene-content-hash", file,
          (verdict){ PMESH_E_CORRUPT, end,
                     "SPEC 11.2: the content hash does not match" });
}

void scene_cases(void)
{
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++)
        break_field(&fields[i]);
    break_header();
    break_sizes();
    add_chunks();
    drop_chunks();
    break_meshes();
    break_hash();
}
