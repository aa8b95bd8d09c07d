/* segment/halo.c: where noise is about as wide as petioles are thick, its far scatter fills what is between them and makes them look
 * wide. Structure is found on what is dense, and the scatter follows the nearest of that. */
#include "segment/halo.h"

#include "cloud/neighbours.h"
#include "segment/scratch.h"
#include "segment/threads.h"

#include <math.h>

/* Noise over R from which on petioles are blurred: small rosettes have 0.10 to 0.25 (0.5 mm of noise). Most seedlings of other kinds as
 * splats have just 0.100 (NOISE_RADII in scale.c), and of some forty two lost their petioles without their halo; six of 84 have 0.111 to
 * 0.125 and are as good without it. */
static const double BLURRED = 0.11;
/* Lengths in sigma, which here is as long as so many spacings at least (SPACINGS), so that some points are counted. */
static const double SPACINGS = 1.5;
static const double BALL = 0.8;   /* the radius in which points are counted */
static const double ABOUT = 2;    /* how far those reach that a count is held against: ... */
static const double DENSE = 0.95; /* ... this quantile of theirs */
/* Of the dense: less is scatter. Balls on a normal profile hold 0.2 of the most at 1.9 sigmas, beyond which 6 % of a sheet's
 * points lie. Voxel means, and whatever else has less noise than CLOSE spacings, have hardly more points amid the profile than at
 * its flanks. Of 66 rosettes 0.2 to 0.3, and 0.3 to 0.4, are as good; from 0.5 on leaves part. */
static const double THIN = 0.2, THIN_SPARSE = 0.35, CLOSE = 1.2;
/* Fewer points have no profile, nor do those of which each ball holds more than MOST in the mean (of PROBES): the plant is little
 * larger than its noise. */
enum { SAMPLE = 15000, LEAST = 300, MOST = 800, PROBES = 64 };

bool plm_has_halo(const plm_scale *scale)
{
    return scale->noise > BLURRED * scale->radius;
}

typedef struct halo {
    const plm_thinned *base;
    float *count;        /* of the points about each voxel */
    float (*sample)[3];  /* some of the voxels, evenly in Morton order ... */
    float *sample_count; /* ... and their counts */
    size_t samples;
    bool *keep;
    uint32_t *row;  /* count a thread */
    float *squared; /* count a thread */
} halo;

/* Whether balls hold no more than MOST voxels. */
static bool are_small(halo *h, const plm_index *index, double radius)
{
    const size_t step = h->base->count / PROBES + 1;
    size_t found = 0, probes = 0;
    for (size_t i = 0; i < h->base->count; i += step, probes++)
        found += plm_index_ball(index, h->base->xyz[i], (float)radius, 0, h->row, h->squared);
    return found <= MOST * probes;
}

/* How many points there are about each voxel; tell: whether that says anything. */
static plm_status count_points(halo *h, double radius, bool *tell, plm_error *error)
{
    const plm_thinned *base = h->base;
    plm_index *index = NULL;
    const plm_status status = plm_index_build((const float(*)[3])base->xyz, base->count, &index, error);
    if (status != PLM_OK) return status;
    *tell = are_small(h, index, radius);
    const int64_t count = *tell ? (int64_t)base->count : 0;
#pragma omp parallel for schedule(dynamic, 256)
    for (int64_t i = 0; i < count; i++) {
        uint32_t *row = h->row + plm_thread_number() * base->count;
        float *squared = h->squared + plm_thread_number() * base->count;
        const size_t found = plm_index_ball(index, base->xyz[i], (float)radius, base->count, row, squared);
        double sum = 0;
        for (size_t k = 0; k < found; k++) sum += base->voxels.size[row[k]];
        h->count[i] = (float)sum;
    }
    plm_index_free(index);
    return PLM_OK;
}

/* Keeps what is not thin against what is about it. */
static plm_status judge(halo *h, double radius, double thin, plm_error *error)
{
    const plm_thinned *base = h->base;
    const size_t step = base->count / SAMPLE + 1;
    for (size_t i = 0; i < base->count; i += step) {
        for (int axis = 0; axis < 3; axis++) h->sample[h->samples][axis] = base->xyz[i][axis];
        h->sample_count[h->samples++] = h->count[i];
    }
    plm_index *index = NULL;
    const plm_status status = plm_index_build((const float(*)[3])h->sample, h->samples, &index, error);
    if (status != PLM_OK) return status;
    const int64_t count = (int64_t)base->count;
#pragma omp parallel for schedule(dynamic, 256)
    for (int64_t i = 0; i < count; i++) {
        uint32_t *row = h->row + plm_thread_number() * base->count;
        float *squared = h->squared + plm_thread_number() * base->count;
        const size_t found = plm_index_ball(index, base->xyz[i], (float)radius, h->samples, row, squared);
        for (size_t k = 0; k < found; k++) squared[k] = h->sample_count[row[k]];
        h->keep[i] = !found || h->count[i] >= thin * plm_quantile(squared, found, DENSE);
    }
    plm_index_free(index);
    return PLM_OK;
}

plm_status plm_halo_drop(plm_thinned *base, const plm_scale *scale, plm_error *error)
{
    if (base->count < LEAST) return PLM_OK;
    plm_scratch scratch = {.error = error};
    const size_t count = base->count, threads = plm_thread_count();
    halo h = {.base = base};
    h.count = plm_scratch_take(&scratch, count, sizeof *h.count);
    h.sample = plm_scratch_take(&scratch, count, sizeof *h.sample);
    h.sample_count = plm_scratch_take(&scratch, count, sizeof *h.sample_count);
    h.keep = plm_scratch_take(&scratch, count, sizeof *h.keep);
    h.row = plm_scratch_take(&scratch, threads * count, sizeof *h.row);
    h.squared = plm_scratch_take(&scratch, threads * count, sizeof *h.squared);
    const double sigma = fmax(scale->noise, SPACINGS * scale->spacing);
    const double thin = scale->noise > CLOSE * scale->spacing ? THIN : THIN_SPARSE;
    bool tell = false;
    size_t kept = 0;
    plm_status status = scratch.failed ? PLM_E_MEMORY : count_points(&h, BALL * sigma, &tell, error);
    if (status == PLM_OK && tell) status = judge(&h, ABOUT * sigma, thin, error);
    for (size_t i = 0; status == PLM_OK && tell && i < count; i++) kept += h.keep[i];
    if (status == PLM_OK && 2 * kept > count) status = plm_thinned_keep(base, h.keep, error);
    plm_scratch_free(&scratch, NULL);
    return status;
}
