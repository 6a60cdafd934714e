/* SPDX-License-Identifier: MIT */
#include "encoder/enc_looks.h"

#include <math.h>
#include <string.h>

#include "encoder/enc_bits.h"
#include "encoder/enc_joint.h"
#include "encoder/enc_wedges.h"
#include "format/alloc.h"
#include "format/quantize.h"

/* The area; the quadric's matrix, which the position alone is asked for by; e
 * and f. */
enum { MATRIX = 1, EDGES = MATRIX + 6 };
enum { FRAME_MAX = EDGES + 2 * (3 + ENC_JOINT_MAX) };

static size_t stride_of(const enc_looks *looks)
{
    return EDGES + 2 * (3 + (size_t)looks->count);
}

/* ---- values -------------------------------------------------------------- */

static void load_values(enc_looks *looks, const enc_mesh *mesh)
{
    double extent = 0;
    float *out = looks->value;

    for (int k = 0; k < 3; k++)
        extent = fmax(extent, mesh->bounds[k]);
    for (uint32_t w = 0; w < mesh->wedge_count; w++) {
        const uint16_t *coded = mesh->value + (size_t)w * mesh->value_count;
        for (uint32_t i = 0; i < mesh->attribute_count; i++) {
            const pmesh_attribute *a = &mesh->attribute[i];
            float value[PMESH_MAX_COMPONENTS];
            if (mesh->weight[i] > 0) {
                pmesh_attribute_dequantize(a, coded, value);
                for (int k = 0; k < a->components; k++)
                    *out++ = (float)((double)mesh->weight[i] * extent *
                                     (double)value[k]);
            }
            coded += pmesh_coded_components(a);
        }
    }
}

static void plan_channels(enc_looks *looks, const enc_mesh *mesh)
{
    uint32_t first = 0;

    for (uint32_t i = 0; i < mesh->attribute_count; i++) {
        const pmesh_attribute *a = &mesh->attribute[i];
        looks->first[i] = (uint8_t)first;
        first += pmesh_coded_components(a);
        if (!(mesh->weight[i] > 0))
            continue;
        looks->count += a->components;
        looks->turns[i] = a->kind == PMESH_TEXCOORD;
        looks->guarded |= looks->turns[i];
    }
}

bool enc_looks_fate(const enc_looks *looks, const enc_mesh *mesh,
                    uint32_t **fate)
{
    *fate = NULL;
    if (looks->count == 0)
        return true;
    *fate = pmesh_alloc(&mesh->allocator, mesh->wedge_count, sizeof **fate);
    if (*fate)
        memset(*fate, 0xff, mesh->wedge_count * sizeof **fate);
    return *fate != NULL;
}

pmesh_status enc_looks_create(const enc_mesh *mesh, enc_looks *out)
{
    const pmesh_allocator *a = &mesh->allocator;

    *out = (enc_looks){ 0 };
    plan_channels(out, mesh);
    if (out->count == 0)
        return PMESH_OK;
    out->value = pmesh_alloc(a, mesh->wedge_count * (size_t)out->count,
                             sizeof *out->value);
    out->frame = pmesh_alloc(a, mesh->face_count * stride_of(out),
                             sizeof *out->frame);
    out->stale = pmesh_alloc(a, enc_bit_words(mesh->face_count),
                             sizeof *out->stale);
    if (!out->value || !out->frame || !out->stale ||
        !enc_looks_fate(out, mesh, &out->fate)) {
        enc_looks_destroy(mesh, out);
        return PMESH_E_MEMORY;
    }
    load_values(out, mesh);
    memset(out->stale, 0xff,
           enc_bit_words(mesh->face_count) * sizeof *out->stale);
    return PMESH_OK;
}

void enc_looks_destroy(const enc_mesh *mesh, enc_looks *looks)
{
    const pmesh_allocator *a = &mesh->allocator;

    pmesh_release(a, looks->value, mesh->wedge_count * (size_t)looks->count,
                  sizeof *looks->value);
    pmesh_release(a, looks->frame, mesh->face_count * stride_of(looks),
                  sizeof *looks->frame);
    pmesh_release(a, looks->stale, enc_bit_words(mesh->face_count),
                  sizeof *looks->stale);
    pmesh_release(a, looks->fate, mesh->wedge_count, sizeof *looks->fate);
    *looks = (enc_looks){ 0 };
}

/* ---- faces --------------------------------------------------------------- */

/* from - to of the values of two wedges. */
static void step_between(const enc_looks *looks, uint32_t from, uint32_t to,
                         double out[])
{
    const float *a = looks->value + (size_t)from * looks->count;
    const float *b = looks->value + (size_t)to * looks->count;

    for (unsigned i = 0; i < looks->count; i++)
        out[i] = (double)a[i] - (double)b[i];
}

/* A face that has no area, or no plane, gets area 0. */
static void make_frame(const enc_looks *looks, const enc_surface *s,
                       uint32_t face, double frame[])
{
    const unsigned m = looks->count;
    const uint32_t h = 3 * face;
    const int32_t *at = s->position[s->vertex[h]];
    double *e = frame + EDGES, *f = e + 3 + m, n[3];
    double place[2][3], value[2][ENC_JOINT_MAX];

    for (uint32_t k = 0; k < 2; k++) {
        const int32_t *to = s->position[s->vertex[h + 1 + k]];
        for (int i = 0; i < 3; i++)
            place[k][i] = (double)(to[i] - at[i]);
        step_between(looks, s->wedge[h + 1 + k], s->wedge[h], value[k]);
    }
    enc_surface_normal(s, h, at, n);
    const double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    frame[0] = 0;
    if (!(length > 0) || !enc_joint_frame(m, place[0], value[0], place[1],
                                          value[1], e, f))
        return;
    for (int i = 0; i < 3; i++)
        n[i] /= length;
    const double area = frame[0] = 0.5 * length;
    for (unsigned i = 0, k = MATRIX; i < 3; i++)
        for (unsigned j = i; j < 3; j++)
            frame[k++] = area * ((i == j) - n[i] * n[j] - e[i] * e[j] -
                                 f[i] * f[j]);
}

uint32_t enc_looks_parts(const enc_looks *looks, const enc_mesh *mesh)
{
    return looks->count ? (mesh->face_count + ENC_BLOCK - 1) / ENC_BLOCK : 0;
}

void enc_looks_begin(enc_looks *looks, const enc_surface *s, uint32_t part)
{
    const uint32_t count = s->mesh->face_count, first = part * ENC_BLOCK;
    const uint32_t end = count - first < ENC_BLOCK ? count : first + ENC_BLOCK;

    for (uint32_t f = first; f < end; f++)
        if (enc_bit_get(looks->stale, f) && s->vertex[3 * f] != ENC_NONE)
            make_frame(looks, s, f, looks->frame + f * stride_of(looks));
    /* Blocks are words of their own. */
    memset(looks->stale + first / 32, 0,
           enc_bit_words(end - first) * sizeof *looks->stale);
}

void enc_looks_contract(enc_looks *looks, const enc_surface *s,
                        uint32_t parent)
{
    if (looks->count == 0)
        return;
    uint32_t start = s->first[parent];
    for (uint32_t h = start; h != ENC_NONE; h = enc_around(s, &start, h))
        enc_bit_put(looks->stale, h / 3);
}

/* At a step in the attributes. */
static void add_step(const enc_looks *looks, const double frame[],
                     const double step[], enc_quadric *q)
{
    const unsigned m = looks->count;
    const double *e = frame + EDGES, *f = e + 3 + m;
    const double area = frame[0];
    double along_e = 0, along_f = 0, square = 0;

    for (unsigned i = 0; i < m; i++) {
        along_e += e[3 + i] * step[i];
        along_f += f[3 + i] * step[i];
        square += step[i] * step[i];
    }
    for (unsigned i = 0; i < 3; i++)
        q->b[i] -= area * (e[i] * along_e + f[i] * along_f);
    q->c += area * (square - along_e * along_e - along_f * along_f);
}

/* What the faces around v say; fate: NULL if its wedges stay. */
static void add_around(const enc_looks *looks, const enc_surface *s,
                       uint32_t v, const uint32_t *fate, bool now,
                       enc_quadric *q)
{
    uint32_t start = s->first[v];

    for (uint32_t h = start; h != ENC_NONE; h = enc_around(s, &start, h)) {
        const double *frame = looks->frame + h / 3 * stride_of(looks);
        const uint32_t to = fate ? fate[s->wedge[h]] : ENC_NONE;
        double own[FRAME_MAX], step[ENC_JOINT_MAX];
        if (now && enc_bit_get(looks->stale, h / 3)) {
            make_frame(looks, s, h / 3, own);
            frame = own;
        }
        if (!(frame[0] > 0))
            continue;
        for (unsigned k = 0; k < 6; k++)
            q->a[k] += frame[MATRIX + k];
        if (to == ENC_NONE)
            continue;
        step_between(looks, to, s->wedge[h], step);
        add_step(looks, frame, step, q);
    }
}

void enc_looks_add_child(const enc_looks *looks, const enc_surface *s,
                         uint32_t child, bool now, enc_quadric *q)
{
    if (looks->count > 0)
        add_around(looks, s, child, looks->fate, now, q);
}

void enc_looks_add_parent(const enc_looks *looks, const enc_surface *s,
                          uint32_t parent, bool now, enc_quadric *q)
{
    if (looks->count > 0)
        add_around(looks, s, parent, NULL, now, q);
}

/* ---- wedges -------------------------------------------------------------- */

void enc_looks_expect(const enc_looks *looks, const enc_surface *s,
                      const enc_pair *pair)
{
    enc_link link;

    if (looks->count == 0)
        return;
    if (pair->left != ENC_NONE || pair->right != ENC_NONE)
        enc_wedges_map(s, pair, looks->fate);
    else if (enc_join_link(s, pair->child, pair->parent, &link))
        enc_wedges_map_link(s, pair, &link, looks->fate);
}

void enc_looks_forget(const enc_looks *looks, const enc_surface *s,
                      const enc_pair *pair)
{
    if (looks->count == 0)
        return;
    uint32_t start = s->first[pair->child];
    for (uint32_t h = start; h != ENC_NONE; h = enc_around(s, &start, h))
        looks->fate[s->wedge[h]] = ENC_NONE;
}

/* Twice the area of the triangle that channel i draws with these wedges. */
static int64_t drawn_area(const enc_looks *looks, const enc_mesh *mesh,
                          uint32_t i, const uint32_t wedge[3])
{
    int64_t x[3], y[3];

    for (int k = 0; k < 3; k++) {
        const uint16_t *value = mesh->value +
                                (size_t)wedge[k] * mesh->value_count +
                                looks->first[i];
        x[k] = value[0];
        y[k] = value[1];
    }
    return (x[1] - x[0]) * (y[2] - y[0]) - (y[1] - y[0]) * (x[2] - x[0]);
}

static bool face_turns(const enc_looks *looks, const enc_surface *s,
                       uint32_t h)
{
    const uint32_t before[3] = { s->wedge[h], s->wedge[enc_next(h)],
                                 s->wedge[enc_prev(h)] };
    const uint32_t after[3] = { looks->fate[before[0]], before[1], before[2] };

    for (uint32_t i = 0; i < s->mesh->attribute_count; i++) {
        if (!looks->turns[i])
            continue;
        const int64_t old = drawn_area(looks, s->mesh, i, before);
        const int64_t new = drawn_area(looks, s->mesh, i, after);
        if ((old > 0 && new <= 0) || (old < 0 && new >= 0))
            return true;
    }
    return false;
}

bool enc_looks_turn(const enc_looks *looks, const enc_surface *s,
                    const enc_pair *pair)
{
    uint32_t start = s->first[pair->child];

    if (!looks->guarded)
        return false;
    for (uint32_t h = start; h != ENC_NONE; h = enc_around(s, &start, h))
        if (s->vertex[enc_next(h)] != pair->parent &&
            s->vertex[enc_prev(h)] != pair->parent &&
            looks->fate[s->wedge[h]] != ENC_NONE && face_turns(looks, s, h))
            return true;
    return false;
}
