/* SPDX-License-Identifier: MIT */
#include "format/coder.h"

enum { PRIOR_USES = 12 }; /* a probability from a table counts as many bits */

#define R(n)   { 16384 / (2 * (n) + 3), (n) < PMESH_BIT_MOST_USES }
#define R4(n)  R(n), R((n) + 1), R((n) + 2), R((n) + 3)
#define R16(n) R4(n), R4((n) + 4), R4((n) + 8), R4((n) + 12)

/* With the last entry estimates become exponential averages; before, they are
 * plain ones. */
const pmesh_bit_rate pmesh_bit_rates[PMESH_BIT_MOST_USES + 1] = {
    R16(0), R16(16), R16(32), R16(48), R16(64), R16(80), R16(96), R16(112),
};

void pmesh_bits_init(pmesh_bit *bits, size_t count)
{
    for (size_t i = 0; i < count; i++)
        bits[i].state = (uint32_t)1 << 31;
}

void pmesh_bits_start(pmesh_bit *bits, size_t count, const uint8_t *table)
{
    pmesh_bits_init(bits, count);
    for (size_t i = 0; i < count; i++)
        if (table[i])
            bits[i].state = (uint32_t)table[i] << 24 | 1u << 23 | PRIOR_USES;
}

void pmesh_coder_encode(pmesh_coder *c, pmesh_writer *out)
{
    *c = (pmesh_coder){ .encoding = true,
                        .range = UINT64_MAX,
                        .out = out,
                        .start = out->size };
}

/* The next 32 bits of the stream. */
static uint32_t next_word(pmesh_cursor *in)
{
    uint32_t word = 0;
    for (int i = 0; i < 4; i++)
        word = word << 8 | pmesh_get_u8(in);
    return word;
}

void pmesh_coder_decode(pmesh_coder *c, const uint8_t *data, size_t size)
{
    *c = (pmesh_coder){ .range = UINT64_MAX,
                        .in = pmesh_cursor_make(data, size) };
    c->code = (uint64_t)next_word(&c->in) << 32;
    c->code |= next_word(&c->in);
}

/* The most significant byte first. */
static void put_word(pmesh_writer *out, uint32_t word)
{
    for (int shift = 24; shift >= 0; shift -= 8)
        pmesh_put(out, word >> shift & 0xff, 1);
}

void pmesh_coder_shift(pmesh_coder *c)
{
    c->range <<= 32;
    if (c->encoding) {
        put_word(c->out, (uint32_t)(c->low >> 32));
        c->low <<= 32;
    } else {
        c->code = c->code << 32 | next_word(&c->in);
    }
}

/* The digits behind the point never come to 1: there is a byte to stop at, but
 * if some did not fit. */
void pmesh_coder_carry(pmesh_coder *c)
{
    size_t i = c->out->size;
    while (i > c->start && ++c->out->data[--i] == 0)
        ;
}

bool pmesh_coder_finish(pmesh_coder *c)
{
    if (!c->encoding) /* zeros left out: at most the 8 bytes of the flush */
        return c->in.next == c->in.end;

    /* Any value in [low, low + range) will do: one with many zeros. */
    uint64_t value = c->low;
    for (unsigned bits = 63; bits > 0; bits--) {
        const uint64_t mask = ((uint64_t)1 << bits) - 1;
        value = (c->low + mask) & ~mask;
        if (value - c->low < c->range)
            break;
        value = c->low;
    }
    if (value < c->low)
        pmesh_coder_carry(c);
    put_word(c->out, (uint32_t)(value >> 32));
    put_word(c->out, (uint32_t)value);
    while (c->out->size > c->start && c->out->data[c->out->size - 1] == 0)
        c->out->size--;
    return !c->out->overflow;
}

/* The bytes that left the range, and by how much it is narrower than at the
 * start: log2(range) by squaring. */
uint64_t pmesh_coder_spent(const pmesh_coder *c)
{
    uint64_t part = c->range, log = 31;
    for (; part < (UINT64_C(1) << 63); part <<= 1)
        log--;
    part >>= 32;
    for (int i = 0; i < 8; i++) {
        part = part * part >> 31;
        log = 2 * log + (part >> 32);
        part >>= part >> 32;
    }
    return c->out->size * 8 * 256 + 32 * 256 - log;
}

uint32_t pmesh_code_raw(pmesh_coder *c, unsigned count, uint32_t value)
{
    uint32_t result = 0;
    while (count-- > 0) {
        const uint64_t half = c->range >> 1;
        const uint32_t bit =
            c->encoding ? value >> count & 1 : c->code >= half;
        pmesh_coder_narrow(c, half & (0 - (uint64_t)bit), half);
        result = result << 1 | bit;
    }
    return result;
}

uint32_t pmesh_code_tree(pmesh_coder *c, pmesh_bit *tree, unsigned count,
                         uint32_t value)
{
    uint32_t node = 1;
    for (unsigned i = count; i-- > 0;)
        node = node << 1 | pmesh_code_bit(c, &tree[node - 1], value >> i & 1);
    return node - (1u << count);
}

void pmesh_number_init(pmesh_number *m)
{
    pmesh_bits_init(m->length, 32);
    pmesh_bits_init(m->top[0], sizeof m->top / sizeof m->top[0][0]);
}

/* value + 1 = 1xyz...: the number of bits behind the leading one in unary,
 * then those bits, the first two of them adaptive. */
uint32_t pmesh_code_number(pmesh_coder *c, pmesh_number *m, uint32_t value)
{
    const uint64_t wide = (uint64_t)value + 1;
    unsigned length = 0;
    while (length < 31 &&
           pmesh_code_bit(c, &m->length[length], wide >> (length + 1) != 0))
        length++;

    uint64_t result = 1;
    unsigned node = 0;
    for (unsigned i = length; i-- > 0;) {
        const uint32_t bit = (uint32_t)(wide >> i & 1);
        if (node < 3 && length - i <= 2) {
            const unsigned b = pmesh_code_bit(c, &m->top[length][node], bit);
            result = result << 1 | b;
            node = 1 + b;
        } else {
            result = result << 1 | pmesh_code_raw(c, 1, bit);
        }
    }
    return (uint32_t)(result - 1);
}
