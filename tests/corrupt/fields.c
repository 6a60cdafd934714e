/* SPDX-License-Identifier: MIT */
/* The fields of headers by name, as SPEC 5.3 and 11.2 list them. */
#include "tests/corrupt/corrupt.h"

#include <stdio.h>
#include <string.h>

enum { SCENE_CHUNK = 8, NORMAL = 0 };

typedef struct walk {
    const uint8_t *data;
    size_t at;
    field *out;
    int count;
} walk;

/* The value of the next field, of which u32 may be a float. */
static uint64_t take(walk *w, field_type type, const char *name)
{
    static const size_t sizes[] = { 1, 4, 8 };
    field *f = &w->out[w->count++];
    uint64_t value = 0;
    snprintf(f->name, sizeof f->name, "%s", name);
    f->type = type;
    f->at = w->at;
    if (type == VARINT)
        while (w->data[w->at++] >= 128)
            ;
    else
        w->at += sizes[type];
    f->size = w->at - f->at;
    for (size_t i = f->size; i-- > 0;)
        value = type == VARINT
                    ? value << 7 | (w->data[f->at + i] & 127u)
                    : value << 8 | w->data[f->at + i];
    return value;
}

/* "level.2.faces" */
static uint64_t take_of(walk *w, field_type type, const char *list, uint64_t i,
                        const char *name)
{
    char full[32];
    snprintf(full, sizeof full, "%s.%u%s%s", list, (unsigned)i % 100000,
             *name ? "." : "", name);
    return take(w, type, full);
}

static void take_attribute(walk *w, uint64_t i)
{
    const uint64_t kind = take_of(w, U8, "attribute", i, "kind");
    take_of(w, U8, "attribute", i, "set");
    const uint64_t components = take_of(w, U8, "attribute", i, "components");
    take_of(w, U8, "attribute", i, "bits");
    for (uint64_t k = 0; kind != NORMAL && k < components; k++) {
        take_of(w, U32, "attribute", i, "minimum");
        take_of(w, U32, "attribute", i, "scale");
    }
}

static void take_mesh_header(walk *w)
{
    static const char *const limits[] = { "material_count", "chunk_size",
                                          "block_splits",   "block_wedges",
                                          "moved_corners",  "names_size" };
    const uint64_t modes = (take(w, U8, "version"),
                            take(w, U64, "content_hash"),
                            take(w, U8, "modes"));
    take(w, U8, "position_bits");
    for (uint64_t i = 0; i < 3; i++)
        take_of(w, U64, "origin", i, "");
    take(w, U64, "step");
    for (uint64_t i = 0; i < 3; i++)
        take_of(w, VARINT, "bounds", i, "");
    for (size_t i = 0; i < sizeof limits / sizeof *limits; i++)
        take(w, VARINT, limits[i]);
    if (modes & 32) {
        take(w, VARINT, "base_fans");
        take(w, VARINT, "block_faces");
    }
    if (modes & 16) {
        take(w, VARINT, "exact_size");
        for (uint64_t i = 0; i < 3; i++) {
            take_of(w, U8, "form", i, "digits");
            take_of(w, U8, "form", i, "decimals");
        }
    }
    const uint64_t attributes = take(w, U8, "attribute_count");
    for (uint64_t i = 0; i < attributes; i++)
        take_attribute(w, i);
    const uint64_t levels = take(w, U8, "level_count");
    for (uint64_t i = 0; i < levels; i++) {
        take_of(w, VARINT, "level", i, "bytes");
        take_of(w, VARINT, "level", i, "faces");
        take_of(w, VARINT, "level", i, "vertices");
        if (attributes > 0)
            take_of(w, VARINT, "level", i, "wedges");
        take_of(w, U32, "level", i, "error");
        take_of(w, U8, "level", i, "inflation");
        if (modes & 64) {
            take_of(w, VARINT, "level", i, "rms");
            take_of(w, VARINT, "level", i, "most");
        }
    }
}

static void take_scene_header(walk *w)
{
    take(w, U8, "version");
    take(w, U64, "content_hash");
    take(w, VARINT, "chunk_size");
    take(w, U8, "document_form");
    take(w, VARINT, "document_size");
    const uint64_t meshes = take(w, VARINT, "mesh_count");
    const uint64_t resources = take(w, VARINT, "resource_count");
    const uint64_t levels = take(w, U8, "level_count");
    for (uint64_t i = 0; i < levels; i++) {
        take_of(w, VARINT, "level", i, "bytes");
        take_of(w, VARINT, "level", i, "faces");
        take_of(w, VARINT, "level", i, "vertices");
        take_of(w, U32, "level", i, "error");
    }
    for (uint64_t i = 0; i < meshes; i++) {
        take_of(w, VARINT, "mesh", i, "size");
        take_of(w, U32, "mesh", i, "scale");
    }
    for (uint64_t i = 0; i < resources; i++)
        take_of(w, VARINT, "resource", i, "");
}

int fields_of(const chunk *header, field *out)
{
    walk w = { header->data, 0, out, 0 };
    if (header->type == SCENE_CHUNK)
        take_scene_header(&w);
    else
        take_mesh_header(&w);
    return w.at == header->size ? w.count : 0;
}

static bool find_field(const chunk *header, const char *name, field *out)
{
    static field all[FIELDS];
    const int count = fields_of(header, all);
    for (int i = 0; i < count; i++)
        if (!strcmp(all[i].name, name)) {
            *out = all[i];
            return true;
        }
    return false;
}

bool field_get(const chunk *header, const char *name, uint64_t *value)
{
    field f;
    if (!find_field(header, name, &f))
        return false;
    *value = 0;
    for (size_t i = f.size; i-- > 0;)
        *value = f.type == VARINT
                     ? *value << 7 | (header->data[f.at + i] & 127u)
                     : *value << 8 | header->data[f.at + i];
    return true;
}

bool field_put(chunk *header, const char *name, const void *data, size_t size)
{
    field f;
    if (!find_field(header, name, &f))
        return false;
    uint8_t *at = header->data + f.at;
    memmove(at + size, at + f.size, header->size - f.at - f.size);
    memcpy(at, data, size);
    header->size += size - f.size;
    return true;
}

bool field_set(chunk *header, const char *name, uint64_t value)
{
    field f;
    uint8_t bytes[10];
    size_t size = 0;
    if (!find_field(header, name, &f))
        return false;
    if (f.type == VARINT) {
        for (; value >= 128; value /= 128)
            bytes[size++] = (uint8_t)(value % 128 + 128);
        bytes[size++] = (uint8_t)value;
    } else {
        for (; size < f.size; size++)
            bytes[size] = (uint8_t)(value >> (8 * size));
    }
    return field_put(header, name, bytes, size);
}
