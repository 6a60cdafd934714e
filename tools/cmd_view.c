/* SPDX-License-Identifier: MIT */
/*
 * cmd_view.c - a page that shows a .pmesh file in a browser.
 */
#include <inttypes.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "tools/args.h"
#include "tools/cmd.h"
#include "tools/file.h"
#include "tools/page.h"
#include "tools/report.h"
#include "tools/scene_file.h"
#include "tools/serve.h"
#include "tools/stream.h"

#define MESH_PATH "/mesh.pmesh"

typedef struct options {
    const char *output, *page, *title;
    bool serve, quiet;
    uint32_t port, rate;
} options;

static const args_option option_table[] = {
    { .name = "output", .letter = 'o', .kind = ARGS_TEXT, .value = "OUT.html",
      .offset = offsetof(options, output),
      .help = "write one page that holds the mesh; \"-\" is standard\noutput" },
    { .name = "serve", .kind = ARGS_FLAG, .offset = offsetof(options, serve),
      .help = "serve page and mesh on this machine until interrupted" },
    { .name = "port", .kind = ARGS_COUNT, .value = "N", .min = 0, .max = 65535,
      .offset = offsetof(options, port),
      .help = "port of --serve (default: any that is free)" },
    { .name = "rate", .kind = ARGS_COUNT, .value = "N", .min = 1000,
      .max = UINT32_MAX, .offset = offsetof(options, rate),
      .help = "with --serve, send N bits per second: 500k, 4M" },
    { .name = "title", .kind = ARGS_TEXT, .value = "TEXT",
      .offset = offsetof(options, title),
      .help = "title of the page (default: the file's name)" },
    { .name = "page", .kind = ARGS_TEXT, .value = "FILE",
      .offset = offsetof(options, page),
      .help = "take FILE for the viewer's page" },
    { .name = "quiet", .letter = 'q', .kind = ARGS_FLAG,
      .offset = offsetof(options, quiet), .help = "no report" },
};

static const args_command command = {
    .name = "view",
    .summary = "Makes a page that shows a .pmesh file in a browser.",
    .synopsis = "FILE -o OUT.html|--serve [options]",
    .options = option_table,
    .option_count = sizeof option_table / sizeof *option_table,
    .details =
        "The page needs nothing else: it holds mesh, decoder and three.js. It "
        "shows the\nmesh at any number of faces or bytes, its error, "
        "wireframe, age of vertices, and\nthe original beside it; and how the "
        "mesh arrives over a slow link. The viewer's\npage is made by 'make "
        "viewer' and installed with the program. Of a scene it shows\nall "
        "meshes with their materials.\n\n"
        "With --serve the mesh is fetched by the page from 127.0.0.1, which no "
        "other\nmachine can reach. Files with a Draco base mesh cannot be "
        "shown.\n\n"
        "  pmesh view bunny.pmesh -o bunny.html\n"
        "  pmesh view bunny.pmesh --serve --rate 500k\n",
};

static const char *title_of(const options *o, const char *path)
{
    const char *slash = strrchr(path, '/');
    if (o->title)
        return o->title;
    return strcmp(path, "-") == 0 ? "mesh" : slash ? slash + 1 : path;
}

static int write_page(const options *o, const char *path,
                      const file_data *page, const file_data *mesh)
{
    asset_bytes out = { 0 };
    asset_error error;
    bool good = file_check_output(o->output, false, mesh, &error) &&
                page_fill(page, title_of(o, path), mesh, NULL, &out, &error) &&
                file_write(o->output, out.data, out.size, &error);
    if (!good) {
        report_asset_error(file_output_name(o->output), &error);
    } else if (!o->quiet) {
        FILE *to = strcmp(o->output, "-") == 0 ? stderr : stdout;
        report_put(to, file_output_name(o->output));
        fprintf(to, ": %zu bytes, %zu of them the mesh\n", out.size,
                mesh->size);
    }
    asset_bytes_free(&out);
    return good ? CMD_DONE : CMD_IO;
}

static void say_address(uint16_t port)
{
    printf("http://127.0.0.1:%u/\n", (unsigned)port);
    fflush(stdout);
}

static int serve_page(const options *o, const char *path,
                      const file_data *page, uint64_t hash,
                      const file_data *mesh)
{
    asset_bytes html = { 0 };
    asset_error error;
    char etag[32];

    snprintf(etag, sizeof etag, "\"%016" PRIx64 "-%zx\"", hash, mesh->size);
    if (page_fill(page, title_of(o, path), NULL, MESH_PATH, &html, &error)) {
        const serve_file files[] = {
            { "/", "text/html; charset=utf-8", html.data, html.size, NULL },
            { MESH_PATH, "application/octet-stream", mesh->bytes, mesh->size,
              etag }
        };
        serve(files, 2, (uint16_t)o->port, o->rate, say_address, &error);
    }
    report_asset_error("view", &error);
    asset_bytes_free(&html);
    return CMD_IO;
}

/* Whether the page can show the file, and the hash that names its content. */
static int look(const file_data *file, uint64_t *hash, asset_error *error)
{
    if (scene_file_is(file)) {
        scene_file s;
        const int code = scene_file_open(file, &s, error);
        *hash = s.has_header ? s.header.content_hash : 0;
        scene_file_close(&s);
        return code;
    }
    stream s;
    int code = stream_open_header(file, &s, error);
    *hash = s.header.content_hash;
    if (code == CMD_DONE && s.header.base_coder == PMESH_BASE_DRACO) {
        asset_fail(error, "", "has a Draco base mesh, which the viewer cannot "
                   "decode");
        code = CMD_BOUND;
    }
    stream_close(&s);
    return code;
}

static int view(const options *o, const char *path, const file_data *mesh)
{
    char page_path[PAGE_PATH];
    asset_error error;
    file_data page;
    uint64_t hash;

    int code = look(mesh, &hash, &error);
    if (code != CMD_DONE) {
        report_asset_error(file_input_name(path), &error);
    } else if (!page_read(o->page, page_path, &page, &error)) {
        report_asset_error(page_path, &error);
        code = CMD_IO;
    } else {
        code = o->serve ? serve_page(o, path, &page, hash, mesh)
                        : write_page(o, path, &page, mesh);
        file_free(&page);
    }
    return code;
}

int cmd_view(int argc, char **argv)
{
    options o = { 0 };
    int count;
    file_data mesh;
    asset_error error;

    const args_result parsed = args_parse(&command, argc, argv, &o, &count);
    if (parsed != ARGS_RUN)
        return parsed == ARGS_HELP ? CMD_DONE : CMD_USAGE;
    if (count != 1 || !o.output == !o.serve) {
        args_complain(&command, "%s",
                      count == 0   ? "no file is named"
                      : count != 1 ? "takes one file"
                                   : "needs either -o OUT.html or --serve");
        return CMD_USAGE;
    }
    const char *path = argv[0];
    if (!file_read(path, FILE_LIMIT, &mesh, &error)) {
        report_asset_error(file_input_name(path), &error);
        return CMD_IO;
    }
    const int code = view(&o, path, &mesh);
    file_free(&mesh);
    return code;
}
