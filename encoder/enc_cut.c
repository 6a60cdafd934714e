/* SPDX-License-Identifier: MIT */
#include "encoder/enc_import.h"

#include "format/alloc.h"

/*
 * A fan is what one reaches around a vertex through twins, corner by corner:
 *
 *        w2 ---- w1       corner x sits at the vertex v; half-edge x leaves v,
 *        / \  x / \       enc_previous_corner(x) arrives. Counter-clockwise
 *       / y \  / z \      neighbour: y = twin of the arriving half-edge.
 *     w3 --- v ---- w0    Clockwise one: z, after the twin of the leaving one.
 *
 * Each half-edge has at most one twin and it runs the other way, so a fan is a
 * chain or a ring, and walking it needs no other memory.
 */
typedef struct cutter {
    enc_mesh *mesh;
    size_t corner_count;
    uint32_t *visited; /* set of corners */
    uint32_t *taken;   /* set of vertices: some fan has the number already */
    uint32_t *met;     /* per vertex: the last arc that met it */
    uint32_t arc;
} cutter;

static uint32_t left_neighbour(const cutter *cut, uint32_t x)
{
    return cut->mesh->twin[enc_previous_corner(x)];
}

/* The corner that has no right neighbour; `x` itself in a ring. */
static uint32_t fan_begin(const cutter *cut, uint32_t x)
{
    const uint32_t *twin = cut->mesh->twin;
    uint32_t begin = x;

    while (twin[begin] != ENC_NONE) {
        begin = enc_next_corner(twin[begin]);
        if (begin == x)
            break;
    }
    return begin;
}

static void number_corner(cutter *cut, uint32_t x, uint32_t id)
{
    enc_bit_put(cut->visited, x);
    cut->mesh->vertex[x] = id;
}

/* All corners of the fan of x: to the left, and if that ends, to the right. */
static void number_fan(cutter *cut, uint32_t x, uint32_t id)
{
    const uint32_t *twin = cut->mesh->twin;
    uint32_t y = x;

    do {
        number_corner(cut, y, id);
        y = left_neighbour(cut, y);
    } while (y != ENC_NONE && y != x);
    if (y == x)
        return;
    for (y = twin[x]; y != ENC_NONE; y = twin[y]) {
        y = enc_next_corner(y);
        number_corner(cut, y, id);
    }
}

/* The first fan of a vertex, in the order of its first corner, keeps the
 * number; every other one gets the next free number. */
static void split_fans(cutter *cut)
{
    enc_mesh *mesh = cut->mesh;

    memset(cut->visited, 0,
           enc_bit_words(cut->corner_count) * sizeof *cut->visited);
    memset(cut->taken, 0,
           enc_bit_words(cut->corner_count) * sizeof *cut->taken);
    for (uint32_t c = 0; c < cut->corner_count; c++) {
        if (enc_bit_get(cut->visited, c))
            continue;
        uint32_t id = mesh->vertex[c];
        if (enc_bit_get(cut->taken, id))
            id = mesh->vertex_count++;
        enc_bit_put(cut->taken, id);
        number_fan(cut, c, id);
    }
}

static void open_edge(enc_mesh *mesh, uint32_t h)
{
    mesh->twin[mesh->twin[h]] = ENC_NONE;
    mesh->twin[h] = ENC_NONE;
}

/* An arc is a part of a fan that meets no neighbour twice. */
static void begin_arc(cutter *cut, uint32_t x)
{
    cut->arc++;
    cut->met[cut->mesh->vertex[enc_next_corner(x)]] = cut->arc;
}

/*
 * Cuts a fan into arcs, each with a vertex of its own: where corner x would
 * meet a neighbour again, the edge before it is opened. A ring with such a
 * neighbour is opened at the first of these edges and then walked as a chain.
 */
static void untangle_fan(cutter *cut, uint32_t begin)
{
    enc_mesh *mesh = cut->mesh;
    uint32_t id = mesh->vertex[begin], x = begin;

    begin_arc(cut, x);
    for (;;) {
        const uint32_t left = left_neighbour(cut, x);
        const uint32_t met = mesh->vertex[enc_previous_corner(x)];
        if (left == begin)
            break; /* once around; `met` is where it began */
        if (cut->met[met] == cut->arc) {
            if (mesh->twin[begin] != ENC_NONE)
                begin = x;
            else
                id = mesh->vertex_count++;
            open_edge(mesh, x);
            begin_arc(cut, x);
        }
        cut->met[met] = cut->arc;
        enc_bit_put(cut->visited, x);
        mesh->vertex[x] = id;
        if (left == ENC_NONE)
            return;
        x = left;
    }
    enc_bit_put(cut->visited, x);
}

/*
 * Afterwards no fan meets a neighbour twice, so no two vertices are joined by
 * two edges. An opened edge may leave its far vertex with two fans: they are
 * split at the end, which takes no neighbour from one fan to another.
 */
static void untangle(cutter *cut)
{
    memset(cut->visited, 0,
           enc_bit_words(cut->corner_count) * sizeof *cut->visited);
    for (uint32_t c = 0; c < cut->corner_count; c++)
        if (!enc_bit_get(cut->visited, c))
            untangle_fan(cut, fan_begin(cut, c));
    split_fans(cut);
}

pmesh_status enc_cut(enc_mesh *mesh, bool regular)
{
    const pmesh_allocator *a = &mesh->allocator;
    const size_t corners = 3 * (size_t)mesh->face_count;
    const size_t words = enc_bit_words(corners);
    cutter cut = { .mesh = mesh, .corner_count = corners };
    pmesh_status status = PMESH_E_MEMORY;

    /* Each vertex number has a corner, so there are never more of them. */
    cut.visited = pmesh_alloc(a, words, sizeof *cut.visited);
    cut.taken = pmesh_alloc(a, words, sizeof *cut.taken);
    if (!regular)
        cut.met = pmesh_alloc_zero(a, corners, sizeof *cut.met);
    if (cut.visited && cut.taken && (regular || cut.met)) {
        split_fans(&cut);
        if (!regular)
            untangle(&cut);
        status = PMESH_OK;
    }
    pmesh_release(a, cut.met, corners, sizeof *cut.met);
    pmesh_release(a, cut.taken, words, sizeof *cut.taken);
    pmesh_release(a, cut.visited, words, sizeof *cut.visited);
    return status;
}
