/* SPDX-License-Identifier: MIT */
/*
 * golden_decode FILE... - prints hashes of all that the decoder tells about
 * each file, in a few states of refinement. Equal text means equal results, to
 * the last bit of the last float. Of a bad file it prints what is shown before
 * and after the failure, and the verdict; then the exit code is 1.
 *
 * Needs the decoder and stdio only, so that it runs wherever a C compiler
 * reaches. Numbers are hashed byte by byte, least significant first: the order
 * of a machine's bytes and the padding of its structs do not show.
 */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "decoder/pmesh_scene.h"

static const uint64_t hash_start = 0xcbf29ce484222325u; /* FNV-1a */

static uint64_t hash_number(uint64_t h, uint64_t value, unsigned bytes)
{
    for (unsigned i = 0; i < bytes; i++)
        h = (h ^ (value >> (8 * i) & 0xff)) * 0x100000001b3u;
    return h;
}

static uint64_t hash_f32(uint64_t h, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return hash_number(h, bits, 4);
}

static uint64_t hash_f64(uint64_t h, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return hash_number(h, bits, 8);
}

/* ---- a file ------------------------------------------------------------ */

static uint64_t hash_attribute(uint64_t h, const pmesh_attribute *a)
{
    h = hash_number(h, a->kind, 1);
    h = hash_number(h, a->set, 1);
    h = hash_number(h, a->components, 1);
    h = hash_number(h, a->bits, 1);
    for (int i = 0; a->kind != PMESH_NORMAL && i < a->components; i++)
        h = hash_f32(hash_f32(h, a->minimum[i]), a->scale[i]);
    return h;
}

static uint64_t hash_level(uint64_t h, const pmesh_level *l)
{
    h = hash_number(h, l->bytes, 8);
    h = hash_number(h, l->faces, 4);
    h = hash_number(h, l->mesh_vertices, 4);
    h = hash_number(h, l->vertices, 4);
    return hash_f32(h, l->error);
}

/* All but `memory`, which differs with the size of a pointer. */
static uint64_t hash_header(const pmesh_header *header)
{
    uint64_t h = hash_number(hash_start, header->format_version, 4);
    h = hash_number(h, header->profile, 1);
    h = hash_number(h, header->placement, 1);
    for (int i = 0; i < 3; i++)
        h = hash_f64(h, header->grid.origin[i]);
    h = hash_f64(h, header->grid.step);
    h = hash_number(h, header->grid.bits, 1);
    for (int i = 0; i < 3; i++)
        h = hash_number(h, (uint32_t)header->bounds[i], 4);
    for (uint32_t i = 0; i < header->attribute_count; i++)
        h = hash_attribute(h, &header->attributes[i]);
    for (uint32_t i = 0; i < header->level_count; i++)
        h = hash_level(h, &header->levels[i]);
    return h;
}

static uint64_t hash_names(const pmesh_decoder *dec, uint32_t count)
{
    uint64_t h = hash_number(hash_start, count, 4);
    for (uint32_t i = 0; i < count; i++) {
        const char *name = pmesh_decoder_material_name(dec, i);
        do
            h = hash_number(h, (unsigned char)*name, 1);
        while (*name++);
    }
    return h;
}

static uint64_t hash_parents(const pmesh_decoder *dec, uint32_t count)
{
    uint64_t h = hash_start;
    for (uint32_t v = 0; v < count; v++)
        h = hash_number(h, pmesh_decoder_parent(dec, v), 4);
    return h;
}

/* ---- a state ----------------------------------------------------------- */

static uint64_t hash_indices(const pmesh_view *v)
{
    uint64_t h = hash_start;
    for (size_t i = 0; i < 3 * (size_t)v->face_count; i++)
        h = hash_number(h, v->indices[i], 4);
    for (uint32_t i = 0; v->positions_of && i < v->vertex_count; i++)
        h = hash_number(h, v->positions_of[i], 4);
    return h;
}

static uint64_t hash_positions(const pmesh_view *v)
{
    uint64_t h = hash_start;
    for (size_t i = 0; i < 3 * (size_t)v->mesh_vertex_count; i++)
        h = hash_number(h, (uint32_t)v->positions[i], 4);
    return h;
}

static uint64_t hash_values(const pmesh_view *v)
{
    uint64_t h = hash_start;
    const size_t count = (size_t)v->value_stride * v->vertex_count;
    for (size_t i = 0; v->values && i < count; i++)
        h = hash_number(h, v->values[i], 2);
    return h;
}

static uint64_t hash_materials(const pmesh_view *v)
{
    uint64_t h = hash_start;
    for (uint32_t i = 0; v->materials && i < v->face_count; i++)
        h = hash_number(h, v->materials[i], 4);
    return h;
}

/* Dequantised positions, then attributes, and the error of the view. `room`
 * holds a tuple of PMESH_MAX_COMPONENTS for every output vertex. */
static uint64_t hash_floats(const pmesh_decoder *dec, const pmesh_header *file,
                            const pmesh_view *v, float *room)
{
    uint64_t h = hash_f32(hash_start, v->error);
    pmesh_decoder_copy_positions(dec, room, 0);
    for (size_t i = 0; i < 3 * (size_t)v->vertex_count; i++)
        h = hash_f32(h, room[i]);
    for (uint32_t a = 0; a < file->attribute_count; a++) {
        const size_t count =
            (size_t)file->attributes[a].components * v->vertex_count;
        pmesh_decoder_copy_attribute(dec, a, room, 0);
        for (size_t i = 0; i < count; i++)
            h = hash_f32(h, room[i]);
    }
    return h;
}

static uint64_t hash_ranges(uint64_t h, const pmesh_range *r, uint32_t count)
{
    h = hash_number(h, count, 4);
    for (uint32_t i = 0; i < count; i++)
        h = hash_number(hash_number(h, r[i].first, 4), r[i].count, 4);
    return h;
}

static void print_hash(uint64_t h)
{
    if (h == hash_start)
        printf(" -"); /* there is nothing of the kind */
    else
        printf(" %016" PRIx64, h);
}

static void print_state(const pmesh_decoder *dec, const char *name,
                        const pmesh_header *file, const pmesh_changes *c,
                        float *room)
{
    pmesh_view v;
    printf("  %-5s", name);
    if (pmesh_decoder_mesh(dec, &v) != PMESH_OK) {
        printf(" nothing yet\n");
        return;
    }
    printf(" %5" PRIu32 " %5" PRIu32, v.face_count, v.vertex_count);
    print_hash(hash_indices(&v));
    print_hash(hash_positions(&v));
    print_hash(hash_values(&v));
    print_hash(hash_materials(&v));
    print_hash(hash_floats(dec, file, &v, room));
    print_hash(hash_ranges(
        hash_ranges(hash_start, c->vertices, c->vertex_range_count), c->faces,
        c->face_range_count));
    printf("\n");
}

/* Where and why a file is refused; or it only ends too early. */
static void print_verdict(pmesh_status status, pmesh_decode_error error)
{
    if (status < 0)
        printf("  refused: %s, byte %" PRIu64 ": %s\n",
               pmesh_status_text(status), error.offset, error.rule);
    else
        printf("  incomplete\n");
}

/* ---- the walk ---------------------------------------------------------- */

static void move(pmesh_decoder *dec, const char *name,
                 const pmesh_header *file, pmesh_target target, float *room)
{
    pmesh_changes changes = { 0 };
    pmesh_decoder_refine(dec, &target, &changes);
    print_state(dec, name, file, &changes, room);
}

/* Up and down through all that was decoded; `all` faces are the most. */
static void walk(pmesh_decoder *dec, const pmesh_header *file, float *room)
{
    const uint32_t all = file->faces;
    const double error = (double)file->levels[file->level_count / 2].error;
    const uint64_t half = file->bytes / 2;
    move(dec, "all", file, (pmesh_target){ .faces = all }, room);
    move(dec, "1/2", file, (pmesh_target){ .faces = all / 2 }, room);
    move(dec, "9/10", file, (pmesh_target){ .faces = all / 10 * 9 }, room);
    move(dec, "base", file, (pmesh_target){ .faces = 1 }, room);
    move(dec, "1/5", file, (pmesh_target){ .faces = all / 5 }, room);
    move(dec, "error", file, (pmesh_target){ .error = error }, room);
    move(dec, "bytes", file, (pmesh_target){ .bytes = half }, room);
    move(dec, "again", file, (pmesh_target){ 0 }, room);
}

/* The first half byte by byte (and more, if that lacks the header), then what
 * it shows, then the rest. */
static pmesh_status print_states(pmesh_decoder *dec, const uint8_t *data,
                                 size_t size, pmesh_header *file)
{
    pmesh_status status = PMESH_NEED_DATA;
    size_t at = 0;
    while (at < size && status == PMESH_NEED_DATA &&
           (at < size / 2 || pmesh_decoder_header(dec, file) != PMESH_OK))
        status = pmesh_decoder_feed(dec, data + at++, 1);
    if (status < 0)
        return status;
    float *room =
        malloc(PMESH_MAX_COMPONENTS * sizeof *room * (size_t)file->vertices);
    if (!room)
        return PMESH_E_MEMORY;
    move(dec, "half", file, (pmesh_target){ 0 }, room);
    status = pmesh_decoder_feed(dec, data + at, size - at);
    if (status == PMESH_OK)
        walk(dec, file, room);
    else
        move(dec, "good", file, (pmesh_target){ 0 }, room);
    free(room);
    return status;
}

static void print_whole(const pmesh_decoder *dec, size_t size,
                       const pmesh_header *file)
{
    printf("  file  %5zu bytes content %016" PRIx64 " header %016" PRIx64, size,
           file->content_hash, hash_header(file));
    printf(" names %016" PRIx64 " parents %016" PRIx64 "\n",
           hash_names(dec, file->material_count),
           hash_parents(dec, file->mesh_vertices));
}

static pmesh_status print_hashes(const uint8_t *data, size_t size)
{
    pmesh_decoder *dec;
    pmesh_header file = { 0 };
    pmesh_status status = pmesh_decoder_create(&dec, NULL);
    if (status != PMESH_OK)
        return status;
    status = print_states(dec, data, size, &file);
    if (status == PMESH_OK)
        print_whole(dec, size, &file);
    else
        print_verdict(status, pmesh_decoder_error(dec));
    pmesh_decoder_destroy(dec);
    return status;
}

/* ---- scenes ------------------------------------------------------------ */

static uint64_t hash_bytes(pmesh_scene_bytes b)
{
    uint64_t h = hash_number(hash_start, b.size, 8);
    for (uint64_t i = 0; i < b.arrived; i++)
        h = hash_number(h, b.data[i], 1);
    return h;
}

static uint64_t hash_scene_header(pmesh_scene *s, const pmesh_scene_header *h)
{
    uint64_t hash = hash_number(hash_start, h->document_form, 1);
    for (uint32_t i = 0; i < h->level_count; i++) {
        hash = hash_number(hash, h->levels[i].bytes, 8);
        hash = hash_number(hash, h->levels[i].faces, 8);
        hash = hash_number(hash, h->levels[i].vertices, 8);
        hash = hash_f32(hash, h->levels[i].error);
    }
    for (uint32_t i = 0; i < h->mesh_count; i++)
        hash = hash_f32(hash, pmesh_scene_scale(s, i));
    return hash;
}

static void print_scene(pmesh_scene *s, size_t size)
{
    pmesh_scene_header h = { 0 };
    pmesh_scene_get_header(s, &h);
    printf("  scene %5zu bytes content %016" PRIx64 " header %016" PRIx64
           " document %016" PRIx64 "\n", size, h.content_hash,
           hash_scene_header(s, &h), hash_bytes(pmesh_scene_document(s)));
    for (uint32_t i = 0; i < h.resource_count; i++)
        printf("  resource %016" PRIx64 "\n",
               hash_bytes(pmesh_scene_resource(s, i)));
}

/* What the target makes of each mesh that is there. */
static void move_scene(pmesh_scene *s, const char *name,
                       pmesh_scene_target target)
{
    const pmesh_changes unchanged = { 0 };
    pmesh_scene_shown shown;
    pmesh_scene_header h;
    if (pmesh_scene_refine(s, &target, &shown) != PMESH_OK ||
        pmesh_scene_get_header(s, &h) != PMESH_OK)
        return;
    printf("  %s: %" PRIu32 " meshes, %" PRIu64 " faces, error %016" PRIx64
           "\n", name, shown.meshes, shown.faces,
           hash_f64(hash_start, shown.error));
    for (uint32_t i = 0; i < h.mesh_count; i++) {
        pmesh_decoder *dec = pmesh_scene_mesh(s, i);
        pmesh_header file;
        if (!dec || pmesh_decoder_header(dec, &file) != PMESH_OK)
            continue;
        float *room = malloc(PMESH_MAX_COMPONENTS * sizeof *room *
                             (size_t)file.vertices);
        if (room)
            print_state(dec, "", &file, &unchanged, room);
        free(room);
    }
}

static pmesh_status print_scene_hashes(const uint8_t *data, size_t size)
{
    pmesh_scene *s;
    pmesh_scene_header h;
    pmesh_status status = pmesh_scene_create(&s, NULL);
    if (status != PMESH_OK)
        return status;
    for (size_t at = 0; at < size / 12; at++)
        pmesh_scene_feed(s, data + at, 1);
    move_scene(s, "part", (pmesh_scene_target){ 0 });
    status = pmesh_scene_feed(s, data + size / 12, size - size / 12);
    if (status == PMESH_OK && pmesh_scene_get_header(s, &h) == PMESH_OK) {
        const pmesh_scene_level *some = &h.levels[h.level_count / 2];
        const double error = (double)some->error;
        move_scene(s, "all", (pmesh_scene_target){ 0 });
        move_scene(s, "base", (pmesh_scene_target){ .faces = 1 });
        move_scene(s, "faces",
                   (pmesh_scene_target){ .faces = some->faces + 5 });
        move_scene(s, "error", (pmesh_scene_target){ .error = error });
        move_scene(s, "bytes", (pmesh_scene_target){ .bytes = some->bytes });
        print_scene(s, size);
    } else {
        move_scene(s, "good", (pmesh_scene_target){ 0 });
        print_verdict(status, pmesh_scene_error(s));
    }
    pmesh_scene_destroy(s);
    return status;
}

static pmesh_status print_file(const uint8_t *data, size_t size)
{
    return pmesh_scene_probe(data, size) == PMESH_OK
               ? print_scene_hashes(data, size)
               : print_hashes(data, size);
}

/* The bytes of a file, all of which are small. */
static int read_file(const char *path, uint8_t *data, size_t capacity,
                     size_t *size)
{
    FILE *in = fopen(path, "rb");
    if (!in)
        return 0;
    *size = fread(data, 1, capacity, in);
    fclose(in);
    return *size < capacity;
}

int main(int argc, char **argv)
{
    static uint8_t data[1 << 18];
    int bad = argc < 2;
    printf("# state faces vertices; hashes of indices, positions, values,"
           " materials, floats, changes\n");
    for (int i = 1; i < argc; i++) {
        const char *slash = strrchr(argv[i], '/');
        printf("%s\n", slash ? slash + 1 : argv[i]);
        size_t size;
        if (!read_file(argv[i], data, sizeof data, &size)) {
            fprintf(stderr, "%s: cannot be read, or is too long\n", argv[i]);
            bad = 1;
        } else if (print_file(data, size) != PMESH_OK) {
            bad = 1;
        }
    }
    return bad;
}
