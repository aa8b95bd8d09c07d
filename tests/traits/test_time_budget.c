/* Time budgets and target errors: the scheduler on made-up machines, whole measurements on clocks that the test winds, and what is
 * reported of what there was no time for. */
#include "support/test.h"

#include "cloud/clock.h"
#include "support/scene.h"
#include "traits/anytime.h"

/* ---- The scheduler on a machine of its own ------------------------------------------------------------------------- */

/** How a made-up machine differs from what the model knows. */
typedef struct machine {
    double speed;  /* seconds per second of the reference */
    double power;  /* of the model's growth: stages may grow less than it has them */
    double organs; /* organs cost so many times more */
    size_t all;
} machine;

static double true_seconds(const machine *m, int stage, size_t points)
{
    const plm_pace empty = {0};
    const double few = plm_pace_predict(&empty, stage, 10000), many = plm_pace_predict(&empty, stage, points);
    const double base = m->speed * few * pow(many / few, m->power);
    return stage >= PLM_STAGE_SEGMENT && stage <= PLM_STAGE_AXES ? m->organs * base : base;
}

static plm_plan plan_of(const char *traits)
{
    plm_error error = {0};
    plm_measure_options options;
    plm_measure_defaults(&options);
    options.traits = traits;
    plm_plan plan;
    assert_ok(plm_plan_make(&options, 0, &plan, &error));
    return plan;
}

static plm_schedule schedule_of(const machine *m, bool plant, bool organs)
{
    plm_schedule made = {.all = m->all};
    made.group[PLM_GROUP_PLANT] = (plm_group_state){
        .is_wanted = plant, .plan = plan_of("plant_height,convex_hull_volume"), .power = PLM_USUAL_POWER};
    made.group[PLM_GROUP_ORGANS] = (plm_group_state){
        .is_wanted = organs, .plan = plan_of("leaf_area,petiole_inclination"), .power = PLM_USUAL_POWER};
    made.plan = plan_of(plant && organs ? NULL
                        : plant         ? "plant_height,convex_hull_volume"
                                        : "leaf_area,petiole_inclination");
    return made;
}

/* Runs a pass as the machine would; the seconds that it took. */
static double run_on(const machine *m, plm_schedule *schedule, plm_pace *pace, const plm_next_pass *next)
{
    const plm_plan *plan =
        next->has_group[0] && next->has_group[1] ? &schedule->plan : &schedule->group[next->has_group[1]].plan;
    double seconds = 0;
    for (int id = 0; id < PLM_STAGE_COUNT; id++) {
        if (!plan->stage[id].runs) continue;
        const double taken = true_seconds(m, id, next->points);
        plm_pace_note(pace, id, next->points, taken);
        seconds += taken;
    }
    for (int g = 0; g < PLM_GROUP_COUNT; g++)
        if (next->has_group[g]) plm_schedule_done(schedule, (plm_group)g, next->points, g ? 50 : 20, NAN);
    return seconds;
}

/* Uses up a budget; the seconds used. */
static double use(const machine *m, plm_schedule *schedule, double budget)
{
    plm_pace pace = {0};
    plm_next_pass next = plm_schedule_first(schedule, &pace, budget);
    double used = run_on(m, schedule, &pace, &next);
    for (int passes = 0; plm_schedule_next(schedule, &pace, budget - used, &next); passes++) {
        assert_true(passes < PLM_MOST_PASSES);
        assert_true(next.predicted > 0 && next.predicted <= budget - used);
        for (int g = 0; g < PLM_GROUP_COUNT; g++)
            if (next.has_group[g]) assert_true(next.points > schedule->group[g].points);
        used += run_on(m, schedule, &pace, &next);
    }
    return used;
}

static void no_budget_is_overrun_and_most_of_it_is_used(void **unused)
{
    (void)unused;
    static const machine machines[] = {{1, 1, 1, 5000000},    {0.3, 0.9, 1, 1000000}, {4, 1, 1, 1000000},
                                       {1, 0.75, 1, 1000000}, {1, 0.85, 3, 1000000},  {0.5, 0.8, 0.3, 5000000}};
    for (size_t i = 0; i < COUNT(machines); i++)
        for (double budget = 4; budget < 40; budget *= 2) {
            plm_schedule schedule = schedule_of(&machines[i], true, true);
            const double used = use(&machines[i], &schedule, budget);
            print_message("machine %zu, %.3g s: used %.3g s, %zu and %zu points\n", i, budget, used,
                          schedule.group[0].points, schedule.group[1].points);
            assert_true(used <= 1.02 * budget);
            const bool all_seen = schedule.group[0].points == schedule.all && schedule.group[1].points == schedule.all;
            assert_true(all_seen || used >= 0.5 * budget);
        }
}

static void small_clouds_are_looked_at_whole_and_then_time_is_left(void **unused)
{
    (void)unused;
    const machine m = {1, 0.9, 1, 30000};
    plm_schedule schedule = schedule_of(&m, true, true);
    const double used = use(&m, &schedule, 60);
    assert_int_equal(schedule.group[0].points, 30000);
    assert_int_equal(schedule.group[1].points, 30000);
    assert_true(used < 20);
}

static void where_only_the_plant_is_asked_for_all_time_is_the_plants(void **unused)
{
    (void)unused;
    const machine m = {1, 0.9, 1, 5000000};
    plm_schedule both = schedule_of(&m, true, true), plant = schedule_of(&m, true, false);
    use(&m, &both, 10);
    use(&m, &plant, 10);
    assert_int_equal(plant.group[PLM_GROUP_ORGANS].points, 0);
    assert_true(plant.group[PLM_GROUP_PLANT].points > both.group[PLM_GROUP_ORGANS].points);
}

static void errors_that_no_longer_fall_draw_less_time(void **unused)
{
    (void)unused;
    const machine m = {1, 0.9, 1, 5000000};
    plm_schedule schedule = schedule_of(&m, true, true);
    for (int g = 0; g < PLM_GROUP_COUNT; g++) plm_schedule_done(&schedule, (plm_group)g, 10000, 40, NAN);
    schedule.group[PLM_GROUP_PLANT].power = 0.05; /* noise, not spacing, is its error */
    plm_pace pace = {0};
    for (int id = 0; id < PLM_STAGE_COUNT; id++) plm_pace_note(&pace, id, 10000, true_seconds(&m, id, 10000));
    plm_next_pass next;
    assert_true(plm_schedule_next(&schedule, &pace, 3, &next));
    assert_true(next.has_group[PLM_GROUP_ORGANS]);
    schedule.group[PLM_GROUP_PLANT].power = 1;
    schedule.group[PLM_GROUP_ORGANS].power = 0.05;
    assert_true(plm_schedule_next(&schedule, &pace, 3, &next));
    assert_true(next.has_group[PLM_GROUP_PLANT] && !next.has_group[PLM_GROUP_ORGANS]);
}

/* ---- Whole measurements on a clock that the test winds --------------------------------------------------------------- */

/** Every question costs time: a machine on which nothing but asking takes any. */
typedef struct slow_clock {
    double now, step;
} slow_clock;

static double ask_clock(void *user)
{
    slow_clock *clock = user;
    double now;
#pragma omp critical(test_clock)
    now = clock->now += clock->step;
    return now;
}

static plm_cloud plant_of(size_t points)
{
    plm_error error = {0};
    const test_scene scene = {.points = points, .leaf_length = 0.3, .spacing = 0.005, .seed = 3};
    plm_cloud cloud;
    assert_ok(test_scene_make(&scene, &cloud, &error));
    plm_free(cloud.label);
    plm_free(cloud.organ);
    cloud.label = NULL;
    cloud.organ = NULL;
    return cloud;
}

/* Measures by a clock; the time that it shows at the end. */
static double measure_by(double budget, double step, const char *traits, plm_measurement *plant,
                         plm_anytime_record *record)
{
    plm_error error = {0};
    plm_cloud cloud = plant_of(30000);
    plm_measure_options options;
    plm_measure_defaults(&options);
    options.traits = traits;
    slow_clock clock = {0, step};
    const plm_anytime_options anytime = {
        .seconds = budget, .outputs = 1U << PLM_COST_LABELS, .clock = ask_clock, .clock_user = &clock};
    assert_ok(plm_measure_anytime(&cloud, &options, &anytime, plant, record, &error));
    return clock.now;
}

static size_t count_late(const plm_measurement *plant)
{
    size_t late = 0;
    for (size_t i = 0; i < plant->value_count; i++) {
        const plm_estimate *e = &plant->value[i].estimate;
        if (e->state == PLM_STATE_OK) continue;
        assert_true(e->reason[0] != 0);
        late += strstr(e->reason, "time budget") != NULL;
    }
    return late;
}

/* The stages ask between their steps; none of them may ask so often that a budget is used up by asking. */
static void what_there_is_no_time_for_is_left_out_with_that_reason(void **unused)
{
    (void)unused;
    static const double step[] = {1e-4, 0.003, 0.01, 0.03, 0.1, 0.4, 2};
    size_t late_before = 0;
    for (size_t i = 0; i < COUNT(step); i++) {
        plm_measurement plant;
        plm_anytime_record record;
        const double used = measure_by(1, step[i], NULL, &plant, &record);
        const size_t late = count_late(&plant);
        print_message("%g s a question: used %.3g of 1 s, %zu of %zu values late, %zu passes\n", step[i], used, late,
                      plant.value_count, record.pass_count);
        assert_true(used <= 1.1 + 80 * step[i]); /* each row is asked for */
        assert_true(late >= late_before || late > plant.value_count / 2);
        assert_true((late > 0) == (record.is_late[0] || record.is_late[1]));
        assert_true(plant.cloud.count > 1000); /* what is shown is what was measured, however little of it */
        late_before = late;
        plm_measurement_free(&plant);
    }
    assert_true(late_before > 0);
}

static void a_deadline_that_has_passed_leaves_rows_without_values(void **unused)
{
    (void)unused;
    plm_error error = {0};
    plm_cloud cloud = plant_of(5000);
    plm_measure_options options;
    plm_measure_defaults(&options);
    const plm_deadline deadline = {.at = plm_seconds_now() - 1};
    options.deadline = &deadline;
    plm_measurement plant;
    assert_ok(plm_measure(&cloud, &options, &plant, &error));
    assert_true(plant.value_count > 20);
    for (size_t i = 0; i < plant.value_count; i++) {
        assert_int_not_equal(plant.value[i].estimate.state, PLM_STATE_OK);
        assert_true(plant.value[i].estimate.reason[0] != 0);
    }
    assert_true(count_late(&plant) > plant.value_count / 2);
    plm_measurement_free(&plant);
}

/* A repeated pass: what the budget's record names gives the same digits again. */
static void the_points_of_the_record_give_the_same_digits(void **unused)
{
    (void)unused;
    plm_error error = {0};
    plm_measurement plant, again;
    plm_anytime_record record;
    measure_by(100, 1e-5, "leaf_area,plant_height", &plant, &record);
    plm_cloud cloud = plant_of(30000);
    plm_measure_options options;
    plm_measure_defaults(&options);
    options.traits = "leaf_area,plant_height";
    options.points = record.points[PLM_GROUP_ORGANS];
    assert_ok(plm_measure(&cloud, &options, &again, &error));
    assert_int_equal(plant.value_count, again.value_count);
    for (size_t i = 0; i < plant.value_count; i++) {
        assert_ptr_equal(plant.value[i].trait, again.value[i].trait);
        assert_int_equal(plant.value[i].estimate.state, again.value[i].estimate.state);
        if (plant.value[i].estimate.state != PLM_STATE_OK) continue;
        assert_near(plant.value[i].estimate.value, again.value[i].estimate.value, 0);
    }
    plm_measurement_free(&plant);
    plm_measurement_free(&again);
}

/* ---- Target errors ------------------------------------------------------------------------------------------------- */

static void targets_are_read_in_the_traits_unit_or_in_percent(void **unused)
{
    (void)unused;
    plm_error error = {0};
    plm_target target[PLM_MOST_TARGETS];
    size_t count = 0;
    assert_ok(plm_targets_parse("leaf_area=2%, plant_height=1mm,petiole_inclination=0.5 deg", target, &count, &error));
    assert_ok(
        plm_targets_parse("plant_height=0.2cm,total_leaf_area=3,convex_hull_volume=100mm3", target, &count, &error));
    assert_int_equal(count, 6);
    assert_true(target[0].is_relative && !target[1].is_relative);
    assert_string_equal(target[0].trait->name, "leaf_area");
    assert_near(target[0].half_width, 0.02, 1e-15);
    assert_near(target[1].half_width, 0.001, 1e-15);
    assert_near(target[2].half_width, 0.5 * 3.14159265358979 / 180, 1e-12);
    assert_near(target[3].half_width, 0.002, 1e-15);
    assert_near(target[4].half_width, 3e-4, 1e-15);
    assert_near(target[5].half_width, 1e-7, 1e-20);
    static const char *const wrong[] = {"",
                                        ",",
                                        "leaf_area",
                                        "leaf_area=",
                                        "leaf_area=x",
                                        "leaf_area=0%",
                                        "leaf_area=-1%",
                                        "leaf_area=2mm",
                                        "leaf_areas=2%",
                                        "leaf=2%",
                                        "leaf_area=inf"};
    for (size_t i = 0; i < COUNT(wrong); i++) {
        count = 0;
        assert_int_equal(plm_targets_parse(wrong[i], target, &count, &error), PLM_E_ARGUMENT);
        assert_true(error.message[0] != 0);
    }
    count = 0;
    assert_int_equal(plm_targets_parse("leaf_area=1%,leaf_area=1%,leaf_area=1%,leaf_area=1%,leaf_area=1%,leaf_area=1%,"
                                       "leaf_area=1%,leaf_area=1%,leaf_area=1%",
                                       target, &count, &error),
                     PLM_E_ARGUMENT);
}

static void traits_of_organs_are_judged_by_the_median_organ(void **unused)
{
    (void)unused;
    plm_error error = {0};
    plm_target target[PLM_MOST_TARGETS];
    size_t count = 0;
    assert_ok(plm_targets_parse("leaf_area=10%", target, &count, &error));
    plm_trait_value value[4];
    static const double std_error[] = {0.01, 0.02, 0.04, 0.2};
    for (int i = 0; i < 4; i++)
        value[i] = (plm_trait_value){.trait = target->trait, .estimate = {.value = 1, .std_error = std_error[i]}};
    plm_target_outcome out = plm_target_check(target, value, 3);
    assert_true(out.is_reached);
    assert_near(out.half_width, 1.96 * 0.02, 1e-12);
    assert_near(out.worst, 1.96 * 0.04, 1e-12);
    assert_int_equal(out.organs_within, 3);
    value[1].estimate.state = PLM_STATE_FAILED; /* no value is no small error */
    out = plm_target_check(target, value, 4);
    assert_false(out.is_reached);
    assert_int_equal(out.organs_within, 2);
    assert_false(plm_target_check(target, value, 0).is_reached);
}

static plm_anytime_record reach(const char *text, plm_measurement *plant)
{
    plm_error error = {0};
    plm_target target[PLM_MOST_TARGETS];
    plm_anytime_options anytime = {.target = target};
    assert_ok(plm_targets_parse(text, target, &anytime.target_count, &error));
    plm_cloud cloud = plant_of(30000);
    plm_measure_options options;
    plm_measure_defaults(&options);
    options.traits = "plant,stem";
    plm_anytime_record record;
    assert_ok(plm_measure_anytime(&cloud, &options, &anytime, plant, &record, &error));
    return record;
}

static void a_target_ends_with_as_few_points_as_reach_it_or_with_all(void **unused)
{
    (void)unused;
    plm_measurement plant;
    plm_anytime_record easy = reach("plant_height=50%", &plant);
    assert_true(easy.outcome[0].is_reached);
    assert_true(easy.points[PLM_GROUP_PLANT] < 8000);
    plm_measurement_free(&plant);
    plm_anytime_record hard = reach("plant_height=0.0001%", &plant);
    assert_false(hard.outcome[0].is_reached);
    assert_int_equal(hard.points[PLM_GROUP_PLANT], plant.cloud.count);
    /* All that was asked for comes with the points that the target took. */
    assert_int_equal(hard.points[PLM_GROUP_ORGANS], plant.cloud.count);
    assert_true(hard.outcome[0].half_width < easy.outcome[0].half_width);
    plm_measurement_free(&plant);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_budget_is_overrun_and_most_of_it_is_used),
        cmocka_unit_test(small_clouds_are_looked_at_whole_and_then_time_is_left),
        cmocka_unit_test(where_only_the_plant_is_asked_for_all_time_is_the_plants),
        cmocka_unit_test(errors_that_no_longer_fall_draw_less_time),
        plant_case(what_there_is_no_time_for_is_left_out_with_that_reason),
        cmocka_unit_test(a_deadline_that_has_passed_leaves_rows_without_values),
        cmocka_unit_test(the_points_of_the_record_give_the_same_digits),
        cmocka_unit_test(targets_are_read_in_the_traits_unit_or_in_percent),
        cmocka_unit_test(traits_of_organs_are_judged_by_the_median_organ),
        plant_case(a_target_ends_with_as_few_points_as_reach_it_or_with_all),
    };
    return run_cases(tests);
}
