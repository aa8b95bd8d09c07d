/* segment/sketch.h: the thinned plant on which structure is found, and what the stages found on it. Internal.
 *
 * Stages run in the order of their functions here; each reads what the earlier ones wrote. All arrays have
 * working.count rows, and are the sketch's. */
#ifndef PLANTIMETER_SEGMENT_SKETCH_H
#define PLANTIMETER_SEGMENT_SKETCH_H

#include "segment/graph.h"
#include "segment/scale.h"
#include "segment/segment.h"
#include "segment/thinning.h"
#include "segment/tube_class.h"

/** The centre line of the main stem, from the base up. */
typedef struct plm_stem_path {
    size_t count; /**< nodes; 0: there is no stem */
    double (*node)[3];
    double *radius; /**< at each node */
    double *along;  /**< arc length from the base */
} plm_stem_path;

typedef struct plm_sketch {
    plm_scale scale;
    plm_thinned base;    /**< up to the point budget; working is thinned from it */
    plm_thinned working; /**< one point each max(R / 12, spacing), or more, to R / 6, where parts are sparse */
    plm_graph
        graph; /**< over working, in one piece where gaps are below 2.5 R; broken petioles and stalks, and sparse parts of rosettes, are linked later, and what touches there parted */
    plm_tube_point *point;
    float *tube; /**< probability of being tube, smoothed */
    bool *is_tube;
    bool *is_stem; /**< is_tube, and on the main stem */
    plm_stem_path stem;
    plm_habit asked; /**< what the user says it is; PLM_HABIT_UNKNOWN: nothing */
    plm_habit habit;
    int32_t *group;   /**< side group (all that hangs on one foot at the stem), -1: stem */
    int32_t *leaf;    /**< leaf that a blade or petiole point belongs to, -1 */
    int32_t *leaflet; /**< component of blade within the leaf, -1 */
    size_t leaf_count;
    uint32_t *leaf_flags;
} plm_sketch;

/** Which tubes count as tubes: none, sure ones, doubtful ones as well, or whatever looks like one (is_doubtful, then). */
typedef enum plm_tubes { PLM_TUBES_NONE, PLM_TUBES_SURE, PLM_TUBES_DOUBTFUL, PLM_TUBES_ANY } plm_tubes;

/** Thins the plant, finds its scale and the graph, and tells tubes from blades. scale.is_doubtful: they are not sure. */
plm_status plm_sketch_make(const float (*xyz)[3], size_t count, size_t point_budget, plm_tubes tubes,
                           plm_sketch *sketch, plm_error *error);

/** A graph over the working points whose edges are at most so many cells long. The caller's: plm_graph_free. */
plm_status plm_sketch_link(const plm_sketch *sketch, double edge_cells, plm_graph *graph, plm_error *error);

/** Joins the pieces of such a graph over gaps below 2.5 R; also: as plm_graph_join. */
plm_status plm_sketch_join(const plm_sketch *sketch, plm_graph *graph, bool also, plm_error *error);

/** Sets classes right that no plant can have: tubes shorter than they are thick, specks of blade on a tube. */
plm_status plm_sketch_tidy(plm_sketch *sketch, plm_error *error);

/** Whether most points are called tube and larger balls would find more: folded straps, seen as tubes; or a bare stem. */
bool plm_leaves_look_like_tubes(const plm_sketch *sketch);

/** Finds the main stem's centre line and marks its points. No stem: the path stays empty. */
plm_status plm_sketch_stem(plm_sketch *sketch, plm_error *error);

/** The same for plants whose leaves may be as thick as the stem: the straightest way up from the base. */
plm_status plm_sketch_upright_stem(plm_sketch *sketch, plm_error *error);

/** Takes back what of the path is the petiole of the topmost leaf, and the whole of it where there is no stem (rosettes). */
plm_status plm_sketch_stem_end(plm_sketch *sketch, plm_error *error);

/** Writes is_stem from the path. */
void plm_sketch_mark_stem(plm_sketch *sketch);

/** Finds the leaves: side groups, habit, leaves, leaflets. */
plm_status plm_sketch_leaves(plm_sketch *sketch, plm_error *error);

/** Takes fruit off the leaves of a plant on a stem (leaves that are balls are none) and finds the others again without it. */
plm_status plm_sketch_fruit(plm_sketch *sketch, plm_error *error);

/** Gives few points of a blade or petiole that lie apart from it amid a stem or petiole to those. */
plm_status plm_sketch_strays(plm_sketch *sketch, plm_error *error);

void plm_sketch_free(plm_sketch *sketch);

#endif
