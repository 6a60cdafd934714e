/* SPDX-License-Identifier: MIT */
/*
 * gltf_write.c - one mesh as glTF 2.0: a .glb, or a .gltf with a data URI.
 *
 * All primitives, one per material, share the vertices:
 *
 *   BIN   positions | normals, UVs, colours ... | indices of all primitives
 *
 * A mesh far from the origin is written about its centre and moved back by its
 * node, for the numbers in BIN are float32.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/asset.h"
#include "tools/base64.h"
#include "tools/corners.h"
#include "tools/utf8.h"

#define TARGET_VERTICES 34962
#define TARGET_INDICES 34963
#define TYPE_U16 5123
#define TYPE_U32 5125
#define TYPE_F32 5126

typedef struct writer {
    const asset *mesh;
    corners corners;
    double origin[3];
    float low[3], high[3]; /* of the positions as written */
    size_t *faces;         /* per material */
    uint32_t material_count;
    bool wide; /* 32-bit indices */
    asset_bytes bin;
    asset_bytes view_json, accessor_json;
    size_t views; /* written so far, one accessor each */
} writer;

/* ---- BIN ---------------------------------------------------------------- */

static void put_u32(asset_bytes *out, uint32_t value)
{
    const uint8_t bytes[4] = { (uint8_t)value, (uint8_t)(value >> 8),
                               (uint8_t)(value >> 16),
                               (uint8_t)(value >> 24) };
    asset_put(out, bytes, sizeof bytes);
}

static void put_f32(asset_bytes *out, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_u32(out, bits);
}

static void put_index(writer *w, uint32_t value)
{
    const uint8_t bytes[2] = { (uint8_t)value, (uint8_t)(value >> 8) };
    if (w->wide)
        put_u32(&w->bin, value);
    else
        asset_put(&w->bin, bytes, sizeof bytes);
}

static void pad(asset_bytes *out, char fill)
{
    while (out->size % 4 != 0 && !out->failed)
        asset_put(out, &fill, 1);
}

static void put_number(asset_bytes *out, double value)
{
    char text[40];
    asset_put(out, text, asset_number_print(text, value));
}

static void put_floats(asset_bytes *out, const char *name, const float *v)
{
    asset_printf(out, ",\"%s\":[", name);
    for (int i = 0; i < 3; i++) {
        if (i > 0)
            asset_printf(out, ",");
        put_number(out, (double)v[i]);
    }
    asset_printf(out, "]");
}

/* Closes the view that began at `start` and gives it an accessor. */
static void end_view(writer *w, size_t start, int target, int type,
                     const char *shape, size_t count)
{
    if (w->views > 0) {
        asset_printf(&w->view_json, ",");
        asset_printf(&w->accessor_json, ",");
    }
    asset_printf(&w->view_json,
                 "{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu,"
                 "\"target\":%d}",
                 start, w->bin.size - start, target);
    asset_printf(&w->accessor_json,
                 "{\"bufferView\":%zu,\"componentType\":%d,\"count\":%zu,"
                 "\"type\":\"%s\"",
                 w->views, type, count, shape);
    if (w->views == 0) {
        put_floats(&w->accessor_json, "min", w->low);
        put_floats(&w->accessor_json, "max", w->high);
    }
    asset_printf(&w->accessor_json, "}");
    w->views++;
    pad(&w->bin, 0);
}

/* About which point to write, and whether everything fits into a float. */
static bool choose_origin(writer *w, asset_error *error)
{
    const asset *m = w->mesh;
    double low[3], high[3], extent = 0.0, reach = 0.0;

    for (size_t i = 0; i < m->face_count * 3; i++) {
        const double *p = m->positions + 3 * (size_t)m->indices[i];
        for (int k = 0; k < 3; k++) {
            if (!(fabs(p[k]) <= 1e37))
                return asset_fail(error, "",
                                  "a position is too large for glTF");
            if (i == 0 || p[k] < low[k])
                low[k] = p[k];
            if (i == 0 || p[k] > high[k])
                high[k] = p[k];
        }
    }
    for (int k = 0; k < 3; k++) {
        extent = fmax(extent, high[k] - low[k]);
        reach = fmax(reach, fmax(fabs(low[k]), fabs(high[k])));
    }
    if (reach > 8.0 * extent && !m->floats) {
        for (int k = 0; k < 3; k++)
            w->origin[k] = low[k] + (high[k] - low[k]) / 2.0;
    }
    return true;
}

static void write_positions(writer *w)
{
    const asset *m = w->mesh;

    for (size_t i = 0; i < w->corners.count; i++) {
        const double *p =
            m->positions + 3 * (size_t)m->indices[w->corners.first[i]];
        for (int k = 0; k < 3; k++) {
            const float v = (float)(p[k] - w->origin[k]);
            if (i == 0 || v < w->low[k])
                w->low[k] = v;
            if (i == 0 || v > w->high[k])
                w->high[k] = v;
            put_f32(&w->bin, v);
        }
    }
    end_view(w, 0, TARGET_VERTICES, TYPE_F32, "VEC3", w->corners.count);
}

/* What viewers may rely on: unit normals, colours from 0 to 1, all finite. */
static void tidy(const asset_attribute *a, const float *in, float *out)
{
    double length = 0.0;

    for (unsigned k = 0; k < a->components; k++) {
        out[k] = isfinite(in[k]) ? in[k] : 0.0f;
        if (a->kind == PMESH_COLOR)
            out[k] = out[k] < 0.0f ? 0.0f : out[k] > 1.0f ? 1.0f : out[k];
        length += (double)out[k] * (double)out[k];
    }
    if (a->kind != PMESH_NORMAL)
        return;
    length = sqrt(length);
    for (unsigned k = 0; k < 3; k++)
        out[k] = length > 0.0 ? (float)((double)out[k] / length)
                              : (k == 2 ? 1.0f : 0.0f);
}

static bool is_written(const asset_attribute *a)
{
    if (a->kind == PMESH_NORMAL)
        return a->components == 3;
    if (a->kind == PMESH_TEXCOORD)
        return a->components == 2;
    return a->kind == PMESH_COLOR && a->components >= 3 && a->components <= 4;
}

static void write_attributes(writer *w)
{
    static const char *const shapes[] = { "SCALAR", "VEC2", "VEC3", "VEC4" };

    for (size_t i = 0; i < w->mesh->attribute_count; i++) {
        const asset_attribute *a = &w->mesh->attributes[i];
        const size_t start = w->bin.size;
        if (!is_written(a))
            continue;
        for (size_t k = 0; k < w->corners.count; k++) {
            float v[PMESH_MAX_COMPONENTS];
            tidy(a, corners_values(w->mesh, a, w->corners.first[k]), v);
            for (unsigned c = 0; c < a->components; c++)
                put_f32(&w->bin, v[c]);
        }
        end_view(w, start, TARGET_VERTICES, TYPE_F32,
                 shapes[a->components - 1], w->corners.count);
    }
}

static uint32_t face_material(const asset *mesh, size_t face)
{
    return mesh->materials ? mesh->materials[face] : 0;
}

/* The faces of all materials in one go: a stable counting sort. */
static bool write_indices(writer *w)
{
    const asset *m = w->mesh;
    size_t *order = malloc((m->face_count + 1) * sizeof *order);
    size_t *next = calloc((size_t)w->material_count + 1, sizeof *next);

    if (!order || !next) {
        free(order);
        free(next);
        return false;
    }
    for (uint32_t i = 0; i + 1 < w->material_count; i++)
        next[i + 1] = next[i] + w->faces[i];
    for (size_t f = 0; f < m->face_count; f++)
        order[next[face_material(m, f)]++] = f;
    size_t done = 0;
    for (uint32_t i = 0; i < w->material_count; i++) {
        const size_t start = w->bin.size;
        if (w->faces[i] == 0)
            continue;
        for (const size_t end = done + w->faces[i]; done < end; done++) {
            for (size_t k = 0; k < 3; k++)
                put_index(w, w->corners.points[3 * order[done] + k]);
        }
        end_view(w, start, TARGET_INDICES, w->wide ? TYPE_U32 : TYPE_U16,
                 "SCALAR", w->faces[i] * 3);
    }
    free(order);
    free(next);
    return true;
}

/* ---- JSON --------------------------------------------------------------- */

static void put_string(asset_bytes *out, const char *text)
{
    uint32_t code;
    size_t n;

    asset_printf(out, "\"");
    for (; (n = utf8_next(text, &code)) > 0; text += n) {
        if (code == '"' || code == '\\')
            asset_printf(out, "\\%c", *text);
        else if (code < 0x20 || code == 0x7F)
            asset_printf(out, "\\u%04x", (unsigned)code);
        else if (code == UTF8_INVALID)
            asset_printf(out, "?");
        else
            asset_put(out, text, n);
    }
    asset_printf(out, "\"");
}

/* Sets are renumbered without gaps, as the validator wants them. */
static void put_semantics(asset_bytes *out, const asset *mesh)
{
    unsigned sets[3] = { 0 };
    size_t accessor = 1;

    asset_printf(out, "{\"POSITION\":0");
    for (size_t i = 0; i < mesh->attribute_count; i++) {
        const asset_attribute *a = &mesh->attributes[i];
        if (!is_written(a))
            continue;
        if (a->kind == PMESH_NORMAL)
            asset_printf(out, ",\"%s\":%zu", sets[0]++ == 0 ? "NORMAL"
                                                            : "_NORMAL",
                         accessor);
        else
            asset_printf(out, ",\"%s_%u\":%zu",
                         a->kind == PMESH_COLOR ? "COLOR" : "TEXCOORD",
                         sets[a->kind]++, accessor);
        accessor++;
    }
    asset_printf(out, "}");
}

static void put_mesh(writer *w, asset_bytes *out)
{
    size_t accessor = 1;
    bool first = true;

    for (size_t i = 0; i < w->mesh->attribute_count; i++)
        accessor += is_written(&w->mesh->attributes[i]);
    asset_printf(out, "\"meshes\":[{\"primitives\":[");
    for (uint32_t i = 0; i < w->material_count; i++) {
        if (w->faces[i] == 0)
            continue;
        asset_printf(out, "%s{\"attributes\":", first ? "" : ",");
        put_semantics(out, w->mesh);
        asset_printf(out, ",\"indices\":%zu", accessor++);
        if (w->mesh->material_names)
            asset_printf(out, ",\"material\":%u", (unsigned)i);
        asset_printf(out, "}");
        first = false;
    }
    asset_printf(out, "]}]");
    if (!w->mesh->material_names)
        return;
    asset_printf(out, ",\"materials\":[");
    for (uint32_t i = 0; i < w->material_count; i++) {
        const char *name = w->mesh->material_names[i];
        asset_printf(out, "%s{\"name\":", i == 0 ? "" : ",");
        put_string(out, name ? name : "");
        asset_printf(out, "}");
    }
    asset_printf(out, "]");
}

static void put_node(const writer *w, asset_bytes *out)
{
    asset_printf(out, "\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
                      "\"nodes\":[{\"mesh\":0");
    if (w->origin[0] != 0.0 || w->origin[1] != 0.0 || w->origin[2] != 0.0) {
        asset_printf(out, ",\"translation\":[");
        for (int k = 0; k < 3; k++) {
            if (k > 0)
                asset_printf(out, ",");
            put_number(out, w->origin[k]);
        }
        asset_printf(out, "]");
    }
    asset_printf(out, "}],");
}

/* The document around the accessors and views written so far. */
static void finish_json(writer *w, asset_bytes *out, bool glb)
{
    asset_printf(out, "{\"asset\":{\"version\":\"2.0\",\"generator\":"
                      "\"pmesh %s\"},", pmesh_version());
    put_node(w, out);
    put_mesh(w, out);
    asset_printf(out, ",\"accessors\":[");
    asset_put(out, w->accessor_json.data, w->accessor_json.size);
    asset_printf(out, "],\"bufferViews\":[");
    asset_put(out, w->view_json.data, w->view_json.size);
    asset_printf(out, "],\"buffers\":[{\"byteLength\":%zu", w->bin.size);
    if (!glb) {
        asset_printf(out, ",\"uri\":\"data:application/octet-stream;base64,");
        base64_put(out, w->bin.data, w->bin.size);
        asset_printf(out, "\"");
    }
    asset_printf(out, "}]}");
}

static bool finish(writer *w, bool glb, asset_bytes *out, asset_error *error)
{
    asset_bytes json = { 0 };

    finish_json(w, &json, glb);
    if (glb)
        pad(&json, ' ');
    else
        asset_put(&json, "\n", 1);
    bool ok = !json.failed && !w->bin.failed && !w->view_json.failed &&
              !w->accessor_json.failed;
    const uint64_t total =
        (uint64_t)json.size + (uint64_t)w->bin.size + 12 + 8 + 8;
    if (!ok) {
        asset_fail(error, "", "out of memory");
    } else if (glb && total > UINT32_MAX) {
        ok = asset_fail(error, "", "more than 4 GiB do not fit into a GLB");
    } else {
        if (glb) {
            put_u32(out, 0x46546C67u);
            put_u32(out, 2);
            put_u32(out, (uint32_t)total);
            put_u32(out, (uint32_t)json.size);
            put_u32(out, 0x4E4F534Au);
        }
        asset_put(out, json.data, json.size);
        if (glb) {
            put_u32(out, (uint32_t)w->bin.size);
            put_u32(out, 0x004E4942u);
            asset_put(out, w->bin.data, w->bin.size);
        }
        ok = !out->failed || asset_fail(error, "", "out of memory");
    }
    asset_bytes_free(&json);
    return ok;
}

static bool prepare(writer *w, asset_error *error)
{
    const asset *m = w->mesh;

    if (m->face_count == 0)
        return asset_fail(error, "", "there are no triangles to write");
    if (!choose_origin(w, error))
        return false;
    w->material_count = m->material_count > 0 ? m->material_count : 1;
    w->faces = calloc(w->material_count, sizeof *w->faces);
    if (!w->faces || !corners_unify(m, &w->corners))
        return asset_fail(error, "", "out of memory");
    for (size_t f = 0; f < m->face_count; f++)
        w->faces[face_material(m, f)]++;
    w->wide = w->corners.count > 0xFFFF; /* 65535 itself is a restart */
    return true;
}

bool asset_write_gltf(const asset *mesh, bool glb, asset_bytes *out,
                      asset_error *error)
{
    writer w = { .mesh = mesh };

    bool ok = prepare(&w, error);
    if (ok) {
        write_positions(&w);
        write_attributes(&w);
        ok = write_indices(&w) ? finish(&w, glb, out, error)
                               : asset_fail(error, "", "out of memory");
    }
    corners_free(&w.corners);
    free(w.faces);
    asset_bytes_free(&w.bin);
    asset_bytes_free(&w.view_json);
    asset_bytes_free(&w.accessor_json);
    return ok;
}
