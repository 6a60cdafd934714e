/* SPDX-License-Identifier: MIT */
/*
 * Bytes become options and a small mesh on a small grid: at most 100 vertices,
 * index bytes modulo their number, as meshoptimizer's simplifyfuzz does. Baked
 * twice it gives the same bytes; decoded it is the input, and its levels are a
 * ladder.
 */
#include <stdlib.h>
#include <string.h>

#include "encoder/pmesh_encode.h"
#include "format/cursor.h"
#include "tests/fuzz/fuzz.h"
#include "tests/unit/faces.h"
#include "tests/unit/float_faces.h"

enum { VERTICES = 100, FACES = 400, TUPLES = 16 };

typedef struct model {
    double positions[3 * VERTICES];
    float values[2][4 * VERTICES];
    uint32_t indices[3 * FACES], corners[3 * FACES], materials[FACES];
    pmesh_attribute_input attributes[2];
    pmesh_mesh_input input;
    pmesh_encoder_config config;
    bool odd; /* positions are any doubles, NaN among them */
} model;

typedef struct bytes {
    uint8_t *data;
    size_t size;
} bytes;

static int append(void *user, const void *data, size_t size)
{
    bytes *b = user;
    b->data = realloc(b->data, b->size + size + 1);
    if (!b->data)
        return 1;
    if (size > 0)
        memcpy(b->data + b->size, data, size);
    b->size += size;
    return 0;
}

static void read_config(pmesh_cursor *in, model *m)
{
    pmesh_encoder_config *c = &m->config;
    const uint8_t modes = pmesh_get_u8(in), more = pmesh_get_u8(in);
    *c = pmesh_encoder_config_default();
    c->profile = (pmesh_profile)(modes % 3);
    c->placement = (pmesh_placement)(modes >> 2 & 1);
    c->metric = (pmesh_metric)(modes >> 3 & 1);
    c->lossless = modes >> 4 & 1;
    c->measure = modes >> 5 & 1;
    c->topology = (pmesh_topology)((modes >> 6) % 3);
    m->odd = more & 1;
    c->cost = (pmesh_cost)((more >> 1) % 4);
    c->threshold = more & 8 ? 1.5 : 0;
    c->position_bits = (uint8_t)(4 + pmesh_get_u8(in) % 21);
    c->base_faces = 1 + pmesh_get_u8(in) % 16;
}

/* A texture coordinate by corner, see read_faces(), and something by vertex. */
static void read_attributes(pmesh_cursor *in, model *m)
{
    const uint8_t kinds = pmesh_get_u8(in);
    size_t n = 0;
    if (kinds & 1) {
        for (size_t i = 0; i < 2 * TUPLES; i++)
            m->values[n][i] = (float)(pmesh_get_u8(in) % 8) / 7;
        m->attributes[n] = (pmesh_attribute_input){
            .kind = PMESH_TEXCOORD, .components = 2, .values = m->values[n],
            .count = TUPLES, .indices = m->corners
        };
        n++;
    }
    if (kinds & 2) {
        static const uint8_t components[] = { 3, 2, 4, 1 };
        const pmesh_attribute_kind kind = (pmesh_attribute_kind)(kinds >> 2 & 3);
        for (size_t i = 0; i < 4 * m->input.vertex_count; i++)
            m->values[n][i] = (float)(int8_t)pmesh_get_u8(in) / 64;
        m->attributes[n] = (pmesh_attribute_input){
            .kind = kind, .set = 1, .components = components[kind],
            .bits = (uint8_t)(kinds & 16 ? 4 : 0), .values = m->values[n],
            .count = m->input.vertex_count
        };
        n++;
    }
    m->input.attributes = m->attributes;
    m->input.attribute_count = n;
}

/* The rest of the bytes; seams and materials follow from a face's first vertex,
 * so that the bytes of a face are its vertices. */
static void read_faces(pmesh_cursor *in, model *m, uint32_t vertices)
{
    size_t face = 0;
    for (; face < FACES && in->next < in->end; face++) {
        uint32_t *v = m->indices + 3 * face;
        for (uint32_t k = 0; k < 3; k++)
            v[k] = pmesh_get_u8(in) % vertices;
        for (uint32_t k = 0; k < 3; k++)
            m->corners[3 * face + k] = (v[k] + (v[0] & 1)) % TUPLES;
        m->materials[face] = v[0] & 3;
    }
    m->input.face_count = face;
}

static double coordinate(pmesh_cursor *in, bool odd)
{
    return odd ? pmesh_get_f64(in) : pmesh_get_u8(in) % 10;
}

static void read_model(pmesh_cursor *in, model *m)
{
    read_config(in, m);
    const uint32_t vertices = 1 + pmesh_get_u8(in) % VERTICES;
    const bool painted = pmesh_get_u8(in) & 1;
    for (uint32_t i = 0; i < 3 * vertices; i++)
        m->positions[i] = coordinate(in, m->odd);
    m->input = (pmesh_mesh_input){ .positions = m->positions,
                                   .vertex_count = vertices,
                                   .indices = m->indices };
    read_attributes(in, m);
    read_faces(in, m, vertices);
    if (painted) {
        m->input.materials = m->materials;
        m->input.material_count = 4;
    }
}

/* Lossless: the very floats. */
static void check_floats(const model *m, pmesh_decoder *dec)
{
    float_face *in = fuzz_room(m->input.face_count * sizeof *in);
    pmesh_view v;
    pmesh_decoder_mesh(dec, &v);
    float_face *out = fuzz_room(v.face_count * sizeof *out);
    float *xyz = fuzz_room(12 * (size_t)v.vertex_count);
    pmesh_decoder_copy_positions(dec, xyz, 0);
    const size_t a = float_faces_of(m->positions, m->input.vertex_count,
                                    m->indices, m->input.face_count, in);
    const size_t b = float_faces(xyz, v.indices, v.face_count, out);
    FUZZ_CHECK(a == b && memcmp(in, out, a * sizeof *in) == 0);
    free(xyz);
    free(out);
    free(in);
}

static void check_file(const model *m, const bytes *file,
                       const pmesh_encode_report *report, fuzz_dice *dice)
{
    pmesh_status status;
    pmesh_header h;
    pmesh_decoder *dec = fuzz_decode(file->data, file->size, &status);
    FUZZ_CHECK(status == PMESH_OK && report->bytes == file->size);
    pmesh_decoder_header(dec, &h);
    FUZZ_CHECK(h.faces == report->faces && h.bytes == file->size);
    FUZZ_CHECK(h.level_count == report->level_count);
    if (!m->odd) {
        FUZZ_CHECK(faces_match(&m->input, dec));
        if (m->config.lossless)
            check_floats(m, dec);
    }
    fuzz_use(dec, dice);
    pmesh_decoder_destroy(dec);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_dice dice = fuzz_dice_of(data, size);
    pmesh_cursor in = pmesh_cursor_make(data, size);
    model *m = calloc(1, sizeof *m);
    pmesh_encode_report report[2] = { { .faces = 0 }, { .faces = 0 } };
    bytes file[2] = { { NULL, 0 }, { NULL, 0 } };
    pmesh_status status[2];

    FUZZ_CHECK(m);
    read_model(&in, m);
    for (int i = 0; i < 2; i++) {
        m->config.threads = (uint32_t)i + 1;
        status[i] = pmesh_encode(&m->input, &m->config, append, &file[i],
                                 &report[i]);
    }
    FUZZ_CHECK(status[0] == status[1] && file[0].size == file[1].size);
    FUZZ_CHECK(status[0] == PMESH_OK || status[0] == PMESH_E_NO_FACES ||
               (m->odd && status[0] == PMESH_E_NOT_FINITE));
    if (status[0] == PMESH_OK) {
        FUZZ_CHECK(memcmp(file[0].data, file[1].data, file[0].size) == 0);
        check_file(m, &file[0], &report[0], &dice);
    }
    free(file[0].data);
    free(file[1].data);
    free(m);
    return 0;
}
