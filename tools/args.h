/* SPDX-License-Identifier: MIT */
/*
 * args.h - command line options from one table per command.
 *
 *   typedef struct options { uint32_t faces; bool json; } options;
 *   static const args_option table[] = {
 *       { .name = "faces", .kind = ARGS_COUNT, .value = "N", .min = 1,
 *         .max = UINT32_MAX, .offset = offsetof(options, faces),
 *         .help = "at most N faces" },
 *       { .name = "json", .kind = ARGS_FLAG,
 *         .offset = offsetof(options, json), .help = "report as JSON" },
 *   };
 *
 * Accepted: --name value, --name=value, -x value, -xvalue, -xyz for flags;
 * "--" ends the options; "-" is an operand. Names are spelled in full. -h and
 * --help are added to every command.
 */
#ifndef ARGS_H
#define ARGS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum args_kind {
    ARGS_FLAG,   /* bool; takes no value */
    ARGS_TEXT,   /* const char *, into argv */
    ARGS_CHOICE, /* int: which of the words in .value, "compact|balanced" */
    ARGS_COUNT,  /* uint32_t: 20000, 20k, 1.5M */
    ARGS_SIZE,   /* uint64_t: 20k, 1.5MB, 64KiB */
    ARGS_NUMBER, /* double */
    ARGS_RATIO   /* double: 25% or 0.25 */
} args_kind;

typedef struct args_option {
    const char *name; /* the long one, without dashes */
    char letter;      /* the short one; 0: none */
    args_kind kind;
    const char *value; /* what the help calls the value, or the choices */
    double min, max;   /* of COUNT, SIZE, NUMBER, RATIO, both included */
    size_t offset;     /* of the target in the command's options */
    const char *help;  /* may hold line breaks; NULL: not listed */
} args_option;

typedef struct args_command {
    const char *name;
    const char *summary;  /* one line */
    const char *synopsis; /* "IN -o OUT [options]" */
    const args_option *options;
    size_t option_count;
    const char *details; /* for --help: paragraphs and examples */
} args_command;

typedef enum args_result {
    ARGS_RUN,  /* go on */
    ARGS_HELP, /* help was printed: exit with success */
    ARGS_BAD   /* one line was printed on stderr: exit with CMD_USAGE */
} args_result;

/*
 * Fills the options struct at `options` (preset with the defaults) and moves
 * the operands to argv[0] .. argv[*operand_count - 1]. argv[0] is the
 * command's name at first.
 */
args_result args_parse(const args_command *command, int argc, char **argv,
                       void *options, int *operand_count);

/* One line on stderr about the command line, with a pointer to --help. */
args_result args_complain(const args_command *command, const char *form, ...);

/* The word that `text` is most likely a misspelling of, or NULL. */
const char *args_nearest(const char *text, const char *const *words,
                         size_t word_count);

#endif
