/* segment/ground_foot.c: where a plant meets the soil. Soil points at the foot of something that stands are its foot, if
 * colours do not say otherwise; what is left of bumps where nothing stands is soil, and at a foot what has surely its colour. */
#include <math.h>

#include "segment/ground_mark.h"

enum { FOOT_LAYERS = 4, FILLED = (1 << FOOT_LAYERS) - 1 };

static const float SOIL_SHARE = 0.2f;   /* of the plant among the points of a colour: less is the soil's */
static const float SURE_SHARE = 0.05f;  /* less: surely the soil's */
static const float PLANT_SHARE = 0.5f;  /* more: no bump of the soil */
static const double FOOT_LAYER = 0.75;  /* voxels */
static const double BUMP = 0.25;        /* voxels beyond the slack that bumps and the tail of the noise reach */
static const double BROWN = 2;          /* voxels above the highest bumps in which the soil's colour is a stem's */
static const double HIGHEST_BUMP = 1.3; /* voxels over the relief that single bumps reach where there is little noise */
/* Points of other colours per point of the soil's about a foot: 0.2 and more under stems, 0.03 and less under rosettes. */
static const double ROOTED = 0.1;

/* ---- The foot of the stem ------------------------------------------------------------------------------------- */

static int64_t foot_cell(const plm_stand *t, const float p[3])
{
    const double cell = 0.5 * t->cell;
    const double a = floor((p[0] - t->low[0]) / cell), b = floor((p[1] - t->low[1]) / cell);
    if (!(a >= 0 && a < 2 * t->size[0] && b >= 0 && b < 2 * t->size[1])) return -1;
    return (int64_t)a * (2 * t->size[1]) + (int64_t)b;
}

/* Of each cell of the floor, the layers over the soil that hold free points, as bits; NULL: no room. The caller's. */
static uint8_t *find_layers(const plm_marker *m, plm_error *error)
{
    const plm_stand *t = &m->scene->stand;
    const double layer = FOOT_LAYER * m->cell;
    uint8_t *layers = plm_alloc_zero((size_t)(2 * t->size[0]) * (size_t)(2 * t->size[1]), 1, error);
    for (size_t i = 0; layers && i < m->cloud->count; i++) {
        const double over = m->over[i] - m->soil_slack;
        if (m->zone[i] != PLM_ZONE_FREE || !(over > 0 && over < FOOT_LAYERS * layer)) continue;
        const int64_t c = foot_cell(t, m->place[i]);
        if (c >= 0) layers[c] |= (uint8_t)(1 << (int)(over / layer));
    }
    return layers;
}

static bool has_soils_colour(const plm_marker *m, size_t i, const float *plant_share)
{
    return plant_share && plant_share[plm_shade(m->cloud->rgb[i])] < SOIL_SHARE;
}

/* Gives the foot its points back, where all layers are filled: without colours all, else those that have not the soil's, as a disc of
 * soil would stay at a rosette's foot. */
static void free_foot(plm_marker *m, const float *plant_share, const uint8_t *layers, double foot[2])
{
    double sum[2] = {0}, n = 0, soil = 0, other = 0;
    for (int turn = 0; turn < 2; turn++)
        for (size_t i = 0; i < m->cloud->count; i++) {
            const double over = m->over[i];
            if (!(over >= -m->soil.sigma && over < m->soil_slack + FOOT_LAYERS * FOOT_LAYER * m->cell)) continue;
            const int64_t c = foot_cell(&m->scene->stand, m->place[i]);
            if (c < 0 || layers[c] != FILLED) continue;
            if (turn == 0) {
                sum[0] += m->place[i][0], sum[1] += m->place[i][1], n++;
                if (over > m->soil_slack || !plant_share) continue;
                has_soils_colour(m, i, plant_share) ? soil++ : other++;
            } else if (m->zone[i] == PLM_ZONE_NEAR && !(other < ROOTED * soil) &&
                       !has_soils_colour(m, i, plant_share)) {
                m->zone[i] = PLM_ZONE_FREE;
            }
        }
    for (int i = 0; i < 2 && n > 0; i++) foot[i] = sum[i] / n;
}

/* Where free points fill all layers over the soil, something stands. If nearly all below them has the soil's colour, it
 * stands over the soil, not in it: the petioles of a rosette, which need no foot. */
plm_status plm_ground_foot(plm_marker *m, const float *plant_share, double foot[2], plm_error *error)
{
    uint8_t *layers = find_layers(m, error);
    if (!layers) return PLM_E_MEMORY;
    free_foot(m, plant_share, layers, foot);
    plm_free(layers);
    return PLM_OK;
}

/* ---- Bumps ---------------------------------------------------------------------------------------------------- */

enum { ABOUT = 9 };

/* A cell of the floor and those beside it. Gives their number. */
static size_t cells_about(const plm_stand *t, int64_t cell, int64_t about[ABOUT])
{
    const int64_t high = 2 * t->size[1], x = cell / high, y = cell % high;
    size_t count = 0;
    for (int64_t a = x > 0 ? x - 1 : 0; a <= x + 1 && a < 2 * t->size[0]; a++)
        for (int64_t b = y > 0 ? y - 1 : 0; b <= y + 1 && b < high; b++) about[count++] = a * high + b;
    return count;
}

/* Does anything stand on the cell of the floor or beside it? */
static bool is_by_foot(const plm_stand *t, const uint8_t *layers, int64_t cell)
{
    int64_t about[ABOUT];
    const size_t count = cells_about(t, cell, about);
    for (size_t k = 0; k < count; k++)
        if (layers[about[k]] == FILLED) return true;
    return false;
}

/* What a patch holds: points of the ground and of the soil's colour at it, and others. */
typedef struct patch_points {
    size_t ground, other;
} patch_points;

static bool has_surely_soils_colour(const plm_marker *m, size_t i, const float *plant_share)
{
    return plant_share && plant_share[plm_shade(m->cloud->rgb[i])] < SURE_SHARE;
}

/* How high over the relief bumps reach. */
static double highest_bump(const plm_marker *m)
{
    return fmax(m->soil_slack + BUMP * m->cell, HIGHEST_BUMP * m->cell);
}

static bool is_soils_by_colour(const plm_marker *m, size_t i, const float *plant_share)
{
    return (double)m->over[i] <= highest_bump(m) && has_surely_soils_colour(m, i, plant_share);
}

/* Free points over a cell of the floor: bumps, and higher ones with surely the soil's colour, and with others. */
typedef struct column {
    uint32_t bumps, brown, other;
} column;

/* The columns of all cells; NULL: no room. The caller's. */
static column *find_columns(const plm_marker *m, const float *plant_share, plm_error *error)
{
    const plm_stand *t = &m->scene->stand;
    const double low = highest_bump(m), high = low + BROWN * m->cell;
    column *columns = plm_alloc_zero((size_t)(2 * t->size[0]) * (size_t)(2 * t->size[1]), sizeof *columns, error);
    for (size_t i = 0; columns && i < m->cloud->count; i++) {
        if (m->zone[i] != PLM_ZONE_FREE || !((double)m->over[i] < high)) continue;
        const int64_t c = foot_cell(t, m->place[i]);
        if (c < 0) continue;
        if (!has_surely_soils_colour(m, i, plant_share))
            columns[c].other += (double)m->over[i] > low;
        else
            (double)m->over[i] > low ? columns[c].brown++ : columns[c].bumps++;
    }
    return columns;
}

/* Do the bumps on the cell and beside it go on upwards, as the foot of a brown stem does? */
static bool is_by_brown(const plm_stand *t, const column *columns, int64_t cell)
{
    size_t bumps = 0, brown = 0, other = 0;
    int64_t about[ABOUT];
    const size_t count = cells_about(t, cell, about);
    for (size_t k = 0; k < count; k++) {
        const column *it = &columns[about[k]];
        bumps += it->bumps, brown += it->brown, other += it->other;
    }
    return brown > other && brown > bumps;
}

static void count_ground(const plm_marker *m, const float *plant_share, patch_points *held)
{
    for (size_t i = 0; i < m->cloud->count; i++) {
        if (m->patch[i] < 0) continue;
        const bool ground = m->zone[i] != PLM_ZONE_FREE || is_soils_by_colour(m, i, plant_share);
        ground ? held[m->patch[i]].ground++ : held[m->patch[i]].other++;
    }
}

/* May a free point be soil where nothing stands, by its height, its colour (if that tells) and what else its patch holds? */
static bool is_like_soil(const plm_marker *m, size_t i, const float *plant_share, patch_points held)
{
    const float share = plant_share ? plant_share[plm_shade(m->cloud->rgb[i])] : SOIL_SHARE;
    if (!((double)m->over[i] <= m->soil_slack + BUMP * m->cell) || share > PLANT_SHARE) return false;
    return share < SOIL_SHARE || held.ground > held.other;
}

/* Where there is little noise, bumps of the soil that are smaller than the relief's cells stick out of it, and where there is
 * much, its tail does. Where nothing stands, such points are soil if they have its colour or most of their patch is ground; at a
 * foot, if their colour is surely the soil's, the patch is not the plant's, and it does not go on upwards: one of them 2 mm
 * beside a stem widens the hull by 0.4 %, and those below a rosette are lower than all of it. */
plm_status plm_ground_bumps(plm_marker *m, const float *plant_share, plm_error *error)
{
    const plm_stand *t = &m->scene->stand;
    uint8_t *layers = find_layers(m, error);
    column *columns = plant_share ? find_columns(m, plant_share, error) : NULL; /* for what colours tell */
    patch_points *held = plm_alloc_zero(t->surfels->count + 1, sizeof *held, error);
    const bool room = layers && held && (columns || !plant_share);
    if (room) count_ground(m, plant_share, held);
    for (size_t i = 0; room && i < m->cloud->count; i++) {
        if (m->zone[i] != PLM_ZONE_FREE || m->patch[i] < 0) continue;
        const patch_points in_patch = held[m->patch[i]];
        const int64_t c = foot_cell(t, m->place[i]);
        if (c < 0) continue;
        const bool surely = is_soils_by_colour(m, i, plant_share) && in_patch.ground >= in_patch.other;
        if ((surely && !is_by_brown(t, columns, c)) ||
            (!is_by_foot(t, layers, c) && is_like_soil(m, i, plant_share, in_patch)))
            m->zone[i] = PLM_ZONE_NEAR;
    }
    plm_free(held);
    plm_free(columns);
    plm_free(layers);
    return room ? PLM_OK : PLM_E_MEMORY;
}
