/* traits/anytime.c: passes over more and more points, until the time is used or the errors are small enough. The values that are
 * reported are those of the largest complete pass, not those with the smallest reported errors: choosing by an estimated error
 * would choose the underestimated ones. Traits of the plant and of its organs may come from different passes; all traits of
 * organs come from one, as their numbers do. */
#include "traits/anytime.h"

#include "cloud/clock.h"

#include <math.h>
#include <string.h>

static const double usable = 0.97;   /* of the time; the rest is for what no model knows */
static const double tables = 0.008;  /* seconds for the tables on the reference machine */
static const double for_files = 0.4; /* of the time left behind the first pass: files are given no more */
static const double short_of = 1.1;  /* points asked for over those that the errors' power says suffice */
static const double least_step = 1.5, most_step = 4; /* times the points of the last pass, towards a target */

typedef struct anytime_job {
    plm_measure_options options; /* with a deadline */
    plm_deadline deadline;
    const plm_anytime_options *anytime;
    plm_anytime_record *record;
    const plm_cloud *cloud;
    bool *chosen, *in_pass; /* rows of the trait table: asked for; of a pass */
    size_t trait_count;
    plm_schedule schedule;
    bool has_base, has_organ_rows; /* the base has rows of organs, be they late */
    plm_pass base;                 /* the largest complete pass over organs; else the first */
    bool has_plant;
    size_t plant_count; /* values of the plant's group, of the largest complete pass over it; else of the first */
    plm_trait_value *plant;
    plm_mesh hull;
} anytime_job;

static double now_of(const plm_anytime_options *anytime)
{
    return anytime->clock ? anytime->clock(anytime->clock_user) : plm_seconds_now();
}

double plm_anytime_left(const plm_anytime_options *anytime, const plm_pace *pace)
{
    if (!(anytime->seconds > 0)) return INFINITY;
    const double for_tables = tables * fmax(1, plm_pace_speed(pace));
    return anytime->begin + usable * anytime->seconds - for_tables - now_of(anytime);
}

/* ---- What passes gave -------------------------------------------------------------------------------------------- */

/* How many values of a group have a standard error; and, by trait, the sum of their squares and their number. */
static size_t sum_errors(const plm_trait_value *value, size_t count, plm_group group, const plm_trait *trait,
                         double *squares, size_t *number)
{
    size_t found = 0;
    *squares = 0;
    *number = 0;
    for (size_t i = 0; i < count; i++) {
        const double error = value[i].estimate.std_error;
        if (plm_group_of(value[i].trait) != group || value[i].estimate.state != PLM_STATE_OK || !(error > 0)) continue;
        found++;
        if (value[i].trait != trait) continue;
        *squares += error * error;
        ++*number;
    }
    return found;
}

/* Mean over the traits of a group of the logarithm of old over new error; NAN where they have none in common. */
static double compare_errors(const plm_trait_value *old, size_t old_count, const plm_trait_value *new, size_t new_count,
                             plm_group group)
{
    size_t count, common = 0, n[2];
    const plm_trait *trait = plm_traits(&count);
    double sum = 0, squares[2];
    for (size_t i = 0; i < count; i++) {
        sum_errors(old, old_count, group, &trait[i], &squares[0], &n[0]);
        sum_errors(new, new_count, group, &trait[i], &squares[1], &n[1]);
        if (!n[0] || !n[1]) continue;
        sum += 0.5 * log(squares[0] / (double)n[0] / (squares[1] / (double)n[1]));
        common++;
    }
    return common ? sum / (double)common : NAN;
}

static void note_group(anytime_job *job, plm_group group, const plm_trait_value *old, size_t old_count,
                       const plm_pass *pass)
{
    double squares;
    size_t number;
    const plm_measurement *draft = &pass->draft;
    const size_t count = sum_errors(draft->value, draft->value_count, group, NULL, &squares, &number);
    const double ratio = compare_errors(old, old_count, draft->value, draft->value_count, group);
    plm_schedule_done(&job->schedule, group, pass->work.count, count, ratio);
    job->record->points[group] = pass->work.count;
}

/* The plant's group of a pass, complete or the first: copies the values, takes the hull. */
static plm_status take_plant(anytime_job *job, plm_pass *pass, bool is_complete, plm_error *error)
{
    plm_measurement *draft = &pass->draft;
    plm_trait_value *values = plm_alloc(draft->value_count, sizeof *values, error);
    if (!values) return PLM_E_MEMORY;
    size_t count = 0;
    for (size_t i = 0; i < draft->value_count; i++)
        if (plm_group_of(draft->value[i].trait) == PLM_GROUP_PLANT) values[count++] = draft->value[i];
    if (is_complete) note_group(job, PLM_GROUP_PLANT, job->plant, job->plant_count, pass);
    plm_free(job->plant);
    job->plant = values;
    job->plant_count = count;
    job->has_plant = true;
    if (draft->hull.triangle_count) {
        plm_mesh_free(&job->hull);
        job->hull = draft->hull;
        draft->hull = (plm_mesh){0};
    }
    return PLM_OK;
}

/* What a pass gave, if it is worth keeping; the pass is freed or moved. */
static plm_status take_pass(anytime_job *job, const plm_pass_record *record, plm_pass *pass, plm_error *error)
{
    plm_status status = PLM_OK;
    const bool is_complete = record->is_complete[PLM_GROUP_PLANT];
    if (is_complete || (record->has_group[PLM_GROUP_PLANT] && !job->has_plant))
        status = take_plant(job, pass, is_complete, error);
    const bool has_organs = record->is_complete[PLM_GROUP_ORGANS];
    if (status == PLM_OK && has_organs)
        note_group(job, PLM_GROUP_ORGANS, job->base.draft.value, job->base.draft.value_count, pass);
    const bool only_plant = !job->schedule.group[PLM_GROUP_ORGANS].is_wanted && record->is_complete[PLM_GROUP_PLANT];
    const bool first_rows = record->has_group[PLM_GROUP_ORGANS] && !job->has_organ_rows;
    job->has_organ_rows |= record->has_group[PLM_GROUP_ORGANS];
    if (status == PLM_OK && (has_organs || only_plant || first_rows || !job->has_base)) {
        plm_pass_free(&job->base);
        job->base = *pass;
        job->has_base = true;
        *pass = (plm_pass){0};
    }
    plm_pass_free(pass);
    return status;
}

/* ---- A pass ------------------------------------------------------------------------------------------------------ */

static plm_status run_pass(anytime_job *job, const plm_next_pass *next, const bool *chosen, plm_error *error)
{
    plm_pass pass = {0};
    plm_pass_record *record = &job->record->pass[job->record->pass_count];
    size_t count;
    const plm_trait *trait = plm_traits(&count);
    for (size_t i = 0; i < count; i++) job->in_pass[i] = chosen[i] && next->has_group[plm_group_of(&trait[i])];
    const plm_pass_options options = {.measure = &job->options,
                                      .chosen = job->in_pass,
                                      .points = next->points < job->cloud->count ? next->points : 0,
                                      .pace = &job->record->pace};
    const double begin = now_of(job->anytime);
    plm_status status = plm_pass_run(job->cloud, &options, &pass, error);
    if (status != PLM_OK) return status;
    *record = (plm_pass_record){
        .points = pass.work.count, .predicted = next->predicted, .seconds = now_of(job->anytime) - begin};
    for (int g = 0; g < PLM_GROUP_COUNT; g++) {
        record->has_group[g] = next->has_group[g];
        record->is_complete[g] = next->has_group[g] && !pass.late_in[g];
    }
    job->record->pass_count++;
    return take_pass(job, record, &pass, error);
}

static plm_status run_first(anytime_job *job, const bool *chosen, plm_error *error)
{
    const plm_next_pass first =
        plm_schedule_first(&job->schedule, &job->record->pace, plm_anytime_left(job->anytime, &job->record->pace));
    return run_pass(job, &first, chosen, error);
}

/* ---- Time -------------------------------------------------------------------------------------------------------- */

/* Seconds kept for what comes after the passes: of the outputs that are wanted, cheapest first, those that get along with their
 * share of the time. */
static double time_for_outputs(const anytime_job *job, double left)
{
    const plm_measurement *draft = &job->base.draft;
    double cost[PLM_COST_COUNT], kept = 0;
    bool is_done[PLM_COST_COUNT] = {false};
    for (int c = PLM_COST_LABELS; c < PLM_COST_COUNT; c++)
        cost[c] = plm_pace_predict(
            &job->record->pace, c,
            plm_cost_size((plm_cost)c, job->cloud->count, draft->used_points, draft->leaves.triangle_count));
    cost[PLM_COST_CLOUD_FILE] += cost[PLM_COST_LABELS]; /* which it cannot do without */
    is_done[PLM_COST_LABELS] = true;
    while (true) {
        int cheapest = 0;
        for (int c = PLM_COST_LABELS; c < PLM_COST_COUNT; c++)
            if (!is_done[c] && job->anytime->outputs & 1U << c && (!cheapest || cost[c] < cost[cheapest])) cheapest = c;
        if (!cheapest || kept + cost[cheapest] > for_files * left) return kept;
        kept += cost[cheapest];
        is_done[cheapest] = true;
    }
}

/* ---- Targets ----------------------------------------------------------------------------------------------------- */

/* The values as they would be reported now: of the plant's group where that is ahead. */
static void check_targets(anytime_job *job)
{
    for (size_t t = 0; t < job->anytime->target_count; t++) {
        const plm_target *target = &job->anytime->target[t];
        const bool of_plant = plm_group_of(target->trait) == PLM_GROUP_PLANT && job->has_plant;
        const plm_measurement *draft = &job->base.draft;
        job->record->outcome[t] = plm_target_check(target, of_plant ? job->plant : draft->value,
                                                   of_plant ? job->plant_count : draft->value_count);
    }
}

static bool are_reached(const anytime_job *job)
{
    bool reached = job->anytime->target_count > 0;
    for (size_t t = 0; t < job->anytime->target_count; t++) reached = reached && job->record->outcome[t].is_reached;
    return reached;
}

/* Points that should suffice for the targets that are not reached, by the power of the errors. */
static size_t points_for_targets(const anytime_job *job)
{
    double points = 0;
    for (size_t t = 0; t < job->anytime->target_count; t++) {
        const plm_target_outcome *outcome = &job->record->outcome[t];
        const plm_target *target = &job->anytime->target[t];
        const plm_group_state *group = &job->schedule.group[plm_group_of(target->trait)];
        if (outcome->is_reached) continue;
        const double times = short_of * pow(outcome->half_width / target->half_width, 1 / group->power);
        points = fmax(points, (double)group->points * fmin(fmax(times, least_step), most_step));
    }
    if (points == 0) points = most_step * (double)job->base.work.count;
    return points < 0.7 * (double)job->cloud->count ? (size_t)points : job->cloud->count;
}

/* ---- The passes in turn ------------------------------------------------------------------------------------------ */

static bool next_in_time(anytime_job *job, double left, plm_next_pass *next)
{
    if (!plm_schedule_next(&job->schedule, &job->record->pace, left, next)) return false;
    if (job->anytime->target_count && points_for_targets(job) < next->points) {
        next->points = points_for_targets(job);
        next->predicted = plm_schedule_seconds(&job->schedule, &job->record->pace, next->has_group, next->points);
    }
    return true;
}

/* Organs that no pass came to get their rows, which say so: those of a pass whose time is over. Nothing else of it is kept,
 * as it looks at no points to speak of. */
static plm_status tell_of_organs(anytime_job *job, plm_error *error)
{
    if (!job->schedule.group[PLM_GROUP_ORGANS].is_wanted || job->has_organ_rows) return PLM_OK;
    const plm_next_pass none = {.has_group = {false, true}, .points = 1};
    plm_pass before = job->base;
    const bool had_base = job->has_base;
    job->base = (plm_pass){0};
    job->has_base = false;
    job->deadline.at = -INFINITY;
    const plm_status status = run_pass(job, &none, job->chosen, error);
    if (!had_base) return status;
    if (job->has_base) {
        const plm_measurement told = job->base.draft;
        job->base.draft.value = before.draft.value;
        job->base.draft.value_count = before.draft.value_count;
        before.draft.value = told.value;
        before.draft.value_count = told.value_count;
    }
    plm_pass_free(&job->base);
    job->base = before;
    job->has_base = true;
    return status;
}

/* Until no pass fits any more, or is worth it. */
static plm_status use_the_time(anytime_job *job, plm_error *error)
{
    plm_status status = run_first(job, job->chosen, error);
    while (status == PLM_OK && job->record->pass_count + 1 < PLM_MOST_PASSES) {
        plm_next_pass next;
        check_targets(job);
        const double left = plm_anytime_left(job->anytime, &job->record->pace);
        const double kept = time_for_outputs(job, left);
        if (are_reached(job) || !next_in_time(job, left - kept, &next)) break;
        job->deadline.at = now_of(job->anytime) + left - kept;
        status = run_pass(job, &next, job->chosen, error);
    }
    return status == PLM_OK ? tell_of_organs(job, error) : status;
}

/* Until the targets are reached, looking at their traits alone, or until all points are; then all traits over as many. */
static plm_status reach_targets(anytime_job *job, const bool *of_targets, plm_error *error)
{
    plm_status status = run_first(job, of_targets, error);
    size_t points = job->base.work.count;
    while (status == PLM_OK && job->record->pass_count + 1 < PLM_MOST_PASSES) {
        check_targets(job);
        if (are_reached(job) || points >= job->cloud->count) break;
        plm_next_pass next = {.points = points_for_targets(job)};
        for (int g = 0; g < PLM_GROUP_COUNT; g++) next.has_group[g] = job->schedule.group[g].is_wanted;
        if (next.points <= points) next.points = job->cloud->count;
        next.predicted = plm_schedule_seconds(&job->schedule, &job->record->pace, next.has_group, next.points);
        status = run_pass(job, &next, of_targets, error);
        points = next.points;
    }
    return status;
}

/* ---- Beginning and end ------------------------------------------------------------------------------------------- */

/* Plans and groups for the traits that chosen marks. */
static plm_status make_schedule(anytime_job *job, const bool *chosen, plm_error *error)
{
    size_t count;
    const plm_trait *trait = plm_traits(&count);
    const unsigned attributes = plm_cloud_attributes(job->cloud);
    plm_schedule made = {.all = job->cloud->count};
    plm_status status = plm_plan_of(&job->options, chosen, attributes, &made.plan, error);
    for (int g = 0; g < PLM_GROUP_COUNT && status == PLM_OK; g++) {
        plm_group_state *group = &made.group[g];
        group->power = PLM_USUAL_POWER;
        for (size_t i = 0; i < count; i++) {
            job->in_pass[i] = chosen[i] && (int)plm_group_of(&trait[i]) == g;
            group->is_wanted |= job->in_pass[i];
        }
        status = plm_plan_of(&job->options, job->in_pass, attributes, &group->plan, error);
    }
    if (status == PLM_OK) job->schedule = made;
    return status;
}

/* Whether the traits of the targets make fewer stages run than all that were asked for. */
static plm_status choose_for_targets(const anytime_job *job, bool *of_targets, bool *is_less, plm_error *error)
{
    plm_plan all, few;
    const plm_trait *trait = plm_traits(&(size_t){0});
    const unsigned attributes = plm_cloud_attributes(job->cloud);
    memset(of_targets, 0, job->trait_count * sizeof *of_targets);
    for (size_t t = 0; t < job->anytime->target_count; t++) of_targets[job->anytime->target[t].trait - trait] = true;
    plm_status status = plm_plan_of(&job->options, job->chosen, attributes, &all, error);
    if (status == PLM_OK) status = plm_plan_of(&job->options, of_targets, attributes, &few, error);
    *is_less = false;
    for (int id = 0; id < PLM_STAGE_COUNT && status == PLM_OK; id++)
        *is_less = *is_less || (all.stage[id].runs && !few.stage[id].runs);
    if (!*is_less) memcpy(of_targets, job->chosen, job->trait_count * sizeof *of_targets);
    return status;
}

static void forget_passes(anytime_job *job)
{
    plm_pass_free(&job->base);
    plm_free(job->plant);
    plm_mesh_free(&job->hull);
    job->plant = NULL;
    job->plant_count = 0;
    job->has_plant = job->has_base = job->has_organ_rows = false;
}

static plm_status reach_targets_then_all(anytime_job *job, plm_error *error)
{
    bool is_less = false;
    bool *of_targets = plm_alloc(job->trait_count, sizeof *of_targets, error);
    if (!of_targets) return PLM_E_MEMORY;
    plm_status status = choose_for_targets(job, of_targets, &is_less, error);
    if (status == PLM_OK) status = make_schedule(job, of_targets, error);
    if (status == PLM_OK) status = reach_targets(job, of_targets, error);
    plm_free(of_targets);
    if (status != PLM_OK || !is_less) return status;
    plm_next_pass last = {.points = job->record->pass[job->record->pass_count - 1].points};
    forget_passes(job);
    status = make_schedule(job, job->chosen, error);
    for (int g = 0; g < PLM_GROUP_COUNT; g++) last.has_group[g] = job->schedule.group[g].is_wanted;
    last.predicted = plm_schedule_seconds(&job->schedule, &job->record->pace, last.has_group, last.points);
    if (status == PLM_OK) status = run_pass(job, &last, job->chosen, error);
    check_targets(job);
    return status;
}

/* The base's values, those of the plant's group replaced by those of a larger pass over it. Both hold all that was asked for, or
 * their group of it, in the order of the table. */
static plm_status join_values(anytime_job *job, plm_error *error)
{
    plm_measurement *draft = &job->base.draft;
    const size_t most = draft->value_count + job->plant_count;
    plm_trait_value *joined = plm_alloc(most, sizeof *joined, error);
    if (!joined) return PLM_E_MEMORY;
    size_t count = 0, from_base = 0, from_plant = 0;
    while (from_base < draft->value_count || from_plant < job->plant_count) {
        const plm_trait_value *base = from_base < draft->value_count ? &draft->value[from_base] : NULL;
        const plm_trait_value *plant = from_plant < job->plant_count ? &job->plant[from_plant] : NULL;
        if (base && job->has_plant && plm_group_of(base->trait) == PLM_GROUP_PLANT) {
            from_base++; /* comes from the other list */
        } else if (plant && (!base || base->trait->level != PLM_PLANT || plant->trait < base->trait)) {
            joined[count++] = *plant;
            from_plant++;
        } else {
            joined[count++] = *base;
            from_base++;
        }
    }
    plm_free(draft->value);
    draft->value = joined;
    draft->value_count = count;
    if (job->hull.triangle_count) {
        plm_mesh_free(&draft->hull);
        draft->hull = job->hull;
        job->hull = (plm_mesh){0};
    }
    return PLM_OK;
}

static plm_status finish(anytime_job *job, plm_cloud *cloud, plm_measurement *measurement, plm_error *error)
{
    plm_anytime_record *record = job->record;
    for (int g = 0; g < PLM_GROUP_COUNT; g++)
        record->is_late[g] = job->schedule.group[g].is_wanted && !record->points[g];
    plm_status status = join_values(job, error);
    const size_t all = cloud->count;
    double needed = plm_pace_predict(&record->pace, PLM_COST_LABELS, all);
    if (job->anytime->outputs & 1U << PLM_COST_CLOUD_FILE)
        needed += plm_pace_predict(&record->pace, PLM_COST_CLOUD_FILE, all);
    const bool is_all_seen = job->base.work.count == all;
    record->has_all_points = is_all_seen || (job->anytime->outputs & 1U << PLM_COST_LABELS &&
                                             needed < plm_anytime_left(job->anytime, &record->pace));
    const double begin = now_of(job->anytime);
    if (status == PLM_OK) status = plm_pass_finish(&job->base, cloud, record->has_all_points, measurement, error);
    if (record->has_all_points && !is_all_seen)
        plm_pace_note(&record->pace, PLM_COST_LABELS, all, now_of(job->anytime) - begin);
    return status;
}

plm_status plm_measure_anytime(plm_cloud *cloud, const plm_measure_options *options, const plm_anytime_options *anytime,
                               plm_measurement *measurement, plm_anytime_record *record, plm_error *error)
{
    plm_cloud taken = *cloud;
    *cloud = (plm_cloud){0};
    *record = (plm_anytime_record){0};
    const double left = plm_anytime_left(anytime, &record->pace);
    anytime_job job = {.options = *options,
                       .deadline = {now_of(anytime) + left, anytime->clock, anytime->clock_user},
                       .anytime = anytime,
                       .record = record,
                       .cloud = &taken};
    plm_traits(&job.trait_count);
    job.options.deadline = &job.deadline;
    job.chosen = plm_alloc(job.trait_count, sizeof *job.chosen, error);
    job.in_pass = job.chosen ? plm_alloc(job.trait_count, sizeof *job.in_pass, error) : NULL;
    plm_status status = job.in_pass ? plm_check_points(&taken, error) : PLM_E_MEMORY;
    if (status == PLM_OK) status = plm_trait_choose(options->traits, job.chosen, error);
    const plm_trait *trait = plm_traits(&(size_t){0});
    for (size_t t = 0; t < anytime->target_count && status == PLM_OK; t++)
        job.chosen[anytime->target[t].trait - trait] = true;
    if (status == PLM_OK) status = make_schedule(&job, job.chosen, error);
    if (status == PLM_OK && anytime->seconds > 0)
        status = use_the_time(&job, error);
    else if (status == PLM_OK)
        status = reach_targets_then_all(&job, error);
    if (status == PLM_OK) status = finish(&job, &taken, measurement, error);
    forget_passes(&job);
    plm_cloud_free(&taken);
    plm_free(job.in_pass);
    plm_free(job.chosen);
    return status;
}
