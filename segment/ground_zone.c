/* segment/ground_zone.c: which points are ground by their place: below the soil's relief inside of the pot, on the wall,
 * on the rim, on the table. */
#include <math.h>
#include <string.h>

#include "cloud/linear.h"
#include "segment/ground_mark.h"

enum { SECTORS = 36, PROFILE = 96, LINE_ROUNDS = 4 };

/* ---- Soil and table ------------------------------------------------------------------------------------------- */

static bool within_wall(const void *context, const double p[3])
{
    const plm_marker *m = context;
    const plm_pot *pot = &m->scene->pot;
    return plm_pot_distance(pot, p) < plm_pot_radius(pot, p[2]) - 1.5 * m->cell;
}

static bool on_soil_level(const void *context, const double p[3])
{
    const plm_marker *m = context;
    return plm_within_level(&m->scene->level[m->scene->soil], 2 * m->cell, p);
}

static bool on_table_level(const void *context, const double p[3])
{
    const plm_marker *m = context;
    const plm_pot *pot = &m->scene->pot;
    return plm_within_level(&m->scene->level[m->scene->table], 2 * m->cell, p) &&
           plm_pot_distance(pot, p) > plm_pot_radius(pot, p[2]) + 1.5 * m->cell;
}

/* A point of the surface lies within 2.2 sigma (97 %) of its relief, or so many voxels: soil has bumps. */
static const double SOIL_BUMP = 0.3, EVEN_BUMP = 0.1;

static double slack_of(const plm_relief *relief, double bump)
{
    return fmax(2.2 * relief->sigma, bump);
}

static plm_status fit_reliefs(plm_marker *m, plm_error *error)
{
    const plm_ground_scene *s = m->scene;
    plm_status status = PLM_OK;
    double plane[3] = {0, 0, s->pot.soil};
    if (s->soil >= 0) memcpy(plane, s->level[s->soil].plane, sizeof plane);
    const double scatter = s->soil >= 0 ? s->level[s->soil].scatter : 0;
    if (s->soil >= 0 || s->pot.soil_seen) {
        status = plm_relief_fit(&s->stand, (const float(*)[3])m->place, m->cloud->count, plane,
                                fmax(2 * m->cell, 3 * scatter), s->has_pot ? within_wall : on_soil_level, m, &m->soil,
                                error);
        m->has_soil = status == PLM_OK;
        if (m->has_soil) m->soil_slack = slack_of(&m->soil, SOIL_BUMP * m->cell);
    }
    if (status == PLM_OK && s->table >= 0) {
        const plm_level *it = &s->level[s->table];
        status = plm_relief_fit(&s->stand, (const float(*)[3])m->place, m->cloud->count, it->plane,
                                fmax(2 * m->cell, 3 * it->scatter), on_table_level, m, &m->table, error);
        m->has_table = status == PLM_OK;
        if (m->has_table) m->table_slack = slack_of(&m->table, EVEN_BUMP * m->cell);
    }
    return status;
}

/* ---- Wall and rim --------------------------------------------------------------------------------------------- */

static const double WIDEST_PART = 1.2; /* radii of the wall within which the rim is looked for */
static const double THICKEST = 0.82;   /* the same: where it ends inwards at the latest */
/* Voxels between the wall's line below the soil and what was traced there, at most: more is a wall that bends. And how far it may be
 * carried up, in lengths of the wall that tell it. */
static const double BENT = 1.5, FARTHEST = 2;

/* Shares of the soil's density from which on points of a rim are more than stray ones, one after the other until an edge is seen:
 * much noise leaves few of a low rim's points above it. */
static const double DENSE[] = {0.25, 0.1, 0};
/* Share of the most sectors at which a rim ends that has no end at half of all. */
static const double SHARP = 0.75;

static int count_bits(uint64_t bits)
{
    int n = 0;
    for (; bits; bits &= bits - 1) n++;
    return n;
}

static int sector(const plm_pot *pot, const double p[3])
{
    const double h = p[2] - pot->foot;
    const double angle = atan2(p[1] - pot->centre[1] - pot->slant[1] * h, p[0] - pot->centre[0] - pot->slant[0] * h);
    const int s = (int)((angle / (2 * PLM_PI) + 0.5) * SECTORS);
    return s < 0 ? 0 : s >= SECTORS ? SECTORS - 1 : s;
}

/* Sectors in which points are seen at each height of the rim, from low to high. */
typedef struct rim_view {
    double low, high;
    uint64_t sectors[PROFILE];
} rim_view;

static bool is_at_wall(double part, double slack)
{
    return part > 0.9 - slack && part < 1.04 + slack;
}

static void view_heights(const plm_marker *m, rim_view *view)
{
    const plm_pot *pot = &m->scene->pot;
    const double top = pot->radius[pot->rows - 1], reach = fmax(4 * m->cell, 0.15 * top);
    *view = (rim_view){.low = pot->rim - reach, .high = pot->rim + reach};
    for (size_t i = 0; i < m->cloud->count; i++) {
        const double p[3] = {m->place[i][0], m->place[i][1], m->place[i][2]};
        if (p[2] < view->low || p[2] >= view->high) continue;
        const double r = plm_pot_distance(pot, p);
        if (is_at_wall(r / plm_pot_radius(pot, p[2]), m->cell / top) ||
            is_at_wall(r / plm_wall_radius(m, p[2]), m->cell / top))
            view->sectors[(int)((p[2] - view->low) / (view->high - view->low) * PROFILE)] |= UINT64_C(1)
                                                                                             << sector(pot, p);
    }
}

/* Points of a level as dense as the soil, in a sector of one bin of radii at the wall. 0 where no soil is seen. */
static double soil_in_sector(const plm_marker *m)
{
    const plm_pot *pot = &m->scene->pot;
    const double part = 0.8;
    double soil = 0;
    for (size_t i = 0; i < m->cloud->count && m->has_soil; i++) {
        const double p[3] = {m->place[i][0], m->place[i][1], m->place[i][2]};
        if (plm_pot_distance(pot, p) > part * plm_wall_radius(m, p[2])) continue;
        soil += fabs(plm_relief_over(&m->soil, p)) <= m->soil_slack;
    }
    return soil / (part * part) * 2 * WIDEST_PART / PROFILE / SECTORS;
}

/* Points that are seen above the soil, up to the rim, by sector at each radius from 0 to WIDEST_PART of the wall's. */
static void view_radii(const plm_marker *m, uint32_t seen[PROFILE][SECTORS])
{
    const plm_pot *pot = &m->scene->pot;
    const double clear = (m->has_soil ? slack_of(&m->soil, EVEN_BUMP * m->cell) : 0) + 0.3 * m->cell; /* of the soil */
    /* The rim's upper side may lie just above where the wall was seen to end. */
    const double top = m->has_soil ? fmax(pot->rim, m->rim_height + m->soil_slack) : pot->rim;
    memset(seen, 0, PROFILE * sizeof *seen);
    for (size_t i = 0; i < m->cloud->count; i++) {
        const double p[3] = {m->place[i][0], m->place[i][1], m->place[i][2]};
        if (p[2] >= top) continue;
        const double part = plm_pot_distance(pot, p) / plm_wall_radius(m, p[2]);
        if (part >= WIDEST_PART) continue;
        const double over = m->has_soil ? plm_relief_over(&m->soil, p) : p[2] - pot->soil;
        if (over > clear) seen[(int)(part / WIDEST_PART * PROFILE)][sector(pot, p)]++;
    }
}

/* Sectors that have so many points at a radius and just inside of it together. */
static int count_sectors(const uint32_t outer[SECTORS], const uint32_t inner[SECTORS], double least)
{
    int n = 0;
    for (int k = 0; k < SECTORS; k++) n += outer[k] + inner[k] >= least;
    return n;
}

/* Inner radius of the rim over the outer one. Seen from the wall inwards: the rim ends where fewer than half of the sectors have so
 * many points, or less than a share of the most. Where leaves fill all sectors there is no such edge: NAN, and the rim is taken to
 * be thin. */
static double find_inner(const uint32_t seen[PROFILE][SECTORS], double least, double least_share)
{
    int most = 0;
    double inner = 1;
    for (int b = PROFILE - 1; b >= (int)(THICKEST / WIDEST_PART * PROFILE); b--) {
        const int n = count_sectors(seen[b], seen[b - 1], least);
        if (n > most) most = n;
        if (n >= SECTORS / 2 && n >= least_share * most)
            inner = (b - 1.0) / PROFILE * WIDEST_PART;
        else if (inner < 1)
            return inner;
    }
    return NAN;
}

static void measure_height(plm_marker *m)
{
    rim_view view;
    view_heights(m, &view);
    int best = 0;
    for (int b = 0; b < PROFILE; b++) {
        const int n = count_bits(view.sectors[b]);
        if (n > best) best = n;
        if (best >= SECTORS / 2 && n >= best / 2)
            m->rim_height = view.low + (b + 1.0) / PROFILE * (view.high - view.low);
    }
}

static void measure_thickness(plm_marker *m)
{
    uint32_t seen[PROFILE][SECTORS];
    view_radii(m, seen);
    const double soil = soil_in_sector(m);
    m->inner = NAN;
    for (size_t k = 0; k < sizeof DENSE / sizeof *DENSE && isnan(m->inner); k++)
        m->inner = find_inner((const uint32_t(*)[SECTORS])seen, fmax(1, 2 * DENSE[k] * soil), 0);
    if (isnan(m->inner)) m->inner = find_inner((const uint32_t(*)[SECTORS])seen, 1, SHARP);
    if (isnan(m->inner)) m->inner = 0.97;
    m->inner = fmin(m->inner, 1 - m->wall_slack / plm_wall_radius(m, m->rim_height));
}

/* The outside of the wall: what is below the soil, where only its outside is seen, as a straight line in height. */
static void measure_wall(plm_marker *m)
{
    const plm_pot *pot = &m->scene->pot;
    const double low = pot->foot + 0.4 * (pot->rim - pot->foot), high = fmin(pot->soil - m->cell, pot->rim);
    double base = plm_pot_radius(pot, high), slope = 0, band = 2 * m->cell;
    if (high - low < 4 * m->cell || pot->rim - high > FARTHEST * (high - low)) return;
    for (int round = 0; round < LINE_ROUNDS; round++) {
        double n = 0, sum[2] = {0}, moment[2] = {0}, squares = 0;
        for (size_t i = 0; i < m->cloud->count; i++) {
            const double p[3] = {m->place[i][0], m->place[i][1], m->place[i][2]};
            if (p[2] < low || p[2] > high) continue;
            const double x = p[2] - high, r = plm_pot_distance(pot, p);
            const double expected = round ? base + slope * x : plm_pot_radius(pot, p[2]);
            if (fabs(r - expected) > band) continue;
            n++, sum[0] += x, sum[1] += r, moment[0] += x * x, moment[1] += x * r;
            squares += (r - expected) * (r - expected);
        }
        const double spread = moment[0] - sum[0] * sum[0] / fmax(n, 1);
        if (n < 30 || !(spread > 0)) return;
        slope = (moment[1] - sum[0] * sum[1] / n) / spread;
        base = sum[1] / n - slope * sum[0] / n;
        band = fmin(band, fmax(3 * sqrt(squares / n), 0.2 * m->cell));
    }
    if (fabs(base - plm_pot_radius(pot, high)) > BENT * m->cell) return;
    m->wall_top = high, m->wall_radius = base, m->wall_slope = slope, m->wall_band = band;
    m->rim_radius = base + slope * (m->rim_height - high); /* without a lip */
}

/* Outer radius of the rim: the wall's, carried up to it, or more where a lip stands out in most sectors. */
static void measure_radius(plm_marker *m)
{
    const plm_pot *pot = &m->scene->pot;
    m->rim_radius = plm_pot_radius(pot, m->rim_height);
    if (!isfinite(m->wall_top)) return;
    const double base = m->wall_radius, slope = m->wall_slope, reach = 0.2 * base;
    m->rim_radius = base + slope * (m->rim_height - m->wall_top);
    uint64_t beyond[PROFILE] = {0};
    for (size_t i = 0; i < m->cloud->count; i++) {
        const double p[3] = {m->place[i][0], m->place[i][1], m->place[i][2]};
        if (p[2] < m->rim_height - PLM_LIP * base || p[2] > m->rim_height) continue;
        const double out = plm_pot_distance(pot, p) - (base + slope * (p[2] - m->wall_top));
        if (out >= 0 && out < reach) beyond[(int)(out / reach * PROFILE)] |= UINT64_C(1) << sector(pot, p);
    }
    for (int b = PROFILE - 1; b >= 0; b--) {
        const double out = (b + 0.5) / PROFILE * reach;
        if (out < 1.2 * m->wall_band) break;
        if (count_bits(beyond[b]) < 0.6 * SECTORS) continue;
        m->rim_radius += out - m->wall_band / 3; /* the outermost are as far out as noise brings them */
        break;
    }
}

/* ---- Zones ---------------------------------------------------------------------------------------------------- */

static plm_zone zone_of_pot(const plm_marker *m, const double p[3], float *over_soil)
{
    const plm_pot *pot = &m->scene->pot;
    const double top = m->rim_height + fmax(m->soil_slack, 4 * m->cell);
    if (p[2] < pot->foot - 3 * m->cell || p[2] > fmax(top, pot->soil + 8 * m->cell)) return PLM_ZONE_FREE;
    const double radius = plm_wall_radius(m, p[2]), out = plm_pot_distance(pot, p) - radius;
    if (out > m->wall_slack) return PLM_ZONE_FREE;
    const double over = m->has_soil ? plm_relief_over(&m->soil, p) : p[2] - pot->soil;
    *over_soil = (float)over;
    if (over <= m->soil_slack) return over < -2 * m->cell && out < -m->wall_slack ? PLM_ZONE_INSIDE : PLM_ZONE_NEAR;
    if (p[2] <= m->rim_height + m->soil_slack && out >= -(1 - m->inner) * radius - m->wall_slack) return PLM_ZONE_NEAR;
    return PLM_ZONE_FREE;
}

static plm_zone zone_of_plain(const plm_marker *m, const double p[3], float *over_soil)
{
    const plm_level *it = &m->scene->level[m->scene->soil];
    if (p[2] - plm_level_height(it, p[0], p[1]) > 8 * m->cell + 6 * it->scatter) return PLM_ZONE_FREE;
    if (!plm_within_level(it, 2 * m->cell, p)) return PLM_ZONE_FREE;
    const double over = plm_relief_over(&m->soil, p);
    *over_soil = (float)over;
    return over > m->soil_slack ? PLM_ZONE_FREE : over < -2 * m->cell ? PLM_ZONE_INSIDE : PLM_ZONE_NEAR;
}

static plm_zone zone_of_table(const plm_marker *m, const double p[3])
{
    const plm_level *it = &m->scene->level[m->scene->table];
    if (fabs(p[2] - plm_level_height(it, p[0], p[1])) > 4 * m->cell + 6 * it->scatter) return PLM_ZONE_FREE;
    if (!plm_within_level(it, 3 * m->cell, p)) return PLM_ZONE_FREE;
    const double over = plm_relief_over(&m->table, p);
    if (fabs(over) <= m->table_slack) return PLM_ZONE_NEAR;
    return over < 0 && over > -3 * m->table_slack - m->cell ? PLM_ZONE_INSIDE : PLM_ZONE_FREE;
}

plm_status plm_ground_zones(plm_marker *m, plm_error *error)
{
    plm_status status = fit_reliefs(m, error);
    if (status != PLM_OK) return status;
    m->wall_top = INFINITY;
    if (m->scene->has_pot) {
        m->wall_slack = fmax(0.8 * m->cell, fmin(2.5 * m->scene->pot.scatter, 1.5 * m->cell));
        m->rim_height = m->scene->pot.rim;
        measure_wall(m);
        measure_height(m);
        if (m->rim_height < m->wall_top) m->wall_top = INFINITY;
        measure_radius(m);
        measure_thickness(m);
    }
#pragma omp parallel for schedule(static)
    for (size_t i = 0; i < m->cloud->count; i++) {
        const double p[3] = {m->place[i][0], m->place[i][1], m->place[i][2]};
        m->over[i] = INFINITY;
        plm_zone zone = m->has_table ? zone_of_table(m, p) : PLM_ZONE_FREE;
        if (zone == PLM_ZONE_FREE)
            zone = m->scene->has_pot ? zone_of_pot(m, p, &m->over[i]) : zone_of_plain(m, p, &m->over[i]);
        m->zone[i] = (uint8_t)zone;
    }
    return PLM_OK;
}
