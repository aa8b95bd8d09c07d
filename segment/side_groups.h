/* segment/side_groups.h: what hangs on the trunk at one place is a side group. Internal. */
#ifndef PLANTIMETER_SEGMENT_SIDE_GROUPS_H
#define PLANTIMETER_SEGMENT_SIDE_GROUPS_H

#include "segment/sketch.h"

/** One side group. */
typedef struct plm_side_group {
    bool has_foot;                  /**< false: it is apart from the trunk */
    double along;                   /**< of its foot on the stem's line; height where there is no stem */
    double tube_share;              /**< of its points between the trunk and a little beyond the foot */
    double tube_radius;             /**< median there; 0 without tube */
    double tube_length, blade_area; /**< of the whole group; blades too small to be leaves do not count */
    size_t blades;
} plm_side_group;

typedef struct plm_side_groups {
    size_t count;
    plm_side_group *group;
    float *distance; /**< of each working point, along the graph, from the trunk */
    int32_t *blade;  /**< of each working point: its component of blade within its group, -1 for tube and trunk */
    size_t blade_count;
    double *blade_area;
    int32_t *blade_group;
} plm_side_groups;

/** Finds the side groups and writes sketch->group; the graph of a plant without a stem gets links where it is sparse
 * (plm_graph_widen). The trunk: the stem's points, or (rosettes) the core where the petioles meet. blade_cost: of a length of
 * blade over one of tube, on the way that decides whose a point is; 1 where nothing is known about the leaves, more where
 * they are compound (their leaflets then part by plm_touch_cut's rule for them). */
plm_status plm_side_groups_find(plm_sketch *sketch, double blade_cost, plm_side_groups *groups, plm_error *error);

/** For plants of simple leaves: splits groups of several petioles, so that each blade with a petiole of its own has a
 * group. Writes sketch->group. */
plm_status plm_side_groups_split(plm_sketch *sketch, plm_side_groups *groups, plm_error *error);

/** For plants without a stem: finds the young leaves, whose blades are so small that they pass as tubes: ends of tubes
 * with no or little blade. Those without any get a group each (or keep one that has no blade), and the outer part of all
 * becomes blade. Writes sketch->group and is_tube. */
plm_status plm_side_groups_young(plm_sketch *sketch, plm_side_groups *groups, plm_error *error);

/** Median of the points of the groups that have a foot and a blade; 0: these are fewer than least. points, value: room for one a group, all 0
 * before; points: out, of each group. */
double plm_side_groups_usual_points(const plm_sketch *sketch, const plm_side_groups *groups, size_t least,
                                    size_t *points, double *value);

void plm_side_groups_free(plm_side_groups *groups);

/** Blades smaller than this are no leaves. */
double plm_blade_least(const plm_sketch *sketch);

/** The same in working points. */
double plm_blade_least_points(const plm_sketch *sketch);

#endif
