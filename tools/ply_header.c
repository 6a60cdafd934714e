/* SPDX-License-Identifier: MIT */
#include "tools/ply_header.h"

#include <stdlib.h>

#include "tools/builder.h"

static ply_type type_of(text_word word)
{
    static const char *const names[][2] = {
        [PLY_INT8] = { "char", "int8" },
        [PLY_UINT8] = { "uchar", "uint8" },
        [PLY_INT16] = { "short", "int16" },
        [PLY_UINT16] = { "ushort", "uint16" },
        [PLY_INT32] = { "int", "int32" },
        [PLY_UINT32] = { "uint", "uint32" },
        [PLY_FLOAT] = { "float", "float32" },
        [PLY_DOUBLE] = { "double", "float64" },
    };
    for (int i = 0; i < PLY_NO_TYPE; i++)
        if (text_equal(word, names[i][0]) || text_equal(word, names[i][1]))
            return (ply_type)i;
    return PLY_NO_TYPE;
}

size_t ply_size_of(ply_type type)
{
    static const uint8_t sizes[] = { 1, 1, 2, 2, 4, 4, 4, 8 };
    return sizes[type];
}

static ply_slot vertex_slot(text_word name)
{
    static const struct {
        const char *name;
        ply_slot slot;
    } names[] = {
        { "x", SLOT_X },           { "y", SLOT_Y },
        { "z", SLOT_Z },           { "nx", SLOT_NX },
        { "ny", SLOT_NY },         { "nz", SLOT_NZ },
        { "s", SLOT_U },           { "t", SLOT_V },
        { "u", SLOT_U },           { "v", SLOT_V },
        { "texture_u", SLOT_U },   { "texture_v", SLOT_V },
        { "red", SLOT_RED },       { "green", SLOT_GREEN },
        { "blue", SLOT_BLUE },     { "alpha", SLOT_ALPHA },
        { "r", SLOT_RED },         { "g", SLOT_GREEN },
        { "b", SLOT_BLUE },        { "a", SLOT_ALPHA },
        { "diffuse_red", SLOT_RED }, { "diffuse_green", SLOT_GREEN },
        { "diffuse_blue", SLOT_BLUE },
        { "quality", SLOT_QUALITY }, { "weight", SLOT_QUALITY },
    };
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (text_equal(name, names[i].name))
            return names[i].slot;
    return SLOT_NONE;
}

static bool read_element(ply_header *h, text_cursor *in, asset_error *error)
{
    const text_word name = text_next_word(in);
    ply_element e = { .role = ROLE_NONE, .first = h->property_count };
    text_skip_blanks(in);
    if (!text_count(in, UINT64_MAX, &e.count))
        return asset_fail(error, TEXT_AT(in), "not a count of elements");
    if (text_equal(name, "vertex")) {
        for (size_t i = 0; i < h->element_count; i++)
            if (h->elements[i].role == ROLE_VERTICES)
                return asset_fail(error, TEXT_AT(in), "vertices again");
        e.role = ROLE_VERTICES;
        h->vertex_count = e.count;
    } else if (text_equal(name, "face")) {
        e.role = ROLE_FACES;
    } else if (text_equal(name, "tristrips")) {
        e.role = ROLE_STRIPS;
    }
    ply_element *grown = list_grow(h->elements, &h->element_capacity,
                                   h->element_count + 1, sizeof *grown);
    if (!grown)
        return asset_fail(error, "", "out of memory");
    h->elements = grown;
    grown[h->element_count++] = e;
    return true;
}

/* Of two properties with one meaning the first counts. */
static ply_slot unless_taken(const ply_header *h, const ply_element *e,
                             ply_slot slot)
{
    for (size_t i = e->first; i < h->property_count; i++)
        if (h->properties[i].slot == slot)
            return SLOT_NONE;
    return slot;
}

static bool read_property(ply_header *h, text_cursor *in, asset_error *error)
{
    if (!h->element_count)
        return asset_fail(error, TEXT_AT(in), "a property without an element");
    ply_element *e = &h->elements[h->element_count - 1];
    ply_property p = { .count_type = PLY_NO_TYPE, .slot = SLOT_NONE };
    text_word word = text_next_word(in);
    const bool list = text_equal(word, "list");
    if (list) {
        p.count_type = type_of(text_next_word(in));
        word = text_next_word(in);
    }
    p.type = type_of(word);
    if (p.type == PLY_NO_TYPE || (list && p.count_type == PLY_NO_TYPE))
        return asset_fail(error, TEXT_AT(in), "unknown property type");
    const text_word name = text_next_word(in);
    if (e->role == ROLE_VERTICES && !list)
        p.slot = unless_taken(h, e, vertex_slot(name));
    else if (e->role != ROLE_VERTICES && e->role != ROLE_NONE && list &&
             (text_equal(name, "vertex_indices") ||
              text_equal(name, "vertex_index")))
        p.slot = SLOT_CORNERS;
    ply_property *grown = list_grow(h->properties, &h->property_capacity,
                                    h->property_count + 1, sizeof *grown);
    if (!grown)
        return asset_fail(error, "", "out of memory");
    h->properties = grown;
    grown[h->property_count++] = p;
    e->property_count++;
    return true;
}

static bool read_format(ply_header *h, text_cursor *in, asset_error *error)
{
    const text_word order = text_next_word(in), version = text_next_word(in);
    h->ascii = text_equal(order, "ascii");
    h->big_endian = text_equal(order, "binary_big_endian");
    if (!h->ascii && !h->big_endian &&
        !text_equal(order, "binary_little_endian"))
        return asset_fail(error, TEXT_AT(in), "unknown PLY format \"%.*s\"",
                          (int)(order.size < 40 ? order.size : 40), order.data);
    if (!text_equal(version, "1.0"))
        return asset_fail(error, TEXT_AT(in), "unknown PLY version \"%.*s\"",
                          (int)(version.size < 40 ? version.size : 40),
                          version.data);
    return true;
}

/* Behind "end_header" the data begin. Where lines end with a lone \r, a \n
 * that follows is one of the data. */
static bool end_header(text_cursor *in, bool lone_cr)
{
    text_skip_blanks(in);
    if (in->p == in->end || !text_is_eol(*in->p))
        return false;
    if (lone_cr) {
        in->p++;
        in->line++;
    } else {
        text_take_eol(in);
    }
    return true;
}

bool ply_header_read(ply_header *h, text_cursor *in, asset_error *error)
{
    if (!text_equal(text_next_word(in), "ply"))
        return asset_fail(error, TEXT_AT(in), "not a PLY file");
    const bool lone_cr =
        text_left(in) > 1 && in->p[0] == '\r' && in->p[1] != '\n';
    bool format = false;
    for (;;) {
        text_skip_line(in);
        if (in->p == in->end)
            return asset_fail(error, TEXT_AT(in), "the header has no end");
        const text_word word = text_next_word(in);
        bool ok = true;
        if (text_equal(word, "end_header"))
            break;
        if (text_equal(word, "format"))
            ok = format = read_format(h, in, error);
        else if (text_equal(word, "element"))
            ok = read_element(h, in, error);
        else if (text_equal(word, "property"))
            ok = read_property(h, in, error);
        else if (word.size && !text_equal(word, "comment") &&
                 !text_equal(word, "obj_info"))
            ok = asset_fail(error, TEXT_AT(in), "unknown header line");
        if (!ok)
            return false;
    }
    if (!format)
        return asset_fail(error, TEXT_AT(in), "the format line is missing");
    return end_header(in, lone_cr) ||
           asset_fail(error, TEXT_AT(in), "the file ends behind its header");
}

void ply_header_free(ply_header *h)
{
    free(h->elements);
    free(h->properties);
    *h = (ply_header){ 0 };
}
