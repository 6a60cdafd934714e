#!/bin/sh
# SPDX-License-Identifier: MIT
# Usage: tools/amalgamate.sh FOLDER VERSION
#
# Writes the decoder as two files to drop into another program, FOLDER/
# pmesh_decode.h and pmesh_decode.c: C99, C11 or C++17. The header is format/
# pmesh.h and those of decoder/; the source is all of format/ and decoder/ with
# the internal functions made static. Where two sources use the same name
# for something of their own, the name gets that of the source in front.
#
# Codec code runs in either direction; here that is known, and what only an
# encoder does goes away.
#
# C++ converts no void * by itself: what returns one returns PMESH_UNTYPED
# here, which does.
set -eu
folder=$1
version=$2
public="format/pmesh.h decoder/pmesh_decode.h decoder/pmesh_plan.h
    decoder/pmesh_scene.h"
mkdir -p "$folder"

about() {
    cat <<TEXT
/* SPDX-License-Identifier: MIT */
/*
 * $1 - the decoder of pmesh $version in two files, made from format/ and
 * decoder/ of the project: change those, not this.
 */
TEXT
}

{
    about pmesh_decode.h
    # shellcheck disable=SC2086 # words on purpose
    awk '!/SPDX-License/ && !/^#include "/' $public
} >"$folder/pmesh_decode.h"

# One source: includes of the tree are put in their place once, those of the
# system come first, and what the linker saw inside the library becomes static.
{
    about pmesh_decode.c
    cat <<'TEXT'
#include "pmesh_decode.h"

#include <assert.h>
#include <float.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#if defined(__GNUC__)
#define PMESH_PRIVATE static __attribute__((unused))
#else
#define PMESH_PRIVATE static
#endif

#ifdef __cplusplus
#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wpragmas"
#pragma GCC diagnostic ignored "-Wc++20-extensions"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wnarrowing"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#endif
#define restrict __restrict
namespace {
struct pmesh_untyped {
    void *at;
    pmesh_untyped(void *p) : at(p) {}
    template <class T> operator T *() const { return (T *)at; }
    bool operator!() const { return !at; }
};
} // namespace
#define PMESH_UNTYPED pmesh_untyped
#else
#define PMESH_UNTYPED void *
#endif
TEXT
    # shellcheck disable=SC2086
    awk -v public="$public" '
    # The names that a source keeps to itself: static functions and data,
    # types and constants.
    function own_names(file,  line, name, list) {
        while ((getline line < file) > 0) {
            if (line ~ /^(static|typedef) /) {
                name = line
                sub(/^static (inline )?/, "", name)
                if (name ~ /^typedef/)
                    sub(/^typedef (struct|enum) /, "", name)
                else {
                    sub(/[[(=;].*/, "", name)
                    sub(/ *$/, "", name)
                    sub(/.*[ *]/, "", name)
                }
                sub(/[^a-zA-Z0-9_].*/, "", name)
                list = list " " name
            }
            if (line ~ /^(enum [a-z_]*|static const enum) *\{/ ||
                line ~ /^enum \{/)
                constants = 1
            if (constants) {
                name = line
                gsub(/\/\*.*/, "", name)
                while (match(name, /[A-Z][A-Z0-9_]+ *=/)) {
                    list = list " " substr(name, RSTART, RLENGTH - 1)
                    name = substr(name, RSTART + RLENGTH)
                }
                if (line ~ /\}/)
                    constants = 0
            }
            if (line ~ /^#define [A-Z]/) {
                name = line
                sub(/^#define /, "", name)
                sub(/[^A-Z0-9_].*/, "", name)
                macros[file] = macros[file] " " name
            }
        }
        close(file)
        return list
    }

    function internal(line) {
        if (line !~ /^(const )?(struct )?[a-z_][a-z0-9_]* [*]*(pmesh|dec)_[a-z0-9_]+\(/ ||
            line ~ /^(static|typedef|return|extern|PMESH_API) /)
            return 0
        sub(/\(.*/, "", line)
        sub(/.*[ *]/, "", line)
        return !(line in exported)
    }

    function put(file,  line, target) {
        if (file in seen)
            return
        seen[file]
        while ((getline line < file) > 0) {
            if (line ~ /SPDX-License/ ||
                (line ~ /^#include </ && line !~ /emmintrin/))
                continue
            if (line ~ /^#include "/) {
                target = line
                gsub(/^#include "|"$/, "", target)
                if (index(" " public " ", " " target " ") == 0)
                    put(target)
                continue
            }
            if (internal(line))
                line = "PMESH_PRIVATE " line
            if (line ~ /^(PMESH_PRIVATE|static) void \*/ &&
                line !~ /\(void \*user/)
                sub(/void \*/, "PMESH_UNTYPED ", line)
            gsub(/\(void \*\)/, "(PMESH_UNTYPED)", line)
            gsub(/([a-z]+->)+encoding/, "false", line)
            print line
        }
        close(file)
    }

    BEGIN {
        count = split(public, headers, " ")
        for (i = 1; i <= count; i++)
            while ((getline line < headers[i]) > 0)
                while (match(line, /pmesh_[a-z0-9_]+\(/)) {
                    exported[substr(line, RSTART, RLENGTH - 1)]
                    line = substr(line, RSTART + RLENGTH)
                }
        for (i = 1; i < ARGC; i++) {
            names[i] = own_names(ARGV[i])
            m = split(names[i], list, " ")
            for (k = 1; k <= m; k++)
                if (!((i, list[k]) in mine)) {
                    mine[i, list[k]]
                    uses[list[k]]++
                }
        }
        for (i = 1; i < ARGC; i++) {
            stem = ARGV[i]
            gsub(/.*\/|[.]c$/, "", stem)
            m = split(names[i], list, " ")
            shared = ""
            for (k = 1; k <= m; k++)
                if (uses[list[k]] > 1 && !((i, list[k]) in renamed)) {
                    renamed[i, list[k]]
                    shared = shared " " list[k]
                }
            # Headers first: the names are those of the source alone.
            while ((getline line < ARGV[i]) > 0)
                if (line ~ /^#include "/) {
                    gsub(/^#include "|"$/, "", line)
                    if (index(" " public " ", " " line " ") == 0)
                        put(line)
                }
            close(ARGV[i])
            printf "\n/* --- %s --- */\n", ARGV[i]
            m = split(shared, list, " ")
            for (k = 1; k <= m; k++)
                printf "#define %s %s_%s\n", list[k], stem, list[k]
            put(ARGV[i])
            n = split(macros[ARGV[i]], extra, " ")
            for (k = 1; k <= n; k++)
                print "#undef " extra[k]
            for (k = 1; k <= m; k++)
                print "#undef " list[k]
        }
    }' format/*.c decoder/*.c
} >"$folder/pmesh_decode.c"
