/* SPDX-License-Identifier: MIT */
#include "encoder/enc_session.h"

#include <math.h>
#include <string.h>

#include "encoder/enc_guide_pull.h"
#include "encoder/enc_import.h"
#include "format/alloc.h"

/* What weight 1 multiplies costs by. */
#define FACTOR 100.0

static pmesh_status check(const pmesh_mesh_input *in)
{
    if (!in->positions || !in->indices)
        return in->face_count == 0 ? PMESH_E_NO_FACES : PMESH_E_ARGUMENT;
    if (in->face_count == 0)
        return PMESH_E_NO_FACES;
    if (in->face_count > ENC_MAX_CORNERS / 3 || in->vertex_count >= UINT32_MAX)
        return PMESH_E_LIMIT;
    for (size_t c = 0; c < 3 * in->face_count; c++)
        if (in->indices[c] >= in->vertex_count)
            return PMESH_E_INDEX;
    for (uint32_t v = 0; v < in->vertex_count; v++) {
        double p[3];
        enc_load_position(in, false, v, p);
        for (int k = 0; k < 3; k++)
            if (!(p[k] > -ENC_LARGEST_COORDINATE &&
                  p[k] < ENC_LARGEST_COORDINATE))
                return PMESH_E_NOT_FINITE;
    }
    return PMESH_OK;
}

static bool allocate(pmesh_session *s)
{
    const pmesh_allocator *a = &s->allocator;
    const size_t n = s->vertex_count, corners = 3 * (size_t)s->face_count;

    s->original = pmesh_alloc(a, corners, sizeof *s->original);
    s->input = pmesh_alloc(a, n, 3 * sizeof *s->input);
    s->node = pmesh_alloc(a, n, sizeof *s->node);
    s->vertex = pmesh_alloc(a, corners, sizeof *s->vertex);
    s->next = pmesh_alloc(a, corners, sizeof *s->next);
    s->first = pmesh_alloc(a, n, sizeof *s->first);
    s->end = pmesh_alloc(a, s->face_count, sizeof *s->end);
    s->into = pmesh_alloc(a, n, sizeof *s->into);
    s->error = pmesh_alloc(a, n, sizeof *s->error);
    s->merge = pmesh_alloc(a, n, sizeof *s->merge);
    s->age = pmesh_alloc_zero(a, n, sizeof *s->age);
    s->mark = pmesh_alloc_zero(a, n, sizeof *s->mark);
    return s->original && s->input && s->node && s->vertex && s->next &&
           s->first && s->end && s->into && s->error && s->merge && s->age &&
           s->mark;
}

static void release_deed(pmesh_session *s, size_t i)
{
    pmesh_release(&s->allocator, s->deed[i].vertices, s->deed[i].count,
                  sizeof *s->deed[i].vertices);
}

void pmesh_session_destroy(pmesh_session *s)
{
    if (!s)
        return;
    const pmesh_allocator a = s->allocator;
    const size_t n = s->vertex_count, corners = 3 * (size_t)s->face_count;

    pmesh_release(&a, s->original, corners, sizeof *s->original);
    pmesh_release(&a, s->input, n, 3 * sizeof *s->input);
    pmesh_release(&a, s->node, n, sizeof *s->node);
    pmesh_release(&a, s->vertex, corners, sizeof *s->vertex);
    pmesh_release(&a, s->next, corners, sizeof *s->next);
    pmesh_release(&a, s->first, n, sizeof *s->first);
    pmesh_release(&a, s->end, s->face_count, sizeof *s->end);
    pmesh_release(&a, s->into, n, sizeof *s->into);
    pmesh_release(&a, s->error, n, sizeof *s->error);
    pmesh_release(&a, s->merge, n, sizeof *s->merge);
    pmesh_release(&a, s->age, n, sizeof *s->age);
    pmesh_release(&a, s->mark, n, sizeof *s->mark);
    pmesh_release(&a, s->heap, s->heap_room, sizeof *s->heap);
    for (size_t i = 0; i < s->deed_count; i++)
        release_deed(s, i);
    pmesh_release(&a, s->deed, s->deed_room, sizeof *s->deed);
    pmesh_release(&a, s->step, s->deed_room, sizeof *s->step);
    pmesh_release(&a, s, 1, sizeof *s);
}

pmesh_status pmesh_session_create(pmesh_session **out,
                                  const pmesh_mesh_input *in,
                                  const pmesh_allocator *allocator)
{
    const pmesh_allocator a = pmesh_allocator_resolve(
        allocator ? *allocator : (pmesh_allocator){ 0 });
    const pmesh_status status = check(in);

    *out = NULL;
    if (status != PMESH_OK)
        return status;
    pmesh_session *s = pmesh_alloc_zero(&a, 1, sizeof *s);
    if (!s)
        return PMESH_E_MEMORY;
    s->allocator = a;
    s->vertex_count = (uint32_t)in->vertex_count;
    s->face_count = (uint32_t)in->face_count;
    if (!allocate(s)) {
        pmesh_session_destroy(s);
        return PMESH_E_MEMORY;
    }
    memcpy(s->original, in->indices,
           3 * (size_t)s->face_count * sizeof *s->original);
    for (uint32_t v = 0; v < s->vertex_count; v++)
        enc_load_position(in, false, v, s->input + 3 * (size_t)v);
    enc_session_reset(s);
    *out = s;
    return PMESH_OK;
}

/* ---- deeds --------------------------------------------------------------- */

static void weigh(pmesh_session *s, const enc_deed *deed)
{
    for (size_t i = 0; i < deed->count; i++) {
        enc_node *n =
            &s->node[pmesh_session_vertex(s, deed->vertices[i])];
        /* What was painted before is painted over. */
        const double f = pow(FACTOR, 2 * (deed->amount - n->weight));
        if (n->weight == deed->amount)
            continue;
        for (int k = 0; k < 6; k++)
            n->quadric.a[k] *= f;
        for (int k = 0; k < 3; k++)
            n->quadric.b[k] *= f;
        n->quadric.c *= f;
        n->quadric.weight *= f;
        n->weight = deed->amount;
    }
}

static void fit(const pmesh_session *s, const enc_deed *deed, double mean[3],
                double normal[3])
{
    static const int row[] = { 0, 0, 0, 1, 1, 2 }, col[] = { 0, 1, 2, 1, 2, 2 };
    double sum[6] = { 0 };

    mean[0] = mean[1] = mean[2] = 0;
    for (size_t i = 0; i < deed->count; i++) {
        const uint32_t v = pmesh_session_vertex(s, deed->vertices[i]);
        for (int k = 0; k < 3; k++)
            mean[k] += s->node[v].position[k] / (double)deed->count;
    }
    for (size_t i = 0; i < deed->count; i++) {
        const uint32_t v = pmesh_session_vertex(s, deed->vertices[i]);
        const double *p = s->node[v].position;
        for (int k = 0; k < 6; k++)
            sum[k] += (p[row[k]] - mean[row[k]]) * (p[col[k]] - mean[col[k]]);
    }
    enc_pull_fit(sum, normal);
}

static double strength(const pmesh_session *s, const enc_deed *deed, uint32_t v)
{
    return ENC_PULL * (deed->amount > 0 ? deed->amount : 1) *
           enc_session_area(s, v);
}

static void pull_line(pmesh_session *s, const enc_deed *deed, size_t i)
{
    const uint32_t end[2] = { pmesh_session_vertex(s, deed->vertices[i - 1]),
                              pmesh_session_vertex(s, deed->vertices[i]) };
    double along[3];

    for (int k = 0; k < 3; k++)
        along[k] = s->node[end[1]].position[k] - s->node[end[0]].position[k];
    for (int k = 0; k < 2 && end[0] != end[1]; k++)
        enc_pull_line(&s->node[end[k]].pull, along, strength(s, deed, end[k]));
}

/* Several of the vertices may be one by now: that gets it but once. */
static bool is_repeated(const pmesh_session *s, const enc_deed *deed, size_t i)
{
    const uint32_t v = pmesh_session_vertex(s, deed->vertices[i]);
    return s->mark[v] == s->stamp;
}

static void constrain(pmesh_session *s, const enc_deed *deed)
{
    double mean[3] = { 0 }, normal[3] = { 0 };

    s->stamp++;
    if (deed->kind == PMESH_PLANE)
        fit(s, deed, mean, normal);
    for (size_t i = 0; i < deed->count; i++) {
        const uint32_t v = pmesh_session_vertex(s, deed->vertices[i]);
        enc_node *n = &s->node[v];
        if (deed->kind == PMESH_CONTOUR) {
            if (i > 0)
                pull_line(s, deed, i);
            continue;
        }
        if (is_repeated(s, deed, i))
            continue;
        s->mark[v] = s->stamp;
        if (deed->kind == PMESH_POINT) {
            enc_pull_point(&n->pull, strength(s, deed, v));
        } else {
            const double through[3] = { mean[0] - n->position[0],
                                        mean[1] - n->position[1],
                                        mean[2] - n->position[2] };
            enc_pull_plane(&n->pull, normal, through, strength(s, deed, v));
        }
    }
}

static bool perform(pmesh_session *s, size_t i)
{
    const enc_deed *deed = &s->deed[i];

    if (deed->action == PMESH_SESSION_MOVE) {
        if (!enc_session_walk(s, deed->faces))
            return false;
    } else {
        if (deed->action == PMESH_SESSION_WEIGH)
            weigh(s, deed);
        else
            constrain(s, deed);
        s->old = s->done;
        enc_session_forget(s);
    }
    double error = 0;
    for (uint32_t m = 0; m < s->done; m++)
        error = fmax(error, s->merge[m].error);
    s->step[i] = (pmesh_session_step){ deed->action, s->alive, sqrt(error) };
    return true;
}

static bool make_room(pmesh_session *s)
{
    const size_t room = 2 * s->deed_room + 16;

    if (s->deed_count < s->deed_room)
        return true;
    enc_deed *deed = pmesh_alloc(&s->allocator, room, sizeof *deed);
    pmesh_session_step *step = pmesh_alloc(&s->allocator, room, sizeof *step);
    if (!deed || !step) {
        pmesh_release(&s->allocator, deed, room, sizeof *deed);
        pmesh_release(&s->allocator, step, room, sizeof *step);
        return false;
    }
    if (s->deed_count > 0) {
        memcpy(deed, s->deed, s->deed_count * sizeof *deed);
        memcpy(step, s->step, s->deed_count * sizeof *step);
    }
    pmesh_release(&s->allocator, s->deed, s->deed_room, sizeof *deed);
    pmesh_release(&s->allocator, s->step, s->deed_room, sizeof *step);
    s->deed = deed;
    s->step = step;
    s->deed_room = room;
    return true;
}

/* Takes a copy of the vertices. */
static pmesh_status act(pmesh_session *s, enc_deed deed,
                        const uint32_t *vertices)
{
    for (size_t i = 0; i < deed.count; i++)
        if (vertices[i] >= s->vertex_count ||
            s->first[vertices[i]] == ENC_NOBODY)
            return PMESH_E_ARGUMENT;
    if (!make_room(s))
        return PMESH_E_MEMORY;
    if (vertices && deed.count > 0) {
        deed.vertices =
            pmesh_alloc(&s->allocator, deed.count, sizeof *deed.vertices);
        if (!deed.vertices)
            return PMESH_E_MEMORY;
        memcpy(deed.vertices, vertices, deed.count * sizeof *vertices);
    }
    s->step[s->deed_count] = (pmesh_session_step){ deed.action, s->alive, 0 };
    s->deed[s->deed_count++] = deed;
    return perform(s, s->deed_count - 1) ? PMESH_OK : PMESH_E_MEMORY;
}

pmesh_status pmesh_session_move(pmesh_session *s, size_t faces)
{
    return act(s, (enc_deed){ .action = PMESH_SESSION_MOVE, .faces = faces },
               NULL);
}

pmesh_status pmesh_session_weigh(pmesh_session *s, const uint32_t *vertices,
                                 size_t count, double weight)
{
    if (!(weight >= 0 && weight <= 1))
        return PMESH_E_ARGUMENT;
    return act(s, (enc_deed){ .action = PMESH_SESSION_WEIGH, .amount = weight,
                              .count = count }, vertices);
}

pmesh_status pmesh_session_constrain(pmesh_session *s,
                                     pmesh_constraint_kind kind,
                                     const uint32_t *vertices, size_t count,
                                     double importance)
{
    if ((unsigned)kind > PMESH_POINT || !(importance >= 0) ||
        !(importance < INFINITY))
        return PMESH_E_ARGUMENT;
    return act(s, (enc_deed){ .action = PMESH_SESSION_CONSTRAIN, .kind = kind,
                              .amount = importance, .count = count }, vertices);
}

/* From the beginning: what was done leads to the same bits. */
pmesh_status pmesh_session_undo(pmesh_session *s)
{
    if (s->deed_count == 0)
        return PMESH_E_ARGUMENT;
    release_deed(s, --s->deed_count);
    enc_session_reset(s);
    for (size_t i = 0; i < s->deed_count; i++)
        if (!perform(s, i))
            return PMESH_E_MEMORY;
    return PMESH_OK;
}

const pmesh_session_step *pmesh_session_log(const pmesh_session *s,
                                            size_t *count)
{
    *count = s->deed_count;
    return s->step;
}
