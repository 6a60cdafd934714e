/* SPDX-License-Identifier: MIT */
/*
 * cmd.h - the subcommands of the program and its exit codes.
 *
 * A command gets its own name as argv[0] and returns an exit code; where that
 * is not CMD_DONE it has printed one line on stderr. It may print on stdout;
 * main() flushes and checks it.
 */
#ifndef CMD_H
#define CMD_H

/* Pinned: scripts rely on them. */
enum {
    CMD_DONE = 0,
    CMD_IO = 1,     /* input or output failed, or out of memory */
    CMD_USAGE = 2,  /* the command line makes no sense */
    CMD_ASSET = 3,  /* the input mesh is unreadable or unsupported */
    CMD_STREAM = 4, /* the .pmesh is damaged, or cut and a whole one is asked */
    CMD_BOUND = 5   /* a bound that was asked for cannot be met */
};

/* The choices of --format, in the order of asset_format from ASSET_OBJ on. */
#define CMD_FORMATS "obj|ply|stl|off|gltf|glb|drc"

int cmd_bake(int argc, char **argv);
int cmd_batch(int argc, char **argv);
int cmd_extract(int argc, char **argv);
int cmd_info(int argc, char **argv);
int cmd_verify(int argc, char **argv);
int cmd_compare(int argc, char **argv);
int cmd_sheet(int argc, char **argv);
int cmd_simplify(int argc, char **argv);
int cmd_session(int argc, char **argv);
int cmd_stats(int argc, char **argv);
int cmd_plot(int argc, char **argv);
int cmd_guide(int argc, char **argv);
int cmd_plan(int argc, char **argv);
int cmd_view(int argc, char **argv);
int cmd_sample(int argc, char **argv);

#endif
