/* reports/validation.c: from two tables to statistics by trait and group. */
#include "reports/validation.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int by_group(const void *a, const void *b)
{
    const plm_validated_pair *x = a, *y = b;
    int order = strcmp(x->estimate->trait, y->estimate->trait);
    if (!order) order = strcmp(x->manual->group, y->manual->group);
    if (!order) order = strcmp(x->estimate->plant_id, y->estimate->plant_id);
    if (!order) order = strcmp(x->estimate->organ_id, y->estimate->organ_id);
    return order ? order : (x->estimate > y->estimate) - (x->estimate < y->estimate);
}

/* Pairs in one unit; those whose units are not of one kind go back to the unmatched. */
static plm_status convert_pairs(plm_validation *v, const plm_match_pair *match, size_t count, plm_error *error)
{
    v->pair = plm_alloc(count, sizeof *v->pair, error);
    if (!v->pair) return PLM_E_MEMORY;
    for (size_t i = 0; i < count; i++) {
        const plm_reading *e = &v->estimate.reading[match[i].estimate], *m = &v->manual.reading[match[i].manual];
        const double factor = plm_unit_conversion(m->unit, e->unit);
        if (!(factor > 0)) {
            v->estimate_used[match[i].estimate] = v->manual_used[match[i].manual] = false;
            v->unit_mismatches++;
            continue;
        }
        v->pair[v->pair_count++] =
            (plm_validated_pair){e, m, e->value, m->value * factor, v->estimate.std_error[match[i].estimate]};
    }
    qsort(v->pair, v->pair_count, sizeof *v->pair, by_group);
    return PLM_OK;
}

static plm_status match_tables(plm_validation *v, plm_match match, plm_error *error)
{
    const size_t most = v->estimate.count < v->manual.count ? v->estimate.count : v->manual.count;
    plm_match_pair *pair = plm_alloc(most, sizeof *pair, error);
    v->estimate_used = plm_alloc(v->estimate.count, sizeof *v->estimate_used, error);
    v->manual_used = plm_alloc(v->manual.count, sizeof *v->manual_used, error);
    plm_status status = pair && v->estimate_used && v->manual_used ? PLM_OK : PLM_E_MEMORY;
    size_t count = 0;
    if (status == PLM_OK)
        status = plm_match_readings(v->estimate.reading, v->estimate.count, v->manual.reading, v->manual.count, match,
                                    pair, &count, v->estimate_used, v->manual_used, error);
    if (status == PLM_OK) status = convert_pairs(v, pair, count, error);
    plm_free(pair);
    if (status == PLM_OK && v->pair_count == 0)
        status = plm_fail(
            error, PLM_E_ARGUMENT,
            "no estimate has a manual partner (%zu and %zu readings): plant_id, organ, trait and organ_id must "
            "agree; --match rank pairs organs without numbers",
            v->estimate.count, v->manual.count);
    return status;
}

/* "trait=number,..." */
static plm_status find_tolerance(const char *list, const char *trait, double *tolerance, plm_error *error)
{
    *tolerance = 0;
    for (const char *at = list ? list : ""; *at;) {
        const size_t length = strcspn(at, ","), name = strcspn(at, "=");
        char number[64];
        double value;
        if (name >= length || length - name > sizeof number)
            return plm_fail(error, PLM_E_ARGUMENT, "tolerance \"%s\": TRAIT=NUMBER was expected", at);
        memcpy(number, at + name + 1, length - name - 1);
        number[length - name - 1] = 0;
        if (!plm_table_number(number, &value) || !(value > 0))
            return plm_fail(error, PLM_E_ARGUMENT, "tolerance \"%s\": a number above 0 was expected", number);
        if (strlen(trait) == name && !strncmp(trait, at, name)) *tolerance = value;
        at += length + (at[length] == ',');
    }
    return PLM_OK;
}

/* Repeats of the manual readings of these pairs. */
static plm_status repeatability_of(const plm_validation *v, const plm_validated_pair *pair, size_t count,
                                   plm_repeatability *out, plm_error *error)
{
    *out = (plm_repeatability){NAN, NAN, 0, 0};
    size_t rows = 0;
    for (size_t i = 0; i < count; i++) rows += pair[i].manual->repeat_count;
    if (rows == count) return PLM_OK;
    bool *wanted = plm_alloc_zero(v->manual.count, sizeof *wanted, error);
    double *value = plm_alloc(rows, sizeof *value, error);
    uint32_t *subject = plm_alloc(rows, sizeof *subject, error);
    plm_status status = wanted && value && subject ? PLM_OK : PLM_E_MEMORY;
    if (status == PLM_OK) {
        for (size_t i = 0; i < count; i++) wanted[pair[i].manual - v->manual.reading] = true;
        size_t used = 0;
        for (size_t i = 0; i < v->manual.repeat_total; i++)
            if (wanted[v->manual.repeat_reading[i]]) {
                const plm_reading *manual = &v->manual.reading[v->manual.repeat_reading[i]];
                value[used] = v->manual.repeat_value[i] * plm_unit_conversion(manual->unit, pair->estimate->unit);
                subject[used++] = v->manual.repeat_reading[i];
            }
        status = plm_repeatability_measure(value, subject, used, out, error);
    }
    plm_free(wanted);
    plm_free(value);
    plm_free(subject);
    return status;
}

static plm_status add_group(plm_validation *v, const char *name, size_t first, size_t count,
                            const plm_validation_options *options, plm_error *error)
{
    const plm_validated_pair *pair = v->pair + first;
    plm_validated_group *group = &v->group[v->group_count];
    *group = (plm_validated_group){.trait = pair->estimate->trait,
                                   .group = name,
                                   .unit = pair->estimate->unit,
                                   .first = first,
                                   .count = count,
                                   .coverage = NAN};
    double *estimate = plm_alloc(count, sizeof *estimate, error), *manual = plm_alloc(count, sizeof *manual, error);
    uint32_t *plant = plm_alloc(count, sizeof *plant, error);
    plm_agreement_options how = {.variance_ratio = options->variance_ratio,
                                 .circular = strstr(group->trait, "azimuth") != NULL,
                                 .resamples = options->resamples,
                                 .seed = options->seed};
    plm_status status = estimate && manual && plant ? PLM_OK : PLM_E_MEMORY;
    if (status == PLM_OK) status = find_tolerance(options->tolerance, group->trait, &how.tolerance, error);
    size_t covered = 0, known = 0;
    uint32_t plants = 0;
    for (size_t i = 0; status == PLM_OK && i < count; i++) {
        estimate[i] = pair[i].estimate_value;
        manual[i] = pair[i].manual_value;
        plants += i > 0 && strcmp(pair[i].estimate->plant_id, pair[i - 1].estimate->plant_id);
        plant[i] = plants;
        if (!isfinite(pair[i].std_error)) continue;
        known++;
        covered += fabs(estimate[i] - manual[i]) <= 1.959963984540054 * pair[i].std_error;
    }
    if (status == PLM_OK) status = plm_agreement(estimate, manual, plant, count, &how, group->statistic, error);
    if (status == PLM_OK) status = repeatability_of(v, pair, count, &group->repeatability, error);
    if (status == PLM_OK) {
        if (known) group->coverage = (double)covered / (double)known;
        v->group_count++;
    }
    plm_free(estimate);
    plm_free(manual);
    plm_free(plant);
    return status;
}

static plm_status compute_groups(plm_validation *v, const plm_validation_options *options, plm_error *error)
{
    v->group = plm_alloc(2 * v->pair_count, sizeof *v->group, error);
    if (!v->group) return PLM_E_MEMORY;
    plm_status status = PLM_OK;
    for (size_t begin = 0, end; status == PLM_OK && begin < v->pair_count; begin = end) {
        for (end = begin; end < v->pair_count && !strcmp(v->pair[end].estimate->trait, v->pair[begin].estimate->trait);)
            end++;
        status = add_group(v, "all", begin, end - begin, options, error);
        for (size_t first = begin, last; options->by && status == PLM_OK && first < end; first = last) {
            for (last = first; last < end && !strcmp(v->pair[last].manual->group, v->pair[first].manual->group);)
                last++;
            if (v->pair[first].manual->group[0])
                status = add_group(v, v->pair[first].manual->group, first, last - first, options, error);
        }
    }
    return status;
}

plm_status plm_validate(const char *estimates_path, const char *manual_path, const plm_validation_options *options,
                        plm_validation *out, plm_error *error)
{
    plm_validation v = {0};
    plm_status status = plm_readings_load(estimates_path, &v.estimate, error);
    if (status == PLM_OK) status = plm_readings_load(manual_path, &v.manual, error);
    if (status == PLM_OK) plm_readings_convert_angles(&v.manual, options->manual_angle);
    if (status == PLM_OK && options->metadata) status = plm_table_read(options->metadata, &v.metadata, error);
    if (status == PLM_OK && options->by) {
        status = options->metadata ? plm_readings_group(&v.manual, &v.metadata, options->by, &v.group_names, error)
                                   : plm_fail(error, PLM_E_ARGUMENT, "groups need a metadata table");
    }
    if (status == PLM_OK) status = match_tables(&v, options->match, error);
    if (status == PLM_OK) status = compute_groups(&v, options, error);
    if (status == PLM_OK)
        *out = v;
    else
        plm_validation_free(&v);
    return status;
}

void plm_validation_free(plm_validation *validation)
{
    plm_readings_free(&validation->estimate);
    plm_readings_free(&validation->manual);
    plm_table_free(&validation->metadata);
    plm_free(validation->group_names);
    plm_free(validation->pair);
    plm_free(validation->estimate_used);
    plm_free(validation->manual_used);
    plm_free(validation->group);
    *validation = (plm_validation){0};
}

/* Splits "trait.statistic OP number" and finds the value it speaks of. */
static plm_status read_condition(const plm_validation *v, const char *condition, double *value, char name[128],
                                 char operator[3], double *limit, plm_error *error)
{
    const size_t dot = strcspn(condition, "."), end = strcspn(condition, "<>= ");
    size_t at = end + strspn(condition + end, " ");
    const size_t length = strspn(condition + at, "<>=");
    if (dot >= end || end >= 128 || length < 1 || length > 2 || condition[at] == '=' ||
        (length == 2 && condition[at + 1] != '=') || !plm_table_number(condition + at + length, limit))
        return plm_fail(error, PLM_E_ARGUMENT, "condition \"%s\": TRAIT.STATISTIC>NUMBER was expected (also < <= >=)",
                        condition);
    memcpy(name, condition, end);
    name[end] = 0;
    memcpy(operator, condition + at, length);
    operator[length] = 0;
    for (size_t g = 0; g < v->group_count; g++) {
        if (strcmp(v->group[g].group, "all") || strlen(v->group[g].trait) != dot ||
            strncmp(v->group[g].trait, name, dot))
            continue;
        for (int id = 0; id < PLM_STAT_COUNT; id++) {
            if (strcmp(plm_statistic_describe((plm_statistic_id)id)->name, name + dot + 1)) continue;
            *value = v->group[g].statistic[id].value;
            if (isfinite(*value)) return PLM_OK;
            return plm_fail(error, PLM_E_ARGUMENT, "%s has no value: %s", name, v->group[g].statistic[id].reason);
        }
        return plm_fail(error, PLM_E_ARGUMENT, "no statistic \"%s\" (r2, rmse, rrmse, mape, mae, bias, ccc, ...)",
                        name + dot + 1);
    }
    return plm_fail(error, PLM_E_ARGUMENT, "no pairs of trait \"%.*s\"", (int)dot, name);
}

plm_status plm_validation_gate(const plm_validation *validation, const char *condition, plm_gate_result *result,
                               plm_error *error)
{
    char name[128], operator[3];
    double value = NAN, limit;
    plm_status status = read_condition(validation, condition, &value, name, operator, & limit, error);
    if (status != PLM_OK) return status;
    const bool equal = operator[1] == '=' && value == limit;
    result->failed = equal || (operator[0] == '<' ? value < limit : value> limit);
    snprintf(result->message, sizeof result->message, "%s is %.6g, which is %s%s %g", name, value,
             result->failed ? "" : "not ", operator, limit);
    return PLM_OK;
}
