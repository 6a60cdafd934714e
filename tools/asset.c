/* SPDX-License-Identifier: MIT */
#include "tools/asset.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/builder.h"
#include "tools/text.h"
#include "tools/utf8.h"

void asset_free(asset *mesh)
{
    free(mesh->positions);
    free(mesh->indices);
    free(mesh->materials);
    for (uint32_t i = 0; mesh->material_names && i < mesh->material_count; i++)
        free(mesh->material_names[i]);
    free(mesh->material_names);
    for (size_t i = 0; i < mesh->attribute_count; i++) {
        free(mesh->attributes[i].values);
        free(mesh->attributes[i].indices);
    }
    *mesh = (asset){ 0 };
}

/* ---- messages ------------------------------------------------------------ */

/* U+0080 .. U+009F are control characters too: some terminals obey them. */
void asset_clean_text(char *text)
{
    size_t size;
    uint32_t code;
    for (; (size = utf8_next(text, &code)) != 0; text += size)
        if (code < 0x20 || (code >= 0x7F && code < 0xA0) ||
            code == UTF8_INVALID)
            memset(text, '?', size);
}

bool asset_fail(asset_error *error, const char *where, const char *what, ...)
{
    snprintf(error->where, sizeof error->where, "%s", where);
    va_list args;
    va_start(args, what);
    vsnprintf(error->what, sizeof error->what, what, args);
    va_end(args);
    asset_clean_text(error->where);
    asset_clean_text(error->what);
    return false;
}

void asset_warn(asset *mesh, const char *what, ...)
{
    char line[256];
    va_list args;
    va_start(args, what);
    vsnprintf(line, sizeof line, what, args);
    va_end(args);
    asset_clean_text(line);

    const size_t used = strlen(mesh->warnings), size = strlen(line);
    if (used + size + 2 > sizeof mesh->warnings)
        return; /* enough has been said */
    memcpy(mesh->warnings + used, line, size);
    memcpy(mesh->warnings + used + size, "\n", 2);
}

/* ---- bytes --------------------------------------------------------------- */

void asset_bytes_free(asset_bytes *bytes)
{
    free(bytes->data);
    *bytes = (asset_bytes){ 0 };
}

void asset_put(asset_bytes *out, const void *data, size_t size)
{
    if (out->failed || !size)
        return;
    if (size > out->capacity - out->size) {
        uint8_t *grown = size > SIZE_MAX - out->size
                             ? NULL
                             : list_grow(out->data, &out->capacity,
                                         out->size + size, 1);
        if (!grown) {
            out->failed = true;
            return;
        }
        out->data = grown;
    }
    memcpy(out->data + out->size, data, size);
    out->size += size;
}

void asset_printf(asset_bytes *out, const char *form, ...)
{
    char text[256];
    va_list args, again;
    va_start(args, form);
    va_copy(again, args);
    const int size = vsnprintf(text, sizeof text, form, args);
    va_end(args);
    if (size < 0) {
        out->failed = true;
    } else if ((size_t)size < sizeof text) {
        asset_put(out, text, (size_t)size);
    } else {
        char *all = malloc((size_t)size + 1);
        if (all) {
            vsnprintf(all, (size_t)size + 1, form, again);
            asset_put(out, all, (size_t)size);
        }
        out->failed |= !all;
        free(all);
    }
    va_end(again);
}

/* ---- formats ------------------------------------------------------------- */

asset_format asset_format_of(const char *path)
{
    static const struct {
        const char *name;
        asset_format format;
    } names[] = {
        { "obj", ASSET_OBJ },   { "ply", ASSET_PLY }, { "stl", ASSET_STL },
        { "off", ASSET_OFF },   { "gltf", ASSET_GLTF }, { "glb", ASSET_GLB },
        { "drc", ASSET_DRC },
    };
    const char *slash = strrchr(path, '/');
    const char *name = slash ? slash + 1 : path;
    const char *dot = strrchr(name, '.');
    const char *ending = dot ? dot + 1 : name;
    const text_word word = { ending, strlen(ending) };
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (text_equal_any_case(word, names[i].name))
            return names[i].format;
    return ASSET_UNKNOWN;
}

static bool starts_with(const uint8_t *data, size_t size, const char *magic)
{
    const size_t n = strlen(magic);
    return size >= n && memcmp(data, magic, n) == 0;
}

/* Binary STL has no magic, but its size follows from its count of faces. */
static bool is_binary_stl(const uint8_t *data, size_t size)
{
    if (size < 84)
        return false;
    const uint64_t count = (uint64_t)data[80] | (uint64_t)data[81] << 8 |
                           (uint64_t)data[82] << 16 | (uint64_t)data[83] << 24;
    return count && 84 + 50 * count == size;
}

static bool is_off_keyword(text_word word)
{
    return word.size >= 3 && word.size <= 8 &&
           memcmp(word.data + word.size - 3, "OFF", 3) == 0;
}

static asset_format sniff(const uint8_t *data, size_t size)
{
    if (starts_with(data, size, "glTF"))
        return ASSET_GLB;
    if (starts_with(data, size, "DRACO"))
        return ASSET_DRC;
    if (is_binary_stl(data, size))
        return ASSET_STL;
    text_cursor in = text_open(data, size);
    if (starts_with((const uint8_t *)in.p, text_left(&in), "ply") &&
        text_left(&in) > 3 && text_is_eol(in.p[3]))
        return ASSET_PLY;
    text_skip_space(&in);
    if (in.p < in.end && *in.p == '{')
        return ASSET_GLTF;
    while (in.p < in.end && *in.p == '#') { /* OBJ and OFF have comments */
        text_skip_line(&in);
        text_skip_space(&in);
    }
    const text_word word = text_next_word(&in);
    if (text_equal_any_case(word, "solid"))
        return ASSET_STL;
    if (is_off_keyword(word))
        return ASSET_OFF;
    static const char *const obj[] = { "v",      "vt", "vn", "f", "o", "g",
                                       "mtllib", "usemtl", "s" };
    for (size_t i = 0; i < sizeof obj / sizeof obj[0]; i++)
        if (text_equal(word, obj[i]))
            return ASSET_OBJ;
    return ASSET_UNKNOWN;
}

static bool read_as(const uint8_t *data, size_t size, asset_format format,
                    const char *path, asset *out, asset_error *error)
{
    switch (format) {
    case ASSET_OBJ: return asset_read_obj(data, size, out, error);
    case ASSET_PLY: return asset_read_ply(data, size, out, error);
    case ASSET_STL: return asset_read_stl(data, size, out, error);
    case ASSET_OFF: return asset_read_off(data, size, out, error);
    case ASSET_GLTF:
    case ASSET_GLB: return asset_read_gltf(data, size, path, out, error);
    case ASSET_DRC: return asset_read_drc(data, size, out, error);
    case ASSET_UNKNOWN: break;
    }
    return asset_fail(error, "", "not a known mesh format");
}

bool asset_read(const uint8_t *data, size_t size, asset_format format,
                const char *path, asset *out, asset_error *error)
{
    *out = (asset){ 0 };
    *error = (asset_error){ { 0 }, { 0 } };
    if (!size)
        return asset_fail(error, "", "the file is empty");
    if (format == ASSET_UNKNOWN)
        format = sniff(data, size);
    if (read_as(data, size, format, path, out, error) &&
        asset_check(out, error))
        return true;
    asset_free(out);
    return false;
}

static bool write_as(const asset *mesh, asset_format format, asset_bytes *out,
                     asset_error *error)
{
    switch (format) {
    case ASSET_OBJ: return asset_write_obj(mesh, out, error);
    case ASSET_PLY: return asset_write_ply(mesh, out, error);
    case ASSET_STL: return asset_write_stl(mesh, out, error);
    case ASSET_OFF: return asset_write_off(mesh, out, error);
    case ASSET_GLTF: return asset_write_gltf(mesh, false, out, error);
    case ASSET_GLB: return asset_write_gltf(mesh, true, out, error);
    case ASSET_DRC: return asset_write_drc(mesh, out, error);
    case ASSET_UNKNOWN: break;
    }
    return asset_fail(error, "", "not a known mesh format");
}

bool asset_write(const asset *mesh, asset_format format, asset_bytes *out,
                 asset_error *error)
{
    *error = (asset_error){ { 0 }, { 0 } };
    if (!write_as(mesh, format, out, error))
        return false;
    return !out->failed || asset_fail(error, "", "out of memory");
}
