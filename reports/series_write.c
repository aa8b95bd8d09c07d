/* reports/series_write.c: tables and plots of a series. */
#include "reports/plots.h"
#include "reports/series.h"
#include "reports/sheet.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- Tables -------------------------------------------------------------------------------------------------------- */

static plm_status write_long(const plm_series *series, const char *folder, plm_error *error)
{
    plm_sheet s = plm_sheet_open(folder, "series.csv", error);
    plm_sheet_line(&s, "plant_id,trait,date,day,value,unit,std_error,outlier");
    for (size_t k = 0; k < series->line_count; k++) {
        const plm_series_line *line = &series->line[k];
        for (size_t i = line->first; i < line->first + line->count; i++) {
            const plm_series_point *point = &series->point[i];
            plm_sheet_text(&s, line->plant_id, ',');
            plm_sheet_text(&s, line->trait->name, ',');
            plm_sheet_text(&s, point->date, ',');
            plm_sheet_number(&s, point->day, ',');
            plm_sheet_number(&s, point->value, ',');
            plm_sheet_text(&s, plm_unit_name(line->trait->unit), ',');
            plm_sheet_number(&s, point->std_error, ',');
            plm_sheet_text(&s, point->is_outlier ? "yes" : "no", '\n');
        }
    }
    return plm_sheet_close(&s);
}

static plm_status write_wide(const plm_series *series, const char *folder, plm_error *error)
{
    plm_sheet s = plm_sheet_open(folder, "wide.csv", error);
    plm_sheet_text(&s, "plant_id", ',');
    plm_sheet_text(&s, "trait", ',');
    plm_sheet_text(&s, "unit", ',');
    for (size_t d = 0; d < series->run_count; d++)
        plm_sheet_text(&s, series->date[d], d + 1 < series->run_count ? ',' : '\n');
    for (size_t k = 0; k < series->line_count; k++) {
        const plm_series_line *line = &series->line[k];
        plm_sheet_text(&s, line->plant_id, ',');
        plm_sheet_text(&s, line->trait->name, ',');
        plm_sheet_text(&s, plm_unit_name(line->trait->unit), ',');
        size_t at = line->first;
        for (size_t d = 0; d < series->run_count; d++) {
            const bool is_there = at < line->first + line->count && series->point[at].day == series->day[d];
            plm_sheet_number(&s, is_there ? series->point[at].value : NAN, d + 1 < series->run_count ? ',' : '\n');
            at += is_there;
        }
    }
    return plm_sheet_close(&s);
}

static void growth_row(plm_sheet *s, const plm_series_line *line, const char *from, const char *to, double days,
                       const plm_rate *absolute, const plm_rate *relative)
{
    plm_sheet_text(s, line->plant_id, ',');
    plm_sheet_text(s, line->trait->name, ',');
    plm_sheet_text(s, from, ',');
    plm_sheet_text(s, to, ',');
    plm_sheet_number(s, days, ',');
    plm_sheet_number(s, absolute->value, ',');
    plm_sheet_number(s, absolute->std_error, ',');
    char unit[32];
    snprintf(unit, sizeof unit, "%s/day", plm_unit_name(line->trait->unit));
    plm_sheet_text(s, unit, ',');
    plm_sheet_number(s, relative->value, ',');
    plm_sheet_number(s, relative->std_error, '\n');
}

static plm_status write_growth(const plm_series *series, const char *folder, plm_error *error)
{
    plm_sheet s = plm_sheet_open(folder, "growth.csv", error);
    plm_sheet_line(&s, "plant_id,trait,from,to,days,absolute_rate,absolute_rate_std_error,unit,relative_rate_per_day,"
                       "relative_rate_std_error");
    for (size_t k = 0; k < series->line_count; k++) {
        const plm_series_line *line = &series->line[k];
        const plm_series_point *first = NULL, *last = NULL;
        plm_rate absolute, relative;
        for (size_t i = line->first; i < line->first + line->count; i++) {
            const plm_series_point *point = &series->point[i];
            if (point->is_outlier) continue;
            if (last) {
                plm_series_rates(last, point, &absolute, &relative);
                growth_row(&s, line, last->date, point->date, point->day - last->day, &absolute, &relative);
            }
            if (!first) first = point;
            last = point;
        }
        if (first == last) continue;
        plm_series_fit(series, line, &absolute, &relative);
        growth_row(&s, line, "all", "all", last->day - first->day, &absolute, &relative);
    }
    return plm_sheet_close(&s);
}

plm_status plm_series_write(const plm_series *series, const char *folder, plm_error *error)
{
    plm_status status = write_long(series, folder, error);
    if (status == PLM_OK) status = write_wide(series, folder, error);
    if (status == PLM_OK) status = write_growth(series, folder, error);
    return status;
}

/* ---- Plots ----------------------------------------------------------------------------------------------------------- */

/* A block a plant, blocks apart by two empty lines: day, value, half of the 95 % interval, outlier, what the pointer shows. */
static plm_status write_data(const plm_series *series, size_t first, size_t last, const char *folder, plm_error *error)
{
    char name[128];
    snprintf(name, sizeof name, "%s.dat", series->line[first].trait->name);
    plm_sheet s = plm_sheet_open(folder, name, error);
    plm_sheet_line(&s, "# day value half_interval outlier label");
    for (size_t k = first; k < last; k++) {
        const plm_series_line *line = &series->line[k];
        for (size_t i = line->first; i < line->first + line->count; i++) {
            const plm_series_point *point = &series->point[i];
            plm_sheet_number(&s, point->day, ' ');
            plm_sheet_number(&s, point->value, ' ');
            plm_sheet_number(&s, isfinite(point->std_error) ? 1.96 * point->std_error : 0, ' ');
            plm_sheet_number(&s, point->is_outlier, ' ');
            char label[256];
            snprintf(label, sizeof label, "%.120s, %.60s", line->plant_id, point->date);
            plm_sheet_quoted(&s, label, '\n');
        }
        plm_sheet_line(&s, "\n");
    }
    return plm_sheet_close(&s);
}

static plm_status write_script(const plm_trait *trait, size_t lines, const char *folder, plm_error *error)
{
    static const char *const terminals[] = {
        "svg size 900,560 enhanced font 'sans,13' mouse standalone background '#ffffff'",
        "pngcairo size 2700,1680 enhanced font 'sans,13' fontscale 3 linewidth 3 pointscale 3"};
    static const char *const endings[] = {"svg", "png"};
    char name[128];
    snprintf(name, sizeof name, "%s.gp", trait->name);
    plm_sheet s = plm_sheet_open(folder, name, error);
    if (s.status == PLM_OK)
        s.status = plm_output_print(
            s.output, error,
            "# gnuplot script; run it in this folder\nset datafile separator whitespace\nunset key\n"
            "set border lc rgb '#444444'\nset grid lc rgb '#dddddd'\nset xlabel 'days'\nset ylabel '%s'\n"
            "set title '%s' noenhanced\narray hue[8] = ['#0072b2','#d55e00','#009e73','#cc79a7','#56b4e9','#e69f00',"
            "'#332288','#999933']\ncolour(k) = hue[int(k)%%8+1]\n",
            trait->unit == PLM_NUMBER ? "" : plm_unit_name(trait->unit), trait->name);
    for (int k = 0; k < 2 && s.status == PLM_OK; k++)
        s.status =
            plm_output_print(s.output, error,
                             "set terminal %s\nset output '%s.%s'\n"
                             "plot for [k=0:%zu] '%s.dat' index k u 1:($4==0?$2:1/0) w l lw 1.5 lc rgb colour(k), "
                             "for [k=0:%zu] '' index k u 1:2:3 w yerrorbars pt 7 ps 0.6 lc rgb colour(k), "
                             "'' u 1:($4==1?$2:1/0) w p pt 6 ps 1.6 lw 2 lc rgb '#000000', "
                             "'' u 1:2:5 w labels hypertext point pt 7 ps 0.1 lc rgb '#444444'\nunset output\n",
                             terminals[k], trait->name, endings[k], lines - 1, trait->name, lines - 1);
    return plm_sheet_close(&s);
}

plm_status plm_series_plots(const plm_series *series, const char *folder, bool *drawn, plm_error *error)
{
    plm_status status = plm_folder_make(folder, error);
    *drawn = true;
    for (size_t first = 0, last; first < series->line_count && status == PLM_OK; first = last) {
        const plm_trait *trait = series->line[first].trait;
        for (last = first; last < series->line_count && series->line[last].trait == trait;) last++;
        status = write_data(series, first, last, folder, error);
        if (status == PLM_OK) status = write_script(trait, last - first, folder, error);
        char script[128];
        snprintf(script, sizeof script, "%s.gp", trait->name);
        if (status == PLM_OK && *drawn) status = plm_gnuplot_run(folder, script, drawn, error);
    }
    return status;
}
