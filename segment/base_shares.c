/* segment/base_shares.c: the blades of a plant, but for a rosette's of different ages, begin alike. In noise a narrow lobe that begins late is nearly as likely as a wide
 * one that begins early, and one side of one leaf hardly tells which; the sides of all leaves together tell what outlines the plant
 * has. So the outlines are a mixture with the same shares at all sides, found by expectation and maximisation (A. P. Dempster,
 * N. M. Laird, D. B. Rubin 1977) from what each side says of outline and junction. */
#include "segment/blade_base.h"

#include <math.h>

static const double ALIKE = 4; /* sides that have all outlines alike, added to the plant's */
enum { STEPS = 10, ROWS = PLM_BASE_ROWS, OUTLINES = PLM_BASE_OUTLINES };

/* Logarithm of the likelihood of one side's points with outlines of these shares. */
static double side_evidence(const float value[OUTLINES], const double share[OUTLINES])
{
    double best = -INFINITY, sum = 0;
    for (size_t which = 0; which < OUTLINES; which++) best = fmax(best, (double)value[which]);
    for (size_t which = 0; which < OUTLINES; which++) sum += share[which] * exp((double)value[which] - best);
    return best + log(sum);
}

double plm_base_evidence(const plm_base_table *table, int row, const double share[OUTLINES])
{
    if (isinf(table->rest[row])) return -INFINITY;
    return table->rest[row] + side_evidence(table->likelihood[row][0], share) +
           side_evidence(table->likelihood[row][1], share);
}

void plm_base_any(double share[OUTLINES])
{
    for (size_t which = 0; which < OUTLINES; which++) share[which] = 1.0 / OUTLINES;
}

/* How likely each row is, 0 where hardly; they add up to 1. */
static void row_weights(const plm_base_table *table, const double share[OUTLINES], double weight[ROWS])
{
    double best = -INFINITY, sum = 0;
    for (int k = 0; k < ROWS; k++) best = fmax(best, weight[k] = plm_base_evidence(table, k, share));
    for (int k = 0; k < ROWS; k++) sum += weight[k] = weight[k] < best - PLM_BASE_UNLIKELY ? 0 : exp(weight[k] - best);
    for (int k = 0; k < ROWS; k++) weight[k] /= sum;
}

double plm_base_mean(const plm_base_table *table, const double share[OUTLINES])
{
    double weight[ROWS], mean = 0;
    row_weights(table, share, weight);
    for (int k = 0; k < ROWS; k++) mean += weight[k] * k;
    return table->first + mean * table->step;
}

/* Adds the outlines that the sides of a leaf have, each side 1 in all. */
static void add_sides(const plm_base_table *table, const double share[OUTLINES], double found[OUTLINES])
{
    double weight[ROWS];
    row_weights(table, share, weight);
    for (int k = 0; k < ROWS; k++)
        for (int s = 0; weight[k] > 0 && s < 2; s++) {
            const float *value = table->likelihood[k][s];
            const double side = side_evidence(value, share);
            for (size_t which = 0; which < OUTLINES; which++)
                found[which] += weight[k] * share[which] * exp((double)value[which] - side);
        }
}

void plm_base_shares(const plm_base_table *const *table, size_t count, double share[OUTLINES])
{
    plm_base_any(share);
    for (int step = 0; step < STEPS; step++) {
        double found[OUTLINES];
        for (size_t which = 0; which < OUTLINES; which++) found[which] = ALIKE / OUTLINES;
        for (size_t i = 0; i < count; i++) add_sides(table[i], share, found);
        for (size_t which = 0; which < OUTLINES; which++) share[which] = found[which] / (ALIKE + 2 * (double)count);
    }
}
