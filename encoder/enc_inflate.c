/* SPDX-License-Identifier: MIT */
#include "encoder/enc_inflate.h"

#include <string.h>

#include "format/alloc.h"

#define BEST_SHARE 0.75

enum { LARGEST = 96 }; /* in 1/256: more is noise, of open meshes say */

/* Six times the signed volume between the faces and the middle of the grid. */
static double volume_of(const enc_mesh *mesh, const uint32_t *vertex,
                        uint32_t face_count, const int32_t (*position)[3])
{
    double volume = 0;
    for (uint32_t f = 0; f < face_count; f++) {
        double p[3][3];
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++)
                p[i][k] = position[vertex[3 * (size_t)f + (size_t)i]][k] -
                          0.5 * mesh->bounds[k];
        volume += p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) +
                  p[0][1] * (p[1][2] * p[2][0] - p[1][0] * p[2][2]) +
                  p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]);
    }
    return volume;
}

pmesh_status enc_inflate_create(const enc_mesh *mesh, enc_inflate *out)
{
    *out = (enc_inflate){ .mesh = mesh };
    out->bulge =
        pmesh_alloc(&mesh->allocator, mesh->vertex_count, sizeof *out->bulge);
    if (!out->bulge)
        return PMESH_E_MEMORY;
    out->volume = volume_of(mesh, mesh->vertex, mesh->face_count,
                            (const int32_t(*)[3])mesh->position);
    return PMESH_OK;
}

void enc_inflate_destroy(enc_inflate *inflate)
{
    if (inflate->mesh)
        pmesh_release(&inflate->mesh->allocator, inflate->bulge,
                      inflate->mesh->vertex_count, sizeof *inflate->bulge);
    *inflate = (enc_inflate){ 0 };
}

uint8_t enc_inflate_level(enc_inflate *inflate, const pmesh_mesh *level)
{
    const int32_t(*position)[3] = (const int32_t(*)[3])level->position;
    pmesh_bulge *bulge = inflate->bulge;
    double gain = 0;
    memset(bulge, 0, level->vertex_count * sizeof *bulge);
    for (uint32_t f = 0; f < level->face_count; f++)
        pmesh_bulge_add(bulge, level->vertex + 3 * (size_t)f, position[0]);
    for (uint32_t v = 0; v < level->vertex_count; v++) {
        double d[3];
        if (!pmesh_bulge_height(&bulge[v], position[v], d))
            continue;
        for (int k = 0; k < 3; k++)
            gain += d[k] * bulge[v].normal[k];
    }
    const double missing =
        inflate->volume -
        volume_of(inflate->mesh, level->vertex, level->face_count, position);
    if (!(missing * gain > 0))
        return 0;
    const double share = BEST_SHARE * PMESH_INFLATE_ONE * missing / gain;
    return (uint8_t)(share < LARGEST ? share + 0.5 : LARGEST);
}
