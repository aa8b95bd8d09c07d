/* segment/sparse_tips.c: scanners and fits to photographs see the tip of a leaf less often than its blade, so points lie two to
 * five times as far apart there, as floaters do that come near a plant. But a tip is led to step by step, in the plane of what
 * is before it, and the sparse foot of a stem on the tube: so what was dropped is looked at from the kept surface on, a seam at
 * a time. Of the points that 12 virtual maize as splats lose nearly all are found. */
#include "segment/sparse_tips.h"

#include <math.h>

#include "cloud/linear.h"
#include "cloud/order.h"
#include "cloud/sampling.h"
#include "segment/scratch.h"
#include "segment/subset.h"

enum {
    FIT = 16,        /* kept neighbours that the plane is of */
    LEAST = 8,       /* of them, at least */
    LOOK = 64,       /* neighbours among which kept ones are looked for */
    TUBE = 192,      /* kept neighbours that a tube is told by at most, */
    TUBE_LEAST = 24, /* and at least: */
    TUBE_LOOK = 256, /* among so many */
    USUAL = 6,       /* nearest of them, whose own spacing is usual */
    FOURTH = 4,      /* spacing: distance to the fourth kept one */
    CLOSE = 8,       /* neighbours that tell voxel means, as in cloud/sampling.h */
    BOX = 8,         /* edge of a box of points, in cells */
    ENOUGH = 80000,  /* points in boxes */
};

static const double flat = 0.35; /* thickness over length of what is before it, at most */
/* Than usual, at most. At 2 a tip of a virtual maize that ends at four points a step was lost (29 mm); at 3 floaters are hardly more
 * (24 of 21 600 beside 96 virtual splats). */
static const double farther = 3;
static const double farthest = 4; /* the same in a plane, where there are no floaters */
/* Floaters are anywhere: where none was dropped that far off, in what is usual of the nearest kept points, nearer ones are none. */
static const double anywhere = 5, rare = 0.002,
                    noise_free = 0.05; /* dropped points, of all; noise over usual spacing */
static const double off_rest = 3,
                    off_usual = 0.5; /* off the plane: in what the neighbours are off it, or in the usual spacing */

/* Tubes: width over length of what is before the point, at most, and thickness over width, at least; spread of the points' distances
 * from the axis over their mean, at most; how far off that mean (of it, and off_rest spreads) the point may be; how many of them may lie
 * beyond it. */
static const double slim = 0.6, round_across = 0.5, hollow = 0.55, off_mean = 0.15, end_share = 0.1;

typedef struct tips {
    const plm_index *index;
    const float (*xyz)[3];
    const bool *drop;
    double spared; /* usual spacing from which on what lies near is kept; INFINITY: none (see spared_spacing) */
} tips;

/* The nearest kept points to a point but itself, at most as many as wanted. */
static size_t kept_near(const tips *t, uint32_t point, size_t wanted, uint32_t *row, float *squared)
{
    uint32_t near[TUBE_LOOK];
    float far[TUBE_LOOK];
    const size_t found = plm_index_neighbours(t->index, point, wanted > FIT ? TUBE_LOOK : LOOK, near, far);
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

/** Points, and their principal axes. */
typedef struct shape {
    double mean[3], value[3], axis[3][3]; /* value: sums of squares, the largest first */
} shape;

static shape shape_of(const tips *t, const uint32_t *row, size_t rows)
{
    shape s = {0};
    double m[6] = {0}, d[3];
    for (size_t j = 0; j < rows; j++)
        for (int a = 0; a < 3; a++) s.mean[a] += (double)t->xyz[row[j]][a] / (double)rows;
    for (size_t j = 0; j < rows; j++) {
        for (int a = 0; a < 3; a++) d[a] = t->xyz[row[j]][a] - s.mean[a];
        m[0] += d[0] * d[0], m[1] += d[0] * d[1], m[2] += d[0] * d[2];
        m[3] += d[1] * d[1], m[4] += d[1] * d[2], m[5] += d[2] * d[2];
    }
    plm_eigen3(m, s.value, s.axis);
    return s;
}

/* Whether a point lies in the plane of the kept ones before it, within what those are off it. Not where they are no sheet:
 * floaters hold each other in all directions. */
static bool goes_on_in_plane(const tips *t, uint32_t point, const uint32_t *row, size_t rows, double usual)
{
    const shape s = shape_of(t, row, rows);
    double d[3];
    for (int a = 0; a < 3; a++) d[a] = t->xyz[point][a] - s.mean[a];
    const double off = fabs(plm_dot(d, s.axis[2])), rest = sqrt(fmax(s.value[2], 0) / (double)rows);
    return s.value[2] < flat * flat * s.value[0] && off < fmax(off_rest * rest, off_usual * usual);
}

/* Where a point lies against the longest axis. */
static void place_on_axis(const tips *t, uint32_t point, const shape *s, double *along, double *off)
{
    double d[3];
    for (int a = 0; a < 3; a++) d[a] = t->xyz[point][a] - s->mean[a];
    *along = plm_dot(d, s->axis[0]);
    *off = hypot(plm_dot(d, s->axis[1]), plm_dot(d, s->axis[2]));
}

/* Whether a point lies on the tube that the kept ones are of, behind its end: as far off its axis as they are. */
static bool goes_on_as_tube(const tips *t, uint32_t point, const shape *s, const uint32_t *row, size_t rows)
{
    double along, off, mean = 0, squares = 0;
    size_t beyond = 0;
    place_on_axis(t, point, s, &along, &off);
    for (size_t j = 0; j < rows; j++) {
        double other, radius;
        place_on_axis(t, row[j], s, &other, &radius);
        beyond += along > 0 ? other > along : other < along;
        mean += radius / (double)rows;
        squares += radius * radius / (double)rows;
    }
    const double spread = sqrt(fmax(squares - mean * mean, 0));
    return (double)beyond < end_share * (double)rows && spread < hollow * mean &&
           fabs(off - mean) < off_rest * spread + off_mean * mean;
}

/* Enough kept neighbours to tell the tube by, if they are of one: several times longer than it is wide, and about as wide across. */
static bool goes_on_in_tube(const tips *t, uint32_t point)
{
    uint32_t row[TUBE];
    float squared[TUBE];
    const size_t found = kept_near(t, point, TUBE, row, squared);
    for (size_t rows = TUBE_LEAST; rows <= found; rows *= 2) {
        const shape s = shape_of(t, row, rows);
        if (s.value[1] < slim * slim * s.value[0] && s.value[2] > round_across * round_across * s.value[1])
            return goes_on_as_tube(t, point, &s, row, rows);
    }
    return false;
}

/* Scanners without noise see the hidden sides of thin petioles here and there, which are dropped. A few dropped points of which none lies
 * far from all that was kept are no floaters, as those are anywhere. Gives the spacing against which the noise is none; INFINITY:
 * there may be floaters. */
static double spared_spacing(const tips *t, size_t count, const uint32_t *dropped, size_t left)
{
    double noise;
    plm_error ignored;
    if (left == 0 || (double)left > rare * (double)count) return INFINITY;
    for (size_t i = 0; i < left; i++) {
        uint32_t row[FIT];
        float squared[FIT];
        const size_t rows = kept_near(t, dropped[i], FIT, row, squared);
        if (rows < LEAST || sqrt((double)squared[0]) > anywhere * sqrt((double)usual_spacing(t, row))) return INFINITY;
    }
    return plm_noise_measure(t->index, t->xyz, count, &noise, &ignored) == PLM_OK ? noise / noise_free : INFINITY;
}

static bool goes_on(const tips *t, uint32_t point)
{
    uint32_t row[FIT];
    float squared[FIT];
    const size_t rows = kept_near(t, point, FIT, row, squared);
    if (rows < LEAST) return false;
    const double usual = sqrt((double)usual_spacing(t, row));
    const double far = sqrt((double)squared[FOURTH - 1]);
    if (!(far < farthest * usual)) return false;
    const bool in_plane = goes_on_in_plane(t, point, row, rows, usual), spared = usual > t->spared;
    if (!(far < farther * usual)) return in_plane && spared;
    return in_plane || spared || goes_on_in_tube(t, point);
}

plm_status plm_sparse_tips(const plm_index *index, const float (*xyz)[3], size_t count, const bool *drop, bool *tip,
                           plm_error *error)
{
    plm_scratch scratch = {.error = error};
    uint32_t *dropped = plm_scratch_take(&scratch, count, sizeof *dropped);
    bool *back = plm_scratch_take(&scratch, count, sizeof *back);
    bool *still = plm_scratch_take(&scratch, count, sizeof *still);
    tips t = {index, xyz, still, INFINITY};
    size_t left = 0, seam = 1;
    for (uint32_t i = 0; !scratch.failed && i < count; i++) {
        still[i] = drop[i];
        if (drop[i]) dropped[left++] = i;
    }
    t.spared = spared_spacing(&t, count, dropped, left);
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
