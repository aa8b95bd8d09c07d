/* selftest/checks.c: the table of checks, and its rows. */
#include "selftest/checks.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const char *plm_verdict_name(plm_verdict verdict)
{
    static const char *const names[PLM_VERDICT_COUNT] = {"within", "said why", "BEYOND"};
    return names[verdict];
}

size_t plm_check_defects(const plm_check_table *table)
{
    size_t defects = 0;
    for (size_t i = 0; i < table->count; i++) defects += table->check[i].verdict == PLM_VERDICT_BEYOND;
    return defects;
}

void plm_check_table_free(plm_check_table *table)
{
    if (!table) return;
    plm_free(table->check);
    *table = (plm_check_table){0};
}

void plm_check_scene(plm_checker *checker, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(checker->scene, sizeof checker->scene, format, arguments);
    va_end(arguments);
}

static void add_row(plm_checker *checker, const char *measure, plm_check row)
{
    plm_check_table *table = checker->table;
    if (checker->status != PLM_OK) return;
    if (table->count == table->room) {
        const size_t room = table->room ? 2 * table->room : 256;
        plm_check *grown = plm_realloc(table->check, room, sizeof *grown, checker->error);
        if (!grown) {
            checker->status = PLM_E_MEMORY;
            return;
        }
        table->check = grown;
        table->room = room;
    }
    memcpy(row.scene, checker->scene, sizeof row.scene);
    snprintf(row.measure, sizeof row.measure, "%s", measure);
    table->check[table->count++] = row;
}

void plm_check_value(plm_checker *checker, const char *measure, double found, double reference, plm_bound bound)
{
    plm_check row = {.found = found, .reference = reference, .condition = bound.condition, .bound = bound.error};
    const double scale = bound.scale > 0 ? bound.scale : fabs(reference);
    row.error = found == reference ? 0 : fabs(found - reference) / scale;
    row.verdict = row.error <= bound.error ? PLM_VERDICT_WITHIN : PLM_VERDICT_BEYOND; /* NaN is beyond */
    if (bound.note) snprintf(row.note, sizeof row.note, "%s", bound.note);
    add_row(checker, measure, row);
}

static void add_message(plm_checker *checker, const char *measure, plm_verdict verdict, const char *message)
{
    plm_check row = {.found = NAN, .reference = NAN, .error = NAN, .condition = NAN, .bound = NAN, .verdict = verdict};
    snprintf(row.note, sizeof row.note, "%.*s", (int)sizeof row.note - 1, message);
    add_row(checker, measure, row);
}

/* What the machine lacks is no finding about numbers. */
static bool is_fault_of_the_machine(plm_checker *checker, plm_status status, const plm_error *why)
{
    if (status != PLM_E_MEMORY && status != PLM_E_LIBRARY) return false;
    if (checker->status == PLM_OK) checker->status = plm_fail(checker->error, status, "%s", why->message);
    return true;
}

void plm_check_refused(plm_checker *checker, const char *measure, plm_status status, const plm_error *why)
{
    if (checker->status != PLM_OK || is_fault_of_the_machine(checker, status, why)) return;
    if (status == PLM_OK || !why->message[0])
        add_message(checker, measure, PLM_VERDICT_BEYOND,
                    status == PLM_OK ? "gave a value where none is determined" : "failed without a message");
    else
        add_message(checker, measure, PLM_VERDICT_SAID_WHY, why->message);
}

bool plm_check_ran(plm_checker *checker, const char *measure, plm_status status, const plm_error *why)
{
    if (checker->status != PLM_OK || is_fault_of_the_machine(checker, status, why)) return false;
    if (status != PLM_OK) add_message(checker, measure, PLM_VERDICT_BEYOND, why->message);
    return status == PLM_OK;
}

/* ---- Plants ------------------------------------------------------------------------------------------------------ */

/* A value is right to read: finite, with a standard error that is none or finite; or it says why it is not. */
static bool is_sound(const plm_estimate *estimate)
{
    if (estimate->state != PLM_STATE_OK) return estimate->reason[0] != 0;
    return isfinite(estimate->value) && (isnan(estimate->std_error) || estimate->std_error >= 0) &&
           !isinf(estimate->std_error);
}

bool plm_check_measure(plm_checker *checker, plm_cloud *cloud, const char *traits, plm_measurement *plant)
{
    plm_error why = {0};
    plm_measure_options options;
    plm_measure_defaults(&options);
    options.traits = traits;
    options.up = PLM_UP_Z;
    if (checker->status != PLM_OK) {
        plm_cloud_free(cloud);
        return false;
    }
    const plm_status status = plm_measure(cloud, &options, plant, &why);
    if (status == PLM_E_DEGENERATE || status == PLM_E_ARGUMENT) {
        plm_check_refused(checker, "all values", status, &why);
        return false;
    }
    if (!plm_check_ran(checker, "all values", status, &why)) return false;
    size_t unsound = 0;
    char first[64] = "";
    for (size_t i = 0; i < plant->value_count; i++) {
        if (is_sound(&plant->value[i].estimate)) continue;
        if (unsound++ == 0) snprintf(first, sizeof first, "%s", plant->value[i].trait->name);
    }
    plm_check_value(checker, "values neither finite nor explained", (double)unsound, 0,
                    (plm_bound){.condition = NAN, .scale = 1, .note = first});
    return true;
}

void plm_check_trait(plm_checker *checker, const plm_measurement *plant, const char *trait, int32_t organ,
                     double reference, plm_bound bound, bool must)
{
    const plm_estimate *estimate = NULL;
    for (size_t i = 0; i < plant->value_count && !estimate; i++)
        if (!strcmp(plant->value[i].trait->name, trait) && plant->value[i].organ_id == organ)
            estimate = &plant->value[i].estimate;
    if (!estimate) {
        const bool is_said = !must && organ >= 0 && plm_trait_find(trait);
        add_message(checker, trait, is_said ? PLM_VERDICT_SAID_WHY : PLM_VERDICT_BEYOND, "the plant has no such organ");
        return;
    }
    if (estimate->state != PLM_STATE_OK) {
        const bool is_said = !must && estimate->reason[0];
        add_message(checker, trait, is_said ? PLM_VERDICT_SAID_WHY : PLM_VERDICT_BEYOND, estimate->reason);
        return;
    }
    const double scale = bound.scale > 0 ? bound.scale : fabs(reference);
    if (bound.error < 0) bound.error *= -estimate->std_error / scale;
    /* A flag is a warning that a reader of the table sees: that much is said where nothing can be known. */
    if (!must && estimate->flags & PLM_FLAG_LOW_DENSITY && !(fabs(estimate->value - reference) <= bound.error * scale))
        add_message(checker, trait, PLM_VERDICT_SAID_WHY, "flagged low_density");
    else
        plm_check_value(checker, trait, estimate->value, reference, bound);
}
