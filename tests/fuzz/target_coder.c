/* SPDX-License-Identifier: MIT */
/*
 * The entropy coder and its models alone. The input is a list of numbers and of
 * models to code them with: what is written is read again. The same list reads
 * the input as if it were a stream: whatever comes out is written again.
 */
#include <stdlib.h>
#include <string.h>

#include "format/residual.h"
#include "tests/fuzz/fuzz.h"

enum { STEPS = 2000, STEP_SIZE = 6, TREE = 6 };

typedef struct step {
    uint8_t kind, choice;
    int64_t value;
} step;

typedef struct models {
    pmesh_bit bit[16], tree[8][1 << TREE];
    pmesh_number number[4];
    pmesh_residual_model residual;
} models;

static size_t read_steps(const uint8_t *data, size_t size, step *out)
{
    const size_t count = size / STEP_SIZE < STEPS ? size / STEP_SIZE : STEPS;
    for (size_t i = 0; i < count; i++) {
        pmesh_cursor in = pmesh_cursor_make(data + STEP_SIZE * i, STEP_SIZE);
        out[i].kind = pmesh_get_u8(&in) % 6;
        out[i].choice = pmesh_get_u8(&in);
        out[i].value = pmesh_get_u32(&in);
    }
    return count;
}

/* What is read may be any number that the model can tell. */
static int64_t walk(pmesh_coder *c, models *m, const step *s, int64_t value)
{
    const unsigned choice = s->choice;
    const unsigned scale = choice % PMESH_SCALES;
    const pmesh_expectation near = {
        &m->residual.any[scale], &m->residual.here[scale][choice % 3][choice % 4],
        m->residual.low[scale], &m->residual.escape, scale,
        ((int64_t)choice - 128) * 1000
    };
    const unsigned width = 1 + choice % 32;
    switch (s->kind) {
    case 0:
        return pmesh_code_bit(c, &m->bit[choice % 16], value & 1);
    case 1:
        return pmesh_code_bit_twice(c, &m->bit[choice % 8],
                                    &m->bit[8 + choice % 8], value & 1);
    case 2:
        return pmesh_code_raw(
            c, width, (uint32_t)((uint64_t)value & ((1ull << width) - 1)));
    case 3:
        return pmesh_code_tree(c, m->tree[choice % 8], TREE,
                               (uint32_t)value & ((1u << TREE) - 1));
    case 4:
        return pmesh_code_number(c, &m->number[choice % 4], (uint32_t)value);
    default:
        return pmesh_code_near(c, &near, value);
    }
}

static models *fresh(void)
{
    models *m = fuzz_room(sizeof *m);
    pmesh_place_models *all = fuzz_room(sizeof *all);
    pmesh_place_models_init(all, PMESH_PREDICT_CHILD, &pmesh_start);
    m->residual = all->residual;
    free(all);
    pmesh_bits_init(m->bit, 16);
    pmesh_bits_init(m->tree[0], sizeof m->tree / sizeof **m->tree);
    for (int i = 0; i < 4; i++)
        pmesh_number_init(&m->number[i]);
    return m;
}

/* Writes the values; they become those that the models make of them. */
static size_t write_all(const step *s, int64_t *value, size_t count,
                        uint8_t *out, size_t room)
{
    pmesh_writer w = { out, 0, room, false };
    pmesh_coder c;
    models *m = fresh();
    pmesh_coder_encode(&c, &w);
    for (size_t i = 0; i < count; i++)
        value[i] = walk(&c, m, &s[i], value[i]);
    FUZZ_CHECK(pmesh_coder_finish(&c) && !w.overflow);
    free(m);
    return w.size;
}

static bool read_all(const step *s, int64_t *value, size_t count,
                     const uint8_t *data, size_t size)
{
    uint8_t *copy = fuzz_copy(data, size);
    pmesh_coder c;
    models *m = fresh();
    pmesh_coder_decode(&c, copy, size);
    for (size_t i = 0; i < count; i++)
        value[i] = walk(&c, m, &s[i], 0);
    const bool good = pmesh_coder_finish(&c);
    free(m);
    free(copy);
    return good;
}

/* Written, then read: the same values, and all bytes used. */
static void there_and_back(const step *s, int64_t *value, size_t count)
{
    const size_t room = 32 * count + 64;
    uint8_t *out = fuzz_room(room);
    int64_t *again = fuzz_room((count + 1) * sizeof *again);
    const size_t size = write_all(s, value, count, out, room);
    FUZZ_CHECK(read_all(s, again, count, out, size));
    FUZZ_CHECK(memcmp(value, again, count * sizeof *value) == 0);
    free(again);
    free(out);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    step *s = fuzz_room(STEPS * sizeof *s);
    int64_t *value = fuzz_room((STEPS + 1) * sizeof *value);
    const size_t count = read_steps(data, size, s);

    for (size_t i = 0; i < count; i++)
        value[i] = s[i].value;
    there_and_back(s, value, count);
    read_all(s, value, count, data, size);
    for (size_t i = 0; i < count; i++) /* beyond what the codec ever writes */
        if (value[i] < -(int64_t)UINT32_MAX || value[i] > UINT32_MAX)
            value[i] = 0;
    there_and_back(s, value, count);
    free(value);
    free(s);
    return 0;
}
