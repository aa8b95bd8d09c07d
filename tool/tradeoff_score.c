/* tool/tradeoff_score.c: from values to the table of error against cost. */
#include "reports/agreement.h"
#include "reports/front.h"
#include "tool/tradeoff.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/** A row that measured less than this share of what the best row of its trait measured is no rival to it: leaving out the hard
 * organs is no way to a smaller error. */
static const double fewest_share = 0.95;
enum { RESAMPLES = 2000, BOOTSTRAPPED = 3, MAPE = 2 };
static const double two_sided = 1.96;

static bool is_angle(const plm_trait *trait)
{
    return trait->unit == PLM_DEGREE;
}

/* Difference in the trait's SI unit; azimuths wrap, and so do slopes of lines, but these are folded already. */
static double difference_of(const plm_trait *trait, double value, double truth)
{
    const double difference = value - truth, turn = 6.283185307179586;
    return strstr(trait->name, "azimuth") ? remainder(difference, turn) : difference;
}

static const tradeoff_value *value_of(const tradeoff_run *run, const tradeoff_value *truth)
{
    for (size_t i = 0; i < run->value_count; i++)
        if (run->value[i].trait == truth->trait && run->value[i].organ_id == truth->organ_id) return &run->value[i];
    return NULL;
}

/* A neighbourhood is a part of the smoothness factor's definition: its truth is the same neighbourhood with all points. */
static const tradeoff_value *true_value(const tradeoff *study, size_t plant, size_t setting, size_t group,
                                        const tradeoff_value *truth)
{
    const tradeoff_setting *own = &study->setting[setting];
    if (own->neighbours == 0) return truth;
    for (size_t s = 0; s < study->setting_count; s++) {
        const tradeoff_setting *other = &study->setting[s];
        const tradeoff_run *run = tradeoff_find_run(study, plant, s, group);
        if (other->neighbours == own->neighbours && other->labels == own->labels && other->points == 0 && run)
            return value_of(run, truth);
    }
    return NULL;
}

static void add_pair(const plm_trait *trait, const tradeoff_value *value, const tradeoff_value *truth, size_t plant,
                     tradeoff_pairs *pairs)
{
    const double difference = difference_of(trait, value->value, truth->value);
    const double factor = is_angle(trait) ? plm_unit_factor(PLM_DEGREE) : 100 / fabs(truth->value);
    pairs->difference[pairs->count] = is_angle(trait) ? difference * factor : difference;
    pairs->truth[pairs->count] = is_angle(trait) ? 100 : truth->value; /* so that the mean of |d| / |t| is in degrees */
    pairs->size[pairs->count] = fabs(difference) * factor;
    pairs->plant[pairs->count++] = (uint32_t)plant;
    pairs->told += truth->std_error * factor;
}

/* One plant's part of a row. */
static void add_plant(const tradeoff *study, size_t plant, size_t trait, tradeoff_row *row, tradeoff_pairs *pairs)
{
    const tradeoff_plant *of = &study->plant[plant];
    const tradeoff_setting *setting = &study->setting[row->setting];
    const size_t group = tradeoff_group_of(study, setting, trait);
    const tradeoff_run *run = tradeoff_find_run(study, plant, row->setting, group);
    if (!run) return;
    row->plants++;
    row->failed += !run->is_good;
    if (run->is_good) {
        row->seconds += run->seconds;
        row->points += (double)run->points;
        if (run->peak_bytes > row->peak_bytes) row->peak_bytes = run->peak_bytes;
    }
    for (size_t k = 0; k < of->truth_count; k++) {
        if ((size_t)of->truth[k].trait != trait) continue;
        const tradeoff_value *truth = true_value(study, plant, row->setting, group, &of->truth[k]);
        if (!truth || (truth->value == 0 && !is_angle(row->trait))) continue;
        const tradeoff_value *value = run->is_good ? value_of(run, truth) : NULL;
        if (value)
            add_pair(row->trait, value, truth, plant, pairs);
        else
            row->missing++;
    }
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Mean error with its interval: by BCa bootstrap, plants drawn whole (organs where there are fewer than three plants); of errors against
 * the finest setting, that one's own standard error. */
static plm_status summarise(const tradeoff *study, tradeoff_pairs *pairs, tradeoff_row *row, plm_error *error)
{
    const size_t n = pairs->count;
    row->count = n;
    row->error = row->low = row->high = row->half_interval = row->median_error = NAN;
    const double good = (double)(row->plants - row->failed);
    row->seconds = good > 0 ? row->seconds / good : NAN;
    row->points = good > 0 ? row->points / good : NAN;
    if (n == 0) return PLM_OK;
    double sum = 0;
    for (size_t i = 0; i < n; i++) sum += pairs->size[i];
    row->error = sum / (double)n;
    plm_status status = PLM_OK;
    if (study->has_truth) {
        plm_statistic boot[BOOTSTRAPPED] = {{.value = NAN}, {.value = NAN}, {.value = row->error}};
        for (int k = 0; k < BOOTSTRAPPED; k++) boot[k].low = boot[k].high = NAN;
        status = plm_bootstrap_agreement(pairs->difference, pairs->truth, row->plants < 3 ? NULL : pairs->plant, n,
                                         RESAMPLES, study->settings->seed, boot, error);
        row->low = boot[MAPE].low;
        row->high = boot[MAPE].high;
        row->half_interval = 0.5 * (row->high - row->low);
    } else {
        row->half_interval = two_sided * pairs->told / (double)n;
        row->low = fmax(0, row->error - row->half_interval);
        row->high = row->error + row->half_interval;
    }
    qsort(pairs->size, n, sizeof *pairs->size, by_size);
    row->median_error = n % 2 ? pairs->size[n / 2] : 0.5 * (pairs->size[n / 2 - 1] + pairs->size[n / 2]);
    return status;
}

tradeoff_row tradeoff_gather(const tradeoff *study, size_t trait, size_t setting, tradeoff_pairs *pairs)
{
    size_t count;
    tradeoff_row row = {.trait = &plm_traits(&count)[trait], .setting = setting};
    pairs->count = 0;
    pairs->told = 0;
    for (size_t p = 0; p < study->plant_count; p++) add_plant(study, p, trait, &row, pairs);
    return row;
}

plm_status tradeoff_add_row(tradeoff *study, const tradeoff_row *row, plm_error *error)
{
    void *grown = plm_realloc(study->row, study->row_count + 1, sizeof *study->row, error);
    if (!grown) return PLM_E_MEMORY;
    study->row = grown;
    study->row[study->row_count++] = *row;
    return PLM_OK;
}

static plm_status score_setting(tradeoff *study, size_t trait, size_t setting, tradeoff_pairs *pairs, plm_error *error)
{
    tradeoff_row row = tradeoff_gather(study, trait, setting, pairs);
    if (row.plants == 0) return PLM_OK;
    const plm_status status = summarise(study, pairs, &row, error);
    return status == PLM_OK ? tradeoff_add_row(study, &row, error) : status;
}

/* ---- Fronts --------------------------------------------------------------------------------------------------------- */

/* Who may be on the front: whoever measured about as many organs as the one that measured most, and failed nowhere. */
static void let_take_part(tradeoff *study, size_t first, size_t end)
{
    size_t most = 0;
    for (size_t i = first; i < end; i++)
        if (study->row[i].count > most) most = study->row[i].count;
    for (size_t i = first; i < end; i++) {
        tradeoff_row *row = &study->row[i];
        row->takes_part = row->failed == 0 && row->count > 0 && (double)row->count >= fewest_share * (double)most;
    }
}

plm_status tradeoff_mark_fronts(tradeoff *study, size_t first, plm_error *error)
{
    const size_t n = study->row_count - first;
    double *cost = plm_alloc(n, 2 * sizeof *cost, error);
    bool *flag = cost ? plm_alloc(n, 2 * sizeof *flag, error) : NULL;
    if (flag) let_take_part(study, first, study->row_count);
    for (int labels = 0; flag && labels < TRADEOFF_LABELS; labels++) {
        for (size_t i = 0; i < n; i++) {
            const tradeoff_row *row = &study->row[first + i];
            cost[i] = row->seconds;
            cost[n + i] = row->error;
            flag[i] = row->takes_part && (int)study->setting[row->setting].labels == labels;
        }
        plm_front_mark(cost, cost + n, flag, n, flag + n);
        for (size_t i = 0; i < n; i++)
            if (flag[n + i]) study->row[first + i].is_on_front = true;
    }
    const plm_status status = flag ? PLM_OK : PLM_E_MEMORY;
    plm_free(cost);
    plm_free(flag);
    return status;
}

plm_status tradeoff_pairs_make(const tradeoff *study, tradeoff_pairs *pairs, plm_error *error)
{
    size_t most = 1;
    for (size_t p = 0; p < study->plant_count; p++) most += study->plant[p].truth_count;
    *pairs = (tradeoff_pairs){0};
    pairs->difference = plm_alloc(most, 3 * sizeof *pairs->difference, error);
    pairs->plant = pairs->difference ? plm_alloc(most, sizeof *pairs->plant, error) : NULL;
    if (!pairs->plant) {
        tradeoff_pairs_free(pairs);
        return PLM_E_MEMORY;
    }
    pairs->truth = pairs->difference + most;
    pairs->size = pairs->truth + most;
    return PLM_OK;
}

void tradeoff_pairs_free(tradeoff_pairs *pairs)
{
    plm_free(pairs->difference);
    plm_free(pairs->plant);
    *pairs = (tradeoff_pairs){0};
}

plm_status tradeoff_score(tradeoff *study, plm_error *error)
{
    size_t trait_count;
    plm_traits(&trait_count);
    tradeoff_pairs pairs;
    plm_status status = tradeoff_pairs_make(study, &pairs, error);
    for (size_t t = 0; t < trait_count && status == PLM_OK; t++) {
        const size_t first = study->row_count;
        for (size_t s = 0; s < study->setting_count && study->is_wanted[t] && status == PLM_OK; s++)
            if (tradeoff_applies(&study->setting[s], t)) status = score_setting(study, t, s, &pairs, error);
        if (status == PLM_OK) status = tradeoff_mark_fronts(study, first, error);
    }
    tradeoff_pairs_free(&pairs);
    return status;
}
