/* SPDX-License-Identifier: MIT */
/*
 * driver.c - gives a target files: what libFuzzer's main does with file names,
 * for any compiler.
 *
 * Usage: TARGET [-q] FILE_OR_FOLDER...
 * Names each file before its turn (-q: does not) and says how many there were. A
 * target that fails ends the program; so does one that takes more than 20 s.
 */
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/fuzz/fuzz.h"

enum { SECONDS = 20, ROOM = 1 << 24 };

static unsigned long inputs;

static int run_file(const char *path)
{
    FILE *in = fopen(path, "rb");
    uint8_t *data = malloc(ROOM);
    if (!in || !data) {
        perror(path);
        return 1;
    }
    const size_t size = fread(data, 1, ROOM, in);
    fclose(in);
    uint8_t *exact = fuzz_copy(data, size);
    free(data);
    inputs++;
    alarm(SECONDS);
    LLVMFuzzerTestOneInput(exact, size);
    alarm(0);
    free(exact);
    return 0;
}

/* The driver's last words, if the target ends the program. */
static void say(const char *path)
{
    fprintf(stderr, "%s\n", path);
    fflush(stderr);
}

static int run_path(const char *path, int quiet);

static int run_folder(const char *path, int quiet)
{
    struct dirent **entry;
    int bad = 0;
    const int count = scandir(path, &entry, NULL, alphasort);
    for (int i = 0; i < count; i++) {
        char name[4096];
        if (entry[i]->d_name[0] != '.') {
            snprintf(name, sizeof name, "%s/%s", path, entry[i]->d_name);
            bad |= run_path(name, quiet);
        }
        free(entry[i]);
    }
    if (count >= 0)
        free(entry);
    return bad || count < 0;
}

static int run_path(const char *path, int quiet)
{
    struct stat info;
    if (stat(path, &info) != 0) {
        perror(path);
        return 1;
    }
    if (S_ISDIR(info.st_mode))
        return run_folder(path, quiet);
    if (!quiet)
        say(path);
    return run_file(path);
}

int main(int argc, char **argv)
{
    const int quiet = argc > 1 && strcmp(argv[1], "-q") == 0;
    int bad = 0;
    for (int i = 1 + quiet; i < argc; i++)
        bad |= run_path(argv[i], quiet);
    printf("%lu inputs\n", inputs);
    return bad;
}
