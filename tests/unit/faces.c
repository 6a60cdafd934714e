/* SPDX-License-Identifier: MIT */
#include "tests/unit/faces.h"

#include <stdlib.h>
#include <string.h>

#include "format/quantize.h"

enum { CORNER = 3 + 16, FACE = 3 * CORNER + 1 };

/* A face as numbers: of each corner its grid point and coded attributes, then
 * the material. */
typedef struct face_record {
    int32_t x[FACE];
} face_record;

static int compare_faces(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(face_record));
}

/* The rotation that compares least. */
static void rotate_face(face_record *f)
{
    face_record best = *f;
    for (int turn = 1; turn < 3; turn++) {
        face_record t = *f;
        for (int k = 0; k < 3; k++)
            memcpy(t.x + CORNER * k, f->x + CORNER * ((turn + k) % 3),
                   CORNER * sizeof *t.x);
        if (compare_faces(&t, &best) < 0)
            best = t;
    }
    *f = best;
}

static void coded_values(const pmesh_mesh_input *in, const pmesh_header *h,
                         size_t corner, int32_t *out)
{
    for (uint32_t a = 0; a < in->attribute_count; a++) {
        const pmesh_attribute_input *src = &in->attributes[a];
        const uint32_t tuple =
            src->indices ? src->indices[corner] : in->indices[corner];
        uint16_t q[PMESH_MAX_COMPONENTS];
        pmesh_attribute_quantize(&h->attributes[a],
                                 src->values +
                                     (size_t)tuple * src->components,
                                 q);
        for (uint32_t i = 0; i < pmesh_coded_components(&h->attributes[a]); i++)
            *out++ = q[i];
    }
}

/* The input's faces, less those with a repeated position and copies. */
static face_record *expected_faces(const pmesh_mesh_input *in,
                                   const pmesh_header *h, size_t *count)
{
    face_record *list = calloc(in->face_count, sizeof *list);
    *count = 0;
    for (size_t f = 0; f < in->face_count; f++) {
        face_record *r = &list[*count];
        const double *p[3];
        *r = (face_record){ { 0 } };
        for (size_t k = 0; k < 3; k++) {
            p[k] = in->positions + 3 * (size_t)in->indices[3 * f + k];
            for (int j = 0; j < 3; j++)
                r->x[CORNER * k + (size_t)j] =
                    pmesh_grid_quantize(&h->grid, j, p[k][j]);
            coded_values(in, h, 3 * f + k, r->x + CORNER * k + 3);
        }
        r->x[3 * CORNER] = in->materials ? (int32_t)in->materials[f] : 0;
        rotate_face(r);
        if (memcmp(p[0], p[1], 24) && memcmp(p[1], p[2], 24) &&
            memcmp(p[2], p[0], 24))
            ++*count;
    }
    qsort(list, *count, sizeof *list, compare_faces);
    return list;
}

static face_record *decoded_faces(const pmesh_view *v)
{
    face_record *list = calloc(v->face_count, sizeof *list);
    for (uint32_t f = 0; f < v->face_count; f++) {
        face_record *r = &list[f];
        for (size_t k = 0; k < 3; k++) {
            const uint32_t w = v->indices[3 * (size_t)f + k];
            const uint32_t x = v->positions_of ? v->positions_of[w] : w;
            memcpy(r->x + CORNER * k, v->positions + 3 * (size_t)x, 12);
            for (uint32_t i = 0; i < v->value_stride; i++)
                r->x[CORNER * k + 3 + i] =
                    v->values[(size_t)w * v->value_stride + i];
        }
        r->x[3 * CORNER] = v->materials ? (int32_t)v->materials[f] : 0;
        rotate_face(r);
    }
    qsort(list, v->face_count, sizeof *list, compare_faces);
    return list;
}

static size_t without_copies(face_record *list, size_t count)
{
    size_t n = 0;
    for (size_t i = 0; i < count; i++)
        if (i == 0 || compare_faces(&list[i], &list[n - 1]) != 0)
            list[n++] = list[i];
    return n;
}

bool faces_match(const pmesh_mesh_input *mesh, pmesh_decoder *dec)
{
    pmesh_header h;
    pmesh_view v;
    size_t count;
    pmesh_decoder_header(dec, &h);
    pmesh_decoder_refine(dec, NULL, NULL);
    pmesh_decoder_mesh(dec, &v);
    face_record *in = expected_faces(mesh, &h, &count);
    face_record *out = decoded_faces(&v);
    const size_t a = without_copies(in, count);
    const size_t b = without_copies(out, v.face_count);
    const bool same = v.face_count <= count && a == b &&
                      memcmp(in, out, a * sizeof *in) == 0;
    free(in);
    free(out);
    return same;
}
