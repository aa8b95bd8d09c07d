/* tool/tradeoff_grid.c: which settings are tried, on which traits. Only knobs that change a result are here: the number of points
 * (which is all that an effort is), alpha for traits of leaf surfaces, neighbours for the smoothness factor, and whose labels. The
 * rows of the competitors come from their program. */
#include "tool/tradeoff.h"
#include "traits/plan.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const size_t default_points[] = {1000,   2000,   5000,   10000,   20000,   50000,
                                        100000, 200000, 400000, 1000000, 2000000, 5000000};
static const size_t quick_points[] = {2000, 10000, 50000};
static const double alphas[] = {0.5, 1, 2, 4};
static const int neighbours[] = {8, 32, 64};
enum { MOST_BUDGETS = 32, FEWEST_POINTS = 100 };

/** Budgets in rising order; 0, which is all points, comes first: runs of clouds that have no more are then known. */
typedef struct budget_list {
    size_t count, points[MOST_BUDGETS];
} budget_list;

const char *tradeoff_labels_name(tradeoff_labels labels)
{
    return labels == TRADEOFF_OWN ? "own" : "given";
}

/* ---- Traits --------------------------------------------------------------------------------------------------------- */

static bool has_truth(const tradeoff *study, size_t trait)
{
    for (size_t p = 0; p < study->plant_count; p++)
        for (size_t k = 0; k < study->plant[p].truth_count; k++)
            if ((size_t)study->plant[p].truth[k].trait == trait) return true;
    return false;
}

static plm_status choose_traits(tradeoff *study, plm_error *error)
{
    size_t count, wanted = 0;
    plm_traits(&count);
    study->is_wanted = plm_alloc(count, sizeof *study->is_wanted, error);
    if (!study->is_wanted) return PLM_E_MEMORY;
    const plm_status status = plm_trait_choose(study->settings->traits, study->is_wanted, error);
    if (status != PLM_OK) return status;
    for (size_t t = 0; t < count; t++) {
        study->is_wanted[t] = study->is_wanted[t] && has_truth(study, t);
        wanted += study->is_wanted[t];
    }
    return wanted ? PLM_OK : plm_fail(error, PLM_E_FORMAT, "the truth has none of the traits asked for");
}

static unsigned stages_of(const plm_plan *plan)
{
    unsigned stages = 0;
    for (size_t i = 0; i < plan->stage_count; i++)
        if (plan->stage[i].runs) stages |= 1u << i;
    return stages;
}

static void add_name(tradeoff_group *group, const char *name)
{
    const size_t used = strlen(group->list);
    snprintf(group->list + used, sizeof group->list - used, "%s%s", used ? "," : "", name);
}

/* Traits that make the same stages run are measured together: alone, each would cost as much. */
static plm_status make_groups(tradeoff *study, plm_error *error)
{
    size_t count;
    const plm_trait *table = plm_traits(&count);
    plm_measure_options options;
    plm_measure_defaults(&options);
    for (size_t t = 0; t < count; t++) {
        if (!study->is_wanted[t]) continue;
        plm_plan plan;
        options.traits = table[t].name;
        const plm_status status = plm_plan_make(&options, PLM_HAS_RGB, &plan, error);
        if (status != PLM_OK) return status;
        size_t g = 0;
        while (g < study->group_count && study->group[g].stages != stages_of(&plan)) g++;
        if (g == TRADEOFF_GROUPS) return plm_fail(error, PLM_E_ARGUMENT, "the traits need too many sets of stages");
        if (g == study->group_count) study->group[study->group_count++].stages = stages_of(&plan);
        study->group[g].needs |= plan.needs;
        add_name(&study->group[g], table[t].name);
    }
    for (size_t g = 0; g < study->group_count; g++) /* costs nothing, and says what alpha was found */
        if (study->group[g].needs & PLM_NEEDS_SURFACE) add_name(&study->group[g], "leaf_alpha");
    return PLM_OK;
}

size_t tradeoff_group_of(const tradeoff *study, const tradeoff_setting *setting, size_t trait)
{
    size_t count;
    const plm_trait *table = plm_traits(&count);
    if (setting->rival[0]) return 0;
    const size_t length = strlen(table[trait].name);
    for (size_t g = 0; g < study->group_count; g++)
        for (const char *at = study->group[g].list; *at; at += strcspn(at, ","), at += *at == ',')
            if (strcspn(at, ",") == length && !strncmp(at, table[trait].name, length)) return g;
    return study->group_count;
}

bool tradeoff_applies(const tradeoff_setting *setting, size_t trait)
{
    size_t count;
    const plm_trait *table = plm_traits(&count);
    if (setting->gives) return setting->gives[trait];
    return setting->needs == 0 || setting->needs & table[trait].needs;
}

/* ---- Settings ------------------------------------------------------------------------------------------------------- */

static plm_status parse_points(const char *text, budget_list *list, plm_error *error)
{
    while (*text) {
        char *end;
        const unsigned long long points = strtoull(text, &end, 10);
        if (end == text || *text == '-' || (*end && *end != ',') || points < FEWEST_POINTS || points > 1000000000ULL)
            return plm_fail(error, PLM_E_ARGUMENT, "--points: \"%.40s\"; expected numbers from %d on, e.g. 1000,10000",
                            text, FEWEST_POINTS);
        if (list->count == MOST_BUDGETS)
            return plm_fail(error, PLM_E_ARGUMENT, "--points: at most %d numbers", MOST_BUDGETS - 1);
        list->points[list->count++] = (size_t)points;
        text = *end ? end + 1 : end;
    }
    return PLM_OK;
}

plm_status tradeoff_check_lists(const tradeoff_settings *settings, plm_error *error)
{
    budget_list list = {.count = 1};
    size_t count;
    plm_traits(&count);
    bool *chosen = plm_alloc(count, sizeof *chosen, error);
    plm_status status = chosen ? plm_trait_choose(settings->traits, chosen, error) : PLM_E_MEMORY;
    if (status == PLM_OK && settings->points) status = parse_points(settings->points, &list, error);
    plm_free(chosen);
    return status;
}

static plm_status find_budgets(const tradeoff *study, budget_list *list, plm_error *error)
{
    size_t most = 0;
    budget_list asked = {.count = 1};
    const tradeoff_settings *settings = study->settings;
    const size_t *known = settings->is_quick ? quick_points : default_points;
    const size_t known_count = settings->is_quick ? COUNT(quick_points) : COUNT(default_points);
    for (size_t p = 0; p < study->plant_count; p++)
        if (study->plant[p].point_count > most) most = study->plant[p].point_count;
    if (settings->points) {
        const plm_status status = parse_points(settings->points, &asked, error);
        if (status != PLM_OK) return status;
    }
    for (size_t k = 0; !settings->points && k < known_count; k++) asked.points[asked.count++] = known[k];
    *list = (budget_list){.count = 1};
    for (size_t k = 1; k < asked.count; k++) /* the others are all points */
        if (asked.points[k] < most) list->points[list->count++] = asked.points[k];
    return PLM_OK;
}

tradeoff_setting *tradeoff_add_setting(tradeoff *study, const char *method, plm_error *error)
{
    void *grown = plm_realloc(study->setting, study->setting_count + 1, sizeof *study->setting, error);
    if (!grown) return NULL;
    study->setting = grown;
    tradeoff_setting *made = &study->setting[study->setting_count++];
    *made = (tradeoff_setting){0};
    snprintf(made->method, sizeof made->method, "%s", method);
    return made;
}

static void name_points(size_t points, char text[TRADEOFF_TEXT])
{
    if (points)
        snprintf(text, TRADEOFF_TEXT, "points=%zu", points);
    else
        snprintf(text, TRADEOFF_TEXT, "points=all");
}

static const char *const own_method[TRADEOFF_LABELS] = {"plantimeter", "plantimeter --labels"};

static plm_status add_budgets(tradeoff *study, const budget_list *list, tradeoff_labels labels, plm_error *error)
{
    for (size_t k = 0; k < list->count; k++) {
        tradeoff_setting *made = tradeoff_add_setting(study, own_method[labels], error);
        if (!made) return PLM_E_MEMORY;
        made->labels = labels;
        made->points = list->points[k];
        name_points(made->points, made->text);
    }
    return PLM_OK;
}

/* As the library has them, so that they cannot differ. */
static plm_status add_efforts(tradeoff *study, tradeoff_labels labels, plm_error *error)
{
    static const char *const name[] = {"fast", "balanced", "precise"};
    for (int effort = PLM_EFFORT_FAST; effort <= PLM_EFFORT_PRECISE; effort++) {
        tradeoff_setting *made = tradeoff_add_setting(study, own_method[labels], error);
        if (!made) return PLM_E_MEMORY;
        const plm_measure_options options = {.effort = (plm_effort)effort};
        made->labels = labels;
        made->points = plm_point_budget(&options);
        snprintf(made->text, sizeof made->text, "effort=%s", name[effort]);
    }
    return PLM_OK;
}

/* Alpha the same everywhere, and other numbers of neighbours, with all points and with some. */
static plm_status add_variants(tradeoff *study, const budget_list *list, tradeoff_labels labels, plm_error *error)
{
    const size_t some = list->count > 1 ? list->points[list->count / 2] : 0;
    for (size_t k = 0; k < (some ? 2 : 1); k++) {
        const size_t points = k ? some : 0;
        char text[TRADEOFF_TEXT];
        name_points(points, text);
        for (size_t a = 0; a < COUNT(alphas); a++) {
            tradeoff_setting *made = tradeoff_add_setting(study, own_method[labels], error);
            if (!made) return PLM_E_MEMORY;
            made->labels = labels;
            made->points = points;
            made->alpha = alphas[a];
            made->needs = PLM_NEEDS_SURFACE;
            snprintf(made->text, sizeof made->text, "%.24s alpha=fixed*%g", text, alphas[a]);
        }
        for (size_t n = 0; n < COUNT(neighbours) && !study->has_truth; n++) {
            tradeoff_setting *made = tradeoff_add_setting(study, own_method[labels], error);
            if (!made) return PLM_E_MEMORY;
            made->labels = labels;
            made->points = points;
            made->neighbours = neighbours[n];
            made->needs = PLM_NEEDS_NEIGHBOURS;
            snprintf(made->text, sizeof made->text, "%.24s neighbours=%d", text, neighbours[n]);
        }
    }
    return PLM_OK;
}

static bool is_asked_for(const tradeoff *study, const tradeoff_rival *rival)
{
    size_t count;
    plm_traits(&count);
    for (size_t t = 0; t < count; t++)
        if (rival->gives[t] && study->is_wanted[t]) return true;
    return false;
}

static plm_status add_rivals(tradeoff *study, const budget_list *list, plm_error *error)
{
    for (size_t r = 0; r < study->rival_count; r++) {
        const tradeoff_rival *rival = &study->rival[r];
        for (size_t k = 0; k < list->count && is_asked_for(study, rival); k++) {
            char text[TRADEOFF_TEXT];
            tradeoff_setting *made = tradeoff_add_setting(study, rival->method, error);
            if (!made) return PLM_E_MEMORY;
            made->labels = TRADEOFF_GIVEN;
            made->points = list->points[k];
            made->gives = rival->gives;
            name_points(made->points, text);
            snprintf(made->rival, sizeof made->rival, "%s", rival->setting);
            snprintf(made->text, sizeof made->text, "%.24s %.64s", text, rival->setting);
        }
    }
    return PLM_OK;
}

static bool has_given_labels(const tradeoff *study)
{
    for (size_t p = 0; p < study->plant_count; p++)
        if (study->plant[p].labelled[0]) return true;
    return false;
}

plm_status tradeoff_make_grid(tradeoff *study, plm_error *error)
{
    budget_list list;
    plm_status status = choose_traits(study, error);
    if (status == PLM_OK) status = make_groups(study, error);
    if (status == PLM_OK) status = find_budgets(study, &list, error);
    if (status == PLM_OK) status = add_budgets(study, &list, TRADEOFF_OWN, error);
    if (status == PLM_OK) status = add_efforts(study, TRADEOFF_OWN, error);
    if (status != PLM_OK || !has_given_labels(study)) return status;
    status = add_budgets(study, &list, TRADEOFF_GIVEN, error);
    if (status == PLM_OK) status = add_efforts(study, TRADEOFF_GIVEN, error);
    if (status == PLM_OK && !study->settings->is_quick) status = add_variants(study, &list, TRADEOFF_GIVEN, error);
    return status == PLM_OK ? add_rivals(study, &list, error) : status;
}
