/* tool/command.h: sub-commands and their options as tables. The parser, --help, the manual page and the completion are
 * all made from them, so none can be forgotten. A sub-command is one file command_NAME.c with one plm_command, listed in
 * tool/commands.c. */
#ifndef PLANTIMETER_TOOL_COMMAND_H
#define PLANTIMETER_TOOL_COMMAND_H

#include "cloud/cloud.h"

#include <jansson.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))

/** What the program's exit codes mean. */
typedef enum plm_exit {
    PLM_EXIT_GOOD = 0,
    PLM_EXIT_SOME_FAILED = 1,
    PLM_EXIT_USAGE = 2,
    PLM_EXIT_INPUT = 3,
    PLM_EXIT_OUTPUT = 4
} plm_exit;

/** What an option's value is, and what lies at its offset in the command's settings. */
typedef enum plm_option_kind {
    PLM_OPTION_FLAG = 0, /**< no value; bool, set to true */
    PLM_OPTION_TEXT,     /**< const char * into argv */
    PLM_OPTION_NUMBER,   /**< double from minimum to maximum */
    PLM_OPTION_INTEGER,  /**< int from minimum to maximum */
    PLM_OPTION_SEED,     /**< uint64_t */
    PLM_OPTION_LENGTH,   /**< double, metres: a number with the suffix m, cm or mm (none: m), from minimum to maximum */
    PLM_OPTION_DURATION, /**< double, seconds: a number with the suffix ms, s or min (none: s), above 0 */
    PLM_OPTION_TEXTS,    /**< plm_texts: as PLM_OPTION_TEXT, but the option may come several times */
    PLM_OPTION_CHOICE    /**< int: place of the value among the words of `argument`, which are separated by | */
} plm_option_kind;

/** The values of an option that may come several times: into argv. */
typedef struct plm_texts {
    int count;
    const char *text[8];
} plm_texts;

/** One option of a command. */
typedef struct plm_option {
    char letter;          /**< 0: long name only */
    const char *name;     /**< without the dashes */
    const char *argument; /**< what the help calls the value; the words of a choice; NULL for a flag */
    const char *help;
    plm_option_kind kind;
    size_t offset;           /**< of its field in the settings */
    double minimum, maximum; /**< of numbers, integers and lengths; both 0: any */
    bool changes_nothing;    /**< in the results: where they go, how many threads, what is told */
} plm_option;

/** One sub-command. */
typedef struct plm_command {
    const char *name, *arguments;
    const char *summary;     /**< one line */
    const char *description; /**< paragraphs for --help and the manual, separated by empty lines; may be NULL */
    const plm_option *options;
    size_t option_count;
    const plm_option *shared; /**< options that other commands have too; may be NULL */
    size_t shared_count;
    size_t shared_offset; /**< where their settings lie in the command's settings */
    /** argv[0] is the command's name. Gives the exit code. */
    int (*run)(int argc, char **argv);
} plm_command;

/** Options of a command, its own and the shared ones. */
size_t plm_option_total(const plm_command *command);
const plm_option *plm_option_at(const plm_command *command, size_t i);

/** Where an option's value lies in a command's settings. */
void *plm_option_field(const plm_command *command, const plm_option *option, void *settings);

/** The table of sub-commands. */
const plm_command *const *plm_commands(size_t *count);
const plm_command *plm_command_find(const char *name);

/** Reads the options of argv[1..argc) into settings (which hold the defaults) and moves the operands to the front:
 * argv[0..*argc) afterwards. GNU style: --name=value, --name value, unambiguous beginnings of names, -x value, -xvalue,
 * flags in one word, options behind operands, -- ends them, "-" is an operand. Gives -1 when the command should go on,
 * else the exit code: help was printed, or the usage is wrong and was told. */
int plm_parse_options(const plm_command *command, int *argc, char **argv, void *settings);

/** The options that change results, with their values, for run.json; the caller's. */
plm_status plm_options_json(const plm_command *command, void *settings, json_t **object, plm_error *error);

/** Reads a length as an option does: "20mm", "2 cm", "0.02". PLM_E_ARGUMENT says what was expected. */
plm_status plm_parse_length(const char *text, double *metres, plm_error *error);

/** Reads a time as an option does: "500ms", "2 s", "1.5min". PLM_E_ARGUMENT says what was expected. */
plm_status plm_parse_duration(const char *text, double *seconds, plm_error *error);

/** Reads a number, all of text. */
bool plm_parse_number(const char *text, double *number);

/** Prints the help of a command, or of the program. */
void plm_print_help(const plm_command *command);
void plm_print_overview(void);

/** Prints the manual page (roff) and the completion for bash. */
void plm_print_manual(void);
void plm_print_completion(void);

/** Tells the user that the usage is wrong, in printf style, and where help is. command may be NULL. Gives
 * PLM_EXIT_USAGE. */
int plm_usage_error(const plm_command *command, const char *format, ...) PLM_PRINTF(2, 3);

/** Tells of a failure: "plantimeter: MESSAGE". Gives the exit code that belongs to the status. */
int plm_report_failure(plm_status status, const plm_error *error);

/** The exit code of a status. */
plm_exit plm_exit_of(plm_status status);

extern const plm_command plm_command_measure, plm_command_plan, plm_command_info, plm_command_traits, plm_command_help,
    plm_command_simulate, plm_command_light, plm_command_study, plm_command_validate, plm_command_compare,
    plm_command_report, plm_command_export, plm_command_series, plm_command_selftest, plm_command_tradeoff;

#endif
