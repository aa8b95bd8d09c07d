/* tool/tradeoff_print.c: the cheapest setting that is good enough, trait by trait. */
#include "reports/front.h"
#include "tool/tradeoff.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char default_target[] = "5%,2deg";

/** One word of --target: TRAIT=2%, 1deg, ... */
typedef struct target_word {
    char trait[TRADEOFF_NAME]; /* "": all */
    bool is_angle;
    double most;
} target_word;

/* Reads one word up to the comma; gives where the next one begins. */
static plm_status read_word(const char **text, target_word *word, plm_error *error)
{
    const char *begin = *text;
    const size_t length = strcspn(begin, ",");
    const char *equal = memchr(begin, '=', length);
    const char *number = equal ? equal + 1 : begin;
    char *end;
    *word = (target_word){0};
    if (equal) snprintf(word->trait, sizeof word->trait, "%.*s", (int)(equal - begin), begin);
    word->most = strtod(number, &end);
    word->is_angle = !strncmp(end, "deg", 3);
    const char *behind = end + (word->is_angle ? 3 : *end == '%' ? 1 : 0);
    *text = begin + length + (begin[length] == ',');
    const plm_trait *trait = word->trait[0] ? plm_trait_find(word->trait) : NULL;
    if (end == number || behind == end || behind != begin + length || !(word->most > 0) || !isfinite(word->most))
        return plm_fail(error, PLM_E_ARGUMENT,
                        "--target: \"%.*s\"; expected an error such as 2%%, 1deg, leaf_area=2%% or "
                        "leaf_inclination=1deg",
                        (int)(length < 60 ? length : 60), begin);
    if (word->trait[0] && !trait)
        return plm_fail(error, PLM_E_ARGUMENT, "--target: unknown trait \"%s\"; `plantimeter traits` lists them",
                        word->trait);
    if (trait && (trait->unit == PLM_DEGREE) != word->is_angle)
        return plm_fail(error, PLM_E_ARGUMENT, "--target: errors of %s are in %s", word->trait,
                        trait->unit == PLM_DEGREE ? "deg" : "%");
    return PLM_OK;
}

plm_status tradeoff_check_target(const char *text, plm_error *error)
{
    plm_status status = PLM_OK;
    target_word word;
    if (text && !*text) return plm_fail(error, PLM_E_ARGUMENT, "--target: the list is empty");
    while (text && *text && status == PLM_OK) status = read_word(&text, &word, error);
    return status;
}

/* The last word that is about the trait counts, a name before its unit. */
static double target_of(const char *text, const plm_trait *trait)
{
    double of_all = NAN, of_it = NAN;
    for (int pass = 0; pass < 2; pass++) {
        const char *at = pass ? text : default_target;
        target_word word;
        while (at && *at && read_word(&at, &word, NULL) == PLM_OK) {
            if (word.is_angle != (trait->unit == PLM_DEGREE)) continue;
            if (!word.trait[0]) of_all = word.most;
            if (!strcmp(word.trait, trait->name)) of_it = word.most;
        }
    }
    return isnan(of_it) ? of_all : of_it;
}

static void print_row(const tradeoff *study, const tradeoff_row *row, const char *unit)
{
    const tradeoff_setting *setting = &study->setting[row->setting];
    printf("%s %s: %.3g%s, %.3g s, %.0f MB\n", setting->method, setting->text, row->error, unit, row->seconds,
           (double)row->peak_bytes / 1e6);
}

/* The rows first..end are one trait's. */
static void print_trait(const tradeoff *study, size_t first, size_t end, tradeoff_labels labels)
{
    const plm_trait *trait = study->row[first].trait;
    const size_t n = end - first;
    const char *unit = trait->unit == PLM_DEGREE ? " deg" : " %";
    const double most = target_of(study->settings->target, trait);
    double *cost = plm_alloc(n, 2 * sizeof *cost, NULL);
    bool *takes_part = cost ? plm_alloc(n, sizeof *takes_part, NULL) : NULL;
    bool has_any = false;
    for (size_t i = 0; takes_part && i < n; i++) {
        const tradeoff_row *row = &study->row[first + i];
        cost[i] = row->seconds;
        cost[n + i] = row->error;
        takes_part[i] = row->takes_part && study->setting[row->setting].labels == labels;
        has_any = has_any || takes_part[i];
    }
    if (has_any) {
        const size_t found = plm_front_cheapest(cost, cost + n, takes_part, n, most);
        const size_t best =
            plm_front_cheapest(cost + n, cost, takes_part, n, INFINITY); /* cost and error change places */
        printf("%-24s %-6s %4g%-4s ", trait->name, tradeoff_labels_name(labels), most, unit);
        if (found == n) printf("not reached; best is ");
        print_row(study, &study->row[first + (found == n ? best : found)], unit);
    }
    plm_free(cost);
    plm_free(takes_part);
}

void tradeoff_print(const tradeoff *study)
{
    printf("%-24s %-6s %-8s cheapest setting that reaches it: mean error, seconds, peak memory\n", "trait", "labels",
           "target");
    for (size_t first = 0, end; first < study->row_count; first = end) {
        for (end = first; end < study->row_count && study->row[end].trait == study->row[first].trait;) end++;
        for (int labels = 0; labels < TRADEOFF_LABELS; labels++)
            print_trait(study, first, end, (tradeoff_labels)labels);
    }
}
