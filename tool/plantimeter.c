/* tool/plantimeter.c: the program's entry: finds the sub-command and runs it. */
#include "tool/command.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* What was printed may not have arrived: a full disk shows only when the buffer is written. */
static int close_output(int code)
{
    if (fclose(stdout) == 0) return code;
    perror("plantimeter: standard output");
    return PLM_EXIT_OUTPUT;
}

/* A thread that waits for others spins, in libgomp, for some 15 ms before it sleeps. Where other programs want the processors
 * too, those it waits for may not run meanwhile, and a plant takes ten times as long. libgomp reads its environment before
 * main, so the program begins anew with a better one; where it cannot, it goes on as it is. */
static void let_waiting_threads_sleep(char **argv)
{
    if (getenv("OMP_WAIT_POLICY") || getenv("GOMP_SPINCOUNT")) return; /* the user's, or this was done */
    if (setenv("GOMP_SPINCOUNT", "1000", 1) == 0) execv("/proc/self/exe", argv);
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
    let_waiting_threads_sleep(argv);
    const plm_command *command = plm_command_find(argv[1]);
    if (command) return close_output(command->run(argc - 1, argv + 1));
    char help[] = "help"; /* it knows the nearest name */
    char *words[] = {help, argv[1], NULL};
    return argv[1][0] == '-' ? plm_usage_error(NULL, "unknown option %s", argv[1]) : plm_command_help.run(2, words);
}
