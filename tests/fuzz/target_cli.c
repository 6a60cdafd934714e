/* SPDX-License-Identifier: MIT */
/*
 * Command lines, one argument a line: the exit code is one of ours. What comes
 * behind an empty line is the content of a file "s": a script, a guide, a mask,
 * a mesh. The commands run in a folder of their own that holds this, a mesh and
 * its bake, without standard input, with short file names and small numbers:
 * what is tested is how things are read, not how much work they can ask for.
 */
#define _DEFAULT_SOURCE
#include <dirent.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/fuzz/fuzz.h"
#include "tools/cmd.h"

enum { ARGUMENTS = 16, FOLDERS = 4 };

typedef struct command {
    const char *name;
    int (*run)(int argc, char **argv);
} command;

/* Not batch, which forks, and view only as it writes a page. */
static const command commands[] = {
    { "bake", cmd_bake },         { "extract", cmd_extract },
    { "info", cmd_info },         { "verify", cmd_verify },
    { "compare", cmd_compare },   { "simplify", cmd_simplify },
    { "session", cmd_session },   { "stats", cmd_stats },
    { "plot", cmd_plot },         { "guide", cmd_guide },
    { "plan", cmd_plan },         { "view", cmd_view },
    { "sample", cmd_sample },     { "sheet", cmd_sheet },
};

static const char quad[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 1\nvt 0 0\n"
                           "vt 1 1\nvt 1 0\nf 1/1 2/2 3/3\nf 2/2 4/1 3/3\n";

/* No other folder, no server, nothing that takes long or much. */
static bool is_harmless(const char *line)
{
    size_t digits = 0;
    if (strchr(line, '/') || strstr(line, "..") || strstr(line, "serve"))
        return false;
    for (const char *p = line; *p; p++) {
        const bool digit = *p >= '0' && *p <= '9';
        if (digits > 0 && strchr("kKmMgGtTeE", *p))
            return false;
        digits = digit ? digits + 1 : 0;
        if (digits > 3)
            return false;
    }
    return true;
}

/* ---- the folder --------------------------------------------------------- */

/* What the file "s" holds. */
typedef struct content {
    const char *data;
    size_t size;
} content;

static void put_file(const char *name, content c)
{
    FILE *out = fopen(name, "w");
    FUZZ_CHECK(out && fwrite(c.data, 1, c.size, out) == c.size &&
               fclose(out) == 0);
}

static int enter(content s)
{
    char name[] = "/tmp/pmesh-fuzz-XXXXXX";
    const int home = open(".", O_RDONLY);
    FUZZ_CHECK(home >= 0 && mkdtemp(name) && chdir(name) == 0);
    put_file("a.obj", (content){ quad, sizeof quad - 1 });
    put_file("s", s);
    char word[][8] = { "bake", "a.obj", "-o", "b.pmesh", "-q" };
    char *bake[] = { word[0], word[1], word[2], word[3], word[4], NULL };
    FUZZ_CHECK(cmd_bake(5, bake) == CMD_DONE);
    return home;
}

/* Removes what is in the current folder. */
static void empty(int depth)
{
    struct dirent **entry;
    const int count = scandir(".", &entry, NULL, NULL);
    for (int i = 0; i < count; i++) {
        const char *name = entry[i]->d_name;
        if (strcmp(name, ".") != 0 && strcmp(name, "..") != 0 &&
            unlink(name) != 0 && depth < FOLDERS && chdir(name) == 0) {
            empty(depth + 1);
            FUZZ_CHECK(chdir("..") == 0);
            rmdir(name);
        }
        free(entry[i]);
    }
    if (count >= 0)
        free(entry);
}

static void leave(int home)
{
    char name[4096];
    FUZZ_CHECK(getcwd(name, sizeof name) && strstr(name, "/pmesh-fuzz-"));
    empty(0);
    FUZZ_CHECK(fchdir(home) == 0 && rmdir(name) == 0);
    close(home);
}

/* ---- running ------------------------------------------------------------ */

static int redirect(int fd, const char *path, int flags)
{
    const int kept = dup(fd), other = open(path, flags);
    FUZZ_CHECK(kept >= 0 && other >= 0 && dup2(other, fd) == fd);
    close(other);
    return kept;
}

static void restore(int fd, int kept)
{
    FUZZ_CHECK(dup2(kept, fd) == fd);
    close(kept);
}

static int run(const command *c, int argc, char **argv, content s)
{
    fflush(stdout);
    fflush(stderr);
    const int in = redirect(STDIN_FILENO, "/dev/null", O_RDONLY);
    const int out = redirect(STDOUT_FILENO, "/dev/null", O_WRONLY);
    const int err = redirect(STDERR_FILENO, "/dev/null", O_WRONLY);
    const int home = enter(s);
    const int code = c->run(argc, argv);
    leave(home);
    fflush(stdout);
    restore(STDERR_FILENO, err);
    restore(STDOUT_FILENO, out);
    restore(STDIN_FILENO, in);
    clearerr(stdin);
    return code;
}

static const command *find(const char *name)
{
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
        if (strcmp(commands[i].name, name) == 0)
            return &commands[i];
    return NULL;
}

/* Cuts the lines before the empty one into arguments; returns the rest. */
static content cut(char *text, size_t size, int *argc, char **argv)
{
    char *next = text, *end = text + size;
    *argc = 0;
    while (next < end && *next != '\n' && *argc < ARGUMENTS) {
        char *stop = memchr(next, '\n', (size_t)(end - next));
        argv[(*argc)++] = next;
        next = stop ? stop + 1 : end;
        if (stop)
            *stop = '\0';
    }
    argv[*argc] = NULL;
    next += next < end;
    return (content){ next, (size_t)(end - next) };
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char *text = fuzz_room(size + 1), *argv[ARGUMENTS + 1];
    int argc;

    memcpy(text, data, size);
    text[size] = '\0';
    const content s = cut(text, size, &argc, argv);
    const command *c = argc > 0 ? find(argv[0]) : NULL;
    bool harmless = c && (c->run != cmd_session || is_harmless(s.data));
    for (int i = 0; i < argc; i++)
        harmless = harmless && is_harmless(argv[i]);
    if (harmless) {
        const int code = run(c, argc, argv, s);
        FUZZ_CHECK(code >= CMD_DONE && code <= CMD_BOUND);
    }
    free(text);
    return 0;
}
