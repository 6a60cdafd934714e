/* SPDX-License-Identifier: MIT */
/*
 * gltf_channels.c - which attributes of a mesh go into its stream.
 *
 * A stream has at most eight. What a renderer cannot make up by itself goes
 * first; morph targets go all or none, for a mesh with half of them is wrong.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/gltf.h"

#define MOST_CANDIDATES 64

typedef struct candidate {
    gltf_channel channel;
    int rank;
} candidate;

typedef struct search {
    const gltf_model *model;
    const gltf_mesh *mesh;
    const char *name; /* of the mesh, for messages */
    asset *warnings;
    candidate found[MOST_CANDIDATES];
    size_t count;
    bool too_many;
    gltf_budget *budget;
    bool spent;
} search;

bool gltf_is_coded(const gltf_primitive *p)
{
    return p->position != GLTF_NONE;
}

/* "JOINTS_12" has the prefix "JOINTS_" and the number 12. */
static bool numbered(const char *semantic, const char *prefix,
                     unsigned *number)
{
    const size_t n = strlen(prefix);
    if (strncmp(semantic, prefix, n) != 0 || semantic[n] == '\0')
        return false;
    *number = 0;
    for (const char *p = semantic + n; *p; p++) {
        if (*p < '0' || *p > '9' || *number > 25)
            return false;
        *number = *number * 10 + (unsigned)(*p - '0');
    }
    return *number < 256;
}

/* Kind, shape and rank by name; false if it is none that glTF knows. */
static bool describe(const char *semantic, uint8_t components, candidate *out)
{
    static const struct {
        const char *prefix;
        pmesh_attribute_kind kind;
        uint8_t least, most; /* components */
        int rank, more;      /* of number 0, and of others */
    } families[] = { { "TEXCOORD_", PMESH_TEXCOORD, 2, 2, 1, 20 },
                     { "JOINTS_", PMESH_GENERIC, 4, 4, 2, 10 },
                     { "WEIGHTS_", PMESH_GENERIC, 4, 4, 3, 11 },
                     { "COLOR_", PMESH_COLOR, 3, 4, 4, 22 } };
    gltf_channel *c = &out->channel;
    unsigned number;

    c->semantic = semantic;
    c->components = components;
    c->kind = PMESH_GENERIC;
    if (strcmp(semantic, "NORMAL") == 0) {
        c->kind = PMESH_NORMAL;
        out->rank = 0;
        return components == 3;
    }
    if (strcmp(semantic, "TANGENT") == 0) {
        out->rank = 5;
        return components == 4;
    }
    for (size_t i = 0; i < sizeof families / sizeof *families; i++) {
        if (!numbered(semantic, families[i].prefix, &number))
            continue;
        c->kind = families[i].kind;
        c->number = (uint8_t)number;
        out->rank = number == 0 ? families[i].rank
                                : families[i].more + 2 * (int)number;
        return components >= families[i].least &&
               components <= families[i].most;
    }
    out->rank = 15;
    return semantic[0] == '_';
}

/* Of a morph target: differences, so generic whatever they are. */
static bool describe_target(const char *semantic, uint8_t components,
                            uint32_t set, candidate *out)
{
    candidate plain = { 0 };
    const bool vector = strcmp(semantic, "POSITION") == 0 ||
                        strcmp(semantic, "NORMAL") == 0 ||
                        strcmp(semantic, "TANGENT") == 0;
    const bool known = vector ? components == 3
                              : describe(semantic, components, &plain);
    out->channel = (gltf_channel){ .semantic = semantic, .set = set,
                                   .kind = PMESH_GENERIC,
                                   .components = components };
    out->rank = 100 + (int)(set < 1000 ? set : 1000);
    return known;
}

static const gltf_set *set_of(const gltf_model *model,
                              const gltf_primitive *p, uint32_t set)
{
    return set < p->set_count ? &model->sets[p->first_set + set] : NULL;
}

const gltf_accessor *gltf_channel_accessor(const gltf_model *model,
                                           const gltf_primitive *p,
                                           const gltf_channel *channel)
{
    const gltf_set *set = set_of(model, p, channel->set);
    for (size_t i = 0; set && i < set->count; i++) {
        const gltf_named *named = &model->named[set->first + i];
        const gltf_accessor *a = &model->accessors[named->accessor];
        if (strcmp(named->semantic, channel->semantic) == 0)
            return a->count == model->accessors[p->position].count &&
                           a->components <= channel->components &&
                           (a->components == channel->components ||
                            channel->kind == PMESH_COLOR) &&
                           a->type != GLTF_U32
                       ? a
                       : NULL;
    }
    return NULL;
}

static void note(search *s, const gltf_primitive *p, const gltf_named *named,
                 uint32_t set)
{
    const gltf_accessor *a = &s->model->accessors[named->accessor];
    const uint8_t n = a->components;
    candidate c = { 0 };

    if (set == 0 && strcmp(named->semantic, "POSITION") == 0)
        return;
    const bool known = set == 0 ? describe(named->semantic, n, &c)
                                : describe_target(named->semantic, n, set, &c);
    if (!known || a->type == GLTF_U32 ||
        a->count != s->model->accessors[p->position].count) {
        asset_warn(s->warnings, "%s: an unusable %.40s is left out", s->name,
                   named->semantic);
        return;
    }
    for (size_t i = 0; i < s->count; i++) {
        gltf_channel *other = &s->found[i].channel;
        if (other->set != set || strcmp(other->semantic, named->semantic) != 0)
            continue;
        if (other->components < n) /* colours with and without alpha */
            other->components = n;
        return;
    }
    if (s->count == MOST_CANDIDATES)
        s->too_many = true;
    else
        s->found[s->count++] = c;
}

static int by_rank(const void *a, const void *b)
{
    const candidate *x = a, *y = b;
    if (x->rank != y->rank)
        return x->rank < y->rank ? -1 : 1;
    return strcmp(x->channel.semantic, y->channel.semantic);
}

/* Joints and application data, if they are whole numbers, get as many bits as
 * keep them: half a step is below one half then. */
static void fit_whole_numbers(search *s, gltf_channel *c)
{
    double low = 0, high = 0;
    bool whole = c->set == 0 && (c->semantic[0] == '_' ||
                                 strncmp(c->semantic, "JOINTS_", 7) == 0);
    for (size_t k = 0; whole && k < s->mesh->count; k++) {
        const gltf_primitive *p = &s->model->primitives[s->mesh->first + k];
        const gltf_accessor *a =
            gltf_is_coded(p) ? gltf_channel_accessor(s->model, p, c) : NULL;
        if (a && !gltf_spend(s->budget, a->count, a->components)) {
            s->spent = true;
            return;
        }
        for (uint64_t i = 0; a && whole && i < a->count; i++) {
            double v[4] = { 0 };
            gltf_get(a, i, v);
            for (unsigned n = 0; n < a->components; n++) {
                whole = whole && fabs(v[n]) < 1e9 && v[n] >= floor(v[n]) &&
                        v[n] <= floor(v[n]);
                low = fmin(low, v[n]);
                high = fmax(high, v[n]);
            }
        }
    }
    if (!whole)
        return;
    if (high - low > 65535) {
        asset_warn(s->warnings, "%s: %.40s spans more than 65536 values and is "
                   "not kept exactly", s->name, c->semantic);
        c->bits = 16;
        return;
    }
    c->exact = true;
    c->bits = 4;
    while (high - low > (double)((1 << c->bits) - 1))
        c->bits++;
}

bool gltf_channels_of(const gltf_model *model, const gltf_mesh *mesh,
                      const char *name, gltf_budget *budget, gltf_channels *out,
                      asset *warnings, asset_error *error)
{
    search s = { .model = model, .mesh = mesh, .name = name,
                 .warnings = warnings, .budget = budget };
    bool morphs = false;
    uint8_t generic = 0;

    *out = (gltf_channels){ .fits = true };
    for (size_t k = 0; k < mesh->count; k++) {
        const gltf_primitive *p = &model->primitives[mesh->first + k];
        if (!gltf_is_coded(p))
            continue;
        for (uint32_t set = 0; set < p->set_count; set++) {
            const gltf_set *list = set_of(model, p, set);
            morphs = morphs || set > 0;
            for (size_t i = 0; i < list->count; i++)
                note(&s, p, &model->named[list->first + i], set);
        }
    }
    out->fits = !morphs || (s.count <= PMESH_MAX_ATTRIBUTES && !s.too_many);
    qsort(s.found, s.count, sizeof *s.found, by_rank);
    for (size_t i = 0; i < s.count && out->fits; i++) {
        if (out->count == PMESH_MAX_ATTRIBUTES) {
            asset_warn(warnings, "%s: %.40s is left out: at most %d attributes",
                       name, s.found[i].channel.semantic,
                       PMESH_MAX_ATTRIBUTES);
            continue;
        }
        gltf_channel *c = &out->item[out->count++];
        *c = s.found[i].channel;
        if (c->kind == PMESH_GENERIC)
            c->number = generic++;
        fit_whole_numbers(&s, c);
    }
    return !s.spent || asset_fail(error, name, "its primitives share too many "
                                  "elements for a file of this size");
}
