/* SPDX-License-Identifier: MIT */
#include "tools/args.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "tools/asset.h"
#include "tools/report.h"

#define HELP_COLUMN 26
#define MAX_WORD 32

static const args_option help_options[] = {
    { .name = "help", .letter = 'h', .kind = ARGS_FLAG,
      .help = "-h: this list; --help: more, with examples" },
};

args_result args_complain(const args_command *command, const char *form, ...)
{
    char text[512];
    va_list args;

    va_start(args, form);
    vsnprintf(text, sizeof text, form, args);
    va_end(args);
    report_error(command->name, NULL, "%s; try 'pmesh %s --help'", text,
                 command->name);
    return ARGS_BAD;
}

/* ---- nearest word ------------------------------------------------------- */

static size_t least(size_t a, size_t b, size_t c)
{
    const size_t ab = a < b ? a : b;
    return ab < c ? ab : c;
}

/* Edit distance (Levenshtein); words longer than MAX_WORD are far away. */
static size_t distance(const char *a, const char *b)
{
    const size_t na = strlen(a), nb = strlen(b);
    size_t row[MAX_WORD + 1];

    if (na > MAX_WORD || nb > MAX_WORD)
        return SIZE_MAX;
    for (size_t j = 0; j <= nb; j++)
        row[j] = j;
    for (size_t i = 1; i <= na; i++) {
        size_t diagonal = row[0];
        row[0] = i;
        for (size_t j = 1; j <= nb; j++) {
            const size_t change = diagonal + (a[i - 1] != b[j - 1]);
            diagonal = row[j];
            row[j] = least(row[j] + 1, row[j - 1] + 1, change);
        }
    }
    return row[nb];
}

const char *args_nearest(const char *text, const char *const *words,
                         size_t word_count)
{
    const char *best = NULL;
    size_t best_distance = strlen(text) / 3 + 2; /* from here on: no guess */

    for (size_t i = 0; i < word_count; i++) {
        size_t d = distance(text, words[i]);
        if (strlen(text) > 2 && strncmp(text, words[i], strlen(text)) == 0)
            d = 1; /* cut short */
        if (d < best_distance) {
            best_distance = d;
            best = words[i];
        }
    }
    return best;
}

/* ---- help --------------------------------------------------------------- */

static void print_option(const args_option *option)
{
    char head[96];
    const char *text = option->help;
    const bool valued = option->kind != ARGS_FLAG;
    const int letter_size =
        option->letter ? snprintf(head, sizeof head, "  -%c, ", option->letter)
                       : snprintf(head, sizeof head, "      ");
    snprintf(head + letter_size, sizeof head - (size_t)letter_size, "--%s%s%s",
             option->name, valued ? " " : "", valued ? option->value : "");

    printf("%-*s", HELP_COLUMN, head);
    if (strlen(head) >= HELP_COLUMN)
        printf("\n%*s", HELP_COLUMN, "");
    while (true) {
        const int size = (int)strcspn(text, "\n");
        printf("%.*s\n", size, text);
        text += size;
        if (*text == '\0')
            return;
        text++;
        printf("%*s", HELP_COLUMN, "");
    }
}

static args_result print_help(const args_command *command, bool full)
{
    printf("Usage: pmesh %s %s\n\n%s\n\nOptions:\n", command->name,
           command->synopsis, command->summary);
    for (size_t i = 0; i < command->option_count; i++)
        if (command->options[i].help)
            print_option(&command->options[i]);
    print_option(&help_options[0]);
    if (full && command->details)
        printf("\n%s", command->details);
    return ARGS_HELP;
}

/* ---- values ------------------------------------------------------------- */

/* The factor of a suffix such as k, MB, KiB, or 0 if there is none like it. */
static double suffix_factor(const char *suffix)
{
    static const char letters[] = "kMGT";
    double factor = 1;

    if (*suffix == '\0' || strcmp(suffix, "B") == 0)
        return 1;
    const char first = *suffix == 'K' ? 'k' : *suffix == 'm' ? 'M' : *suffix;
    const char *at = strchr(letters, first);
    if (!at)
        return 0;
    suffix++;
    const bool binary = *suffix == 'i';
    suffix += binary;
    if (strcmp(suffix, "") != 0 && strcmp(suffix, "B") != 0)
        return 0;
    for (const char *p = letters; p <= at; p++)
        factor *= binary ? 1024 : 1000;
    return factor;
}

static bool read_number(const args_option *option, const char *text,
                        double *out)
{
    const char *end = text + strlen(text);
    const char *rest = asset_number_parse(text, end, out);

    if (rest == text || !isfinite(*out))
        return false;
    if (option->kind == ARGS_RATIO) {
        if (strcmp(rest, "%") == 0)
            *out /= 100;
        else if (*rest != '\0')
            return false;
    } else if (option->kind == ARGS_NUMBER) {
        if (*rest != '\0')
            return false;
    } else {
        const double scaled = *out * suffix_factor(rest);
        *out = floor(scaled + 0.5);
        /* 1.001k is 1000.9999999999999 in doubles and means 1001. */
        if (suffix_factor(rest) <= 0 ||
            fabs(scaled - *out) > 1e-9 * fmax(1, fabs(scaled)))
            return false;
    }
    return *out >= option->min && *out <= option->max;
}

static args_result bad_number(const args_command *command,
                              const args_option *option, const char *text)
{
    const char *kind = option->kind == ARGS_RATIO    ? "ratio"
                       : option->kind == ARGS_NUMBER ? "number"
                                                     : "whole number";
    char low[40], high[40];

    low[asset_number_print(low, option->min)] = '\0';
    high[asset_number_print(high, option->max)] = '\0';
    if (option->max > UINT32_MAX)
        return args_complain(command, "--%s: '%s' is not a %s of at least %s",
                             option->name, text, kind, low);
    return args_complain(command, "--%s: '%s' is not a %s from %s to %s",
                         option->name, text, kind, low, high);
}

/* The position of `text` in the list "one|two|three", or -1. */
static int choice_of(const char *list, const char *text)
{
    const size_t size = strlen(text);

    for (int i = 0; ; i++) {
        const size_t word = strcspn(list, "|");
        if (word == size && memcmp(list, text, size) == 0)
            return i;
        if (list[word] == '\0')
            return -1;
        list += word + 1;
    }
}

static args_result store(const args_command *command,
                         const args_option *option, const char *text,
                         void *options)
{
    void *target = (char *)options + option->offset;
    double number;

    if (option->kind == ARGS_TEXT) {
        *(const char **)target = text;
        return ARGS_RUN;
    }
    if (option->kind == ARGS_CHOICE) {
        const int choice = choice_of(option->value, text);
        if (choice < 0)
            return args_complain(command, "--%s: '%s' is none of %s",
                                 option->name, text, option->value);
        *(int *)target = choice;
        return ARGS_RUN;
    }
    if (!read_number(option, text, &number))
        return bad_number(command, option, text);
    if (option->kind == ARGS_COUNT)
        *(uint32_t *)target = (uint32_t)number;
    else if (option->kind == ARGS_SIZE)
        *(uint64_t *)target = (uint64_t)number;
    else
        *(double *)target = number;
    return ARGS_RUN;
}

/* ---- words -------------------------------------------------------------- */

typedef struct words {
    const args_command *command;
    char **argv;
    int argc, next;
    void *options;
} words;

static args_result unknown_option(const args_command *command,
                                  const char *name)
{
    const char *names[64];
    size_t count = 0;

    for (size_t i = 0; i < command->option_count && count < 63; i++)
        if (command->options[i].help)
            names[count++] = command->options[i].name;
    names[count++] = "help";
    const char *nearest = args_nearest(name, names, count);
    if (nearest)
        return args_complain(command, "unknown option '--%s', '--%s' perhaps",
                             name, nearest);
    return args_complain(command, "unknown option '--%s'", name);
}

static args_result long_option(words *w, const char *word)
{
    const size_t size = strcspn(word, "=");
    const char *value = word[size] == '=' ? word + size + 1 : NULL;
    const args_command *command = w->command;
    char name[64];

    snprintf(name, sizeof name, "%.*s", (int)(size < 63 ? size : 63), word);
    if (strcmp(name, "help") == 0)
        return print_help(command, true);
    for (size_t i = 0; i < command->option_count; i++) {
        const args_option *option = &command->options[i];
        if (strcmp(option->name, name) != 0)
            continue;
        if (option->kind == ARGS_FLAG) {
            if (value)
                return args_complain(command, "--%s takes no value", name);
            *(bool *)((char *)w->options + option->offset) = true;
            return ARGS_RUN;
        }
        if (!value && w->next < w->argc)
            value = w->argv[w->next++];
        if (!value)
            return args_complain(command, "--%s needs a value", name);
        return store(command, option, value, w->options);
    }
    return unknown_option(command, name);
}

/* A word of one dash: flags, of which the last may be an option with value. */
static args_result short_options(words *w, const char *word)
{
    const args_command *command = w->command;

    for (; *word; word++) {
        const args_option *option = NULL;
        for (size_t i = 0; i < command->option_count; i++)
            if (command->options[i].letter == *word)
                option = &command->options[i];
        if (*word == 'h' && !option)
            return print_help(command, false);
        if (!option)
            return args_complain(command, "unknown option '-%c'", *word);
        if (option->kind == ARGS_FLAG) {
            *(bool *)((char *)w->options + option->offset) = true;
            continue;
        }
        const char *value = word[1] ? word + 1 : NULL;
        if (!value && w->next < w->argc)
            value = w->argv[w->next++];
        if (!value)
            return args_complain(command, "-%c needs a value", *word);
        return store(command, option, value, w->options);
    }
    return ARGS_RUN;
}

args_result args_parse(const args_command *command, int argc, char **argv,
                       void *options, int *operand_count)
{
    words w = { .command = command, .argv = argv, .argc = argc, .next = 1,
                .options = options };
    bool options_ended = false;

    *operand_count = 0;
    while (w.next < argc) {
        char *word = argv[w.next++];
        args_result result = ARGS_RUN;
        if (options_ended || word[0] != '-' || word[1] == '\0')
            argv[(*operand_count)++] = word;
        else if (strcmp(word, "--") == 0)
            options_ended = true;
        else if (word[1] == '-')
            result = long_option(&w, word + 2);
        else
            result = short_options(&w, word + 1);
        if (result != ARGS_RUN)
            return result;
    }
    return ARGS_RUN;
}
