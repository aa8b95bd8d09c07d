/* segment/ground_pieces.c: what shape and colour leave open is settled by what hangs together. Pieces along the ground
 * that do not join the plant (clods, lips, saucers, stray points at the wall) are ground, and so are single points among the
 * ground's that nothing of the plant is beside: a dense ground has thousands in the tail of its noise, and with the
 * plant's colour by chance, which would widen the hull of a low plant. Where colour does not tell, those in patches that are mostly
 * ground stay. */
#include <math.h>

#include "segment/ground_mark.h"

enum { GROUND = -1, OPEN = -2, THIN = -3, JOIN = 2, MOST_ABOUT = (2 * JOIN + 1) * (2 * JOIN + 1) * (2 * JOIN + 1) };

static const float PLANT_SHARE = 0.5f; /* of the plant among the points of a colour: less is not the plant's, ... */
static const float CLEAR_SHARE = 0.8f; /* ... more is */
/* Patches mostly of the plant's colour in and about a piece of the plant's, of all there, at least. */
static const double FILLED = 0.25;
/* In voxels, off the wall that was traced: a piece that nowhere leaves it by more is the wall's, whatever its colour. */
static const double ON_WALL = 0.15;
/* At a pot, patches close to the ground in a piece that has not the plant's colour, of its own, at least: it is the ground's though the
 * rest reaches away (the tail of 5.6 mm of noise about a rim: 0.9; of soil about rosettes: 0.27 and more). */
static const double CLOSE = 0.25;
/* A brown patch that is close to the soil is the foot of a stem where so many brown ones stand over it and about, within so many cells of
 * the raster, higher over the soil than so many times what is close to it; ghosts below leaves are fewer. */
static const double STEM_HIGH = 2;
enum { STEM_PATCHES = 3, STEM_CELLS = 2 };
/* Free points in and about a patch, of the ground's there: less are none of the plant. */
static const double THINNEST = 0.1;

typedef struct pieces {
    const plm_surfels *patches;
    double *ground;               /* of each patch: how many of its points are ground, ... */
    double *plantlike, *soillike; /* ... have surely the plant's colour, have not the plant's */
    int32_t *piece;               /* of each patch: number of its piece, GROUND, THIN, or OPEN */
    uint32_t *stack;
    bool *stays;    /* of each piece: it reaches away from the ground, is the largest, or has the plant's colour; not
                       where it has the ground's and lies partly close to it */
    size_t *close;  /* of each piece: patches close to the ground */
    bool *tail;     /* of each patch: the ground's by its colour, though its piece stays */
    bool *off_wall; /* of each piece: it leaves the wall, or stands over the soil */
    size_t *size;   /* of each piece, patches */
    double *green, *brown;       /* of each piece: patches of the plant's colour, and not of it */
    size_t *about, *green_about; /* of each piece: patches in and about its own, those mostly of the plant's colour */
    int32_t count;
} pieces;

/* Patches at most reach voxels from one along each axis, itself too. */
static size_t patches_about(const plm_surfels *s, size_t patch, int reach, uint32_t about[MOST_ABOUT])
{
    int32_t at[3];
    size_t count = 0;
    for (int i = 0; i < 3; i++) at[i] = (int32_t)(s->centre[patch][i] / s->cell);
    for (int32_t x = at[0] - reach; x <= at[0] + reach; x++)
        for (int32_t y = at[1] - reach; y <= at[1] + reach; y++)
            for (int32_t z = at[2] - reach; z <= at[2] + reach; z++) {
                if (x < 0 || y < 0 || z < 0 || x >= s->size[0] || y >= s->size[1] || z >= s->size[2]) continue;
                const int32_t other = s->slot[((int64_t)x * s->size[1] + y) * s->size[2] + z];
                if (other >= 0) about[count++] = (uint32_t)other;
            }
    return count;
}

static double over_soil(const plm_marker *m, const double p[3])
{
    return m->has_soil ? plm_relief_over(&m->soil, p) : p[2] - m->scene->pot.soil;
}

/* How far over a pot's soil something is close to it. */
static double soil_reach(const plm_marker *m)
{
    return fmax(1.5 * m->cell, 2 * m->soil_slack);
}

/* May a patch be a left-over of the ground: close to wall, rim, soil or table? */
static bool close_to_ground(const plm_marker *m, const double p[3])
{
    const plm_ground_scene *s = m->scene;
    const double reach = 3 * m->cell;
    if (m->has_table && plm_within_level(&s->level[s->table], reach, p) && plm_relief_over(&m->table, p) < reach)
        return true;
    if (!s->has_pot)
        return plm_within_level(&s->level[s->soil], reach, p) &&
               plm_relief_over(&m->soil, p) < fmax(reach, 3 * m->soil_slack);
    const double radius = plm_wall_radius(m, p[2]), out = plm_pot_distance(&s->pot, p) - radius;
    if (out < 0 && over_soil(m, p) < soil_reach(m)) return true;
    return p[2] < m->rim_height + fmax(1.5 * m->cell, m->soil_slack) && out < fmax(reach, 0.15 * radius) &&
           out > -0.15 * radius - reach;
}

/* Does a patch lie on the outer wall, below the soil? */
static bool is_on_wall(const plm_marker *m, const double p[3])
{
    const plm_ground_scene *s = m->scene;
    if (!s->has_pot || p[2] > s->pot.soil) return false;
    return fabs(plm_pot_distance(&s->pot, p) - plm_wall_radius(m, p[2])) < ON_WALL * m->cell;
}

/* Does a patch hold but the tail of the ground's noise, or what has the plant's colour by chance? */
static bool is_thin(const plm_marker *m, const pieces *q, size_t patch)
{
    const float *place = m->scene->stand.place[patch];
    uint32_t about[MOST_ABOUT];
    double ground = 0, points = 0;
    const size_t count = patches_about(q->patches, patch, 1, about);
    for (size_t k = 0; k < count; k++) ground += q->ground[about[k]], points += q->patches->points[about[k]];
    return points - ground < THINNEST * ground && close_to_ground(m, (const double[3]){place[0], place[1], place[2]});
}

static void count_points(const plm_marker *m, const float *plant_share, pieces *q)
{
    for (size_t i = 0; i < m->cloud->count; i++) {
        const int32_t k = m->patch[i];
        if (k < 0) continue;
        q->ground[k] += m->zone[i] != PLM_ZONE_FREE;
        if (!plant_share) continue;
        const float share = plant_share[plm_shade(m->cloud->rgb[i])];
        q->plantlike[k] += share > CLEAR_SHARE;
        q->soillike[k] += share < PLANT_SHARE;
    }
    for (size_t k = 0; k < q->patches->count; k++) {
        const bool ground = q->ground[k] > 0.5 * q->patches->points[k];
        q->piece[k] = ground ? GROUND : is_thin(m, q, k) ? THIN : OPEN;
    }
}

/* Joins open patches that are at most two voxels apart. */
static void join_patches(pieces *q)
{
    uint32_t about[MOST_ABOUT];
    q->count = 0;
    for (size_t start = 0; start < q->patches->count; start++) {
        if (q->piece[start] != OPEN) continue;
        size_t depth = 0;
        q->stack[depth++] = (uint32_t)start;
        q->piece[start] = q->count;
        while (depth) {
            const size_t count = patches_about(q->patches, q->stack[--depth], JOIN, about);
            for (size_t k = 0; k < count; k++) {
                if (q->piece[about[k]] != OPEN) continue;
                q->piece[about[k]] = q->count;
                q->stack[depth++] = about[k];
            }
        }
        q->count++;
    }
}

static void judge_pieces(const plm_marker *m, pieces *q)
{
    const plm_surfels *s = q->patches;
    uint32_t about[MOST_ABOUT];
    int32_t largest = -1;
    for (size_t k = 0; k < s->count; k++) {
        const int32_t n = q->piece[k];
        if (n < 0) continue;
        q->size[n]++;
        q->green[n] += q->plantlike[k] / s->points[k];
        q->brown[n] += q->soillike[k] / s->points[k];
        const size_t count = patches_about(s, k, 1, about);
        q->about[n] += count;
        for (size_t j = 0; j < count; j++) q->green_about[n] += 2 * q->plantlike[about[j]] > s->points[about[j]];
        if (largest < 0 || q->size[n] > q->size[largest]) largest = n;
        const float *place = m->scene->stand.place[k];
        const double p[3] = {place[0], place[1], place[2]};
        q->close[n] += close_to_ground(m, p);
        if (!is_on_wall(m, p)) q->off_wall[n] = true;
    }
    for (int32_t n = 0; n < q->count; n++) {
        const bool is_green = q->green[n] > 0.5 * (double)q->size[n];
        const bool is_brown = m->scene->has_pot && q->brown[n] > 0.5 * (double)q->size[n];
        const double most_close = is_brown ? CLOSE : 1;
        q->stays[n] = (double)q->close[n] < most_close * (double)q->size[n];
        if (n == largest || (is_green && q->off_wall[n] && (double)q->green_about[n] > FILLED * (double)q->about[n]))
            q->stays[n] = true;
    }
}

/* Is a free point among ground the ground's, as it lies at its surface or has not the plant's colour? */
static bool is_grounds(const plm_marker *m, size_t i, const float *plant_share)
{
    if (plant_share[plm_shade(m->cloud->rgb[i])] < PLANT_SHARE || m->over[i] <= m->soil_slack) return true;
    const double p[3] = {m->place[i][0], m->place[i][1], m->place[i][2]};
    return plm_at_table(m, m->table_slack, p);
}

/* Is the patch by one of a piece that stays, and not by the ground's tail alone? */
static bool is_beside(const pieces *q, int32_t patch)
{
    uint32_t about[MOST_ABOUT];
    const size_t count = patches_about(q->patches, (size_t)patch, JOIN, about);
    for (size_t k = 0; k < count; k++) {
        const int32_t n = q->piece[about[k]];
        if (n >= 0 && q->stays[n] && !q->tail[about[k]]) return true;
    }
    return false;
}

/* Is a patch of a piece that stays, though most of its points, the ground's among them, have not the plant's colour? */
static bool is_brown_in_plant(const pieces *q, size_t k)
{
    return q->piece[k] >= 0 && q->stays[q->piece[k]] && 2 * q->soillike[k] > q->patches->points[k];
}

/* Do brown patches stand over a place and about, as the stem does that it is the foot of? high: how many, of each cell of the raster. */
static bool goes_on(const plm_stand *t, const uint32_t *high, const float place[3])
{
    const int64_t cell = plm_stand_cell(t, place[0], place[1]), x = cell / t->size[1], y = cell % t->size[1];
    size_t count = 0;
    for (int64_t a = x - STEM_CELLS; cell >= 0 && a <= x + STEM_CELLS; a++)
        for (int64_t b = y - STEM_CELLS; b <= y + STEM_CELLS; b++)
            if (a >= 0 && a < t->size[0] && b >= 0 && b < t->size[1]) count += high[a * t->size[1] + b];
    return count >= STEM_PATCHES;
}

/* Marks what hangs together with the plant, but has the ground's colour and is close to it, and does not go on upwards as the foot of
 * a brown stem does: the tail of much noise. */
static plm_status mark_tails(const plm_marker *m, pieces *q, plm_error *error)
{
    const plm_stand *t = &m->scene->stand;
    uint32_t *high = plm_alloc_zero((size_t)t->size[0] * (size_t)t->size[1], sizeof *high, error);
    if (!high) return PLM_E_MEMORY;
    for (size_t k = 0; k < q->patches->count; k++) {
        if (!is_brown_in_plant(q, k)) continue;
        const double p[3] = {t->place[k][0], t->place[k][1], t->place[k][2]};
        const int64_t cell = plm_stand_cell(t, p[0], p[1]);
        q->tail[k] = close_to_ground(m, p);
        if (!q->tail[k] && cell >= 0) high[cell] += over_soil(m, p) > STEM_HIGH * soil_reach(m);
    }
    for (size_t k = 0; k < q->patches->count; k++) q->tail[k] = q->tail[k] && !goes_on(t, high, t->place[k]);
    plm_free(high);
    return PLM_OK;
}

static plm_status take_pieces(plm_marker *m, const float *plant_share, pieces *q, plm_error *error)
{
    count_points(m, plant_share, q);
    join_patches(q);
    judge_pieces(m, q);
    if (plant_share && m->scene->has_pot && mark_tails(m, q, error) != PLM_OK) return PLM_E_MEMORY;
    for (size_t i = 0; i < m->cloud->count; i++) {
        if (m->zone[i] != PLM_ZONE_FREE || m->patch[i] < 0) continue;
        const int32_t n = q->piece[m->patch[i]];
        const bool single = n == THIN || (n == GROUND && plant_share && is_grounds(m, i, plant_share));
        const bool is_tail = q->tail[m->patch[i]] && plant_share[plm_shade(m->cloud->rgb[i])] < PLANT_SHARE;
        if (n >= 0 ? !q->stays[n] || is_tail : single && !is_beside(q, m->patch[i])) m->zone[i] = PLM_ZONE_NEAR;
    }
    return PLM_OK;
}

plm_status plm_ground_leftovers(plm_marker *m, const float *plant_share, plm_error *error)
{
    const size_t count = m->scene->stand.surfels->count;
    pieces q = {.ground = plm_alloc_zero(count, sizeof *q.ground, error),
                .plantlike = plm_alloc_zero(count, sizeof *q.plantlike, error),
                .soillike = plm_alloc_zero(count, sizeof *q.soillike, error),
                .piece = plm_alloc(count, sizeof *q.piece, error),
                .stack = plm_alloc(count, sizeof *q.stack, error),
                .stays = plm_alloc(count, sizeof *q.stays, error),
                .close = plm_alloc_zero(count, sizeof *q.close, error),
                .tail = plm_alloc_zero(count, sizeof *q.tail, error),
                .off_wall = plm_alloc_zero(count, sizeof *q.off_wall, error),
                .size = plm_alloc_zero(count, sizeof *q.size, error),
                .green = plm_alloc_zero(count, sizeof *q.green, error),
                .brown = plm_alloc_zero(count, sizeof *q.brown, error),
                .about = plm_alloc_zero(count, sizeof *q.about, error),
                .green_about = plm_alloc_zero(count, sizeof *q.green_about, error),
                .patches = m->scene->stand.surfels};
    const bool room = q.ground && q.plantlike && q.soillike && q.piece && q.stack && q.stays && q.close && q.tail &&
                      q.off_wall && q.size && q.green && q.brown && q.about && q.green_about;
    const plm_status status = room ? take_pieces(m, plant_share, &q, error) : PLM_E_MEMORY;
    plm_free(q.ground);
    plm_free(q.plantlike);
    plm_free(q.soillike);
    plm_free(q.piece);
    plm_free(q.stack);
    plm_free(q.stays);
    plm_free(q.close);
    plm_free(q.tail);
    plm_free(q.off_wall);
    plm_free(q.size);
    plm_free(q.green);
    plm_free(q.brown);
    plm_free(q.about);
    plm_free(q.green_about);
    return status;
}
