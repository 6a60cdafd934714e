/* SPDX-License-Identifier: MIT */
/*
 * asset.h - a triangle mesh as files give it, and the table of file formats.
 *
 * Readers fill an asset, writers take one; neither knows the codec. Readers
 * treat their bytes as hostile: every count is checked against the bytes that
 * are there before memory is taken, every index before it is used.
 */
#ifndef ASSET_H
#define ASSET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "format/pmesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* `count` tuples; `indices` names the tuple of every corner (3 per face), or
 * is NULL when tuples go with positions (count == vertex_count). */
typedef struct asset_attribute {
    pmesh_attribute_kind kind;
    uint8_t set;
    uint8_t components; /* 3 for normals, 2 texcoords, 3..4 colours, 1..4 */
    uint8_t bits;       /* for baking; 0: the kind's default */
    char name[24];      /* as the file calls it, where that is no rule */
    float *values;
    size_t count;
    uint32_t *indices;
} asset_attribute;

typedef struct asset {
    double *positions; /* xyz */
    size_t vertex_count;
    bool floats; /* positions are floats: text need not tell more */
    uint32_t *indices; /* 3 per face, counter-clockwise */
    size_t face_count;
    uint32_t *materials;   /* per face, < material_count; NULL: all 0 */
    char **material_names; /* material_count strings, NULL if none is named */
    uint32_t material_count;
    asset_attribute attributes[PMESH_MAX_ATTRIBUTES];
    size_t attribute_count;
    bool texcoords_down; /* v runs down the picture, as in glTF */
    char warnings[1024]; /* lines of text: what a reader repaired or left out */
} asset;

/* Why a read or write failed: `where` is a line or byte offset in words
 * ("line 812", "byte 1204") or empty. Control characters never occur. */
typedef struct asset_error {
    char where[48];
    char what[256];
} asset_error;

typedef enum asset_format {
    ASSET_UNKNOWN,
    ASSET_OBJ,
    ASSET_PLY,
    ASSET_STL,
    ASSET_OFF,
    ASSET_GLTF,
    ASSET_GLB,
    ASSET_DRC
} asset_format;

/* From a path's ending, any case, or a bare name such as "obj". */
asset_format asset_format_of(const char *path);

/*
 * Reads a mesh from memory. `path` serves glTF's side files (looked for below
 * its folder only); NULL: none. ASSET_UNKNOWN: the bytes are looked at.
 * On failure *out is empty (nothing to free) and *error says why.
 */
bool asset_read(const uint8_t *data, size_t size, asset_format format,
                const char *path, asset *out, asset_error *error);

/* A growing block of bytes; `failed` is sticky (out of memory). */
typedef struct asset_bytes {
    uint8_t *data;
    size_t size, capacity;
    bool failed;
} asset_bytes;

/* Appends the file's bytes to `out` (binary PLY and STL, GLB with one buffer,
 * .gltf with a data URI, .drc). */
bool asset_write(const asset *mesh, asset_format format, asset_bytes *out,
                 asset_error *error);

void asset_free(asset *mesh);
void asset_bytes_free(asset_bytes *bytes);

/* ---- for readers and writers ------------------------------------------- */

/* Formats `what`, with control characters replaced; returns false. */
bool asset_fail(asset_error *error, const char *where, const char *what, ...);
void asset_warn(asset *mesh, const char *what, ...);
void asset_put(asset_bytes *out, const void *data, size_t size);
void asset_printf(asset_bytes *out, const char *form, ...);

/* Formats without locale. asset_number_parse reads a decimal float from
 * [p, end), correctly rounded, and returns the first byte behind it, or p if
 * there is no number; nan and inf are numbers. asset_number_print writes the
 * shortest text that reads back as the same double (or float) and returns its
 * length (at most 32, no terminator). */
const char *asset_number_parse(const char *p, const char *end, double *out);
size_t asset_number_print(char *dst, double value);
size_t asset_number_print_float(char *dst, float value);

bool asset_read_obj(const uint8_t *, size_t, asset *, asset_error *);
bool asset_read_ply(const uint8_t *, size_t, asset *, asset_error *);
bool asset_read_stl(const uint8_t *, size_t, asset *, asset_error *);
bool asset_read_off(const uint8_t *, size_t, asset *, asset_error *);
bool asset_read_gltf(const uint8_t *, size_t, const char *path, asset *,
                     asset_error *);
bool asset_read_drc(const uint8_t *, size_t, asset *, asset_error *);
bool asset_write_obj(const asset *, asset_bytes *, asset_error *);
bool asset_write_ply(const asset *, asset_bytes *, asset_error *);
bool asset_write_stl(const asset *, asset_bytes *, asset_error *);
bool asset_write_off(const asset *, asset_bytes *, asset_error *);
bool asset_write_gltf(const asset *, bool glb, asset_bytes *, asset_error *);
bool asset_write_drc(const asset *, asset_bytes *, asset_error *);

/* Splits a polygon of n >= 3 corners into n - 2 triangles that do not overlap
 * if it is simple (ear clipping, concave polygons included); appends corner
 * numbers 0..n-1 by threes to `out`, which holds 3 * (n - 2). */
void asset_triangulate(const double (*corners)[3], size_t n, uint32_t *out);

#ifdef __cplusplus
}
#endif
#endif
