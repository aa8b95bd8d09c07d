/* segment/strap_tube.h: a stem amid feet of strap leaves as a tube of circles. Internal. */
#ifndef PLANTIMETER_SEGMENT_STRAP_TUBE_H
#define PLANTIMETER_SEGMENT_STRAP_TUBE_H

#include "segment/sketch.h"

enum {
    PLM_STRAP_ARM = 4,        /**< nodes to both sides for the direction; a node stands for R / 4 */
    PLM_STRAP_LEAST_NODES = 6 /**< that a tube has */
};

/** A tube under way, its arrays the caller's: nodes, the radius of each one's circle and the share of directions with points. */
typedef struct plm_strap_tube {
    const plm_sketch *sketch; /**< whose stem is the rough path */
    plm_stem_path path;
    double *closed;
    double *low;        /**< radius without the feet */
    double (*moved)[3]; /**< buffer: nodes */
    float *value;       /**< buffer: nodes and points */
    double (*e)[2];     /**< buffer: points across the line */
    uint32_t *near;     /**< points about the trunk */
    size_t near_count;
} plm_strap_tube;

/** From a rough path, of fork nodes (more than PLM_STRAP_LEAST_NODES), to the tube; room for most nodes. */
void plm_strap_tube_find(plm_strap_tube *tube, size_t fork, size_t most);

/** Follows the tube on from its last node until it is none, and ends it where it is a stem no longer. Its first nodes are sure, up to trunk
 * (no fewer) it may widen, as it holds feet, as long as it is closed, beyond not. Writes low, and the radii without feet. */
void plm_strap_tube_go_on(plm_strap_tube *tube, size_t sure, size_t trunk, size_t most);

/** Finds the points in the line's box, widened by so many radii: most of the leaves are not. */
void plm_strap_tube_find_near(plm_strap_tube *tube, double radii);

/** Unit vector from one node to another. */
void plm_strap_direction(const plm_stem_path *path, size_t from, size_t to, double out[3]);

#endif
