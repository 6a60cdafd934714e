/* SPDX-License-Identifier: MIT */
#include "encoder/enc_import.h"

#include "format/alloc.h"
#include "format/quantize.h"

#include <float.h>

/* One attribute while its corners are turned into wedges. */
typedef struct channel {
    const pmesh_attribute_input *in;
    const uint32_t *indices; /* per input corner */
    uint32_t width;          /* coded integers per tuple */
    size_t rows;             /* tuples that an index can name */
    uint32_t *used;          /* set of rows */
    uint16_t *coded;         /* `width` per row; only used rows are filled */
} channel;

/* One entry of the table that tells the wedges of one vertex apart. */
typedef struct wedge_slot {
    uint32_t vertex; /* whose entry it is: others count as free */
    uint32_t corner; /* one with this wedge */
} wedge_slot;

typedef struct wedger {
    enc_mesh *mesh;
    const uint32_t *source;
    channel channels[PMESH_MAX_ATTRIBUTES];
    uint32_t channel_count;
    uint32_t corner_count;
    uint32_t vertex_count;
    uint32_t *start;   /* per vertex: its first corner */
    uint32_t *next;    /* per corner: the next of its vertex; NULL unless a
                          vertex may have several fans */
    uint32_t *valence; /* per vertex: how many corners */
    size_t slot_count; /* a power of two, for the largest valence */
    wedge_slot *slot;
} wedger;

static uint32_t tuple_of(const wedger *w, const channel *c, uint32_t corner)
{
    return c->indices[3 * (size_t)w->source[corner / 3] + corner % 3];
}

/* Loads a tuple, with every value that has no meaning replaced. Returns
 * whether there was one. */
static bool load_tuple(const channel *c, size_t row, float out[])
{
    const uint32_t n = c->in->components;
    const size_t stride = c->in->stride ? c->in->stride : n * sizeof *out;
    const unsigned char *base = (const unsigned char *)c->in->values;
    bool repaired = false;

    memcpy(out, base + row * stride, n * sizeof *out);
    for (uint32_t k = 0; k < n; k++) {
        float value = out[k] + 0.0f; /* no negative zero */
        if (!(value >= -FLT_MAX && value <= FLT_MAX))
            value = 0.0f;
        if (c->in->kind == PMESH_COLOR)
            value = value < 0.0f ? 0.0f : value > 1.0f ? 1.0f : value;
        repaired |= !(value == out[k]);
        out[k] = value;
    }
    if (c->in->kind == PMESH_NORMAL && out[0] == 0.0f && out[1] == 0.0f &&
        out[2] == 0.0f) {
        out[2] = 1.0f;
        repaired = true;
    }
    return repaired;
}

/* The distance of neighbouring floats as large as `value`, but never a
 * subnormal number: some machines flush them. */
static double float_spacing(float value)
{
    uint32_t word;
    float power;

    memcpy(&word, &value, sizeof word);
    word &= UINT32_C(0x7f800000);
    memcpy(&power, &word, sizeof power);
    const double spacing = (double)power * 0x1p-23;
    return spacing < (double)FLT_MIN ? (double)FLT_MIN : spacing;
}

/*
 * Codes finer than the floats themselves would not survive dequantisation to
 * floats, so there the codes are the floats: multiples of their spacing.
 */
void enc_attribute_fit(pmesh_attribute *attribute, uint32_t k, float low,
                       float high)
{
    const double last = (double)((UINT32_C(1) << attribute->bits) - 1);
    const double range = (double)high - (double)low;
    const double spacing = float_spacing(-low > high ? low : high);

    attribute->minimum[k] = low;
    attribute->scale[k] = (float)(range / last);
    if (range > 0.0 && (double)attribute->scale[k] <= spacing) {
        const double steps = (double)low / spacing; /* below 2^25 in size */
        double whole = (double)(int64_t)steps;
        if (whole > steps)
            whole -= 1.0;
        attribute->minimum[k] = (float)(whole * spacing);
        attribute->scale[k] = (float)spacing;
    }
}

static void fit_channel(const channel *c, pmesh_attribute *attribute,
                        uint32_t *repaired)
{
    float low[PMESH_MAX_COMPONENTS] = { 0 };
    float high[PMESH_MAX_COMPONENTS] = { 0 };
    float value[PMESH_MAX_COMPONENTS];
    bool any = false;

    for (size_t row = 0; row < c->rows; row++) {
        if (!enc_bit_get(c->used, row))
            continue;
        *repaired += load_tuple(c, row, value);
        for (uint32_t k = 0; k < c->in->components; k++) {
            if (!any || value[k] < low[k])
                low[k] = value[k];
            if (!any || value[k] > high[k])
                high[k] = value[k];
        }
        any = true;
    }
    for (uint32_t k = 0; k < c->in->components; k++) {
        if (c->in->kind == PMESH_COLOR)
            enc_attribute_fit(attribute, k, 0.0f, 1.0f);
        else if (c->in->kind != PMESH_NORMAL)
            enc_attribute_fit(attribute, k, low[k], high[k]);
    }
}

static void quantize_channel(const channel *c,
                             const pmesh_attribute *attribute)
{
    float value[PMESH_MAX_COMPONENTS];

    for (size_t row = 0; row < c->rows; row++) {
        if (!enc_bit_get(c->used, row))
            continue;
        load_tuple(c, row, value);
        pmesh_attribute_quantize(attribute, value, c->coded + row * c->width);
    }
}

static uint8_t bits_of(const pmesh_attribute_input *in,
                       const pmesh_encoder_config *config)
{
    if (in->bits)
        return in->bits;
    switch (in->kind) {
    case PMESH_NORMAL:
        return config->normal_bits;
    case PMESH_TEXCOORD:
        return config->texcoord_bits;
    case PMESH_COLOR:
        return config->color_bits;
    case PMESH_GENERIC:
        break;
    }
    return config->generic_bits;
}

static float weight_of(const pmesh_attribute_input *in,
                       const pmesh_encoder_config *config)
{
    if (in->weight != 0)
        return in->weight > 0 ? in->weight : 0;
    switch (in->kind) {
    case PMESH_NORMAL:
        return (float)config->normal_weight;
    case PMESH_TEXCOORD:
        return (float)config->texcoord_weight;
    case PMESH_COLOR:
        return (float)config->color_weight;
    case PMESH_GENERIC:
        break;
    }
    return (float)config->generic_weight;
}

static pmesh_status open_channel(wedger *w, channel *c,
                                 const pmesh_encoder_config *config,
                                 uint32_t *repaired)
{
    const pmesh_allocator *a = &w->mesh->allocator;
    pmesh_attribute *attribute =
        &w->mesh->attribute[w->mesh->attribute_count];

    w->mesh->weight[w->mesh->attribute_count++] = weight_of(c->in, config);
    *attribute = (pmesh_attribute){
        .kind = c->in->kind, .set = c->in->set,
        .components = c->in->components, .bits = bits_of(c->in, config)
    };
    c->width = pmesh_coded_components(attribute);
    w->mesh->value_count += c->width;
    c->coded = pmesh_alloc(a, c->rows, c->width * sizeof *c->coded);
    c->used =
        pmesh_alloc_zero(a, enc_bit_words(c->rows), sizeof *c->used);
    if (!c->coded || !c->used)
        return PMESH_E_MEMORY;
    for (uint32_t corner = 0; corner < w->corner_count; corner++)
        enc_bit_put(c->used, tuple_of(w, c, corner));
    fit_channel(c, attribute, repaired);
    quantize_channel(c, attribute);
    return PMESH_OK;
}

static void close_channel(wedger *w, channel *c)
{
    const pmesh_allocator *a = &w->mesh->allocator;

    pmesh_release(a, c->used, enc_bit_words(c->rows), sizeof *c->used);
    pmesh_release(a, c->coded, c->rows, c->width * sizeof *c->coded);
}

static void gather_values(const wedger *w, uint32_t corner, uint16_t *out)
{
    for (uint32_t i = 0; i < w->channel_count; i++) {
        const channel *c = &w->channels[i];
        const uint16_t *row =
            c->coded + (size_t)tuple_of(w, c, corner) * c->width;
        for (uint32_t k = 0; k < c->width; k++)
            *out++ = row[k];
    }
}

static bool same_tuples(const wedger *w, uint32_t x, uint32_t y)
{
    for (uint32_t i = 0; i < w->channel_count; i++) {
        const channel *c = &w->channels[i];
        if (tuple_of(w, c, x) != tuple_of(w, c, y))
            return false;
    }
    return true;
}

/* The corner of `vertex` with equal values that came first; `corner` itself if
 * there is none. `mask` + 1 slots are more than the vertex has corners. */
static uint32_t first_alike(wedger *w, uint32_t vertex, uint32_t corner,
                            size_t mask)
{
    const size_t size = w->mesh->value_count * sizeof(uint16_t);
    uint16_t value[PMESH_MAX_ATTRIBUTES * PMESH_MAX_COMPONENTS];
    uint16_t other[PMESH_MAX_ATTRIBUTES * PMESH_MAX_COMPONENTS];
    uint64_t hash = 0;

    gather_values(w, corner, value);
    for (uint32_t k = 0; k < w->mesh->value_count; k++)
        hash = enc_mix(hash, value[k]);
    size_t i = hash & mask;
    for (; w->slot[i].vertex == vertex; i = (i + 1) & mask) {
        gather_values(w, w->slot[i].corner, other);
        if (memcmp(value, other, size) == 0)
            return w->slot[i].corner;
    }
    w->slot[i] = (wedge_slot){ .vertex = vertex, .corner = corner };
    return corner;
}

/* The corners of a fan of v, of which `corner` is one. */
static void number_fan(wedger *w, uint32_t v, uint32_t corner, size_t mask,
                       uint32_t *count)
{
    const uint32_t *twin = w->mesh->twin;
    uint32_t *wedge = w->mesh->wedge;
    uint32_t begin = corner, before = ENC_NONE;

    while (twin[begin] != ENC_NONE) {
        begin = enc_next_corner(twin[begin]);
        if (begin == corner)
            break;
    }
    uint32_t x = begin;
    do {
        if (before != ENC_NONE && same_tuples(w, before, x)) {
            wedge[x] = wedge[before];
        } else {
            const uint32_t alike = first_alike(w, v, x, mask);
            wedge[x] = alike == x ? (*count)++ : wedge[alike];
        }
        before = x;
        x = twin[enc_previous_corner(x)];
    } while (x != ENC_NONE && x != begin);
}

/* Wedges are numbered vertex by vertex, and around each counter-clockwise:
 * without seams they have the numbers of their vertices. */
static void number_wedges(wedger *w)
{
    uint32_t *wedge = w->mesh->wedge;
    uint32_t count = 0;

    memset(wedge, 0xff, w->corner_count * sizeof *wedge);
    for (uint32_t v = 0; v < w->vertex_count; v++) {
        size_t slots = 4;
        while (slots < 2 * (size_t)w->valence[v])
            slots *= 2;
        for (uint32_t c = w->start[v]; c != ENC_NONE;
             c = w->next ? w->next[c] : ENC_NONE)
            if (wedge[c] == ENC_NONE)
                number_fan(w, v, c, slots - 1, &count);
    }
    w->mesh->wedge_count = count;
}

static pmesh_status find_wedges(wedger *w)
{
    const pmesh_allocator *a = &w->mesh->allocator;
    const uint32_t *vertex = w->mesh->vertex;
    uint32_t largest = 0;

    w->start = pmesh_alloc(a, w->vertex_count, sizeof *w->start);
    w->valence = pmesh_alloc_zero(a, w->vertex_count, sizeof *w->valence);
    if (w->mesh->joined)
        w->next = pmesh_alloc(a, w->corner_count, sizeof *w->next);
    if (!w->start || !w->valence || (w->mesh->joined && !w->next))
        return PMESH_E_MEMORY;
    memset(w->start, 0xff, w->vertex_count * sizeof *w->start);
    for (uint32_t corner = w->corner_count; corner-- > 0;) {
        if (w->next)
            w->next[corner] = w->start[vertex[corner]];
        w->start[vertex[corner]] = corner;
        if (++w->valence[vertex[corner]] > largest)
            largest = w->valence[vertex[corner]];
    }
    w->slot_count = 4;
    while (w->slot_count < 2 * (size_t)largest)
        w->slot_count *= 2;
    w->slot = pmesh_alloc(a, w->slot_count, sizeof *w->slot);
    if (!w->slot)
        return PMESH_E_MEMORY;
    memset(w->slot, 0xff, w->slot_count * sizeof *w->slot);
    number_wedges(w);
    return PMESH_OK;
}

static pmesh_status fill_wedges(wedger *w)
{
    enc_mesh *mesh = w->mesh;
    const pmesh_allocator *a = &mesh->allocator;

    mesh->wedge_vertex =
        pmesh_alloc(a, mesh->wedge_count, sizeof *mesh->wedge_vertex);
    mesh->value = pmesh_alloc(a, mesh->wedge_count,
                              mesh->value_count * sizeof *mesh->value);
    if (!mesh->wedge_vertex || !mesh->value)
        return PMESH_E_MEMORY;
    memset(mesh->wedge_vertex, 0xff,
           mesh->wedge_count * sizeof *mesh->wedge_vertex);
    for (uint32_t corner = 0; corner < w->corner_count; corner++) {
        const uint32_t i = mesh->wedge[corner];
        if (mesh->wedge_vertex[i] != ENC_NONE)
            continue;
        mesh->wedge_vertex[i] = mesh->vertex[corner];
        gather_values(w, corner, mesh->value + (size_t)i * mesh->value_count);
    }
    return PMESH_OK;
}

static pmesh_status build_wedges(wedger *w, const pmesh_mesh_input *in,
                                 const pmesh_encoder_config *config,
                                 uint32_t *repaired)
{
    pmesh_status status = PMESH_OK;

    for (size_t i = 0; i < in->attribute_count && !status; i++) {
        const pmesh_attribute_input *attribute = &in->attributes[i];
        channel *c = &w->channels[w->channel_count++];
        c->in = attribute;
        c->indices = attribute->indices ? attribute->indices : in->indices;
        c->rows = attribute->indices ? attribute->count : in->vertex_count;
        status = open_channel(w, c, config, repaired);
    }
    if (status)
        return status;
    w->mesh->wedge = pmesh_alloc(&w->mesh->allocator, w->corner_count,
                                 sizeof *w->mesh->wedge);
    if (!w->mesh->wedge)
        return PMESH_E_MEMORY;
    status = find_wedges(w);
    return status ? status : fill_wedges(w);
}

pmesh_status enc_wedges(enc_mesh *mesh, const pmesh_mesh_input *in,
                        const pmesh_encoder_config *config,
                        const uint32_t *source, uint32_t *repaired)
{
    const pmesh_allocator *a = &mesh->allocator;
    wedger w = { .mesh = mesh, .source = source,
                 .corner_count = 3 * mesh->face_count,
                 .vertex_count = mesh->vertex_count };

    *repaired = 0;
    mesh->value_count = 0;
    mesh->attribute_count = 0;
    mesh->wedge_count = mesh->vertex_count;
    if (in->attribute_count == 0)
        return PMESH_OK;
    const pmesh_status status = build_wedges(&w, in, config, repaired);
    pmesh_release(a, w.slot, w.slot_count, sizeof *w.slot);
    pmesh_release(a, w.valence, w.vertex_count, sizeof *w.valence);
    pmesh_release(a, w.next, w.corner_count, sizeof *w.next);
    pmesh_release(a, w.start, w.vertex_count, sizeof *w.start);
    for (uint32_t i = 0; i < w.channel_count; i++)
        close_channel(&w, &w.channels[i]);
    return status;
}
