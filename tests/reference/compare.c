/* SPDX-License-Identifier: MIT */
#include "tests/reference/compare.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

#include "decoder/pmesh_decode.h"
#include "tests/reference/ref.h"
#include "tests/unit/shapes.h"

enum { VIEWS = 6, MEMORY = 1 << 28 };

static ref_verdict verdict_of(pmesh_status status)
{
    switch (status) {
    case PMESH_OK: return REF_COMPLETE;
    case PMESH_NEED_DATA: return REF_INCOMPLETE;
    case PMESH_E_VERSION: return REF_NEWER;
    case PMESH_E_UNSUPPORTED: return REF_UNSUPPORTED;
    default: return REF_REJECTED;
    }
}

/* ---- header ------------------------------------------------------------- */

static bool same_attribute(const ref_attribute *a, const pmesh_attribute *b)
{
    bool same = a->kind == (int)b->kind && a->set == b->set &&
                a->components == b->components && a->bits == b->bits;
    for (int i = 0; a->kind != 0 && i < a->components; i++)
        same = same &&
               !memcmp(&a->minimum[i], &b->minimum[i], sizeof(float)) &&
               !memcmp(&a->scale[i], &b->scale[i], sizeof(float));
    return same;
}

/* A measured distance; a hostile step makes it too large for a float. */
static bool same_distance(uint64_t units, double step, float b)
{
    const double a = step * (double)units / 16;
    return (a < FLT_MAX ? (float)a : FLT_MAX) == b;
}

static bool same_level(const ref_level *a, const pmesh_level *b, double step)
{
    return a->faces == b->faces && a->vertices == b->mesh_vertices &&
           a->wedges == b->vertices &&
           !memcmp(&a->error, &b->error, sizeof(float)) &&
           a->inflation == 256 * b->inflation &&
           same_distance(a->rms, step, b->rms) &&
           same_distance(a->most, step, b->furthest);
}

static const char *compare_header(const ref_header *a, const pmesh_header *b)
{
    bool same = a->content_hash == b->content_hash &&
                a->profile == (int)b->profile &&
                a->moving == (b->placement == PMESH_OPTIMAL) &&
                a->position_bits == b->grid.bits &&
                !memcmp(&a->step, &b->grid.step, sizeof(double)) &&
                !memcmp(a->origin, b->grid.origin, sizeof a->origin) &&
                a->material_count == b->material_count &&
                a->exact_size == b->exact_bytes &&
                a->measured == (b->measured != 0) &&
                a->attribute_count == (int)b->attribute_count &&
                a->level_count == (int)b->level_count;
    for (int i = 0; i < 3; i++)
        same = same && a->bounds[i] == b->bounds[i];
    for (int i = 0; same && i < a->attribute_count; i++)
        same = same_attribute(&a->attribute[i], &b->attributes[i]);
    for (int i = 0; same && i < a->level_count; i++)
        same = same_level(&a->level[i], &b->levels[i], a->step);
    return same ? NULL : "header";
}

static const char *compare_progress(const ref *r, const pmesh_decoder *dec)
{
    const pmesh_progress_state p = pmesh_decoder_progress(dec);
    for (uint32_t i = 0; i < r->header.material_count && i < 100; i++)
        if (strcmp(ref_name(r, i), pmesh_decoder_material_name(dec, i)))
            return "material names";
    if (!r->has_base)
        return p.faces == 0 ? NULL : "faces that were decoded";
    return p.faces != r->face_count          ? "faces that were decoded"
           : (int)p.levels != r->levels      ? "levels that were decoded"
           : p.exact_vertices != r->exact_count ? "exact vertices"
                                                : NULL;
}

/* ---- views -------------------------------------------------------------- */

static const char *compare_floats(const ref *r, const ref_view *a,
                                  const pmesh_decoder *dec)
{
    const char *difference = NULL;
    const size_t count = a->wedges;
    float *room = calloc(4 * count + 1, sizeof *room);
    const float *attribute = a->attributes;
    pmesh_decoder_copy_positions(dec, room, 0);
    if (memcmp(room, a->positions, 3 * count * sizeof *room))
        difference = "dequantised positions";
    for (int i = 0; !difference && i < r->header.attribute_count; i++) {
        const size_t n = count * (size_t)r->header.attribute[i].components;
        pmesh_decoder_copy_attribute(dec, (uint32_t)i, room, 0);
        if (memcmp(room, attribute, n * sizeof *room))
            difference = "dequantised attributes";
        attribute += n;
    }
    free(room);
    return difference;
}

static const char *compare_arrays(const ref *r, const ref_view *a,
                                  const pmesh_view *b)
{
    const size_t values = (size_t)r->header.value_count * a->wedges;
    if (a->faces != b->face_count)
        return "faces";
    if (a->vertices != b->mesh_vertex_count)
        return "vertices";
    if (a->wedges != b->vertex_count)
        return "output vertices";
    if (memcmp(a->indices, b->indices, 12 * (size_t)a->faces))
        return "indices";
    if (memcmp(a->grid, b->positions, 12 * (size_t)a->vertices))
        return "positions";
    if (values && memcmp(a->values, b->values, 2 * values))
        return "values";
    for (uint32_t w = 0; w < a->wedges; w++)
        if (a->vertex_of[w] != (b->positions_of ? b->positions_of[w] : w))
            return "vertices of output vertices";
    for (uint32_t f = 0; f < a->faces; f++)
        if (a->materials[f] != (b->materials ? b->materials[f] : 0))
            return "materials";
    return NULL;
}

static const char *compare_view(const ref *r, pmesh_decoder *dec,
                                uint32_t faces)
{
    ref_view a = ref_view_at(r, faces);
    pmesh_view b = { 0 };
    const pmesh_target target = { .faces = faces };
    pmesh_decoder_refine(dec, &target, NULL);
    pmesh_decoder_mesh(dec, &b);
    const char *difference = compare_arrays(r, &a, &b);
    if (!difference)
        difference = compare_floats(r, &a, dec);
    for (uint32_t v = 0; !difference && v < a.vertices; v++)
        if (a.parents[v] != pmesh_decoder_parent(dec, v))
            difference = "parents";
    ref_view_free(&a);
    return difference;
}

/* All, the base, and some between: the library goes up and down. */
static void compare_views(comparison *c, const ref *r, pmesh_decoder *dec,
                          uint32_t seed)
{
    const uint32_t least = r->base_faces, most = r->face_count;
    for (int i = 0; i < VIEWS && !c->difference; i++) {
        c->faces = i == 0   ? most
                   : i == 1 ? 1
                            : least + shape_random(&seed, most - least + 1);
        c->difference = compare_view(r, dec, c->faces);
        c->views++;
    }
}

static void compare_contents(comparison *c, const ref *r, pmesh_decoder *dec,
                             uint32_t seed)
{
    pmesh_header header;
    if (pmesh_decoder_header(dec, &header) != PMESH_OK) {
        if (r->header.level_count > 0)
            c->difference = "only the reference has a header";
        return;
    }
    c->difference = compare_header(&r->header, &header);
    if (!c->difference)
        c->difference = compare_progress(r, dec);
    if (!c->difference && r->has_base)
        compare_views(c, r, dec, seed);
}

static pmesh_decoder *feed(const uint8_t *data, size_t size,
                           pmesh_status *status)
{
    pmesh_decoder_config config = pmesh_decoder_config_default();
    pmesh_decoder *dec = NULL;
    config.max_memory = MEMORY;
    *status = pmesh_decoder_create(&dec, &config);
    if (*status == PMESH_OK)
        *status = pmesh_decoder_feed(dec, data, size);
    return dec;
}

comparison compare_decoders(const uint8_t *data, size_t size, uint32_t seed)
{
    comparison c = { .rule = "", .library_rule = "" };
    pmesh_status status;
    pmesh_decoder *dec = feed(data, size, &status);
    if (status == PMESH_E_LIMIT || status == PMESH_E_MEMORY) {
        c.too_large = true;
        pmesh_decoder_destroy(dec);
        return c;
    }
    ref *r = ref_decode(data, size);
    const ref_verdict library = verdict_of(status);
    c.accepted = r->verdict == REF_COMPLETE;
    c.readable = c.accepted || r->verdict == REF_INCOMPLETE;
    c.rule = r->rule;
    c.library_rule = pmesh_decoder_error(dec).rule;
    c.other_reason = library != r->verdict;
    const bool library_reads =
        library == REF_COMPLETE || library == REF_INCOMPLETE;
    if (c.accepted != (library == REF_COMPLETE))
        c.difference = c.accepted ? "only the reference accepts it"
                                  : "only the library accepts it";
    else if (c.readable != library_reads)
        c.difference = c.readable ? "only the library rejects it"
                                  : "only the reference rejects it";
    else if (c.readable)
        compare_contents(&c, r, dec, seed);
    ref_free(r);
    pmesh_decoder_destroy(dec);
    return c;
}
