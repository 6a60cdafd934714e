/* SPDX-License-Identifier: MIT */
#include "tools/utf8.h"

#include <stdbool.h>

size_t utf8_next(const char *text, uint32_t *code)
{
    static const uint32_t least[5] = { 0, 0, 0x80, 0x800, 0x10000 };
    const unsigned lead = (unsigned char)text[0];
    size_t length;
    uint32_t value;

    if (lead < 0x80) {
        *code = lead;
        return lead != 0;
    }
    if (lead >= 0xC0 && lead < 0xE0) {
        length = 2;
        value = lead & 0x1F;
    } else if (lead >= 0xE0 && lead < 0xF0) {
        length = 3;
        value = lead & 0x0F;
    } else {
        length = 4;
        value = lead & 0x07;
    }
    bool valid = lead >= 0xC0 && lead < 0xF8;
    /* The terminator is no continuation byte, so the loop stops there. */
    for (size_t i = 1; valid && i < length; i++) {
        const unsigned byte = (unsigned char)text[i];
        valid = (byte & 0xC0) == 0x80;
        value = value << 6 | (byte & 0x3F);
    }
    if (!valid || value < least[length] || value > 0x10FFFF ||
        (value >= 0xD800 && value < 0xE000)) {
        *code = UTF8_INVALID;
        return 1;
    }
    *code = value;
    return length;
}
