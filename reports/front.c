/* reports/front.c: the Pareto front of cost and error. Tables of settings are short: every pair is looked at. */
#include "reports/front.h"

#include <math.h>

static bool counts(const double *cost, const double *error, const bool *takes_part, size_t i)
{
    return takes_part[i] && isfinite(cost[i]) && isfinite(error[i]);
}

static bool beats(const double *cost, const double *error, size_t a, size_t b)
{
    return cost[a] <= cost[b] && error[a] <= error[b] && (cost[a] < cost[b] || error[a] < error[b]);
}

void plm_front_mark(const double *cost, const double *error, const bool *takes_part, size_t count, bool *is_on)
{
    for (size_t i = 0; i < count; i++) {
        is_on[i] = counts(cost, error, takes_part, i);
        for (size_t k = 0; k < count && is_on[i]; k++)
            if (counts(cost, error, takes_part, k) && beats(cost, error, k, i)) is_on[i] = false;
    }
}

size_t plm_front_cheapest(const double *cost, const double *error, const bool *takes_part, size_t count, double most)
{
    size_t best = count;
    for (size_t i = 0; i < count; i++) {
        if (!counts(cost, error, takes_part, i) || error[i] > most) continue;
        if (best == count || beats(cost, error, i, best) || cost[i] < cost[best]) best = i;
    }
    return best;
}
