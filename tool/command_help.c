/* tool/command_help.c: the `help` sub-command: help by name, the manual page, the completion. */
#include "tool/command.h"

#include "cloud/nearest_name.h"

#include <stdio.h>

typedef struct help_settings {
    bool manual, completion;
} help_settings;

static const plm_option options[] = {
    {.name = "man",
     .help = "print the manual page (roff)",
     .kind = PLM_OPTION_FLAG,
     .offset = offsetof(help_settings, manual)},
    {.name = "completion",
     .help = "print the completion for bash",
     .kind = PLM_OPTION_FLAG,
     .offset = offsetof(help_settings, completion)},
};

static const char *command_name(const void *table, size_t i)
{
    return ((const plm_command *const *)table)[i]->name;
}

static int unknown_command(const char *name)
{
    size_t count;
    const plm_command *const *commands = plm_commands(&count);
    const char *nearest = plm_nearest_name(name, command_name, commands, count);
    if (nearest) return plm_usage_error(NULL, "unknown command \"%s\"; did you mean \"%s\"?", name, nearest);
    return plm_usage_error(NULL, "unknown command \"%s\"", name);
}

static int run(int argc, char **argv)
{
    help_settings settings = {0};
    const int code = plm_parse_options(&plm_command_help, &argc, argv, &settings);
    if (code >= 0) return code;
    if (argc > 1) return plm_usage_error(&plm_command_help, "one command at a time; found %d", argc);
    if (settings.manual) {
        plm_print_manual();
    } else if (settings.completion) {
        plm_print_completion();
    } else if (argc == 0) {
        plm_print_overview();
    } else {
        const plm_command *command = plm_command_find(argv[0]);
        if (!command) return unknown_command(argv[0]);
        plm_print_help(command);
    }
    return PLM_EXIT_GOOD;
}

const plm_command plm_command_help = {.name = "help",
                                      .arguments = "[OPTION]... [COMMAND]",
                                      .summary = "help on a command, the manual page, the completion for bash",
                                      .options = options,
                                      .option_count = COUNT(options),
                                      .run = run};
