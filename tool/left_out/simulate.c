/* tool/left_out/simulate.c: stands in for the sub-commands that need virtual plants or light, in a build without them
 * (PLANTIMETER_SIMULATE=OFF): they stay in the help, and say why they do nothing. */
#include "tool/command.h"

#include <stdio.h>

static int run(int argc, char **argv)
{
    (void)argc;
    fprintf(stderr, "plantimeter %s: left out of this build (PLANTIMETER_SIMULATE=OFF)\n", argv[0]);
    return PLM_EXIT_USAGE;
}

const plm_command plm_command_simulate = {
    .name = "simulate", .arguments = "...", .summary = "left out of this build: virtual plants", .run = run};
const plm_command plm_command_light = {
    .name = "light", .arguments = "...", .summary = "left out of this build: absorbed light", .run = run};
const plm_command plm_command_study = {
    .name = "study", .arguments = "...", .summary = "left out of this build: lost geometry", .run = run};
