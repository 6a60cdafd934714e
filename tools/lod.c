/* SPDX-License-Identifier: MIT */
#include "tools/lod.h"

#include <stdlib.h>
#include <string.h>

#include "tools/corners.h"

/* The mesh as pmesh_simplify_mesh() takes it, and the room for its answer. */
typedef struct lod_job {
    const asset *in;
    corners corners;
    double *positions; /* per point */
    float *values[PMESH_MAX_ATTRIBUTES];
    pmesh_simplify_attribute attributes[PMESH_MAX_ATTRIBUTES];
    pmesh_simplify_output out;
} lod_job;

static float weight_of(const lod_weights *weights, pmesh_attribute_kind kind)
{
    switch (kind) {
    case PMESH_NORMAL: return (float)weights->normal;
    case PMESH_TEXCOORD: return (float)weights->texcoord;
    case PMESH_COLOR: return (float)weights->color;
    default: return (float)weights->generic;
    }
}

static bool put_points(lod_job *job)
{
    const asset *in = job->in;
    const size_t n = job->corners.count;

    job->positions = malloc((n + 1) * 3 * sizeof *job->positions);
    if (!job->positions)
        return false;
    for (size_t i = 0; i < n; i++)
        memcpy(&job->positions[3 * i],
               &in->positions[3 * (size_t)in->indices[job->corners.first[i]]],
               3 * sizeof *job->positions);
    return true;
}

static bool put_attribute(lod_job *job, size_t i, const lod_weights *weights)
{
    const asset_attribute *a = &job->in->attributes[i];
    pmesh_simplify_attribute *to = &job->attributes[i];
    const size_t size = a->components * sizeof(float);

    job->values[i] = malloc((job->corners.count + 1) * size);
    if (!job->values[i])
        return false;
    for (size_t k = 0; k < job->corners.count; k++)
        memcpy(job->values[i] + k * a->components,
               corners_values(job->in, a, job->corners.first[k]), size);
    *to = (pmesh_simplify_attribute){ .kind = a->kind,
                                      .components = a->components,
                                      .values = job->values[i] };
    for (size_t k = 0; k < a->components; k++)
        to->weight[k] = weight_of(weights, a->kind);
    return true;
}

static bool make_room(lod_job *job)
{
    const size_t faces = job->in->face_count + 1;
    const size_t points = job->corners.count + 1;
    pmesh_simplify_output *out = &job->out;

    out->indices = malloc(faces * 3 * sizeof *out->indices);
    out->position_indices = malloc(faces * 3 * sizeof *out->indices);
    out->face_source = malloc(faces * sizeof *out->face_source);
    out->positions = malloc(points * 3 * sizeof *out->positions);
    bool good = out->indices && out->position_indices && out->face_source &&
                out->positions;
    for (size_t i = 0; i < job->in->attribute_count; i++) {
        out->attribute_values[i] =
            malloc(points * job->in->attributes[i].components * sizeof(float));
        good = good && out->attribute_values[i];
    }
    return good;
}

static bool prepare(lod_job *job, const asset *in, const lod_weights *weights)
{
    *job = (lod_job){ .in = in };
    bool good = corners_unify(in, &job->corners) && put_points(job);
    for (size_t i = 0; i < in->attribute_count && good; i++)
        good = put_attribute(job, i, weights);
    return good && make_room(job);
}

static void clean_up(lod_job *job)
{
    corners_free(&job->corners);
    free(job->positions);
    free(job->out.indices);
    free(job->out.position_indices);
    free(job->out.face_source);
    free(job->out.positions);
    for (size_t i = 0; i < PMESH_MAX_ATTRIBUTES; i++) {
        free(job->values[i]);
        free(job->out.attribute_values[i]);
    }
}

/* Numbers what `used` names from 0 in order of appearance, in place; *order
 * lists what was named. Returns the count, or SIZE_MAX without memory. */
static size_t renumber(uint32_t *used, size_t used_count, size_t range,
                       uint32_t **order)
{
    uint32_t *number = calloc(range + 1, sizeof *number);
    size_t count = 0;

    *order = malloc((range + 1) * sizeof **order);
    if (!number || !*order) {
        free(number);
        free(*order);
        *order = NULL;
        return SIZE_MAX;
    }
    for (size_t i = 0; i < used_count; i++) {
        const uint32_t item = used[i];
        if (number[item] == 0) {
            (*order)[count++] = item;
            number[item] = (uint32_t)count;
        }
        used[i] = number[item] - 1;
    }
    free(number);
    return count;
}

static bool take_positions(lod_job *job, asset *out)
{
    uint32_t *order;
    const size_t corner_count = 3 * job->out.face_count;
    const size_t count = renumber(job->out.position_indices, corner_count,
                                  job->corners.count, &order);

    if (count == SIZE_MAX)
        return false;
    out->indices = job->out.position_indices;
    job->out.position_indices = NULL;
    out->face_count = job->out.face_count;
    out->vertex_count = count;
    out->positions = malloc((count + 1) * 3 * sizeof *out->positions);
    /* A place is in the row of any point there; its own may have no corner. */
    for (size_t c = 0; c < corner_count && out->positions; c++)
        memcpy(&out->positions[3 * (size_t)out->indices[c]],
               &job->out.positions[3 * (size_t)job->out.indices[c]],
               3 * sizeof *out->positions);
    free(order);
    return out->positions != NULL;
}

static bool take_attribute(lod_job *job, size_t i, const uint32_t *points,
                           const uint32_t *order, size_t count, asset *out)
{
    const asset_attribute *from = &job->in->attributes[i];
    asset_attribute *to = &out->attributes[out->attribute_count++];
    const size_t corner_count = 3 * job->out.face_count;
    const size_t size = from->components * sizeof(float);

    *to = (asset_attribute){ .kind = from->kind,
                             .set = from->set,
                             .components = from->components,
                             .count = count };
    to->values = malloc((count + 1) * size);
    to->indices = malloc((corner_count + 1) * sizeof *to->indices);
    if (!to->values || !to->indices)
        return false;
    memcpy(to->indices, points, corner_count * sizeof *points);
    for (size_t k = 0; k < count; k++)
        memcpy(to->values + k * from->components,
               job->out.attribute_values[i] +
                   (size_t)order[k] * from->components,
               size);
    return true;
}

static bool take_attributes(lod_job *job, asset *out)
{
    uint32_t *order;
    bool good = true;

    if (job->in->attribute_count == 0)
        return true;
    const size_t count = renumber(job->out.indices, 3 * job->out.face_count,
                                  job->corners.count, &order);
    for (size_t i = 0; i < job->in->attribute_count && good; i++)
        good = count != SIZE_MAX &&
               take_attribute(job, i, job->out.indices, order, count, out);
    free(order);
    return good;
}

static char *copy_text(const char *text)
{
    const size_t size = strlen(text) + 1;
    char *copy = malloc(size);

    return copy ? memcpy(copy, text, size) : NULL;
}

static bool take_materials(const lod_job *job, asset *out)
{
    const asset *in = job->in;

    out->material_count = in->material_count;
    if (in->materials) {
        out->materials = malloc((out->face_count + 1) * sizeof *out->materials);
        if (!out->materials)
            return false;
        for (size_t f = 0; f < out->face_count; f++)
            out->materials[f] = in->materials[job->out.face_source[f]];
    }
    if (!in->material_names)
        return true;
    out->material_names =
        calloc(in->material_count + 1u, sizeof *out->material_names);
    if (!out->material_names)
        return false;
    for (uint32_t i = 0; i < in->material_count; i++) {
        out->material_names[i] = copy_text(in->material_names[i]);
        if (!out->material_names[i])
            return false;
    }
    return true;
}

/* Floats stay floats: moved vertices are rounded to them. */
static void round_positions(const asset *in, asset *out)
{
    out->floats = in->floats;
    for (size_t i = 0; i < 3 * out->vertex_count && in->floats; i++)
        out->positions[i] = (double)(float)out->positions[i];
}

pmesh_status lod_make(const asset *in, const pmesh_simplify_options *options,
                      const lod_weights *weights, asset *out,
                      lod_report *report)
{
    pmesh_status status = PMESH_E_MEMORY;
    lod_job job;

    *out = (asset){ 0 };
    if (prepare(&job, in, weights)) {
        const pmesh_simplify_input mesh = {
            .indices = job.corners.points,
            .face_count = in->face_count,
            .vertex_count = job.corners.count,
            .doubles = job.positions,
            .materials = in->materials,
            .attributes = job.attributes,
            .attribute_count = in->attribute_count,
        };
        status = pmesh_simplify_mesh(&mesh, options, &job.out);
    }
    if (status == PMESH_OK) {
        *report = (lod_report){ .end = job.out.end,
                                .vertices = job.out.vertex_count,
                                .error = job.out.error,
                                .cost_least = job.out.cost_least,
                                .cost_mean = job.out.cost_mean,
                                .cost_most = job.out.cost_most,
                                .dropped_faces = job.out.dropped_faces,
                                .joined = job.out.joined };
        if (!take_positions(&job, out) || !take_attributes(&job, out) ||
            !take_materials(&job, out)) {
            asset_free(out);
            *out = (asset){ 0 };
            status = PMESH_E_MEMORY;
        } else {
            round_positions(in, out);
        }
    }
    clean_up(&job);
    return status;
}
