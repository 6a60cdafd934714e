/* SPDX-License-Identifier: MIT */
/*
 * io_obj.c - Wavefront OBJ: v (with colours), vt, vn, f and usemtl.
 *
 * Groups, lines, points, free-form surfaces and material libraries are passed
 * over. Faces may precede their vertices: indices are checked at the end.
 */
#include <stdlib.h>
#include <string.h>

#include "tools/builder.h"
#include "tools/hash.h"
#include "tools/text.h"

/* ---- reading ------------------------------------------------------------- */

typedef struct obj_materials {
    char **names; /* in order of the first face that uses them */
    size_t capacity;
    uint32_t count;
    hash_table table;
    u32_list faces;    /* per face; empty while there is but one */
    text_word pending; /* what usemtl said, not used by a face yet */
    bool changed;
    uint32_t current;
} obj_materials;

typedef struct obj_reader {
    text_cursor in;
    mesh_builder mesh;
    f32_list uvs, normals, colors;
    uint32_t top[BUILDER_CHANNELS];    /* the largest index, plus 1 */
    size_t top_line[BUILDER_CHANNELS]; /* the line that has it */
    size_t uncolored, weighted;        /* v lines, once there are colours */
    obj_materials materials;
    bool failed; /* out of memory */
} obj_reader;

/* Blanks, and line ends behind a backslash. */
static void skip_blanks(text_cursor *in)
{
    for (;;) {
        text_skip_blanks(in);
        if (text_left(in) < 2 || *in->p != '\\' || !text_is_eol(in->p[1]))
            return;
        in->p++;
        text_take_eol(in);
    }
}

/* As text_at_gap(), or the backslash of a line that goes on. */
static bool at_gap(const text_cursor *in)
{
    return text_at_gap(in) || *in->p == '\\';
}

static bool at_end_of_data(const text_cursor *in)
{
    return text_at_eol(in) || *in->p == '#';
}

/* Reads up to `max` numbers and sets *count; more are passed over. */
static bool read_numbers(text_cursor *in, double *out, int max, int *count,
                         asset_error *error)
{
    for (*count = 0;; ++*count) {
        skip_blanks(in);
        if (*count == max || at_end_of_data(in))
            return true;
        const char *start = in->p;
        in->p = asset_number_parse(in->p, in->end, &out[*count]);
        if (in->p == start || !at_gap(in))
            return asset_fail(error, TEXT_AT(in), "malformed number");
    }
}

static void push_floats(obj_reader *obj, f32_list *list, const double *values,
                        int count)
{
    for (int i = 0; i < count; i++)
        if (!f32_push(list, builder_float(values[i])))
            obj->failed = true;
}

/* x y z, x y z w, x y z r g b or x y z r g b a. */
static bool read_position(obj_reader *obj, asset_error *error)
{
    static const double white[3] = { 1, 1, 1 };
    double v[7];
    int n;
    if (!read_numbers(&obj->in, v, 7, &n, error))
        return false;
    if (n < 3)
        return asset_fail(error, TEXT_AT(&obj->in),
                          "a position of less than 3 numbers");
    obj->weighted += n == 4 && v[3] != 1;
    if (n >= 6) {
        for (; obj->colors.count < 3 * obj->mesh.vertex_count && !obj->failed;
             obj->uncolored++)
            push_floats(obj, &obj->colors, white, 3);
        push_floats(obj, &obj->colors, v + 3, 3);
    } else if (obj->colors.count) {
        push_floats(obj, &obj->colors, white, 3);
        obj->uncolored++;
    }
    builder_position(&obj->mesh, v[0], v[1], v[2]);
    return true;
}

static bool read_vector(obj_reader *obj, f32_list *list, int size, int required,
                        asset_error *error)
{
    double v[3] = { 0 };
    int n;
    if (!read_numbers(&obj->in, v, 3, &n, error))
        return false;
    if (n < required)
        return asset_fail(error, TEXT_AT(&obj->in),
                          "less than %d numbers here", required);
    push_floats(obj, list, v, size);
    return true;
}

/* One index of a corner: from 1, or counted back from the latest with -1. */
static bool read_index(obj_reader *obj, builder_channel channel, size_t count,
                       uint32_t *out, asset_error *error)
{
    text_cursor *in = &obj->in;
    const bool negative = in->p < in->end && *in->p == '-';
    if (negative)
        in->p++;
    const char *start = in->p;
    uint64_t value = 0;
    for (; in->p < in->end && *in->p >= '0' && *in->p <= '9'; in->p++)
        if (value < UINT32_MAX) /* else it is too large already */
            value = value * 10 + (uint64_t)(*in->p - '0');
    if (in->p == start)
        return asset_fail(error, TEXT_AT(in), "malformed face corner");
    if (value == 0)
        return asset_fail(error, TEXT_AT(in), "index 0: they start at 1");
    if (negative ? value > count : value >= UINT32_MAX)
        return asset_fail(error, TEXT_AT(in), "an index is out of range");
    if (negative)
        value = count - value + 1;
    if (value > obj->top[channel]) {
        obj->top[channel] = (uint32_t)value;
        obj->top_line[channel] = in->line;
    }
    *out = (uint32_t)(value - 1);
    return true;
}

static bool take_slash(text_cursor *in)
{
    if (in->p == in->end || *in->p != '/')
        return false;
    in->p++;
    return true;
}

static bool has_index(const text_cursor *in)
{
    return !at_gap(in) && *in->p != '/';
}

/* v, v/vt, v//vn, v/vt/vn; an index may be missing behind its slash. */
static bool read_corner(obj_reader *obj, mesh_corner *out, asset_error *error)
{
    text_cursor *in = &obj->in;
    *out = builder_vertex(BUILDER_NONE);
    if (!read_index(obj, BUILDER_VERTEX, obj->mesh.vertex_count,
                    &out->index[BUILDER_VERTEX], error))
        return false;
    if (take_slash(in)) {
        if (has_index(in) &&
            !read_index(obj, BUILDER_UV, obj->uvs.count / 2,
                        &out->index[BUILDER_UV], error))
            return false;
        if (take_slash(in) && has_index(in) &&
            !read_index(obj, BUILDER_NORMAL, obj->normals.count / 3,
                        &out->index[BUILDER_NORMAL], error))
            return false;
    }
    return at_gap(in) ||
           asset_fail(error, TEXT_AT(in), "malformed face corner");
}

static char *copy_name(text_word word)
{
    char *name = malloc(word.size + 1);
    if (!name)
        return NULL;
    for (size_t i = 0; i < word.size; i++)
        name[i] = word.data[i] ? word.data[i] : '?';
    name[word.size] = '\0';
    asset_clean_text(name);
    return name;
}

/* The number of a material of this name, old or new. Takes `name` over. */
static bool number_material(obj_materials *m, char *name)
{
    const uint32_t hash = hash_bytes(name, strlen(name));
    if (!hash_reserve(&m->table))
        goto fail;
    size_t i = hash_first(&m->table, hash);
    for (; m->table.slots[i].id != HASH_EMPTY; i = hash_next(&m->table, i)) {
        m->current = m->table.slots[i].id;
        if (m->table.slots[i].hash == hash &&
            strcmp(m->names[m->current], name) == 0) {
            free(name);
            return true;
        }
    }
    char **names = list_grow(m->names, &m->capacity, m->count + (size_t)1,
                             sizeof *names);
    if (!names)
        goto fail;
    m->names = names;
    m->current = m->count;
    names[m->count++] = name;
    hash_put(&m->table, i, hash, m->current);
    return true;
fail:
    free(name);
    return false;
}

/* Gives the faces from `first` on the current material. */
static bool assign_material(obj_materials *m, size_t first, size_t count)
{
    if (m->changed || m->count == 0) {
        char *name = copy_name(m->pending);
        if (!name || !number_material(m, name))
            return false;
        m->changed = false;
    }
    if (m->count < 2)
        return true;
    while (m->faces.count < first) /* all of the first material so far */
        if (!u32_push(&m->faces, 0))
            return false;
    while (m->faces.count < count)
        if (!u32_push(&m->faces, m->current))
            return false;
    return true;
}

static bool read_face(obj_reader *obj, asset_error *error)
{
    const size_t first = obj->mesh.face_count;
    builder_begin_face(&obj->mesh);
    for (;;) {
        skip_blanks(&obj->in);
        if (at_end_of_data(&obj->in))
            break;
        mesh_corner corner;
        if (!read_corner(obj, &corner, error))
            return false;
        builder_corner(&obj->mesh, corner);
    }
    builder_end_face(&obj->mesh);
    if (obj->mesh.face_count > first &&
        !assign_material(&obj->materials, first, obj->mesh.face_count))
        obj->failed = true;
    return true;
}

/* The rest of the line is the name: blanks inside belong to it. */
static void read_material(obj_reader *obj)
{
    text_cursor *in = &obj->in;
    text_skip_blanks(in);
    const char *start = in->p;
    while (!text_at_eol(in))
        in->p++;
    const char *end = in->p;
    while (end > start && text_is_blank(end[-1]))
        end--;
    obj->materials.pending = (text_word){ start, (size_t)(end - start) };
    obj->materials.changed = true;
}

static bool read_line(obj_reader *obj, asset_error *error)
{
    text_cursor *in = &obj->in;
    const text_word word = text_next_word(in);
    if (text_equal(word, "v"))
        return read_position(obj, error);
    if (text_equal(word, "f"))
        return read_face(obj, error);
    if (text_equal(word, "vt"))
        return read_vector(obj, &obj->uvs, 2, 1, error);
    if (text_equal(word, "vn"))
        return read_vector(obj, &obj->normals, 3, 3, error);
    if (text_equal(word, "usemtl"))
        read_material(obj);
    return true;
}

static bool check_indices(const obj_reader *obj, asset_error *error)
{
    static const char *const names[] = { "vertex", "texture coordinate",
                                         "normal" };
    const size_t counts[] = { obj->mesh.vertex_count, obj->uvs.count / 2,
                              obj->normals.count / 3 };
    for (int k = 0; k < BUILDER_CHANNELS; k++) {
        const text_cursor at = { .line = obj->top_line[k] };
        if (obj->top[k] > counts[k])
            return asset_fail(error, TEXT_AT(&at), "%s %lu of %zu", names[k],
                              (unsigned long)obj->top[k], counts[k]);
    }
    return true;
}

/* Corners without texture coordinates share a new tuple (0, 0). */
static bool complete_uvs(obj_reader *obj, asset *out)
{
    u32_list *corners = &obj->mesh.corners[BUILDER_UV];
    const uint32_t none = (uint32_t)(obj->uvs.count / 2);
    size_t missing = 0;
    for (size_t i = 0; i < corners->count; i++) {
        if (corners->items[i] == BUILDER_NONE) {
            corners->items[i] = none;
            missing++;
        }
    }
    if (!missing)
        return true;
    asset_warn(out, "texture coordinates: %zu corners have none, now 0",
               missing);
    return f32_push(&obj->uvs, 0) && f32_push(&obj->uvs, 0);
}

/* Corners without a normal get a zero one per vertex: asset_check() makes it
 * the normal of the faces around. */
static bool complete_normals(obj_reader *obj, const asset *out)
{
    u32_list *corners = &obj->mesh.corners[BUILDER_NORMAL];
    const size_t none = obj->normals.count / 3;
    bool missing = false;
    for (size_t i = 0; i < corners->count; i++)
        missing |= corners->items[i] == BUILDER_NONE;
    if (!missing)
        return true;
    if (none + out->vertex_count >= UINT32_MAX)
        return false;
    for (size_t i = 0; i < corners->count; i++)
        if (corners->items[i] == BUILDER_NONE)
            corners->items[i] = (uint32_t)none + out->indices[i];
    for (size_t i = 0; i < 3 * out->vertex_count; i++)
        if (!f32_push(&obj->normals, 0))
            return false;
    return true;
}

/* Brings all channels up to the last face and hands them over. */
static bool finish_attributes(obj_reader *obj, asset *out)
{
    u32_list *uvs = &obj->mesh.corners[BUILDER_UV];
    u32_list *normals = &obj->mesh.corners[BUILDER_NORMAL];
    if (!complete_uvs(obj, out) || !complete_normals(obj, out))
        return false;
    if (normals->count)
        builder_attach(out, PMESH_NORMAL, 3, &obj->normals, normals);
    if (uvs->count)
        builder_attach(out, PMESH_TEXCOORD, 2, &obj->uvs, uvs);
    if (obj->colors.count)
        builder_attach(out, PMESH_COLOR, 3, &obj->colors, NULL);
    if (obj->uncolored)
        asset_warn(out, "colours: %zu vertices have none, now white",
                   obj->uncolored);
    if (obj->weighted)
        asset_warn(out, "the weights (w) of %zu vertices were ignored",
                   obj->weighted);
    return true;
}

/* A single material without a name is none. */
static void finish_materials(obj_materials *m, asset *out)
{
    if (m->count == 0 || (m->count == 1 && !m->names[0][0]))
        return;
    out->material_names = m->names;
    out->material_count = m->count;
    out->materials = m->faces.items;
    m->names = NULL;
    m->count = 0;
    m->faces.items = NULL;
}

static void free_reader(obj_reader *obj)
{
    builder_free(&obj->mesh);
    free(obj->uvs.items);
    free(obj->normals.items);
    free(obj->colors.items);
    for (uint32_t i = 0; i < obj->materials.count; i++)
        free(obj->materials.names[i]);
    free(obj->materials.names);
    free(obj->materials.table.slots);
    free(obj->materials.faces.items);
}

static bool read_all(obj_reader *obj, asset *out, asset_error *error)
{
    while (obj->in.p < obj->in.end) {
        if (!read_line(obj, error))
            return false;
        text_skip_line(&obj->in);
    }
    if (!check_indices(obj, error) || !builder_finish(&obj->mesh, out, error))
        return false;
    if (obj->failed || !finish_attributes(obj, out))
        return asset_fail(error, "", "out of memory");
    finish_materials(&obj->materials, out);
    return true;
}

bool asset_read_obj(const uint8_t *data, size_t size, asset *out,
                    asset_error *error)
{
    obj_reader obj = { .in = text_open(data, size) };
    *out = (asset){ 0 };
    const bool ok = read_all(&obj, out, error);
    if (!ok)
        asset_free(out);
    free_reader(&obj);
    return ok;
}

/* ---- writing ------------------------------------------------------------- */

static size_t put_index(char *dst, uint32_t value)
{
    char digits[10];
    size_t n = 0;
    do
        digits[n++] = (char)('0' + value % 10);
    while (value /= 10);
    for (size_t i = 0; i < n; i++)
        dst[i] = digits[n - 1 - i];
    return n;
}

/* The first of its kind and lowest set. */
static const asset_attribute *find_attribute(const asset *mesh,
                                             pmesh_attribute_kind kind)
{
    const asset_attribute *found = NULL;
    for (size_t i = 0; i < mesh->attribute_count; i++) {
        const asset_attribute *a = &mesh->attributes[i];
        if (a->kind == kind && (!found || a->set < found->set))
            found = a;
    }
    return found;
}

static void write_positions(const asset *mesh, asset_bytes *out)
{
    const asset_attribute *color = find_attribute(mesh, PMESH_COLOR);
    if (color && color->indices)
        color = NULL; /* OBJ has colours at vertices only */
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        char line[8 * 33];
        size_t n = 0;
        line[n++] = 'v';
        for (size_t k = 0; k < 3; k++) {
            line[n++] = ' ';
            n += builder_print(mesh, line + n, 3 * v + k);
        }
        for (size_t k = 0; color && k < 3; k++) {
            line[n++] = ' ';
            n += asset_number_print_float(
                line + n, color->values[v * color->components + k]);
        }
        line[n++] = '\n';
        asset_put(out, line, n);
    }
}

static void write_vectors(const asset_attribute *a, const char *word,
                          size_t size, asset_bytes *out)
{
    for (size_t i = 0; a && i < a->count; i++) {
        char line[4 * 33];
        size_t n = strlen(word);
        memcpy(line, word, n);
        for (size_t k = 0; k < size; k++) {
            line[n++] = ' ';
            n += asset_number_print_float(line + n,
                                          a->values[i * a->components + k]);
        }
        line[n++] = '\n';
        asset_put(out, line, n);
    }
}

static void write_material(const asset *mesh, uint32_t material, bool first,
                           asset_bytes *out)
{
    const char *name =
        mesh->material_names ? mesh->material_names[material] : "";
    if (name[0])
        asset_printf(out, "usemtl %s\n", name);
    else if (!first || mesh->material_count > 1)
        asset_printf(out, "usemtl material_%lu\n", (unsigned long)material);
}

static uint32_t tuple_at(const asset_attribute *a, const asset *mesh,
                         size_t corner)
{
    return a->indices ? a->indices[corner] : mesh->indices[corner];
}

static void write_faces(const asset *mesh, asset_bytes *out)
{
    const asset_attribute *uv = find_attribute(mesh, PMESH_TEXCOORD);
    const asset_attribute *normal = find_attribute(mesh, PMESH_NORMAL);
    uint32_t material = 0;
    for (size_t f = 0; f < mesh->face_count; f++) {
        const uint32_t next = mesh->materials ? mesh->materials[f] : 0;
        if (f == 0 || next != material)
            write_material(mesh, next, f == 0, out);
        material = next;
        char line[3 * 36];
        size_t n = 0;
        line[n++] = 'f';
        for (size_t c = 3 * f; c < 3 * f + 3; c++) {
            line[n++] = ' ';
            n += put_index(line + n, mesh->indices[c] + 1);
            if (uv || normal)
                line[n++] = '/';
            if (uv)
                n += put_index(line + n, tuple_at(uv, mesh, c) + 1);
            if (normal) {
                line[n++] = '/';
                n += put_index(line + n, tuple_at(normal, mesh, c) + 1);
            }
        }
        line[n++] = '\n';
        asset_put(out, line, n);
    }
}

bool asset_write_obj(const asset *mesh, asset_bytes *out, asset_error *error)
{
    write_positions(mesh, out);
    write_vectors(find_attribute(mesh, PMESH_TEXCOORD), "vt", 2, out);
    write_vectors(find_attribute(mesh, PMESH_NORMAL), "vn", 3, out);
    write_faces(mesh, out);
    return !out->failed || asset_fail(error, "", "out of memory");
}
