/* SPDX-License-Identifier: MIT */
#include "tests/corrupt/script.h"

#include <stdlib.h>
#include <string.h>

#include "tests/reference/ref.h"

/* ---- models by name ----------------------------------------------------- */

#define AT(member) offsetof(ref, member), sizeof((ref *)NULL)->member

static const struct {
    const char *name;
    size_t at, size;
} groups[] = {
    { "base.boundary", AT(base_models.boundary) },
    { "base.known", AT(base_models.known) },
    { "base.neighbour", AT(base_models.neighbour) },
    { "base.vertex", AT(base_models.vertex) },
    { "base.position", AT(base_models.position) },
    { "base.sign", AT(base_models.sign) },
    { "join.known", AT(join.known) },
    { "join.back", AT(join.back) },
    { "join.whole", AT(join.whole) },
    { "join.moves", AT(join.moves) },
    { "join.lone", AT(join.lone) },
    { "join.pair", AT(join.pair) },
    { "join.turned", AT(join.turned) },
    { "join.far", AT(join.far) },
    { "join.member", AT(join.member) },
    { "flag", AT(flag) },
    { "rank", AT(cut.rank) },
    { "child", AT(residual[0]) },
    { "parent", AT(residual[1]) },
    { "material", AT(wedge_models.material) },
    { "ordinary", AT(wedge_models.ordinary) },
    { "seam", AT(wedge_models.seam) },
    { "corner", AT(wedge_models.corner) },
    { "choice", AT(wedge_models.choice) },
    { "pick", AT(wedge_models.pick) },
    { "differs", AT(channel_models[0].differs) },
    { "exact.same", AT(exact_models.same) },
    { "exact.rare", AT(exact_models.rare) }
};

/* Of a residual: its cells come first, the escape last. */
static const char *part_of_cell(const ref_cell *cells, const ref_model *m)
{
    const size_t at = ((size_t)((const char *)m - (const char *)cells)) %
                      sizeof(ref_cell);
    return at < offsetof(ref_cell, sign)    ? "zero"
           : at < offsetof(ref_cell, unary) ? "sign"
                                            : "unary";
}

static bool within(const void *m, const void *part, size_t size)
{
    const char *at = m, *from = part;
    return at >= from && at < from + size;
}

/* "child.sign", "value.unary", ...; NULL if it has no parts. */
static const char *part_name(const ref *r, const ref_model *m)
{
    for (int i = 0; i < 2; i++)
        if (within(m, r->residual[i].any, sizeof r->residual[i].any))
            return part_of_cell(r->residual[i].any, m);
    for (int i = 0; i < REF_ATTRIBUTES; i++)
        if (within(m, r->channel_models[i].any,
                   sizeof r->channel_models[i].any))
            return part_of_cell(r->channel_models[i].any, m);
    return NULL;
}

static const char *group_name(const ref *r, const ref_model *m)
{
    if (!m)
        return "raw";
    for (size_t i = 0; i < sizeof groups / sizeof *groups; i++)
        if (within(m, (const char *)r + groups[i].at, groups[i].size))
            return groups[i].name;
    return within(m, r->channel_models, sizeof r->channel_models) ? "value"
                                                                  : "";
}

/* "child" names all of "child.zero", "child.sign", ... */
static bool is_named(const ref *r, const ref_model *m, const char *name)
{
    const char *group = group_name(r, m);
    const size_t size = strlen(group);
    if (strncmp(name, group, size) != 0)
        return false;
    if (name[size] == '\0')
        return true;
    const char *part = m ? part_name(r, m) : NULL;
    return name[size] == '.' && part && !strcmp(name + size + 1, part);
}

/* ---- decisions ---------------------------------------------------------- */

typedef struct writer {
    ref *r;
    const script *script;
    int64_t met[TURNS];
    bool began[TURNS];
    const char *next[TURNS]; /* of the bits */
    bool turned;
} writer;

/* The next bit of a turn, or -1. */
static int next_bit(writer *w, int i)
{
    const char **at = &w->next[i];
    if (!*at)
        *at = w->script->turns[i].bits;
    if (**at == '(')
        (*at)++;
    if (**at == ')')
        *at = strchr(w->script->turns[i].bits, '(') + 1;
    return **at ? *(*at)++ - '0' : -1;
}

static int choose(void *user, const ref_model *m, int given)
{
    writer *w = user;
    for (int i = 0; i < TURNS && w->script->turns[i].models; i++) {
        const turn *t = &w->script->turns[i];
        if (!is_named(w->r, m, t->models) ||
            (t->from == AFTERWARDS ? !w->began[i - 1]
                                   : w->met[i]++ < t->from))
            continue;
        w->began[i] = true;
        const int bit = next_bit(w, i);
        w->turned = true;
        if (bit >= 0)
            return bit;
    }
    if (!w->turned)
        return given;
    return m && m->p < 1 << 21;
}

static uint32_t pick(void *user, uint32_t cells, uint32_t given)
{
    writer *w = user;
    if (w->script->pick == 0)
        return given;
    w->turned = true;
    return w->script->pick < cells ? w->script->pick : cells - 1;
}

static void read_chunk(ref *r, const chunk *at)
{
    switch (at->type) {
    case CHUNK_BASE: ref_read_base(r, at->data, at->size); break;
    case CHUNK_POSITIONS: ref_read_exact(r, at->data, at->size); break;
    default: ref_read_block(r, at->data, at->size, at->type == CHUNK_LAST);
    }
}

/* The file before that chunk; `c` stays as it is. */
static ref *decode_before(const chunks *c, const chunk *at)
{
    chunks copy = *c;
    const size_t size = chunk_offset(c, at);
    for (uint32_t i = 0; i < c->count; i++)
        copy.at[i] = chunk_make(c->at[i].type, c->at[i].data, c->at[i].size);
    shape_bytes file = chunks_put_together(&copy);
    ref *r = ref_decode(file.data, size);
    free(file.data);
    return r;
}

const char *script_write(const chunks *c, chunk *at, const script *s)
{
    writer w = { .r = decode_before(c, at), .script = s };
    ref_author author = { .choose = choose, .pick = pick, .user = &w };
    ref *r = w.r;
    const char *volatile rule = r->rule;
    if (r->verdict == REF_INCOMPLETE) {
        r->in.author = &author;
        rule = NULL;
        if (!setjmp(r->stop))
            read_chunk(r, at);
        else
            rule = r->rule;
        ref_author_end(&author);
        /* The counts before the coded stream stay. */
        size_t keep = 0;
        if (at->type != CHUNK_BASE)
            while (at->data[keep++] >= 128)
                ;
        shape_bytes payload = { 0 };
        bytes_put(&payload, at->data, keep);
        bytes_put(&payload, author.data, author.size);
        free(at->data);
        *at = chunk_make(at->type, payload.data, payload.size);
        free(payload.data);
    }
    free(author.data);
    ref_free(r);
    return rule;
}
