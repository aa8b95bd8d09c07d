/* traits/pace.c: seconds of the stages, predicted. A stage's seconds grow as a power of its points (and of some more, for what it
 * does whatever the points are); reference, powers and offsets were read off measurements of virtual plants of seven kinds at
 * 2000 to 400 000 points, the powers at the upper end of what was seen, so that a prediction for more points errs to the long
 * side. What two passes showed replaces the reference's power where it is less. */
#include "traits/pace.h"

#include <math.h>

/** Seconds at 10 000 (points, triangles; the page: 1) on the reference machine, the power, and the offset in points. */
static const struct cost_row {
    double seconds, power, offset, unit;
} reference[PLM_COST_COUNT] = {
    [PLM_STAGE_FRAME] = {0.150, 0.7, 3000, 1e4},  [PLM_STAGE_GROUND] = {0.020, 0.8, 5000, 1e4},
    [PLM_STAGE_CLEAN] = {0.050, 1.0, 0, 1e4},     [PLM_STAGE_INDEX] = {0.025, 0.8, 0, 1e4},
    [PLM_STAGE_SEGMENT] = {0.300, 0.9, 0, 1e4},   [PLM_STAGE_ORGANS] = {0.030, 1.0, 0, 1e4},
    [PLM_STAGE_SURFACES] = {0.060, 1.0, 0, 1e4},  [PLM_STAGE_AXES] = {0.060, 0.95, 0, 1e4},
    [PLM_STAGE_HULL] = {0.015, 1.0, 0, 1e4},      [PLM_STAGE_SMOOTHNESS] = {0.005, 1.0, 0, 1e4},
    [PLM_STAGE_LIGHT] = {1.0, 0.8, 0, 1e4},       [PLM_STAGE_TRAITS] = {0.300, 1.0, 20000, 1e4},
    [PLM_COST_SAMPLE] = {0.0005, 1.0, 0, 1e4},    [PLM_COST_LABELS] = {0.010, 1.1, 0, 1e4},
    [PLM_COST_CLOUD_FILE] = {0.002, 1.0, 0, 1e4}, [PLM_COST_MESH_FILE] = {0.003, 1.0, 0, 1e4},
    [PLM_COST_PICTURE] = {0.100, 0.4, 0, 1e4},    [PLM_COST_VIEW] = {0.130, 1.25, 0, 1e4},
    [PLM_COST_PAGE] = {0.030, 1.0, 0, 1},
};

/** A stage that took less than this share of what the reference would have taken may find more to do among more points. */
static const double least_share = 0.25;
/** What is added to a power that two passes showed. */
static const double power_margin = 0.15, least_power = 0.2;

size_t plm_cost_size(plm_cost cost, size_t all, size_t used, size_t triangles)
{
    switch (cost) {
        case PLM_COST_MESH_FILE:
        case PLM_COST_VIEW:
            return triangles;
        case PLM_COST_PICTURE:
            return used;
        case PLM_COST_PAGE:
            return 1;
        default:
            return all;
    }
}

/* How many times as long a cost of one size takes as of another. */
static double growth(int cost, double power, double from, double to)
{
    const double offset = reference[cost].offset;
    return pow((to + offset) / (from + offset), power);
}

static double by_reference(int cost, double size)
{
    return reference[cost].seconds * growth(cost, reference[cost].power, reference[cost].unit, size);
}

double plm_pace_speed(const plm_pace *pace)
{
    return pace->reference > 0 ? pace->seconds / pace->reference : 1;
}

void plm_pace_note(plm_pace *pace, int cost, size_t size, double seconds)
{
    struct plm_pace_note *note = &pace->note[cost];
    if (size == 0) return;
    if (note->size > 0 && (double)size > 1.5 * note->size && note->seconds > 0 && seconds > 0) {
        const double shown = log(seconds / note->seconds) / log(growth(cost, 1, note->size, (double)size));
        note->power = fmin(fmax(shown + power_margin, least_power), reference[cost].power);
    }
    note->size = (double)size;
    note->seconds = seconds;
    pace->seconds += seconds;
    pace->reference += by_reference(cost, (double)size);
}

double plm_pace_predict(const plm_pace *pace, int cost, size_t size)
{
    const struct plm_pace_note *note = &pace->note[cost];
    if (size == 0) return 0;
    const double usual = plm_pace_speed(pace) * by_reference(cost, (double)size);
    if (!(note->size > 0)) return usual;
    const double power = note->power > 0 ? note->power : reference[cost].power;
    return fmax(note->seconds * growth(cost, power, note->size, (double)size), least_share * usual);
}

double plm_pace_pass(const plm_pace *pace, const plm_plan *plan, size_t points, size_t all)
{
    double seconds = plm_pace_predict(pace, PLM_COST_SAMPLE, all);
    for (int id = 0; id < PLM_STAGE_COUNT; id++)
        if (plan->stage[id].runs) seconds += plm_pace_predict(pace, id, points);
    return seconds;
}
