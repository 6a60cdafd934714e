/* SPDX-License-Identifier: MIT */
/*
 * cmd_info.c - what the header of a .pmesh file says.
 */
#include <inttypes.h>
#include <stddef.h>
#include <stdio.h>

#include "tools/args.h"
#include "tools/cmd.h"
#include "tools/file.h"
#include "tools/json.h"
#include "tools/levels.h"
#include "tools/report.h"
#include "tools/scene_file.h"
#include "tools/scene_info.h"
#include "tools/stream.h"

typedef struct options {
    bool json, levels;
} options;

static const args_option option_table[] = {
    { .name = "json", .kind = ARGS_FLAG, .offset = offsetof(options, json),
      .help = "print one JSON object on stdout" },
    { .name = "levels", .kind = ARGS_FLAG, .offset = offsetof(options, levels),
      .help = "print the level table, too" },
};

static const args_command command = {
    .name = "info",
    .summary = "Prints what the header of a .pmesh file says; the file may be "
               "cut off.",
    .synopsis = "FILE [options]",
    .options = option_table,
    .option_count = sizeof option_table / sizeof *option_table,
    .details =
        "\"-\" is standard input. Nothing behind the header is checked: see "
        "pmesh verify.\nThe JSON object always holds the level table, and all "
        "materials and meshes\nwhere the text ends with \"and N more\".\n\n"
        "  pmesh info bunny.pmesh --levels\n"
        "  head -c 10k bunny.pmesh | pmesh info -\n",
};

static void print_attributes(const pmesh_header *h)
{
    printf("attributes   ");
    if (h->attribute_count == 0)
        printf("none");
    for (uint32_t i = 0; i < h->attribute_count; i++) {
        const pmesh_attribute *a = &h->attributes[i];
        printf("%s%s", i > 0 ? ", " : "", levels_kind_name(a->kind));
        if (a->kind != PMESH_NORMAL)
            printf(" %u", a->set);
        printf(" (%u bits)", a->bits);
    }
    putchar('\n');
}

/* Those without a name are counted only, and so are those behind the first. */
static void print_materials(const stream *s)
{
    enum { SHOWN = 32 };
    uint32_t named = 0;

    printf("materials    %" PRIu32, s->header.material_count);
    for (uint32_t i = 0; i < s->header.material_count; i++) {
        const char *name = pmesh_decoder_material_name(s->decoder, i);
        if (!*name || named++ >= SHOWN)
            continue;
        printf(i > 0 ? ", " : ": ");
        report_put(stdout, name);
    }
    if (named > SHOWN)
        printf(" and %" PRIu32 " more", named - SHOWN);
    putchar('\n');
}

static void print_text(const char *path, const stream *s, uint64_t size,
                       bool levels)
{
    const pmesh_header *h = &s->header;

    printf("file         ");
    report_put(stdout, file_input_name(path));
    printf("\nformat       %" PRIu32 ", content %016" PRIx64 "\n",
           h->format_version, h->content_hash);
    printf("bytes        %" PRIu64, h->bytes);
    if (size < h->bytes)
        printf(", cut off after %" PRIu64 ": %" PRIu32 " of %" PRIu32
               " levels", size,
               levels_within(h->levels, h->level_count, size), h->level_count);
    printf("\nfull detail  %" PRIu32 " faces, %" PRIu32 " vertices, %" PRIu32
           " output vertices\n",
           h->faces, h->mesh_vertices, h->vertices);
    printf("base mesh    %" PRIu32 " faces, %" PRIu32 " vertices, %s coder\n",
           h->base_faces, h->base_mesh_vertices,
           levels_base_name(h->base_coder));
    printf("levels       %" PRIu32 ", %s profile, %s placement%s\n",
           h->level_count, levels_profile_name(h->profile),
           levels_placement_name(h->placement), h->joined ? ", joined" : "");
    printf("positions    %u bits, step %.6g\n", h->grid.bits, h->grid.step);
    if (h->exact_bytes > 0)
        printf("lossless     exact floats in the last %" PRIu64
               " bytes, %.2f bits per vertex\n",
               h->exact_bytes, 8.0 * (double)h->exact_bytes / h->mesh_vertices);
    print_attributes(h);
    print_materials(s);
    if (levels) {
        putchar('\n');
        levels_print(stdout, h->levels, h->level_count, h->measured);
    }
}

static void json_grid(json *j, const pmesh_header *h)
{
    json_open_flat(j, "origin", '[');
    for (int i = 0; i < 3; i++)
        json_number(j, NULL, h->grid.origin[i]);
    json_close(j);
    json_number(j, "step", h->grid.step);
    json_open_flat(j, "size", '[');
    for (int i = 0; i < 3; i++)
        json_number(j, NULL, h->grid.step * h->bounds[i]);
    json_close(j);
}

static void json_lists(json *j, const stream *s)
{
    const pmesh_header *h = &s->header;

    json_open(j, "attributes", '[');
    for (uint32_t i = 0; i < h->attribute_count; i++) {
        json_open_flat(j, NULL, '{');
        json_text(j, "kind", levels_kind_name(h->attributes[i].kind));
        json_count(j, "set", h->attributes[i].set);
        json_count(j, "components", h->attributes[i].components);
        json_count(j, "bits", h->attributes[i].bits);
        json_close(j);
    }
    json_close(j);
    json_open(j, "materials", '[');
    for (uint32_t i = 0; i < h->material_count; i++)
        json_text(j, NULL, pmesh_decoder_material_name(s->decoder, i));
    json_close(j);
    levels_json(j, h->levels, h->level_count, h->measured);
}

static void print_json(const char *path, const stream *s, uint64_t size)
{
    const pmesh_header *h = &s->header;
    char hash[20];
    json j;

    snprintf(hash, sizeof hash, "%016" PRIx64, h->content_hash);
    json_begin(&j, stdout);
    json_text(&j, "schema", "pmesh-info-1");
    json_text(&j, "tool", "pmesh");
    json_text(&j, "version", pmesh_version());
    json_text(&j, "input", path);
    json_count(&j, "format_version", h->format_version);
    json_text(&j, "content_hash", hash);
    json_count(&j, "bytes", h->bytes);
    json_count(&j, "bytes_present", size);
    json_bool(&j, "complete", size >= h->bytes);
    json_count(&j, "levels_present",
               levels_within(h->levels, h->level_count, size));
    json_count(&j, "meshes", 1);
    json_count(&j, "faces", h->faces);
    json_count(&j, "vertices", h->mesh_vertices);
    json_count(&j, "output_vertices", h->vertices);
    json_text(&j, "base_coder", levels_base_name(h->base_coder));
    json_count(&j, "base_faces", h->base_faces);
    json_count(&j, "base_vertices", h->base_mesh_vertices);
    json_count(&j, "base_output_vertices", h->base_vertices);
    json_text(&j, "profile", levels_profile_name(h->profile));
    json_text(&j, "placement", levels_placement_name(h->placement));
    json_count(&j, "position_bits", h->grid.bits);
    json_bool(&j, "joined", h->joined != 0);
    json_bool(&j, "measured", h->measured != 0);
    json_bool(&j, "lossless", h->exact_bytes > 0);
    json_count(&j, "lossless_bytes", h->exact_bytes);
    json_grid(&j, h);
    json_count(&j, "decoder_memory", h->memory);
    json_lists(&j, s);
    json_end(&j);
}

int cmd_info(int argc, char **argv)
{
    options o = { 0 };
    int count;
    file_data data;
    asset_error error;
    stream s;

    const args_result parsed = args_parse(&command, argc, argv, &o, &count);
    if (parsed != ARGS_RUN)
        return parsed == ARGS_HELP ? CMD_DONE : CMD_USAGE;
    if (count != 1) {
        args_complain(&command, count == 0 ? "no file is named"
                                           : "takes one file");
        return CMD_USAGE;
    }
    const char *path = argv[0];
    if (!file_read(path, FILE_LIMIT, &data, &error)) {
        report_asset_error(file_input_name(path), &error);
        return CMD_IO;
    }
    scene_file_unwrap(&data);
    if (scene_file_is(&data)) {
        const int done = scene_info(path, &data, o.json, o.levels);
        file_free(&data);
        return done;
    }
    const int code = stream_open_header(&data, &s, &error);
    if (code != CMD_DONE)
        report_asset_error(file_input_name(path), &error);
    else if (o.json)
        print_json(path, &s, data.size);
    else
        print_text(path, &s, data.size, o.levels);
    stream_close(&s);
    file_free(&data);
    return code;
}
