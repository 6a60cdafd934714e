/* SPDX-License-Identifier: MIT */
#include "tools/extract_library.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/file.h"

enum { ENDING_ROOM = 40 }; /* "-", a number, ".", a short ending */

static const char *file_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

bool extract_library_open(const char *obj, extract_library *out,
                          asset_error *error)
{
    const size_t size = strlen(obj);

    *out = (extract_library){ .stem = malloc(size + 1),
                              .path = malloc(size + ENDING_ROOM) };
    if (!out->stem || !out->path)
        return asset_fail(error, "", "out of memory");
    memcpy(out->stem, obj, size + 1);
    char *dot = strrchr(file_name(out->stem), '.');
    if (dot && asset_format_of(obj) == ASSET_OBJ)
        *dot = '\0';
    out->content.stem = file_name(out->stem);
    for (const char *c = out->content.stem; *c; c++)
        if ((unsigned char)*c < 0x20 || *c == 0x7F)
            return asset_fail(error, "", "an OBJ cannot name a file whose name "
                              "has control characters");
    return true;
}

void extract_library_put_name(const extract_library *library,
                              asset_bytes *obj)
{
    asset_printf(obj, "mtllib %s.mtl\n", library->content.stem);
}

bool extract_library_write(extract_library *library, asset_error *error)
{
    const scene_library *content = &library->content;
    const size_t room = strlen(library->stem) + ENDING_ROOM;

    for (size_t i = 0; i < content->image_count; i++) {
        const scene_image *image = &content->images[i];
        snprintf(library->path, room, "%s-%zu.%s", library->stem,
                 image->number, image->ending);
        if (!file_write(library->path, image->data, image->size, error))
            return false;
    }
    snprintf(library->path, room, "%s.mtl", library->stem);
    return file_write(library->path, content->mtl.data, content->mtl.size,
                      error);
}

void extract_library_close(extract_library *library)
{
    scene_library_free(&library->content);
    free(library->stem);
    free(library->path);
    *library = (extract_library){ 0 };
}
