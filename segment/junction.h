/* segment/junction.h: where a leaf's petiole ends and its blade begins. Internal. */
#ifndef PLANTIMETER_SEGMENT_JUNCTION_H
#define PLANTIMETER_SEGMENT_JUNCTION_H

#include "segment/side_groups.h"

/** Sets is_tube of the points of leaves right by the place of the blade junction: of each leaf that stands on a petiole,
 * the level sets of the distance along the graph from its foot are as narrow as a tube up to the junction, and widen from
 * there. Simple leaves: all before the (only) junction is petiole, all beyond it is blade. Compound leaves: the way to
 * the last leaflet's junction is rachis, all beyond is blade; of what hangs on the rachis before, what widens is a leaflet
 * (leaflets.c). Leaves whose level sets tell no junction stay as they are. */
plm_status plm_sketch_junctions(plm_sketch *sketch, const plm_side_groups *groups, plm_error *error);

/* ---- Shared by its files --------------------------------------------------------------------------------------- */

/** What of a leaf lies at about one distance from its foot. */
typedef struct plm_station {
    double width;     /**< SD along the largest extent */
    double middle[3]; /**< mean */
    double tube;      /**< share of points called tube */
    uint32_t count;
} plm_station;

/** One leaf, from its foot on. Station k takes in the points at distances within half a window of k steps. */
typedef struct plm_leaf_way {
    const plm_sketch *sketch;
    size_t count;
    uint32_t *order; /**< the leaf's points by distance */
    float *distance; /**< of all working points from the foot, along the graph within the leaf */
    size_t station_count;
    plm_station *station;
    double step, window;
    double tube;        /**< typical width of the tube's stations */
    double tube_points; /**< typical number of their points; 0 where there are none */
    double junction;    /**< distance at which the width begins to grow */
} plm_leaf_way;

/** The station nearest to a distance, or the last before it that has points. */
const plm_station *plm_leaf_station(const plm_leaf_way *way, double distance);

/** Sets is_tube of the leaf's points by way->junction. beside: of each station, whether leaflets may lie beside the line
 * (plm_rachis_clear). sketch: way's, as in all that follow. */
void plm_leaf_relabel_compound(plm_sketch *sketch, const plm_leaf_way *way, const bool *beside);
void plm_leaf_relabel_simple(plm_sketch *sketch, const plm_leaf_way *way);

/** Gives points before the first clear station that are off the petiole's line to the stem. */
void plm_leaf_clean_foot(plm_sketch *sketch, const plm_leaf_way *way);

/** Tells rachis, petiolules and leaflets of a compound leaf apart, up to way->junction. sketch: way's. */
plm_status plm_leaf_leaflets(plm_sketch *sketch, const plm_leaf_way *way, plm_error *error);

/** Median length of the graph's links between the leaf's points that count; 0 where there are none.
 * among: of each working point, whether it counts. value: scratch, way->count long. */
double plm_leaf_typical_link(const plm_leaf_way *way, const bool *among, float *value);

/** Width from which on a station is wider than the tube: 1.6 widths of it. */
double plm_leaf_wide(const plm_leaf_way *way);

/** Whether the narrow stations [begin, end) are a stretch of the tube: as full as one, or so long that their few points do
 * not matter. A strand of some points between stem and foot is neither. */
bool plm_leaf_is_full(const plm_leaf_way *way, size_t begin, size_t end);

/** The station of count points. */
void plm_station_measure(const plm_sketch *sketch, const uint32_t *row, size_t count, plm_station *station);

/** The first station of the only blade: the split at which the fewest stations before it are wide and the fewest from it
 * on, up to the widest, are narrow. */
size_t plm_leaf_only_split(const plm_leaf_way *way, size_t first);

/** Distance, from station 0, at which the width begins to grow: that from which a step and a slope fit the widths around the
 * split best, first at the least. */
double plm_leaf_change(const plm_leaf_way *way, size_t first, size_t split);

#endif
