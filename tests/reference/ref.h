/* SPDX-License-Identifier: MIT */
/*
 * ref.h - a second decoder of .pmesh files, written from SPEC.md alone and in
 * its order. It shares nothing with format/, decoder/ and encoder/: where the
 * two agree, SPEC.md says what the library does.
 *
 * Straightforward, not fast: arrays that grow, rings walked again and again,
 * 64-bit numbers everywhere. Names are those of SPEC.md.
 */
#ifndef REF_H
#define REF_H

#include <setjmp.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tests/reference/ref_seen.h"

#define REF_NONE UINT32_MAX

enum {
    REF_MEMBERS = 48, /* of a ring that may split, the ghost included */
    REF_ROOM = 64,    /* more than the faces of any fan after a split */
    REF_FANS = 48,    /* of a vertex */
    REF_PARTS = 24,   /* fans of a vertex that may split */
    REF_LONE = 16,    /* lone faces of a split, and pairs of them */
    REF_CORNERS = 192, /* more than a split changes of one vertex */
    REF_ATTRIBUTES = 8,
    REF_COMPONENTS = 4,
    REF_VALUES = REF_ATTRIBUTES * REF_COMPONENTS,
    REF_LEVELS = 64,
    REF_TERMS = 7 /* of the prediction */
};

/* ---- 6.1 entropy coding ------------------------------------------------- */

typedef struct ref_model {
    int32_t p, uses; /* p in 1/2^22 */
} ref_model;

typedef struct ref_number {
    ref_model length[32], top[32][3];
} ref_number;

/* Makes a stream instead of reading one: what is read is what choose() says.
 * `given` is what the payload says, as long as it was followed. */
typedef struct ref_author {
    int (*choose)(void *user, const ref_model *m, int given); /* raw: no m */
    uint32_t (*pick)(void *user, uint32_t cells, uint32_t given);
    void *user;
    uint8_t *data;
    size_t size, room;
    uint64_t low;
} ref_author;

typedef struct ref_coder {
    const uint8_t *next, *end;
    uint64_t range, code;
    ref_author *author; /* NULL: none */
} ref_coder;

/* Entry 0 of a table, or none, is a fresh model. */
void ref_model_start(ref_model *m, size_t count);
void ref_model_load(ref_model *m, int entry);
void ref_number_start(ref_number *n);
void ref_coder_start(ref_coder *c, const uint8_t *data, const uint8_t *end);
int ref_bit(ref_coder *c, ref_model *m);
int ref_bit2(ref_coder *c, ref_model *m, ref_model *n);
uint64_t ref_raw(ref_coder *c, int bits);
uint64_t ref_read_number(ref_coder *c, ref_number *n);
uint64_t ref_uniform(ref_coder *c, uint64_t n);
void ref_author_end(ref_author *a);             /* the last bytes */

/* ---- integers (2) ------------------------------------------------------- */

typedef struct ref_vec {
    int64_t c[3];
} ref_vec;

int ref_bits(uint64_t x);
int64_t ref_shift(int64_t a, int n); /* a >> n */
int64_t ref_scale(int64_t a, int s);
int64_t ref_within(int64_t a, int64_t limit);
int64_t ref_clamp(int64_t a, int64_t low, int64_t high);
ref_vec ref_add(ref_vec a, ref_vec b);
ref_vec ref_sub(ref_vec a, ref_vec b);
ref_vec ref_times(ref_vec a, int64_t k);
ref_vec ref_over(ref_vec a, int64_t k); /* a / k */
ref_vec ref_vshift(ref_vec a, int n);
ref_vec ref_vscale(ref_vec a, int s);
ref_vec ref_vwithin(ref_vec a, int64_t limit);
ref_vec ref_cross(ref_vec a, ref_vec b);
int64_t ref_dot(ref_vec a, ref_vec b);
uint64_t ref_or(ref_vec a); /* of the absolute coordinates */

/* ---- 5.3 header --------------------------------------------------------- */

typedef struct ref_attribute {
    int kind, set, components, bits, coded;
    float minimum[REF_COMPONENTS], scale[REF_COMPONENTS];
} ref_attribute;

typedef struct ref_level {
    uint64_t bytes, faces, vertices, wedges;
    float error;
    int inflation; /* in 1/256 */
    uint64_t rms, most; /* measured */
} ref_level;

typedef struct ref_form {
    int radix, digits, decimals;
} ref_form;

typedef struct ref_header {
    uint64_t content_hash;
    int profile, position_bits;
    bool moving, draco, lossless, joined, measured;
    double origin[3], step;
    int64_t bounds[3];
    uint64_t material_count, chunk_size, block_splits, block_wedges,
        moved_corners, names_size, exact_size, base_fans, block_faces;
    ref_form form[3];
    int attribute_count;
    ref_attribute attribute[REF_ATTRIBUTES];
    int value_count, value_bits[REF_VALUES];
    int level_count;
    ref_level level[REF_LEVELS];
} ref_header;

/* ---- the mesh (3) ------------------------------------------------------- */

enum { REF_UNVISITED, REF_KEPT, REF_PARENT, REF_NEWBORN, REF_GHOST };

typedef struct ref_vertex {
    ref_vec at, born; /* now, and when it was new */
    uint32_t first, parent;
    int more; /* fans but the first, and where they start */
    uint32_t later[REF_FANS - 1];
    uint32_t point; /* while the base is read, each is a fan: its vertex */
    int state;
    float exact[3];
} ref_vertex;

/* Half-edge h, and the corner that it starts at. */
typedef struct ref_edge {
    uint32_t vertex, twin, wedge;
} ref_edge;

typedef struct ref_wedge {
    uint32_t from;   /* the wedge it comes from */
    uint32_t corner; /* that it was made for */
    uint32_t vertex;
    uint16_t value[REF_VALUES];
} ref_wedge;

/* Split of vertex base + i, in the order of the vertices. */
typedef struct ref_split {
    uint32_t parent;
    uint32_t first_face, face_end, wedge_end;
    int64_t key;           /* 6.7 */
    ref_vec before, after; /* the parent's position */
} ref_split;

typedef struct ref_ring {
    int count; /* neighbours; one more than REF_MEMBERS stands for many */
    int faces;
    bool open, large;
    uint32_t edge[REF_ROOM];   /* of face i: from the vertex to neighbour i */
    uint32_t vertex[REF_ROOM]; /* neighbour i */
} ref_ring;

/* Of the base while it grows: the half-edges that start at a vertex. */
typedef struct ref_edge_list {
    uint32_t *next, *head; /* per half-edge, per vertex */
    size_t next_room, head_room;
} ref_edge_list;

/* ---- models ------------------------------------------------------------- */

typedef struct ref_base_models {
    ref_model boundary, known, neighbour[2], sign;
    ref_number vertex, position;
} ref_base_models;

typedef struct ref_cut_models {
    int32_t shape[3][2][2], reach[2][2], span[2][14][10], degree[12][2],
        state[5][5][5][2];
    ref_model rank[2][4][32];
} ref_cut_models;

/* The weights of one kind, class and unknown; [0] along, [1] across. */
typedef struct ref_fit {
    int64_t w[2][REF_TERMS], start[2][REF_TERMS];
    int64_t m[2][REF_TERMS][REF_TERMS], b[2][REF_TERMS], samples[2];
} ref_fit;

typedef struct ref_expected {
    int64_t value, uses;
} ref_expected;

typedef struct ref_cell {
    ref_model zero[3], sign[3], unary[14];
} ref_cell;

/* Of children, or of moved parents. */
typedef struct ref_residual_models {
    ref_expected along[9][3][5], across[14][3];
    ref_cell any[60], here[60][3][4];
    ref_model low[60][3];
    ref_number escape;
} ref_residual_models;

typedef struct ref_join_models {
    ref_model whole[3], moves[2][3], lone[3], pair, turned, far, known;
    ref_number member, back;
} ref_join_models;

typedef struct ref_wedge_models {
    ref_model material[3], ordinary[3], seam[3][3], corner[4][3][3], choice[2];
    ref_number pick;
} ref_wedge_models;

/* Of a component. */
typedef struct ref_value_models {
    ref_cell here[40];
    ref_expected by_spread[5][32], by_far[5][5];
    ref_fit fit[3]; /* [0] of each alone */
} ref_value_models;

/* Of an attribute. */
typedef struct ref_channel_models {
    ref_cell any[40];
    ref_model low[40][3], differs[3][3];
    ref_number escape;
} ref_channel_models;

typedef struct ref_exact_models {
    ref_model same[3][2][16], rare[3];
} ref_exact_models;

/* ---- the decoder -------------------------------------------------------- */

typedef enum ref_verdict {
    REF_COMPLETE,
    REF_INCOMPLETE,
    REF_REJECTED,
    REF_NEWER, /* rejected as of a newer version */
    REF_UNSUPPORTED
} ref_verdict;

typedef struct ref {
    ref_verdict verdict;
    const char *rule; /* "6.2: ..." of the last two and REF_REJECTED */
    jmp_buf stop;

    ref_header header;
    char *names; /* names_size bytes and a 0 more */

    uint32_t vertex_count, face_count, wedge_count;
    size_t vertex_room, face_room, wedge_room, split_room;
    ref_vertex *vertex;
    ref_edge *edge;     /* 3 per face */
    uint32_t *material; /* per face */
    ref_wedge *wedge;
    ref_split *split;
    ref_edge_list list;
    uint32_t base_vertices, base_faces, base_wedges;
    uint32_t exact_count;
    uint32_t point_count; /* vertices so far while a joined base is read */

    bool has_base, in_level;
    int levels; /* that are complete */
    uint32_t *order, order_count, order_at;
    size_t order_room;
    uint32_t block_vertex, block_face, block_wedge; /* first of the block */

    ref_coder in;
    ref_base_models base_models;
    ref_model flag[1680];
    ref_cut_models cut;
    ref_fit fit[3][9][3];
    ref_residual_models residual[2];
    ref_wedge_models wedge_models;
    ref_value_models value_models[REF_VALUES];
    ref_channel_models channel_models[REF_ATTRIBUTES];
    ref_join_models join;
    ref_exact_models exact_models;
    uint32_t exact_last[3][4096]; /* last vertex of a coordinate mod 4096 */
    uint64_t moved_corners;
} ref;

/* Ends the decoding: the file breaks a rule. */
_Noreturn void ref_reject(ref *r, const char *rule);
void ref_check(ref *r, bool holds, const char *rule);

/* Makes room for `count` elements; `room` is what there is. */
void *ref_grow(ref *r, void *array, size_t *room, size_t count, size_t size);

/* Little-endian fields of a payload (2); reject what ends too early. */
typedef struct ref_bytes {
    ref *r;
    const uint8_t *next, *end;
    const char *rule;
} ref_bytes;

uint64_t ref_get(ref_bytes *in, int bytes);
uint64_t ref_get_varint(ref_bytes *in);

/* 5. Decodes a file, or a beginning of one. */
ref *ref_decode(const uint8_t *data, size_t size);
void ref_free(ref *r);
/* Goes on from the CRC of the bytes before; 0: there are none. */
uint32_t ref_crc32c(uint32_t crc, const uint8_t *data, size_t size);
uint64_t ref_hash_crc(uint64_t h, uint32_t crc);
void ref_read_header(ref *r, const uint8_t *data, size_t size);
/* The n-th string of the names chunk, "" if there is none. */
const char *ref_name(const ref *r, uint64_t n);

/* Mesh (3, 6.2, 6.3). */
uint32_t ref_next(uint32_t h);
uint32_t ref_prev(uint32_t h);
uint32_t ref_left(const ref *r, uint32_t h); /* turning left */
uint32_t ref_start_of(const ref *r, uint32_t h);
uint32_t ref_end_of(const ref *r, uint32_t h);
ref_ring ref_ring_of(const ref *r, uint32_t v);
ref_ring ref_ring_from(const ref *r, uint32_t start);
/* Fan i of v, NONE behind the last one. */
uint32_t ref_fan(const ref *r, uint32_t v, int i);
/* Appends a fan; false if there are too many. */
bool ref_add_fan(ref *r, uint32_t v, uint32_t start);
/* The fan of v that starts at `old` starts at `now`. */
void ref_restart(ref *r, uint32_t v, uint32_t old, uint32_t now);
uint32_t ref_degree(const ref *r, uint32_t v);
/* All corners of a vertex: for (w = ref_walk_at(r, v); w.h != REF_NONE;
 * ref_walk_on(r, &w)) */
typedef struct ref_walk {
    uint32_t v, start, h;
    int fan;
} ref_walk;
ref_walk ref_walk_at(const ref *r, uint32_t v);
void ref_walk_on(const ref *r, ref_walk *w);
uint32_t ref_new_vertex(ref *r);
uint32_t ref_new_face(ref *r, uint32_t a, uint32_t b, uint32_t c);
uint32_t ref_new_wedge(ref *r, uint32_t corner);
void ref_join(ref *r, uint32_t g, uint32_t h); /* each NONE or not */

/* Contents (6). */
void ref_models_start(ref *r);
void ref_read_base(ref *r, const uint8_t *data, size_t size);
void ref_read_block(ref *r, const uint8_t *data, size_t size, bool last);
void ref_read_exact(ref *r, const uint8_t *data, size_t size);

/* 6.4. `first` and `end` are ring positions, REF_GHOST_WING for the ghost. */
enum { REF_GHOST_WING = -1 };
typedef struct ref_cut {
    int first, end;
} ref_cut;
ref_cut ref_read_cut(ref *r, uint32_t v, const ref_ring *ring);

/* 6.3. What a split makes: of each fan that is cut the faces a, b by their
 * first half-edges, or NONE, and where u's part starts; lone faces likewise. */
typedef struct ref_fresh {
    uint32_t u, first_face;
    int cuts, lones;
    uint32_t a[REF_PARTS], b[REF_PARTS], start[REF_PARTS];
    uint32_t lone[2 * REF_LONE];
} ref_fresh;
/* Cuts one fan of v, whose start goes to start_v. */
void ref_cut_fan(ref *r, uint32_t v, const ref_ring *ring, ref_cut cut,
                 ref_fresh *fresh, uint32_t *start_v);
/* Of joined files. */
typedef struct ref_fans {
    int count, members;
    bool large;
    ref_ring ring[REF_PARTS];
} ref_fans;
ref_fans ref_fans_of(const ref *r, uint32_t v);
void ref_part(ref *r, uint32_t v, const ref_fans *fans, ref_fresh *fresh);

/* 6.5. */
typedef struct ref_prediction {
    bool plain; /* too large a ring: nothing to learn */
    int kind, s, class, unknown, irregular, rough;
    ref_vec q, mean, normal, predicted, position;
    ref_vec t[REF_TERMS];
    int64_t h[REF_TERMS], size;
    int64_t along, across; /* expectations, see the residual */
} ref_prediction;

/* Vertices from `provisional` on are. */
ref_prediction ref_predict(const ref *r, uint32_t x, uint32_t y, ref_vec q,
                           int kind, uint32_t provisional);
void ref_learn(ref *r, const ref_prediction *p, ref_vec final);
ref_vec ref_read_residual(ref *r, ref_prediction *p);
/* M and B of fit->..[which] take F and Y in, each a vector (or a number and two
 * zeros); the weights follow. */
void ref_take_in(ref_fit *fit, int which, const ref_vec *f, ref_vec y,
                 int64_t weight, int64_t pull);
/* Where a coordinate is expected, and the models of its scale. */
typedef struct ref_near {
    ref_cell *any, *here;
    ref_model *low;
    ref_number *escape;
    int scale;
    int64_t mean;
} ref_near;
int64_t ref_read_near(ref *r, const ref_near *at);
int ref_how_far(int64_t coordinate, const ref_near *at);
int64_t ref_len(ref_vec v);
int64_t ref_isqrt(int64_t v);
int64_t ref_share(int64_t v, int64_t k);
ref_vec ref_vshare(ref_vec v, int64_t k);
void ref_read_positions(ref *r);

/* 6.6. */
void ref_read_base_materials(ref *r);
void ref_read_base_wedges(ref *r);
void ref_read_split_materials(ref *r, const ref_fresh *fresh);
void ref_read_split_wedges(ref *r, const ref_fresh *fresh);
void ref_read_values(ref *r);

/* 6.7. */
void ref_renumber(ref *r);

/* 6.8 */
float ref_exact_start(const ref *r, int axis, int64_t q);

/* ---- 7 reconstruction --------------------------------------------------- */

/* What is to be seen; arrays are the view's own. */
typedef struct ref_view {
    uint32_t faces, vertices, wedges;
    uint32_t *indices;      /* 3 per face: wedges */
    uint32_t *vertex_of;    /* per wedge */
    uint32_t *materials;    /* per face */
    int32_t *grid;          /* 3 per vertex */
    uint32_t *parents;      /* per vertex */
    uint16_t *values;       /* value_count per wedge */
    float *positions;       /* 3 per wedge */
    float *attributes;      /* per attribute and wedge, its components */
} ref_view;

/* As many vertices as `faces` faces allow; the base at least. */
ref_view ref_view_at(const ref *r, uint64_t faces);
void ref_view_free(ref_view *v);
uint32_t ref_face_components(const ref_header *h); /* of all attributes */

/* ---- appendix C, generated from SPEC.md --------------------------------- */

extern const int ref_SHAPE[], ref_REACH[], ref_DEGREE[], ref_STATE[],
    ref_SPAN[],
    ref_PREDICT[], ref_ALONG[], ref_ACROSS[], ref_FLAG[], ref_RANK[],
    ref_RESIDUAL[], ref_LOW[];

#endif
