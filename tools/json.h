/* SPDX-License-Identifier: MIT */
/*
 * json.h - writes JSON, indented by two, without locale.
 *
 *   json j;
 *   json_begin(&j, stdout);
 *   json_count(&j, "faces", 5000);
 *   json_open(&j, "levels", '[');
 *   ...
 *   json_close(&j);
 *   json_end(&j);
 *
 * The key is NULL inside an array. Text may be any bytes: what is not UTF-8
 * becomes U+FFFD. Numbers that are not finite become null.
 */
#ifndef JSON_H
#define JSON_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#define JSON_MAX_DEPTH 16

typedef struct json {
    FILE *out;
    unsigned depth;
    bool used[JSON_MAX_DEPTH];   /* has a member: a comma is due */
    bool flat[JSON_MAX_DEPTH];   /* members on one line */
    char closer[JSON_MAX_DEPTH];
} json;

/* Opens and closes the outermost object; json_end() adds the line break. */
void json_begin(json *j, FILE *out);
void json_end(json *j);

/* `bracket` is '{' or '['; json_open_flat keeps all members on one line. */
void json_open(json *j, const char *key, char bracket);
void json_open_flat(json *j, const char *key, char bracket);
void json_close(json *j);

void json_text(json *j, const char *key, const char *value);
void json_count(json *j, const char *key, uint64_t value);
void json_number(json *j, const char *key, double value);
void json_float(json *j, const char *key, float value);
/* `value` is JSON already. */
void json_raw(json *j, const char *key, const char *value);
void json_bool(json *j, const char *key, bool value);

#endif
