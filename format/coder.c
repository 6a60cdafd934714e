/* SPDX-License-Identifier: MIT */
#include "format/coder.h"

#define PROBABILITY_BITS 16
#define FAST_USES        30 /* the estimates become exponential averages with */
#define PRIOR_USES       12 /* a probability from a table counts as many bits */
#define SLOW_USES        127 /* these lengths; before, they are plain averages */

/* 2 / (2 uses + 3) in 1/32768: the step of an average towards a new value. */
#define RATE_BITS 15
#define R(n)      (65536 / (2 * (n) + 3))
#define R4(n)     R(n), R((n) + 1), R((n) + 2), R((n) + 3)
#define R32(n)                                                                 \
    R4(n), R4((n) + 4), R4((n) + 8), R4((n) + 12), R4((n) + 16), R4((n) + 20), \
        R4((n) + 24), R4((n) + 28)

static const uint16_t rate[SLOW_USES + 1] = {
    R32(0),
    R32(32),
    R32(64),
    R32(96),
};

/* Keeps a bit's cost below about 11 bits and above 1/1400. */
#define PROBABILITY_MIN 32u
#define PROBABILITY_MAX (65536u - PROBABILITY_MIN)

void pmesh_bits_init(pmesh_bit *bits, size_t count)
{
    for (size_t i = 0; i < count; i++)
        bits[i] = (pmesh_bit)PMESH_BIT_INIT;
}

void pmesh_bits_start(pmesh_bit *bits, size_t count, const uint8_t *table)
{
    pmesh_bits_init(bits, count);
    for (size_t i = 0; i < count; i++)
        if (table[i]) {
            bits[i].fast = bits[i].slow = (uint16_t)(table[i] * 256 + 128);
            bits[i].uses = PRIOR_USES;
        }
}

void pmesh_coder_encode(pmesh_coder *c, pmesh_writer *out)
{
    *c = (pmesh_coder){
        .encoding = true, .range = UINT32_MAX, .out = out, .pending = 1
    };
}

void pmesh_coder_decode(pmesh_coder *c, const uint8_t *data, size_t size)
{
    *c = (pmesh_coder){ .range = UINT32_MAX,
                        .in = pmesh_cursor_make(data, size) };
    for (int i = 0; i < 4; i++)
        c->code = c->code << 8 | pmesh_get_u8(&c->in);
}

void pmesh_coder_shift(pmesh_coder *c)
{
    const uint8_t carry = (uint8_t)(c->low >> 32);
    if (carry || (uint32_t)c->low < 0xff000000u) {
        /* `pending` counts the cache and the 0xff bytes behind it. The first
         * cache stands for the digit before the point: always 0, left out. */
        if (c->started)
            pmesh_put(c->out, (uint8_t)(c->cache + carry), 1);
        for (; c->pending > 1; c->pending--)
            pmesh_put(c->out, (uint8_t)(0xff + carry), 1);
        c->started = true;
        c->pending = 0;
        c->cache = (uint8_t)(c->low >> 24);
    }
    c->pending++;
    c->low = (c->low & 0x00ffffffu) << 8;
}

bool pmesh_coder_finish(pmesh_coder *c)
{
    if (!c->encoding) /* zeros left out: at most the 4 bytes of the flush */
        return c->in.next == c->in.end;

    const size_t start = c->out->size;
    /* Any value in [low, low + range) will do: the one with most zeros. */
    const uint64_t high = c->low + c->range - 1;
    uint64_t value = high;
    for (unsigned bits = 32; bits > 0; bits--) {
        value = high >> bits << bits;
        if (value >= c->low)
            break;
        value = high;
    }
    c->low = value;
    for (int i = 0; i < 5; i++)
        pmesh_coder_shift(c);
    while (c->out->size > start && c->out->data[c->out->size - 1] == 0)
        c->out->size--;
    return !c->out->overflow;
}

/* The bytes that left the range, and by how much it is narrower than at the
 * start: log2(range) by squaring. */
uint64_t pmesh_coder_spent(const pmesh_coder *c)
{
    uint64_t part = c->range, log = 31;
    for (; part < (UINT64_C(1) << 31); part <<= 1)
        log--;
    for (int i = 0; i < 8; i++) {
        part = part * part >> 31;
        log = 2 * log + (part >> 32);
        part >>= part >> 32;
    }
    return (c->out->size + c->pending + c->started) * 8 * 256 + 32 * 256 - log;
}

static void adapt(pmesh_bit *m, unsigned bit)
{
    const int32_t target = bit ? 0 : 65535;
    const int32_t fast = rate[m->uses < FAST_USES ? m->uses : FAST_USES];
    m->fast = (uint16_t)(m->fast + ((target - m->fast) * fast >> RATE_BITS));
    m->slow =
        (uint16_t)(m->slow + ((target - m->slow) * rate[m->uses] >> RATE_BITS));
    if (m->uses < SLOW_USES)
        m->uses++;
}

/* One bit that is 0 with probability p / 65536. */
static inline unsigned code(pmesh_coder *c, uint32_t p, unsigned bit)
{
    p = p < PROBABILITY_MIN   ? PROBABILITY_MIN
        : p > PROBABILITY_MAX ? PROBABILITY_MAX
                              : p;
    const uint32_t bound = (c->range >> PROBABILITY_BITS) * p;

    if (!c->encoding)
        bit = c->code >= bound;
    if (bit) {
        if (c->encoding)
            c->low += bound;
        else
            c->code -= bound;
        c->range -= bound;
    } else {
        c->range = bound;
    }
    pmesh_coder_normalize(c);
    return bit;
}

unsigned pmesh_code_bit(pmesh_coder *c, pmesh_bit *m, unsigned bit)
{
    bit = code(c, ((uint32_t)m->fast + m->slow) / 2, bit);
    adapt(m, bit);
    return bit;
}

unsigned pmesh_code_bit_twice(pmesh_coder *c, pmesh_bit *m, pmesh_bit *n,
                              unsigned bit)
{
    bit = code(c, ((uint32_t)m->fast + m->slow + n->fast + n->slow) / 4, bit);
    adapt(m, bit);
    adapt(n, bit);
    return bit;
}

uint32_t pmesh_code_raw(pmesh_coder *c, unsigned count, uint32_t value)
{
    uint32_t result = 0;
    while (count-- > 0) {
        c->range >>= 1;
        uint32_t bit = value >> count & 1;
        if (!c->encoding)
            bit = c->code >= c->range;
        if (bit && c->encoding)
            c->low += c->range;
        else if (bit)
            c->code -= c->range;
        result = result << 1 | bit;
        pmesh_coder_normalize(c);
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
