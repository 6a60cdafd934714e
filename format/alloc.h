/* SPDX-License-Identifier: MIT */
/*
 * alloc.h - the one gate for memory: (count, size) with overflow check.
 */
#ifndef PMESH_ALLOC_H
#define PMESH_ALLOC_H

#include "format/pmesh.h"

/* Fills in malloc and free where both hooks are NULL. */
pmesh_allocator pmesh_allocator_resolve(pmesh_allocator allocator);

/* `count` items of `size` bytes, uninitialised; NULL if the product overflows
 * or memory is short. A count of 0 gives a valid, unique pointer. Release with
 * the same count and size. */
void *pmesh_alloc(const pmesh_allocator *a, size_t count, size_t size);
/* The same, zero-filled. */
void *pmesh_alloc_zero(const pmesh_allocator *a, size_t count, size_t size);
void pmesh_release(const pmesh_allocator *a, void *ptr, size_t count,
                   size_t size);

#endif
