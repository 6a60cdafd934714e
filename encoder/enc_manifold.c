/* SPDX-License-Identifier: MIT */
#include "encoder/enc_import.h"

#include "format/alloc.h"

/* Takes the faces in `dead` out again; their twins go with them. */
static pmesh_status drop_faces(enc_importer *im, const uint32_t *dead,
                               uint32_t dead_count)
{
    enc_mesh *mesh = im->mesh;
    const pmesh_allocator *a = &mesh->allocator;
    const size_t before = mesh->face_count, after = before - dead_count;
    uint32_t *vertex = pmesh_alloc(a, 3 * after, sizeof *vertex);
    uint32_t *source = pmesh_alloc(a, after, sizeof *source);
    uint32_t *material = NULL;
    size_t kept = 0;

    if (mesh->material)
        material = pmesh_alloc(a, after, sizeof *material);
    if (!vertex || !source || (mesh->material && !material)) {
        pmesh_release(a, vertex, 3 * after, sizeof *vertex);
        pmesh_release(a, source, after, sizeof *source);
        pmesh_release(a, material, after, sizeof *material);
        return PMESH_E_MEMORY;
    }
    for (size_t face = 0; face < before; face++) {
        if (enc_bit_get(dead, face))
            continue;
        memcpy(vertex + 3 * kept, mesh->vertex + 3 * face,
               3 * sizeof *vertex);
        if (material)
            material[kept] = mesh->material[face];
        source[kept++] = im->source[face];
    }
    pmesh_release(a, mesh->vertex, 3 * before, sizeof *vertex);
    pmesh_release(a, mesh->twin, 3 * before, sizeof *mesh->twin);
    pmesh_release(a, mesh->material, before, sizeof *material);
    pmesh_release(a, im->source, before, sizeof *source);
    mesh->vertex = vertex;
    mesh->twin = NULL;
    mesh->material = material;
    mesh->face_count = (uint32_t)after;
    im->source = source;
    im->source_count = after;
    return PMESH_OK;
}

/* Repeated faces are rare: where there are some, pairing runs twice. */
static pmesh_status pair_faces(enc_importer *im, bool *regular)
{
    const pmesh_allocator *a = &im->mesh->allocator;
    const size_t words = enc_bit_words(im->mesh->face_count);
    uint32_t *repeated = pmesh_alloc_zero(a, words, sizeof *repeated);
    enc_pairing pairing = { .repeated = repeated };

    if (!repeated)
        return PMESH_E_MEMORY;
    pmesh_status status = enc_pair(im->mesh, &pairing);
    if (!status && pairing.repeated_count > 0) {
        im->report->duplicate_faces = pairing.repeated_count;
        status = drop_faces(im, repeated, pairing.repeated_count);
        memset(repeated, 0, words * sizeof *repeated);
        if (!status)
            status = enc_pair(im->mesh, &pairing);
    }
    pmesh_release(a, repeated, words, sizeof *repeated);
    *regular = pairing.regular;
    return status;
}

static uint32_t find_piece(uint32_t *piece, uint32_t v)
{
    while (piece[v] != v) {
        piece[v] = piece[piece[v]];
        v = piece[v];
    }
    return v;
}

/* Pieces of the surface that share no vertex. Must precede the cutting. */
static pmesh_status count_components(enc_importer *im)
{
    const enc_mesh *mesh = im->mesh;
    const pmesh_allocator *a = &mesh->allocator;
    uint32_t *piece = pmesh_alloc(a, mesh->vertex_count, sizeof *piece);

    if (!piece)
        return PMESH_E_MEMORY;
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        piece[v] = v;
    im->report->components = mesh->vertex_count;
    for (uint32_t c = 0; c < 3 * mesh->face_count; c++) {
        const uint32_t v = find_piece(piece, mesh->vertex[c]);
        const uint32_t w =
            find_piece(piece, mesh->vertex[enc_next_corner(c)]);
        if (v == w)
            continue;
        piece[v > w ? v : w] = v > w ? w : v;
        im->report->components--;
    }
    pmesh_release(a, piece, mesh->vertex_count, sizeof *piece);
    return PMESH_OK;
}

/* Returns `old`, one item per vertex, with copies for the vertices from
 * old_count on; or NULL. Releases `old`. */
static void *copy_items(const enc_importer *im, uint32_t old_count, void *old,
                        size_t size)
{
    const enc_mesh *mesh = im->mesh;
    const pmesh_allocator *a = &mesh->allocator;
    unsigned char *items = pmesh_alloc(a, mesh->vertex_count, size);

    if (items) {
        memcpy(items, old, old_count * size);
        for (uint32_t c = 0; c < 3 * mesh->face_count; c++) {
            const size_t input = 3 * (size_t)im->source[c / 3] + c % 3;
            const uint32_t from = im->number[im->in->indices[input]];
            if (mesh->vertex[c] >= old_count)
                memcpy(items + mesh->vertex[c] * size,
                       (unsigned char *)old + from * size, size);
        }
    }
    pmesh_release(a, old, old_count, size);
    return items;
}

static pmesh_status copy_positions(enc_importer *im, uint32_t old_count)
{
    enc_mesh *mesh = im->mesh;
    const bool lossless = mesh->exact != NULL;

    if (mesh->vertex_count == old_count)
        return PMESH_OK;
    mesh->position =
        copy_items(im, old_count, mesh->position, sizeof *mesh->position);
    if (lossless)
        mesh->exact =
            copy_items(im, old_count, mesh->exact, sizeof *mesh->exact);
    return mesh->position && (mesh->exact || !lossless) ? PMESH_OK
                                                        : PMESH_E_MEMORY;
}

pmesh_status enc_make_manifold(enc_importer *im)
{
    const uint32_t old_count = im->mesh->vertex_count;
    bool regular = true;

    pmesh_status status = pair_faces(im, &regular);
    if (!status)
        status = count_components(im);
    if (!status)
        status = enc_cut(im->mesh, regular);
    if (!status)
        status = copy_positions(im, old_count);
    im->report->cut_vertices = im->mesh->vertex_count - old_count;
    return status;
}
