/* tool/help.c: --help of the program and of each command, from the tables. */
#include "tool/command.h"

#include <stdio.h>
#include <string.h>

enum { WIDTH = 80, HELP_COLUMN = 26 };

/* Prints words, wrapped at WIDTH, every line but the first behind indent blanks. column: where the cursor is. */
static void print_wrapped(const char *text, int indent, int column)
{
    while (*text) {
        const int length = (int)strcspn(text, " \n");
        if (column > indent && column + 1 + length > WIDTH) {
            printf("\n%*s", indent, "");
            column = indent;
        } else if (column > indent) {
            putchar(' ');
            column++;
        }
        printf("%.*s", length, text);
        column += length;
        text += length;
        if (text[0] == '\n' && text[1] == '\n') {
            printf("\n\n%*s", indent, "");
            column = indent;
        }
        while (*text == ' ' || *text == '\n') text++;
    }
    putchar('\n');
}

static void print_option(const plm_option *option)
{
    int column =
        option->letter ? printf("  -%c, --%s", option->letter, option->name) : printf("      --%s", option->name);
    if (option->argument) column += printf(" %s", option->argument);
    if (column + 2 > HELP_COLUMN) {
        putchar('\n');
        column = 0;
    }
    printf("%*s", HELP_COLUMN - column, "");
    print_wrapped(option->help, HELP_COLUMN, HELP_COLUMN);
}

void plm_print_help(const plm_command *command)
{
    printf("Usage: plantimeter %s %s\n", command->name, command->arguments);
    print_wrapped(command->summary, 0, 0);
    if (command->description) {
        putchar('\n');
        print_wrapped(command->description, 0, 0);
    }
    printf("\nOptions:\n");
    for (size_t i = 0; i < command->option_count; i++) print_option(&command->options[i]);
    if (command->shared_count) printf("\nOptions about the input:\n");
    for (size_t i = 0; i < command->shared_count; i++) print_option(&command->shared[i]);
    printf("\n");
    const plm_option help = {.letter = 'h', .name = "help", .help = "print this help", .kind = PLM_OPTION_FLAG};
    print_option(&help);
}

void plm_print_overview(void)
{
    size_t count;
    const plm_command *const *commands = plm_commands(&count);
    printf("Usage: plantimeter COMMAND [OPTION]... [ARGUMENT]...\n"
           "Measures standing plants from 3D point clouds.\n\nCommands:\n");
    for (size_t i = 0; i < count; i++) {
        printf("  %-12s", commands[i]->name);
        print_wrapped(commands[i]->summary, 14, 14);
    }
    printf("\n`plantimeter COMMAND --help` tells more; `plantimeter --version` tells the version.\n"
           "Exit codes: 0 good, 1 some plant failed or fell short, 2 wrong usage, 3 bad input, 4 cannot write.\n");
}
