/* tool/command_traits.c: the `traits` sub-command: the table of traits, for people, for Markdown and for programs. */
#include "tool/command.h"
#include "traits/traits.h"

#include <jansson.h>
#include <stdio.h>

typedef struct traits_settings {
    bool markdown, json;
} traits_settings;

static const plm_option options[] = {
    {.name = "markdown",
     .help = "print docs/traits.md",
     .kind = PLM_OPTION_FLAG,
     .offset = offsetof(traits_settings, markdown)},
    {.name = "json",
     .help = "print one JSON object",
     .kind = PLM_OPTION_FLAG,
     .offset = offsetof(traits_settings, json)},
};

static void print_text(const plm_trait *trait, size_t count)
{
    printf("%-28s %-8s %-4s %s\n", "trait", "level", "unit", "definition");
    for (size_t i = 0; i < count; i++)
        printf("%-28s %-8s %-4s %s (%s)\n", trait[i].name, plm_level_name(trait[i].level), plm_unit_name(trait[i].unit),
               trait[i].definition, trait[i].source);
}

/* A bar inside a cell would end it. */
static void print_cell(const char *text)
{
    for (; *text; text++) {
        if (*text == '|') putchar('\\');
        putchar(*text);
    }
}

static void print_markdown(const plm_trait *trait, size_t count)
{
    printf("# Traits\n\n"
           "Printed by `plantimeter traits --markdown` from the table that measures them. Every value comes with its\n"
           "unit, its standard error and its status. Angles are from the zenith unless the definition says otherwise.\n"
           "A trait that a scene cannot give is `not_applicable` with its reason, never 0.\n");
    for (int level = 0; level < PLM_LEVEL_COUNT; level++) {
        printf("\n## Traits of a %s\n\n| trait | unit | definition | source | ontology |\n|---|---|---|---|---|\n",
               plm_level_name((plm_level)level));
        for (size_t i = 0; i < count; i++) {
            if (trait[i].level != (plm_level)level) continue;
            printf("| `%s` | %s | ", trait[i].name, plm_unit_name(trait[i].unit));
            print_cell(trait[i].definition);
            printf(" | ");
            print_cell(trait[i].source);
            printf(" | %s |\n", trait[i].ontology);
        }
    }
}

static int print_json(const plm_trait *trait, size_t count)
{
    json_t *rows = json_array();
    for (size_t i = 0; rows && i < count; i++)
        json_array_append_new(rows, json_pack("{s:s, s:s, s:s, s:s, s:s, s:s}", "trait", trait[i].name, "level",
                                              plm_level_name(trait[i].level), "unit", plm_unit_name(trait[i].unit),
                                              "definition", trait[i].definition, "source", trait[i].source, "ontology",
                                              trait[i].ontology));
    json_t *root = json_pack("{s:s, s:o}", "version", PLM_VERSION, "traits", rows);
    const int failed = !root || json_dumpf(root, stdout, JSON_INDENT(1)) != 0;
    putchar('\n');
    json_decref(root);
    return failed ? PLM_EXIT_OUTPUT : PLM_EXIT_GOOD;
}

static int run(int argc, char **argv)
{
    traits_settings settings = {0};
    const int code = plm_parse_options(&plm_command_traits, &argc, argv, &settings);
    if (code >= 0) return code;
    if (argc > 0) return plm_usage_error(&plm_command_traits, "unexpected argument \"%s\"", argv[0]);
    size_t count;
    const plm_trait *trait = plm_traits(&count);
    if (settings.json) return print_json(trait, count);
    if (settings.markdown)
        print_markdown(trait, count);
    else
        print_text(trait, count);
    return PLM_EXIT_GOOD;
}

const plm_command plm_command_traits = {.name = "traits",
                                        .arguments = "[OPTION]...",
                                        .summary = "list the traits with unit, definition and source",
                                        .options = options,
                                        .option_count = COUNT(options),
                                        .run = run};
