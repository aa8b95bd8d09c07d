/* tool/tradeoff_bootstrap.c: how many resamples a bootstrap interval of `validate` needs: its ends against those of very many. */
#include "cloud/clock.h"
#include "reports/agreement.h"
#include "tool/tradeoff.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { SEEDS = 8, REFERENCE = 100000, FEWEST_PAIRS = 5, STATISTICS = 3, MAPE = 2 };
static const size_t resamples[] = {100, 200, 500, 1000, 2000, 5000, 10000};

/** No trait of plants, but a row like theirs: the interval about the mean relative error. */
static const plm_trait agreement_interval = {.name = "agreement_interval", .level = PLM_PLANT, .unit = PLM_NUMBER};

typedef struct interval_task {
    const tradeoff *study;
    const tradeoff_pairs *pairs;
    const uint32_t *cluster;
    size_t resamples, seeds;
} interval_task;

typedef struct interval_result {
    double low[SEEDS], high[SEEDS], seconds;
    uint64_t peak_bytes;
} interval_result;

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static int bootstrap_in_child(void *user, int fd)
{
    const interval_task *task = user;
    interval_result result = {0};
    double seconds[SEEDS] = {0};
    for (size_t k = 0; k < task->seeds; k++) {
        plm_statistic boot[STATISTICS] = {{.value = NAN}, {.value = NAN}, {.value = 1}};
        const tradeoff_pairs *pairs = task->pairs;
        double sum = 0;
        for (size_t i = 0; i < pairs->count; i++) sum += pairs->size[i];
        boot[MAPE].value = sum / (double)pairs->count;
        const double begin = plm_seconds_now();
        if (plm_bootstrap_agreement(pairs->difference, pairs->truth, task->cluster, pairs->count, task->resamples,
                                    task->study->settings->seed + 1000 * (k + 1), boot, NULL) != PLM_OK)
            return 1;
        seconds[k] = plm_seconds_now() - begin;
        result.low[k] = boot[MAPE].low;
        result.high[k] = boot[MAPE].high;
    }
    qsort(seconds, task->seeds, sizeof *seconds, by_value);
    result.seconds = seconds[task->seeds / 2];
    result.peak_bytes = plm_peak_bytes();
    return write(fd, &result, sizeof result) == (ssize_t)sizeof result ? 0 : 1;
}

static plm_status find_interval(const interval_task *task, interval_result *result, plm_error *error)
{
    char *output;
    size_t size;
    interval_task copy = *task;
    plm_status status = tradeoff_in_child(bootstrap_in_child, &copy, 0, &output, &size, error);
    if (status != PLM_OK) return status;
    if (size == sizeof *result)
        memcpy(result, output, sizeof *result);
    else
        status = plm_fail(error, PLM_E_LIBRARY, "a bootstrap said nothing");
    plm_free(output);
    return status;
}

/* The trait whose finest row has most pairs; the traits' count where none has enough. */
static size_t most_pairs(const tradeoff *study, tradeoff_pairs *pairs)
{
    size_t count, most = FEWEST_PAIRS - 1;
    plm_traits(&count);
    size_t best = count;
    for (size_t t = 0; t < count; t++) {
        if (!study->is_wanted[t]) continue;
        tradeoff_gather(study, t, 0, pairs);
        if (pairs->count > most) {
            most = pairs->count;
            best = t;
        }
    }
    return best;
}

/* Distance of the ends from the reference's, in % of half its width. */
static void compare(const interval_result *found, double low, double high, tradeoff_row *row)
{
    const double half = 0.5 * (high - low);
    double size[2 * SEEDS], sum = 0, squares = 0;
    for (size_t k = 0; k < SEEDS; k++) {
        size[2 * k] = 100 * fabs(found->low[k] - low) / half;
        size[2 * k + 1] = 100 * fabs(found->high[k] - high) / half;
    }
    for (size_t k = 0; k < COUNT(size); k++) sum += size[k];
    row->count = COUNT(size);
    row->error = sum / (double)COUNT(size);
    for (size_t k = 0; k < COUNT(size); k++) squares += (size[k] - row->error) * (size[k] - row->error);
    row->half_interval = 1.96 * sqrt(squares / (double)((COUNT(size) - 1) * COUNT(size)));
    row->low = fmax(0, row->error - row->half_interval);
    row->high = row->error + row->half_interval;
    qsort(size, COUNT(size), sizeof *size, by_value);
    row->median_error = 0.5 * (size[SEEDS - 1] + size[SEEDS]);
}

static plm_status add_rows(tradeoff *study, const tradeoff_pairs *pairs, plm_error *error)
{
    const uint32_t *cluster = study->plant_count < 3 ? NULL : pairs->plant;
    interval_task task = {.study = study, .pairs = pairs, .cluster = cluster, .resamples = REFERENCE, .seeds = 1};
    interval_result reference, found;
    plm_status status = find_interval(&task, &reference, error);
    if (status != PLM_OK || !(reference.high[0] > reference.low[0])) return status;
    task.seeds = SEEDS;
    for (size_t k = 0; k < COUNT(resamples) && status == PLM_OK; k++) {
        task.resamples = resamples[k];
        status = find_interval(&task, &found, error);
        tradeoff_setting *setting = status == PLM_OK ? tradeoff_add_setting(study, "validate", error) : NULL;
        if (!setting) return status == PLM_OK ? PLM_E_MEMORY : status;
        snprintf(setting->text, sizeof setting->text, "resamples=%zu", resamples[k]);
        tradeoff_row row = {.trait = &agreement_interval,
                            .setting = study->setting_count - 1,
                            .plants = study->plant_count,
                            .points = (double)pairs->count,
                            .seconds = found.seconds,
                            .peak_bytes = found.peak_bytes};
        compare(&found, reference.low[0], reference.high[0], &row);
        status = tradeoff_add_row(study, &row, error);
    }
    return status;
}

plm_status tradeoff_score_bootstrap(tradeoff *study, plm_error *error)
{
    size_t count;
    plm_traits(&count);
    if (!study->has_truth) return PLM_OK; /* no errors that an interval could be about */
    tradeoff_pairs pairs;
    plm_status status = tradeoff_pairs_make(study, &pairs, error);
    const size_t first = study->row_count;
    const size_t trait = status == PLM_OK ? most_pairs(study, &pairs) : count;
    if (trait < count) {
        tradeoff_gather(study, trait, 0, &pairs);
        status = add_rows(study, &pairs, error);
    }
    if (status == PLM_OK) status = tradeoff_mark_fronts(study, first, error);
    tradeoff_pairs_free(&pairs);
    return status;
}
