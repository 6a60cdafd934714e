/* SPDX-License-Identifier: MIT */
/*
 * corrupt DIR - writes a file for each rule of SPEC.md that a file can break,
 * and holds the decoder's answer against what is expected of it. Prints a line
 * for each: name, status, offset, rule.
 */
#include "tests/corrupt/corrupt.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "decoder/pmesh_scene.h"
#include "tools/draco_base.h"

static const char *folder;
static unsigned files, failures;

void complain(const char *name, const char *why)
{
    fprintf(stderr, "%s: %s\n", name, why);
    failures++;
}

static void write_file(const char *name, const shape_bytes *file)
{
    char path[1024];
    snprintf(path, sizeof path, "%s/%s.pmesh", folder, name);
    FILE *out = fopen(path, "wb");
    const bool good =
        out && fwrite(file->data, 1, file->size, out) == file->size;
    if (!out || fclose(out) != 0 || !good)
        complain(path, "cannot be written");
}

/* ---- what the decoder says ---------------------------------------------- */

static verdict ask_mesh(const shape_bytes *file, size_t piece)
{
    pmesh_decoder_config config = pmesh_decoder_config_default();
    pmesh_decoder *dec;
    pmesh_status status = PMESH_NEED_DATA;
    config.base_decoder = draco_base_decode;
    if (pmesh_decoder_create(&dec, &config) != PMESH_OK)
        return (verdict){ PMESH_E_MEMORY, 0, "" };
    for (size_t at = 0; at < file->size; at += piece)
        status = pmesh_decoder_feed(dec, file->data + at,
                                    file->size - at < piece ? file->size - at
                                                            : piece);
    const pmesh_decode_error e = pmesh_decoder_error(dec);
    pmesh_decoder_destroy(dec);
    return status < 0 ? (verdict){ e.status, (size_t)e.offset, e.rule }
                      : (verdict){ status, 0, "" };
}

static verdict ask_scene(const shape_bytes *file, size_t piece)
{
    pmesh_scene *scene;
    pmesh_status status = PMESH_NEED_DATA;
    if (pmesh_scene_create(&scene, NULL) != PMESH_OK)
        return (verdict){ PMESH_E_MEMORY, 0, "" };
    for (size_t at = 0; at < file->size; at += piece)
        status = pmesh_scene_feed(scene, file->data + at,
                                  file->size - at < piece ? file->size - at
                                                          : piece);
    const pmesh_decode_error e = pmesh_scene_error(scene);
    pmesh_scene_destroy(scene);
    return status < 0 ? (verdict){ e.status, (size_t)e.offset, e.rule }
                      : (verdict){ status, 0, "" };
}

static bool same(const verdict *a, const verdict *b)
{
    return a->status == b->status && a->offset == b->offset &&
           !strcmp(a->rule, b->rule);
}

void judge(const char *name, shape_bytes file, verdict expected)
{
    const bool scene = file.size > 8 && file.data[8] == 8;
    const verdict at_once = scene ? ask_scene(&file, file.size)
                                  : ask_mesh(&file, file.size);
    const verdict by_byte = scene ? ask_scene(&file, 1) : ask_mesh(&file, 1);
    files++;
    write_file(name, &file);
    printf("%s\t%d\t%zu\t%s\n", name, at_once.status, at_once.offset,
           at_once.rule);
    if (!same(&at_once, &expected)) {
        failures++;
        fprintf(stderr, "%s: expected %d at %zu: %s\n  but got %d at %zu: %s\n",
                name, expected.status, expected.offset, expected.rule,
                at_once.status, at_once.offset, at_once.rule);
    }
    if (!same(&at_once, &by_byte))
        complain(name, "another answer byte by byte");
    free(file.data);
}

/* ---- the files that are broken are good --------------------------------- */

static void check_bases(void)
{
    for (int i = 0; i < BASE_FILES; i++) {
        chunks c = take_base_file((base_file)i);
        shape_bytes again = chunks_put_together(&c);
        const shape_bytes *b = base_bytes((base_file)i);
        const verdict v = i == SCENE ? ask_scene(b, b->size)
                                     : ask_mesh(b, b->size);
        if (v.status != PMESH_OK)
            complain("a base file", "is not good");
        if (i != SCENE && (again.size != b->size ||
                           memcmp(again.data, b->data, b->size)))
            complain("a base file", "is not what its chunks are");
        free(again.data);
    }
}

int main(int argc, char **argv)
{
    if (argc != 2) {
        fprintf(stderr, "usage: corrupt DIR\n");
        return 2;
    }
    folder = argv[1];
    check_bases();
    header_cases();
    stream_cases();
    content_cases();
    scene_cases();
    bases_free();
    fprintf(stderr, "%u files, %u wrong\n", files, failures);
    return failures > 0;
}
