/* simulate/light_rays.c: where rays start, where they are absorbed, reflected and transmitted. Each batch holds rays of one source
 * that run side by side, so that eight of them go through the tree at once. */
#include "simulate/light_rays.h"

#include <math.h>
#include <string.h>

#include "cloud/linear.h"
#include "cloud/random.h"
#include "simulate/turn.h"

/* Number i of ray k of a source, in [0, 1): the R5 sequence (M. Roberts, 2018: powers of the root of x^6 = x + 1), shifted. */
static inline double spread(const double shift[5], uint64_t k, int i)
{
    static const double step[5] = {0.8812714616335696, 0.7766393890897682, 0.6844301295853426, 0.6031687406857282,
                                   0.5315553977157913};
    const double at = shift[i] + step[i] * (double)(int)k;
    return at - (double)(int)at; /* at is not negative, and a part has fewer rays than an int holds */
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

void plm_light_start(const plm_light_run *run, int number, uint64_t first, size_t count, plm_ray_batch *batch)
{
    const plm_light_source *source = &run->source[number];
    float *const x = batch->place[0], *const y = batch->place[1];
    for (size_t k = 0; k < count; k++) {
        batch->share[0][k] = (float)spread(source->shift, first + k, 0);
        batch->share[1][k] = (float)spread(source->shift, first + k, 1);
    }
    for (size_t k = 0; k < count; k++) {
        float sine, cosine;
        const float r = 0.5F * sqrtf(batch->share[0][k]);
        plm_turn_of(batch->share[1][k], &sine, &cosine);
        x[k] = 0.5F + r * cosine;
        y[k] = 0.5F + r * sine;
    }
    plm_ray_order(x, y, count, batch->order);
    batch->count = count;
    batch->source = number;
    batch->first = first;
    for (int i = 0; i < 3; i++) {
        const float along = (float)-source->up[i], u = (float)(2 * run->radius * source->u[i]),
                    v = (float)(2 * run->radius * source->v[i]);
        const float corner =
            (float)(run->centre[i] + run->radius * (1.01 * source->up[i] - source->u[i] - source->v[i]));
        for (size_t at = 0; at < count; at++) {
            const size_t k = batch->order[at];
            batch->lanes.direction[i][at] = along;
            batch->lanes.origin[i][at] = corner + x[k] * u + y[k] * v;
        }
    }
}

/* A direction about a unit normal with density cosine / pi. */
static void scatter(const double normal[3], double first, double second, double direction[3])
{
    double u[3], v[3];
    float sine, cosine;
    const double r = sqrt(first), up = sqrt(fmax(1 - first, 0));
    plm_turn_of((float)second, &sine, &cosine);
    plm_frame_of_axis(normal, u, v);
    for (int i = 0; i < 3; i++) direction[i] = r * (double)cosine * u[i] + r * (double)sine * v[i] + up * normal[i];
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

/* Three numbers for what becomes of a ray at its hit number depth. */
static void draw_scatter(const plm_light_run *run, uint64_t key, int source, uint64_t number, int depth, double draw[3])
{
    if (depth == 0) {
        for (int i = 0; i < 3; i++) draw[i] = spread(run->source[source].shift, number, 2 + i);
    } else { /* a stream of its own: few rays get here */
        const uint64_t later = plm_key(key, 1000003 + number * 131072 + (uint64_t)source);
        for (int i = 0; i < 3; i++) draw[i] = plm_uniform_at(later, (uint64_t)(3 * depth + i));
    }
}

/* A ray that has met a face: what it leaves there, and where it goes on. False when nothing is left of it. */
static bool bounce(const plm_light_run *run, uint64_t key, int depth, plm_ray_batch *batch, size_t from, size_t to,
                   plm_light_tally *count)
{
    const plm_hit *hit = &batch->hit[from];
    const uint32_t *corner = run->mesh->triangle[hit->face];
    const double *n = run->normal[hit->face];
    double draw[3], after[3], before[3], band[PLM_LIGHT_BANDS];
    for (int b = 0; b < PLM_LIGHT_BANDS; b++) band[b] = depth ? batch->band[from][b] : 1.0 / PLM_LIGHT_BANDS;
    const uint16_t order = batch->order[from];
    const uint64_t energy = absorb(run, depth ? batch->energy[from] : PLM_PARCEL, band, &count->face[hit->face]);
    if (!energy) return false;
    draw_scatter(run, key, batch->source, batch->first + order, depth, draw);
    for (int i = 0; i < 3; i++) before[i] = (double)batch->lanes.direction[i][from];
    const bool is_front = plm_dot(n, before) < 0;
    /* reflected to the side it came from, transmitted to the other */
    const double sign = choose_side(run, draw[0], band) == is_front ? 1 : -1;
    const double side[3] = {sign * n[0], sign * n[1], sign * n[2]};
    scatter(side, draw[1], draw[2], after);
    for (int i = 0; i < 3; i++) {
        const double a = run->mesh->vertex[corner[0]][i], b = run->mesh->vertex[corner[1]][i],
                     c = run->mesh->vertex[corner[2]][i];
        batch->lanes.origin[i][to] = (float)(a + hit->u * (b - a) + hit->v * (c - a) + run->gap * side[i]);
        batch->lanes.direction[i][to] = (float)after[i];
    }
    memcpy(batch->band[to], band, sizeof band);
    batch->energy[to] = energy;
    batch->order[to] = order;
    return true;
}

void plm_light_follow(const plm_light_run *run, uint64_t key, plm_ray_batch *batch, plm_light_tally *count)
{
    for (int depth = 0; depth < run->options->depth && batch->count; depth++) {
        size_t kept = 0;
        count->rays += batch->count;
        plm_rays_first_many(run->rays, &batch->lanes, batch->count, depth == 0, batch->hit);
        for (size_t k = 0; k < batch->count; k++) {
            if (batch->hit[k].face == PLM_NO_HIT)
                count->escaped += depth ? batch->energy[k] : PLM_PARCEL;
            else
                kept += bounce(run, key, depth, batch, k, kept, count);
        }
        batch->count = kept;
    }
    for (size_t k = 0; k < batch->count; k++) count->escaped += batch->energy[k];
}
