/* tool/command_compare.c: the `compare` sub-command: two runs of the same plants against each other. */
#include "tool/agreement_run.h"

static const plm_option options[] = {AGREEMENT_OPTIONS};

static int run(int argc, char **argv)
{
    agreement_settings settings = AGREEMENT_DEFAULTS;
    const int usage = plm_parse_options(&plm_command_compare, &argc, argv, &settings);
    if (usage >= 0) return usage;
    if (argc != 2) return plm_usage_error(&plm_command_compare, "two traits.csv were expected");
    return agreement_run(&settings, argv[0], argv[1]);
}

const plm_command plm_command_compare = {
    .name = "compare",
    .arguments = "[OPTION]... A.csv B.csv",
    .summary = "compare two runs of the same plants (versions, settings)",
    .description =
        "The statistics of `validate` with the second run in the place of the manual readings. With --fail-if it is a "
        "gate for scripts.",
    .options = options,
    .option_count = COUNT(options),
    .run = run,
};
