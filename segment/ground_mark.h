/* segment/ground_mark.h: from a scene with ground to ground points. Internal: ground_mark.c puts the steps of
 * ground_zone.c (by shape), ground_colour.c (by colour), ground_pieces.c (by what hangs together) and ground_foot.c (where a
 * plant stands) in order. */
#ifndef PLANTIMETER_SEGMENT_GROUND_MARK_H
#define PLANTIMETER_SEGMENT_GROUND_MARK_H

#include "segment/ground_scene.h"
#include "segment/relief.h"

#include <math.h>

/** Heights and sizes as the marking found them, in the stand's coordinates. */
typedef struct plm_ground_marks {
    double foot[3];    /**< where the plant leaves the soil: u, v, w */
    double rim[3];     /**< middle of the pot's rim */
    double rim_radius; /**< of the outside of the rim */
    double table[3];   /**< the table below the pot's axis */
} plm_ground_marks;

/** Sets ground[i] (count of cloud, the caller's) where a point belongs to soil, pot or table of the scene. */
plm_status plm_ground_mark(const plm_cloud *cloud, const plm_ground_scene *scene, bool *ground, plm_ground_marks *marks,
                           plm_error *error);

/** What a point is by its place. */
typedef enum plm_zone {
    PLM_ZONE_FREE,  /**< not ground */
    PLM_ZONE_NEAR,  /**< ground, but at its surface */
    PLM_ZONE_INSIDE /**< ground, well below a surface */
} plm_zone;

#define PLM_LIP 0.15 /* of the wall's radius: the most that a lip reaches down from the rim */

/** A marking in work. */
typedef struct plm_marker {
    const plm_cloud *cloud;
    const plm_ground_scene *scene;
    double cell;
    float (*place)[3]; /**< of each point, in the stand */
    int32_t *patch;    /**< of each point; -1 for stray points outside of the grid */
    float *over;       /**< of each point near the soil: height over it; INFINITY of others */
    uint8_t *zone;     /**< of each point: plm_zone */
    bool has_soil, has_table;
    plm_relief soil, table;
    double soil_slack, table_slack, wall_slack; /**< how far from a surface a point of it may lie */
    double rim_height, inner;                   /**< top of the wall; inner radius of the rim over the outer one */
    double rim_radius;
    double wall_top;                /**< the line below tells the wall from this height up; INFINITY: there is none */
    double wall_radius, wall_slope; /**< of the line of the wall below the soil, seen from outside, at wall_top */
    double wall_band;               /**< how far from the line its points lie */
} plm_marker;

/** Radius of the pot's outside at a height: as it was traced, or farther out, where the wall below leads, as patches of the rim's
 * inside may have pulled the trace in. */
static inline double plm_wall_radius(const plm_marker *m, double w)
{
    const double traced = plm_pot_radius(&m->scene->pot, w);
    if (!(w > m->wall_top)) return traced;
    const double line = m->wall_radius + m->wall_slope * (fmin(w, m->rim_height) - m->wall_top);
    const double lip = m->rim_radius - m->wall_radius - m->wall_slope * (m->rim_height - m->wall_top);
    return fmax(traced, w > m->rim_height - PLM_LIP * m->wall_radius ? line + lip : line);
}

/** Fits soil, table and rim, and fills over and zone. */
plm_status plm_ground_zones(plm_marker *marker, plm_error *error);

enum { PLM_SHADES = 16, PLM_COLOURS = PLM_SHADES * PLM_SHADES * PLM_SHADES };

/** Share of each colour that is plant, were there as much plant as ground. False where colour does not tell them apart. */
bool plm_ground_colours(const plm_marker *marker, float plant_share[PLM_COLOURS]);

static inline int plm_shade(const uint8_t rgb[3])
{
    const int divide = 256 / PLM_SHADES;
    return (rgb[0] / divide * PLM_SHADES + rgb[1] / divide) * PLM_SHADES + rgb[2] / divide;
}

/** Makes ground of the pieces along soil, wall and table that do not join the plant, and of single points among the ground's.
 * plant_share may be NULL. */
plm_status plm_ground_leftovers(plm_marker *marker, const float *plant_share, plm_error *error);

/** Gives the plant the foot of its stem back, and says where it stands (u, v; untouched where nothing stands). plant_share
 * may be NULL. */
plm_status plm_ground_foot(plm_marker *marker, const float *plant_share, double foot[2], plm_error *error);

/** Makes ground of free points a little over the soil where nothing stands, or that have surely the soil's colour. plant_share may be
 * NULL. */
plm_status plm_ground_bumps(plm_marker *marker, const float *plant_share, plm_error *error);

/** Is the place within a level's outline, widened by margin? */
static inline bool plm_within_level(const plm_level *level, double margin, const double p[3])
{
    const double du = p[0] - level->centre[0], dv = p[1] - level->centre[1];
    const double reach = plm_level_reach(level, du, dv) + margin;
    return du * du + dv * dv <= reach * reach;
}

/** Is the place on the table or at most slack off it? */
static inline bool plm_at_table(const plm_marker *m, double slack, const double p[3])
{
    return m->has_table && plm_within_level(&m->scene->level[m->scene->table], 3 * m->cell, p) &&
           fabs(plm_relief_over(&m->table, p)) <= slack;
}

#endif
