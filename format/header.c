/* SPDX-License-Identifier: MIT */
#include "format/header.h"

#include "format/quantize.h"

enum { BINARY_FORM = 0x80 };

bool pmesh_chunk_is_chained(uint8_t type)
{
    return type < PMESH_CHUNK_SKIPPABLE && type != PMESH_CHUNK_HEADER &&
           type != PMESH_CHUNK_SCENE;
}

uint64_t pmesh_hash_crc(uint64_t hash, uint32_t crc)
{
    for (int i = 0; i < 4; i++)
        hash = (hash ^ (crc >> (8 * i) & 0xff)) * 0x100000001b3u;
    return hash;
}

static void write_attribute(pmesh_writer *out, const pmesh_attribute *a)
{
    pmesh_put(out, a->kind, 1);
    pmesh_put(out, a->set, 1);
    pmesh_put(out, a->components, 1);
    pmesh_put(out, a->bits, 1);
    for (int i = 0; i < a->components && a->kind != PMESH_NORMAL; i++) {
        pmesh_put_f32(out, a->minimum[i]);
        pmesh_put_f32(out, a->scale[i]);
    }
}

static void write_exact(pmesh_writer *out, const pmesh_header_chunk *h)
{
    if (h->exact_size == 0)
        return;
    pmesh_put_varint(out, h->exact_size);
    for (int k = 0; k < 3; k++) {
        const pmesh_form *f = &h->exact_form[k];
        pmesh_put(out, f->digits | (f->binary ? BINARY_FORM : 0u), 1);
        pmesh_put(out, f->decimals, 1);
    }
}

void pmesh_header_write(pmesh_writer *out, const pmesh_header_chunk *h)
{
    const pmesh_codec_sizes *s = &h->sizes;
    pmesh_put(out, PMESH_FORMAT_VERSION, 1);
    pmesh_put(out, h->content_hash, 8);
    pmesh_put(out,
              h->profile | (s->moves ? PMESH_MODES_MOVES : 0) |
                  (h->base_coder == PMESH_BASE_DRACO ? PMESH_MODES_DRACO_BASE
                                                     : 0) |
                  (h->exact_size > 0 ? PMESH_MODES_LOSSLESS : 0) |
                  (s->joined ? PMESH_MODES_JOINED : 0) |
                  (h->measured ? PMESH_MODES_MEASURED : 0),
              1);
    pmesh_put(out, h->grid.bits, 1);
    for (int k = 0; k < 3; k++)
        pmesh_put_f64(out, h->grid.origin[k]);
    pmesh_put_f64(out, h->grid.step);
    for (int k = 0; k < 3; k++)
        pmesh_put_varint(out, (uint32_t)h->bounds[k]);
    pmesh_put_varint(out, s->material_count);
    pmesh_put_varint(out, h->chunk_size);
    pmesh_put_varint(out, s->block_splits);
    pmesh_put_varint(out, s->block_wedges);
    pmesh_put_varint(out, h->moved_corners);
    pmesh_put_varint(out, h->names_size);
    if (s->joined) {
        pmesh_put_varint(out, s->base_fans);
        pmesh_put_varint(out, s->block_faces);
    }
    write_exact(out, h);

    pmesh_put(out, h->attribute_count, 1);
    for (uint32_t i = 0; i < h->attribute_count; i++)
        write_attribute(out, &h->attributes[i]);

    pmesh_put(out, h->level_count, 1);
    pmesh_level_entry last = { 0 };
    for (uint32_t i = 0; i < h->level_count; i++) {
        const pmesh_level_entry *e = &h->levels[i];
        pmesh_put_varint(out, e->bytes - last.bytes);
        pmesh_put_varint(out, e->faces - last.faces);
        pmesh_put_varint(out, e->vertices - last.vertices);
        if (h->attribute_count)
            pmesh_put_varint(out, e->wedges - last.wedges);
        pmesh_put_f32(out, e->error);
        pmesh_put(out, e->inflation, 1);
        if (h->measured) {
            pmesh_put_varint(out, e->rms);
            pmesh_put_varint(out, e->most);
        }
        last = *e;
    }
}

/* Not NaN, not infinite: the difference is 0 for finite numbers only. */
static bool is_finite(double x)
{
    return x - x == 0;
}

static const char *read_attribute(pmesh_cursor *in, pmesh_attribute *a)
{
    const uint8_t kind = pmesh_get_u8(in);
    *a = (pmesh_attribute){ .kind = PMESH_GENERIC };
    a->set = pmesh_get_u8(in);
    a->components = pmesh_get_u8(in);
    a->bits = pmesh_get_u8(in);
    if (kind > PMESH_GENERIC)
        return "SPEC 5.3: an unknown kind of attribute";
    a->kind = (pmesh_attribute_kind)kind;
    if (a->components < 1 || a->components > PMESH_MAX_COMPONENTS ||
        (kind == PMESH_NORMAL && a->components != 3) ||
        (kind == PMESH_TEXCOORD && a->components != 2) ||
        (kind == PMESH_COLOR && a->components < 3))
        return "SPEC 5.3: components do not fit the attribute";
    if (a->bits < 4 || a->bits > 16)
        return "SPEC 5.3: attribute bits are 4 to 16";
    for (int i = 0; i < a->components && kind != PMESH_NORMAL; i++) {
        a->minimum[i] = pmesh_get_f32(in);
        a->scale[i] = pmesh_get_f32(in);
        if (!is_finite(a->minimum[i]) || !is_finite(a->scale[i]) ||
            a->scale[i] < 0)
            return "SPEC 5.3: an attribute's range is not finite";
    }
    return NULL;
}

static const char *read_attributes(pmesh_cursor *in, pmesh_header_chunk *h)
{
    h->attribute_count = pmesh_get_u8(in);
    if (h->attribute_count > PMESH_MAX_ATTRIBUTES)
        return "SPEC 5.3: more than 8 attributes";
    h->sizes.attribute_count = h->attribute_count;
    h->sizes.value_count = 0;
    for (uint32_t i = 0; i < h->attribute_count; i++) {
        const char *rule = read_attribute(in, &h->attributes[i]);
        if (rule)
            return rule;
        h->sizes.value_count += pmesh_coded_components(&h->attributes[i]);
    }
    return NULL;
}

static const char *read_level(pmesh_cursor *in, pmesh_header_chunk *h,
                              pmesh_level_entry *e,
                              const pmesh_level_entry *last)
{
    const uint64_t bytes = pmesh_get_varint(in);
    const uint32_t faces = pmesh_get_count(in, PMESH_MAX_FACES);
    const uint32_t vertices = pmesh_get_count(in, PMESH_MAX_FACES);
    const uint32_t wedges =
        h->attribute_count ? pmesh_get_count(in, PMESH_MAX_WEDGES) : vertices;
    e->error = pmesh_get_f32(in);
    e->inflation = pmesh_get_u8(in);
    e->rms = h->measured ? pmesh_get_count(in, PMESH_MAX_MEASURED) : 0;
    e->most = h->measured ? pmesh_get_count(in, PMESH_MAX_MEASURED) : 0;
    if (in->overrun || bytes > PMESH_MAX_FILE - last->bytes ||
        faces > PMESH_MAX_FACES - last->faces ||
        vertices > PMESH_MAX_FACES - last->vertices ||
        wedges > PMESH_MAX_WEDGES - last->wedges)
        return "SPEC 5.3: the level table is out of range";
    e->bytes = last->bytes + bytes;
    e->faces = last->faces + faces;
    e->vertices = last->vertices + vertices;
    e->wedges = last->wedges + wedges;
    if (!is_finite(e->error) || e->error < 0 || e->rms > e->most)
        return "SPEC 5.3: a level's error is not a distance";
    if (last->faces == 0) /* the base mesh */
        return faces >= 1 && vertices >= 3 && vertices / 3 <= faces &&
                       wedges >= vertices && wedges <= 3 * faces
                   ? NULL
                   : "SPEC 5.3: the base mesh has impossible counts";
    const bool possible = h->sizes.joined || (faces >= vertices &&
                                              faces <= 2 * vertices);
    if (vertices < 1 || !possible || wedges < vertices ||
        e->error > last->error)
        return "SPEC 5.3: a level's counts do not follow from the one before";
    return NULL;
}

static const char *read_levels(pmesh_cursor *in, pmesh_header_chunk *h)
{
    pmesh_level_entry last = { 0 };
    h->level_count = pmesh_get_u8(in);
    if (h->level_count < 1 || h->level_count > PMESH_MAX_LEVELS)
        return "SPEC 5.3: 1 to 64 levels";
    for (uint32_t i = 0; i < h->level_count; i++) {
        const char *rule = read_level(in, h, &h->levels[i], &last);
        if (rule)
            return rule;
        last = h->levels[i];
    }
    if (last.inflation != 0)
        return "SPEC 5.3: the full mesh is inflated";
    h->sizes.base_faces = h->levels[0].faces;
    h->base_vertices = h->levels[0].vertices;
    h->base_wedges = h->levels[0].wedges;
    h->sizes.coarse_vertices =
        h->levels[h->level_count > 1 ? h->level_count - 2 : 0].vertices;
    h->sizes.faces = last.faces;
    h->sizes.vertices = last.vertices;
    h->sizes.wedges = last.wedges;
    return NULL;
}

static const char *read_frame(pmesh_cursor *in, pmesh_header_chunk *h)
{
    const uint8_t modes = pmesh_get_u8(in);
    const uint8_t apart = PMESH_MODES_DRACO_BASE | PMESH_MODES_JOINED;
    if (modes > PMESH_MODES_ALL || (modes & apart) == apart ||
        (modes & PMESH_MODES_PROFILE) > PMESH_QUALITY)
        return "SPEC 5.3: an unknown mode";
    h->profile = (pmesh_profile)(modes & PMESH_MODES_PROFILE);
    h->sizes.moves = modes & PMESH_MODES_MOVES;
    h->sizes.joined = modes & PMESH_MODES_JOINED;
    h->measured = modes & PMESH_MODES_MEASURED;
    h->base_coder = modes & PMESH_MODES_DRACO_BASE ? PMESH_BASE_DRACO
                                                   : PMESH_BASE_NATIVE;
    h->exact_size = modes & PMESH_MODES_LOSSLESS ? 1 : 0; /* until it is read */
    h->grid.bits = pmesh_get_u8(in);
    if (h->grid.bits < 4 || h->grid.bits > 24)
        return "SPEC 5.3: position bits are 4 to 24";
    for (int k = 0; k < 3; k++) {
        h->grid.origin[k] = pmesh_get_f64(in);
        if (!is_finite(h->grid.origin[k]))
            return "SPEC 5.3: the grid's origin is not finite";
    }
    h->grid.step = pmesh_get_f64(in);
    if (!is_finite(h->grid.step) || h->grid.step <= 0)
        return "SPEC 5.3: the grid's step is not a length";
    for (int k = 0; k < 3; k++)
        h->bounds[k] =
            (int32_t)pmesh_get_count(in, ((uint32_t)1 << h->grid.bits) - 1);
    return NULL;
}

static const char *read_limits(pmesh_cursor *in, pmesh_header_chunk *h)
{
    h->sizes.material_count = pmesh_get_count(in, PMESH_MAX_MATERIALS);
    h->chunk_size = pmesh_get_count(in, PMESH_MAX_CHUNK_SIZE);
    h->sizes.block_splits = pmesh_get_count(in, PMESH_MAX_BLOCK_SPLITS);
    h->sizes.block_wedges = pmesh_get_count(in, PMESH_MAX_WEDGES);
    h->moved_corners = pmesh_get_count(in, PMESH_MAX_MOVED);
    h->names_size = pmesh_get_count(in, PMESH_MAX_NAMES_SIZE);
    if (h->sizes.joined) {
        h->sizes.base_fans = pmesh_get_count(in, 3 * PMESH_MAX_FACES);
        h->sizes.block_faces = pmesh_get_count(in, PMESH_MAX_FACES);
    }
    return in->overrun || h->sizes.material_count == 0
               ? "SPEC 5.3: a limit is out of range"
               : NULL;
}

static const char *read_exact(pmesh_cursor *in, pmesh_header_chunk *h)
{
    if (h->exact_size == 0)
        return NULL;
    h->exact_size = pmesh_get_varint(in);
    if (h->exact_size == 0 || h->exact_size > PMESH_MAX_FILE)
        return "SPEC 5.3: the size of the exact positions is out of range";
    for (int k = 0; k < 3; k++) {
        const uint8_t digits = pmesh_get_u8(in);
        h->exact_form[k] = (pmesh_form){
            .binary = digits & BINARY_FORM,
            .digits = digits & (BINARY_FORM - 1),
            .decimals = pmesh_get_u8(in)
        };
        if (!pmesh_form_legal(&h->exact_form[k]))
            return "SPEC 5.3: an unknown form of exact positions";
    }
    return NULL;
}

/* What the limits may be, given the counts: no more than could be used. */
static const char *check_limits(const pmesh_header_chunk *h)
{
    const uint64_t splits = h->sizes.vertices - h->base_vertices;
    const uint64_t wedges = h->sizes.wedges - h->base_wedges;
    const uint64_t faces = h->sizes.faces - h->sizes.base_faces;
    const uint64_t moved = splits * PMESH_MAX_RING +
                           (h->sizes.joined ? faces : 0);
    if (h->sizes.block_splits > splits || h->sizes.block_wedges > wedges ||
        h->sizes.block_faces > faces || h->moved_corners > moved)
        return "SPEC 5.3: a limit is larger than anything that needs it";
    if (h->sizes.joined &&
        (h->sizes.base_fans < h->base_vertices ||
         h->sizes.base_fans > 3 * (uint64_t)h->sizes.base_faces))
        return "SPEC 5.3: the base mesh has impossible counts";
    return NULL;
}

pmesh_status pmesh_header_read(pmesh_cursor *in, pmesh_header_chunk *h,
                               const char **rule)
{
    if (pmesh_get_u8(in) != PMESH_FORMAT_VERSION && !in->overrun) {
        *rule = "SPEC 5.3: an unknown format version";
        return PMESH_E_VERSION;
    }
    h->content_hash = pmesh_get(in, 8);
    *rule = read_frame(in, h);
    if (!*rule)
        *rule = read_limits(in, h);
    if (!*rule)
        *rule = read_exact(in, h);
    if (!*rule)
        *rule = read_attributes(in, h);
    if (!*rule)
        *rule = read_levels(in, h);
    if (!*rule)
        *rule = check_limits(h);
    /* What ends too early reads as 0, and may break any rule before. */
    if ((in->overrun && in->next == in->end) ||
        (!*rule && (in->overrun || in->next != in->end)))
        *rule = "SPEC 5.3: the header's size does not fit its fields";
    return *rule ? PMESH_E_CORRUPT : PMESH_OK;
}
