/* segment/sparse_tips.c: scanners and fits to photographs see the tip of a leaf less often than its blade, so points lie two to
 * five times as far apart there, as floaters do that come near a plant. But a tip is led to step by step, in the plane of what
 * is before it: so what was dropped is looked at from the kept surface on, a seam at a time. Of the points that
 * 12 virtual maize as splats lose nearly all are found. */
#include "segment/sparse_tips.h"

#include <math.h>

#include "cloud/linear.h"
#include "cloud/order.h"
#include "cloud/sampling.h"
#include "segment/scratch.h"
#include "segment/subset.h"

enum {
    FIT = 16,       /* kept neighbours that the plane is of */
    LEAST = 8,      /* of them, at least */
    LOOK = 64,      /* neighbours among which kept ones are looked for */
    USUAL = 6,      /* nearest of them, whose own spacing is usual */
    FOURTH = 4,     /* spacing: distance to the fourth kept one */
    CLOSE = 8,      /* neighbours that tell voxel means, as in cloud/sampling.h */
    BOX = 8,        /* edge of a box of points, in cells */
    ENOUGH = 80000, /* points in boxes */
};

static const double flat = 0.35; /* thickness over length of what is before it, at most */
/* Than usual, at most. At 2 a tip of a virtual maize that ends at four points a step was lost (29 mm); at 3 floaters are hardly more
 * (24 of 21 600 beside 96 virtual splats). */
static const double farther = 3;
static const double off_rest = 3,
                    off_usual = 0.5; /* off the plane: in what the neighbours are off it, or in the usual spacing */

typedef struct tips {
    const plm_index *index;
    const float (*xyz)[3];
    const bool *drop;
} tips;

/* The nearest kept points to a point but itself, at most as many as wanted. */
static size_t kept_near(const tips *t, uint32_t point, size_t wanted, uint32_t *row, float *squared)
{
    uint32_t near[LOOK];
    float far[LOOK];
    const size_t found = plm_index_neighbours(t->index, point, LOOK, near, far);
    size_t kept = 0;
    for (size_t j = 0; j < found && kept < wanted; j++) {
        if (t->drop[near[j]]) continue;
        row[kept] = near[j];
        squared[kept++] = far[j];
    }
    return kept;
}

/* Median over the nearest ones of their distance to their fourth kept neighbour, squared; 0 where that is not told. */
static float usual_spacing(const tips *t, const uint32_t *row)
{
    float value[USUAL];
    size_t values = 0;
    for (int j = 0; j < USUAL; j++) {
        uint32_t near[FOURTH];
        float squared[FOURTH];
        if (kept_near(t, row[j], FOURTH, near, squared) == FOURTH) value[values++] = squared[FOURTH - 1];
    }
    plm_order_sort(value, values);
    return values ? value[values / 2] : 0;
}

/* Distance of a point from the plane of others, and how far (RMS) those are off it. False where they are no sheet: floaters hold
 * each other in all directions. */
static bool off_plane(const tips *t, uint32_t point, const uint32_t *row, size_t rows, double *off, double *rest)
{
    double mean[3] = {0}, m[6] = {0}, value[3], axis[3][3], d[3];
    for (size_t j = 0; j < rows; j++)
        for (int a = 0; a < 3; a++) mean[a] += (double)t->xyz[row[j]][a] / (double)rows;
    for (size_t j = 0; j < rows; j++) {
        for (int a = 0; a < 3; a++) d[a] = t->xyz[row[j]][a] - mean[a];
        m[0] += d[0] * d[0], m[1] += d[0] * d[1], m[2] += d[0] * d[2];
        m[3] += d[1] * d[1], m[4] += d[1] * d[2], m[5] += d[2] * d[2];
    }
    plm_eigen3(m, value, axis);
    for (int a = 0; a < 3; a++) d[a] = t->xyz[point][a] - mean[a];
    *off = fabs(plm_dot(d, axis[2]));
    *rest = sqrt(fmax(value[2], 0) / (double)rows);
    return value[2] < flat * flat * value[0];
}

static bool goes_on(const tips *t, uint32_t point)
{
    uint32_t row[FIT];
    float squared[FIT];
    const size_t rows = kept_near(t, point, FIT, row, squared);
    if (rows < LEAST) return false;
    const double usual = sqrt((double)usual_spacing(t, row));
    if (!(sqrt((double)squared[FOURTH - 1]) < farther * usual)) return false;
    double off, rest;
    return off_plane(t, point, row, rows, &off, &rest) && off < fmax(off_rest * rest, off_usual * usual);
}

plm_status plm_sparse_tips(const plm_index *index, const float (*xyz)[3], size_t count, const bool *drop, bool *tip,
                           plm_error *error)
{
    plm_scratch scratch = {.error = error};
    uint32_t *dropped = plm_scratch_take(&scratch, count, sizeof *dropped);
    bool *back = plm_scratch_take(&scratch, count, sizeof *back);
    bool *still = plm_scratch_take(&scratch, count, sizeof *still);
    const tips t = {index, xyz, still};
    size_t left = 0, seam = 1;
    for (uint32_t i = 0; !scratch.failed && i < count; i++) {
        still[i] = drop[i];
        if (drop[i]) dropped[left++] = i;
    }
    while (seam && left) {
        const int64_t rows = (int64_t)left;
#pragma omp parallel for schedule(dynamic, 64)
        for (int64_t k = 0; k < rows; k++) back[k] = goes_on(&t, dropped[k]);
        left = seam = 0;
        for (int64_t k = 0; k < rows; k++) {
            if (back[k])
                still[dropped[k]] = false, seam++;
            else
                dropped[left++] = dropped[k];
        }
    }
    for (size_t i = 0; !scratch.failed && i < count; i++) tip[i] = drop[i] && !still[i];
    plm_scratch_free(&scratch, NULL);
    return scratch.failed ? PLM_E_MEMORY : PLM_OK;
}

/* The points in some boxes, chosen by where these are: whole neighbourhoods, which points chosen one by one would tear. */
static size_t points_in_boxes(const float (*xyz)[3], size_t count, double edge, uint32_t mask, float (*out)[3])
{
    size_t taken = 0;
    for (size_t i = 0; i < count; i++) {
        float box[3];
        for (int a = 0; a < 3; a++) box[a] = mask ? floorf(xyz[i][a] / (float)edge) : 0;
        uint32_t bits = plm_point_bits(box); /* of whole numbers, whose last bits are alike */
        bits = (bits ^ bits >> 16) * UINT32_C(0x7FEB352D);
        bits = (bits ^ bits >> 15) * UINT32_C(0x846CA68B);
        if ((bits ^ bits >> 16) & mask) continue;
        for (int a = 0; a < 3; a++) out[taken][a] = xyz[i][a];
        taken++;
    }
    return taken;
}

plm_status plm_are_voxel_means(const float (*xyz)[3], size_t count, double cell, bool *answer, plm_error *error)
{
    plm_scratch scratch = {.error = error};
    float(*some)[3] = plm_scratch_take(&scratch, count, sizeof *some);
    size_t taken = 0;
    uint32_t mask = 2 * plm_subset_mask(count, ENOUGH) + 1;
    do mask /= 2, taken = some ? points_in_boxes(xyz, count, BOX * cell, mask, some) : 0;
    while (some && mask && taken < ENOUGH / 8);
    float *squared = plm_scratch_take(&scratch, taken * CLOSE + 1, sizeof *squared);
    plm_status status = scratch.failed ? PLM_E_MEMORY : PLM_OK;
    if (status == PLM_OK && taken > CLOSE)
        status = plm_neighbour_table((const float(*)[3])some, taken, CLOSE, NULL, squared, error);
    size_t close = 0;
    for (size_t i = 0; status == PLM_OK && i < taken && taken > CLOSE; i++)
        close += plm_neighbour_is_close(squared + i * CLOSE, CLOSE);
    *answer = taken <= CLOSE || plm_close_share_is_fused((double)close / (double)taken);
    plm_scratch_free(&scratch, NULL);
    return status;
}

plm_status plm_label_tips(const plm_cloud *cloud, const bool *keep, const bool *tip, plm_segmentation *segmentation,
                          plm_error *error)
{
    size_t wanted = 0, kept = 0;
    for (size_t i = 0; i < cloud->count; i++) wanted += tip[i];
    if (!wanted) return PLM_OK;
    plm_scratch scratch = {.error = error};
    float(*xyz)[3] = plm_scratch_take(&scratch, cloud->count, sizeof *xyz);
    uint32_t *row = plm_scratch_take(&scratch, cloud->count, sizeof *row);
    plm_index *index = NULL;
    for (size_t i = 0; !scratch.failed && i < cloud->count; i++) {
        if (!keep[i] || segmentation->label[i] == PLM_LABEL_GROUND) continue;
        for (int a = 0; a < 3; a++) xyz[kept][a] = cloud->xyz[i][a];
        row[kept++] = (uint32_t)i;
    }
    const plm_status status =
        scratch.failed ? PLM_E_MEMORY : plm_index_build((const float(*)[3])xyz, kept, &index, error);
    for (size_t i = 0; status == PLM_OK && kept && i < cloud->count; i++) {
        uint32_t near;
        if (!tip[i]) continue;
        plm_index_nearest(index, cloud->xyz[i], 1, &near, NULL);
        segmentation->label[i] = segmentation->label[row[near]];
        segmentation->organ[i] = segmentation->organ[row[near]];
        if (segmentation->leaflet) segmentation->leaflet[i] = segmentation->leaflet[row[near]];
    }
    plm_index_free(index);
    plm_scratch_free(&scratch, NULL);
    return status;
}
