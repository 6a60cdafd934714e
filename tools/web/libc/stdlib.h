/* SPDX-License-Identifier: MIT */
/* stdlib.h - for WebAssembly without a C library; see pmesh_wasm.c. */
#ifndef PMESH_WEB_STDLIB_H
#define PMESH_WEB_STDLIB_H

#include <stddef.h>

void *malloc(size_t size);
void free(void *ptr);

#endif
