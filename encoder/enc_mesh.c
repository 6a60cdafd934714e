/* SPDX-License-Identifier: MIT */
#include "encoder/enc_mesh.h"

#include "encoder/enc_guide.h"
#include "encoder/enc_import.h"
#include "format/alloc.h"
#include "format/layout.h"

void enc_mesh_destroy(enc_mesh *mesh)
{
    if (!mesh)
        return;
    const pmesh_allocator *a = &mesh->allocator;
    const size_t corners = 3 * (size_t)mesh->face_count;

    enc_guide_destroy(mesh);
    pmesh_release(a, mesh->exact, mesh->vertex_count, sizeof *mesh->exact);
    pmesh_release(a, mesh->source, mesh->vertex_count, sizeof *mesh->source);
    pmesh_release(a, mesh->position, mesh->vertex_count,
                  sizeof *mesh->position);
    pmesh_release(a, mesh->vertex, corners, sizeof *mesh->vertex);
    pmesh_release(a, mesh->twin, corners, sizeof *mesh->twin);
    pmesh_release(a, mesh->material, mesh->face_count,
                  sizeof *mesh->material);
    pmesh_release(a, mesh->wedge, corners, sizeof *mesh->wedge);
    pmesh_release(a, mesh->wedge_vertex, mesh->wedge_count,
                  sizeof *mesh->wedge_vertex);
    pmesh_release(a, mesh->value, mesh->wedge_count,
                  mesh->value_count * sizeof *mesh->value);
    *mesh = (enc_mesh){ 0 };
}

static const char *check_positions(const enc_mesh *mesh)
{
    int32_t low[3] = { INT32_MAX, INT32_MAX, INT32_MAX };
    int32_t high[3] = { -1, -1, -1 };

    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        for (int k = 0; k < 3; k++) {
            const int32_t q = mesh->position[v][k];
            low[k] = q < low[k] ? q : low[k];
            high[k] = q > high[k] ? q : high[k];
        }
    }
    for (int k = 0; k < 3; k++) {
        if (low[k] != 0 || high[k] != mesh->bounds[k])
            return "coordinates reach from 0 to the bounds";
        if (high[k] >> mesh->grid.bits != 0)
            return "coordinates are on the grid";
    }
    return NULL;
}

static const char *check_faces(const enc_mesh *mesh)
{
    for (uint32_t c = 0; c < 3 * mesh->face_count; c++) {
        if (mesh->vertex[c] >= mesh->vertex_count)
            return "a corner has a vertex";
        if (mesh->vertex[c] == mesh->vertex[enc_next_corner(c)])
            return "the vertices of a face differ";
        if (mesh->material && mesh->material[c / 3] >= mesh->material_count)
            return "a face has a material";
    }
    return NULL;
}

static const char *check_twins(const enc_mesh *mesh)
{
    const uint32_t *vertex = mesh->vertex;

    for (uint32_t h = 0; h < 3 * mesh->face_count; h++) {
        const uint32_t t = mesh->twin[h];
        if (t == ENC_NONE)
            continue;
        if (t >= 3 * mesh->face_count || mesh->twin[t] != h)
            return "a twin has a twin";
        if (vertex[t] != vertex[enc_next_corner(h)] ||
            vertex[h] != vertex[enc_next_corner(t)])
            return "twins run opposite ways";
        if (vertex[enc_previous_corner(t)] == vertex[enc_previous_corner(h)])
            return "twins are in faces over different vertices";
    }
    return NULL;
}

/*
 * Walks every fan once. A corner met in the walk of another one is in its fan,
 * so a second walk at one vertex is a second fan; a neighbour met twice in one
 * is an edge that occurs twice. Joined, neighbours may be the same vertex.
 */
static const char *check_fans(const enc_mesh *mesh, uint32_t *visited,
                              uint32_t *fans, uint32_t *met)
{
    const uint32_t *vertex = mesh->vertex, *twin = mesh->twin;
    const uint32_t most = mesh->joined ? PMESH_MAX_FANS : 1;

    for (uint32_t c = 0; c < 3 * mesh->face_count; c++) {
        const uint32_t v = vertex[c];
        if (enc_bit_get(visited, c))
            continue;
        if (fans[v]++ == most)
            return mesh->joined ? "a vertex has not too many fans"
                                : "a vertex has one fan";
        uint32_t begin = c;
        while (twin[begin] != ENC_NONE) {
            begin = enc_next_corner(twin[begin]);
            if (begin == c)
                break;
        }
        uint32_t x = begin;
        do {
            enc_bit_put(visited, x);
            const uint32_t tip = vertex[enc_next_corner(x)];
            if (!mesh->joined && met[tip] == v + 1)
                return "two vertices have one edge";
            met[tip] = v + 1;
            const uint32_t end = vertex[enc_previous_corner(x)];
            x = twin[enc_previous_corner(x)];
            if (!mesh->joined && x == ENC_NONE && met[end] == v + 1)
                return "two vertices have one edge";
        } while (x != ENC_NONE && x != begin);
    }
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        if (fans[v] == 0)
            return "every vertex is in use";
    return NULL;
}

static const char *check_wedges(const enc_mesh *mesh, uint32_t *used)
{
    if (mesh->value_count == 0)
        return mesh->wedge || mesh->wedge_count != mesh->vertex_count
            ? "without attributes wedges are vertices" : NULL;
    for (uint32_t c = 0; c < 3 * mesh->face_count; c++) {
        const uint32_t w = mesh->wedge[c];
        if (w >= mesh->wedge_count ||
            mesh->wedge_vertex[w] != mesh->vertex[c])
            return "a corner's wedge is one of its vertex";
        enc_bit_put(used, w);
    }
    for (uint32_t w = 0; w < mesh->wedge_count; w++)
        if (!enc_bit_get(used, w))
            return "every wedge is in use";
    return NULL;
}

const char *enc_mesh_check(const enc_mesh *mesh)
{
    const pmesh_allocator *a = &mesh->allocator;
    const size_t words = enc_bit_words(3 * (size_t)mesh->face_count);

    if (mesh->vertex_count > 3 * mesh->face_count ||
        mesh->wedge_count > 3 * mesh->face_count)
        return "there are no more vertices or wedges than corners";
    const char *broken = check_positions(mesh);
    broken = broken ? broken : check_faces(mesh);
    broken = broken ? broken : check_twins(mesh);
    if (broken)
        return broken;

    uint32_t *visited = pmesh_alloc_zero(a, words, sizeof *visited);
    uint32_t *marked = pmesh_alloc_zero(a, words, sizeof *marked);
    uint32_t *met = pmesh_alloc_zero(a, mesh->vertex_count, sizeof *met);
    uint32_t *fans = pmesh_alloc_zero(a, mesh->vertex_count, sizeof *fans);
    if (visited && marked && met && fans) {
        broken = check_fans(mesh, visited, fans, met);
        broken = broken ? broken : check_wedges(mesh, marked);
    } else {
        broken = "out of memory";
    }
    pmesh_release(a, fans, mesh->vertex_count, sizeof *fans);
    pmesh_release(a, met, mesh->vertex_count, sizeof *met);
    pmesh_release(a, marked, words, sizeof *marked);
    pmesh_release(a, visited, words, sizeof *visited);
    return broken;
}
