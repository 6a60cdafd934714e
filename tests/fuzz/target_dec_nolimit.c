/* SPDX-License-Identifier: MIT */
/* Without limits of the caller. Blocks are mapped, not filled, and end where
 * nothing is mapped: claims of gigabytes cost nothing until they are used, and
 * what is used is bounded by the bytes that came. */
#define _DEFAULT_SOURCE
#include <stdint.h>
#include <sys/mman.h>
#include <unistd.h>

#include "tests/fuzz/fuzz.h"

static size_t pages(size_t size)
{
    const size_t page = (size_t)sysconf(_SC_PAGESIZE);
    return (size + page - 1) / page * page;
}

/* The block's end is the end of the pages, as far as alignment lets it. */
static void *map(void *user, size_t size)
{
    const size_t room = pages(size), page = pages(1);
    (void)user;
    uint8_t *at = mmap(NULL, room + page, PROT_NONE,
                       MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (at == MAP_FAILED)
        return NULL;
    FUZZ_CHECK(mprotect(at, room, PROT_READ | PROT_WRITE) == 0);
    return at + (room - size) / 16 * 16;
}

static void unmap(void *user, void *block, size_t size)
{
    const size_t room = pages(size);
    (void)user;
    munmap((uint8_t *)block - (room - size) / 16 * 16, room + pages(1));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    pmesh_decoder_config config = fuzz_config();
    pmesh_decoder *dec;

    config.max_memory = 0;
    config.allocator = (pmesh_allocator){ map, unmap, NULL };
    FUZZ_CHECK(pmesh_decoder_create(&dec, &config) == PMESH_OK);
    pmesh_decoder_feed(dec, data, size);
    pmesh_decoder_refine(dec, NULL, NULL);
    fuzz_sound(dec);
    pmesh_decoder_destroy(dec);
    return 0;
}
