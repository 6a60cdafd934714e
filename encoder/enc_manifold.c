/* SPDX-License-Identifier: MIT */
#include "encoder/enc_import.h"

#include "encoder/enc_schedule.h"
#include "format/alloc.h"
#include "format/layout.h"

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

/* Vertices and faces of which the pieces are counted. */
typedef struct piece_count {
    const uint32_t *vertex; /* per corner */
    uint32_t corners, vertices;
    uint32_t *piece; /* scratch, per vertex */
    uint32_t count;
} piece_count;

static void count_pieces(void *user, uint32_t whole, unsigned worker)
{
    piece_count *p = user;
    uint32_t *piece = p->piece;

    (void)whole;
    (void)worker;
    for (uint32_t v = 0; v < p->vertices; v++)
        piece[v] = v;
    p->count = p->vertices;
    for (uint32_t c = 0; c < p->corners; c++) {
        const uint32_t v = find_piece(piece, p->vertex[c]);
        const uint32_t w = find_piece(piece, p->vertex[enc_next_corner(c)]);
        if (v == w)
            continue;
        piece[v > w ? v : w] = v > w ? w : v;
        p->count--;
    }
}

pmesh_status enc_count_pieces(const pmesh_allocator *a, const uint32_t *vertex,
                              uint32_t corners, uint32_t vertices,
                              uint32_t *count)
{
    piece_count p = { .vertex = vertex, .corners = corners,
                      .vertices = vertices };

    p.piece = pmesh_alloc(a, vertices, sizeof *p.piece);
    if (!p.piece)
        return PMESH_E_MEMORY;
    count_pieces(&p, 0, 0);
    pmesh_release(a, p.piece, vertices, sizeof *p.piece);
    *count = p.count;
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
    const bool asked = mesh->source != NULL;

    if (mesh->vertex_count == old_count)
        return PMESH_OK;
    mesh->position =
        copy_items(im, old_count, mesh->position, sizeof *mesh->position);
    if (lossless)
        mesh->exact =
            copy_items(im, old_count, mesh->exact, sizeof *mesh->exact);
    if (asked)
        mesh->source =
            copy_items(im, old_count, mesh->source, sizeof *mesh->source);
    return mesh->position && (mesh->exact || !lossless) &&
                   (mesh->source || !asked)
               ? PMESH_OK
               : PMESH_E_MEMORY;
}

/* Without joining, each piece keeps a face and three vertices. */
static bool wants_join(const enc_importer *im, uint32_t old_count)
{
    const pmesh_encoder_config *c = im->config;
    const uint32_t pieces = im->report->components;
    const uint32_t target = enc_base_target(c, im->mesh->face_count);
    if (c->topology != PMESH_TOPOLOGY_AUTO)
        return c->topology == PMESH_TOPOLOGY_JOIN;
    if (c->threshold > 0 || c->base_coder == PMESH_BASE_DRACO)
        return c->threshold > 0;
    return im->mesh->vertex_count > old_count ||
           (target > 0 && pieces > target) ||
           (c->base_vertices > 0 && pieces > c->base_vertices / 3);
}

/* Fans get their vertex of before back; those beyond the limit get another one
 * at the same place. */
static pmesh_status join_fans(enc_importer *im, const uint32_t *before,
                              uint32_t old_count)
{
    enc_mesh *mesh = im->mesh;
    const pmesh_allocator *a = &mesh->allocator;
    const uint32_t corners = 3 * mesh->face_count, fans = mesh->vertex_count;
    uint32_t *vertex = pmesh_alloc(a, fans, sizeof *vertex); /* of each fan */
    uint32_t *count = pmesh_alloc_zero(a, old_count, sizeof *count);
    uint32_t *latest = pmesh_alloc(a, old_count, sizeof *latest);
    const bool ready = vertex && count && latest;
    uint32_t next = old_count;

    if (ready)
        memset(vertex, 0xff, fans * sizeof *vertex);
    for (uint32_t c = 0; ready && c < corners; c++) {
        const uint32_t v = before[c], fan = mesh->vertex[c];
        if (vertex[fan] == ENC_NONE) {
            if (count[v]++ % PMESH_MAX_FANS == 0)
                latest[v] = count[v] == 1 ? v : next++;
            im->report->joined_vertices += count[v] == 2;
            vertex[fan] = latest[v];
        }
        mesh->vertex[c] = vertex[fan];
    }
    mesh->vertex_count = next;
    mesh->joined = true;
    pmesh_release(a, latest, old_count, sizeof *latest);
    pmesh_release(a, count, old_count, sizeof *count);
    pmesh_release(a, vertex, fans, sizeof *vertex);
    return ready ? PMESH_OK : PMESH_E_MEMORY;
}

/* Pieces are those before the cutting, and counted beside it. */
static pmesh_status cut_fans(enc_importer *im, bool regular)
{
    enc_mesh *mesh = im->mesh;
    const pmesh_allocator *a = &mesh->allocator;
    const size_t corners = 3 * (size_t)mesh->face_count;
    const uint32_t old_count = mesh->vertex_count;
    uint32_t *before = pmesh_alloc(a, corners, sizeof *before);
    piece_count pieces = { .vertex = before, .corners = (uint32_t)corners,
                           .vertices = old_count };
    pmesh_status status = PMESH_E_MEMORY;

    pieces.piece = pmesh_alloc(a, old_count, sizeof *pieces.piece);
    if (before && pieces.piece) {
        memcpy(before, mesh->vertex, corners * sizeof *before);
        enc_pool_begin(mesh->pool, 1, count_pieces, &pieces);
        status = enc_cut(mesh, regular);
        enc_pool_end(mesh->pool);
        im->report->components = pieces.count;
    }
    if (!status && wants_join(im, old_count))
        status = join_fans(im, before, old_count);
    pmesh_release(a, pieces.piece, old_count, sizeof *pieces.piece);
    pmesh_release(a, before, corners, sizeof *before);
    return status;
}

pmesh_status enc_make_manifold(enc_importer *im)
{
    const uint32_t old_count = im->mesh->vertex_count;
    bool regular = true;

    pmesh_status status = pair_faces(im, &regular);
    if (!status)
        status = cut_fans(im, regular);
    if (!status)
        status = copy_positions(im, old_count);
    im->report->joined = im->mesh->joined;
    im->report->cut_vertices = im->mesh->vertex_count - old_count;
    return status;
}
