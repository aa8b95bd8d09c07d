/* reports/validation_tables.c: what `validate` and `compare` write: agreement.csv (every statistic, long), agreement.md (the
 * main ones, to read), pairs.csv and unmatched.csv. */
#include "reports/csv_write.h"
#include "reports/validation.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A table under way; the first failure stays. */
typedef struct sheet {
    plm_output *output;
    plm_status status;
    plm_error *error;
} sheet;

static void text(sheet *s, const char *cell, char behind)
{
    if (s->status == PLM_OK) s->status = plm_csv_text(s->output, cell, behind, s->error);
}

static void number(sheet *s, double value, char behind)
{
    if (s->status == PLM_OK) s->status = plm_csv_number(s->output, value, behind, s->error);
}

static const char *unit_text(plm_statistic_unit unit, const char *trait_unit)
{
    return unit == PLM_UNIT_OF_TRAIT ? trait_unit : unit == PLM_UNIT_PERCENT ? "%" : "1";
}

static void agreement_row(sheet *s, const plm_validated_group *g, const char *name, const char *unit, double value,
                          double low, double high, size_t n, const char *reason)
{
    text(s, g->trait, ',');
    text(s, g->group, ',');
    text(s, name, ',');
    number(s, value, ',');
    number(s, low, ',');
    number(s, high, ',');
    number(s, (double)n, ',');
    text(s, unit, ',');
    text(s, reason, '\n');
}

static void agreement_rows(sheet *s, const plm_validation *v)
{
    if (s->status == PLM_OK)
        s->status = plm_output_print(s->output, s->error, "trait,group,statistic,value,ci_low,ci_high,n,unit,reason\n");
    for (size_t i = 0; i < v->group_count; i++) {
        const plm_validated_group *g = &v->group[i];
        agreement_row(s, g, "n", "1", (double)g->count, NAN, NAN, g->count, "");
        for (int id = 0; id < PLM_STAT_COUNT; id++) {
            const plm_statistic_row *row = plm_statistic_describe((plm_statistic_id)id);
            const plm_statistic *x = &g->statistic[id];
            agreement_row(s, g, row->name, unit_text(row->unit, g->unit), x->value, x->low, x->high, x->n, x->reason);
        }
        const plm_repeatability *r = &g->repeatability;
        const char *why = r->degrees ? "" : "no manual reading was repeated";
        agreement_row(s, g, "manual_sd_within", g->unit, r->sd_within, NAN, NAN, r->subjects, why);
        agreement_row(s, g, "manual_icc", "1", r->icc, NAN, NAN, r->subjects,
                      r->degrees && isnan(r->icc) ? "fewer than 2 subjects" : why);
        agreement_row(s, g, "coverage_95", "1", g->coverage, NAN, NAN, g->count,
                      isnan(g->coverage) ? "the estimates have no standard errors" : "");
    }
}

/* A cell of the table to read: four significant digits, or what is missing. */
static const char *short_number(double value, char buffer[PLM_NUMBER_LENGTH])
{
    if (!isfinite(value)) return "-";
    snprintf(buffer, PLM_NUMBER_LENGTH, "%.4g", value);
    return buffer;
}

static void markdown_rows(sheet *s, const plm_validation *v)
{
    static const plm_statistic_id shown[] = {
        PLM_STAT_R2,      PLM_STAT_R2_PEARSON, PLM_STAT_RMSE, PLM_STAT_RRMSE,        PLM_STAT_MAPE,      PLM_STAT_BIAS,
        PLM_STAT_LOA_LOW, PLM_STAT_LOA_HIGH,   PLM_STAT_CCC,  PLM_STAT_DEMING_SLOPE, PLM_STAT_PAIRED_T_P};
    static const char head[] = "# Agreement of estimates with manual measurements\n\n"
                               "95 % intervals, the other statistics, and why a value is missing: agreement.csv. "
                               "Differences are estimate minus "
                               "manual.\n\n"
                               "| trait | group | unit | n | R2 | r2 Pearson | RMSE | rRMSE % | MAPE % | bias | LoA "
                               "low | LoA high | CCC | Deming "
                               "slope | paired t p |\n"
                               "|---|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n";
    if (s->status == PLM_OK) s->status = plm_output_write(s->output, head, sizeof head - 1, s->error);
    for (size_t i = 0; i < v->group_count && s->status == PLM_OK; i++) {
        const plm_validated_group *g = &v->group[i];
        s->status =
            plm_output_print(s->output, s->error, "| %s | %s | %s | %zu |", g->trait, g->group, g->unit, g->count);
        for (size_t k = 0; k < sizeof shown / sizeof *shown && s->status == PLM_OK; k++) {
            char buffer[PLM_NUMBER_LENGTH];
            s->status =
                plm_output_print(s->output, s->error, " %s |", short_number(g->statistic[shown[k]].value, buffer));
        }
        if (s->status == PLM_OK) s->status = plm_output_write(s->output, "\n", 1, s->error);
    }
}

static void pair_rows(sheet *s, const plm_validation *v)
{
    if (s->status == PLM_OK)
        s->status = plm_output_print(s->output, s->error,
                                     "trait,group,plant_id,organ,organ_id,manual_organ_id,estimate,manual,difference,"
                                     "std_error,manual_repeats,unit\n");
    for (size_t i = 0; i < v->pair_count; i++) {
        const plm_validated_pair *pair = &v->pair[i];
        text(s, pair->estimate->trait, ',');
        text(s, pair->manual->group, ',');
        text(s, pair->estimate->plant_id, ',');
        text(s, pair->estimate->organ, ',');
        text(s, pair->estimate->organ_id, ',');
        text(s, pair->manual->organ_id, ',');
        number(s, pair->estimate_value, ',');
        number(s, pair->manual_value, ',');
        double difference = pair->estimate_value - pair->manual_value;
        if (strstr(pair->estimate->trait, "azimuth")) difference = remainder(difference, 360);
        number(s, difference, ',');
        number(s, pair->std_error, ',');
        number(s, (double)pair->manual->repeat_count, ',');
        text(s, pair->estimate->unit, '\n');
    }
}

static bool has_trait(const plm_readings *readings, const char *trait)
{
    for (size_t i = 0; i < readings->count; i++)
        if (!strcmp(readings->reading[i].trait, trait)) return true;
    return false;
}

static void unmatched_side(sheet *s, const char *side, const plm_readings *mine, const bool *used,
                           const plm_readings *other)
{
    const char *last = NULL;
    bool known = false;
    for (size_t i = 0; i < mine->count; i++) {
        if (used[i]) continue;
        const plm_reading *reading = &mine->reading[i];
        if (!last || strcmp(last, reading->trait)) last = reading->trait, known = has_trait(other, last);
        text(s, side, ',');
        text(s, reading->plant_id, ',');
        text(s, reading->organ, ',');
        text(s, reading->organ_id, ',');
        text(s, reading->trait, ',');
        number(s, reading->value, ',');
        text(s, reading->unit, ',');
        text(s, known ? "no partner of this plant, organ and number" : "the other table has no such trait", '\n');
    }
}

static void unmatched_rows(sheet *s, const plm_validation *v)
{
    if (s->status == PLM_OK)
        s->status = plm_output_print(s->output, s->error, "side,plant_id,organ,organ_id,trait,value,unit,reason\n");
    unmatched_side(s, "estimate", &v->estimate, v->estimate_used, &v->manual);
    unmatched_side(s, "manual", &v->manual, v->manual_used, &v->estimate);
}

plm_status plm_validation_write(const plm_validation *validation, const char *folder, plm_error *error)
{
    static const struct {
        const char *name;
        void (*write)(sheet *, const plm_validation *);
    } files[] = {{"agreement.csv", agreement_rows},
                 {"agreement.md", markdown_rows},
                 {"pairs.csv", pair_rows},
                 {"unmatched.csv", unmatched_rows}};
    plm_status status = PLM_OK;
    for (size_t i = 0; i < sizeof files / sizeof *files && status == PLM_OK; i++) {
        char path[4096];
        if ((size_t)snprintf(path, sizeof path, "%s/%s", folder, files[i].name) >= sizeof path)
            return plm_fail(error, PLM_E_ARGUMENT, "the folder's name is too long");
        sheet s = {.status = PLM_OK, .error = error};
        status = plm_output_open(path, &s.output, error);
        if (status != PLM_OK) break;
        files[i].write(&s, validation);
        const plm_status closed = plm_output_close(s.output, s.status == PLM_OK, s.status == PLM_OK ? error : NULL);
        status = s.status != PLM_OK ? s.status : closed;
    }
    return status;
}
