/* segment/ground_mark.c: the order of marking. Shape first; then points at a surface that have the plant's colour go
 * back to the plant, if colour tells the two apart at all; then pieces that are left around pot and soil go to the
 * ground; then the foot of the stem goes back to the plant; then bumps of the soil go to the ground. */
#include "segment/ground_mark.h"

#include <math.h>
#include <string.h>

/* Of the plant among the points of a colour, from which on a point at a surface is the plant's: all around a point that lies below the
 * soil's relief is soil, so that a colour has to say more there. */
static const float RETURNED = 0.95f, RETURNED_BELOW = 0.98f;

/* Below the soil, not beside the pot? */
static bool is_in_soil(const plm_marker *m, size_t i)
{
    if (!(m->over[i] <= 0)) return false;
    const double p[3] = {m->place[i][0], m->place[i][1], m->place[i][2]};
    const plm_pot *pot = &m->scene->pot;
    return !m->scene->has_pot || plm_pot_distance(pot, p) < plm_wall_radius(m, p[2]) - m->wall_slack;
}

static void return_by_colour(plm_marker *m, const float plant_share[PLM_COLOURS])
{
    for (size_t i = 0; i < m->cloud->count; i++)
        if (m->zone[i] == PLM_ZONE_NEAR &&
            plant_share[plm_shade(m->cloud->rgb[i])] > (is_in_soil(m, i) ? RETURNED_BELOW : RETURNED))
            m->zone[i] = PLM_ZONE_FREE;
}

/* First places; the foot moves to the stem if one is found. */
static void note_marks(const plm_marker *m, plm_ground_marks *marks)
{
    const plm_ground_scene *s = m->scene;
    *marks = (plm_ground_marks){0};
    if (s->has_pot) {
        const plm_pot *pot = &s->pot;
        for (int i = 0; i < 2; i++) {
            marks->rim[i] = pot->centre[i] + pot->slant[i] * (m->rim_height - pot->foot);
            marks->foot[i] = pot->centre[i] + pot->slant[i] * (pot->soil - pot->foot);
            marks->table[i] = pot->centre[i];
        }
        marks->rim[2] = m->rim_height;
        marks->foot[2] = pot->soil;
        marks->rim_radius = m->rim_radius;
        if (s->table >= 0) marks->table[2] = plm_level_height(&s->level[s->table], marks->table[0], marks->table[1]);
    } else {
        memcpy(marks->foot, s->level[s->soil].centre, 2 * sizeof *marks->foot);
    }
}

static plm_status mark(plm_marker *m, plm_ground_marks *marks, plm_error *error)
{
    float share[PLM_COLOURS];
#pragma omp parallel for schedule(static)
    for (size_t i = 0; i < m->cloud->count; i++) {
        double p[3];
        plm_stand_place(&m->scene->stand, m->cloud->xyz[i], p);
        for (int a = 0; a < 3; a++) m->place[i][a] = (float)p[a];
        const int64_t voxel = plm_surfels_voxel(m->scene->stand.surfels, m->cloud->xyz[i]);
        m->patch[i] = voxel < 0 ? -1 : m->scene->stand.surfels->slot[voxel];
    }
    plm_status status = plm_ground_zones(m, error);
    if (status != PLM_OK) return status;
    const bool colour = m->cloud->rgb && plm_ground_colours(m, share);
    if (colour) return_by_colour(m, share);
    note_marks(m, marks);
    status = plm_ground_leftovers(m, colour ? share : NULL, error);
    if (status == PLM_OK && m->has_soil) {
        status = plm_ground_foot(m, colour ? share : NULL, marks->foot, error);
        if (status == PLM_OK) status = plm_ground_bumps(m, colour ? share : NULL, error);
        marks->foot[2] = -plm_relief_over(&m->soil, (const double[3]){marks->foot[0], marks->foot[1], 0});
    }
    return status;
}

plm_status plm_ground_mark(const plm_cloud *cloud, const plm_ground_scene *scene, bool *ground, plm_ground_marks *marks,
                           plm_error *error)
{
    plm_marker m = {.cloud = cloud, .scene = scene, .cell = scene->stand.surfels->cell};
    m.place = plm_alloc(cloud->count, sizeof *m.place, error);
    m.patch = plm_alloc(cloud->count, sizeof *m.patch, error);
    m.over = plm_alloc(cloud->count, sizeof *m.over, error);
    m.zone = plm_alloc(cloud->count, sizeof *m.zone, error);
    const bool room = m.place && m.patch && m.over && m.zone;
    const plm_status status = room ? mark(&m, marks, error) : PLM_E_MEMORY;
    if (status == PLM_OK)
        for (size_t i = 0; i < cloud->count; i++) ground[i] = m.zone[i] != PLM_ZONE_FREE;
    plm_relief_free(&m.soil);
    plm_relief_free(&m.table);
    plm_free(m.place);
    plm_free(m.patch);
    plm_free(m.over);
    plm_free(m.zone);
    return status;
}
