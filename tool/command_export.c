/* tool/command_export.c: the `export` sub-command: a run in the formats of breeders' systems. */
#include "tool/command.h"

#include "reports/export.h"

#include <stdio.h>
#include <string.h>

typedef struct export_settings {
    const char *output, *metadata, *ontology, *study, *time;
    int format;
    bool mapping, quiet;
} export_settings;

static const plm_option options[] = {
    {.letter = 'o',
     .name = "output",
     .argument = "DIR",
     .help = "write a folder for each format here (required)",
     .kind = PLM_OPTION_TEXT,
     .offset = offsetof(export_settings, output)},
    {.name = "format",
     .argument = "all|fieldbook|brapi|miappe|frictionless|statgen",
     .help =
         "fieldbook: trait file, field file, table and database export of Field Book; brapi: observations, units and "
         "variables of BrAPI v2.1; miappe: sheets of MIAPPE 1.2; frictionless: the tables as a data package; statgen: "
         "the table that R's statgenHTP loads (default: all)",
     .kind = PLM_OPTION_CHOICE,
     .offset = offsetof(export_settings, format)},
    {.name = "metadata",
     .argument = "CSV",
     .help = "table of the plants: plant_id and, where known, genotype (or germplasm, variety, accession), row, "
             "column, rep, "
             "plot, treatment, study, timestamp; all columns go into the Field Book table",
     .kind = PLM_OPTION_TEXT,
     .offset = offsetof(export_settings, metadata)},
    {.name = "ontology",
     .argument = "CSV",
     .help =
         "ontology terms that add to the shipped mapping or override it: trait and any of trait_accession, trait_name, "
         "entity, entity_accession, characteristic, variable_id, hand_variable_id, note",
     .kind = PLM_OPTION_TEXT,
     .offset = offsetof(export_settings, ontology)},
    {.name = "study",
     .argument = "ID",
     .help = "id of the study, where the metadata name none",
     .kind = PLM_OPTION_TEXT,
     .offset = offsetof(export_settings, study)},
    {.name = "time",
     .argument = "TIME",
     .help = "when the plants were scanned, such as 2026-05-02T09:30:00Z, where the metadata have no timestamp or date",
     .kind = PLM_OPTION_TEXT,
     .offset = offsetof(export_settings, time)},
    {.name = "mapping",
     .help = "print the shipped mapping of traits to ontology terms, to extend it",
     .kind = PLM_OPTION_FLAG,
     .offset = offsetof(export_settings, mapping)},
    {.letter = 'q',
     .name = "quiet",
     .help = "print nothing but errors",
     .kind = PLM_OPTION_FLAG,
     .offset = offsetof(export_settings, quiet)},
};

/** In the order of the words of --format, behind `all`. */
static const struct format_row {
    const char *folder;
    plm_status (*write)(const plm_export *bundle, const char *folder, plm_error *error);
} formats[] = {{"fieldbook", plm_export_field_book},
               {"brapi", plm_export_brapi},
               {"miappe", plm_export_miappe},
               {"frictionless", plm_export_frictionless},
               {"statgen", plm_export_statgen}};

static plm_status write_formats(const plm_export *bundle, const export_settings *settings, plm_error *error)
{
    plm_status status = PLM_OK;
    for (int i = 0; i < (int)COUNT(formats) && status == PLM_OK; i++) {
        char folder[4096];
        if (settings->format && settings->format != i + 1) continue;
        if ((size_t)snprintf(folder, sizeof folder, "%s/%s", settings->output, formats[i].folder) >= sizeof folder)
            return plm_fail(error, PLM_E_WRITE, "the folder's name is too long");
        status = plm_folder_make(folder, error);
        if (status == PLM_OK) status = formats[i].write(bundle, folder, error);
        if (status == PLM_OK && !settings->quiet) printf("%s\n", folder);
    }
    return status;
}

static int run(int argc, char **argv)
{
    export_settings settings = {0};
    const int usage = plm_parse_options(&plm_command_export, &argc, argv, &settings);
    if (usage >= 0) return usage;
    if (settings.mapping) {
        fputs(plm_export_mapping(), stdout);
        return PLM_EXIT_GOOD;
    }
    if (argc != 1) return plm_usage_error(&plm_command_export, "one folder of a run was expected; found %d", argc);
    if (!settings.output) return plm_usage_error(&plm_command_export, "-o DIR is missing");
    const plm_export_options how = {
        .metadata = settings.metadata, .ontology = settings.ontology, .study = settings.study, .time = settings.time};
    plm_error error = {0};
    plm_export bundle;
    plm_status status = plm_export_open(&bundle, argv[0], &how, &error);
    if (status == PLM_OK) {
        status = write_formats(&bundle, &settings, &error);
        plm_export_close(&bundle);
    }
    return status == PLM_OK ? PLM_EXIT_GOOD : plm_report_failure(status, &error);
}

const plm_command plm_command_export = {
    .name = "export",
    .arguments = "[OPTION]... -o DIR RUN",
    .summary = "write a run for breeders' systems: Field Book, BrAPI, MIAPPE, Frictionless, statgenHTP",
    .description = "RUN is the folder of `measure -o RUN`. Plants are the units of observation: exported are the "
                   "traits of the plant and "
                   "those of its main stem; leaves stay in traits.csv. A trait measured from a point cloud is another "
                   "variable than the "
                   "same trait measured by hand: its variable id is its own.",
    .options = options,
    .option_count = COUNT(options),
    .run = run,
};
