/* SPDX-License-Identifier: MIT */
/* Any bytes as texts and numbers of our JSON: what is written is JSON in UTF-8,
 * and nothing but line ends of control characters. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/fuzz/fuzz.h"
#include "tools/json.h"
#include "tools/utf8.h"

/* Behind the string at p; NULL if it is none. */
static const char *skip_string(const char *p)
{
    if (*p++ != '"')
        return NULL;
    for (; *p != '"'; p++) {
        if ((unsigned char)*p < 0x20)
            return NULL;
        if (*p != '\\')
            continue;
        p++;
        if (*p == 'u') {
            if (strspn(p + 1, "0123456789abcdefABCDEF") < 4)
                return NULL;
            p += 4;
        } else if (!*p || !strchr("\"\\/bfnrt", *p)) {
            return NULL;
        }
    }
    return p + 1;
}

/* Strings are strings, and what is between them is made of these. */
static void check_json(const char *text)
{
    uint32_t code;
    for (const char *p = text; *p; p += utf8_next(p, &code)) {
        utf8_next(p, &code);
        FUZZ_CHECK(code != UTF8_INVALID);
    }
    int depth = 0;
    for (const char *p = text; *p;) {
        if (*p == '"') {
            p = skip_string(p);
            FUZZ_CHECK(p);
            continue;
        }
        FUZZ_CHECK(strchr("{}[]:, \n0123456789+-.eEtrufalsn", *p));
        depth += (*p == '{' || *p == '[') - (*p == '}' || *p == ']');
        FUZZ_CHECK(depth >= 0);
        p++;
    }
    FUZZ_CHECK(depth == 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char *text = fuzz_room(size + 1), *written = NULL;
    size_t length = 0;
    double number = 0;
    uint64_t count = 0;
    json j;

    memcpy(text, data, size);
    text[size] = '\0';
    memcpy(&number, data, size < sizeof number ? size : sizeof number);
    memcpy(&count, data, size < sizeof count ? size : sizeof count);
    FILE *out = open_memstream(&written, &length);
    FUZZ_CHECK(out);
    json_begin(&j, out);
    json_text(&j, "text", text);
    json_open(&j, "list", '[');
    json_text(&j, NULL, text);
    json_number(&j, NULL, number);
    json_float(&j, NULL, (float)(count % 1000000) / 7);
    json_close(&j);
    json_count(&j, "count", count);
    json_bool(&j, "bool", size & 1);
    json_end(&j);
    fclose(out);
    check_json(written);
    free(written);
    free(text);
    return 0;
}
