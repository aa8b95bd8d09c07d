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

/* Share of the most sectors at which a rim ends that has no end at half of all. */
static const double SHARP = 0.75;

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

/* Sectors in which points are seen at each height of the rim and at each radius above the soil. */
typedef struct rim_view {
    double low, high;            /* heights */
    uint64_t at_height[PROFILE]; /* from low to high */
    uint64_t at_radius[PROFILE]; /* from 0 to 1.2 radii of the wall */
} rim_view;

static void view_rim(const plm_marker *m, rim_view *view)
{
    const plm_pot *pot = &m->scene->pot;
    const double top = pot->radius[pot->rows - 1], reach = fmax(4 * m->cell, 0.15 * top);
    *view = (rim_view){.low = pot->rim - reach, .high = pot->rim + reach};
    const double lowest = fmin(view->low, pot->soil);
    const double clear = (m->has_soil ? slack_of(&m->soil, EVEN_BUMP * m->cell) : 0) + 0.3 * m->cell; /* of the soil */
    for (size_t i = 0; i < m->cloud->count; i++) {
        const double p[3] = {m->place[i][0], m->place[i][1], m->place[i][2]};
        if (p[2] < lowest || p[2] >= view->high) continue;
        const double part = plm_pot_distance(pot, p) / plm_pot_radius(pot, p[2]);
        if (part >= 1.2) continue;
        const uint64_t bit = UINT64_C(1) << sector(pot, p);
        if (p[2] >= view->low && part > 0.9 - m->cell / top && part < 1.04 + m->cell / top)
            view->at_height[(int)((p[2] - view->low) / (view->high - view->low) * PROFILE)] |= bit;
        const double over = m->has_soil ? plm_relief_over(&m->soil, p) : p[2] - pot->soil;
        if (over > clear && p[2] < pot->rim) view->at_radius[(int)(part / 1.2 * PROFILE)] |= bit;
    }
}

/* Inner radius of the rim over the outer one. Seen from the wall inwards: the rim ends where fewer than half of the sectors are seen,
 * or less than a share of the most, as the tail of the soil's noise may fill half of them. Where leaves fill all sectors there is no
 * such edge: NAN, and the rim is taken to be thin. */
static double find_inner(const rim_view *view, double least_share)
{
    const int thickest = (int)(0.82 / 1.2 * PROFILE);
    int most = 0;
    double inner = 1;
    for (int b = PROFILE - 1; b >= thickest; b--) {
        const int n = count_bits(view->at_radius[b] | view->at_radius[b - 1]);
        if (n > most) most = n;
        if (n >= SECTORS / 2 && n >= least_share * most)
            inner = (b - 1.0) / PROFILE * 1.2;
        else if (inner < 1)
            return inner;
    }
    return NAN;
}

/* How high the rim is and how thick. */
static void measure_rim(plm_marker *m)
{
    const plm_pot *pot = &m->scene->pot;
    rim_view view;
    view_rim(m, &view);
    m->rim_height = pot->rim;
    int best = 0;
    for (int b = 0; b < PROFILE; b++) {
        const int n = count_bits(view.at_height[b]);
        if (n > best) best = n;
        if (best >= SECTORS / 2 && n >= best / 2)
            m->rim_height = view.low + (b + 1.0) / PROFILE * (view.high - view.low);
    }
    m->inner = find_inner(&view, 0);
    if (isnan(m->inner)) m->inner = find_inner(&view, SHARP);
    if (isnan(m->inner)) m->inner = 0.97;
    m->inner = fmin(m->inner, 1 - m->wall_slack / pot->radius[pot->rows - 1]);
}

/* Outer radius of the rim: the wall below the soil, where only its outside is seen, as a straight line in height,
 * carried up to the rim; more where a lip stands out in most sectors. */
static void measure_radius(plm_marker *m)
{
    const plm_pot *pot = &m->scene->pot;
    const double low = pot->foot + 0.4 * (pot->rim - pot->foot), high = fmin(pot->soil - m->cell, m->rim_height);
    double base = plm_pot_radius(pot, high), slope = 0, band = 2 * m->cell;
    m->rim_radius = plm_pot_radius(pot, m->rim_height);
    if (high - low < 4 * m->cell) return;
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
    m->rim_radius = base + slope * (m->rim_height - high);
    uint64_t beyond[PROFILE] = {0};
    const double reach = 0.2 * base;
    for (size_t i = 0; i < m->cloud->count; i++) {
        const double p[3] = {m->place[i][0], m->place[i][1], m->place[i][2]};
        if (p[2] < m->rim_height - 0.15 * base || p[2] > m->rim_height) continue;
        const double out = plm_pot_distance(pot, p) - (base + slope * (p[2] - high));
        if (out >= 0 && out < reach) beyond[(int)(out / reach * PROFILE)] |= UINT64_C(1) << sector(pot, p);
    }
    for (int b = PROFILE - 1; b >= 0; b--) {
        const double out = (b + 0.5) / PROFILE * reach;
        if (out < 1.2 * band) break;
        if (count_bits(beyond[b]) < 0.6 * SECTORS) continue;
        m->rim_radius += out - band / 3; /* the outermost are as far out as noise brings them */
        break;
    }
}

/* ---- Zones ---------------------------------------------------------------------------------------------------- */

static plm_zone zone_of_pot(const plm_marker *m, const double p[3], float *over_soil)
{
    const plm_pot *pot = &m->scene->pot;
    const double top = m->rim_height + fmax(m->soil_slack, 4 * m->cell);
    if (p[2] < pot->foot - 3 * m->cell || p[2] > fmax(top, pot->soil + 8 * m->cell)) return PLM_ZONE_FREE;
    const double radius = plm_pot_radius(pot, p[2]), out = plm_pot_distance(pot, p) - radius;
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
    if (m->scene->has_pot) {
        m->wall_slack = fmax(0.8 * m->cell, fmin(2.5 * m->scene->pot.scatter, 1.5 * m->cell));
        measure_rim(m);
        measure_radius(m);
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
