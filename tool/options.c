/* tool/options.c: the parser of options, driven by a command's table. Not getopt_long: it prints messages of its own,
 * and cannot say which option was probably meant. */
#include "cloud/nearest_name.h"
#include "tool/command.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

plm_exit plm_exit_of(plm_status status)
{
    switch (status) {
        case PLM_OK:
            return PLM_EXIT_GOOD;
        case PLM_E_ARGUMENT:
            return PLM_EXIT_USAGE;
        case PLM_E_READ:
        case PLM_E_FORMAT:
        case PLM_E_DEGENERATE:
            return PLM_EXIT_INPUT;
        case PLM_E_WRITE:
            return PLM_EXIT_OUTPUT;
        default:
            return PLM_EXIT_SOME_FAILED;
    }
}

int plm_report_failure(plm_status status, const plm_error *error)
{
    fprintf(stderr, "plantimeter: %s\n", error->message[0] ? error->message : plm_status_name(status));
    return (int)plm_exit_of(status);
}

int plm_usage_error(const plm_command *command, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fprintf(stderr, "plantimeter%s%s: ", command ? " " : "", command ? command->name : "");
    vfprintf(stderr, format, arguments);
    fprintf(stderr, "\nTry `plantimeter %s%s--help`.\n", command ? command->name : "", command ? " " : "");
    va_end(arguments);
    return PLM_EXIT_USAGE;
}

/* ---- Values ---------------------------------------------------------------------------------------------------- */

bool plm_parse_number(const char *text, double *number)
{
    char *end;
    const double value = strtod(text, &end);
    if (end == text || *end || !isfinite(value)) return false;
    *number = value;
    return true;
}

typedef struct suffix {
    const char *name;
    double factor;
} suffix;

/* A number with one of the suffixes. */
static bool parse_with_suffix(const char *text, const suffix *suffixes, size_t count, double *value)
{
    char *end;
    const double number = strtod(text, &end);
    if (end == text || !isfinite(number)) return false;
    while (*end == ' ') end++;
    for (size_t i = 0; i < count; i++)
        if (!strcmp(end, suffixes[i].name)) {
            *value = number * suffixes[i].factor;
            return true;
        }
    return false;
}

plm_status plm_parse_duration(const char *text, double *seconds, plm_error *error)
{
    static const suffix suffixes[] = {{"", 1}, {"s", 1}, {"ms", 1e-3}, {"min", 60}};
    double value;
    if (parse_with_suffix(text, suffixes, COUNT(suffixes), &value) && value > 0) {
        *seconds = value;
        return PLM_OK;
    }
    return plm_fail(error, PLM_E_ARGUMENT, "\"%s\" is no time; expected a number above 0 with ms, s or min, e.g. 500ms",
                    text);
}

plm_status plm_parse_length(const char *text, double *metres, plm_error *error)
{
    static const suffix suffixes[] = {{"", 1}, {"m", 1}, {"cm", 1e-2}, {"mm", 1e-3}};
    if (parse_with_suffix(text, suffixes, COUNT(suffixes), metres)) return PLM_OK;
    return plm_fail(error, PLM_E_ARGUMENT, "\"%s\" is no length; expected a number with m, cm or mm, e.g. 20mm", text);
}

static plm_status check_range(const plm_option *option, const char *text, double value, plm_error *error)
{
    const bool any = option->minimum == 0 && option->maximum == 0;
    if (any || (value >= option->minimum && value <= option->maximum)) return PLM_OK;
    const char *unit = option->kind == PLM_OPTION_LENGTH ? " m" : "";
    return plm_fail(error, PLM_E_ARGUMENT, "\"%s\" is out of range; expected %g%s to %g%s", text, option->minimum, unit,
                    option->maximum, unit);
}

static plm_status parse_integer(const plm_option *option, const char *text, int *field, plm_error *error)
{
    char *end;
    errno = 0;
    const long value = strtol(text, &end, 10);
    if (end == text || *end || errno || value < -1000000000 || value > 1000000000)
        return plm_fail(error, PLM_E_ARGUMENT, "\"%s\" is no whole number", text);
    *field = (int)value;
    return check_range(option, text, (double)value, error);
}

static plm_status parse_seed(const char *text, uint64_t *field, plm_error *error)
{
    char *end;
    errno = 0;
    const unsigned long long value = strtoull(text, &end, 10);
    if (end == text || *end || errno || *text == '-')
        return plm_fail(error, PLM_E_ARGUMENT, "\"%s\" is no whole number from 0 to 2^64 - 1", text);
    *field = value;
    return PLM_OK;
}

static plm_status parse_choice(const plm_option *option, const char *text, int *field, plm_error *error)
{
    const size_t length = strlen(text);
    int place = 0;
    for (const char *word = option->argument; word; place++) {
        const size_t word_length = strcspn(word, "|");
        if (word_length == length && !strncmp(word, text, length)) {
            *field = place;
            return PLM_OK;
        }
        word = word[word_length] ? word + word_length + 1 : NULL;
    }
    return plm_fail(error, PLM_E_ARGUMENT, "\"%s\" is none of %s", text, option->argument);
}

static plm_status append_text(const char *text, plm_texts *texts, plm_error *error)
{
    if ((size_t)texts->count == COUNT(texts->text))
        return plm_fail(error, PLM_E_ARGUMENT, "given more than %zu times", COUNT(texts->text));
    texts->text[texts->count++] = text;
    return PLM_OK;
}

static plm_status store(const plm_option *option, const char *text, void *field, plm_error *error)
{
    plm_status status = PLM_OK;
    switch (option->kind) {
        case PLM_OPTION_FLAG:
            *(bool *)field = true;
            return PLM_OK;
        case PLM_OPTION_TEXT:
            *(const char **)field = text;
            return PLM_OK;
        case PLM_OPTION_NUMBER:
            if (!plm_parse_number(text, field)) return plm_fail(error, PLM_E_ARGUMENT, "\"%s\" is no number", text);
            return check_range(option, text, *(double *)field, error);
        case PLM_OPTION_INTEGER:
            return parse_integer(option, text, field, error);
        case PLM_OPTION_SEED:
            return parse_seed(text, field, error);
        case PLM_OPTION_LENGTH:
            status = plm_parse_length(text, field, error);
            return status == PLM_OK ? check_range(option, text, *(double *)field, error) : status;
        case PLM_OPTION_DURATION:
            return plm_parse_duration(text, field, error);
        case PLM_OPTION_TEXTS:
            return append_text(text, field, error);
        case PLM_OPTION_CHOICE:
            return parse_choice(option, text, field, error);
    }
    return status;
}

/* ---- Names ----------------------------------------------------------------------------------------------------- */

size_t plm_option_total(const plm_command *command)
{
    return command->option_count + command->shared_count;
}

const plm_option *plm_option_at(const plm_command *command, size_t i)
{
    return i < command->option_count ? &command->options[i] : &command->shared[i - command->option_count];
}

static const char *option_name(const void *command, size_t i)
{
    return plm_option_at(command, i)->name;
}

/* The option of a long name of the given length: the name itself or an unambiguous beginning of it. NULL: told. */
static const plm_option *find_long(const plm_command *command, const char *name, size_t length)
{
    const plm_option *found = NULL;
    size_t found_count = 0;
    for (size_t i = 0; i < plm_option_total(command); i++) {
        const plm_option *option = plm_option_at(command, i);
        if (strncmp(option->name, name, length)) continue;
        if (strlen(option->name) == length) return option;
        found = option;
        found_count++;
    }
    if (found_count == 1) return found;
    char word[64];
    snprintf(word, sizeof word, "%.*s", (int)length, name);
    if (found_count > 1) {
        plm_usage_error(command, "option --%s is ambiguous", word);
        return NULL;
    }
    const char *nearest = plm_nearest_name(word, option_name, command, plm_option_total(command));
    if (nearest)
        plm_usage_error(command, "unknown option --%s; did you mean --%s?", word, nearest);
    else
        plm_usage_error(command, "unknown option --%s", word);
    return NULL;
}

static const plm_option *find_letter(const plm_command *command, char letter)
{
    for (size_t i = 0; i < plm_option_total(command); i++)
        if (plm_option_at(command, i)->letter == letter) return plm_option_at(command, i);
    plm_usage_error(command, "unknown option -%c", letter);
    return NULL;
}

void *plm_option_field(const plm_command *command, const plm_option *option, void *settings)
{
    const bool is_shared =
        command->shared_count && option >= command->shared && option < command->shared + command->shared_count;
    return (char *)settings + (is_shared ? command->shared_offset : 0) + option->offset;
}

/* ---- The command line ------------------------------------------------------------------------------------------ */

typedef struct parser {
    const plm_command *command;
    void *settings;
    int argc, at; /* at: the word being read */
    char **argv;
} parser;

static bool give(parser *p, const plm_option *option, const char *value)
{
    plm_error error = {0};
    if (option->kind != PLM_OPTION_FLAG && !value) {
        if (p->at + 1 >= p->argc) {
            plm_usage_error(p->command, "option --%s needs a value: %s", option->name, option->argument);
            return false;
        }
        value = p->argv[++p->at];
    }
    if (store(option, value, plm_option_field(p->command, option, p->settings), &error) == PLM_OK) return true;
    plm_usage_error(p->command, "--%s: %s", option->name, error.message);
    return false;
}

static bool read_long(parser *p, const char *word)
{
    const size_t length = strcspn(word, "=");
    const plm_option *option = find_long(p->command, word, length);
    if (!option) return false;
    const char *value = word[length] ? word + length + 1 : NULL;
    if (option->kind == PLM_OPTION_FLAG && value) {
        plm_usage_error(p->command, "option --%s takes no value", option->name);
        return false;
    }
    return give(p, option, value);
}

static bool read_letters(parser *p, const char *letters)
{
    while (*letters) {
        const plm_option *option = find_letter(p->command, *letters++);
        if (!option) return false;
        if (option->kind == PLM_OPTION_FLAG) {
            if (!give(p, option, NULL)) return false;
            continue;
        }
        return give(p, option, *letters ? letters : NULL);
    }
    return true;
}

int plm_parse_options(const plm_command *command, int *argc, char **argv, void *settings)
{
    parser p = {.command = command, .settings = settings, .argc = *argc, .argv = argv};
    int operands = 0;
    bool only_operands = false;
    for (p.at = 1; p.at < p.argc; p.at++) {
        char *word = argv[p.at];
        if (only_operands || word[0] != '-' || !word[1]) {
            argv[operands++] = word;
        } else if (!strcmp(word, "--")) {
            only_operands = true;
        } else if (!strcmp(word, "--help") || !strcmp(word, "-h")) {
            plm_print_help(command);
            return PLM_EXIT_GOOD;
        } else if (!(word[1] == '-' ? read_long(&p, word + 2) : read_letters(&p, word + 1))) {
            return PLM_EXIT_USAGE;
        }
    }
    *argc = operands;
    return -1;
}
