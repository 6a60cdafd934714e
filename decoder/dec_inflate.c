/* SPDX-License-Identifier: MIT */
/*
 * dec_inflate.c - the visible mesh as it looks best: swollen by the share that
 * its level tells (SPEC 7.1).
 */
#include <string.h>

#include "decoder/dec_internal.h"
#include "format/inflate.h"
#include "format/quantize.h"

size_t pmesh_decoder_inflate_room(const pmesh_decoder *dec)
{
    return dec->view.vertices * sizeof(pmesh_bulge);
}

/* Between two levels it changes evenly with the vertices. */
static double share_of(const pmesh_decoder *dec)
{
    const pmesh_level_entry *e = dec->header.levels;
    const uint32_t n = dec->view.vertices;
    uint32_t i = 0;
    while (i + 1 < dec->header.level_count && e[i + 1].vertices <= n)
        i++;
    double share = e[i].inflation;
    if (n > e[i].vertices)
        share += ((double)e[i + 1].inflation - share) * (n - e[i].vertices) /
                 (e[i + 1].vertices - e[i].vertices);
    return share / PMESH_INFLATE_ONE;
}

static void gather(const pmesh_view *view, pmesh_bulge *bulge)
{
    memset(bulge, 0, view->mesh_vertex_count * sizeof *bulge);
    for (uint32_t f = 0; f < view->face_count; f++) {
        uint32_t v[3];
        for (int i = 0; i < 3; i++) {
            const uint32_t w = view->indices[3 * (size_t)f + (size_t)i];
            v[i] = view->positions_of ? view->positions_of[w] : w;
        }
        pmesh_bulge_add(bulge, v, view->positions);
    }
}

pmesh_status pmesh_decoder_copy_inflated(const pmesh_decoder *dec, float *dst,
                                         size_t stride, void *room)
{
    pmesh_view view;
    const pmesh_status status = pmesh_decoder_copy_positions(dec, dst, stride);
    if (status != PMESH_OK)
        return status;
    if (!room)
        return PMESH_E_ARGUMENT;
    pmesh_decoder_mesh(dec, &view);
    const double share = share_of(dec);
    if (share == 0)
        return PMESH_OK;
    pmesh_bulge *bulge = (pmesh_bulge *)room;
    const double to_model = share * dec->header.grid.step;
    gather(&view, bulge);
    for (uint32_t i = 0; i < view.vertex_count; i++) {
        const uint32_t v = view.positions_of ? view.positions_of[i] : i;
        double height[3];
        float xyz[3];
        uint8_t *at = (uint8_t *)dst + i * (stride ? stride : sizeof xyz);
        if (!pmesh_bulge_height(&bulge[v], view.positions + 3 * (size_t)v,
                                height))
            continue;
        memcpy(xyz, at, sizeof xyz);
        for (int k = 0; k < 3; k++)
            xyz[k] = pmesh_narrow((double)xyz[k] + to_model * height[k]);
        memcpy(at, xyz, sizeof xyz);
    }
    return PMESH_OK;
}
