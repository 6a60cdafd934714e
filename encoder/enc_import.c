/* SPDX-License-Identifier: MIT */
#include "encoder/enc_import.h"

#include "encoder/enc_guide.h"
#include "format/alloc.h"
#include "format/quantize.h"

#include <float.h>

static bool bits_are_legal(unsigned bits)
{
    return bits >= 4 && bits <= 16;
}

static bool config_is_legal(const pmesh_encoder_config *config)
{
    return config->position_bits >= 4 && config->position_bits <= 24 &&
           bits_are_legal(config->normal_bits) &&
           bits_are_legal(config->texcoord_bits) &&
           bits_are_legal(config->color_bits) &&
           bits_are_legal(config->generic_bits) &&
           config->weld >= 0.0 && config->weld <= DBL_MAX;
}

static bool attribute_is_legal(const pmesh_attribute_input *attribute,
                               size_t vertex_count)
{
    const unsigned n = attribute->components;

    switch ((int)attribute->kind) {
    case PMESH_NORMAL:
        if (n != 3)
            return false;
        break;
    case PMESH_TEXCOORD:
        if (n != 2)
            return false;
        break;
    case PMESH_COLOR:
        if (n != 3 && n != 4)
            return false;
        break;
    case PMESH_GENERIC:
        if (n < 1 || n > PMESH_MAX_COMPONENTS)
            return false;
        break;
    default:
        return false;
    }
    return (attribute->bits == 0 || bits_are_legal(attribute->bits)) &&
           attribute->weight - attribute->weight == 0 &&
           (attribute->values || attribute->count == 0) &&
           (attribute->stride == 0 ||
            attribute->stride >= n * sizeof(float)) &&
           (attribute->indices || attribute->count >= vertex_count);
}

static pmesh_status check_arguments(const enc_importer *im)
{
    const pmesh_mesh_input *in = im->in;

    if (!config_is_legal(im->config) ||
        (in->vertex_count > 0 && !in->positions) ||
        (in->face_count > 0 && !in->indices) ||
        (in->position_stride > 0 &&
         in->position_stride < 3 * sizeof(double)) ||
        in->attribute_count > PMESH_MAX_ATTRIBUTES ||
        (in->attribute_count > 0 && !in->attributes))
        return PMESH_E_ARGUMENT;
    for (size_t i = 0; i < in->attribute_count; i++)
        if (!attribute_is_legal(&in->attributes[i], in->vertex_count))
            return PMESH_E_ARGUMENT;
    if (in->face_count > ENC_MAX_CORNERS / 3 ||
        in->vertex_count >= UINT32_MAX)
        return PMESH_E_LIMIT;
    return in->face_count > 0 ? PMESH_OK : PMESH_E_NO_FACES;
}

static bool face_is_legal(const pmesh_mesh_input *in, size_t face)
{
    for (size_t c = 3 * face; c < 3 * face + 3; c++) {
        if (in->indices[c] >= in->vertex_count)
            return false;
        for (size_t i = 0; i < in->attribute_count; i++) {
            const pmesh_attribute_input *attribute = &in->attributes[i];
            if (attribute->indices &&
                attribute->indices[c] >= attribute->count)
                return false;
        }
    }
    const uint32_t materials = in->material_count ? in->material_count : 1;
    return !in->materials || in->materials[face] < materials;
}

static pmesh_status check_indices(const enc_importer *im)
{
    for (size_t face = 0; face < im->in->face_count; face++) {
        if (!face_is_legal(im->in, face)) {
            im->report->error_index = face;
            return PMESH_E_INDEX;
        }
    }
    return PMESH_OK;
}

/* Not NaN, not infinite, and no sum of two overflows. */
static bool is_usable(const double p[3], double largest)
{
    for (int k = 0; k < 3; k++)
        if (!(p[k] >= -largest && p[k] <= largest))
            return false;
    return true;
}

/* number[v]: v where a face without a position that is not finite has it. */
static pmesh_status find_usable(enc_importer *im)
{
    const pmesh_mesh_input *in = im->in;
    const pmesh_allocator *a = &im->mesh->allocator;
    const size_t words = enc_bit_words(in->vertex_count);
    uint32_t *usable = pmesh_alloc_zero(a, words, sizeof *usable);

    if (!usable)
        return PMESH_E_MEMORY;
    for (uint32_t v = 0; v < in->vertex_count; v++) {
        double p[3];
        enc_load_position(in, im->config->lossless, v, p);
        if (is_usable(p, im->config->lossless ? (double)FLT_MAX
                                              : ENC_LARGEST_COORDINATE))
            enc_bit_put(usable, v);
    }
    memset(im->number, 0xff, in->vertex_count * sizeof *im->number);
    for (size_t face = 0; face < in->face_count; face++) {
        const uint32_t *v = in->indices + 3 * face;
        if (!enc_bit_get(usable, v[0]) || !enc_bit_get(usable, v[1]) ||
            !enc_bit_get(usable, v[2])) {
            im->report->not_finite_faces++;
            continue;
        }
        for (int k = 0; k < 3; k++)
            im->number[v[k]] = v[k];
    }
    pmesh_release(a, usable, words, sizeof *usable);
    return im->report->not_finite_faces < in->face_count
        ? PMESH_OK : PMESH_E_NOT_FINITE;
}

typedef enum face_use { FACE_KEPT, FACE_NOT_FINITE, FACE_DEGENERATE } face_use;

/* `number` may be of welded input vertices or of vertices. */
static face_use use_of(const enc_importer *im, size_t face)
{
    const uint32_t *v = im->in->indices + 3 * face;
    const uint32_t x = im->number[v[0]], y = im->number[v[1]],
                   z = im->number[v[2]];

    if (x == ENC_NONE || y == ENC_NONE || z == ENC_NONE)
        return FACE_NOT_FINITE;
    return x == y || y == z || z == x ? FACE_DEGENERATE : FACE_KEPT;
}

/* Counts the faces to keep and the vertices they use, fills im->first. */
static pmesh_status select_faces(enc_importer *im)
{
    const pmesh_mesh_input *in = im->in;
    const pmesh_allocator *a = &im->mesh->allocator;
    const size_t words = enc_bit_words(in->vertex_count);
    uint32_t *used = pmesh_alloc_zero(a, words, sizeof *used);
    uint32_t use_count = 0;

    if (!used)
        return PMESH_E_MEMORY;
    for (size_t face = 0; face < in->face_count; face++) {
        const face_use use = use_of(im, face);
        im->report->degenerate_faces += use == FACE_DEGENERATE;
        if (use != FACE_KEPT)
            continue;
        im->mesh->face_count++;
        for (size_t k = 0; k < 3; k++)
            enc_bit_put(used, in->indices[3 * face + k]);
    }
    for (uint32_t v = 0; v < in->vertex_count; v++) {
        if (!enc_bit_get(used, v))
            continue;
        use_count++;
        im->mesh->vertex_count += !enc_bit_get(im->first, im->number[v]);
        enc_bit_put(im->first, im->number[v]);
    }
    pmesh_release(a, used, words, sizeof *used);
    im->report->unused_vertices = (uint32_t)in->vertex_count - use_count;
    im->report->welded_vertices = use_count - im->mesh->vertex_count;
    return im->mesh->face_count > 0 ? PMESH_OK : PMESH_E_NO_FACES;
}

/* number[v] turns from an input vertex into a vertex. The least input vertex
 * of each comes first, so one pass does. */
static void number_vertices(enc_importer *im)
{
    uint32_t count = 0;

    for (uint32_t v = 0; v < im->in->vertex_count; v++) {
        const uint32_t least = im->number[v];
        if (least == v)
            im->number[v] =
                enc_bit_get(im->first, v) ? count++ : ENC_NONE;
        else if (least != ENC_NONE)
            im->number[v] = im->number[least];
    }
}

static void load_faces(enc_importer *im)
{
    const pmesh_mesh_input *in = im->in;
    enc_mesh *mesh = im->mesh;
    size_t kept = 0;

    for (size_t face = 0; face < in->face_count; face++) {
        if (use_of(im, face) != FACE_KEPT)
            continue;
        for (size_t k = 0; k < 3; k++)
            mesh->vertex[3 * kept + k] =
                im->number[in->indices[3 * face + k]];
        if (mesh->material && in->materials)
            mesh->material[kept] = in->materials[face];
        im->source[kept++] = (uint32_t)face;
    }
}

/* There is a face, so the extent is not 0. */
static void fit_grid(enc_importer *im)
{
    pmesh_grid *grid = &im->mesh->grid;
    double high[3] = { 0 }, extent = 0.0;
    bool any = false;

    for (uint32_t v = 0; v < im->in->vertex_count; v++) {
        double p[3];
        if (!enc_bit_get(im->first, v))
            continue;
        enc_load_position(im->in, im->config->lossless, v, p);
        for (int k = 0; k < 3; k++) {
            if (!any || p[k] < grid->origin[k])
                grid->origin[k] = p[k];
            if (!any || p[k] > high[k])
                high[k] = p[k];
        }
        any = true;
    }
    for (int k = 0; k < 3; k++)
        if (high[k] - grid->origin[k] > extent)
            extent = high[k] - grid->origin[k];
    grid->bits = im->config->position_bits;
    grid->step = extent / (double)((UINT32_C(1) << grid->bits) - 1);
    if (grid->step < DBL_MIN)
        grid->step = DBL_MIN; /* a normal number; leaves codes unused */
}

static void load_positions(enc_importer *im)
{
    enc_mesh *mesh = im->mesh;
    uint32_t vertex = 0;

    for (uint32_t v = 0; v < im->in->vertex_count; v++) {
        double p[3];
        if (!enc_bit_get(im->first, v))
            continue;
        enc_load_position(im->in, im->config->lossless, v, p);
        for (int k = 0; k < 3; k++) {
            const int32_t q = pmesh_grid_quantize(&mesh->grid, k, p[k]);
            mesh->position[vertex][k] = q;
            if (q > mesh->bounds[k])
                mesh->bounds[k] = q;
            if (mesh->exact)
                mesh->exact[vertex][k] = (float)p[k];
        }
        if (mesh->source)
            mesh->source[vertex] = v;
        vertex++;
    }
}

/* Weld, drop, number, quantise: mesh has faces and positions, no twins. */
static pmesh_status load_mesh(enc_importer *im)
{
    const pmesh_mesh_input *in = im->in;
    enc_mesh *mesh = im->mesh;
    const pmesh_allocator *a = &mesh->allocator;

    im->number = pmesh_alloc(a, in->vertex_count, sizeof *im->number);
    im->first = pmesh_alloc_zero(a, enc_bit_words(in->vertex_count),
                                 sizeof *im->first);
    if (!im->number || !im->first)
        return PMESH_E_MEMORY;
    pmesh_status status = find_usable(im);
    if (!status)
        status = enc_weld(a, in, im->config->weld, im->config->lossless,
                          im->number, &im->report->zero_twins);
    if (!status)
        status = select_faces(im);
    if (status)
        return status;

    mesh->vertex =
        pmesh_alloc(a, 3 * (size_t)mesh->face_count, sizeof *mesh->vertex);
    mesh->position =
        pmesh_alloc(a, mesh->vertex_count, sizeof *mesh->position);
    if (im->config->lossless)
        mesh->exact =
            pmesh_alloc(a, mesh->vertex_count, sizeof *mesh->exact);
    if (im->config->cost == PMESH_COST_CUSTOM)
        mesh->source =
            pmesh_alloc(a, mesh->vertex_count, sizeof *mesh->source);
    im->source_count = mesh->face_count;
    im->source = pmesh_alloc(a, im->source_count, sizeof *im->source);
    if (mesh->material_count > 1)
        mesh->material =
            pmesh_alloc_zero(a, mesh->face_count, sizeof *mesh->material);
    if (!mesh->vertex || !mesh->position || !im->source ||
        (im->config->lossless && !mesh->exact) ||
        (im->config->cost == PMESH_COST_CUSTOM && !mesh->source) ||
        (mesh->material_count > 1 && !mesh->material))
        return PMESH_E_MEMORY;
    number_vertices(im);
    load_faces(im);
    fit_grid(im);
    load_positions(im);
    return PMESH_OK;
}

static void release_numbers(enc_importer *im)
{
    const pmesh_allocator *a = &im->mesh->allocator;

    pmesh_release(a, im->number, im->in->vertex_count, sizeof *im->number);
    pmesh_release(a, im->first, enc_bit_words(im->in->vertex_count),
                  sizeof *im->first);
}

static void begin_report(const enc_importer *im)
{
    pmesh_encode_report *report = im->report;

    report->input_faces = (uint32_t)im->in->face_count;
    report->input_vertices = (uint32_t)im->in->vertex_count;
    report->degenerate_faces = report->duplicate_faces = 0;
    report->not_finite_faces = report->not_finite_values = 0;
    report->welded_vertices = report->unused_vertices = 0;
    report->zero_twins = report->cut_vertices = report->components = 0;
    report->joined_vertices = 0;
    report->faces = report->vertices = report->wedges = 0;
    report->error_index = 0;
}

static pmesh_status run_import(enc_importer *im)
{
    pmesh_status status = check_arguments(im);
    if (!status)
        status = check_indices(im);
    if (status)
        return status;

    status = load_mesh(im);
    if (!status)
        status = enc_order(im);
    if (!status)
        status = enc_make_manifold(im);
    if (!status)
        status = enc_wedges(im->mesh, im->in, im->config, im->source,
                            &im->report->not_finite_values);
    if (!status)
        status = enc_guide_create(im->mesh, im->in, im->config->guide,
                                  im->number, im->source);
    release_numbers(im);
    pmesh_release(&im->mesh->allocator, im->source, im->source_count,
                  sizeof *im->source);
    return status;
}

pmesh_status enc_mesh_import(const pmesh_mesh_input *in,
                             const pmesh_encoder_config *config,
                             enc_pool *pool, enc_mesh *out,
                             pmesh_encode_report *report)
{
    enc_importer im = { .in = in, .config = config, .mesh = out,
                    .report = report };

    *out = (enc_mesh){
        .allocator = pmesh_allocator_resolve(config->allocator),
        .material_count = in->material_count ? in->material_count : 1,
        .pool = pool
    };
    begin_report(&im);
    const pmesh_status status = run_import(&im);
    if (status) {
        enc_mesh_destroy(out);
        return status;
    }
    report->grid = out->grid;
    report->faces = out->face_count;
    report->vertices = out->vertex_count;
    report->wedges = out->wedge_count;
    return PMESH_OK;
}
