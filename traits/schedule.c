/* traits/schedule.c: passes chosen by what they are predicted to cost and to gain. The gain of a pass is the sum over values of
 * the logarithm of old over new standard error; errors fall as a power of the points, learnt from the passes so far. */
#include "traits/schedule.h"

#include <math.h>
#include <string.h>

enum { FIRST_POINTS = 5000, FEWEST_POINTS = 2000, STEPS = 24 };

static const double first_share =
    0.25; /* of the time left: the first pass takes no more, unless the fewest points do */
static const double growth =
    12; /* a pass has at most so many times the points of the last, whose times foretell its own */
static const double margin = 1.12; /* predictions are taken so much longer */
static const double worth = 1.3;   /* fewer times the points of the last pass are not worth a pass */
static const double least_power = 0.05, most_power = 1;

plm_group plm_group_of(const plm_trait *trait)
{
    return plm_needs_closure(trait->needs) & PLM_NEEDS_ORGANS ? PLM_GROUP_ORGANS : PLM_GROUP_PLANT;
}

double plm_schedule_seconds(const plm_schedule *schedule, const plm_pace *pace, const bool has_group[PLM_GROUP_COUNT],
                            size_t points)
{
    const plm_plan *plan =
        has_group[0] && has_group[1] ? &schedule->plan : &schedule->group[has_group[PLM_GROUP_ORGANS]].plan;
    return plm_pace_pass(pace, plan, points, schedule->all);
}

/* The most points that fit into the seconds, at most `most`; 0 where fewer than `least` do. */
static size_t points_that_fit(const plm_schedule *schedule, const plm_pace *pace, const bool has_group[PLM_GROUP_COUNT],
                              double seconds, size_t least, size_t most)
{
    if (least > most || margin * plm_schedule_seconds(schedule, pace, has_group, least) > seconds) return 0;
    if (margin * plm_schedule_seconds(schedule, pace, has_group, most) <= seconds) return most;
    double low = (double)least, high = (double)most;
    for (int i = 0; i < STEPS; i++) {
        const double middle = sqrt(low * high);
        if (margin * plm_schedule_seconds(schedule, pace, has_group, (size_t)middle) <= seconds)
            low = middle;
        else
            high = middle;
    }
    return (size_t)low;
}

plm_next_pass plm_schedule_first(const plm_schedule *schedule, const plm_pace *pace, double seconds_left)
{
    plm_next_pass next = {0};
    for (int g = 0; g < PLM_GROUP_COUNT; g++) next.has_group[g] = schedule->group[g].is_wanted;
    const size_t most = schedule->all < FIRST_POINTS ? schedule->all : FIRST_POINTS;
    const size_t least = schedule->all < FEWEST_POINTS ? schedule->all : FEWEST_POINTS;
    next.points = points_that_fit(schedule, pace, next.has_group, first_share * seconds_left, least, most);
    if (next.points == 0) next.points = least;
    const bool both = next.has_group[PLM_GROUP_PLANT] && next.has_group[PLM_GROUP_ORGANS];
    if (both && plm_schedule_seconds(schedule, pace, next.has_group, least) > seconds_left)
        next.has_group[PLM_GROUP_ORGANS] = false; /* rather the plant alone than nothing */
    next.predicted = plm_schedule_seconds(schedule, pace, next.has_group, next.points);
    return next;
}

/* What a pass of a group over so many points gains; 0 where it is not worth a pass. */
static double gain_of(const plm_group_state *group, size_t points, size_t all)
{
    const bool is_better = (double)points >= worth * (double)group->points || (points == all && points > group->points);
    if (!group->is_wanted || !is_better) return 0;
    if (group->points == 0)
        return (double)group->value_count + 1; /* no value yet: any is worth more than a better one */
    return (double)group->value_count * group->power * log((double)points / (double)group->points);
}

/* The largest pass of these groups that fits, and its gain. */
static double try_groups(const plm_schedule *schedule, const plm_pace *pace, const bool has_group[PLM_GROUP_COUNT],
                         double seconds, plm_next_pass *next)
{
    size_t least = 0, seen = 0;
    for (int g = 0; g < PLM_GROUP_COUNT; g++) {
        if (!has_group[g]) continue;
        const size_t points = schedule->group[g].points;
        if (points > least) least = points;
        if (seen == 0 || points < seen) seen = points;
    }
    const size_t most =
        seen && growth * (double)seen < (double)schedule->all ? (size_t)(growth * (double)seen) : schedule->all;
    if (least == 0) least = schedule->all < FEWEST_POINTS ? schedule->all : FEWEST_POINTS;
    memcpy(next->has_group, has_group, sizeof next->has_group);
    next->points = points_that_fit(schedule, pace, has_group, seconds, least, most);
    next->predicted = next->points ? plm_schedule_seconds(schedule, pace, has_group, next->points) : 0;
    double gain = 0;
    for (int g = 0; g < PLM_GROUP_COUNT && next->points; g++)
        if (has_group[g]) gain += gain_of(&schedule->group[g], next->points, schedule->all);
    return gain;
}

bool plm_schedule_next(const plm_schedule *schedule, const plm_pace *pace, double seconds_left, plm_next_pass *next)
{
    static const bool plant[PLM_GROUP_COUNT] = {true, false}, organs[PLM_GROUP_COUNT] = {false, true},
                      both[PLM_GROUP_COUNT] = {true, true};
    const bool wants_plant = schedule->group[PLM_GROUP_PLANT].is_wanted;
    const bool wants_organs = schedule->group[PLM_GROUP_ORGANS].is_wanted;
    plm_next_pass tried;
    double best = 0, gain;
    if (wants_plant && wants_organs && (gain = try_groups(schedule, pace, both, seconds_left, &tried)) > best) {
        best = gain;
        *next = tried;
    }
    if (wants_plant && (gain = try_groups(schedule, pace, plant, seconds_left, &tried)) > best) {
        best = gain;
        *next = tried;
    }
    /* Organs with a part of the time, and the plant alone with the rest. */
    for (int tenths = 10; tenths >= 3 && wants_organs; tenths--) {
        plm_next_pass rest;
        const double share = 0.1 * tenths * seconds_left;
        gain = try_groups(schedule, pace, organs, share, &tried);
        if (gain > 0 && wants_plant) gain += try_groups(schedule, pace, plant, seconds_left - share, &rest);
        if (gain <= best) continue;
        best = gain;
        *next = tried;
    }
    return best > 0;
}

void plm_schedule_done(plm_schedule *schedule, plm_group group, size_t points, size_t value_count, double log_ratio)
{
    plm_group_state *state = &schedule->group[group];
    if (state->points && points > state->points && isfinite(log_ratio)) {
        const double power = log_ratio / log((double)points / (double)state->points);
        state->power = fmin(fmax(0.5 * (power + state->power), least_power), most_power);
    }
    state->points = points;
    state->value_count = value_count;
}
