/* SPDX-License-Identifier: MIT */
/*
 * cmd_sheet.c - draws levels of detail side by side.
 */
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "tools/args.h"
#include "tools/budgets.h"
#include "tools/cmd.h"
#include "tools/digits.h"
#include "tools/file.h"
#include "tools/glyphs.h"
#include "tools/guide.h"
#include "tools/heat.h"
#include "tools/load.h"
#include "tools/report.h"
#include "tools/scene_file.h"
#include "tools/sheet.h"
#include "tools/stream.h"

#define DEFAULT_PANELS 6u

typedef struct options {
    const char *output, *faces, *guide, *weights, *camera;
    uint32_t size, columns, ellipsoids;
    int heat;
    double yaw, pitch;
    bool wire, smooth;
} options;

/* One run of the command. */
typedef struct job {
    options opt;
    const char *input;
    file_data data, guide_data;
    asset finest;
    budgets list;
    sheet sheet;
    raster_camera camera;
} job;

static const args_option option_table[] = {
    { .name = "output", .letter = 'o', .kind = ARGS_TEXT, .value = "FILE",
      .offset = offsetof(options, output), .help = "the PNG file (required)" },
    { .name = "faces", .letter = 'n', .kind = ARGS_TEXT, .value = "LIST",
      .offset = offsetof(options, faces),
      .help = "face budgets such as 200,2k,20k (default: six,\n"
              "from the base mesh to full detail)" },
    { .name = "wire", .letter = 'w', .kind = ARGS_FLAG,
      .offset = offsetof(options, wire), .help = "draw the edges, too" },
    { .name = "smooth", .kind = ARGS_FLAG,
      .offset = offsetof(options, smooth),
      .help = "shade across edges that are not sharp" },
    { .name = "heat", .kind = ARGS_CHOICE, .value = "none|cost|error|weights",
      .offset = offsetof(options, heat),
      .help = "colour by what contracting the cheapest edge of a\n"
              "vertex costs; full detail by its distance from the\n"
              "level; or by weights" },
    { .name = "weights", .kind = ARGS_TEXT, .value = "SOURCE",
      .offset = offsetof(options, weights),
      .help = "weights to show, as of pmesh bake" },
    { .name = "guide", .kind = ARGS_TEXT, .value = "FILE",
      .offset = offsetof(options, guide),
      .help = "a guide file: its weights and cameras" },
    { .name = "camera", .kind = ARGS_TEXT, .value = "NAME",
      .offset = offsetof(options, camera),
      .help = "look as this camera of the guide does" },
    { .name = "ellipsoids", .kind = ARGS_COUNT, .value = "N", .min = 1,
      .max = 5000, .offset = offsetof(options, ellipsoids),
      .help = "draw the quadrics of N vertices, too: flat on flat\n"
              "surfaces, thin along edges, round in corners" },
    { .name = "size", .kind = ARGS_COUNT, .value = "PX", .min = 120,
      .max = 1024, .offset = offsetof(options, size),
      .help = "width of a panel (default 360)" },
    { .name = "columns", .kind = ARGS_COUNT, .value = "N", .min = 1,
      .max = BUDGETS_MAX, .offset = offsetof(options, columns),
      .help = "panels in a row (default: two rows, four\n"
              "panels at most)" },
    { .name = "yaw", .kind = ARGS_NUMBER, .value = "DEGREES", .min = -360,
      .max = 360, .offset = offsetof(options, yaw),
      .help = "turn the model (default 30)" },
    { .name = "pitch", .kind = ARGS_NUMBER, .value = "DEGREES", .min = -90,
      .max = 90, .offset = offsetof(options, pitch),
      .help = "look from above (default 18)" },
};

static const args_command command = {
    .name = "sheet",
    .summary = "Draws levels of detail side by side into a PNG file.",
    .synopsis = "FILE -o SHEET.png [options]",
    .options = option_table,
    .option_count = sizeof option_table / sizeof *option_table,
    .details =
        "FILE is a .pmesh file or what has arrived of one; a mesh file gives "
        "one panel.\nAll panels have the same camera, y is up. Below each "
        "stand its faces, the\nbytes from the start of the file that it needs "
        "and its distance from full\ndetail, absolute and as a share of the "
        "bounding box's diagonal.\n\n"
        "  pmesh sheet bunny.pmesh -o bunny.png\n"
        "  pmesh sheet bunny.pmesh -o bunny.png --faces 500,5k --wire\n"
        "  pmesh sheet bunny.pmesh -o error.png --heat error\n",
};

/* ---- panels ------------------------------------------------------------- */

static uint32_t default_columns(uint32_t count)
{
    const uint32_t half = count <= 3 ? count : (count + 1) / 2;
    return half < 4 ? half : 4;
}

static const char *name_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : file_input_name(path);
}

/* The bytes of the first level with at least these faces. */
static uint64_t bytes_for(const pmesh_header *header, uint32_t faces)
{
    for (uint32_t i = 0; i < header->level_count; i++)
        if (header->levels[i].faces >= faces)
            return header->levels[i].bytes;
    return header->bytes;
}

static double diagonal_of(const pmesh_header *header)
{
    double sum = 0;
    for (size_t k = 0; k < 3; k++)
        sum += (double)header->bounds[k] * header->bounds[k];
    return sqrt(sum) * header->grid.step;
}

static void set_level_caption(const pmesh_header *header,
                              const pmesh_view *view, sheet_caption *out)
{
    const uint64_t bytes = bytes_for(header, view->face_count);
    const double error = (double)view->error;
    char number[32];

    *out = (sheet_caption){ 0 };
    digits_grouped(number, view->face_count);
    snprintf(out->left, sizeof out->left, "%s faces", number);
    digits_bytes(out->right, bytes);
    const double percent = 100 * (double)bytes / (double)header->bytes;
    snprintf(out->right_below, sizeof out->right_below,
             percent < 10 ? "%.2g %% of the file" : "%.0f %% of the file",
             percent);
    if (view->face_count == header->faces)
        snprintf(out->left_below, sizeof out->left_below, "full detail");
    else
        snprintf(out->left_below, sizeof out->left_below,
                 "error %.3g (%.2g %%)", error,
                 100 * error / diagonal_of(header));
}

static raster_style style_of(const job *j)
{
    return (raster_style){ .wire = j->opt.wire, .flat = !j->opt.smooth };
}

/* ---- heat --------------------------------------------------------------- */

/* A guide of what the options say; true unless *error says why not. */
static bool guide_for(const job *j, const asset *mesh, guide *g,
                      asset_error *error)
{
    if (!guide_create(g))
        return asset_fail(error, "", "out of memory");
    if (j->opt.weights ? !guide_take_weights(g, mesh, j->opt.weights, error)
                       : !guide_take_own_weights(g, mesh, error))
        return false;
    return !j->opt.guide || guide_read(g, j->guide_data.bytes,
                                       j->guide_data.size, mesh, error);
}

static bool heat_weights(const job *j, const asset *mesh, heat *out,
                         asset_error *error)
{
    guide g;
    bool ok = guide_for(j, mesh, &g, error);
    if (ok && !heat_of_weights(mesh, &g, out))
        ok = asset_fail(error, "", "out of memory");
    guide_free(&g);
    return ok;
}

/* Draws a level as the options say; it may get glyphs. *error is why not. */
static bool draw_mesh_panel(job *j, uint32_t index, asset *mesh,
                            sheet_caption *caption, asset_error *error)
{
    raster_style style = style_of(j);
    asset *shown = j->opt.heat == HEAT_ERROR ? &j->finest : mesh;
    heat h = { 0 };
    bool ok = true;

    if (j->opt.heat == HEAT_WEIGHTS)
        ok = heat_weights(j, mesh, &h, error);
    else if (j->opt.heat == HEAT_COST)
        ok = heat_of_costs(mesh, &h);
    else if (j->opt.heat == HEAT_ERROR)
        ok = heat_of_errors(shown, mesh, &h);
    if (ok && j->opt.ellipsoids > 0 && shown == mesh) {
        style.plain = mesh->face_count;
        ok = glyphs_add(mesh, j->opt.ellipsoids);
    }
    if (ok && h.value) {
        style.heat = h.value;
        memcpy(caption->blue, h.blue, sizeof h.blue);
        memcpy(caption->red, h.red, sizeof h.red);
    }
    ok = ok && sheet_draw(&j->sheet, index, shown, &j->camera, &style, caption);
    heat_free(&h);
    return ok;
}

/* Shows a level and draws it. */
static bool draw_level(job *j, uint32_t index, const stream *s,
                       asset_error *error)
{
    const pmesh_target target = { .faces = j->list.faces[index] };
    sheet_caption caption;
    pmesh_view view;
    asset mesh;

    pmesh_decoder_refine(s->decoder, &target, NULL);
    if (pmesh_decoder_mesh(s->decoder, &view) != PMESH_OK ||
        !asset_from_decoder(s->decoder, &mesh, error))
        return false;
    set_level_caption(&s->header, &view, &caption);
    const bool drawn = draw_mesh_panel(j, index, &mesh, &caption, error);
    asset_free(&mesh);
    return drawn;
}

static bool begin_sheet(job *j, const char *remark)
{
    const uint32_t columns =
        j->opt.columns > 0 ? j->opt.columns : default_columns(j->list.count);
    return sheet_begin(&j->sheet, j->list.count,
                       columns < j->list.count ? columns : j->list.count,
                       j->opt.size, name_of(j->input), remark);
}

/* Takes the angles of the guide's camera. */
static bool find_camera(job *j, const asset *finest, asset_error *error)
{
    guide g;
    bool found = false;

    bool ok = guide_for(j, finest, &g, error);
    for (size_t i = 0; ok && i < g.camera_count && !found; i++) {
        found = strcmp(g.cameras[i].name, j->opt.camera) == 0;
        if (found) {
            j->opt.yaw = g.cameras[i].yaw;
            j->opt.pitch = g.cameras[i].pitch;
        }
    }
    if (ok && !found)
        asset_fail(error, "", "the guide has no camera '%s'", j->opt.camera);
    guide_free(&g);
    return found;
}

/* Fits the camera to the finest mesh. */
static int fit_camera(job *j, const asset *finest, asset_error *error)
{
    if (j->opt.camera && !find_camera(j, finest, error))
        return CMD_ASSET;
    /* A model that turns to its left shows more of its right: yaw > 0. */
    if (raster_camera_fit(&j->camera, finest, -j->opt.yaw / 360,
                          j->opt.pitch / 360))
        return CMD_DONE;
    asset_fail(error, "", "there is no face to draw");
    return CMD_ASSET;
}

static int out_of_memory(asset_error *error)
{
    asset_fail(error, "", "out of memory");
    return CMD_IO;
}

/* ---- the two kinds of sheet --------------------------------------------- */

static void set_remark(const stream *s, uint64_t bytes, char *out, size_t size)
{
    char faces[32], there[32], all[32];

    digits_grouped(faces, s->header.faces);
    digits_bytes(there, bytes);
    digits_bytes(all, s->header.bytes);
    if (s->progress.complete)
        snprintf(out, size, "%s faces, %s", faces, all);
    else
        snprintf(out, size, "%s faces, the first %s of %s", faces, there, all);
}

static int draw_stream(job *j, const stream *s, asset_error *error)
{
    char remark[128];

    if (!s->shown) {
        asset_fail(error, "", "cut off after %zu bytes, before the base mesh",
                   j->data.size);
        return CMD_STREAM;
    }
    if (!asset_from_decoder(s->decoder, &j->finest, error))
        return CMD_IO;
    const int code = fit_camera(j, &j->finest, error);
    if (code != CMD_DONE)
        return code;
    if (j->list.count == 0)
        budgets_spread(s->header.base_faces, s->progress.faces, DEFAULT_PANELS,
                       &j->list);
    set_remark(s, j->data.size, remark, sizeof remark);
    out_of_memory(error); /* unless something else is said */
    bool ok = begin_sheet(j, remark);
    for (uint32_t i = 0; ok && i < j->list.count; i++)
        ok = draw_level(j, i, s, error);
    return ok ? CMD_DONE : j->opt.heat == HEAT_WEIGHTS ? CMD_ASSET : CMD_IO;
}

static int draw_mesh(job *j, asset *mesh, asset_error *error)
{
    sheet_caption caption = { { 0 }, { 0 }, { 0 }, { 0 }, { 0 }, { 0 } };
    char number[32];

    const int code = fit_camera(j, mesh, error);
    if (code != CMD_DONE)
        return code;
    digits_grouped(number, mesh->face_count);
    snprintf(caption.left, sizeof caption.left, "%s faces", number);
    digits_grouped(number, mesh->vertex_count);
    snprintf(caption.left_below, sizeof caption.left_below, "%s vertices",
             number);
    digits_bytes(caption.right, j->data.size);
    j->list.count = 1;
    out_of_memory(error);
    if (!begin_sheet(j, "") || !draw_mesh_panel(j, 0, mesh, &caption, error))
        return j->opt.heat == HEAT_WEIGHTS ? CMD_ASSET : CMD_IO;
    return CMD_DONE;
}

/* ---- command ------------------------------------------------------------ */

static int draw(job *j, asset_error *error)
{
    if (load_is_stream(&j->data, j->input) && !scene_file_is(&j->data)) {
        stream s;
        int code = stream_open(&j->data, &s, error);
        if (code == CMD_DONE)
            code = draw_stream(j, &s, error);
        stream_close(&s);
        return code;
    }
    if (j->list.count > 0) {
        asset_fail(error, "", "--faces is for .pmesh files of one mesh only");
        return CMD_USAGE;
    }
    if (j->opt.heat == HEAT_ERROR) {
        asset_fail(error, "", "--heat error is for .pmesh files of one mesh "
                              "only");
        return CMD_USAGE;
    }
    asset mesh;
    int code = load_mesh_data(&j->data, j->input, &mesh, error);
    if (code != CMD_DONE)
        return code;
    report_notes notes = { .size = 0 };
    report_note_lines(&notes, mesh.warnings);
    report_notes_print(&notes, file_input_name(j->input));
    code = draw_mesh(j, &mesh, error);
    asset_free(&mesh);
    return code;
}

static int run(job *j)
{
    asset_error error;
    asset_bytes png = { 0 };
    const char *input = file_input_name(j->input);
    const char *output = file_output_name(j->opt.output);

    if (!file_read(j->input, FILE_LIMIT, &j->data, &error)) {
        report_asset_error(input, &error);
        return CMD_IO;
    }
    if (j->opt.guide &&
        !file_read(j->opt.guide, FILE_LIMIT, &j->guide_data, &error)) {
        report_asset_error(file_input_name(j->opt.guide), &error);
        return CMD_IO;
    }
    if (!file_check_output(j->opt.output, true, &j->data, &error)) {
        report_asset_error(output, &error);
        return CMD_IO;
    }
    scene_file_unwrap(&j->data);
    const int code = draw(j, &error);
    if (code != CMD_DONE) {
        report_asset_error(input, &error);
        return code;
    }
    bool ok = picture_to_png(&j->sheet.picture, &png);
    if (!ok)
        out_of_memory(&error);
    ok = ok && file_write(j->opt.output, png.data, png.size, &error);
    if (!ok)
        report_asset_error(output, &error);
    asset_bytes_free(&png);
    return ok ? CMD_DONE : CMD_IO;
}

int cmd_sheet(int argc, char **argv)
{
    job j = { .opt = { .size = 360, .yaw = 30, .pitch = 18 } };
    int operands;

    const args_result result =
        args_parse(&command, argc, argv, &j.opt, &operands);
    if (result == ARGS_HELP)
        return CMD_DONE;
    if (result == ARGS_BAD)
        return CMD_USAGE;
    if (operands != 1 || !j.opt.output) {
        args_complain(&command, "one FILE and -o SHEET.png are needed");
        return CMD_USAGE;
    }
    if (j.opt.faces && !budgets_parse(j.opt.faces, &j.list)) {
        args_complain(&command, "--faces: '%s' is no list of face counts",
                      j.opt.faces);
        return CMD_USAGE;
    }
    if (j.opt.camera && !j.opt.guide) {
        args_complain(&command, "--camera is one of --guide");
        return CMD_USAGE;
    }
    j.input = argv[0];
    const int code = run(&j);
    file_free(&j.data);
    file_free(&j.guide_data);
    asset_free(&j.finest);
    sheet_free(&j.sheet);
    return code;
}
