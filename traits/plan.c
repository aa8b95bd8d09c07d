/* traits/plan.c: what runs for the traits asked for and for what the cloud has. Stages and their needs are a table; a
 * stage runs when a chosen trait needs it, or when another stage that runs does. */
#include "traits/plan.h"

#include "cloud/nearest_name.h"

#include <stdio.h>
#include <string.h>

/** A need of the last stages that every trait has. */
enum { NEEDS_ALWAYS = 1 << 30, NEEDS_INDEX = 1 << 29 };

/** One stage: the needs that make it run. */
static const struct stage_row {
    const char *name;
    unsigned needs;
} stages[PLM_STAGE_COUNT] = {
    [PLM_STAGE_FRAME] = {"frame", PLM_NEEDS_ZENITH},
    [PLM_STAGE_GROUND] = {"ground", PLM_NEEDS_GROUND},
    [PLM_STAGE_CLEAN] = {"clean", PLM_NEEDS_CLEAN},
    [PLM_STAGE_INDEX] = {"index", NEEDS_INDEX},
    [PLM_STAGE_SEGMENT] = {"segment", PLM_NEEDS_ORGANS},
    [PLM_STAGE_ORGANS] = {"organs", PLM_NEEDS_ORGANS},
    [PLM_STAGE_SURFACES] = {"surfaces", PLM_NEEDS_SURFACE},
    [PLM_STAGE_AXES] = {"axes", PLM_NEEDS_AXIS},
    [PLM_STAGE_HULL] = {"hull", PLM_NEEDS_HULL},
    [PLM_STAGE_SMOOTHNESS] = {"smoothness", PLM_NEEDS_NEIGHBOURS},
    [PLM_STAGE_LIGHT] = {"light", PLM_NEEDS_LIGHT},
    [PLM_STAGE_TRAITS] = {"traits", NEEDS_ALWAYS},
};

/** What a need rests on. Rows stand so that one pass from the top down closes the set. */
static const struct rests_row {
    unsigned need, on;
} rests[] = {
    {PLM_NEEDS_LIGHT, PLM_NEEDS_SURFACE | PLM_NEEDS_AXIS},
    {PLM_NEEDS_SURFACE, PLM_NEEDS_ORGANS},
    {PLM_NEEDS_AXIS, PLM_NEEDS_ORGANS},
    {PLM_NEEDS_ORGANS, PLM_NEEDS_CLEAN | NEEDS_INDEX},
    {PLM_NEEDS_HULL, PLM_NEEDS_CLEAN | NEEDS_INDEX},
    {PLM_NEEDS_NEIGHBOURS, PLM_NEEDS_CLEAN | NEEDS_INDEX},
    {PLM_NEEDS_SAMPLING, PLM_NEEDS_CLEAN | NEEDS_INDEX},
    {PLM_NEEDS_CLEAN, PLM_NEEDS_GROUND},
    {PLM_NEEDS_GROUND, PLM_NEEDS_ZENITH},
};

enum { RESTS_COUNT = sizeof rests / sizeof *rests };

void plm_measure_defaults(plm_measure_options *options)
{
    *options = (plm_measure_options){.stem_height = 0.02, .neighbours = 16, .effort = PLM_EFFORT_BALANCED};
}

size_t plm_point_budget(const plm_measure_options *options)
{
    static const size_t by_effort[] = {
        [PLM_EFFORT_FAST] = 50000, [PLM_EFFORT_BALANCED] = 200000, [PLM_EFFORT_PRECISE] = 400000};
    return options->points ? options->points : by_effort[options->effort];
}

/* ---- The list of traits ---------------------------------------------------------------------------------------- */

static const char *trait_name(const void *table, size_t i)
{
    return ((const plm_trait *)table)[i].name;
}

static plm_status choose_word(const char *word, bool *chosen, plm_error *error)
{
    size_t count;
    const plm_trait *trait = plm_traits(&count);
    bool found = false;
    for (size_t i = 0; i < count; i++) {
        const bool is_of_many = !strcmp(word, "all") || !strcmp(word, plm_level_name(trait[i].level));
        if (strcmp(word, trait[i].name) && !(is_of_many && !trait[i].on_request)) continue;
        chosen[i] = found = true;
    }
    if (found) return PLM_OK;
    const char *nearest = plm_nearest_name(word, trait_name, trait, count);
    if (nearest) return plm_fail(error, PLM_E_ARGUMENT, "unknown trait \"%s\"; did you mean \"%s\"?", word, nearest);
    return plm_fail(error, PLM_E_ARGUMENT, "unknown trait \"%s\"; `plantimeter traits` lists them", word);
}

plm_status plm_trait_choose(const char *list, bool *chosen, plm_error *error)
{
    size_t count, words = 0;
    const plm_trait *trait = plm_traits(&count);
    for (size_t i = 0; i < count; i++) chosen[i] = list == NULL && !trait[i].on_request;
    if (!list) return PLM_OK;
    for (const char *at = list; *at;) {
        at += strspn(at, ", ");
        const size_t length = strcspn(at, ", ");
        if (length == 0) break;
        char word[80];
        if (length >= sizeof word)
            return plm_fail(error, PLM_E_ARGUMENT, "unknown trait \"%.60s...\"; names are separated by commas", at);
        memcpy(word, at, length);
        word[length] = 0;
        const plm_status status = choose_word(word, chosen, error);
        if (status != PLM_OK) return status;
        at += length;
        words++;
    }
    if (words == 0) return plm_fail(error, PLM_E_ARGUMENT, "the list of traits is empty");
    return PLM_OK;
}

/* ---- The plan -------------------------------------------------------------------------------------------------- */

void plm_plan_leave_out(plm_plan *plan, plm_stage_id id, const char *format, ...)
{
    plm_stage *stage = &plan->stage[id];
    stage->runs = false;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(stage->why, sizeof stage->why, format, arguments);
    va_end(arguments);
}

unsigned plm_needs_closure(unsigned needs)
{
    for (int i = 0; i < RESTS_COUNT; i++)
        if (needs & rests[i].need) needs |= rests[i].on;
    return needs;
}

/* "for plant_height, leaf_area and 12 more" in why: the chosen traits that, alone, would make the stage run. */
static void name_users(plm_stage *stage, unsigned stage_needs, const bool *chosen)
{
    size_t count, users = 0, named = 0;
    const plm_trait *trait = plm_traits(&count);
    for (size_t i = 0; i < count; i++) users += chosen[i] && plm_needs_closure(trait[i].needs) & stage_needs;
    size_t length = (size_t)snprintf(stage->why, sizeof stage->why, "for ");
    for (size_t i = 0; i < count && named < 3; i++) {
        if (!chosen[i] || !(plm_needs_closure(trait[i].needs) & stage_needs)) continue;
        length +=
            (size_t)snprintf(stage->why + length, sizeof stage->why - length, "%s%s", named ? ", " : "", trait[i].name);
        if (length >= sizeof stage->why) return;
        named++;
    }
    if (users > named) snprintf(stage->why + length, sizeof stage->why - length, " and %zu more", users - named);
}

/* What the scene itself makes needless. */
static void leave_out_needless(plm_plan *plan, unsigned attributes, const plm_measure_options *options)
{
    const char *labelled = "left out: the cloud has labels; they are used as they are";
    if (attributes & PLM_HAS_LABEL) {
        plm_plan_leave_out(plan, PLM_STAGE_CLEAN, "%s", labelled);
        plm_plan_leave_out(plan, PLM_STAGE_SEGMENT, "%s", labelled);
    }
    if (options->ground == PLM_GROUND_NONE)
        plm_plan_leave_out(plan, PLM_STAGE_GROUND, "left out: the options say that there is no ground");
}

void plm_plan_widen(plm_plan *plan, unsigned needs, unsigned attributes, const plm_measure_options *options,
                    const char *why)
{
    const unsigned added = plm_needs_closure(needs) & ~plan->needs;
    plan->needs |= added;
    for (int id = 0; id < PLM_STAGE_COUNT; id++) {
        plm_stage *stage = &plan->stage[id];
        if (stage->runs || !(added & stages[id].needs)) continue;
        stage->runs = true;
        snprintf(stage->why, sizeof stage->why, "%s", why);
    }
    leave_out_needless(plan, attributes, options);
}

unsigned plm_stage_needs(plm_stage_id id)
{
    return stages[id].needs;
}

plm_status plm_plan_of(const plm_measure_options *options, const bool *list, unsigned attributes, plm_plan *plan,
                       plm_error *error)
{
    size_t count;
    const plm_trait *trait = plm_traits(&count);
    bool *chosen = plm_alloc(count, sizeof *chosen, error);
    if (!chosen) return PLM_E_MEMORY;
    plm_plan made = {.stage_count = PLM_STAGE_COUNT};
    for (size_t i = 0; i < count; i++) { /* what is blind will say so; nothing is run for it */
        const bool is_blind = trait[i].needs & PLM_NEEDS_COLOUR && !(attributes & PLM_HAS_RGB);
        chosen[i] = list[i] && !is_blind;
        if (chosen[i]) made.needs |= plm_needs_closure(trait[i].needs);
    }
    const unsigned for_base = made.needs & PLM_NEEDS_BASE ? plm_needs_closure(PLM_NEEDS_AXIS) : 0;
    for (int id = 0; id < PLM_STAGE_COUNT; id++) {
        plm_stage *stage = &made.stage[id];
        stage->name = stages[id].name;
        stage->runs = (made.needs & stages[id].needs) || stages[id].needs == NEEDS_ALWAYS;
        if (!stage->runs)
            plm_plan_leave_out(&made, (plm_stage_id)id, "left out: %s",
                               id == PLM_STAGE_LIGHT ? "absorbed_radiation was not asked for by its name"
                               : for_base & stages[id].needs
                                   ? "needed only where the plant is so low that it may hide its base"
                                   : "no trait asked for needs it");
        else if (stages[id].needs == NEEDS_ALWAYS)
            snprintf(stage->why, sizeof stage->why, "all traits asked for");
        else
            name_users(stage, stages[id].needs, chosen);
    }
    leave_out_needless(&made, attributes, options);
    *plan = made;
    plm_free(chosen);
    return PLM_OK;
}

plm_status plm_plan_make(const plm_measure_options *options, unsigned attributes, plm_plan *plan, plm_error *error)
{
    size_t count;
    plm_traits(&count);
    bool *chosen = plm_alloc(count, sizeof *chosen, error);
    if (!chosen) return PLM_E_MEMORY;
    plm_status status = plm_trait_choose(options->traits, chosen, error);
    if (status == PLM_OK) status = plm_plan_of(options, chosen, attributes, plan, error);
    plm_free(chosen);
    return status;
}
