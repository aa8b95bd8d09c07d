/* traits/tube_moment.c: noise that comes near to the radius leaves no ring: a tube that is fitted to the points then leans across the stem
 * and comes out slim. The axis of the whole organ still tells the direction, and noise adds to the mean square of the distances from
 * it whatever becomes of the ring. */
#include "traits/tube_moment.h"

#include "cloud/linear.h"
#include "cloud/order.h"
#include "traits/tube_fit.h"

#include <math.h>

/* What adds to the mean square: of the noise's square (that along the normal, of the whole plant), and of the voxel's. (80 virtual stems from
 * depth cameras whose noise is more than 0.3 of the radius; the error is 0.066 of the diameter then. In doubt are so much of the noise's square
 * and of the diameter.) */
static const double of_noise = 2.0, of_voxel = 0.25, noise_unknown = 0.5, unknown = 0.05;
static const double least_square = 0.09; /* of the mean square, which the radius' is at least */
static const double far = 3;             /* medians of the distance: farther points are of something else */
static const double seen = 0.7; /* of the directions: those that have a part of their even share of the points */
static const double even_part = 0.25;
enum { FEWEST = 24, ROUNDS = 3 };

static double off_middle(const double at[2], const double middle[2])
{
    const double x = at[0] - middle[0], y = at[1] - middle[1];
    return x * x + y * y;
}

/* Mean square of distances from the middle of those that are not far, and its standard error. */
static double mean_square(const double (*flat)[2], size_t count, double *std_error)
{
    double squared[PLM_MOMENT_POINTS];
    double middle[2] = {0}, limit = INFINITY, sum = 0, squares = 0;
    size_t used = 0;
    for (int round = 0; round <= ROUNDS; round++) {
        double total[2] = {0};
        size_t kept = 0;
        for (size_t i = 0; i < count; i++) {
            if (round && off_middle(flat[i], middle) > limit) continue;
            for (int c = 0; c < 2; c++) total[c] += flat[i][c];
            kept++;
        }
        for (int c = 0; c < 2; c++) middle[c] = total[c] / (double)kept;
        for (size_t i = 0; i < count; i++) squared[i] = off_middle(flat[i], middle);
        limit = far * far * plm_order_median(squared, count);
    }
    for (size_t i = 0; i < count; i++) {
        const double d = off_middle(flat[i], middle);
        if (d > limit) continue;
        sum += d;
        squares += d * d;
        used++;
    }
    const double mean = sum / (double)used;
    *std_error = sqrt(fmax(squares / (double)used - mean * mean, 0) / (double)used);
    return mean * (double)used / (double)(used - 1);
}

/* Whether the points lie all around a place. */
static bool is_ring(const double (*flat)[2], size_t count, const double place[2])
{
    size_t inside[PLM_TUBE_SECTORS] = {0}, covered = 0;
    for (size_t i = 0; i < count; i++) {
        const double turn = atan2(flat[i][1] - place[1], flat[i][0] - place[0]) / (2 * PLM_PI) + 0.5;
        const size_t sector = (size_t)(turn * PLM_TUBE_SECTORS);
        inside[sector < PLM_TUBE_SECTORS ? sector : PLM_TUBE_SECTORS - 1]++;
    }
    const double least = even_part * (double)count / PLM_TUBE_SECTORS;
    for (size_t s = 0; s < PLM_TUBE_SECTORS; s++) covered += (double)inside[s] >= least;
    return (double)covered >= seen * PLM_TUBE_SECTORS;
}

bool plm_tube_moment(const plm_moment_query *query, double *diameter, double *std_error)
{
    double flat[PLM_MOMENT_POINTS][2], u[3], v[3], square_error;
    const size_t count = query->count;
    const plm_sampling *sampling = query->sampling;
    if (count < FEWEST || count > PLM_MOMENT_POINTS) return false;
    plm_frame_of_axis(query->along, u, v);
    for (size_t i = 0; i < count; i++) flat[i][0] = plm_dot(query->xyz[i], u), flat[i][1] = plm_dot(query->xyz[i], v);
    const double place[2] = {plm_dot(query->place, u), plm_dot(query->place, v)};
    const double(*ring)[2] = (const double(*)[2])flat;
    if (!is_ring(ring, count, place)) return false;
    const double square = mean_square(ring, count, &square_error);
    const double voxel = sampling->pitch > 0 ? sampling->pitch : sampling->spacing;
    const double noise2 = sampling->noise * sampling->noise;
    const double radius = sqrt(fmax(square - of_noise * noise2 - of_voxel * voxel * voxel, least_square * square));
    if (!(radius > 0)) return false;
    *diameter = 2 * radius;
    *std_error =
        sqrt(pow(square_error / radius, 2) + pow(noise_unknown * noise2 / radius, 2) + pow(unknown * *diameter, 2));
    return true;
}
