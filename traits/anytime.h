/* traits/anytime.h: a measurement that makes the best of a given time, or that is as cheap as a wanted error allows: passes over
 * more and more points. Internal to traits/ and tool/. */
#ifndef PLANTIMETER_TRAITS_ANYTIME_H
#define PLANTIMETER_TRAITS_ANYTIME_H

#include "traits/pass.h"
#include "traits/schedule.h"
#include "traits/target.h"

/** What the caller does with a measurement afterwards: time is kept for it where it is little. Bits: 1 << plm_cost. */
typedef struct plm_anytime_options {
    double begin;     /**< when the job began (its reading included), on the clock */
    double seconds;   /**< that it may take; 0: any */
    unsigned outputs; /**< costs of plm_cost that the caller will have: labels of all points, files */
    size_t target_count;
    const plm_target *target;
    double (*clock)(void *user); /**< NULL: plm_seconds_now */
    void *clock_user;
} plm_anytime_options;

enum { PLM_MOST_PASSES = 24 };

/** A pass that was run. */
typedef struct plm_pass_record {
    size_t points;
    bool has_group[PLM_GROUP_COUNT];
    bool is_complete[PLM_GROUP_COUNT];
    double predicted, seconds;
} plm_pass_record;

/** What was done. */
typedef struct plm_anytime_record {
    size_t pass_count;
    plm_pass_record pass[PLM_MOST_PASSES];
    size_t points[PLM_GROUP_COUNT]; /**< that the reported values of a group rest on; 0: no pass was complete */
    bool is_late[PLM_GROUP_COUNT];  /**< values of the group are missing for want of time */
    bool has_all_points;            /**< the measurement's cloud has all points, else those of a pass */
    plm_target_outcome outcome[PLM_MOST_TARGETS];
    plm_pace pace;
} plm_anytime_record;

/** Measures a plant within a time, or to an error, or both: what comes first ends it. As plm_measure otherwise; traits of the
 * plant and of organs may rest on different passes. What there was no time for fails with the reason "time budget". The same
 * time does not give the same digits; the record names the points, which do. */
plm_status plm_measure_anytime(plm_cloud *cloud, const plm_measure_options *options, const plm_anytime_options *anytime,
                               plm_measurement *measurement, plm_anytime_record *record, plm_error *error);

/** Seconds that are left of the time, less those for the tables; INFINITY without one. */
double plm_anytime_left(const plm_anytime_options *anytime, const plm_pace *pace);

#endif
