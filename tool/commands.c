/* tool/commands.c: the table of sub-commands, in the order of the help. */
#include "tool/command.h"

#include <string.h>

static const plm_command *const commands[] = {
    &plm_command_measure,  //
    &plm_command_plan,     //
    &plm_command_info,     //
    &plm_command_traits,   //
    &plm_command_validate, //
    &plm_command_compare,  //
    &plm_command_report,   //
    &plm_command_export,   //
    &plm_command_series,   //
    &plm_command_simulate, //
    &plm_command_light,    //
    &plm_command_study,    //
    &plm_command_tradeoff, //
    &plm_command_selftest, //
    &plm_command_help,
};

const plm_command *const *plm_commands(size_t *count)
{
    *count = COUNT(commands);
    return commands;
}

const plm_command *plm_command_find(const char *name)
{
    for (size_t i = 0; i < COUNT(commands); i++)
        if (!strcmp(commands[i]->name, name)) return commands[i];
    return NULL;
}
