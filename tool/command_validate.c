/* tool/command_validate.c: the `validate` sub-command: a run's traits against manual measurements. */
#include "tool/agreement_run.h"

#include "reports/agreement.h"

#include <stdio.h>

static const plm_option options[] = {
    AGREEMENT_OPTIONS,
    {.name = "match",
     .argument = "auto|id|position|rank",
     .help =
         "how organs are paired: by number, by the nearest centroids one-to-one, by rank of their values (only when "
         "asked for); auto: by number where the manual table has numbers, else by position",
     .kind = PLM_OPTION_CHOICE,
     .offset = offsetof(agreement_settings, match)},
    {.name = "manual-angle",
     .argument = "zenith|horizontal|stem",
     .help = "what the manual inclinations were taken against (ours: zenith)",
     .kind = PLM_OPTION_CHOICE,
     .offset = offsetof(agreement_settings, manual_angle)},
    {.name = "statistics",
     .help = "print docs/statistics.md: the definition of every statistic",
     .kind = PLM_OPTION_FLAG,
     .offset = offsetof(agreement_settings, statistics)},
};

static void print_statistics(void)
{
    puts("# Statistics of agreement\n\n"
         "p is the estimate, m the manual value, d = p - m. Printed by `plantimeter validate --statistics`. Intervals "
         "are "
         "at 95 %;\n"
         "BCa intervals draw plants whole. What cannot be computed comes with a reason, never as a number.\n\n"
         "| statistic | definition and source |\n|---|---|");
    for (int id = 0; id < PLM_STAT_COUNT; id++) {
        const plm_statistic_row *row = plm_statistic_describe((plm_statistic_id)id);
        printf("| %s | ", row->name);
        for (const char *c = row->definition; *c; c++) {
            if (*c == '|') putchar('\\');
            putchar(*c);
        }
        puts(" |");
    }
    puts("| manual_sd_within, manual_icc | repeatability of repeated manual readings: within-subject SD and ICC(1) "
         "(Shrout and "
         "Fleiss 1979) |\n"
         "| coverage_95 | share of pairs whose estimate +- 1.96 standard errors holds the manual value |");
}

static int run(int argc, char **argv)
{
    agreement_settings settings = AGREEMENT_DEFAULTS;
    const int usage = plm_parse_options(&plm_command_validate, &argc, argv, &settings);
    if (usage >= 0) return usage;
    if (settings.statistics) {
        print_statistics();
        return PLM_EXIT_GOOD;
    }
    if (argc != 2) return plm_usage_error(&plm_command_validate, "TRAITS.csv and MANUAL.csv were expected");
    return agreement_run(&settings, argv[0], argv[1]);
}

const plm_command plm_command_validate = {
    .name = "validate",
    .arguments = "[OPTION]... TRAITS.csv MANUAL.csv",
    .summary = "compare measured traits with manual measurements",
    .description =
        "Pairs the rows of a run's traits.csv with manual readings (columns plant_id, organ, organ_id, trait, value, "
        "unit; "
        "Field Book's database export is read too), converts units, averages repeated readings, and gives R2, RMSE, "
        "rRMSE, MAPE, bias, limits of agreement, concordance, Deming and Passing-Bablok regression and tests, each "
        "with its interval, for each trait and group.",
    .options = options,
    .option_count = COUNT(options),
    .run = run,
};
