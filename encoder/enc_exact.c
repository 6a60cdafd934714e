/* SPDX-License-Identifier: MIT */
#include "encoder/enc_exact.h"

#include <string.h>

#include "format/alloc.h"
#include "format/exact.h"
#include "format/quantize.h"

enum {
    SAMPLES = 1024,
    STRAY_SHARE = 8, /* a form that misses more than one of these is no use */
    RAW_BITS = 34,   /* of such a miss, its flag included */
    COUNT_ROOM = 5,
    CHUNK_TARGET = PMESH_BLOCK_CHUNK_SIZE - 256
};

/* ---- forms -------------------------------------------------------------- */

/* Some coordinates of one axis, and the middles of their cells. */
typedef struct sample {
    uint32_t count;
    double step;
    float value[SAMPLES];
    double cell[SAMPLES];
} sample;

static void take_sample(const enc_mesh *mesh, int axis, sample *s)
{
    const uint32_t stride = mesh->vertex_count / SAMPLES + 1;
    s->count = 0;
    s->step = mesh->grid.step;
    for (uint32_t v = 0; v < mesh->vertex_count; v += stride) {
        s->value[s->count] = mesh->exact[v][axis];
        s->cell[s->count++] = pmesh_grid_dequantize(&mesh->grid, axis,
                                                    mesh->position[v][axis]);
    }
}

/* log2(n) for n >= 1, within 0.09 and without libm. */
static double rough_log2(double n)
{
    double bits = 0;
    for (; n >= 2; n /= 2)
        bits++;
    return bits + (n - 1);
}

/* Bits that the sample would take; `limit` or more if it is not less. */
static double cost_of(const pmesh_form *f, const sample *s, double limit)
{
    double bits = 0;
    uint32_t strays = 0;
    for (uint32_t i = 0; i < s->count && bits < limit; i++) {
        int64_t ordinal;
        if (!pmesh_ordinal_of(f, s->value[i], &ordinal)) {
            bits += RAW_BITS;
            if (++strays > s->count / STRAY_SHARE)
                return limit;
            continue;
        }
        const double reach = s->step / 2;
        const int64_t n = pmesh_ordinal_to(f, s->cell[i] + reach) -
                          pmesh_ordinal_from(f, s->cell[i] - reach);
        bits += n > 0 ? rough_log2((double)n + 1) : 0;
    }
    return bits;
}

static void try_form(const sample *s, bool binary, int digits, int decimals,
                     pmesh_form *best, double *least)
{
    const pmesh_form f = { binary, (uint8_t)digits, (uint8_t)decimals };
    const double bits = cost_of(&f, s, *least);
    if (bits < *least) {
        *least = bits;
        *best = f;
    }
}

/* Decimals win a tie: they are tried from few to many, before binary forms. */
static pmesh_form choose_form(const sample *s)
{
    pmesh_form best = { true, PMESH_BINARY_DIGITS, PMESH_BINARY_DECIMALS };
    double least = (double)RAW_BITS * SAMPLES;
    for (int digits = 1; digits <= PMESH_DECIMAL_DIGITS; digits++)
        for (int decimals = 0; decimals <= PMESH_DECIMAL_DECIMALS; decimals++)
            try_form(s, false, digits, decimals, &best, &least);
    for (int digits = 1; digits <= PMESH_BINARY_DIGITS; digits++)
        try_form(s, true, digits, PMESH_BINARY_DECIMALS, &best, &least);
    const int digits = best.binary ? best.digits : PMESH_BINARY_DIGITS;
    for (int decimals = 0; decimals < PMESH_BINARY_DECIMALS; decimals++)
        try_form(s, true, digits, decimals, &best, &least);
    return best;
}

/* ---- chunks ------------------------------------------------------------- */

/* As many vertices as fit a chunk of 64 KiB. */
static pmesh_status write_chunk(pmesh_exact *e, const pmesh_mesh *m,
                                enc_stream *stream, uint8_t *room)
{
    const uint32_t first = e->count;
    pmesh_writer out = { room + COUNT_ROOM, 0, PMESH_BLOCK_CHUNK_SIZE, false };
    pmesh_coder coder;
    pmesh_coder_encode(&coder, &out);
    while (e->count < m->vertex_count && out.size < CHUNK_TARGET)
        pmesh_exact_code(e, &coder, m);
    if (!pmesh_coder_finish(&coder))
        return PMESH_E_LIMIT;

    uint8_t count[COUNT_ROOM];
    pmesh_writer head = { count, 0, sizeof count, false };
    pmesh_put_varint(&head, e->count - first);
    uint8_t *payload = room + COUNT_ROOM - head.size;
    memcpy(payload, count, head.size);
    enc_stream_chunk(stream, PMESH_CHUNK_POSITIONS, payload,
                     (uint32_t)(head.size + out.size));
    return PMESH_OK;
}

static pmesh_status write_chunks(pmesh_exact *e, const enc_replay *r,
                                 enc_stream *stream, uint8_t *room)
{
    const pmesh_mesh *m = &r->codec.mesh;
    pmesh_status status = PMESH_OK;
    for (uint32_t v = 0; v < m->vertex_count; v++)
        memcpy(e->position[v], r->mesh->exact[r->vertex_of[v]],
               sizeof *e->position);
    while (status == PMESH_OK && e->count < m->vertex_count)
        status = write_chunk(e, m, stream, room);
    return status;
}

pmesh_status enc_exact_write(const enc_replay *r, enc_stream *stream,
                             uint8_t *room, pmesh_header_chunk *h)
{
    const enc_mesh *mesh = r->mesh;
    const pmesh_allocator *a = &mesh->allocator;
    const size_t before = stream->size;
    pmesh_exact e;
    sample *s = pmesh_alloc(a, 1, sizeof *s);
    if (!s)
        return PMESH_E_MEMORY;
    for (int k = 0; k < 3; k++) {
        take_sample(mesh, k, s);
        h->exact_form[k] = choose_form(s);
    }
    pmesh_release(a, s, 1, sizeof *s);

    const uint64_t size = pmesh_exact_bind(NULL, &mesh->grid, h->exact_form,
                                           mesh->vertex_count, NULL);
    void *block = pmesh_alloc(a, 1, (size_t)size);
    if (!block)
        return PMESH_E_MEMORY;
    pmesh_exact_bind(&e, &mesh->grid, h->exact_form, mesh->vertex_count,
                     block);
    const pmesh_status status = write_chunks(&e, r, stream, room);
    pmesh_release(a, block, 1, (size_t)size);
    h->exact_size = stream->size - before;
    return status;
}
