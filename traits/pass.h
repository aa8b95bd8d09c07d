/* traits/pass.h: one pass over a plant: the stages of the plan over about so many of its points. A measurement is one pass and
 * the labels of all points; an anytime measurement is several. Internal. */
#ifndef PLANTIMETER_TRAITS_PASS_H
#define PLANTIMETER_TRAITS_PASS_H

#include "traits/pace.h"
#include "traits/work.h"

/** What a pass looks at, and until when. */
typedef struct plm_pass_options {
    const plm_measure_options *measure; /**< its traits and points do not count: chosen and points do */
    const bool *chosen;                 /**< rows of the trait table */
    size_t points;                      /**< about so many; 0: all */
    plm_pace *
        pace; /**< learns what the stages take; where the options have a deadline, a stage that would not end in time is
                         not begun. NULL: neither */
} plm_pass_options;

/** What a pass gave. The caller's: plm_pass_free. */
typedef struct plm_pass {
    plm_measurement draft;         /**< all but cloud and segmentation, which are empty; centroids in the frame */
    plm_work work;                 /**< the points that were looked at, in the frame; row[i] in the cloud */
    plm_segmentation segmentation; /**< of these points */
    bool has_labels;               /**< they came with the cloud */
    unsigned late;                 /**< PLM_NEEDS_... that the time did not allow */
    bool late_in[2]; /**< whether values are missing for that: of traits without and with PLM_NEEDS_ORGANS */
} plm_pass;

/** PLM_E_DEGENERATE for an empty cloud, PLM_E_ARGUMENT for coordinates that are not finite. Readers drop those; a program that
 * hands over a cloud may not have. */
plm_status plm_check_points(const plm_cloud *cloud, plm_error *error);

/** Runs the stages over a copy of some of the cloud's points, chosen by a hash of their coordinates: smaller passes look at
 * some of the points of larger ones. What the deadline of the options does not allow fails with that reason.
 * PLM_E_DEGENERATE  an empty cloud. */
plm_status plm_pass_run(const plm_cloud *cloud, const plm_pass_options *options, plm_pass *pass, plm_error *error);

/** Makes a measurement of a pass and of the cloud (taken over) that it was made of. with_all: all points come, turned into the
 * frame, and with labels where the pass has any; else the points of the pass alone. The pass is left empty, also on failure. */
plm_status plm_pass_finish(plm_pass *pass, plm_cloud *cloud, bool with_all, plm_measurement *measurement,
                           plm_error *error);

void plm_pass_free(plm_pass *pass);

#endif
