/* SPDX-License-Identifier: MIT */
/*
 * pmesh.h - what encoder and decoder have in common: status codes, memory,
 * the quantisation grid, attributes, and the level table.
 *
 * A progressive mesh (Hoppe 1996) is a coarse base mesh and a sequence of
 * vertex splits that refine it to the original. A .pmesh file stores the base
 * first and the splits in levels, coarse to fine: any prefix is a mesh.
 *
 *   encoder/pmesh_encode.h   triangles -> bytes
 *   decoder/pmesh_decode.h   bytes -> triangles at any face budget
 *   SPEC.md                  every byte of the file
 *
 * Nothing here keeps global state. Distinct objects may be used from distinct
 * threads; one object by one thread at a time.
 */
#ifndef PMESH_H
#define PMESH_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define PMESH_API __attribute__((visibility("default")))
#else
#define PMESH_API
#endif

/* The library's version; the file format has a number of its own. */
#define PMESH_VERSION_MAJOR 0
#define PMESH_VERSION_MINOR 1
#define PMESH_VERSION_PATCH 0
#define PMESH_FORMAT_VERSION 0

/* Every outcome of every call. Values are pinned: append, never renumber. */
typedef enum pmesh_status {
    PMESH_OK = 0,
    PMESH_NEED_DATA = 1,     /* not an error: feed more bytes */
    PMESH_MORE = 2,          /* not an error: max_ops were used up, go on */
    PMESH_E_ARGUMENT = -1,   /* the caller broke a documented precondition */
    PMESH_E_MEMORY = -2,     /* the allocator returned NULL */
    PMESH_E_LIMIT = -3,      /* valid, but larger than the config allows */
    PMESH_E_CANCELLED = -4,  /* the progress callback asked to stop */
    PMESH_E_WRITE = -5,      /* the write callback reported a failure */
    PMESH_E_MAGIC = -10,     /* the bytes are no .pmesh file */
    PMESH_E_VERSION = -11,   /* a format version or critical chunk we lack */
    PMESH_E_CORRUPT = -12,   /* the stream breaks a MUST of SPEC.md */
    PMESH_E_CHECKSUM = -13,  /* a chunk's CRC-32C does not match */
    PMESH_E_UNSUPPORTED = -14, /* the file needs a hook that the config lacks */
    PMESH_E_NO_FACES = -20,  /* the input mesh has no usable triangle */
    PMESH_E_INDEX = -21,     /* an input index is out of range */
    PMESH_E_NOT_FINITE = -22 /* an input position in use is NaN or infinite */
} pmesh_status;

/* A short English phrase for a status, for messages; never NULL. */
PMESH_API const char *pmesh_status_text(pmesh_status status);

/* The library's version as "major.minor.patch". */
PMESH_API const char *pmesh_version(void);

/*
 * Memory hook. `alloc` returns `size` bytes aligned for any object, or NULL;
 * `release` gets the same pointer and size back (never NULL). Both fields NULL
 * stands for malloc and free.
 */
typedef struct pmesh_allocator {
    void *(*alloc)(void *user, size_t size);
    void (*release)(void *user, void *ptr, size_t size);
    void *user;
} pmesh_allocator;

/*
 * The quantisation grid of a file: cubic cells, so that no axis is favoured.
 * A grid point (x, y, z) stands for origin + step * (x, y, z) in model units;
 * coordinates are 0 .. 2^bits - 1.
 */
typedef struct pmesh_grid {
    double origin[3];
    double step;  /* > 0 */
    uint8_t bits; /* 4 .. 24 */
} pmesh_grid;

/* What an attribute means; decides its default precision and quantiser. */
typedef enum pmesh_attribute_kind {
    PMESH_NORMAL = 0,   /* unit vector, octahedral, 2 coded components */
    PMESH_TEXCOORD = 1, /* 2 components, uniform over their range */
    PMESH_COLOR = 2,    /* 3 or 4 components in 0 .. 1 */
    PMESH_GENERIC = 3   /* 1 .. 4 components, uniform over their range */
} pmesh_attribute_kind;

#define PMESH_MAX_ATTRIBUTES 8
#define PMESH_MAX_COMPONENTS 4
#define PMESH_MAX_LEVELS 64

/*
 * One attribute channel of a file. A coded integer q of component i stands for
 * minimum[i] + q * scale[i]; normals ignore both (SPEC 7).
 */
typedef struct pmesh_attribute {
    pmesh_attribute_kind kind;
    uint8_t set;        /* TEXCOORD_<set>, COLOR_<set>; 0 for normals */
    uint8_t components; /* of the dequantised value: 3 for normals */
    uint8_t bits;       /* per coded component, 4 .. 16 */
    float minimum[PMESH_MAX_COMPONENTS];
    float scale[PMESH_MAX_COMPONENTS];
} pmesh_attribute;

/* One row of the level table: what is there once `bytes` have arrived. */
typedef struct pmesh_level {
    uint64_t bytes;         /* from the start of the file */
    uint32_t faces;
    uint32_t mesh_vertices; /* distinct positions */
    uint32_t vertices;      /* output vertices: position and attributes */
    float error;            /* bound: no vertex of the full mesh, as it lies on
                               the grid, is further from this level's surface;
                               pieces that have vanished do not count. Model
                               units, never rises, 0 at the last */
    float inflation;        /* share of its height over its neighbours by which
                               a vertex may be moved out for display; 0 at the
                               last (SPEC 7.1) */
    float rms, furthest;    /* of a measured file: distance to the full mesh, at
                               points spread evenly over both, each to the other
                               surface: root mean square and largest; model
                               units, up to 1/16 grid step too much. Else 0 */
} pmesh_level;

/* The same of a scene (pmesh_scene.h): what is there once `bytes` have come. */
typedef struct pmesh_scene_level {
    uint64_t bytes;    /* from the start of the file */
    uint64_t faces;
    uint64_t vertices; /* output vertices */
    float error;       /* world units, never rising from row to row */
} pmesh_scene_level;

/* How the document of a scene is stored; the libraries see bytes only. */
typedef enum pmesh_document_form {
    PMESH_DOCUMENT_PLAIN = 0,
    PMESH_DOCUMENT_ZLIB = 1 /* RFC 1950 */
} pmesh_document_form;

typedef enum pmesh_profile {
    PMESH_COMPACT = 0,  /* smallest complete file; bakes twice as long, as the
                           better of two ways is kept */
    PMESH_BALANCED = 1, /* default: small file, good coarse levels */
    PMESH_QUALITY = 2   /* best levels */
} pmesh_profile;

typedef enum pmesh_placement {
    PMESH_SUBSET = 0, /* every level's vertices are vertices of the input */
    PMESH_OPTIMAL = 1 /* vertices move to where the error is least */
} pmesh_placement;

typedef enum pmesh_metric {
    PMESH_MEMORYLESS = 0, /* quadrics of the current surface: most accurate */
    PMESH_ACCUMULATED = 1 /* quadrics summed from the original (1997): planes
                             count once for each corner that went into a
                             vertex, up to three times */
} pmesh_metric;

/* Who codes the shape of the base mesh. Attributes are coded by ourselves in
 * both cases. */
typedef enum pmesh_base_coder {
    PMESH_BASE_NATIVE = 0, /* default: the libraries do */
    PMESH_BASE_DRACO = 1   /* Draco, which encoder and decoder reach by hooks */
} pmesh_base_coder;

/*
 * Hook: decodes a Draco buffer that holds a base mesh. Fills 3 coordinates in
 * `positions` for each of `vertex_count` points and 3 point numbers in
 * `indices` for each of `face_count` faces, in Draco's order of both. The
 * bytes come from a file and are hostile; the answer is checked, too.
 *
 * Returns PMESH_OK, or PMESH_E_MEMORY; any other status says that the bytes
 * are no such mesh.
 */
typedef pmesh_status (*pmesh_base_decode)(void *user, const void *data,
                                          size_t size, uint32_t vertex_count,
                                          uint32_t face_count,
                                          int32_t *positions,
                                          uint32_t *indices);

#ifdef __cplusplus
}
#endif
#endif
