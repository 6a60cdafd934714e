/* SPDX-License-Identifier: MIT */
/*
 * io_stl.c - STL, binary and ASCII. Its triangles have no vertices in common;
 * equal positions are joined on reading. Normals and colours are passed over:
 * normals follow from the positions.
 *
 * A file is binary if 84 + 50 * count fits its size (exporters put "solid" in
 * front of both kinds), where text would have to be above 7 GB to look so.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/builder.h"
#include "tools/hash.h"
#include "tools/text.h"

#define HEADER_SIZE 84 /* 80 bytes of anything, a count */
#define FACET_SIZE 50  /* normal, 3 positions, 2 bytes of anything */

static uint32_t load_u32(const uint8_t *p)
{
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 |
           (uint32_t)p[3] << 24;
}

static float load_float(const uint8_t *p)
{
    const uint32_t bits = load_u32(p);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* ---- reading ------------------------------------------------------------- */

typedef struct stl_reader {
    text_cursor in;
    mesh_builder mesh;
    hash_table table; /* over mesh.positions */
} stl_reader;

/* The vertex with the bits of a position: whether -0 and 0 are one place is
 * left to the encoder, which may be asked to tell them apart. */
static void add_corner(stl_reader *stl, const double p[3])
{
    mesh_builder *mesh = &stl->mesh;
    const uint32_t hash = hash_bytes(p, 3 * sizeof *p);
    if (!hash_reserve(&stl->table)) {
        mesh->failed = true;
        return;
    }
    size_t i = hash_first(&stl->table, hash);
    for (;; i = hash_next(&stl->table, i)) {
        const hash_slot slot = stl->table.slots[i];
        if (slot.id == HASH_EMPTY)
            break;
        if (slot.hash == hash &&
            memcmp(mesh->positions.items + 3 * (size_t)slot.id, p,
                   3 * sizeof *p) == 0) {
            builder_corner(mesh, builder_vertex(slot.id));
            return;
        }
    }
    const uint32_t id = (uint32_t)mesh->vertex_count;
    builder_position(mesh, p[0], p[1], p[2]);
    if (mesh->failed || mesh->too_many)
        return;
    hash_put(&stl->table, i, hash, id);
    builder_corner(mesh, builder_vertex(id));
}

static void read_binary(stl_reader *stl, const uint8_t *data, uint32_t count)
{
    const uint8_t *p = data + HEADER_SIZE;
    for (uint32_t i = 0; i < count && !stl->mesh.failed; i++, p += FACET_SIZE) {
        builder_begin_face(&stl->mesh);
        for (int c = 0; c < 3; c++) {
            const uint8_t *at = p + 12 + 12 * c;
            add_corner(stl, (double[3]){ (double)load_float(at),
                                         (double)load_float(at + 4),
                                         (double)load_float(at + 8) });
        }
        builder_end_face(&stl->mesh);
    }
}

static text_word next_word(stl_reader *stl)
{
    text_skip_space(&stl->in);
    return text_next_word(&stl->in);
}

static bool expect(stl_reader *stl, const char *word, asset_error *error)
{
    if (text_equal_any_case(next_word(stl), word))
        return true;
    if (stl->in.p == stl->in.end)
        return asset_fail(error, TEXT_AT(&stl->in), "the file ends too early");
    return asset_fail(error, TEXT_AT(&stl->in), "\"%s\" is expected", word);
}

static bool read_vector(stl_reader *stl, double out[3], asset_error *error)
{
    for (int k = 0; k < 3; k++) {
        text_skip_space(&stl->in);
        if (stl->in.p == stl->in.end)
            return asset_fail(error, TEXT_AT(&stl->in),
                              "the file ends too early");
        if (!text_number(&stl->in, &out[k]))
            return asset_fail(error, TEXT_AT(&stl->in), "malformed number");
    }
    return true;
}

/* What follows "facet". */
static bool read_facet(stl_reader *stl, asset_error *error)
{
    double v[3];
    if (!expect(stl, "normal", error) || !read_vector(stl, v, error) ||
        !expect(stl, "outer", error) || !expect(stl, "loop", error))
        return false;
    builder_begin_face(&stl->mesh);
    for (;;) {
        const text_cursor before = stl->in;
        if (text_equal_any_case(next_word(stl), "endloop"))
            break;
        stl->in = before;
        if (!expect(stl, "vertex", error) || !read_vector(stl, v, error))
            return false;
        add_corner(stl, v);
    }
    builder_end_face(&stl->mesh);
    return expect(stl, "endfacet", error);
}

/* A name goes up to the line's end, or to a facet on the same line. */
static void skip_name(text_cursor *in)
{
    while (text_skip_blanks(in), !text_at_eol(in)) {
        const text_cursor before = *in;
        double x;
        if (!text_equal_any_case(text_next_word(in), "facet"))
            continue;
        const bool normal = text_equal_any_case(text_next_word(in), "normal");
        text_skip_blanks(in);
        const bool found = normal && text_number(in, &x);
        *in = before;
        if (found)
            return;
        text_next_word(in);
    }
}

static bool read_ascii(stl_reader *stl, asset *out, asset_error *error)
{
    bool open = false;
    for (;;) {
        const text_word word = next_word(stl);
        if (!word.size)
            break;
        if (text_equal_any_case(word, "facet") && open) {
            if (!read_facet(stl, error))
                return false;
        } else if (text_equal_any_case(word, "solid") ||
                   text_equal_any_case(word, "endsolid")) {
            open = word.size == strlen("solid");
            skip_name(&stl->in);
        } else {
            return asset_fail(error, TEXT_AT(&stl->in),
                              "neither \"facet\" nor \"endsolid\"");
        }
    }
    if (open)
        asset_warn(out, "\"endsolid\" is missing: the file may be cut");
    return true;
}

static bool read_any(stl_reader *stl, const uint8_t *data, size_t size,
                     asset *out, asset_error *error)
{
    const uint32_t count = size < HEADER_SIZE ? 0 : load_u32(data + 80);
    const uint64_t need = HEADER_SIZE + FACET_SIZE * (uint64_t)count;
    const bool solid = text_equal_any_case(next_word(stl), "solid");
    stl->in = text_open(data, size);
    if (size >= HEADER_SIZE && need <= size && (count || !solid)) {
        read_binary(stl, data, count);
    } else if (solid) {
        if (!read_ascii(stl, out, error))
            return false;
    } else if (size < HEADER_SIZE) {
        return asset_fail(error, "", "too short for an STL file");
    } else {
        return asset_fail(error, "byte 80", "%lu facets announced, %zu there",
                          (unsigned long)count,
                          (size - HEADER_SIZE) / FACET_SIZE);
    }
    return builder_finish(&stl->mesh, out, error);
}

bool asset_read_stl(const uint8_t *data, size_t size, asset *out,
                    asset_error *error)
{
    stl_reader stl = { .in = text_open(data, size) };
    *out = (asset){ 0 };
    const bool ok = read_any(&stl, data, size, out, error);
    if (!ok)
        asset_free(out);
    builder_free(&stl.mesh);
    free(stl.table.slots);
    return ok;
}

/* ---- writing ------------------------------------------------------------- */

static void store_u32(uint8_t *p, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        p[i] = (uint8_t)(value >> 8 * i);
}

static void store_float(uint8_t *p, double value)
{
    const float f = builder_float(value);
    uint32_t bits;
    memcpy(&bits, &f, sizeof bits);
    store_u32(p, bits);
}

/* The unit normal, 0 for a triangle without one. */
static void facet_normal(const double *a, const double *b, const double *c,
                         double out[3])
{
    double u[3], v[3];
    for (int k = 0; k < 3; k++) {
        u[k] = b[k] - a[k];
        v[k] = c[k] - a[k];
    }
    for (int k = 0; k < 3; k++)
        out[k] = u[(k + 1) % 3] * v[(k + 2) % 3] -
                 u[(k + 2) % 3] * v[(k + 1) % 3];
    const double length =
        sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2]);
    for (int k = 0; k < 3; k++)
        out[k] = length > 0 && isfinite(length) ? out[k] / length : 0;
}

bool asset_write_stl(const asset *mesh, asset_bytes *out, asset_error *error)
{
    /* Must not begin with "solid": some readers take that for ASCII. */
    uint8_t header[HEADER_SIZE] = "binary STL, written by pmesh";
    if (mesh->face_count > UINT32_MAX)
        return asset_fail(error, "", "too many faces for STL");
    store_u32(header + 80, (uint32_t)mesh->face_count);
    asset_put(out, header, sizeof header);
    for (size_t f = 0; f < mesh->face_count; f++) {
        uint8_t facet[FACET_SIZE] = { 0 };
        const double *p[3];
        double normal[3];
        for (size_t c = 0; c < 3; c++)
            p[c] = mesh->positions + 3 * (size_t)mesh->indices[3 * f + c];
        facet_normal(p[0], p[1], p[2], normal);
        for (int k = 0; k < 3; k++) {
            store_float(facet + 4 * k, normal[k]);
            for (int c = 0; c < 3; c++)
                store_float(facet + 12 + 12 * c + 4 * k, p[c][k]);
        }
        asset_put(out, facet, sizeof facet);
    }
    return !out->failed || asset_fail(error, "", "out of memory");
}
