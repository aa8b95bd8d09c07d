/* traits/pace.h: what the stages of a measurement take on this machine and this plant: a model of each stage's seconds by the
 * number of points, which starts from a reference machine's and learns from every stage that ends. Internal. */
#ifndef PLANTIMETER_TRAITS_PACE_H
#define PLANTIMETER_TRAITS_PACE_H

#include "traits/plan.h"

/** Costs beside those of the stages. */
typedef enum plm_cost {
    PLM_COST_SAMPLE = PLM_STAGE_COUNT, /**< choosing the points of a pass; by the points of the whole cloud */
    PLM_COST_LABELS,                   /**< carrying labels to all points; by the points of the whole cloud */
    PLM_COST_CLOUD_FILE,               /**< by points written */
    PLM_COST_MESH_FILE,                /**< by triangles */
    PLM_COST_PICTURE,                  /**< by points drawn */
    PLM_COST_VIEW,                     /**< by triangles */
    PLM_COST_PAGE,                     /**< report.html; by plants with a view */
    PLM_COST_COUNT
} plm_cost;

/** All zero: nothing was learnt. */
typedef struct plm_pace {
    double seconds, reference; /**< of all that was noted: here, and as the reference has it */
    struct plm_pace_note {
        double size, seconds, power;
    } note[PLM_COST_COUNT]; /**< the latest of each; size 0: none; power: as the last two showed it, 0: none did */
} plm_pace;

/** The size that a cost goes by: points of the whole cloud, points looked at, triangles of leaves. */
size_t plm_cost_size(plm_cost cost, size_t all, size_t used, size_t triangles);

/** How many times as long as on the reference machine what was noted took; 1 where nothing was. */
double plm_pace_speed(const plm_pace *pace);

/** Learns that a cost (a plm_stage_id or plm_cost) of this size took so long. */
void plm_pace_note(plm_pace *pace, int cost, size_t size, double seconds);

/** Seconds that a cost of this size will take: as it took before, by the power of the sizes' ratio; where it never ran, as on
 * the reference machine, times what this machine took for what did run. */
double plm_pace_predict(const plm_pace *pace, int cost, size_t size);

/** Seconds of all stages that run by a plan, over so many of all points. */
double plm_pace_pass(const plm_pace *pace, const plm_plan *plan, size_t points, size_t all);

#endif
