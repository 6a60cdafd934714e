/* SPDX-License-Identifier: MIT */
/* Bytes become options and a small mesh, any doubles among its positions: what
 * pmesh_simplify_mesh() gives is sound, within its bounds, and the same again. */
#include <stdlib.h>
#include <string.h>

#include "format/cursor.h"
#include "tests/fuzz/fuzz.h"
#include "tests/unit/lods.h"

enum { VERTICES = 60, FACES = 200 };

static void read_options(pmesh_cursor *in, lods *l)
{
    const uint8_t bits = pmesh_get_u8(in), more = pmesh_get_u8(in);
    pmesh_simplify_options *o = &l->options;
    o->faces = bits & 1 ? pmesh_get_u8(in) % 64u : 0;
    o->error = bits & 2 ? pmesh_get_u8(in) / 64.0 : 0;
    o->ratio = bits & 4 ? pmesh_get_u8(in) / 256.0 : 0;
    o->vertices = bits & 8 ? pmesh_get_u8(in) % 32u : 0;
    o->placement = (pmesh_place)((bits >> 4) % 6);
    o->metric = (pmesh_metric)(bits >> 7);
    o->cost = (pmesh_cost)(more & 3);
    o->threshold = more & 4 ? 2 : 0;
    o->weld = more & 8 ? 0.5 : 0;
    o->loose = more >> 4 & 1;
    o->turn_cosine = more & 32 ? 0.5 : -1;
}

static lods *read_mesh(pmesh_cursor *in)
{
    const uint8_t modes = pmesh_get_u8(in);
    const size_t vertices = 1 + pmesh_get_u8(in) % VERTICES;
    double xyz[3 * VERTICES];
    uint32_t tri[3 * FACES];
    size_t corners = 0;
    lods *l;

    for (size_t i = 0; i < 3 * vertices; i++)
        xyz[i] = modes & 1 ? pmesh_get_f64(in) : pmesh_get_u8(in) % 8;
    pmesh_cursor rest = *in; /* options and attributes overlap the faces */
    for (; corners + 3 <= 3 * FACES && in->next < in->end; corners += 3)
        for (size_t k = 0; k < 3; k++)
            tri[corners + k] = pmesh_get_u8(in) % (uint32_t)vertices;
    l = lods_copy(xyz, vertices, tri, corners / 3);
    read_options(&rest, l);
    if (modes & 2) {
        float *values = fuzz_room(3 * vertices * sizeof *values);
        for (size_t i = 0; i < 3 * vertices; i++)
            values[i] = (float)pmesh_get_u8(&rest) / 16 - 8;
        lods_add(l, (pmesh_attribute_kind)(modes >> 2 & 1 ? PMESH_NORMAL
                                                          : PMESH_COLOR),
                 3, values, 0.1f);
    }
    return l;
}

static void check(const lods *l, pmesh_status status)
{
    if (status != PMESH_OK) {
        FUZZ_CHECK(status == PMESH_E_NO_FACES ||
                   status == PMESH_E_NOT_FINITE);
        return;
    }
    const pmesh_simplify_output *out = &l->out;
    FUZZ_CHECK(lods_is_sound(l));
    FUZZ_CHECK(out->face_count + out->dropped_faces <= l->in.face_count);
    FUZZ_CHECK(out->error >= 0);
    if (out->end == PMESH_END_FACES && l->options.faces > 0 &&
        !(l->options.ratio > 0))
        FUZZ_CHECK(out->face_count <= l->options.faces);
    if (out->end == PMESH_END_VERTICES)
        FUZZ_CHECK(out->vertex_count <= l->options.vertices);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    lods *l[2];
    pmesh_status status[2];
    for (int i = 0; i < 2; i++) {
        pmesh_cursor in = pmesh_cursor_make(data, size);
        l[i] = read_mesh(&in);
        status[i] = lods_run(l[i]);
    }
    FUZZ_CHECK(status[0] == status[1]);
    check(l[0], status[0]);
    FUZZ_CHECK(status[0] != PMESH_OK ||
               (lods_same_faces(l[0], l[1]) &&
                memcmp(&l[0]->out.error, &l[1]->out.error,
                       sizeof(double)) == 0));
    lods_free(l[0]);
    lods_free(l[1]);
    return 0;
}
