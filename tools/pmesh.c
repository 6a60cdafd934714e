/* SPDX-License-Identifier: MIT */
/*
 * pmesh.c - the program: finds the subcommand and runs it.
 */
#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "format/pmesh.h"
#include "tools/args.h"
#include "tools/cmd.h"
#include "tools/exhausted.h"
#include "tools/file.h"
#include "tools/report.h"

typedef struct subcommand {
    const char *name;
    int (*run)(int argc, char **argv);
    const char *summary;
} subcommand;

static const subcommand subcommands[] = {
    { "bake", cmd_bake, "turn a triangle mesh into a .pmesh file" },
    { "batch", cmd_batch, "bake many files, several at a time" },
    { "extract", cmd_extract, "write a mesh of any size out of a .pmesh" },
    { "simplify", cmd_simplify, "write a mesh file with fewer faces" },
    { "info", cmd_info, "print what the header of a .pmesh says" },
    { "verify", cmd_verify, "decode .pmesh files and check every byte" },
    { "compare", cmd_compare, "measure the distance of two meshes" },
    { "guide", cmd_guide, "begin a guide file: what matters of a mesh" },
    { "sheet", cmd_sheet, "draw the levels of a .pmesh into a picture" },
    { "plot", cmd_plot, "draw bytes against distance into a diagram" },
    { "stats", cmd_stats, "print what contractions cost at a size" },
    { "session", cmd_session, "simplify back and forth by a script" },
    { "plan", cmd_plan, "say how much of a .pmesh to load" },
    { "view", cmd_view, "make a page that shows a .pmesh in a browser" },
    { "sample", cmd_sample, "write a mesh to try things with" },
};
#define SUBCOMMAND_COUNT (sizeof subcommands / sizeof *subcommands)

static void print_usage(FILE *out)
{
    fprintf(out, "Usage: pmesh COMMAND [options]\n\n"
                 "Bakes triangle meshes into progressive files, of which any "
                 "prefix is a mesh.\n\nCommands:\n");
    for (size_t i = 0; i < SUBCOMMAND_COUNT; i++)
        fprintf(out, "  %-10s%s\n", subcommands[i].name,
                subcommands[i].summary);
    fprintf(out, "  %-10s%s\n\n", "help", "explain a command");
    fprintf(out, "  pmesh bake bunny.obj -o bunny.pmesh\n"
                 "  pmesh extract bunny.pmesh --faces 5k -o small.obj\n\n"
                 "pmesh COMMAND --help tells more; pmesh --version the "
                 "version.\n");
}

static const subcommand *find(const char *name)
{
    for (size_t i = 0; i < SUBCOMMAND_COUNT; i++)
        if (strcmp(subcommands[i].name, name) == 0)
            return &subcommands[i];
    return NULL;
}

static int unknown(const char *name)
{
    const char *names[SUBCOMMAND_COUNT + 1];

    for (size_t i = 0; i < SUBCOMMAND_COUNT; i++)
        names[i] = subcommands[i].name;
    names[SUBCOMMAND_COUNT] = "help";
    const char *nearest = args_nearest(name, names, SUBCOMMAND_COUNT + 1);
    const bool option = name[0] == '-';
    if (nearest && !option)
        report_error(NULL, NULL, "unknown command '%s', '%s' perhaps; try "
                     "'pmesh help'", name, nearest);
    else
        report_error(NULL, NULL, "unknown %s '%s'; try 'pmesh help'",
                     option ? "option" : "command", name);
    return CMD_USAGE;
}

static int help(int argc, char **argv)
{
    if (argc < 2) {
        print_usage(stdout);
        return CMD_DONE;
    }
    const subcommand *command = find(argv[1]);
    if (!command)
        return unknown(argv[1]);
    char option[] = "--help";
    char *full[] = { argv[1], option, NULL };
    return command->run(2, full);
}

static int run(int argc, char **argv)
{
    if (argc < 2) {
        print_usage(stderr);
        return CMD_USAGE;
    }
    const char *name = argv[1];
    if (strcmp(name, "help") == 0)
        return help(argc - 1, argv + 1);
    if (strcmp(name, "-h") == 0 || strcmp(name, "--help") == 0) {
        print_usage(stdout);
        return CMD_DONE;
    }
    if (strcmp(name, "-V") == 0 || strcmp(name, "--version") == 0) {
        printf("pmesh %s (format %d)\n", pmesh_version(),
               PMESH_FORMAT_VERSION);
        return CMD_DONE;
    }
    const subcommand *command = find(name);
    return command ? command->run(argc - 1, argv + 1) : unknown(name);
}

/*
 * A closed standard descriptor would be taken by the next file opened, and
 * messages would land in it. Each gets one that fails the use it is meant for.
 */
static void occupy_descriptors(void)
{
    for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; fd++)
        if (fcntl(fd, F_GETFD) < 0 &&
            open("/dev/null", fd == STDIN_FILENO ? O_WRONLY : O_RDONLY) < 0)
            return;
}

int main(int argc, char **argv)
{
    const bool has_stdout = fcntl(STDOUT_FILENO, F_GETFD) >= 0;

    occupy_descriptors();
    file_catch_signals();
    exhausted_catch();
    int code = run(argc, argv);

    errno = 0;
    const bool failed = fflush(stdout) != 0 || ferror(stdout);
    if (failed && has_stdout) {
        report_error("standard output", NULL, "cannot write: %s",
                     errno ? strerror(errno) : "an earlier write failed");
        if (code == CMD_DONE)
            code = CMD_IO;
    }
    return code;
}
