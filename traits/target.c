/* traits/target.c: reading wanted errors, and comparing reported ones to them. */
#include "traits/target.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/** Of a normal distribution: half the width of a 95 % interval in standard errors. */
static const double half_width_in_errors = 1.96;

/* A number's unit, as a factor to SI: none is the trait's own. */
static bool unit_factor(plm_unit unit, const char *name, double *factor)
{
    static const struct {
        plm_unit unit;
        const char *name;
        double factor;
    } others[] = {{PLM_MILLIMETRE, "m", 1}, {PLM_MILLIMETRE, "cm", 1e-2}, {PLM_SQUARE_CM, "mm2", 1e-6},
                  {PLM_SQUARE_CM, "m2", 1}, {PLM_CUBIC_CM, "mm3", 1e-9},  {PLM_CUBIC_CM, "m3", 1}};
    *factor = 1 / plm_unit_factor(unit);
    if (!*name || !strcmp(name, plm_unit_name(unit))) return true;
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (others[i].unit == unit && !strcmp(others[i].name, name)) {
            *factor = others[i].factor;
            return true;
        }
    return false;
}

static plm_status parse_one(const char *word, plm_target *target, plm_error *error)
{
    char name[80];
    const char *equals = strchr(word, '=');
    if (!equals || (size_t)(equals - word) >= sizeof name)
        return plm_fail(error, PLM_E_ARGUMENT, "\"%s\"; expected TRAIT=ERROR, e.g. leaf_area=2%% or plant_height=1mm",
                        word);
    memcpy(name, word, (size_t)(equals - word));
    name[equals - word] = 0;
    plm_plan plan;
    plm_measure_options options;
    plm_measure_defaults(&options);
    options.traits = name;
    *target = (plm_target){.trait = plm_trait_find(name)};
    if (!target->trait) { /* the plan knows the nearest name */
        const plm_status status = plm_plan_make(&options, 0, &plan, error);
        return status == PLM_OK ? plm_fail(error, PLM_E_ARGUMENT, "\"%s\" is no trait but a level", name) : status;
    }
    char *end;
    const double number = strtod(equals + 1, &end);
    if (end == equals + 1 || !isfinite(number) || number <= 0)
        return plm_fail(error, PLM_E_ARGUMENT, "\"%s\": the error must be a number above 0, e.g. 2%% or 1mm", word);
    while (*end == ' ') end++;
    double factor = 0.01;
    target->is_relative = !strcmp(end, "%");
    if (!target->is_relative && !unit_factor(target->trait->unit, end, &factor))
        return plm_fail(error, PLM_E_ARGUMENT, "\"%s\": the unit is %% or that of the trait, %s", word,
                        plm_unit_name(target->trait->unit));
    target->half_width = number * factor;
    return PLM_OK;
}

plm_status plm_targets_parse(const char *text, plm_target target[PLM_MOST_TARGETS], size_t *count, plm_error *error)
{
    size_t words = 0;
    for (const char *at = text; *at; words++) {
        char word[160];
        at += strspn(at, ", ");
        size_t length = strcspn(at, ",");
        if (length == 0) break;
        if (length >= sizeof word)
            return plm_fail(error, PLM_E_ARGUMENT, "\"%.60s...\"; expected TRAIT=ERROR, e.g. leaf_area=2%%", at);
        if (*count == PLM_MOST_TARGETS)
            return plm_fail(error, PLM_E_ARGUMENT, "there are more than %d target errors", PLM_MOST_TARGETS);
        memcpy(word, at, length);
        at += length;
        while (length && word[length - 1] == ' ') length--;
        word[length] = 0;
        const plm_status status = parse_one(word, &target[*count], error);
        if (status != PLM_OK) return status;
        ++*count;
    }
    return words ? PLM_OK : plm_fail(error, PLM_E_ARGUMENT, "the list of target errors is empty");
}

static int compare_numbers(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* INFINITY for a value that is missing, or that has no standard error. */
static double half_width_of(const plm_target *target, const plm_estimate *estimate)
{
    if (estimate->state != PLM_STATE_OK || !isfinite(estimate->std_error)) return INFINITY;
    const double half = half_width_in_errors * estimate->std_error;
    if (!target->is_relative) return half;
    return estimate->value == 0 ? INFINITY : half / fabs(estimate->value);
}

plm_target_outcome plm_target_check(const plm_target *target, const plm_trait_value *value, size_t count)
{
    plm_target_outcome out = {.half_width = INFINITY, .worst = INFINITY};
    double *half = plm_alloc(count, sizeof *half, NULL);
    if (!half) return out;
    for (size_t i = 0; i < count; i++) {
        if (value[i].trait != target->trait) continue;
        const double mine = half_width_of(target, &value[i].estimate);
        out.organs_within += mine <= target->half_width;
        half[out.organs++] = mine;
    }
    if (out.organs) {
        qsort(half, out.organs, sizeof *half, compare_numbers);
        out.half_width = half[out.organs / 2]; /* of an even number the upper of the two: at least half are within */
        out.worst = half[out.organs - 1];
    }
    out.is_reached = out.half_width <= target->half_width;
    plm_free(half);
    return out;
}
