/* SPDX-License-Identifier: MIT */
/*
 * gltf_survey.c - the first look at placed meshes: checks what primitives refer
 * to, counts faces against the budget and finds channels and materials in use.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/gltf.h"

typedef struct survey {
    const gltf_model *model;
    gltf_plan *plan;
    asset *out;
    asset_error *error;
    uint64_t face_limit;
    uint8_t components[GLTF_SLOTS]; /* most of any primitive; 0: none has it */
    bool missing[GLTF_SLOTS];       /* some primitive lacks it */
    bool broken[GLTF_SLOTS];        /* some primitive's is unusable */
    bool without_position;
} survey;

int gltf_slot(const char *semantic)
{
    static const struct {
        const char *prefix;
        int first;
    } families[] = { { "TEXCOORD_", GLTF_TEXCOORD }, { "COLOR_", GLTF_COLOR } };

    if (strcmp(semantic, "NORMAL") == 0)
        return GLTF_NORMAL;
    for (size_t i = 0; i < 2; i++) {
        const size_t n = strlen(families[i].prefix);
        if (strncmp(semantic, families[i].prefix, n) == 0 &&
            semantic[n] >= '0' && semantic[n] < '0' + GLTF_SETS &&
            semantic[n + 1] == '\0')
            return families[i].first + (semantic[n] - '0');
    }
    return -1;
}

static pmesh_attribute_kind slot_kind(unsigned slot)
{
    if (slot == GLTF_NORMAL)
        return PMESH_NORMAL;
    return slot < GLTF_COLOR ? PMESH_TEXCOORD : PMESH_COLOR;
}

static uint8_t slot_set(unsigned slot)
{
    if (slot == GLTF_NORMAL)
        return 0;
    return (uint8_t)(slot < GLTF_COLOR ? slot - GLTF_TEXCOORD
                                       : slot - GLTF_COLOR);
}

static const char *slot_name(unsigned slot, char text[16])
{
    static const char *const names[] = { "NORMAL", "TEXCOORD_", "COLOR_" };
    const pmesh_attribute_kind kind = slot_kind(slot);
    if (kind == PMESH_NORMAL)
        return names[0];
    snprintf(text, 16, "%s%u", names[kind], (unsigned)slot_set(slot));
    return text;
}

const gltf_accessor *gltf_slot_accessor(const gltf_model *model,
                                        const gltf_primitive *p, unsigned slot)
{
    if (p->slots[slot] == GLTF_NONE)
        return NULL;
    const gltf_accessor *a = &model->accessors[p->slots[slot]];
    const pmesh_attribute_kind kind = slot_kind(slot);
    const uint8_t n = a->components;
    const bool shaped = kind == PMESH_NORMAL     ? n == 3
                        : kind == PMESH_TEXCOORD ? n == 2
                                                 : n == 3 || n == 4;
    if (!shaped || a->type == GLTF_U32 ||
        a->count != model->accessors[p->position].count)
        return NULL;
    return a;
}

/* ---- first pass --------------------------------------------------------- */

static bool count_faces(survey *s, const gltf_primitive *p, const char *where)
{
    const gltf_accessor *position = &s->model->accessors[p->position];
    uint64_t faces;

    if (!gltf_face_count(s->model, p, where, &faces, s->error))
        return false;
    s->plan->faces += faces;
    if (s->plan->faces > s->face_limit)
        return asset_fail(s->error, where,
                          "the scene expands to more than %llu triangles, "
                          "the limit for a file of this size",
                          (unsigned long long)s->face_limit);
    s->plan->vertex_bound += position->count < 3 * faces ? position->count
                                                   : 3 * faces;
    if (s->plan->largest < position->count)
        s->plan->largest = position->count;
    return true;
}

static void note_slots(survey *s, const gltf_primitive *p)
{
    for (unsigned slot = 0; slot < GLTF_SLOTS; slot++) {
        const gltf_accessor *a = gltf_slot_accessor(s->model, p, slot);
        if (!a)
            s->missing[slot] = true;
        if (!a && p->slots[slot] != GLTF_NONE)
            s->broken[slot] = true;
        if (a && s->components[slot] < a->components)
            s->components[slot] = a->components;
    }
}

static bool look(survey *s, const gltf_instance *instances, size_t count)
{
    const gltf_model *model = s->model;
    char where[48];

    for (size_t i = 0; i < count; i++) {
        const uint32_t id = instances[i].mesh;
        const gltf_mesh *mesh = &model->meshes[id];
        for (size_t k = 0; k < mesh->count; k++) {
            const gltf_primitive *p = &model->primitives[mesh->first + k];
            if (p->position == GLTF_NONE) {
                s->without_position = true;
                continue;
            }
            snprintf(where, sizeof where, "mesh %u, primitive %zu",
                     (unsigned)id, k);
            if (!count_faces(s, p, where))
                return false;
            note_slots(s, p);
            s->plan->materials[p->material == GLTF_NONE ? model->material_count
                                                  : p->material] = 1;
        }
    }
    if (s->plan->faces == 0)
        return asset_fail(s->error, "", "the scene has no triangles");
    return true;
}

/* ---- what the asset will hold ------------------------------------------- */

/* The first sets of every kind go first: they are what a file rarely misses. */
static void choose_channels(survey *s)
{
    static const uint8_t order[GLTF_SLOTS] = {
        GLTF_NORMAL, GLTF_TEXCOORD, GLTF_COLOR,
        GLTF_TEXCOORD + 1, GLTF_TEXCOORD + 2, GLTF_TEXCOORD + 3,
        GLTF_TEXCOORD + 4, GLTF_TEXCOORD + 5, GLTF_TEXCOORD + 6,
        GLTF_TEXCOORD + 7, GLTF_COLOR + 1, GLTF_COLOR + 2, GLTF_COLOR + 3,
        GLTF_COLOR + 4, GLTF_COLOR + 5, GLTF_COLOR + 6, GLTF_COLOR + 7
    };
    asset *out = s->out;
    char name[16];

    for (size_t i = 0; i < GLTF_SLOTS; i++) {
        const unsigned slot = order[i];
        if (s->broken[slot])
            asset_warn(out, "unusable %s of some primitives is left out",
                       slot_name(slot, name));
        if (s->components[slot] == 0)
            continue;
        if (out->attribute_count == PMESH_MAX_ATTRIBUTES) {
            asset_warn(out, "%s is left out: at most %d attributes",
                       slot_name(slot, name), PMESH_MAX_ATTRIBUTES);
            continue;
        }
        if (s->missing[slot])
            asset_warn(out, "%s is missing on some primitives, which get a "
                       "neutral value", slot_name(slot, name));
        s->plan->channel_slots[out->attribute_count] = (uint8_t)slot;
        out->attributes[out->attribute_count++] =
            (asset_attribute){ .kind = slot_kind(slot),
                               .set = slot_set(slot),
                               .components = s->components[slot] };
    }
}

static char *material_name(const char *name, size_t number)
{
    char fallback[40];
    if (name[0] == '\0') {
        snprintf(fallback, sizeof fallback, "material_%zu", number);
        name = fallback;
    }
    const size_t n = strlen(name) + 1;
    char *copy = malloc(n);
    if (copy)
        memcpy(copy, name, n);
    return copy;
}

/* Numbers the materials in use, in the document's order. */
static bool name_materials(survey *s)
{
    const size_t n = s->model->material_count;
    asset *out = s->out;
    uint32_t count = 0;

    for (size_t i = 0; i <= n; i++)
        count += s->plan->materials[i];
    out->material_count = count;
    if (n == 0)
        return true;
    out->material_names = calloc(count, sizeof *out->material_names);
    if (!out->material_names)
        return false;
    uint32_t next = 0;
    for (size_t i = 0; i <= n; i++) {
        if (!s->plan->materials[i])
            continue;
        char *name = material_name(i < n ? s->model->materials[i] : "default",
                                   i);
        if (!name)
            return false;
        out->material_names[next] = name;
        s->plan->materials[i] = next++;
    }
    return true;
}


bool gltf_survey(const gltf_model *model, const gltf_instance *instances,
                 size_t count, gltf_plan *plan, asset *out, asset_error *error)
{
    survey s = { .model = model, .plan = plan, .out = out, .error = error,
                 .face_limit = GLTF_MAX_FACES };

    if (model->byte_count < s.face_limit / 64)
        s.face_limit = ((uint64_t)1 << 20) + model->byte_count * 63;
    *plan = (gltf_plan){ 0 };
    plan->materials =
        calloc(model->material_count + 1, sizeof *plan->materials);
    if (!plan->materials)
        return asset_fail(error, "", "out of memory");
    if (!look(&s, instances, count))
        return false;
    choose_channels(&s);
    if (!name_materials(&s))
        return asset_fail(error, "", "out of memory");
    if (s.without_position)
        asset_warn(out, "primitives without POSITION are left out");
    return true;
}
