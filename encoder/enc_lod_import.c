/* SPDX-License-Identifier: MIT */
#include "encoder/enc_lod_import.h"

#include <math.h>
#include <string.h>

#include "encoder/enc_import.h"
#include "encoder/enc_lod_near.h"
#include "format/alloc.h"

/* Positions are rounded to this, of the extent: finer than floats are, and
 * coarser than the rounding of doubles, so that the unit of the model leaves
 * no trace in what follows. */
#define GRAIN (1.0 / 4294967296.0)

void enc_lod_input_position(const pmesh_simplify_input *in, size_t vertex,
                            double out[3])
{
    if (in->doubles) {
        const size_t stride = in->stride ? in->stride : 3 * sizeof(double);
        memcpy(out, (const unsigned char *)in->doubles + vertex * stride,
               3 * sizeof *out);
        return;
    }
    const size_t stride = in->stride ? in->stride : 3 * sizeof(float);
    float p[3];
    memcpy(p, (const unsigned char *)in->positions + vertex * stride, sizeof p);
    for (int i = 0; i < 3; i++)
        out[i] = (double)p[i];
}

static pmesh_status check(const pmesh_simplify_input *in)
{
    if (!in->indices || (in->positions != NULL) == (in->doubles != NULL))
        return PMESH_E_ARGUMENT;
    if (in->face_count == 0)
        return PMESH_E_NO_FACES;
    if (in->face_count > (UINT32_C(1) << 30) / 3 ||
        in->vertex_count > UINT32_MAX - 2)
        return PMESH_E_LIMIT;
    for (size_t i = 0; i < 3 * in->face_count; i++)
        if (in->indices[i] >= in->vertex_count)
            return PMESH_E_INDEX;
    return PMESH_OK;
}

static bool is_finite(const double p[3])
{
    return isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]);
}

/* The bounding box of the faces that are finite. */
static pmesh_status find_frame(const pmesh_simplify_input *in,
                               enc_lod_frame *frame)
{
    double low[3] = { INFINITY, INFINITY, INFINITY };
    double high[3] = { -INFINITY, -INFINITY, -INFINITY };

    for (size_t f = 0; f < in->face_count; f++) {
        double p[3][3];
        for (int k = 0; k < 3; k++)
            enc_lod_input_position(in, in->indices[3 * f + (size_t)k], p[k]);
        if (!is_finite(p[0]) || !is_finite(p[1]) || !is_finite(p[2]))
            continue;
        for (int k = 0; k < 3; k++)
            for (int i = 0; i < 3; i++) {
                low[i] = p[k][i] < low[i] ? p[k][i] : low[i];
                high[i] = p[k][i] > high[i] ? p[k][i] : high[i];
            }
    }
    if (!(low[0] <= high[0]))
        return PMESH_E_NOT_FINITE;
    frame->extent = 0;
    for (int i = 0; i < 3; i++) {
        frame->origin[i] = 0.5 * low[i] + 0.5 * high[i];
        frame->extent = fmax(frame->extent, high[i] - low[i]);
    }
    if (!isfinite(frame->extent))
        return PMESH_E_LIMIT;
    return frame->extent > 0 ? PMESH_OK : PMESH_E_NO_FACES;
}

static void place_vertices(const pmesh_simplify_input *in,
                           const enc_lod_frame *frame, double (*place)[3],
                           uint32_t *root)
{
    for (uint32_t v = 0; v < in->vertex_count; v++) {
        double p[3];
        enc_lod_input_position(in, v, p);
        root[v] = is_finite(p) ? v : ENC_NONE;
        for (int i = 0; i < 3; i++) {
            const double x = (p[i] - frame->origin[i]) / frame->extent;
            /* Strays outside of the faces' box need not fit. */
            place[v][i] = root[v] == ENC_NONE || fabs(x) > 1
                              ? 0
                              : floor(x / GRAIN + 0.5) * GRAIN;
        }
    }
}

static uint64_t hash_row(uint32_t root, const double *row, size_t width)
{
    uint64_t hash = enc_mix(0, root);

    for (size_t i = 0; i < width; i++) {
        uint64_t word;
        memcpy(&word, &row[i], sizeof word);
        hash = enc_mix(hash, word);
    }
    return hash;
}

/* Of vertices at one position those with equal rows become one wedge, the
 * least. */
static pmesh_status join_wedges(const pmesh_allocator *a, const uint32_t *root,
                                const double *rows, size_t width,
                                uint32_t count, uint32_t *wedge)
{
    const size_t size = enc_table_size(count);
    uint32_t *slot = pmesh_alloc(a, size, sizeof *slot);

    if (!slot)
        return PMESH_E_MEMORY;
    memset(slot, 0xff, size * sizeof *slot);
    for (uint32_t v = 0; v < count; v++) {
        if (root[v] == ENC_NONE)
            continue;
        const double *row = &rows[v * width];
        size_t at = (size_t)hash_row(root[v], row, width) & (size - 1);
        while (slot[at] != ENC_NONE &&
               (root[slot[at]] != root[v] ||
                (width > 0 && memcmp(&rows[slot[at] * width], row,
                                     width * sizeof *row) != 0)))
            at = (at + 1) & (size - 1);
        if (slot[at] == ENC_NONE)
            slot[at] = v;
        wedge[v] = slot[at];
    }
    pmesh_release(a, slot, size, sizeof *slot);
    return PMESH_OK;
}

/* What is needed for the import only. */
typedef struct enc_lod_scratch {
    double (*place)[3];
    uint32_t *root, *wedge;
} enc_lod_scratch;

static pmesh_status build(const pmesh_allocator *a,
                          const pmesh_simplify_input *in, double weld,
                          bool exact, enc_lod_channels *channels,
                          const enc_lod_frame *frame, enc_lod_scratch *s,
                          enc_lod *lod, double *rows)
{
    const size_t width = channels->active + channels->passive;
    const uint32_t n = (uint32_t)in->vertex_count;
    uint32_t twins;

    place_vertices(in, frame, s->place, s->root);
    const pmesh_mesh_input welded = { .positions = &s->place[0][0],
                                      .vertex_count = n };
    pmesh_status status =
        enc_weld(a, &welded, weld / frame->extent, false, s->root, &twins);
    enc_lod_channels_load(channels, in, rows);
    for (uint32_t v = 0; v < n; v++)
        s->wedge[v] = v;
    if (status == PMESH_OK && !exact)
        status = join_wedges(a, s->root, rows, width, n, s->wedge);
    if (status == PMESH_OK)
        status = enc_lod_create(a, in->indices, (uint32_t)in->face_count,
                                in->materials, n, s->root, s->wedge,
                                (const double(*)[3])s->place, lod);
    return status;
}

static pmesh_status pair_up(enc_lod *lod, double threshold)
{
    uint32_t (*near)[2], count;
    size_t capacity;

    if (lod->faces == 0)
        return PMESH_E_NO_FACES;
    if (!(threshold > 0))
        return enc_lod_add_pairs(lod, NULL, 0);
    pmesh_status status =
        enc_lod_find_near(lod, threshold, &near, &capacity, &count);
    if (status != PMESH_OK)
        return status;
    status = enc_lod_add_pairs(lod, (const uint32_t(*)[2])near, count);
    pmesh_release(&lod->allocator, near, capacity, sizeof *near);
    return status;
}

pmesh_status enc_lod_import(const pmesh_allocator *a,
                            const pmesh_simplify_input *in, double weld,
                            double threshold, bool exact,
                            enc_lod_channels *channels, enc_lod_frame *frame,
                            enc_lod *lod, double **value)
{
    pmesh_status status = check(in);

    if (status == PMESH_OK)
        status = enc_lod_channels_plan(in, channels);
    if (status == PMESH_OK)
        status = find_frame(in, frame);
    if (status != PMESH_OK)
        return status;
    const size_t n = in->vertex_count;
    const size_t values = n * (channels->active + channels->passive);
    enc_lod_scratch s = { .place = pmesh_alloc(a, n, sizeof *s.place),
                          .root = pmesh_alloc(a, n, sizeof *s.root),
                          .wedge = pmesh_alloc(a, n, sizeof *s.wedge) };
    *value = pmesh_alloc(a, values, sizeof **value);
    status = s.place && s.root && s.wedge && *value
                 ? build(a, in, weld, exact, channels, frame, &s, lod, *value)
                 : PMESH_E_MEMORY;
    if (status == PMESH_OK) {
        status = pair_up(lod, threshold / frame->extent);
        if (status != PMESH_OK)
            enc_lod_destroy(lod);
    }
    pmesh_release(a, s.place, n, sizeof *s.place);
    pmesh_release(a, s.root, n, sizeof *s.root);
    pmesh_release(a, s.wedge, n, sizeof *s.wedge);
    if (status != PMESH_OK) {
        pmesh_release(a, *value, values, sizeof **value);
        *value = NULL;
    }
    return status;
}
