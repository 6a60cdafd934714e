/* SPDX-License-Identifier: MIT */
/*
 * page.h - the viewer's page: a template that `make viewer` bundles, filled
 * with a mesh or with the address of one.
 */
#ifndef PAGE_H
#define PAGE_H

#include "tools/asset.h"
#include "tools/file.h"

/*
 * Reads the template: `named`, or if that is NULL the one that belongs to this
 * program, ../share/pmesh/viewer.html (installed) or ../web/viewer.html (in the
 * build tree) beside it. *path, of PAGE_PATH bytes, gets its name for messages.
 */
enum { PAGE_PATH = 4096 };
bool page_read(const char *named, char *path, file_data *out,
               asset_error *error);

/* The page titled `title`, with the mesh in it, or, if `mesh` is NULL, at the
 * address `url`. False if the template is none, or memory is short. */
bool page_fill(const file_data *page, const char *title, const file_data *mesh,
               const char *url, asset_bytes *out, asset_error *error);

#endif
