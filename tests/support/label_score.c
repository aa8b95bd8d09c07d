/* tests/support/label_score.c: intersections over unions of classes and of leaves. */
#include "support/label_score.h"

#include <math.h>

enum { LEAF_POINTS = 10 };

static bool counts(uint8_t label)
{
    return label == PLM_LABEL_STEM || label == PLM_LABEL_PETIOLE || label == PLM_LABEL_LEAF;
}

static double ratio(size_t intersection, size_t truth, size_t found)
{
    const size_t either = truth + found - intersection;
    return either ? (double)intersection / (double)either : NAN;
}

static double mean_of_present(double a, double b)
{
    return isnan(a) ? b : isnan(b) ? a : (a + b) / 2;
}

static void score_classes(size_t count, const uint8_t *true_label, const uint8_t *label, label_score *score)
{
    size_t both[PLM_LABEL_COUNT] = {0}, truth[PLM_LABEL_COUNT] = {0}, found[PLM_LABEL_COUNT] = {0};
    size_t axis_both = 0, axis_truth = 0, axis_found = 0;
    for (size_t i = 0; i < count; i++) {
        if (!counts(true_label[i])) continue;
        const bool is_axis = label[i] == PLM_LABEL_STEM || label[i] == PLM_LABEL_PETIOLE;
        const bool was_axis = true_label[i] != PLM_LABEL_LEAF;
        score->points++;
        truth[true_label[i]]++;
        found[label[i]]++;
        if (label[i] == true_label[i]) both[label[i]]++;
        axis_truth += was_axis;
        axis_found += is_axis;
        axis_both += was_axis && is_axis;
    }
    for (int c = 0; c < PLM_LABEL_COUNT; c++) score->iou[c] = ratio(both[c], truth[c], found[c]);
    score->iou_axis = ratio(axis_both, axis_truth, axis_found);
    score->iou_mean = mean_of_present(score->iou_axis, score->iou[PLM_LABEL_LEAF]);
}

static size_t organ_room(size_t count, const uint8_t *label, const int32_t *organ)
{
    int32_t most = -1;
    for (size_t i = 0; i < count; i++)
        if (label[i] == PLM_LABEL_LEAF && organ[i] > most) most = organ[i];
    return (size_t)(most + 1);
}

plm_status label_score_compute(size_t count, const uint8_t *true_label, const int32_t *true_organ, const uint8_t *label,
                               const int32_t *organ, label_score *score, plm_error *error)
{
    const size_t rows = organ_room(count, true_label, true_organ), columns = organ_room(count, label, organ);
    size_t *table = plm_alloc_zero((rows + 1) * (columns + 1), sizeof *table, error); /* last row and column: sums */
    if (!table) return PLM_E_MEMORY;
    label_score out = {.worst_leaf = 1};
    score_classes(count, true_label, label, &out);
    for (size_t i = 0; i < count; i++) {
        if (!counts(true_label[i])) continue;
        const size_t r = true_label[i] == PLM_LABEL_LEAF && true_organ[i] >= 0 ? (size_t)true_organ[i] : rows;
        const size_t c = label[i] == PLM_LABEL_LEAF && organ[i] >= 0 ? (size_t)organ[i] : columns;
        if (r < rows) table[r * (columns + 1) + columns]++;
        if (c < columns) table[rows * (columns + 1) + c]++;
        if (r < rows && c < columns) table[r * (columns + 1) + c]++;
    }
    for (size_t c = 0; c < columns; c++) out.leaves_found += table[rows * (columns + 1) + c] > 0;
    for (size_t r = 0; r < rows; r++) {
        const size_t truth = table[r * (columns + 1) + columns];
        if (truth < LEAF_POINTS) continue;
        out.leaves++;
        double best = 0;
        for (size_t c = 0; c < columns; c++)
            best = fmax(best, ratio(table[r * (columns + 1) + c], truth, table[rows * (columns + 1) + c]));
        out.leaves_matched += best > 0.5;
        out.worst_leaf = fmin(out.worst_leaf, best);
    }
    out.f1 =
        out.leaves + out.leaves_found ? 2 * (double)out.leaves_matched / (double)(out.leaves + out.leaves_found) : 1;
    plm_free(table);
    *score = out;
    return PLM_OK;
}
