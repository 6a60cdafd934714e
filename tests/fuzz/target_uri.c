/* SPDX-License-Identifier: MIT */
/* URIs of glTF: a path stays below its folder, data comes out as it went in, and
 * a data URI gives as many bytes as it says. */
#include <stdlib.h>
#include <string.h>

#include "tests/fuzz/fuzz.h"
#include "tools/base64.h"
#include "tools/gltf.h"

static void check_path(const char *uri, size_t length)
{
    char *path = fuzz_room(length + 1);
    if (gltf_uri_path(uri, length, path)) {
        const size_t size = strnlen(path, length + 1);
        FUZZ_CHECK(size > 0 && size <= length && path[0] != '/');
        FUZZ_CHECK(!strchr(path, '\\'));
        for (const char *p = path; p; p = strchr(p, '/')) {
            p += *p == '/';
            FUZZ_CHECK(strcspn(p, "/") != 2 || strncmp(p, "..", 2) != 0);
        }
    }
    free(path);
}

/* Without a folder nothing but data URIs can be read. */
static void check_data(const char *uri, size_t length)
{
    const gltf_source source = { .json = "", .path = NULL };
    asset_error error;
    uint64_t size;
    if (!gltf_uri_size(&source, uri, length, &size, &error))
        return;
    FUZZ_CHECK(length >= 5 && memcmp(uri, "data:", 5) == 0 && size < length);
    uint8_t *bytes = fuzz_room((size_t)size);
    FUZZ_CHECK(gltf_uri_read(&source, uri, length, bytes, size, &error));
    FUZZ_CHECK(!gltf_uri_read(&source, uri, length, bytes, size + 1, &error));
    free(bytes);
}

static void check_base64(const uint8_t *data, size_t size)
{
    const gltf_source source = { .json = "", .path = NULL };
    asset_bytes text = { 0 };
    asset_error error;
    uint64_t told;
    uint8_t *back = fuzz_room(size);
    asset_printf(&text, "data:;base64,");
    base64_put(&text, data, size);
    const char *uri = (const char *)text.data;
    FUZZ_CHECK(gltf_uri_size(&source, uri, text.size, &told, &error));
    FUZZ_CHECK(told == size);
    FUZZ_CHECK(gltf_uri_read(&source, uri, text.size, back, size, &error));
    FUZZ_CHECK(size == 0 || memcmp(back, data, size) == 0);
    free(back);
    asset_bytes_free(&text);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    /* As in JSON, a text may hold 0, and a 0 stands behind it. */
    char *uri = fuzz_room(size + 1);
    memcpy(uri, data, size);
    uri[size] = '\0';
    check_path(uri, size);
    check_data(uri, size);
    check_base64(data, size);
    free(uri);
    return 0;
}
