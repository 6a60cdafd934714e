/* SPDX-License-Identifier: MIT */
/*
 * golden_bake DIR [THREADS] - writes the golden files: small files that
 * together reach every element of the format but two: a Draco base, which needs
 * a hook, and prediction in a ring of more than 48 members (SPEC 6.5), which no
 * mesh was found to lead the encoder to.
 *
 * They name what a decoder of this format version must read, so they change
 * only with the version (0 is a draft, and changes with every byte).
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "encoder/pmesh_scene_encode.h"
#include "format/crc32c.h"
#include "format/cursor.h"
#include "format/layout.h"
#include "tests/golden/golden_mesh.h"

typedef struct golden_case {
    const char *name;
    int mesh;
    uint32_t size, base_faces; /* of pmesh_encoder_config; 1: all the way */
    pmesh_profile profile;
    pmesh_placement placement;
    uint8_t bits;
} golden_case;

/* Sheets and pieces are kept apart in these ... */
static const golden_case kept[] = {
    { "triangle", GOLDEN_TRIANGLE, 3, 1, PMESH_BALANCED, PMESH_SUBSET, 4 },
    { "closed", SHAPE_TORUS, 72, 1, PMESH_COMPACT, PMESH_SUBSET, 12 },
    { "closed-moving", SHAPE_TORUS, 16, 40, PMESH_QUALITY, PMESH_OPTIMAL, 21 },
    { "open", SHAPE_TERRAIN, 20, 20, PMESH_BALANCED, PMESH_SUBSET, 14 },
    { "open-moving", SHAPE_TERRAIN, 14, 1, PMESH_QUALITY, PMESH_OPTIMAL, 24 },
    { "seam", SHAPE_SPHERE, 12, 30, PMESH_BALANCED, PMESH_SUBSET, 13 },
    { "seam-moving", SHAPE_SPHERE, 10, 1, PMESH_QUALITY, PMESH_OPTIMAL, 16 },
    { "facets", SHAPE_FACETS, 10, 1, PMESH_COMPACT, PMESH_SUBSET, 10 },
    { "facets-moving", SHAPE_FACETS, 9, 30, PMESH_QUALITY, PMESH_OPTIMAL, 4 },
    { "materials", GOLDEN_PATCHES, 18, 1, PMESH_BALANCED, PMESH_SUBSET, 8 },
    { "pieces", SHAPE_PIECES, 40, 20, PMESH_BALANCED, PMESH_SUBSET, 11 },
    { "cuts", SHAPE_SOUP, 40, 1, PMESH_BALANCED, PMESH_OPTIMAL, 7 },
    { "spikes", GOLDEN_SPIKES, 24, 1, PMESH_BALANCED, PMESH_SUBSET, 24 },
    { "hub", GOLDEN_FAN, 55, 1, PMESH_QUALITY, PMESH_SUBSET, 4 },
    { "hubs", GOLDEN_SPINDLE, 60, 400, PMESH_BALANCED, PMESH_SUBSET, 9 },
    { "hubs-moving", GOLDEN_SPINDLE, 60, 1, PMESH_COMPACT, PMESH_OPTIMAL, 15 },
    { "measured", SHAPE_FACETS, 8, 1, PMESH_BALANCED, PMESH_SUBSET, 6 },
    { "blocks", GOLDEN_CHANNELS, 40, 1700, PMESH_COMPACT, PMESH_OPTIMAL, 24 },
};

/* ... and join in these. */
static const golden_case joined[] = {
    { "joined", SHAPE_SOUP, 90, 1, PMESH_COMPACT, PMESH_SUBSET, 9 },
    { "leaves", GOLDEN_LEAVES, 42, 1, PMESH_BALANCED, PMESH_SUBSET, 12 },
    { "leaves-moving", GOLDEN_LEAVES, 40, 60, PMESH_QUALITY, PMESH_OPTIMAL,
      15 },
};

/* Puts a chunk that no decoder knows in front of the end chunk, where it moves
 * no byte that the level table counts. */
static void insert_skippable(shape_bytes *b)
{
    enum { END_SIZE = 2 + PMESH_CRC_SIZE };
    uint8_t chunk[] = { 0x85, 3, 'a', 'b', 'c', 0, 0, 0, 0 };
    const uint32_t crc = pmesh_crc32c(0, chunk, 5);
    for (int i = 0; i < PMESH_CRC_SIZE; i++)
        chunk[5 + i] = (uint8_t)(crc >> (8 * i));
    b->data = realloc(b->data, b->size + sizeof chunk);
    uint8_t *end = b->data + b->size - END_SIZE;
    memmove(end + sizeof chunk, end, END_SIZE);
    memcpy(end, chunk, sizeof chunk);
    b->size += sizeof chunk;
}

/* Notes in seen[] the types of the chunks. */
static void note_chunks(const shape_bytes *b, unsigned char seen[256])
{
    pmesh_cursor in = pmesh_cursor_make(b->data, b->size);
    pmesh_get(&in, PMESH_SIGNATURE_SIZE);
    while (in.next < in.end && !in.overrun) {
        seen[pmesh_get_u8(&in)] = 1;
        for (uint64_t n = pmesh_get_varint(&in) + PMESH_CRC_SIZE; n > 0; n--)
            pmesh_get_u8(&in);
    }
}

static int collect(void *user, const void *data, size_t size)
{
    shape_bytes *to = user;
    uint8_t *all = realloc(to->data, to->size + size + 1);
    if (!all)
        return 1;
    memcpy(all + to->size, data, size);
    to->data = all;
    to->size += size;
    return 0;
}

static int bake(const golden_case *g, pmesh_topology topology,
                uint32_t threads, shape_bytes *out)
{
    golden_mesh mesh;
    pmesh_encode_report report;
    pmesh_encoder_config config = pmesh_encoder_config_default();
    config.profile = g->profile;
    config.placement = g->placement;
    config.position_bits = g->bits;
    config.base_faces = g->base_faces;
    config.threads = threads;
    config.topology = topology;
    config.measure = !strcmp(g->name, "measured");
    golden_mesh_make(&mesh, g->mesh, g->size);
    mesh.shape->input = mesh.input;
    const pmesh_status status = shape_bake(mesh.shape, &config, out, &report);
    golden_mesh_free(&mesh);
    if (status != PMESH_OK)
        fprintf(stderr, "%s: %s\n", g->name, pmesh_status_text(status));
    else if (!strcmp(g->name, "blocks"))
        insert_skippable(out);
    return status == PMESH_OK;
}

/* Three meshes with a document and resources before and
 * behind them. */
static int bake_scene(uint32_t threads, shape_bytes *out)
{
    enum { MESHES = 3 };
    static const golden_case cases[MESHES] = {
        { "scene 0", SHAPE_SPHERE, 14, 30, PMESH_BALANCED, PMESH_SUBSET, 12 },
        { "scene 1", SHAPE_TORUS, 24, 40, PMESH_QUALITY, PMESH_OPTIMAL, 11 },
        { "scene 2", SHAPE_TERRAIN, 16, 20, PMESH_COMPACT, PMESH_SUBSET, 10 }
    };
    static const float scale[MESHES] = { 1, 0.25f, 3 };
    static const char document[] = "document", early[] = "early";
    static uint8_t late[40000]; /* more than one chunk takes */
    const pmesh_scene_blob resources[] = { { early, sizeof early },
                                           { late, sizeof late },
                                           { NULL, 0 } };
    shape_bytes streams[MESHES];
    pmesh_scene_mesh_input meshes[MESHES];
    int good = 1;
    for (int i = 0; i < MESHES; i++) {
        good = bake(&cases[i], PMESH_TOPOLOGY_AUTO, threads, &streams[i]) &&
               good;
        meshes[i] = (pmesh_scene_mesh_input){ streams[i].data,
                                              streams[i].size, scale[i] };
    }
    const pmesh_scene_input scene = {
        .meshes = meshes, .mesh_count = MESHES,
        .document = { document, sizeof document },
        .resources = resources, .resource_count = 3, .early_count = 1
    };
    *out = (shape_bytes){ 0 };
    good = good && pmesh_scene_encode(&scene, NULL, collect, out, NULL) ==
                       PMESH_OK;
    for (int i = 0; i < MESHES; i++)
        free(streams[i].data);
    return good;
}

static int write_file(const char *dir, const char *name, const shape_bytes *b)
{
    char path[1024];
    snprintf(path, sizeof path, "%s/%s.pmesh", dir, name);
    FILE *out = fopen(path, "wb");
    const int good = out && fwrite(b->data, 1, b->size, out) == b->size;
    if (!out || fclose(out) != 0 || !good) {
        perror(path);
        return 0;
    }
    return 1;
}

/* A change of the encoder must not silently thin out the set. */
static int is_complete(const unsigned char seen[256])
{
    static const unsigned char wanted[] = {
        PMESH_CHUNK_HEADER,     PMESH_CHUNK_BASE, PMESH_CHUNK_BLOCK,
        PMESH_CHUNK_BLOCK_LAST, PMESH_CHUNK_END,  PMESH_CHUNK_NAMES
    };
    for (size_t i = 0; i < sizeof wanted; i++)
        if (!seen[wanted[i]]) {
            fprintf(stderr, "no golden file has a chunk of type %u\n",
                    wanted[i]);
            return 0;
        }
    return 1;
}

static int bake_all(const golden_case *list, size_t count,
                    pmesh_topology topology, uint32_t threads, const char *dir,
                    unsigned char seen[256])
{
    for (size_t i = 0; i < count; i++) {
        shape_bytes bytes;
        if (!bake(&list[i], topology, threads, &bytes) ||
            !write_file(dir, list[i].name, &bytes))
            return 0;
        note_chunks(&bytes, seen);
        free(bytes.data);
    }
    return 1;
}

int main(int argc, char **argv)
{
    unsigned char seen[256] = { 0 };
    if (argc < 2 || argc > 3) {
        fprintf(stderr, "usage: golden_bake DIR [THREADS]\n");
        return 2;
    }
    const uint32_t threads =
        argc > 2 ? (uint32_t)strtoul(argv[2], NULL, 10) : 1;
    shape_bytes scene;
    if (!bake_scene(threads, &scene) ||
        !write_file(argv[1], "scene", &scene))
        return 1;
    free(scene.data);
    return !bake_all(kept, sizeof kept / sizeof *kept, PMESH_TOPOLOGY_KEEP,
                     threads, argv[1], seen) ||
           !bake_all(joined, sizeof joined / sizeof *joined,
                     PMESH_TOPOLOGY_JOIN, threads, argv[1], seen) ||
           !is_complete(seen);
}
