/* reports/pairing.c: pairing estimates with manual readings, and units. */
#include "reports/pairing.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const struct {
    const char *name;
    int kind;
    double factor; /* to the kind's base */
} units[] = {
    {"m", 1, 1},
    {"cm", 1, 1e-2},
    {"mm", 1, 1e-3},
    {"um", 1, 1e-6},
    {"in", 1, 0.0254},
    {"m2", 2, 1},
    {"cm2", 2, 1e-4},
    {"mm2", 2, 1e-6},
    {"dm2", 2, 1e-2},
    {"m3", 3, 1},
    {"cm3", 3, 1e-6},
    {"ml", 3, 1e-6},
    {"mm3", 3, 1e-9},
    {"l", 3, 1e-3},
    {"dm3", 3, 1e-3},
    {"deg", 4, 1},
    {"rad", 4, 57.29577951308232},
    {"1", 5, 1},
    {"%", 5, 1e-2},
    {"", 5, 1},
    {"count", 5, 1},
    {"W", 6, 1},
    {"mW", 6, 1e-3},
};

double plm_unit_conversion(const char *from, const char *to)
{
    size_t a = SIZE_MAX, b = SIZE_MAX;
    for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
        if (!strcmp(units[i].name, from)) a = i;
        if (!strcmp(units[i].name, to)) b = i;
    }
    if (a == SIZE_MAX || b == SIZE_MAX || units[a].kind != units[b].kind) return 0;
    return units[a].factor / units[b].factor;
}

plm_status plm_assign(const double *cost, size_t rows, size_t columns, size_t *column, plm_error *error)
{
    /* Potentials u, v; owner[j] is the row (1-based) that column j has; column 0 is a stand-in. */
    double *u = plm_alloc_zero(rows + 1, sizeof *u, error), *v = plm_alloc_zero(columns + 1, sizeof *v, error);
    double *least = plm_alloc(columns + 1, sizeof *least, error);
    size_t *owner = plm_alloc_zero(columns + 1, sizeof *owner, error),
           *way = plm_alloc(columns + 1, sizeof *way, error);
    bool *seen = plm_alloc(columns + 1, sizeof *seen, error);
    plm_status status = u && v && least && owner && way && seen ? PLM_OK : PLM_E_MEMORY;
    for (size_t row = 1; status == PLM_OK && row <= rows; row++) {
        size_t at = 0;
        owner[0] = row;
        for (size_t j = 0; j <= columns; j++) least[j] = INFINITY, seen[j] = false;
        do {
            seen[at] = true;
            const size_t i = owner[at];
            size_t next = 0;
            double delta = INFINITY;
            for (size_t j = 1; j <= columns; j++) {
                if (seen[j]) continue;
                const double reduced = cost[(i - 1) * columns + j - 1] - u[i] - v[j];
                if (reduced < least[j]) least[j] = reduced, way[j] = at;
                if (least[j] < delta) delta = least[j], next = j;
            }
            for (size_t j = 0; j <= columns; j++) {
                if (seen[j])
                    u[owner[j]] += delta, v[j] -= delta;
                else
                    least[j] -= delta;
            }
            at = next;
        } while (owner[at]);
        while (at) {
            const size_t before = way[at];
            owner[at] = owner[before];
            at = before;
        }
    }
    if (status == PLM_OK)
        for (size_t j = 1; j <= columns; j++)
            if (owner[j]) column[owner[j] - 1] = j - 1;
    plm_free(u);
    plm_free(v);
    plm_free(least);
    plm_free(owner);
    plm_free(way);
    plm_free(seen);
    return status;
}

/* ---- Groups of readings of the same plant, organ and trait ------------------------------------------------------- */

typedef struct side {
    const plm_reading *reading;
    size_t row;
} side;

static int compare_key(const plm_reading *a, const plm_reading *b)
{
    int order = strcmp(a->plant_id, b->plant_id);
    if (!order) order = strcmp(a->organ, b->organ);
    if (!order) order = strcmp(a->trait, b->trait);
    return order;
}

static int by_key(const void *a, const void *b)
{
    const side *x = a, *y = b;
    int order = compare_key(x->reading, y->reading);
    if (!order) order = strcmp(x->reading->organ_id, y->reading->organ_id);
    return order ? order : (x->row > y->row) - (x->row < y->row);
}

static int by_value(const void *a, const void *b)
{
    const side *x = a, *y = b;
    if (x->reading->value != y->reading->value) return x->reading->value > y->reading->value ? 1 : -1;
    return (x->row > y->row) - (x->row < y->row);
}

typedef struct matcher {
    plm_match_pair *pair;
    size_t count;
    bool *used_estimate, *used_manual;
} matcher;

static void pair_up(matcher *m, const side *e, const side *r)
{
    m->pair[m->count++] = (plm_match_pair){e->row, r->row};
    m->used_estimate[e->row] = m->used_manual[r->row] = true;
}

static void match_by_id(matcher *m, const side *e, size_t ne, const side *r, size_t nr)
{
    size_t i = 0, j = 0;
    while (i < ne && j < nr) {
        const int order = strcmp(e[i].reading->organ_id, r[j].reading->organ_id);
        if (!order && !m->used_estimate[e[i].row] && !m->used_manual[r[j].row]) pair_up(m, &e[i], &r[j]);
        if (order <= 0) i++;
        if (order >= 0) j++;
    }
}

static plm_status match_by_position(matcher *m, const side *e, size_t ne, const side *r, size_t nr, plm_error *error)
{
    for (size_t i = 0; i < ne; i++)
        if (!e[i].reading->has_position) return PLM_OK;
    for (size_t j = 0; j < nr; j++)
        if (!r[j].reading->has_position) return PLM_OK;
    const bool turned = nr > ne;
    const side *few = turned ? e : r, *many = turned ? r : e;
    const size_t rows = turned ? ne : nr, columns = turned ? nr : ne;
    double *cost = plm_alloc(rows * columns, sizeof *cost, error);
    size_t *column = plm_alloc(rows, sizeof *column, error);
    plm_status status = cost && column ? PLM_OK : PLM_E_MEMORY;
    for (size_t i = 0; status == PLM_OK && i < rows; i++)
        for (size_t j = 0; j < columns; j++) {
            const double *a = few[i].reading->position, *b = many[j].reading->position;
            cost[i * columns + j] =
                sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
        }
    if (status == PLM_OK) status = plm_assign(cost, rows, columns, column, error);
    for (size_t i = 0; status == PLM_OK && i < rows; i++)
        pair_up(m, turned ? &few[i] : &many[column[i]], turned ? &many[column[i]] : &few[i]);
    plm_free(cost);
    plm_free(column);
    return status;
}

/* Order statistics; where one side has more, the ones left out are those that let the rest fit best (order kept), by
 * dynamic programming over the longer side. */
static plm_status match_by_rank(matcher *m, side *e, size_t ne, side *r, size_t nr, plm_error *error)
{
    qsort(e, ne, sizeof *e, by_value);
    qsort(r, nr, sizeof *r, by_value);
    const bool turned = nr > ne;
    const side *few = turned ? e : r, *many = turned ? r : e;
    const size_t rows = turned ? ne : nr, columns = turned ? nr : ne;
    double *best = plm_alloc((rows + 1) * (columns + 1), sizeof *best, error);
    if (!best) return PLM_E_MEMORY;
#define BEST(i, j) best[(i) * (columns + 1) + (j)]
    for (size_t j = 0; j <= columns; j++) BEST(0, j) = 0;
    for (size_t i = 1; i <= rows; i++) {
        BEST(i, i - 1) = INFINITY;
        for (size_t j = i; j <= columns; j++) {
            const double with = BEST(i - 1, j - 1) + fabs(few[i - 1].reading->value - many[j - 1].reading->value);
            BEST(i, j) = fmin(with, BEST(i, j - 1));
        }
    }
    for (size_t i = rows, j = columns; i > 0; j--)
        if (BEST(i, j) < BEST(i, j - 1)) {
            pair_up(m, turned ? &few[i - 1] : &many[j - 1], turned ? &many[j - 1] : &few[i - 1]);
            i--;
        }
#undef BEST
    plm_free(best);
    return PLM_OK;
}

static plm_status match_group(matcher *m, side *e, size_t ne, side *r, size_t nr, plm_match match, plm_error *error)
{
    bool numbered = true;
    for (size_t j = 0; j < nr; j++) numbered = numbered && r[j].reading->organ_id[0];
    if (match == PLM_MATCH_RANK) return match_by_rank(m, e, ne, r, nr, error);
    if (match == PLM_MATCH_ID || (match == PLM_MATCH_AUTO && numbered)) {
        match_by_id(m, e, ne, r, nr);
        return PLM_OK;
    }
    if (ne == 1 && nr == 1) { /* the plant itself, or its only organ of a kind */
        pair_up(m, e, r);
        return PLM_OK;
    }
    return match_by_position(m, e, ne, r, nr, error);
}

static side *sorted_sides(const plm_reading *reading, size_t count, plm_error *error)
{
    side *list = plm_alloc(count, sizeof *list, error);
    for (size_t i = 0; list && i < count; i++) list[i] = (side){&reading[i], i};
    if (list) qsort(list, count, sizeof *list, by_key);
    return list;
}

static size_t group_end(const side *list, size_t begin, size_t count)
{
    size_t end = begin;
    while (end < count && !compare_key(list[begin].reading, list[end].reading)) end++;
    return end;
}

plm_status plm_match_readings(const plm_reading *estimate, size_t estimate_count, const plm_reading *manual,
                              size_t manual_count, plm_match match, plm_match_pair *pair, size_t *pair_count,
                              bool *used_estimate, bool *used_manual, plm_error *error)
{
    side *e = sorted_sides(estimate, estimate_count, error);
    side *r = e ? sorted_sides(manual, manual_count, error) : NULL;
    plm_status status = r ? PLM_OK : PLM_E_MEMORY;
    matcher m = {pair, 0, used_estimate, used_manual};
    memset(used_estimate, 0, estimate_count * sizeof *used_estimate);
    memset(used_manual, 0, manual_count * sizeof *used_manual);
    for (size_t i = 0, j = 0; status == PLM_OK && i < estimate_count && j < manual_count;) {
        const int order = compare_key(e[i].reading, r[j].reading);
        const size_t next_i = group_end(e, i, estimate_count), next_j = group_end(r, j, manual_count);
        if (!order) status = match_group(&m, e + i, next_i - i, r + j, next_j - j, match, error);
        if (order <= 0) i = next_i;
        if (order >= 0) j = next_j;
    }
    if (status == PLM_OK) *pair_count = m.count;
    plm_free(e);
    plm_free(r);
    return status;
}
