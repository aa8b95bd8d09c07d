/* simulate/light_rays.c: where rays start, where they are absorbed, reflected and transmitted. Each batch holds rays of one source
 * that run side by side, so that eight of them go through the tree at once. */
#include "simulate/light_rays.h"

#include <math.h>
#include <string.h>

#include "cloud/linear.h"
#include "simulate/random.h"

/* Number i of ray k of a source, in [0, 1): the R5 sequence (M. Roberts, 2018: powers of the root of x^6 = x + 1), shifted. */
static double spread(const double shift[5], uint64_t k, int i)
{
    static const double step[5] = {0.8812714616335696, 0.7766393890897682, 0.6844301295853426, 0.6031687406857282,
                                   0.5315553977157913};
    const double at = shift[i] + step[i] * (double)k;
    return at - (double)(int64_t)at; /* at is not negative */
}

/* Sine and cosine of a share of the full turn, in [0, 1). The series ends 1e-11 from the truth, at a third of the time that the
 * library's take, which are right for any angle. */
static inline void turn_of(double share, double *sine, double *cosine)
{
    const int quarter = (int)(4 * share + 0.5);
    const double x = (share - 0.25 * quarter) * (2 * PLM_PI), y = x * x; /* -pi/4 to pi/4 */
    const double s =
        x + x * y * (-1 / 6.0 + y * (1 / 120.0 + y * (-1 / 5040.0 + y * (1 / 362880.0 - y * (1 / 39916800.0)))));
    const double c =
        1 + y * (-0.5 +
                 y * (1 / 24.0 + y * (-1 / 720.0 + y * (1 / 40320.0 + y * (-1 / 3628800.0 + y * (1 / 479001600.0))))));
    const double swapped_s = quarter & 1 ? c : s, swapped_c = quarter & 1 ? s : c;
    *sine = quarter & 2 ? -swapped_s : swapped_s;
    *cosine = (quarter + 1) & 2 ? -swapped_c : swapped_c;
}

void plm_light_shift(plm_light_run *run, uint64_t key)
{
    for (int k = 0; k < run->options->circles * run->options->around; k++)
        for (int i = 0; i < 5; i++) run->source[k].shift[i] = plm_uniform_at(plm_key(key, (uint64_t)k), (uint64_t)i);
}

/* Direction to each source, and two axes across it. */
void plm_light_place_sources(plm_light_run *run)
{
    for (int k = 0; k < run->options->circles * run->options->around; k++) {
        const int circle = k / run->options->around, place = k % run->options->around;
        const double elevation = 0.5 * PLM_PI * (circle + 0.5) / run->options->circles;
        const double azimuth = 2 * PLM_PI * (place + 0.5 * (circle % 2)) / run->options->around;
        plm_light_source *source = &run->source[k];
        source->up[0] = cos(elevation) * cos(azimuth);
        source->up[1] = cos(elevation) * sin(azimuth);
        source->up[2] = sin(elevation);
        plm_frame_of_axis(source->up, source->u, source->v);
    }
}

uint32_t plm_curve_place(uint32_t column, uint32_t row)
{
    uint32_t place = 0;
    for (int bit = 0; bit < 6; bit++) place |= (column >> bit & 1) << (2 * bit) | (row >> bit & 1) << (2 * bit + 1);
    return place;
}

void plm_light_start(const plm_light_run *run, int number, uint64_t first, size_t count,
                     const uint16_t place[PLM_LIGHT_CELLS][PLM_LIGHT_CELLS], plm_ray_batch *batch)
{
    enum { CELLS = PLM_LIGHT_CELLS };
    const plm_light_source *source = &run->source[number];
    double across[PLM_RAY_BATCH][2];
    uint16_t cell[PLM_RAY_BATCH];
    uint32_t begin[CELLS * CELLS + 1] = {0};
    for (size_t k = 0; k < count; k++) {
        double sine, cosine;
        const double r = sqrt(spread(source->shift, first + k, 0));
        turn_of(spread(source->shift, first + k, 1), &sine, &cosine);
        across[k][0] = r * cosine;
        across[k][1] = r * sine;
        const int column = (int)((across[k][0] + 1.0001) * (CELLS / 2.0003)),
                  row = (int)((across[k][1] + 1.0001) * (CELLS / 2.0003));
        cell[k] = place[row][column];
        begin[cell[k] + 1]++;
    }
    for (int c = 0; c < CELLS * CELLS; c++) begin[c + 1] += begin[c];
    batch->count = count;
    batch->source = number;
    for (size_t k = 0; k < count; k++) {
        const size_t at = begin[cell[k]]++;
        for (int i = 0; i < 3; i++) {
            batch->direction[at][i] = -source->up[i];
            batch->origin[at][i] = run->centre[i] + run->radius * (1.01 * source->up[i] + across[k][0] * source->u[i] +
                                                                   across[k][1] * source->v[i]);
        }
        for (int b = 0; b < PLM_LIGHT_BANDS; b++) batch->band[at][b] = 1.0 / PLM_LIGHT_BANDS;
        batch->energy[at] = PLM_PARCEL;
        batch->number[at] = first + k;
    }
}

/* A direction about a unit normal with density cosine / pi. */
static void scatter(const double normal[3], double first, double second, double direction[3])
{
    double u[3], v[3], sine, cosine;
    const double r = sqrt(first), up = sqrt(fmax(1 - first, 0));
    turn_of(second, &sine, &cosine);
    plm_frame_of_axis(normal, u, v);
    for (int i = 0; i < 3; i++) direction[i] = r * cosine * u[i] + r * sine * v[i] + up * normal[i];
}

/* Leaves the absorbed share of the ray's energy on the face; gives the rest. band holds the shares of the bands in the energy. */
static uint64_t absorb(const plm_light_run *run, uint64_t energy, const double band[PLM_LIGHT_BANDS], uint64_t *face)
{
    double share = 0;
    for (int b = 0; b < PLM_LIGHT_BANDS; b++) share += band[b] * run->absorptance[b];
    uint64_t left = (uint64_t)(share * (double)energy + 0.5);
    left = left > energy ? energy : left;
    *face += left;
    return energy - left;
}

/* Reflected or transmitted; the bands' shares plm_light_follow. True when reflected. */
static bool choose_side(const plm_light_run *run, double draw, double band[PLM_LIGHT_BANDS])
{
    double reflected = 0, transmitted = 0, sum = 0;
    for (int b = 0; b < PLM_LIGHT_BANDS; b++) {
        reflected += band[b] * run->options->reflectance[b];
        transmitted += band[b] * run->options->transmittance[b];
    }
    const bool is_reflected = draw * (reflected + transmitted) < reflected;
    const double *share = is_reflected ? run->options->reflectance : run->options->transmittance;
    for (int b = 0; b < PLM_LIGHT_BANDS; b++) sum += band[b] *= share[b];
    for (int b = 0; b < PLM_LIGHT_BANDS; b++) band[b] /= sum;
    return is_reflected;
}

/* A ray that has met a face: what it leaves there, and where it goes on. False when nothing is left of it. */
static bool bounce(const plm_light_run *run, uint64_t key, int depth, plm_ray_batch *batch, size_t from, size_t to,
                   plm_light_tally *count)
{
    const plm_hit *hit = &batch->hit[from];
    const double *n = run->normal[hit->face], *before = batch->direction[from];
    double draw[3], origin[3], band[PLM_LIGHT_BANDS];
    memcpy(band, batch->band[from], sizeof band);
    const uint64_t number = batch->number[from],
                   energy = absorb(run, batch->energy[from], band, &count->face[hit->face]);
    if (!energy) return false;
    if (depth == 0) {
        for (int i = 0; i < 3; i++) draw[i] = spread(run->source[batch->source].shift, number, 2 + i);
    } else { /* a stream of its own: few rays get here */
        const uint64_t later = plm_key(key, 1000003 + number * 131072 + (uint64_t)batch->source);
        for (int i = 0; i < 3; i++) draw[i] = plm_uniform_at(later, (uint64_t)(3 * depth + i));
    }
    const bool is_front = plm_dot(n, before) < 0;
    /* reflected to the side it came from, transmitted to the other */
    const double sign = choose_side(run, draw[0], band) == is_front ? 1 : -1;
    const double side[3] = {sign * n[0], sign * n[1], sign * n[2]};
    for (int i = 0; i < 3; i++) origin[i] = batch->origin[from][i] + hit->t * before[i] + run->gap * side[i];
    scatter(side, draw[1], draw[2], batch->direction[to]);
    memcpy(batch->origin[to], origin, sizeof origin);
    memcpy(batch->band[to], band, sizeof band);
    batch->energy[to] = energy;
    batch->number[to] = number;
    return true;
}

/* Follows a batch hit by hit; it thins out on the way. */
void plm_light_follow(const plm_light_run *run, uint64_t key, plm_ray_batch *batch, plm_light_tally *count)
{
    for (int depth = 0; depth < run->options->depth && batch->count; depth++) {
        size_t kept = 0;
        count->rays += batch->count;
        plm_rays_first_many(run->rays, (const double(*)[3])batch->origin, (const double(*)[3])batch->direction,
                            batch->count, batch->hit);
        for (size_t k = 0; k < batch->count; k++) {
            if (batch->hit[k].face == PLM_NO_HIT)
                count->escaped += batch->energy[k];
            else
                kept += bounce(run, key, depth, batch, k, kept, count);
        }
        batch->count = kept;
    }
    for (size_t k = 0; k < batch->count; k++) count->escaped += batch->energy[k];
}
