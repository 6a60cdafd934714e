/* SPDX-License-Identifier: MIT */
#include "tests/reference/author.h"

#include <stdlib.h>
#include <string.h>

#include "tests/golden/golden_mesh.h"
#include "tests/reference/chunks.h"
#include "tests/reference/ref.h"

/* ---- the file that it starts from --------------------------------------- */

static shape_bytes bake_spindle(uint32_t ring)
{
    golden_mesh mesh;
    shape_bytes out;
    pmesh_encode_report report;
    pmesh_encoder_config config = pmesh_encoder_config_default();
    golden_mesh_make(&mesh, GOLDEN_SPINDLE, ring);
    float *uv = calloc(2 * mesh.input.vertex_count, sizeof *uv);
    for (size_t i = 0; i < 2 * mesh.input.vertex_count; i++)
        uv[i] = (float)mesh.input.positions[3 * (i / 2) + i % 2];
    const pmesh_attribute_input channel = { .kind = PMESH_TEXCOORD,
                                            .components = 2,
                                            .values = uv,
                                            .count = mesh.input.vertex_count };
    mesh.shape->input.attributes = &channel;
    mesh.shape->input.attribute_count = 1;
    config.base_faces = (uint32_t)mesh.input.face_count - 2;
    shape_bake(mesh.shape, &config, &out, &report);
    free(uv);
    golden_mesh_free(&mesh);
    return out;
}

/* The header's limits rise to what a wide split needs. Behind 43 bytes come
 * seven varints (SPEC 5.3): of these chunk_size and moved_corners change. */
static chunk raise_limits(const chunk *header)
{
    static const uint8_t large[] = { 0x80, 0x80, 1 }, corners[] = { 48 };
    shape_bytes out = { 0 };
    size_t at = 43;
    bytes_put(&out, header->data, at);
    for (int field = 0; field < 8; field++) {
        const size_t start = at;
        while (header->data[at++] >= 128)
            ;
        if (field == 4)
            bytes_put(&out, large, sizeof large);
        else if (field == 7)
            bytes_put(&out, corners, sizeof corners);
        else
            bytes_put(&out, header->data + start, at - start);
    }
    bytes_put(&out, header->data + at, header->size - at);
    const chunk raised = chunk_make(CHUNK_HEADER, out.data, out.size);
    free(out.data);
    return raised;
}

/* ---- the split ---------------------------------------------------------- */

typedef struct wish {
    const ref *r;
    uint32_t ring, rank;
} wish;

/* Splits the wide vertex alone; all else as expected. */
static int choose(void *user, const ref_model *m)
{
    wish *w = user;
    const ref *r = w->r;
    if (m >= r->flag && m < r->flag + 1680)
        return ref_degree(r, r->order[r->order_at - 1]) == w->ring;
    if (m >= r->cut.rank[0][0] && m < r->cut.rank[0][0] + 256)
        return w->rank > 0 ? (int)(w->rank--, 1) : 0;
    return 0;
}

static bool write_block(ref *r, ref_author *author)
{
    static const uint8_t one_split = 1;
    r->header.moved_corners = 48;
    r->in.author = author;
    if (setjmp(r->stop))
        return false;
    ref_read_block(r, &one_split, 1, true);
    ref_author_end(author);
    return true;
}

uint32_t author_wide_split(uint32_t ring, uint32_t rank, shape_bytes *out)
{
    shape_bytes file = bake_spindle(ring);
    chunks c;
    uint32_t degree = 0;
    chunks_take_apart(&file, &c);
    /* All but the block, its checksum and the end. */
    size_t size = file.size;
    for (uint32_t i = 0; i < c.count; i++)
        if (c.at[i].type == CHUNK_LAST)
            size -= c.at[i].size + 6;
    ref *r = ref_decode(file.data, size - 6);
    wish w = { r, ring, rank };
    ref_author author = { .choose = choose, .user = &w };
    *out = (shape_bytes){ 0 };
    if (r->has_base && write_block(r, &author) && w.rank == 0) {
        degree = ref_degree(r, r->vertex_count - 1);
        const chunk header = raise_limits(&c.at[0]);
        free(c.at[0].data);
        c.at[0] = header;
        for (uint32_t i = 0; i < c.count; i++)
            if (c.at[i].type == CHUNK_LAST) {
                free(c.at[i].data);
                c.at[i] = chunk_make(CHUNK_LAST, NULL, 0);
                c.at[i].data = realloc(c.at[i].data, author.size + 1);
                c.at[i].data[0] = 1;
                memcpy(c.at[i].data + 1, author.data, author.size);
                c.at[i].size = author.size + 1;
            }
    }
    *out = chunks_put_together(&c);
    free(author.data);
    free(file.data);
    ref_free(r);
    return degree;
}
