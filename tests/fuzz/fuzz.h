/* SPDX-License-Identifier: MIT */
/*
 * fuzz.h - what the fuzz targets share.
 *
 * A target is a file target_NAME.c with libFuzzer's entry. `make fuzz T=NAME`
 * runs it under libFuzzer, with what the sanitizers watch; `make fuzz-replay`
 * gives every target the files of corpus/NAME by driver.c, with any compiler.
 *
 * Streams ignore bytes behind their end: so the last bytes of an input both
 * belong to it and steer the target (sizes of pieces, budgets, which allocation
 * fails), and every .pmesh file is an input.
 */
#ifndef FUZZ_H
#define FUZZ_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "decoder/pmesh_decode.h"

/* The target: gets any bytes, returns 0, and aborts if something is wrong. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define FUZZ_CHECK(condition)                                                 \
    do {                                                                      \
        if (!(condition))                                                     \
            fuzz_fail(__FILE__, __LINE__, #condition);                        \
    } while (0)

_Noreturn void fuzz_fail(const char *file, int line, const char *condition);

/* Random numbers that the last bytes of the input (8, or all) decide. */
typedef struct fuzz_dice {
    uint64_t state;
} fuzz_dice;
fuzz_dice fuzz_dice_of(const uint8_t *data, size_t size);
uint32_t fuzz_draw(fuzz_dice *dice, uint32_t below); /* below > 0 */

/* A block of exactly that size, so that a sanitizer sees its end; to free. */
void *fuzz_room(size_t size);
void *fuzz_copy(const void *data, size_t size);

#define FUZZ_MEMORY ((uint64_t)32 << 20) /* for decoders, unless said */

/* A decoder with those limits; Draco base meshes are made up from their bytes,
 * any nonsense among them. */
pmesh_decoder_config fuzz_config(void);
pmesh_decoder *fuzz_decode(const uint8_t *data, size_t size,
                           pmesh_status *status);

/* What holds of every decoder, whatever it was fed: the visible mesh is sound,
 * and counts, header and progress agree. */
void fuzz_sound(const pmesh_decoder *dec);

/* Calls all that there is to call, on memory of exactly the documented size:
 * moves between budgets, checks that each is kept, that bound buffers show what
 * copies do, and that the way to a level does not matter. */
void fuzz_use(pmesh_decoder *dec, fuzz_dice *dice);

/* Everything that two decoders show at full detail is equal. */
bool fuzz_same(pmesh_decoder *a, pmesh_decoder *b);

#endif
