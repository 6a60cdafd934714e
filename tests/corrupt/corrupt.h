/* SPDX-License-Identifier: MIT */
/*
 * corrupt.h - files that break one rule of SPEC.md each. They are made from
 * good files, the *bases*, field by field: all but the wrong field is as it
 * was, checksums and content hash fit.
 */
#ifndef CORRUPT_H
#define CORRUPT_H

#include "tests/reference/chunks.h"

/* ---- good files --------------------------------------------------------- */

typedef enum base_file {
    PLAIN,    /* a torus, several levels */
    FULL,     /* a sphere with normals, texture coordinates, a generic
                 attribute, materials, names; lossless, measured */
    MOVING,   /* an open mesh with colours, whose parents move */
    FACETS,   /* all corners of a vertex differ */
    JOINED,   /* sheets that meet, with materials and attributes */
    SOUP,     /* sheets that meet, bare */
    COARSE,   /* exact positions that are large on a coarse grid */
    DRACO,    /* a Draco base */
    SCENE,    /* two meshes, a document, two resources */
    BASE_FILES
} base_file;

const shape_bytes *base_bytes(base_file which);
void bases_free(void);

/* ---- what is expected --------------------------------------------------- */

/* The decoder's answer: the status, the first byte of the chunk that is to
 * blame, the rule. */
typedef struct verdict {
    pmesh_status status;
    size_t offset;
    const char *rule;
} verdict;

/* Writes the file NAME.pmesh, gives it to the decoder at once and byte by
 * byte, and compares. Frees it. */
void judge(const char *name, shape_bytes file, verdict expected);

/* For files that could not be made as they were meant. */
void complain(const char *name, const char *why);

/* ---- fields of a header ------------------------------------------------- */

typedef enum field_type { U8, U32, U64, VARINT } field_type;

typedef struct field {
    char name[32]; /* "level.2.faces" */
    field_type type;
    size_t at, size;
} field;

enum { FIELDS = 1024 };

/* Of a header of a mesh or a scene, in order; returns their number. */
int fields_of(const chunk *header, field *out);

/* Gets its value, or puts a value, or bytes, in place of a field; false if there
 * is none. */
bool field_get(const chunk *header, const char *name, uint64_t *value);
bool field_set(chunk *header, const char *name, uint64_t value);
bool field_put(chunk *header, const char *name, const void *data,
               size_t size);

/* ---- files -------------------------------------------------------------- */

/* The chunks of a base. */
chunks take_base_file(base_file which);

/* The n-th chunk of a type, from 0; of the last one there is if n < 0. */
chunk *find_chunk(chunks *c, int type, int n);

/* Where that chunk starts in the file. */
size_t chunk_offset(const chunks *c, const chunk *of);

/* Adds a chunk in front of chunk `at`. */
void insert_chunk(chunks *c, uint32_t at, chunk one);
void drop_chunk(chunks *c, chunk *one);

/* ---- the cases, a file of code for each part of SPEC.md ------------------ */

void header_cases(void);
void stream_cases(void);
void content_cases(void);
void scene_cases(void);

#endif
