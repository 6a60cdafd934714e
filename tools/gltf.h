/* SPDX-License-Identifier: MIT */
/*
 * gltf.h - the parts of the glTF reader, in the order they run:
 *
 *   gltf_container.c  bytes -> JSON text and BIN chunk
 *   gltf_plain.cpp    JSON -> a plain document: only what geometry needs, every
 *                     number checked, compressed data expanded
 *                     (gltf_uri.c: buffers; gltf_inflate.cpp: compression)
 *   io_gltf.cpp       plain document -> gltf_model, by tinygltf
 *   gltf_accessor.c   accessors -> numbers
 *   gltf_scene.c      node tree -> instances with world matrices
 *   gltf_survey.c     instances -> counts, channels, materials
 *   gltf_merge.c      instances -> one mesh
 *   gltf_faces.c      triangles of a primitive, and the vertices they name
 *
 * or, for scenes, with everything that a primitive has:
 *
 *   gltf_channels.c   a mesh -> the channels that carry it
 *   gltf_mesh.c       a mesh -> an asset, in its own space
 *   gltf_document.cpp what is no geometry -> document and resources
 *
 * Private to these files. Everything here may meet hostile input.
 */
#ifndef GLTF_H
#define GLTF_H

#include "tools/asset.h"

#ifdef __cplusplus
extern "C" {
#endif

#define GLTF_NONE UINT32_MAX
#define GLTF_MAX_DEPTH 64 /* of nested JSON values */
#define GLTF_MAX_MEMBERS 4096 /* of a JSON object */
#define GLTF_MAX_FACES ((uint64_t)1 << 27)
#define GLTF_MAX_DOCUMENT ((uint64_t)1 << 28) /* of a scene, unpacked */

/* Slots of a primitive: NORMAL, TEXCOORD_0..7, COLOR_0..7. */
#define GLTF_SETS 8
#define GLTF_NORMAL 0
#define GLTF_TEXCOORD 1
#define GLTF_COLOR (GLTF_TEXCOORD + GLTF_SETS)
#define GLTF_SLOTS (GLTF_COLOR + GLTF_SETS)

/* The slot of a semantic such as "TEXCOORD_1", or -1. */
int gltf_slot(const char *semantic);

/* The file's bytes and where they came from. */
typedef struct gltf_source {
    const char *json;
    size_t json_size;
    uint64_t json_values; /* in the text, at most */
    const uint8_t *bin; /* GLB's BIN chunk, or NULL */
    size_t bin_size;
    size_t file_size;
    const char *path; /* or NULL: no side files */
    bool everything;  /* all attributes and morph targets, in `sets`; else only
                         what the merge takes */
    bool leave_images; /* those in files stay there */
} gltf_source;

/* Finds the JSON text; `warnings` takes what is odd but harmless. Nesting
 * beyond GLTF_MAX_DEPTH fails, so later stages may recurse over values, and so
 * do objects with more than GLTF_MAX_MEMBERS, which those that keep their
 * members in order search one by one. */
bool gltf_open(const uint8_t *data, size_t size, gltf_source *out,
               asset *warnings, asset_error *error);

/*
 * How many bytes a buffer's URI offers, and the first `size` of them. Only
 * base64 data URIs and relative paths that stay below the asset's folder are
 * read; the file must be a regular one.
 */
bool gltf_uri_size(const gltf_source *source, const char *uri, size_t length,
                   uint64_t *size, asset_error *error);
bool gltf_uri_read(const gltf_source *source, const char *uri, size_t length,
                   uint8_t *dst, uint64_t size, asset_error *error);

/* The path that a URI means below the asset's folder, at most as long as it is;
 * false if it means anything else. */
bool gltf_uri_path(const char *uri, size_t length, char *path);

/*
 * Bytes that one file may still expand to: compressed views, sparse accessors,
 * elements without data. Starts at 64 MiB and 256 times the file's size, so
 * that a small file that lies cannot take much memory.
 */
typedef struct gltf_budget {
    uint64_t left;
} gltf_budget;

gltf_budget gltf_budget_for(uint64_t file_size);

/* Whether a document of a scene, opened, may be stored in so few bytes: those
 * who read it expand it to its text and 64 bytes a value. */
bool gltf_fits_stored(const gltf_source *document, uint64_t stored);

/* Takes count * size bytes; false (and nothing taken) if they are not left. */
bool gltf_spend(gltf_budget *budget, uint64_t count, uint64_t size);

enum {
    GLTF_I8 = 5120,
    GLTF_U8 = 5121,
    GLTF_I16 = 5122,
    GLTF_U16 = 5123,
    GLTF_U32 = 5125,
    GLTF_F32 = 5126
};

typedef struct gltf_view {
    const uint8_t *data; /* NULL: no view */
    uint64_t size;
} gltf_view;

typedef struct gltf_accessor {
    uint32_t number; /* in the file, for messages */
    gltf_view view; /* from the accessor's first byte to the view's end */
    uint64_t count;
    uint32_t stride;
    uint32_t type; /* GLTF_F32, ... */
    uint8_t components;
    bool normalised;
    uint64_t sparse_count; /* 0: dense */
    uint32_t sparse_type;  /* of the indices */
    gltf_view sparse_indices, sparse_values;
    uint8_t *expanded; /* owned: what `view` shows after expansion, or NULL */
} gltf_accessor;

/* An attribute by its semantic. */
typedef struct gltf_named {
    const char *semantic;
    uint32_t accessor;
} gltf_named;

typedef struct gltf_set {
    size_t first, count; /* of named */
} gltf_set;

typedef struct gltf_primitive {
    uint32_t mode; /* 4 triangles, 5 strip, 6 fan */
    uint32_t position, indices, material;
    uint32_t slots[GLTF_SLOTS]; /* accessors, or GLTF_NONE */
    size_t first_set, set_count; /* attributes, then each morph target */
} gltf_primitive;

typedef struct gltf_mesh {
    size_t first, count; /* of primitives */
} gltf_mesh;

typedef struct gltf_node {
    uint32_t mesh;
    size_t first, count; /* of children */
    bool has_matrix;
    double matrix[16]; /* column by column */
    double translation[3], rotation[4], scale[3];
} gltf_node;

/* References are in range; what they mean is checked by the C stages. */
typedef struct gltf_model {
    gltf_accessor *accessors;
    gltf_primitive *primitives;
    gltf_mesh *meshes;
    gltf_node *nodes;
    gltf_named *named;
    gltf_set *sets;
    uint32_t *children, *roots;
    const char **materials; /* names; empty: unnamed */
    size_t accessor_count, primitive_count, mesh_count, node_count;
    size_t root_count, material_count;
    uint64_t byte_count; /* of the file and the buffers beside it */
    void *owner;         /* the bridge's: holds the arrays and the buffers */
} gltf_model;

/* The bridge: parse, check, expand, load. On failure nothing is to be freed. */
bool gltf_load(const gltf_source *source, gltf_budget *budget, gltf_model *out,
               asset *warnings, asset_error *error);
void gltf_unload(gltf_model *model);

/* Checks one accessor against its views and applies its sparse part; from then
 * on gltf_get() and gltf_index() are safe for every element. */
bool gltf_accessor_prepare(gltf_accessor *accessor, gltf_budget *budget,
                           asset_error *error);

/* Element `i` as real numbers, `components` of them. */
void gltf_get(const gltf_accessor *accessor, uint64_t i, double out[4]);

/* Elements which[0], ... which[n - 1], one behind the other. */
void gltf_gather(const gltf_accessor *accessor, const uint32_t *which, size_t n,
                 double *out);

/* Elements first, ... first + n - 1 of a prepared scalar accessor of unsigned
 * integers; the return value is the largest, 0 if there is none. */
uint32_t gltf_indices(const gltf_accessor *accessor, uint64_t first, size_t n,
                      uint32_t *out);

/* A mesh in the world: x' = m[0] x + m[1] y + m[2] z + m[3], and so on. */
typedef struct gltf_instance {
    double m[12];
    uint32_t mesh;
} gltf_instance;

/* Walks the scene; `*out` is malloc'ed, in document order. */
bool gltf_scene_walk(const gltf_model *model, gltf_instance **out,
                     size_t *count, asset_error *error);

/* Checks what a primitive's faces refer to, and counts them. */
bool gltf_face_count(const gltf_model *model, const gltf_primitive *p,
                     const char *where, uint64_t *faces, asset_error *error);

/* The vertices of each face, below the count of its positions. Triangles that
 * only join the parts of a strip are left out: *faces may be less than the room,
 * which is for all that gltf_face_count() counts. */
bool gltf_faces(const gltf_model *model, const gltf_primitive *p,
                const char *where, uint32_t *out, size_t *faces,
                asset_error *error);

/* Numbers vertices in the order in which faces name them. */
typedef struct gltf_order {
    uint32_t *numbers;  /* by a primitive's vertex: 1 + its number, or 0 */
    uint32_t *vertices; /* the primitive's, by number - first */
} gltf_order;

/* For primitives of so many vertices at most. False if memory is short: what
 * there is is to be freed then, too. */
bool gltf_order_make(gltf_order *order, uint64_t largest);
void gltf_order_free(gltf_order *order);

/* Replaces a primitive's vertices in `corners` by numbers from `first` up and
 * returns how many vertices there are. What primitives before it have left in
 * `numbers` is not above `first`. */
size_t gltf_renumber(gltf_order *order, uint32_t first, uint32_t *corners,
                     size_t n);

/* Takes the positions of vertices[0 .. n); *where names the primitive. */
bool gltf_positions(const gltf_accessor *position, const uint32_t *vertices,
                    size_t n, const char *where, double *out,
                    asset_error *error);
bool gltf_fail_position(const char *where, uint32_t vertex, asset_error *error);

/* What the scene comes to. */
typedef struct gltf_plan {
    uint64_t faces;
    uint64_t vertex_bound; /* vertices at most */
    uint64_t largest;      /* vertex count of a primitive */
    uint8_t channel_slots[PMESH_MAX_ATTRIBUTES]; /* by asset attribute */
    uint32_t *materials; /* new index by old one, the last for "none" */
} gltf_plan;

/* Counts, checks, and gives *out its attributes (without values) and material
 * names; plan->materials is the caller's to free, on failure too. */
bool gltf_survey(const gltf_model *model, const gltf_instance *instances,
                 size_t count, gltf_plan *plan, asset *out,
                 asset_error *error);

/* The accessor of a slot, or NULL if there is none that fits its meaning. */
const gltf_accessor *gltf_slot_accessor(const gltf_model *model,
                                        const gltf_primitive *p,
                                        unsigned slot);

/* Fills the empty asset from prepared accessors. */
bool gltf_merge(const gltf_model *model, const gltf_instance *instances,
                size_t instance_count, asset *out, asset_error *error);

/* ---- scenes: one asset for each mesh ------------------------------------ */

/* What carries an attribute, or a morph target's, of a mesh's primitives. */
typedef struct gltf_channel {
    const char *semantic;
    uint32_t set; /* 0: attributes, k: morph target k - 1 */
    pmesh_attribute_kind kind;
    uint8_t number, components;
    uint8_t bits; /* 0: what the user asked for the kind */
    bool exact;   /* whole numbers, which come back by rounding */
} gltf_channel;

typedef struct gltf_channels {
    gltf_channel item[PMESH_MAX_ATTRIBUTES];
    size_t count;
    bool fits; /* false: there are too many for morph targets to be kept */
} gltf_channels;

/* Whether a primitive's faces can be coded: triangles with positions. All that
 * a model holds are triangles. */
bool gltf_is_coded(const gltf_primitive *p);

/* Finds the channels of a mesh, the most needed first; warns of what is left
 * out. Fails if primitives that share elements make it look at more of them
 * than the budget has bytes. */
bool gltf_channels_of(const gltf_model *model, const gltf_mesh *mesh,
                      const char *name, gltf_budget *budget, gltf_channels *out,
                      asset *warnings, asset_error *error);

/* A primitive's accessor for a channel; NULL: it has none that fits. */
const gltf_accessor *gltf_channel_accessor(const gltf_model *model,
                                           const gltf_primitive *p,
                                           const gltf_channel *channel);

/*
 * A mesh in its own space; faces of coded primitive k have material k. Fails
 * also if the mesh has no face at all: *empty tells. `bits` of the attributes
 * are those of the channels. What it takes is taken from the budget, for meshes
 * may share accessors.
 */
bool gltf_mesh_asset(const gltf_model *model, const gltf_mesh *mesh,
                     const gltf_channels *channels, gltf_budget *budget,
                     asset *out, bool *empty, asset_error *error);

#ifdef __cplusplus
}
#endif
#endif
