/* tool/options_json.c: a command's options as JSON, from its table: what run.json keeps, and what tells whether results of
 * an earlier run are of the same options. */
#include "reports/run_json.h"
#include "tool/command.h"

#include <string.h>

/* The word of a choice. */
static json_t *choice_json(const char *words, int place)
{
    for (; place > 0 && *words; place--) words += strcspn(words, "|") + 1;
    return json_stringn(words, strcspn(words, "|"));
}

static json_t *texts_json(const plm_texts *texts)
{
    json_t *array = json_array();
    bool is_complete = array != NULL;
    for (int i = 0; i < texts->count; i++)
        is_complete &= json_array_append_new(array, json_string(texts->text[i])) == 0;
    if (is_complete) return array;
    json_decref(array);
    return NULL;
}

static json_t *value_json(const plm_option *option, const void *field)
{
    const char *text = NULL;
    switch (option->kind) {
        case PLM_OPTION_FLAG:
            return json_boolean(*(const bool *)field);
        case PLM_OPTION_TEXT:
            text = *(const char *const *)field;
            return text ? json_string(text) : json_null();
        case PLM_OPTION_TEXTS:
            return texts_json(field);
        case PLM_OPTION_NUMBER:
        case PLM_OPTION_LENGTH:
        case PLM_OPTION_DURATION:
            return json_real(*(const double *)field);
        case PLM_OPTION_INTEGER:
            return json_integer(*(const int *)field);
        case PLM_OPTION_SEED:
            return json_integer((json_int_t)(*(const uint64_t *)field & INT64_MAX));
        case PLM_OPTION_CHOICE:
            return choice_json(option->argument, *(const int *)field);
    }
    return NULL;
}

plm_status plm_options_json(const plm_command *command, void *settings, json_t **object, plm_error *error)
{
    plm_json_use_seam();
    json_t *made = json_object();
    bool is_complete = made;
    for (size_t i = 0; i < plm_option_total(command); i++) {
        const plm_option *option = plm_option_at(command, i);
        if (option->changes_nothing) continue;
        json_t *value = value_json(option, plm_option_field(command, option, settings));
        if (!value && option->kind == PLM_OPTION_TEXT && made) {
            json_decref(made);
            return plm_fail(error, PLM_E_ARGUMENT, "the value of --%s is no UTF-8", option->name);
        }
        is_complete &= json_object_set_new(made, option->name, value) == 0;
    }
    if (!is_complete) {
        json_decref(made);
        made = NULL;
    }
    *object = made;
    return plm_json_check(made, error);
}
