/* SPDX-License-Identifier: MIT */
/*
 * io_off.c - Geomview's OFF: [ST][C][N]OFF, ASCII and BINARY (big-endian).
 *
 * ASCII is read by lines: one vertex or face on each, comments from # on, the
 * colours behind a face passed over. 4-D and n-D positions are refused.
 */
#include <stdlib.h>
#include <string.h>

#include "tools/builder.h"
#include "tools/text.h"

/* ---- reading ------------------------------------------------------------- */

typedef struct off_reader {
    text_cursor in;
    const char *start;
    bool has_normals, has_colors, has_uvs, binary;
    uint64_t vertex_count, face_count;
    mesh_builder mesh;
    f32_list normals, colors, uvs;
    uint8_t color_size; /* components of the first colour, 0: none yet */
    bool failed;        /* out of memory */
} off_reader;

/* To the first word of a line that has one. */
static bool next_line(text_cursor *in)
{
    for (;;) {
        text_skip_space(in);
        if (in->p == in->end)
            return false;
        if (*in->p != '#')
            return true;
        text_skip_line(in);
    }
}

static bool at_end_of_data(text_cursor *in)
{
    text_skip_blanks(in);
    return text_at_eol(in) || *in->p == '#';
}

static bool take(text_word *word, const char *prefix)
{
    const size_t n = strlen(prefix);
    if (word->size < n || memcmp(word->data, prefix, n) != 0)
        return false;
    word->data += n;
    word->size -= n;
    return true;
}

/* Up to the line of the counts; the keyword may be missing. */
static bool read_keyword(off_reader *off, asset_error *error)
{
    text_cursor *in = &off->in;
    if (!next_line(in))
        return asset_fail(error, "", "the file is empty");
    const text_cursor before = *in;
    text_word word = text_next_word(in);
    off->has_uvs = take(&word, "ST");
    off->has_colors = take(&word, "C");
    off->has_normals = take(&word, "N");
    const bool more = take(&word, "4") || take(&word, "n");
    if (!text_equal(word, "OFF")) {
        const bool digit = *before.p >= '0' && *before.p <= '9';
        *in = before;
        off->has_uvs = off->has_colors = off->has_normals = false;
        return digit || asset_fail(error, TEXT_AT(in), "not an OFF file");
    }
    if (more)
        return asset_fail(error, TEXT_AT(in),
                          "positions of other than 3 dimensions");
    const text_cursor behind = *in;
    off->binary = text_equal(text_next_word(in), "BINARY");
    if (off->binary)
        text_skip_line(in);
    else
        *in = behind;
    return true;
}

static bool fail_short(const off_reader *off, asset_error *error)
{
    return asset_fail(error, TEXT_AT(&off->in), "the file ends too early");
}

/* Every vertex and face takes at least `vertex` and `face` bytes. */
static bool check_counts(const off_reader *off, size_t vertex, size_t face,
                         asset_error *error)
{
    const uint64_t left = (uint64_t)text_left(&off->in) + 1;
    if (off->vertex_count <= left / vertex && off->face_count <= left / face &&
        off->vertex_count * vertex + off->face_count * face <= left)
        return true;
    return asset_fail(error, TEXT_AT(&off->in),
                      "more vertices or faces announced than fit the file");
}

/* Vertices, faces and, often, edges on one line. */
static bool read_counts(off_reader *off, asset_error *error)
{
    text_cursor *in = &off->in;
    if (!next_line(in))
        return fail_short(off, error);
    bool ok = text_count(in, UINT32_MAX - 1, &off->vertex_count);
    text_skip_blanks(in);
    ok = ok && text_count(in, UINT32_MAX - 1, &off->face_count);
    if (!ok)
        return asset_fail(error, TEXT_AT(in), "malformed counts");
    text_skip_line(in);
    return check_counts(off, 6, 2, error);
}

static void push_floats(off_reader *off, f32_list *list, const double *values,
                        size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!f32_push(list, builder_float(values[i])))
            off->failed = true;
}

/* Colours have 3 or 4 components; all have to have as many as the first, or
 * they end up too few and are left out. */
static void push_color(off_reader *off, const double *values, size_t count)
{
    if (!off->color_size)
        off->color_size = count == 3 || count == 4 ? (uint8_t)count : 1;
    if (count == off->color_size)
        push_floats(off, &off->colors, values, count);
}

/* x y z [normal] [colour] [s t]: the colour is what the others leave. */
static bool read_vertex(off_reader *off, asset_error *error)
{
    text_cursor *in = &off->in;
    double v[12];
    size_t n = 0;
    if (!next_line(in))
        return fail_short(off, error);
    for (; n < sizeof v / sizeof v[0] && !at_end_of_data(in); n++)
        if (!text_number(in, &v[n]))
            return asset_fail(error, TEXT_AT(in), "malformed number");
    const size_t normal = off->has_normals ? 3 : 0, uv = off->has_uvs ? 2 : 0;
    if (n < 3 + normal + uv)
        return asset_fail(error, TEXT_AT(in), "a vertex of only %zu numbers",
                          n);
    builder_position(&off->mesh, v[0], v[1], v[2]);
    push_floats(off, &off->normals, v + 3, normal);
    if (off->has_colors)
        push_color(off, v + 3 + normal, n - uv - normal - 3);
    push_floats(off, &off->uvs, v + n - uv, uv);
    text_skip_line(in);
    return true;
}

static bool add_corner(off_reader *off, uint64_t index, asset_error *error)
{
    if (index >= off->vertex_count)
        return asset_fail(error, TEXT_AT(&off->in),
                          "vertex index %llu, there are %llu",
                          (unsigned long long)index,
                          (unsigned long long)off->vertex_count);
    builder_corner(&off->mesh, builder_vertex((uint32_t)index));
    return true;
}

static bool read_face(off_reader *off, asset_error *error)
{
    text_cursor *in = &off->in;
    uint64_t count, index;
    if (!next_line(in))
        return fail_short(off, error);
    if (!text_count(in, UINT32_MAX, &count))
        return asset_fail(error, TEXT_AT(in), "malformed count of corners");
    builder_begin_face(&off->mesh);
    for (; count; count--) {
        if (at_end_of_data(in))
            return asset_fail(error, TEXT_AT(in), "%llu corners are missing",
                              (unsigned long long)count);
        if (!text_count(in, UINT32_MAX, &index))
            return asset_fail(error, TEXT_AT(in), "malformed vertex index");
        if (!add_corner(off, index, error))
            return false;
    }
    builder_end_face(&off->mesh);
    text_skip_line(in);
    return true;
}

static bool read_ascii(off_reader *off, asset_error *error)
{
    if (!read_counts(off, error))
        return false;
    for (uint64_t i = 0; i < off->vertex_count; i++)
        if (!read_vertex(off, error))
            return false;
    for (uint64_t i = 0; i < off->face_count; i++)
        if (!read_face(off, error))
            return false;
    return true;
}

/* The caller has seen that 4 bytes are there. */
static uint32_t take_u32(text_cursor *in)
{
    const unsigned char *p = (const unsigned char *)in->p;
    in->p += 4;
    return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 |
           p[3];
}

static void take_floats(text_cursor *in, double *out, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const uint32_t bits = take_u32(in);
        float value;
        memcpy(&value, &bits, sizeof value);
        out[i] = (double)value;
    }
}

/* Corner count, corners, count of colour components, those as floats. */
static bool read_binary_face(off_reader *off, asset_error *error)
{
    text_cursor *in = &off->in;
    if (text_left(in) < 4)
        return fail_short(off, error);
    uint32_t count = take_u32(in);
    if (text_left(in) / 4 < (uint64_t)count + 1)
        return fail_short(off, error);
    builder_begin_face(&off->mesh);
    for (; count; count--)
        if (!add_corner(off, take_u32(in), error))
            return false;
    builder_end_face(&off->mesh);
    const uint32_t colors = take_u32(in);
    if (text_left(in) / 4 < colors)
        return fail_short(off, error);
    in->p += 4 * (size_t)colors;
    return true;
}

static bool read_binary(off_reader *off, asset_error *error)
{
    text_cursor *in = &off->in;
    if (text_left(in) < 12)
        return fail_short(off, error);
    off->vertex_count = take_u32(in);
    off->face_count = take_u32(in);
    take_u32(in); /* edges */
    const size_t normal = off->has_normals ? 3 : 0, uv = off->has_uvs ? 2 : 0;
    const size_t color = off->has_colors ? 4 : 0;
    const size_t size = 3 + normal + color + uv;
    if (!check_counts(off, 4 * size, 8, error))
        return false;
    if (off->vertex_count * 4 * size > text_left(in))
        return fail_short(off, error);
    for (uint64_t i = 0; i < off->vertex_count; i++) {
        double v[12];
        take_floats(in, v, size);
        builder_position(&off->mesh, v[0], v[1], v[2]);
        push_floats(off, &off->normals, v + 3, normal);
        if (color)
            push_color(off, v + 3 + normal, color);
        push_floats(off, &off->uvs, v + 3 + normal + color, uv);
    }
    for (uint64_t i = 0; i < off->face_count; i++)
        if (!read_binary_face(off, error))
            return false;
    return true;
}

static bool read_all(off_reader *off, asset *out, asset_error *error)
{
    if (!read_keyword(off, error) ||
        !(off->binary ? read_binary(off, error) : read_ascii(off, error)) ||
        !builder_finish(&off->mesh, out, error))
        return false;
    if (off->failed)
        return asset_fail(error, "", "out of memory");
    if (off->normals.count)
        builder_attach(out, PMESH_NORMAL, 3, &off->normals, NULL);
    if (off->uvs.count)
        builder_attach(out, PMESH_TEXCOORD, 2, &off->uvs, NULL);
    if (off->has_colors && off->color_size)
        builder_attach(out, PMESH_COLOR, off->color_size, &off->colors, NULL);
    return true;
}

bool asset_read_off(const uint8_t *data, size_t size, asset *out,
                    asset_error *error)
{
    off_reader off = { .in = text_open(data, size) };
    *out = (asset){ 0 };
    const bool ok = read_all(&off, out, error);
    if (!ok)
        asset_free(out);
    builder_free(&off.mesh);
    free(off.normals.items);
    free(off.colors.items);
    free(off.uvs.items);
    return ok;
}

/* ---- writing ------------------------------------------------------------- */

bool asset_write_off(const asset *mesh, asset_bytes *out, asset_error *error)
{
    asset_printf(out, "OFF\n%zu %zu 0\n", mesh->vertex_count,
                 mesh->face_count);
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        char line[3 * 33];
        size_t n = 0;
        for (size_t k = 0; k < 3; k++) {
            n += builder_print(mesh, line + n, 3 * v + k);
            line[n++] = k < 2 ? ' ' : '\n';
        }
        asset_put(out, line, n);
    }
    for (size_t f = 0; f < mesh->face_count; f++) {
        const uint32_t *v = mesh->indices + 3 * f;
        asset_printf(out, "3 %lu %lu %lu\n", (unsigned long)v[0],
                     (unsigned long)v[1], (unsigned long)v[2]);
    }
    return !out->failed || asset_fail(error, "", "out of memory");
}
