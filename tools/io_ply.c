/* SPDX-License-Identifier: MIT */
/*
 * io_ply.c - reads PLY: ASCII and both byte orders, any scalar types and
 * property order, faces as lists or as triangle strips.
 *
 * Values of an ASCII file are told apart by blanks and line ends alike. Counts
 * are compared with the bytes that are left before memory is taken.
 */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/builder.h"
#include "tools/ply_header.h"
#include "tools/text.h"

/* Attributes of the vertices: consecutive slots. */
typedef struct ply_channel {
    pmesh_attribute_kind kind;
    ply_slot first;
    uint8_t components; /* 0: not there */
    double unit;        /* what an integer 1.0 is */
    f32_list values;
} ply_channel;

enum { PLY_CHANNELS = 4 };

typedef struct ply_reader {
    text_cursor in;
    const char *start;
    ply_header header;
    mesh_builder mesh;
    ply_channel channels[PLY_CHANNELS];
} ply_reader;

/* ---- values -------------------------------------------------------------- */

static const char *where(const ply_reader *ply, char out[48])
{
    if (ply->header.ascii)
        return text_where(&ply->in, out);
    snprintf(out, 48, "byte %zu", (size_t)(ply->in.p - ply->start));
    return out;
}

#define PLY_AT(ply) where((ply), (char[48]){ 0 })

static bool fail_short(const ply_reader *ply, asset_error *error)
{
    return asset_fail(error, PLY_AT(ply), "the file ends too early");
}

static uint64_t load(const ply_reader *ply, size_t size)
{
    const unsigned char *p = (const unsigned char *)ply->in.p;
    uint64_t bits = 0;
    if (ply->header.big_endian)
        for (size_t i = 0; i < size; i++)
            bits = bits << 8 | p[i];
    else
        for (size_t i = size; i-- > 0;)
            bits = bits << 8 | p[i];
    return bits;
}

/* An integer of the file as written, or NaN and the like as a double. */
static bool next_binary(ply_reader *ply, ply_type type, double *out)
{
    const size_t size = ply_size_of(type);
    if (text_left(&ply->in) < size)
        return false;
    switch (type) {
    case PLY_INT8: *out = (int8_t)load(ply, 1); break;
    case PLY_UINT8: *out = (uint8_t)load(ply, 1); break;
    case PLY_INT16: *out = (int16_t)load(ply, 2); break;
    case PLY_UINT16: *out = (uint16_t)load(ply, 2); break;
    case PLY_INT32: *out = (int32_t)load(ply, 4); break;
    case PLY_UINT32: *out = (uint32_t)load(ply, 4); break;
    case PLY_FLOAT: {
        const uint32_t bits = (uint32_t)load(ply, 4);
        float value;
        memcpy(&value, &bits, sizeof value);
        *out = (double)value;
        break;
    }
    case PLY_DOUBLE: {
        const uint64_t bits = load(ply, 8);
        memcpy(out, &bits, sizeof *out);
        break;
    }
    case PLY_NO_TYPE: return false;
    }
    ply->in.p += size;
    return true;
}

static bool next_value(ply_reader *ply, ply_type type, double *out,
                       asset_error *error)
{
    text_cursor *in = &ply->in;
    if (!ply->header.ascii)
        return next_binary(ply, type, out) || fail_short(ply, error);
    text_skip_space(in);
    if (in->p == in->end)
        return fail_short(ply, error);
    return text_number(in, out) ||
           asset_fail(error, PLY_AT(ply), "malformed number");
}

/* Passes a value over; what it is does not matter. */
static bool skip_value(ply_reader *ply, ply_type type, asset_error *error)
{
    text_cursor *in = &ply->in;
    if (!ply->header.ascii) {
        if (text_left(in) < ply_size_of(type))
            return fail_short(ply, error);
        in->p += ply_size_of(type);
        return true;
    }
    text_skip_space(in);
    return text_next_word(in).size || fail_short(ply, error);
}

/* A whole number of any type. ASCII digits need no detour over double. */
static bool next_integer(ply_reader *ply, ply_type type, int64_t *out,
                         asset_error *error)
{
    text_cursor *in = &ply->in;
    if (ply->header.ascii) {
        text_skip_space(in);
        const text_cursor before = *in;
        uint64_t digits;
        if (text_count(in, UINT32_MAX, &digits)) {
            *out = (int64_t)digits;
            return true;
        }
        *in = before;
    }
    double value;
    if (!next_value(ply, type, &value, error))
        return false;
    if (!(fabs(value) < 9e15) || value != floor(value))
        return asset_fail(error, PLY_AT(ply), "a whole number is expected");
    *out = (int64_t)value;
    return true;
}

/* A list's length; its entries have to be there. */
static bool next_count(ply_reader *ply, const ply_property *p, uint64_t *out,
                       asset_error *error)
{
    int64_t count;
    if (!next_integer(ply, p->count_type, &count, error))
        return false;
    if (count < 0)
        return asset_fail(error, PLY_AT(ply), "a list of %" PRId64 " entries",
                          count);
    const uint64_t left = text_left(&ply->in);
    const uint64_t most =
        ply->header.ascii ? left / 2 + 1 : left / ply_size_of(p->type);
    *out = (uint64_t)count;
    return *out <= most ||
           asset_fail(error, PLY_AT(ply), "a list of %" PRId64 " entries, with "
                      "%" PRIu64 " bytes left", count, left);
}

static bool skip_property(ply_reader *ply, const ply_property *p,
                          asset_error *error)
{
    uint64_t count = 1;
    if (p->count_type != PLY_NO_TYPE && !next_count(ply, p, &count, error))
        return false;
    if (!ply->header.ascii && p->count_type != PLY_NO_TYPE) {
        ply->in.p += count * ply_size_of(p->type);
        return true;
    }
    for (; count; count--)
        if (!skip_value(ply, p->type, error))
            return false;
    return true;
}

/* ---- elements ------------------------------------------------------------ */

/* The line of an element's first value. */
static size_t begin_element(ply_reader *ply)
{
    if (ply->header.ascii)
        text_skip_space(&ply->in);
    return ply->in.line;
}

/* An element that takes the beginning of another line, but not all of it, is
 * short of values or follows one that has too many. */
static bool end_element(ply_reader *ply, size_t line, asset_error *error)
{
    if (!ply->header.ascii || ply->in.line == line)
        return true;
    text_skip_blanks(&ply->in);
    return text_at_eol(&ply->in) ||
           asset_fail(error, PLY_AT(ply), "too many or too few values");
}

static const ply_property *properties_of(const ply_reader *ply,
                                         const ply_element *e)
{
    return e->property_count ? ply->header.properties + e->first : NULL;
}

/* Decides which attributes there are, and what their integers stand for: all
 * components of an attribute have to be there, alpha may be. */
static void find_channels(ply_reader *ply, const ply_element *e)
{
    static const ply_channel all[PLY_CHANNELS] = {
        { .kind = PMESH_NORMAL, .first = SLOT_NX, .components = 3 },
        { .kind = PMESH_TEXCOORD, .first = SLOT_U, .components = 2 },
        { .kind = PMESH_COLOR, .first = SLOT_RED, .components = 3 },
        { .kind = PMESH_GENERIC, .first = SLOT_QUALITY, .components = 1 },
    };
    ply_type types[SLOT_NONE + 1];
    for (int i = 0; i <= SLOT_NONE; i++)
        types[i] = PLY_NO_TYPE;
    const ply_property *p = properties_of(ply, e);
    for (size_t i = 0; i < e->property_count; i++)
        types[p[i].slot] = p[i].type;

    for (int i = 0; i < PLY_CHANNELS; i++) {
        ply_channel *c = &ply->channels[i];
        *c = all[i];
        for (int k = 0; k < all[i].components; k++)
            if (types[c->first + (ply_slot)k] == PLY_NO_TYPE)
                c->components = 0;
        c->unit = 1;
        if (c->components && c->kind == PMESH_COLOR) {
            if (types[SLOT_ALPHA] != PLY_NO_TYPE)
                c->components = 4;
            const ply_type type = types[SLOT_RED];
            if (type == PLY_UINT16 || type == PLY_INT16)
                c->unit = 65535;
            else if (type != PLY_FLOAT && type != PLY_DOUBLE)
                c->unit = 255;
        }
    }
}

static bool reserve_vertices(ply_reader *ply, size_t count)
{
    f64_list *list = &ply->mesh.positions;
    if (count > SIZE_MAX / 4)
        return false;
    list->items =
        list_grow(NULL, &list->capacity, 3 * count, sizeof *list->items);
    bool ok = list->items != NULL;
    for (int i = 0; ok && i < PLY_CHANNELS; i++) {
        ply_channel *c = &ply->channels[i];
        if (!c->components)
            continue;
        c->values.items = list_grow(NULL, &c->values.capacity,
                                    c->components * count, sizeof(float));
        ok = c->values.items != NULL;
    }
    return ok;
}

static void push_channels(ply_reader *ply, const double *values)
{
    for (int i = 0; i < PLY_CHANNELS; i++) {
        ply_channel *c = &ply->channels[i];
        for (uint8_t k = 0; k < c->components; k++)
            c->values.items[c->values.count++] =
                builder_float(values[c->first + (ply_slot)k] / c->unit);
    }
}

static bool read_vertices(ply_reader *ply, const ply_element *e,
                          asset_error *error)
{
    const ply_property *p = properties_of(ply, e);
    unsigned found = 0;
    for (size_t i = 0; i < e->property_count; i++)
        found |= p[i].slot <= SLOT_Z ? 1u << p[i].slot : 0;
    if (found != 7)
        return asset_fail(error, "", "the vertices lack x, y or z");
    if (e->count >= UINT32_MAX)
        return asset_fail(error, "", "more than 2^32 vertices");
    find_channels(ply, e);
    if (!reserve_vertices(ply, (size_t)e->count))
        return asset_fail(error, "", "out of memory");
    for (uint64_t v = 0; v < e->count; v++) {
        const size_t line = begin_element(ply);
        double values[SLOT_COUNT] = { 0 };
        for (size_t i = 0; i < e->property_count; i++) {
            const bool ok =
                p[i].slot < SLOT_COUNT
                    ? next_value(ply, p[i].type, &values[p[i].slot], error)
                    : skip_property(ply, &p[i], error);
            if (!ok)
                return false;
        }
        if (!end_element(ply, line, error))
            return false;
        builder_position(&ply->mesh, values[SLOT_X], values[SLOT_Y],
                         values[SLOT_Z]);
        push_channels(ply, values);
    }
    return true;
}

static bool check_corner(const ply_reader *ply, int64_t index,
                         asset_error *error)
{
    if (index >= 0 && (uint64_t)index < ply->header.vertex_count &&
        index < UINT32_MAX)
        return true;
    return asset_fail(error, PLY_AT(ply),
                      "vertex index %" PRId64 ", there are %" PRIu64, index,
                      ply->header.vertex_count);
}

static bool read_polygon(ply_reader *ply, const ply_property *p,
                         asset_error *error)
{
    uint64_t count;
    if (!next_count(ply, p, &count, error))
        return false;
    builder_begin_face(&ply->mesh);
    for (; count; count--) {
        int64_t index;
        if (!next_integer(ply, p->type, &index, error) ||
            !check_corner(ply, index, error))
            return false;
        builder_corner(&ply->mesh, builder_vertex((uint32_t)index));
    }
    builder_end_face(&ply->mesh);
    return true;
}

/* Every vertex makes a triangle with the two before it; -1 begins a new strip.
 * The sense alternates, as the new vertex takes the older one's place. */
static bool read_strip(ply_reader *ply, const ply_property *p,
                       asset_error *error)
{
    uint64_t count;
    if (!next_count(ply, p, &count, error))
        return false;
    uint32_t last[2] = { 0, 0 };
    for (uint64_t size = 0; count; count--) {
        int64_t index;
        if (!next_integer(ply, p->type, &index, error))
            return false;
        if (index == -1 || (index == UINT32_MAX && p->type == PLY_UINT32)) {
            size = 0;
            continue;
        }
        if (!check_corner(ply, index, error))
            return false;
        if (size >= 2) {
            builder_begin_face(&ply->mesh);
            builder_corner(&ply->mesh, builder_vertex(last[0]));
            builder_corner(&ply->mesh, builder_vertex(last[1]));
            builder_corner(&ply->mesh, builder_vertex((uint32_t)index));
            builder_end_face(&ply->mesh);
        }
        last[size++ % 2] = (uint32_t)index;
    }
    return true;
}

static bool read_faces(ply_reader *ply, const ply_element *e,
                       asset_error *error)
{
    const ply_property *p = properties_of(ply, e);
    bool found = false;
    for (size_t i = 0; i < e->property_count; i++)
        found |= p[i].slot == SLOT_CORNERS;
    if (!found)
        return asset_fail(error, "", "the faces have no list vertex_indices");
    for (uint64_t f = 0; f < e->count; f++) {
        const size_t line = begin_element(ply);
        for (size_t i = 0; i < e->property_count; i++) {
            const bool ok = p[i].slot != SLOT_CORNERS
                                ? skip_property(ply, &p[i], error)
                            : e->role == ROLE_FACES
                                ? read_polygon(ply, &p[i], error)
                                : read_strip(ply, &p[i], error);
            if (!ok)
                return false;
        }
        if (!end_element(ply, line, error))
            return false;
    }
    return true;
}

/* The least number of bytes one of these takes, 0 without properties. In
 * ASCII a digit and a gap each; the very last gap may be missing. */
static uint64_t least_size(const ply_reader *ply, const ply_element *e)
{
    if (ply->header.ascii)
        return 2 * (uint64_t)e->property_count;
    const ply_property *p = properties_of(ply, e);
    uint64_t size = 0;
    for (size_t i = 0; i < e->property_count; i++)
        size += ply_size_of(p[i].count_type != PLY_NO_TYPE ? p[i].count_type
                                                       : p[i].type);
    return size;
}

static bool read_elements(ply_reader *ply, asset_error *error)
{
    for (size_t i = 0; i < ply->header.element_count; i++) {
        const ply_element *e = &ply->header.elements[i];
        const uint64_t size = least_size(ply, e);
        if (size && e->count > ((uint64_t)text_left(&ply->in) + 1) / size)
            return asset_fail(error, PLY_AT(ply),
                              "%" PRIu64 " elements announced, %zu bytes left",
                              e->count, text_left(&ply->in));
        bool ok = true;
        if (e->role == ROLE_VERTICES)
            ok = read_vertices(ply, e, error);
        else if (e->role != ROLE_NONE)
            ok = read_faces(ply, e, error);
        for (uint64_t k = 0; ok && size && e->role == ROLE_NONE && k < e->count;
             k++)
            for (size_t j = 0; ok && j < e->property_count; j++)
                ok = skip_property(ply, properties_of(ply, e) + j, error);
        if (!ok)
            return false;
    }
    return true;
}

static bool read_all(ply_reader *ply, asset *out, asset_error *error)
{
    if (!ply_header_read(&ply->header, &ply->in, error) ||
        !read_elements(ply, error) ||
        !builder_finish(&ply->mesh, out, error))
        return false;
    for (int i = 0; i < PLY_CHANNELS; i++) {
        ply_channel *c = &ply->channels[i];
        if (!c->values.count)
            continue;
        builder_attach(out, c->kind, c->components, &c->values, NULL);
        if (c->kind == PMESH_GENERIC)
            strcpy(out->attributes[out->attribute_count - 1].name, "quality");
    }
    return true;
}

bool asset_read_ply(const uint8_t *data, size_t size, asset *out,
                    asset_error *error)
{
    ply_reader ply = { .in = text_open(data, size),
                       .start = (const char *)data };
    *out = (asset){ 0 };
    const bool ok = read_all(&ply, out, error);
    if (!ok)
        asset_free(out);
    builder_free(&ply.mesh);
    ply_header_free(&ply.header);
    for (int i = 0; i < PLY_CHANNELS; i++)
        free(ply.channels[i].values.items);
    return ok;
}
