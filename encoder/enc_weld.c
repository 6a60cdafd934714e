/* SPDX-License-Identifier: MIT */
#include "encoder/enc_import.h"

#include "format/alloc.h"

typedef struct welder {
    const pmesh_mesh_input *in;
    bool lossless, signless; /* signless: -0 is 0 all the same */
    uint32_t *root; /* a forest: every parent is less than its child */
    size_t size;    /* of the table, a power of two */
    uint64_t *slot; /* upper half of a hash, input vertex; or FREE_SLOT */
} welder;

#define FREE_SLOT UINT64_MAX /* no vertex has the number ENC_NONE */

static void load_position(const welder *weld, uint32_t v, double out[3])
{
    enc_load_position(weld->in, weld->lossless, v, out);
    for (int k = 0; k < 3 && weld->signless; k++)
        out[k] += 0.0;
}

static uint64_t hash_triple(const double p[3])
{
    uint64_t word[3];

    memcpy(word, p, sizeof word);
    return enc_mix(enc_mix(enc_mix(0, word[0]), word[1]), word[2]);
}

/* Not ==: a position has a -0 only where it differs from 0, a cell has none. */
static bool equal_triple(const double p[3], const double q[3])
{
    return memcmp(p, q, 3 * sizeof *p) == 0;
}

static bool open_table(welder *weld, const pmesh_allocator *a, size_t count)
{
    weld->size = enc_table_size(count);
    weld->slot = pmesh_alloc(a, weld->size, sizeof *weld->slot);
    if (!weld->slot)
        return false;
    memset(weld->slot, 0xff, weld->size * sizeof *weld->slot);
    return true;
}

static void close_table(welder *weld, const pmesh_allocator *a)
{
    pmesh_release(a, weld->slot, weld->size, sizeof *weld->slot);
}

/* The lower half of a hash says where, the upper half saves looking. */
static uint64_t make_slot(uint64_t hash, uint32_t v)
{
    return (hash & UINT64_C(0xffffffff00000000)) | v;
}

static bool may_match(uint64_t slot, uint64_t hash)
{
    return (slot ^ hash) >> 32 == 0;
}

/* The slot of position p, or the free one where it would be. */
static uint64_t *find_equal(const welder *weld, const double p[3],
                            uint64_t hash)
{
    const size_t mask = weld->size - 1;
    size_t i = hash & mask;

    for (; weld->slot[i] != FREE_SLOT; i = (i + 1) & mask) {
        double q[3];
        if (!may_match(weld->slot[i], hash))
            continue;
        load_position(weld, (uint32_t)weld->slot[i], q);
        if (equal_triple(p, q))
            break;
    }
    return &weld->slot[i];
}

/* Returns how many distinct positions there are. */
static size_t join_equal(welder *weld)
{
    size_t distinct = 0;

    for (uint32_t v = 0; v < weld->in->vertex_count; v++) {
        if (weld->root[v] == ENC_NONE)
            continue;
        double p[3];
        load_position(weld, v, p);
        uint64_t *slot = find_equal(weld, p, hash_triple(p));
        if (*slot == FREE_SLOT) {
            *slot = make_slot(hash_triple(p), v);
            distinct++;
        }
        weld->root[v] = (uint32_t)*slot;
    }
    return distinct;
}

/*
 * Close positions. Points are sorted into cells whose diagonal is just below
 * the distance: all points of a cell are one cluster without looking further,
 * and two cells need one close pair. Only cells at most two apart have any.
 */
#define CELL_REACH 2
#define CELL_SIDE 0.577 /* of the distance; 1/sqrt(3) = 0.5773... */

typedef struct cell_grid {
    welder *weld;    /* its table holds the first point of every cell */
    double distance;
    uint32_t *after; /* per input vertex: the next point of its cell */
} cell_grid;

static uint32_t find_root(welder *weld, uint32_t v)
{
    uint32_t *root = weld->root;

    while (root[v] != v) {
        root[v] = root[root[v]];
        v = root[v];
    }
    return v;
}

static void join(welder *weld, uint32_t v, uint32_t w)
{
    v = find_root(weld, v);
    w = find_root(weld, w);
    if (v < w)
        weld->root[w] = v;
    else
        weld->root[v] = w;
}

/* The largest integer at or below t; all doubles from 2^52 on are integers. */
static double floor_of(double t)
{
    if (!(t > -0x1p52 && t < 0x1p52))
        return t;
    const double whole = (double)(int64_t)t;
    return whole > t ? whole - 1.0 : whole;
}

static void cell_of(const cell_grid *grid, const double p[3], double cell[3])
{
    for (int k = 0; k < 3; k++)
        cell[k] = floor_of(p[k] / (grid->distance * CELL_SIDE));
}

static bool are_close(const cell_grid *grid, const double p[3],
                      const double q[3])
{
    double sum = 0.0;

    for (int k = 0; k < 3; k++) {
        const double d = (p[k] - q[k]) / grid->distance;
        sum += d * d;
    }
    return sum <= 1.0;
}

/* The slot of a cell, or the free one where it would be. */
static uint64_t *find_cell(const cell_grid *grid, const double cell[3],
                           uint64_t hash)
{
    const welder *weld = grid->weld;
    const size_t mask = weld->size - 1;
    size_t i = hash & mask;

    for (; weld->slot[i] != FREE_SLOT; i = (i + 1) & mask) {
        double p[3], other[3];
        if (!may_match(weld->slot[i], hash))
            continue;
        load_position(weld, (uint32_t)weld->slot[i], p);
        cell_of(grid, p, other);
        if (equal_triple(cell, other))
            break;
    }
    return &weld->slot[i];
}

static void sort_into_cells(cell_grid *grid)
{
    welder *weld = grid->weld;

    for (uint32_t v = 0; v < weld->in->vertex_count; v++) {
        if (weld->root[v] != v)
            continue;
        double p[3], q[3], cell[3];
        load_position(weld, v, p);
        cell_of(grid, p, cell);
        const uint64_t hash = hash_triple(cell);
        uint64_t *slot = find_cell(grid, cell, hash);
        if (*slot == FREE_SLOT) {
            grid->after[v] = ENC_NONE;
            *slot = make_slot(hash, v);
            continue;
        }
        const uint32_t first = (uint32_t)*slot;
        grid->after[v] = grid->after[first];
        grid->after[first] = v;
        load_position(weld, first, q);
        if (are_close(grid, p, q)) /* false only where rounding is coarse */
            join(weld, v, first);
    }
}

/* False only if no point of the cell can be close to p. */
static bool is_near_cell(const cell_grid *grid, const double p[3],
                         const double cell[3])
{
    const double side = grid->distance * CELL_SIDE;
    double q[3];

    for (int k = 0; k < 3; k++) {
        const double low = cell[k] * side, high = low + side;
        q[k] = p[k] < low ? low : p[k] > high ? high : p[k];
        q[k] += 0.001 * (p[k] - q[k]); /* more than rounding can take */
    }
    return are_close(grid, p, q);
}

/* first, second: of two cells; `cell` is the second one. */
static bool cells_touch(const cell_grid *grid, uint32_t first, uint32_t second,
                        const double cell[3])
{
    double p[3], q[3];

    for (uint32_t v = first; v != ENC_NONE; v = grid->after[v]) {
        load_position(grid->weld, v, p);
        if (!is_near_cell(grid, p, cell))
            continue;
        for (uint32_t w = second; w != ENC_NONE; w = grid->after[w]) {
            load_position(grid->weld, w, q);
            if (are_close(grid, p, q))
                return true;
        }
    }
    return false;
}

/* Half of the neighbours: the other half finds this cell. */
static void join_neighbours(cell_grid *grid, uint32_t first)
{
    enum { WIDTH = 2 * CELL_REACH + 1, ALL = WIDTH * WIDTH * WIDTH };
    double p[3], cell[3];

    load_position(grid->weld, first, p);
    cell_of(grid, p, cell);
    for (int i = ALL / 2 + 1; i < ALL; i++) {
        const double other[3] = {
            cell[0] + (double)(i / (WIDTH * WIDTH) - CELL_REACH),
            cell[1] + (double)(i / WIDTH % WIDTH - CELL_REACH),
            cell[2] + (double)(i % WIDTH - CELL_REACH)
        };
        const uint64_t slot = *find_cell(grid, other, hash_triple(other));
        if (slot == FREE_SLOT)
            continue;
        const uint32_t second = (uint32_t)slot;
        if (find_root(grid->weld, first) == find_root(grid->weld, second))
            continue;
        if (cells_touch(grid, first, second, other))
            join(grid->weld, first, second);
    }
}

static void join_close(cell_grid *grid)
{
    sort_into_cells(grid);
    for (size_t i = 0; i < grid->weld->size; i++)
        if (grid->weld->slot[i] != FREE_SLOT)
            join_neighbours(grid, (uint32_t)grid->weld->slot[i]);
    for (uint32_t v = 0; v < grid->weld->in->vertex_count; v++)
        if (grid->weld->root[v] != ENC_NONE)
            grid->weld->root[v] = grid->weld->root[grid->weld->root[v]];
}

/* As join_equal() with -0 for 0, and leaves every vertex alone again. */
static size_t count_values(welder *weld)
{
    weld->signless = true;
    const size_t distinct = join_equal(weld);
    weld->signless = false;

    for (uint32_t v = 0; v < weld->in->vertex_count; v++)
        if (weld->root[v] != ENC_NONE)
            weld->root[v] = v;
    memset(weld->slot, 0xff, weld->size * sizeof *weld->slot);
    return distinct;
}

pmesh_status enc_weld(const pmesh_allocator *allocator,
                      const pmesh_mesh_input *in, double distance,
                      bool lossless, uint32_t *root, uint32_t *zero_twins)
{
    welder weld = { .in = in, .lossless = lossless, .root = root };
    size_t count = 0, values = 0;

    for (size_t v = 0; v < in->vertex_count; v++)
        count += root[v] != ENC_NONE;
    if (!open_table(&weld, allocator, count))
        return PMESH_E_MEMORY;
    if (lossless)
        values = count_values(&weld);
    count = join_equal(&weld);
    *zero_twins = lossless ? (uint32_t)(count - values) : 0;
    close_table(&weld, allocator);
    if (!(distance > 0x1p-1000)) /* quotients by it stay finite or infinite */
        return PMESH_OK;
    *zero_twins = 0; /* all of them are close */

    cell_grid grid = { .weld = &weld, .distance = distance };
    if (!open_table(&weld, allocator, count))
        return PMESH_E_MEMORY;
    grid.after = pmesh_alloc(allocator, in->vertex_count, sizeof *grid.after);
    if (grid.after)
        join_close(&grid);
    pmesh_release(allocator, grid.after, in->vertex_count, sizeof *grid.after);
    close_table(&weld, allocator);
    return grid.after ? PMESH_OK : PMESH_E_MEMORY;
}
