/* SPDX-License-Identifier: MIT */
#include "tools/page.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "tools/base64.h"

#define PAGE_LIMIT ((uint64_t)64 << 20)

static const char title_mark[] = "<!--pmesh:title-->";
static const char data_mark[] = "<!--pmesh:data-->";

/* Folder of this program, with the final slash; "" if it is not known. */
static void own_folder(char folder[PAGE_PATH])
{
    const ssize_t size = readlink("/proc/self/exe", folder, PAGE_PATH - 1);
    folder[size > 0 ? size : 0] = 0;
    char *slash = strrchr(folder, '/');
    folder[slash ? slash + 1 - folder : 0] = 0;
}

bool page_read(const char *named, char *path, file_data *out,
               asset_error *error)
{
    static const char *const places[] = { "../share/pmesh/viewer.html",
                                          "../web/viewer.html" };
    char folder[PAGE_PATH];

    if (named) {
        snprintf(path, PAGE_PATH, "%s", named);
        return file_read(path, PAGE_LIMIT, out, error);
    }
    own_folder(folder);
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        const int size =
            snprintf(path, PAGE_PATH, "%s%s", folder, places[i]);
        if (size > 0 && size < PAGE_PATH && access(path, R_OK) == 0)
            return file_read(path, PAGE_LIMIT, out, error);
    }
    snprintf(path, PAGE_PATH, "viewer.html");
    return asset_fail(error, "", "is neither in %s../share/pmesh nor in "
                      "%s../web; 'make viewer' makes it (needs Node and npm), "
                      "--page names another", folder, folder);
}

/* The first place of `mark` in [p, end), or NULL. */
static const char *find(const char *p, const char *end, const char *mark)
{
    const size_t size = strlen(mark);
    for (; (size_t)(end - p) >= size; p++)
        if (memcmp(p, mark, size) == 0)
            return p;
    return NULL;
}

static void put_escaped(asset_bytes *out, const char *text)
{
    for (; *text; text++)
        switch (*text) {
        case '&': asset_printf(out, "&amp;"); break;
        case '<': asset_printf(out, "&lt;"); break;
        case '>': asset_printf(out, "&gt;"); break;
        case '"': asset_printf(out, "&quot;"); break;
        default: asset_put(out, text, 1);
        }
}

bool page_fill(const file_data *page, const char *title, const file_data *mesh,
               const char *url, asset_bytes *out, asset_error *error)
{
    const char *p = (const char *)page->bytes, *end = p + page->size;
    const char *name = find(p, end, title_mark);
    const char *data = name ? find(name, end, data_mark) : NULL;

    if (!data)
        return asset_fail(error, "", "is no page of the viewer");
    asset_put(out, p, (size_t)(name - p));
    put_escaped(out, title);
    p = name + sizeof title_mark - 1;
    asset_put(out, p, (size_t)(data - p));
    asset_printf(out, "<script type=\"application/octet-stream\" id=\"mesh\"");
    if (!mesh) {
        asset_printf(out, " data-url=\"");
        put_escaped(out, url);
        asset_printf(out, "\"");
    }
    asset_printf(out, ">");
    if (mesh)
        base64_put(out, mesh->bytes, mesh->size);
    asset_printf(out, "</script>");
    p = data + sizeof data_mark - 1;
    asset_put(out, p, (size_t)(end - p));
    return !out->failed || asset_fail(error, "", "out of memory");
}
