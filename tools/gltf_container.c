/* SPDX-License-Identifier: MIT */
/* gltf_container.c - the JSON text and the BIN chunk of a glTF or GLB file. */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "tools/gltf.h"

#define CHUNK_JSON 0x4E4F534Au
#define CHUNK_BIN 0x004E4942u

static uint32_t get_u32(const uint8_t *p)
{
    return p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 |
           (uint32_t)p[3] << 24;
}

static bool fail_at(asset_error *error, size_t offset, const char *what)
{
    char where[48];
    snprintf(where, sizeof where, "byte %zu", offset);
    return asset_fail(error, where, "%s", what);
}

/* Whether the text nests deeper than parsers with a stack can bear, or has an
 * object with so many members that looking for each takes too long. Strings are
 * skipped; the text need not be valid JSON. Counts values: one behind each comma
 * and one at the start of each list or object, unless that is empty. */
static bool fits_parsers(gltf_source *source, asset_error *error)
{
    const char *text = source->json;
    const size_t size = source->json_size;
    size_t room[GLTF_MAX_DEPTH + 1]; /* for members, by depth */
    size_t depth = 0;
    bool quoted = false;

    source->json_values = 1;
    for (size_t i = 0; i < size; i++) {
        const char c = text[i];
        source->json_values += !quoted && (c == ',' || c == '[' || c == '{');
        if (quoted) {
            if (c == '\\')
                i++;
            else if (c == '"')
                quoted = false;
        } else if (c == '"') {
            quoted = true;
        } else if (c == '[' || c == '{') {
            if (++depth > GLTF_MAX_DEPTH)
                return asset_fail(error, "",
                                  "JSON is nested deeper than %d levels",
                                  GLTF_MAX_DEPTH);
            room[depth] = c == '{' ? GLTF_MAX_MEMBERS : SIZE_MAX;
        } else if (c == ',' && depth > 0) {
            if (--room[depth] == 0)
                return asset_fail(error, "",
                                  "a JSON object has more than %d members",
                                  GLTF_MAX_MEMBERS);
        } else if ((c == ']' || c == '}') && depth > 0) {
            depth--;
        }
    }
    return true;
}

static bool open_chunks(const uint8_t *data, size_t length, gltf_source *out,
                        asset_error *error)
{
    size_t at = 12;

    while (length - at >= 8) {
        const size_t size = get_u32(data + at);
        const uint32_t type = get_u32(data + at + 4);
        if (size > length - at - 8)
            return fail_at(error, at, "a GLB chunk is longer than the file");
        const uint8_t *body = data + at + 8;
        if (at == 12 && type != CHUNK_JSON)
            return fail_at(error, at, "the first GLB chunk is not JSON");
        if (at == 12) {
            out->json = (const char *)body;
            out->json_size = size;
        } else if (type == CHUNK_BIN && !out->bin) {
            out->bin = body;
            out->bin_size = size;
        }
        at += 8 + size;
    }
    if (!out->json)
        return fail_at(error, at, "the GLB file ends before its JSON chunk");
    if (at != length)
        return fail_at(error, at, "the GLB file ends inside a chunk header");
    return true;
}

static bool open_glb(const uint8_t *data, size_t size, gltf_source *out,
                     asset *warnings, asset_error *error)
{
    if (size < 12)
        return fail_at(error, size, "the GLB header is cut off");
    const uint32_t version = get_u32(data + 4);
    const uint32_t length = get_u32(data + 8);
    if (version != 2)
        return asset_fail(error, "byte 4", "GLB version %u is not supported",
                          (unsigned)version);
    if (length > size)
        return asset_fail(error, "byte 8",
                          "the GLB file is cut off: %zu of %u bytes", size,
                          (unsigned)length);
    if (length < 12)
        return fail_at(error, 8, "the GLB length is shorter than its header");
    if (length < size)
        asset_warn(warnings, "%zu bytes after the end of the GLB are ignored",
                   size - length);
    if (!open_chunks(data, length, out, error))
        return false;

    /* Some writers pad with NUL instead of spaces. */
    while (out->json_size > 0 && out->json[out->json_size - 1] == '\0')
        out->json_size--;
    return true;
}

bool gltf_open(const uint8_t *data, size_t size, gltf_source *out,
               asset *warnings, asset_error *error)
{
    static const uint8_t bom[3] = { 0xEF, 0xBB, 0xBF };

    out->file_size = size;
    if (size == 0)
        return asset_fail(error, "", "the file is empty");
    if (size >= 4 && memcmp(data, "glTF", 4) == 0) {
        if (!open_glb(data, size, out, warnings, error))
            return false;
    } else {
        out->json = (const char *)data;
        out->json_size = size;
    }
    if (out->json_size >= sizeof bom &&
        memcmp(out->json, bom, sizeof bom) == 0) {
        out->json += sizeof bom;
        out->json_size -= sizeof bom;
    }

    size_t start = 0;
    while (start < out->json_size && strchr(" \t\r\n", out->json[start]) &&
           out->json[start] != '\0')
        start++;
    if (start == out->json_size || out->json[start] != '{')
        return asset_fail(error, "", "neither a GLB nor a JSON object");
    return fits_parsers(out, error);
}
