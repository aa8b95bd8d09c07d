/* reports/bootstrap.c: BCa bootstrap intervals (B. Efron, Better Bootstrap Confidence Intervals, JASA 82, 1987) of R2,
 * RMSE and MAPE. Clusters (plants) are drawn whole, since leaves of one plant err together. Each statistic is a function of
 * a few sums, so a resample is a sum over clusters, and the jackknife of the acceleration subtracts one cluster each. */
#include "reports/agreement.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/** What the three statistics need of a set of pairs. Manual values are taken about their mean. */
typedef struct pair_sums {
    double n, dd, m, mm, relative, nonzero;
} pair_sums;

enum { STATISTICS = 3 };

static void statistics_of(const pair_sums *s, double out[STATISTICS])
{
    const double smm = s->mm - s->m * s->m / s->n;
    out[0] = smm > 0 ? 1 - s->dd / smm : NAN;
    out[1] = sqrt(fmax(0, s->dd) / s->n);
    out[2] = s->nonzero > 0 ? 100 * s->relative / s->nonzero : NAN;
}

static void add(pair_sums *to, const pair_sums *from, double times)
{
    to->n += times * from->n, to->dd += times * from->dd, to->m += times * from->m;
    to->mm += times * from->mm, to->relative += times * from->relative, to->nonzero += times * from->nonzero;
}

/* SplitMix64 (Steele, Lea and Flood 2014); a stream of its own for each resample, so that threads do not matter. */
static uint64_t next(uint64_t *state)
{
    uint64_t z = (*state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static size_t draw(uint64_t *state, size_t below)
{
    return (size_t)(((next(state) >> 32) * (uint64_t)below) >> 32);
}

static int by_number(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Quantile of sorted values by Hyndman and Fan's type 6 with normal-score interpolation left out: linear between order
 * statistics at (B + 1) probability, as Davison and Hinkley 1997 advise. */
static double quantile(const double *sorted, size_t count, double probability)
{
    const double place = ((double)count + 1) * probability - 1;
    if (place <= 0) return sorted[0];
    if (place >= (double)count - 1) return sorted[count - 1];
    const size_t below = (size_t)place;
    return sorted[below] + (place - (double)below) * (sorted[below + 1] - sorted[below]);
}

/* replicate is sorted in place; jackknife holds the leave-one-cluster-out values. */
static void bca_interval(double *replicate, size_t resamples, const double *jackknife, size_t clusters,
                         plm_statistic *statistic)
{
    size_t count = 0, below = 0, tied = 0;
    for (size_t i = 0; i < resamples; i++)
        if (isfinite(replicate[i])) replicate[count++] = replicate[i];
    for (size_t i = 0; i < count; i++) {
        below += replicate[i] < statistic->value;
        tied += replicate[i] == statistic->value;
    }
    for (size_t i = 0; i < clusters; i++)
        if (!isfinite(jackknife[i])) return;
    const double share = ((double)below + (double)tied / 2) / (double)count;
    if (count < 100 || !(share > 0) || !(share < 1)) return;
    qsort(replicate, count, sizeof *replicate, by_number);
    const double mean = plm_mean(jackknife, clusters);
    double cubes = 0, squares = 0;
    for (size_t i = 0; i < clusters; i++) {
        const double u = mean - jackknife[i];
        squares += u * u;
        cubes += u * u * u;
    }
    const double acceleration = squares > 0 ? cubes / (6 * pow(squares, 1.5)) : 0;
    const double z0 = gsl_cdf_ugaussian_Pinv(share);
    double limit[2];
    for (int side = 0; side < 2; side++) {
        const double z = z0 + gsl_cdf_ugaussian_Pinv(side ? 0.975 : 0.025);
        limit[side] = quantile(replicate, count, gsl_cdf_ugaussian_P(z0 + z / (1 - acceleration * z)));
    }
    statistic->low = limit[0];
    statistic->high = limit[1];
}

typedef struct keyed {
    uint32_t cluster, pair;
} keyed;

static int by_cluster(const void *a, const void *b)
{
    const keyed *x = a, *y = b;
    return x->cluster != y->cluster ? (x->cluster > y->cluster) - (x->cluster < y->cluster)
                                    : (x->pair > y->pair) - (x->pair < y->pair);
}

/* Sums of each cluster, clusters in ascending order of their number. Gives how many there are. */
static size_t sum_clusters(const double *d, const double *m, const uint32_t *cluster, size_t n, keyed *key,
                           pair_sums *sums)
{
    const double mean = plm_mean(m, n);
    for (size_t i = 0; i < n; i++) key[i] = (keyed){cluster ? cluster[i] : (uint32_t)i, (uint32_t)i};
    if (cluster) qsort(key, n, sizeof *key, by_cluster);
    size_t count = 0;
    for (size_t k = 0; k < n; k++) {
        const size_t i = key[k].pair;
        if (k == 0 || key[k].cluster != key[k - 1].cluster) sums[count++] = (pair_sums){0};
        const double mi = m[i] - mean;
        const pair_sums one = {1, d[i] * d[i], mi, mi * mi, m[i] != 0 ? fabs(d[i] / m[i]) : 0, m[i] != 0};
        add(&sums[count - 1], &one, 1);
    }
    return count;
}

plm_status plm_bootstrap_agreement(const double *difference, const double *manual, const uint32_t *cluster, size_t n,
                                   size_t resamples, uint64_t seed, plm_statistic statistic[STATISTICS],
                                   plm_error *error)
{
    if (n < 3) return PLM_OK;
    keyed *key = plm_alloc(n, sizeof *key, error);
    pair_sums *sums = plm_alloc(n, sizeof *sums, error);
    double *replicate = plm_alloc(resamples, STATISTICS * sizeof *replicate, error);
    double *jackknife = plm_alloc(n, STATISTICS * sizeof *jackknife, error);
    plm_status status = key && sums && replicate && jackknife ? PLM_OK : PLM_E_MEMORY;
    const size_t clusters = status == PLM_OK ? sum_clusters(difference, manual, cluster, n, key, sums) : 0;
    if (clusters >= 3) {
        const int64_t draws = (int64_t)resamples;
#pragma omp parallel for schedule(static)
        for (int64_t b = 0; b < draws; b++) {
            uint64_t state = seed ^ ((uint64_t)(b + 1) * 0xd1342543de82ef95u);
            pair_sums total = {0};
            for (size_t c = 0; c < clusters; c++) add(&total, &sums[draw(&state, clusters)], 1);
            double value[STATISTICS];
            statistics_of(&total, value);
            for (int k = 0; k < STATISTICS; k++) replicate[(size_t)k * resamples + (size_t)b] = value[k];
        }
        pair_sums all = {0};
        for (size_t c = 0; c < clusters; c++) add(&all, &sums[c], 1);
        for (size_t c = 0; c < clusters; c++) {
            pair_sums rest = all;
            add(&rest, &sums[c], -1);
            double value[STATISTICS];
            statistics_of(&rest, value);
            for (int k = 0; k < STATISTICS; k++) jackknife[(size_t)k * clusters + c] = value[k];
        }
        for (int k = 0; k < STATISTICS; k++)
            if (isfinite(statistic[k].value))
                bca_interval(replicate + (size_t)k * resamples, resamples, jackknife + (size_t)k * clusters, clusters,
                             &statistic[k]);
    }
    plm_free(key);
    plm_free(sums);
    plm_free(replicate);
    plm_free(jackknife);
    return status;
}
