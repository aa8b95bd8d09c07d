/* tool/manual.c: the manual page and the completion for bash, from the tables of commands, options and traits. */
#include "tool/command.h"
#include "traits/traits.h"

#include <stdio.h>
#include <string.h>

/* Roff takes `-` for a hyphen, and `.` or `'` at the start of a line for a request. */
static void print_roff(const char *text)
{
    bool at_start = true;
    for (; *text; text++) {
        if (at_start && (*text == '.' || *text == '\'')) fputs("\\&", stdout);
        if (*text == '\n' && text[1] == '\n') {
            fputs("\n.PP", stdout);
            continue;
        }
        if (*text == '-' || *text == '\\') putchar('\\');
        putchar(*text == '\\' ? 'e' : *text);
        at_start = *text == '\n';
    }
    putchar('\n');
}

static void print_roff_option(const plm_option *option)
{
    printf(".TP\n");
    if (option->letter) printf("\\fB\\-%c\\fR, ", option->letter);
    printf("\\fB\\-\\-%s\\fR", option->name);
    if (option->argument) printf(" \\fI%s\\fR", option->argument);
    putchar('\n');
    print_roff(option->help);
}

static void print_roff_command(const plm_command *command)
{
    printf(".SS plantimeter %s ", command->name);
    print_roff(command->arguments);
    print_roff(command->summary);
    if (command->description) {
        printf(".PP\n");
        print_roff(command->description);
    }
    for (size_t i = 0; i < plm_option_total(command); i++) print_roff_option(plm_option_at(command, i));
}

void plm_print_manual(void)
{
    printf(".TH PLANTIMETER 1 \"\" \"Plantimeter %s\" \"User Commands\"\n"
           ".SH NAME\nplantimeter \\- measures standing plants from 3D point clouds\n"
           ".SH SYNOPSIS\n.B plantimeter\n.I COMMAND\n[\\fIOPTION\\fR]... [\\fIARGUMENT\\fR]...\n"
           ".SH DESCRIPTION\n",
           PLM_VERSION);
    print_roff("Measures plants in point clouds (PLY, 3D Gaussian splats, PCD, text, LAS): height, leaf area and "
               "inclination, stem diameter and more, each with its standard error. Options may be shortened to "
               "unambiguous beginnings; \"-\" is standard input.");
    printf(".SH COMMANDS\n");
    size_t count;
    const plm_command *const *commands = plm_commands(&count);
    for (size_t i = 0; i < count; i++) print_roff_command(commands[i]);
    printf(".SH EXIT STATUS\n.TP\n0\nall went well\n.TP\n1\nsome plant failed; its row in the tables says why\n"
           ".TP\n2\nwrong usage\n.TP\n3\nbad input\n.TP\n4\nthe output cannot be written\n"
           ".SH COPYRIGHT\nGPL\\-3.0\\-or\\-later\n");
}

static void print_completion_of(const plm_command *command)
{
    printf("        %s)\n            case $previous in\n", command->name);
    for (size_t i = 0; i < plm_option_total(command); i++) {
        const plm_option *option = plm_option_at(command, i);
        if (option->kind == PLM_OPTION_CHOICE) {
            printf("                --%s) words=\"", option->name);
            for (const char *at = option->argument; *at; at++) putchar(*at == '|' ? ' ' : *at);
            printf("\" ;;\n");
        } else if (!strcmp(option->name, "traits")) {
            printf("                --traits) words=$traits ;;\n");
        }
    }
    printf("                *) words=\"--help");
    for (size_t i = 0; i < plm_option_total(command); i++) printf(" --%s", plm_option_at(command, i)->name);
    printf("\" ;;\n            esac ;;\n");
}

void plm_print_completion(void)
{
    size_t command_count, trait_count;
    const plm_command *const *commands = plm_commands(&command_count);
    const plm_trait *traits = plm_traits(&trait_count);
    printf(
        "# Completion of plantimeter %s for bash; printed by `plantimeter help --completion`.\n"
        "_plantimeter()\n{\n    local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]} words=\n"
        "    local traits=\"",
        PLM_VERSION);
    for (size_t i = 0; i < trait_count; i++) printf("%s%s", i ? " " : "", traits[i].name);
    printf("\"\n    if [ \"$COMP_CWORD\" -eq 1 ]; then\n        words=\"--help --version");
    for (size_t i = 0; i < command_count; i++) printf(" %s", commands[i]->name);
    printf("\"\n        COMPREPLY=($(compgen -W \"$words\" -- \"$current\"))\n        return\n    fi\n"
           "    case ${COMP_WORDS[1]} in\n");
    for (size_t i = 0; i < command_count; i++) print_completion_of(commands[i]);
    printf("    esac\n    case $current in\n        -*) COMPREPLY=($(compgen -W \"$words\" -- \"$current\")) ;;\n"
           "        *) case $previous in\n"
           "               -*) COMPREPLY=($(compgen -W \"$words\" -- \"$current\") $(compgen -f -- \"$current\")) ;;\n"
           "               *) COMPREPLY=($(compgen -f -- \"$current\")) ;;\n           esac ;;\n    esac\n}\n"
           "complete -o filenames -F _plantimeter plantimeter\n");
}
