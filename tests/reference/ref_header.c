/* SPDX-License-Identifier: MIT */
/* SPEC 5.3: the header. */
#include "tests/reference/ref.h"

#include <math.h>
#include <string.h>

static double get_f64(ref_bytes *in, const char *rule)
{
    const uint64_t bits = ref_get(in, 8);
    double value;
    memcpy(&value, &bits, sizeof value);
    ref_check(in->r, isfinite(value), rule);
    return value;
}

static float get_f32(ref_bytes *in, const char *rule)
{
    const uint32_t bits = (uint32_t)ref_get(in, 4);
    float value;
    memcpy(&value, &bits, sizeof value);
    ref_check(in->r, isfinite(value), rule);
    return value;
}

static uint64_t get_up_to(ref_bytes *in, uint64_t most, const char *rule)
{
    const uint64_t value = ref_get_varint(in);
    ref_check(in->r, value <= most, rule);
    return value;
}

static void read_modes(ref_bytes *in, ref_header *h)
{
    const uint64_t modes = ref_get(in, 1);
    ref_check(in->r, (modes & 3) <= 2 && (modes & 40) != 40 && modes < 128,
              "5.3: modes");
    h->profile = (int)(modes & 3);
    h->moving = modes & 4;
    h->draco = modes & 8;
    h->lossless = modes & 16;
    h->joined = modes & 32;
    h->measured = modes & 64;
    if (h->moving)
        REF_SEEN(parents_move);
    if (h->lossless)
        REF_SEEN(lossless);
    if (h->joined)
        REF_SEEN(joined);
    if (h->measured)
        REF_SEEN(measured);
}

static void read_grid(ref_bytes *in, ref_header *h)
{
    h->position_bits = (int)ref_get(in, 1);
    ref_check(in->r, h->position_bits >= 4 && h->position_bits <= 24,
              "5.3: position_bits");
    for (int i = 0; i < 3; i++)
        h->origin[i] = get_f64(in, "5.3: origin");
    h->step = get_f64(in, "5.3: step");
    ref_check(in->r, h->step > 0, "5.3: step");
    for (int i = 0; i < 3; i++)
        h->bounds[i] = (int64_t)get_up_to(
            in, (1u << h->position_bits) - 1, "5.3: bounds");
}

static void read_form(ref_bytes *in, ref_form *f)
{
    const int digits = (int)ref_get(in, 1);
    f->decimals = (int)ref_get(in, 1);
    f->radix = digits & 128 ? 2 : 10;
    f->digits = digits & 127;
    ref_check(in->r,
              f->digits >= 1 && f->digits <= (f->radix == 2 ? 24 : 9) &&
                  f->decimals <= (f->radix == 2 ? 149 : 22),
              "6.8: form");
    if (f->radix == 2)
        REF_SEEN(form_binary);
    else
        REF_SEEN(form_decimal);
}

static void read_attribute(ref_bytes *in, ref_header *h, ref_attribute *a)
{
    static const int least[] = { 3, 2, 3, 1 }, most[] = { 3, 2, 4, 4 };
    a->kind = (int)ref_get(in, 1);
    ref_check(in->r, a->kind <= 3, "5.3: kind");
    a->set = (int)ref_get(in, 1);
    a->components = (int)ref_get(in, 1);
    ref_check(in->r,
              a->components >= least[a->kind] && a->components <= most[a->kind],
              "5.3: components");
    a->bits = (int)ref_get(in, 1);
    ref_check(in->r, a->bits >= 4 && a->bits <= 16, "5.3: bits");
    for (int i = 0; a->kind != 0 && i < a->components; i++) {
        a->minimum[i] = get_f32(in, "5.3: minimum");
        a->scale[i] = get_f32(in, "5.3: scale");
        ref_check(in->r, a->scale[i] >= 0, "5.3: scale");
    }
    a->coded = a->kind == 0 ? 2 : a->components;
    for (int i = 0; i < a->coded; i++)
        h->value_bits[h->value_count++] = a->bits;
    switch (a->kind) {
    case 0: REF_SEEN(attribute_normal); break;
    case 1: REF_SEEN(attribute_texture); break;
    case 2: REF_SEEN(attribute_colour); break;
    default: REF_SEEN(attribute_generic); break;
    }
}

/* As differences to the level before. */
static uint64_t get_rise(ref_bytes *in, uint64_t before, uint64_t most)
{
    const uint64_t rise = ref_get_varint(in);
    ref_check(in->r, rise <= most && before + rise <= most, "5.3: totals");
    return before + rise;
}

static void read_level(ref_bytes *in, ref_header *h, int i)
{
    static const ref_level none;
    ref_level *l = &h->level[i];
    const ref_level *was = i > 0 ? l - 1 : &none;
    l->bytes = get_rise(in, was->bytes, (uint64_t)1 << 48);
    l->faces = get_rise(in, was->faces, 1 << 28);
    l->vertices = get_rise(in, was->vertices, 1 << 28);
    l->wedges = h->attribute_count > 0 ? get_rise(in, was->wedges, 1 << 30)
                                       : l->vertices;
    l->error = get_f32(in, "5.3: error");
    ref_check(in->r, l->error >= 0 && (i == 0 || l->error <= was->error),
              "5.3: error");
    l->inflation = (int)ref_get(in, 1);
    ref_check(in->r, l->inflation == 0 || i + 1 < h->level_count,
              "5.3: inflation");
    l->rms = h->measured ? get_up_to(in, 1 << 30, "5.3: rms") : 0;
    l->most = h->measured ? get_up_to(in, 1 << 30, "5.3: most") : 0;
    ref_check(in->r, l->rms <= l->most, "5.3: rms");
    const uint64_t faces = l->faces - was->faces;
    const uint64_t vertices = l->vertices - was->vertices;
    const uint64_t wedges = l->wedges - was->wedges;
    if (i == 0)
        ref_check(in->r,
                  faces >= 1 && vertices >= 3 && vertices / 3 <= faces &&
                      vertices <= wedges && wedges <= 3 * faces,
                  "5.3: counts of the base");
    else
        ref_check(in->r,
                  vertices >= 1 && wedges >= vertices &&
                      (h->joined ||
                       (faces >= vertices && faces <= 2 * vertices)),
                  "5.3: counts of a level");
}

/* What the table of levels bounds, though it comes behind. */
static void check_sizes(ref *r)
{
    const ref_header *h = &r->header;
    const ref_level *last = &h->level[h->level_count - 1];
    const uint64_t splits = last->vertices - h->level[0].vertices;
    const uint64_t wedges = last->wedges - h->level[0].wedges;
    ref_check(r, h->block_splits <= splits, "5.3: block_splits");
    ref_check(r, h->block_wedges <= wedges, "5.3: block_wedges");
    const uint64_t faces = last->faces - h->level[0].faces;
    ref_check(r, h->moved_corners <= 48 * splits + (h->joined ? faces : 0),
              "5.3: moved_corners");
    ref_check(r, h->block_faces <= faces, "5.3: block_faces");
    ref_check(r,
              !h->joined || (h->base_fans >= h->level[0].vertices &&
                             h->base_fans <= 3 * h->level[0].faces),
              "5.3: base_fans");
}

void ref_read_header(ref *r, const uint8_t *data, size_t size)
{
    ref_header *h = &r->header;
    ref_bytes in = { r, data, data + size, "5.3: the header is too short" };
    if (ref_get(&in, 1) != 0) {
        r->verdict = REF_NEWER;
        r->rule = "5.3: version";
        longjmp(r->stop, 1);
    }
    h->content_hash = ref_get(&in, 8);
    read_modes(&in, h);
    read_grid(&in, h);
    h->material_count = get_up_to(&in, 65536, "5.3: material_count");
    ref_check(r, h->material_count >= 1, "5.3: material_count");
    h->chunk_size = get_up_to(&in, 1 << 28, "5.3: chunk_size");
    h->block_splits = get_up_to(&in, 32768, "5.3: block_splits");
    h->block_wedges = get_up_to(&in, 1 << 30, "5.3: block_wedges");
    h->moved_corners = get_up_to(&in, 1u << 31, "5.3: moved_corners");
    h->names_size = get_up_to(&in, 1 << 20, "5.3: names_size");
    if (h->joined) {
        h->base_fans = get_up_to(&in, 3u << 28, "5.3: base_fans");
        h->block_faces = get_up_to(&in, 1 << 28, "5.3: block_faces");
    }
    if (h->lossless) {
        h->exact_size =
            get_up_to(&in, (uint64_t)1 << 48, "5.3: exact_size");
        ref_check(r, h->exact_size >= 1, "5.3: exact_size");
        for (int i = 0; i < 3; i++)
            read_form(&in, &h->form[i]);
    }
    h->attribute_count = (int)ref_get(&in, 1);
    ref_check(r, h->attribute_count <= 8, "5.3: attribute_count");
    for (int i = 0; i < h->attribute_count; i++)
        read_attribute(&in, h, &h->attribute[i]);
    h->level_count = (int)ref_get(&in, 1);
    ref_check(r, h->level_count >= 1 && h->level_count <= 64,
              "5.3: level_count");
    for (int i = 0; i < h->level_count; i++)
        read_level(&in, h, i);
    ref_check(r, in.next == in.end, "5.3: the header is too long");
    check_sizes(r);
}
