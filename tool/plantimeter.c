/* tool/plantimeter.c: the program's entry: finds the sub-command and runs it. */
#include "tool/command.h"

#include <stdio.h>
#include <string.h>

/* What was printed may not have arrived: a full disk shows only when the buffer is written. */
static int close_output(int code)
{
    if (fclose(stdout) == 0) return code;
    perror("plantimeter: standard output");
    return PLM_EXIT_OUTPUT;
}

int main(int argc, char **argv)
{
    if (argc < 2) {
        plm_usage_error(NULL, "a command is missing");
        return PLM_EXIT_USAGE;
    }
    if (!strcmp(argv[1], "--version") || !strcmp(argv[1], "-V")) {
        puts("plantimeter " PLM_VERSION);
        if (PLM_LEFT_OUT[0]) puts("left out of this build: " PLM_LEFT_OUT);
        return close_output(PLM_EXIT_GOOD);
    }
    if (!strcmp(argv[1], "--help") || !strcmp(argv[1], "-h")) {
        plm_print_overview();
        return close_output(PLM_EXIT_GOOD);
    }
    const plm_command *command = plm_command_find(argv[1]);
    if (command) return close_output(command->run(argc - 1, argv + 1));
    char help[] = "help"; /* it knows the nearest name */
    char *words[] = {help, argv[1], NULL};
    return argv[1][0] == '-' ? plm_usage_error(NULL, "unknown option %s", argv[1]) : plm_command_help.run(2, words);
}
