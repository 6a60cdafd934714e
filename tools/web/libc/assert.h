/* SPDX-License-Identifier: MIT */
/* assert.h - for WebAssembly without a C library: release builds only. */
#ifndef PMESH_WEB_ASSERT_H
#define PMESH_WEB_ASSERT_H

#include <stddef.h> /* a header is not to be empty */

#define assert(condition) ((void)0)

#endif
