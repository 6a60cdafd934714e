/* SPDX-License-Identifier: MIT */
#include "tools/bake_report.h"

#include <inttypes.h>
#include <math.h>

#include "tools/file.h"
#include "tools/json.h"
#include "tools/levels.h"

/* By pmesh_simplify_end. */
static const char *const ends[] = { "faces", "vertices", "error",
                                    "exhausted" };

static void note_count(report_notes *notes, uint32_t count, const char *what)
{
    if (count > 0)
        report_note(notes, "%" PRIu32 " %s", count, what);
}

void bake_report_note_losses(bake_report *r)
{
    const pmesh_encode_report *e = &r->encode;

    note_count(&r->notes, e->not_finite_faces,
               "faces left out: a position is not finite");
    note_count(&r->notes, e->degenerate_faces,
               "faces left out: two corners at one position");
    note_count(&r->notes, e->duplicate_faces,
               "faces left out: exact copies of others");
    note_count(&r->notes, e->zero_twins,
               "positions differ from another in the sign of a zero only and "
               "were not joined (--weld joins them)");
    note_count(&r->notes, e->not_finite_values,
               "attribute values were not finite and became 0");
}

static double bits_per_vertex(const pmesh_encode_report *e)
{
    return e->vertices > 0 ? 8.0 * (double)e->bytes / e->vertices : 0;
}

/* As in "texcoord_1"; there is one normal at most. */
static void attribute_name(const pmesh_attribute_size *a, char name[32])
{
    if (a->kind == PMESH_NORMAL)
        snprintf(name, 32, "%s", levels_kind_name(a->kind));
    else
        snprintf(name, 32, "%s_%u", levels_kind_name(a->kind), a->set);
}

static void print_attributes(const pmesh_encode_report *e, FILE *out)
{
    for (uint32_t i = 0; i < e->attribute_count; i++) {
        char name[32];
        attribute_name(&e->attributes[i], name);
        fprintf(out, "%s%s %" PRIu64, i > 0 ? ", " : "  values of ", name,
                e->attributes[i].bytes);
    }
    if (e->attribute_count > 0)
        fprintf(out, " bytes\n");
}

static void print_parts(const pmesh_encode_report *e, FILE *out)
{
    fprintf(out,
            "  header %" PRIu64 ", base mesh %" PRIu64 ", connectivity %" PRIu64
            ", positions %" PRIu64 ", attributes %" PRIu64 " bytes\n",
            e->bytes_header, e->bytes_base, e->bytes_connectivity,
            e->bytes_positions, e->bytes_attributes);
    print_attributes(e, out);
    if (e->bytes_lossless > 0)
        fprintf(out,
                "  exact positions %" PRIu64
                " bytes, %.2f bits per vertex\n",
                e->bytes_lossless,
                8.0 * (double)e->bytes_lossless / e->vertices);
    fprintf(out,
            "  input %" PRIu32 " faces, %" PRIu32 " vertices (%" PRIu32
            " welded, %" PRIu32 " unused, %" PRIu32 " added by cuts)\n",
            e->input_faces, e->input_vertices, e->welded_vertices,
            e->unused_vertices, e->cut_vertices);
    levels_print(out, e->levels, e->level_count, e->measured);
}

void bake_report_print(const bake_report *r, FILE *out, bool verbose)
{
    const pmesh_encode_report *e = &r->encode;

    report_put(out, file_output_name(r->output));
    fprintf(out,
            ": %" PRIu32 " faces, %" PRIu32 " vertices in %" PRIu64
            " bytes, %.2f bits per vertex\n",
            e->faces, e->vertices, e->bytes, bits_per_vertex(e));
    if (r->meshes > 0)
        fprintf(out,
                "  a scene of %" PRIu32 " meshes; document %" PRIu64
                ", images and other resources %" PRIu64 " bytes\n",
                r->meshes, r->bytes_document, r->bytes_resources);
    fprintf(out,
            "  %" PRIu32 " levels from a base mesh of %" PRIu32
            " faces, %" PRIu32 " vertices%s\n",
            e->level_count, e->base_faces, e->base_vertices,
            e->base_coder == PMESH_BASE_DRACO ? ", by Draco" : "");
    if (e->joined)
        fprintf(out,
                "  joined: %" PRIu32 " vertices where sheets meet, %" PRIu32
                " pieces that become %" PRIu32 "\n",
                e->joined_vertices, e->components, e->base_components);
    fprintf(out,
            "  %.2f s: reading %.2f, import %.2f, contraction %.2f, "
            "coding %.2f\n",
            r->seconds_total, r->seconds_read, e->seconds_import,
            e->seconds_contract, e->seconds_code);
    if (verbose)
        print_parts(e, out);
}

static void json_seconds(json *j, const char *key, double value)
{
    json_number(j, key, floor(value * 1e6 + 0.5) / 1e6);
}

static void json_counts(json *j, const pmesh_encode_report *e)
{
    json_count(j, "faces", e->faces);
    json_count(j, "vertices", e->vertices);
    json_count(j, "output_vertices", e->wedges);
    json_count(j, "bytes", e->bytes);
    json_number(j, "bits_per_vertex",
                floor(bits_per_vertex(e) * 1e4 + 0.5) / 1e4);
    json_text(j, "base_coder", levels_base_name(e->base_coder));
    json_count(j, "base_faces", e->base_faces);
    json_count(j, "base_vertices", e->base_vertices);
    json_text(j, "end", ends[e->end]);
    json_count(j, "components", e->components);
    json_count(j, "base_components", e->base_components);
    json_bool(j, "joined", e->joined != 0);
    json_count(j, "joined_vertices", e->joined_vertices);
    json_count(j, "position_bits", e->grid.bits);
    json_number(j, "step", e->grid.step);
    json_open_flat(j, "parts", '{');
    json_count(j, "header", e->bytes_header);
    json_count(j, "base", e->bytes_base);
    json_count(j, "connectivity", e->bytes_connectivity);
    json_count(j, "positions", e->bytes_positions);
    json_count(j, "attributes", e->bytes_attributes);
    json_count(j, "lossless", e->bytes_lossless);
    json_close(j);
    json_open_flat(j, "attribute_bytes", '{');
    for (uint32_t i = 0; i < e->attribute_count; i++) {
        char name[32];
        attribute_name(&e->attributes[i], name);
        json_count(j, name, e->attributes[i].bytes);
    }
    json_close(j);
    json_open_flat(j, "dropped", '{');
    json_count(j, "degenerate_faces", e->degenerate_faces);
    json_count(j, "duplicate_faces", e->duplicate_faces);
    json_count(j, "not_finite_faces", e->not_finite_faces);
    json_count(j, "unused_vertices", e->unused_vertices);
    json_close(j);
    json_open_flat(j, "changed", '{');
    json_count(j, "welded_vertices", e->welded_vertices);
    json_count(j, "cut_vertices", e->cut_vertices);
    json_count(j, "zero_twins", e->zero_twins);
    json_count(j, "not_finite_values", e->not_finite_values);
    json_close(j);
}

static void json_warnings(json *j, const report_notes *notes)
{
    char text[1024];
    size_t at = 0;

    json_open(j, "warnings", '[');
    while (report_note_next(notes, &at, text, sizeof text))
        json_text(j, NULL, text);
    json_close(j);
    json_count(j, "warning_count", notes->count);
}

void bake_report_json(const bake_report *r, FILE *out)
{
    const pmesh_encode_report *e = &r->encode;
    json j;

    json_begin(&j, out);
    json_text(&j, "schema", "pmesh-bake-1");
    json_text(&j, "tool", "pmesh");
    json_text(&j, "version", pmesh_version());
    json_count(&j, "format_version", PMESH_FORMAT_VERSION);
    json_text(&j, "input", r->input);
    json_text(&j, "output", r->output);
    json_count(&j, "input_bytes", r->input_bytes);
    json_count(&j, "input_faces", e->input_faces);
    json_count(&j, "input_vertices", e->input_vertices);
    json_text(&j, "profile", levels_profile_name(r->profile));
    json_text(&j, "placement", levels_placement_name(r->placement));
    json_count(&j, "meshes", r->meshes > 0 ? r->meshes : 1);
    json_bool(&j, "scene", r->meshes > 0);
    json_count(&j, "document_bytes", r->bytes_document);
    json_count(&j, "resource_bytes", r->bytes_resources);
    json_counts(&j, e);
    json_open_flat(&j, "timings", '{');
    json_seconds(&j, "read", r->seconds_read);
    json_seconds(&j, "import", e->seconds_import);
    json_seconds(&j, "contract", e->seconds_contract);
    json_seconds(&j, "code", e->seconds_code);
    json_seconds(&j, "write", r->seconds_write);
    json_seconds(&j, "total", r->seconds_total);
    json_close(&j);
    levels_json(&j, e->levels, e->level_count, e->measured);
    json_warnings(&j, &r->notes);
    json_end(&j);
}
