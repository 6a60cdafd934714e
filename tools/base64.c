/* SPDX-License-Identifier: MIT */
#include "tools/base64.h"

void base64_put(asset_bytes *out, const uint8_t *data, size_t size)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnop"
                                 "qrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size && !out->failed; i += 3) {
        const size_t n = size - i < 3 ? size - i : 3;
        char text[4] = { 0, 0, '=', '=' };
        uint32_t word = 0;
        for (size_t k = 0; k < 3; k++)
            word = word << 8 | (k < n ? data[i + k] : 0u);
        for (size_t k = 0; k <= n; k++)
            text[k] = digits[word >> (18 - 6 * k) & 63];
        asset_put(out, text, sizeof text);
    }
}
