/* SPDX-License-Identifier: MIT */
#include "format/alloc.h"

#include <stdlib.h>
#include <string.h>

static void *default_alloc(void *user, size_t size)
{
    (void)user;
    return malloc(size);
}

static void default_release(void *user, void *ptr, size_t size)
{
    (void)user;
    (void)size;
    free(ptr);
}

pmesh_allocator pmesh_allocator_resolve(pmesh_allocator allocator)
{
    if (!allocator.alloc && !allocator.release) {
        allocator.alloc = default_alloc;
        allocator.release = default_release;
    }
    return allocator;
}

/* Zero-sized requests become one byte, so that NULL always means failure. */
static size_t block_size(size_t count, size_t size)
{
    return count && size ? count * size : 1;
}

void *pmesh_alloc(const pmesh_allocator *a, size_t count, size_t size)
{
    if (size && count > SIZE_MAX / size)
        return NULL;
    return a->alloc(a->user, block_size(count, size));
}

void *pmesh_alloc_zero(const pmesh_allocator *a, size_t count, size_t size)
{
    void *ptr = pmesh_alloc(a, count, size);
    if (ptr)
        memset(ptr, 0, block_size(count, size));
    return ptr;
}

void pmesh_release(const pmesh_allocator *a, void *ptr, size_t count,
                   size_t size)
{
    if (ptr)
        a->release(a->user, ptr, block_size(count, size));
}
