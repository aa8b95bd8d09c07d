/* reports/repeatability.c: how well a method repeats itself on the same subjects: one-way random effects analysis of
 * variance (P. E. Shrout and J. L. Fleiss, Intraclass correlations, Psychological Bulletin 86, 1979, ICC(1,1)). */
#include "reports/agreement.h"

#include <math.h>
#include <stdlib.h>

typedef struct measured {
    uint32_t subject;
    double value;
} measured;

static int by_subject(const void *a, const void *b)
{
    const measured *x = a, *y = b;
    if (x->subject != y->subject) return (x->subject > y->subject) - (x->subject < y->subject);
    return (x->value > y->value) - (x->value < y->value);
}

plm_status plm_repeatability_measure(const double *value, const uint32_t *subject, size_t n,
                                     plm_repeatability *repeatability, plm_error *error)
{
    measured *list = plm_alloc(n, sizeof *list, error);
    double *own = plm_alloc(n, sizeof *own, error);
    if (!list || !own) {
        plm_free(list);
        plm_free(own);
        return PLM_E_MEMORY;
    }
    for (size_t i = 0; i < n; i++) list[i] = (measured){subject[i], value[i]};
    qsort(list, n, sizeof *list, by_subject);
    const double grand = plm_mean(value, n);
    double within = 0, between = 0, count_squares = 0;
    size_t subjects = 0;
    for (size_t begin = 0, end; begin < n; begin = end) {
        for (end = begin; end < n && list[end].subject == list[begin].subject; end++)
            own[end - begin] = list[end].value;
        const size_t count = end - begin;
        const double mean = plm_mean(own, count);
        within += plm_sum_products(own, mean, own, mean, count);
        between += (double)count * (mean - grand) * (mean - grand);
        count_squares += (double)count * (double)count;
        subjects++;
    }
    plm_free(list);
    plm_free(own);
    *repeatability = (plm_repeatability){NAN, NAN, subjects, n - subjects};
    if (n == subjects) return PLM_OK;
    const double ms_within = within / (double)(n - subjects);
    repeatability->sd_within = sqrt(ms_within);
    if (subjects < 2) return PLM_OK;
    const double ms_between = between / (double)(subjects - 1);
    const double k = ((double)n - count_squares / (double)n) / (double)(subjects - 1);
    const double total = ms_between + (k - 1) * ms_within;
    if (total > 0) repeatability->icc = (ms_between - ms_within) / total;
    return PLM_OK;
}
