/* reports/series.c: runs joined by plant and date; outliers; growth rates. */
#include "reports/series.h"

#include "cloud/order.h"
#include "reports/csv_table.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double outlier_limit = 3.5;

/* ---- Dates ------------------------------------------------------------------------------------------------------- */

/* Days since 1970-01-01 of the Gregorian calendar (E. G. Richards, Mapping Time, 1998). */
static double days_of(int year, int month, int day)
{
    const int a = (14 - month) / 12, y = year + 4800 - a, m = month + 12 * a - 3;
    return day + (153 * m + 2) / 5 + 365.0 * y + y / 4 - y / 100 + y / 400 - 32045 - 2440588;
}

bool plm_series_date(const char *text, double *days)
{
    static const int length[] = {31, 29, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    int year, month, day, hour = 0, minute = 0, used = 0;
    if (plm_table_number(text, days)) return true;
    if (sscanf(text, "%4d-%2d-%2d%n", &year, &month, &day, &used) != 3 || used != 10) return false;
    if (month < 1 || month > 12 || day < 1 || day > length[month - 1]) return false;
    if (month == 2 && day == 29 && (year % 4 || (year % 100 == 0 && year % 400))) return false;
    const char *rest = text + used;
    double second = 0;
    if (*rest) {
        used = 0;
        if ((*rest != 'T' && *rest != ' ') || sscanf(rest + 1, "%2d:%2d%n", &hour, &minute, &used) != 2) return false;
        rest += 1 + used;
        if (*rest == ':') {
            if (sscanf(rest + 1, "%lf%n", &second, &used) != 1) return false;
            rest += 1 + used;
        }
        if (*rest == 'Z') rest++;
    }
    if (*rest || hour < 0 || hour > 23 || minute < 0 || minute > 59 || !(second >= 0 && second < 61)) return false;
    *days = days_of(year, month, day) + (hour + (minute + second / 60) / 60) / 24;
    return true;
}

/* Whether a name in the dates' table means the folder: as it stands, or its last part. */
static bool is_run(const char *name, const char *folder)
{
    size_t end = strlen(folder);
    while (end > 1 && folder[end - 1] == '/') end--;
    size_t begin = end;
    while (begin > 0 && folder[begin - 1] != '/') begin--;
    const size_t length = strlen(name);
    return !strcmp(name, folder) || (length == end && !strncmp(name, folder, end)) ||
           (length == end - begin && !strncmp(name, folder + begin, length));
}

static plm_status find_date(const plm_table *table, const char *path, const char *folder, double *day,
                            const char **date, plm_error *error)
{
    const size_t run = plm_table_column(table, "run"), column = plm_table_column(table, "date");
    if (run == SIZE_MAX || column == SIZE_MAX)
        return plm_fail(error, PLM_E_FORMAT, "%s: line 1: no column \"%s\"; run,date were expected", path,
                        run == SIZE_MAX ? "run" : "date");
    for (size_t row = 0; row < table->rows; row++) {
        if (!is_run(plm_table_cell(table, row, run), folder)) continue;
        *date = plm_table_cell(table, row, column);
        if (plm_series_date(*date, day)) return PLM_OK;
        return plm_fail(error, PLM_E_FORMAT, "%s: line %zu: \"%s\" is no date such as 2026-05-02, nor a number of days",
                        path, table->line[row + 1], *date);
    }
    return plm_fail(error, PLM_E_ARGUMENT, "%s has no date of the run %s", path, folder);
}

/* ---- Joining ----------------------------------------------------------------------------------------------------- */

/* Sorts the runs in: the new one goes before those of later days. */
static plm_status add_run(plm_series *s, const char *folder, double day, const char *date, plm_error *error)
{
    size_t place = s->run_count;
    for (size_t i = 0; i < s->run_count; i++)
        if (s->day[i] == day)
            return plm_fail(error, PLM_E_ARGUMENT, "%s has the date of another run, %s", folder, date);
    char *copy = plm_strdup(date, error);
    if (!copy) return PLM_E_MEMORY;
    for (; place > 0 && s->day[place - 1] > day; place--) {
        s->run[place] = s->run[place - 1];
        s->day[place] = s->day[place - 1];
        s->date[place] = s->date[place - 1];
    }
    s->run[place] = (plm_results){0};
    s->day[place] = day;
    s->date[place] = copy;
    s->run_count++;
    return plm_results_read_folder(&s->run[place], folder, NULL, error);
}

static plm_status read_runs(plm_series *s, char *const *folder, size_t count, const char *dates, plm_error *error)
{
    plm_table table;
    plm_status status = plm_table_read(dates, &table, error);
    if (status != PLM_OK) return status;
    s->run = plm_alloc_zero(count, sizeof *s->run, error);
    s->day = plm_alloc(count, sizeof *s->day, error);
    s->date = plm_alloc_zero(count, sizeof *s->date, error);
    if (!s->run || !s->day || !s->date) status = PLM_E_MEMORY;
    for (size_t i = 0; i < count && status == PLM_OK; i++) {
        double day = 0;
        const char *date = "";
        status = find_date(&table, dates, folder[i], &day, &date, error);
        if (status == PLM_OK) status = add_run(s, folder[i], day, date, error);
    }
    for (size_t i = s->run_count; i-- > 0;) s->day[i] -= s->day[0];
    plm_table_free(&table);
    return status;
}

/* Points of one plant's trait; the plant is one of run `from`, and of no earlier one. */
static void join_line(plm_series *s, const plm_trait *trait, const char *plant_id, size_t from)
{
    plm_series_line *line = &s->line[s->line_count];
    *line = (plm_series_line){.plant_id = plant_id, .trait = trait, .first = s->point_count};
    for (size_t k = from; k < s->run_count; k++) {
        const plm_result *plant = plm_results_find(&s->run[k], plant_id);
        const plm_result_row *row = plant ? plm_result_of_plant(plant, trait) : NULL;
        if (row)
            s->point[s->point_count++] = (plm_series_point){s->day[k], s->date[k], row->value, row->std_error, false};
    }
    line->count = s->point_count - line->first;
    if (line->count) s->line_count++;
}

static bool was_before(const plm_series *s, size_t run, const char *plant_id)
{
    for (size_t k = 0; k < run; k++)
        if (plm_results_find(&s->run[k], plant_id)) return true;
    return false;
}

static plm_status join(plm_series *s, plm_error *error)
{
    size_t traits, plants = 0;
    const plm_trait *trait = plm_traits(&traits);
    for (size_t k = 0; k < s->run_count; k++) plants += s->run[k].count;
    s->point = plm_alloc(plants * traits, sizeof *s->point, error);
    s->line = plm_alloc(plants * traits, sizeof *s->line, error);
    if (!s->point || !s->line) return PLM_E_MEMORY;
    for (size_t t = 0; t < traits; t++) {
        if (!plm_trait_of_plant(&trait[t])) continue;
        for (size_t k = 0; k < s->run_count; k++)
            for (size_t i = 0; i < s->run[k].count; i++)
                if (!was_before(s, k, s->run[k].plant[i].plant_id))
                    join_line(s, &trait[t], s->run[k].plant[i].plant_id, k);
    }
    return PLM_OK;
}

plm_status plm_series_open(plm_series *made, char *const *folder, size_t count, const char *dates, plm_error *error)
{
    plm_series s = {0};
    plm_status status = read_runs(&s, folder, count, dates, error);
    if (status == PLM_OK) status = join(&s, error);
    if (status == PLM_OK) status = plm_series_mark_outliers(&s, error);
    if (status == PLM_OK)
        *made = s;
    else
        plm_series_close(&s);
    return status;
}

void plm_series_close(plm_series *series)
{
    for (size_t i = 0; i < series->run_count; i++) {
        plm_results_free(&series->run[i]);
        plm_free(series->date[i]);
    }
    plm_free(series->run);
    plm_free(series->day);
    plm_free(series->date);
    plm_free(series->point);
    plm_free(series->line);
    *series = (plm_series){0};
}

/* ---- Outliers ---------------------------------------------------------------------------------------------------- */

/* The neighbour of point i in a direction that is no outlier, or SIZE_MAX. */
static size_t neighbour(const plm_series_point *point, size_t count, size_t i, int step)
{
    for (ptrdiff_t k = (ptrdiff_t)i + step; k >= 0 && k < (ptrdiff_t)count; k += step)
        if (!point[k].is_outlier) return (size_t)k;
    return SIZE_MAX;
}

/* Difference of point i to the line through its neighbours (at an end: through the next two), relative to the value there, and
 * its standard error. False where there are not two. */
static bool jump_at(const plm_series_point *point, size_t count, size_t i, double *jump, double *jump_error)
{
    size_t a = neighbour(point, count, i, -1), b = neighbour(point, count, i, 1);
    if (a == SIZE_MAX && b != SIZE_MAX) a = neighbour(point, count, b, 1);
    if (b == SIZE_MAX && a != SIZE_MAX) b = neighbour(point, count, a, -1);
    if (a == SIZE_MAX || b == SIZE_MAX || a == b) return false;
    const double share = (point[i].day - point[a].day) / (point[b].day - point[a].day);
    const double expected = point[a].value + share * (point[b].value - point[a].value);
    const double size = fmax(fabs(expected), fabs(point[i].value));
    if (!(size > 0)) return false;
    const double errors[] = {point[i].std_error, (1 - share) * point[a].std_error, share * point[b].std_error};
    double variance = 0;
    for (int k = 0; k < 3; k++)
        if (isfinite(errors[k])) variance += errors[k] * errors[k];
    *jump = (point[i].value - expected) / size;
    *jump_error = sqrt(variance) / size;
    return true;
}

/* Lines [first, last) are of one trait: the robust SD of their relative jumps. */
static double usual_jump(const plm_series *s, size_t first, size_t last, double *room)
{
    size_t count = 0;
    double error;
    for (size_t k = first; k < last; k++) {
        const plm_series_line *line = &s->line[k];
        if (line->count < 4) continue;
        for (size_t i = 0; i < line->count; i++)
            count += jump_at(s->point + line->first, line->count, i, &room[count], &error);
    }
    return count ? plm_order_robust_sd(room, count, 0) : 0;
}

static void mark_line(plm_series_point *point, size_t count, double usual)
{
    for (size_t left = count; left >= 4; left--) {
        size_t worst = SIZE_MAX;
        double largest = outlier_limit;
        for (size_t i = 0; i < count; i++) {
            double jump, error;
            if (point[i].is_outlier || !jump_at(point, count, i, &jump, &error)) continue;
            const double scale = fmax(usual, error);
            if (scale > 0 && fabs(jump) / scale > largest) largest = fabs(jump) / scale, worst = i;
        }
        if (worst == SIZE_MAX) return;
        point[worst].is_outlier = true;
    }
}

plm_status plm_series_mark_outliers(plm_series *series, plm_error *error)
{
    double *room = plm_alloc(series->point_count + 1, sizeof *room, error);
    if (!room) return PLM_E_MEMORY;
    for (size_t first = 0, last; first < series->line_count; first = last) {
        for (last = first; last < series->line_count && series->line[last].trait == series->line[first].trait;) last++;
        const double usual = usual_jump(series, first, last, room);
        for (size_t k = first; k < last; k++)
            mark_line(series->point + series->line[k].first, series->line[k].count, usual);
    }
    plm_free(room);
    return PLM_OK;
}

/* ---- Rates --------------------------------------------------------------------------------------------------------- */

void plm_series_rates(const plm_series_point *a, const plm_series_point *b, plm_rate *absolute, plm_rate *relative)
{
    const double days = b->day - a->day;
    *absolute = (plm_rate){(b->value - a->value) / days, hypot(a->std_error, b->std_error) / days};
    *relative = (plm_rate){NAN, NAN};
    if (a->value > 0 && b->value > 0)
        *relative =
            (plm_rate){log(b->value / a->value) / days, hypot(a->std_error / a->value, b->std_error / b->value) / days};
}

/* Slope of y on days by weighted least squares. sigma: errors of y, used where all are finite and positive. */
static plm_rate slope(const double *day, const double *y, const double *sigma, size_t count)
{
    if (count < 2) return (plm_rate){NAN, NAN};
    bool weighted = true;
    for (size_t i = 0; i < count; i++) weighted = weighted && sigma[i] > 0 && isfinite(sigma[i]) && isfinite(y[i]);
    double w = 0, wx = 0, wy = 0, sxx = 0, sxy = 0, rest = 0;
    for (size_t i = 0; i < count; i++) {
        const double weight = weighted ? 1 / (sigma[i] * sigma[i]) : 1;
        w += weight, wx += weight * day[i], wy += weight * y[i];
    }
    for (size_t i = 0; i < count; i++) {
        const double weight = weighted ? 1 / (sigma[i] * sigma[i]) : 1, x = day[i] - wx / w;
        sxx += weight * x * x, sxy += weight * x * (y[i] - wy / w);
    }
    if (!(sxx > 0)) return (plm_rate){NAN, NAN};
    const double b = sxy / sxx;
    for (size_t i = 0; i < count; i++) {
        const double weight = weighted ? 1 / (sigma[i] * sigma[i]) : 1;
        const double residual = y[i] - wy / w - b * (day[i] - wx / w);
        rest += weight * residual * residual;
    }
    const double scatter = count > 2 ? rest / (double)(count - 2) : weighted ? 0 : NAN;
    return (plm_rate){b, sqrt((weighted ? fmax(1, scatter) : scatter) / sxx)};
}

void plm_series_fit(const plm_series *series, const plm_series_line *line, plm_rate *absolute, plm_rate *relative)
{
    enum { MOST = 512 }; /* days of a series */
    double day[MOST], y[MOST], sigma[MOST], logarithm[MOST], log_sigma[MOST];
    size_t count = 0;
    bool is_positive = true;
    for (size_t i = 0; i < line->count && count < MOST; i++) {
        const plm_series_point *point = &series->point[line->first + i];
        if (point->is_outlier) continue;
        day[count] = point->day;
        y[count] = point->value;
        sigma[count] = point->std_error;
        is_positive = is_positive && point->value > 0;
        logarithm[count] = point->value > 0 ? log(point->value) : NAN;
        log_sigma[count] = point->std_error / point->value;
        count++;
    }
    *absolute = slope(day, y, sigma, count);
    *relative = is_positive ? slope(day, logarithm, log_sigma, count) : (plm_rate){NAN, NAN};
}
