/* SPDX-License-Identifier: MIT */
/*
 * Command lines, one argument a line: the exit code is one of ours. The
 * commands run in an empty folder of their own that holds a mesh and its bake,
 * without standard input, with short file names and small numbers: what is
 * tested is how arguments are read, not how much work they can ask for.
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

static const char triangle[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 1\n"
                               "f 1 2 3\nf 2 4 3\n";

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

static int enter(void)
{
    char name[] = "/tmp/pmesh-fuzz-XXXXXX";
    const int home = open(".", O_RDONLY);
    FUZZ_CHECK(home >= 0 && mkdtemp(name) && chdir(name) == 0);
    FILE *mesh = fopen("a.obj", "w");
    FUZZ_CHECK(mesh && fputs(triangle, mesh) >= 0 && fclose(mesh) == 0);
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

static int run(const command *c, int argc, char **argv)
{
    fflush(stdout);
    fflush(stderr);
    const int in = redirect(STDIN_FILENO, "/dev/null", O_RDONLY);
    const int out = redirect(STDOUT_FILENO, "/dev/null", O_WRONLY);
    const int err = redirect(STDERR_FILENO, "/dev/null", O_WRONLY);
    const int home = enter();
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

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char *text = fuzz_room(size + 1), *argv[ARGUMENTS + 1];
    int argc = 0;
    bool harmless = true;

    memcpy(text, data, size);
    text[size] = '\0';
    for (char *next = text; next && argc < ARGUMENTS;) {
        argv[argc] = next;
        next = strchr(next, '\n');
        if (next)
            *next++ = '\0';
        harmless = harmless && is_harmless(argv[argc++]);
    }
    argv[argc] = NULL;
    const command *c = find(argv[0]);
    if (c && harmless) {
        const int code = run(c, argc, argv);
        FUZZ_CHECK(code >= CMD_DONE && code <= CMD_BOUND);
    }
    free(text);
    return 0;
}
