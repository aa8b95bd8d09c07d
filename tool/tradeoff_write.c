/* tool/tradeoff_write.c: the table, and a plot of error against run time for each trait, with the front. */
#include "reports/plots.h"
#include "reports/sheet.h"
#include "tool/tradeoff.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char header[] = "trait,method,settings,points,error,error_ci,seconds,peak_bytes,error_unit,error_low,"
                             "error_high,median_error,labels,"
                             "plants,values,missing,failed,on_front";

static plm_status write_row(plm_sheet *sheet, const tradeoff *study, const tradeoff_row *row)
{
    const tradeoff_setting *setting = &study->setting[row->setting];
    plm_sheet_text(sheet, row->trait->name, ',');
    plm_sheet_text(sheet, setting->method, ',');
    plm_sheet_text(sheet, setting->text, ',');
    plm_sheet_number(sheet, row->points, ',');
    plm_sheet_number(sheet, row->error, ',');
    plm_sheet_number(sheet, row->half_interval, ',');
    plm_sheet_number(sheet, row->seconds, ',');
    plm_sheet_number(sheet, (double)row->peak_bytes, ',');
    plm_sheet_text(sheet, row->trait->unit == PLM_DEGREE ? "deg" : "%", ',');
    plm_sheet_number(sheet, row->low, ',');
    plm_sheet_number(sheet, row->high, ',');
    plm_sheet_number(sheet, row->median_error, ',');
    plm_sheet_text(sheet, tradeoff_labels_name(setting->labels), ',');
    plm_sheet_number(sheet, (double)row->plants, ',');
    plm_sheet_number(sheet, (double)row->count, ',');
    plm_sheet_number(sheet, (double)row->missing, ',');
    plm_sheet_number(sheet, (double)row->failed, ',');
    plm_sheet_text(sheet, row->is_on_front ? "yes" : "no", '\n');
    return sheet->status;
}

static plm_status write_table(const tradeoff *study, plm_error *error)
{
    plm_sheet sheet = plm_sheet_open(study->settings->output, "tradeoff.csv", error);
    plm_sheet_line(&sheet, header);
    for (size_t i = 0; i < study->row_count && sheet.status == PLM_OK; i++) write_row(&sheet, study, &study->row[i]);
    return plm_sheet_close(&sheet);
}

/* What failed, and why: a row a run. */
static plm_status write_failures(const tradeoff *study, plm_error *error)
{
    plm_sheet sheet = plm_sheet_open(study->settings->output, "failures.csv", error);
    plm_sheet_line(&sheet, "plant,method,settings,reason");
    for (size_t i = 0; i < study->run_count; i++) {
        const tradeoff_run *run = &study->run[i];
        if (run->is_good) continue;
        plm_sheet_text(&sheet, study->plant[run->plant].name, ',');
        plm_sheet_text(&sheet, study->setting[run->setting].method, ',');
        plm_sheet_text(&sheet, study->setting[run->setting].text, ',');
        plm_sheet_text(&sheet, run->why, '\n');
    }
    return plm_sheet_close(&sheet);
}

/* ---- Plots ---------------------------------------------------------------------------------------------------------- */

/* Columns of tradeoff.csv, from 1 on. */
enum { COLUMN_ERROR = 5, COLUMN_SECONDS = 7, COLUMN_LOW = 10, COLUMN_HIGH = 11 };
enum { MOST_METHODS = 24 };

/* Methods of a trait's rows. */
static size_t find_methods(const tradeoff *study, const plm_trait *trait, const char **method)
{
    size_t count = 0;
    for (size_t i = 0; i < study->row_count; i++) {
        const tradeoff_row *row = &study->row[i];
        const char *name = study->setting[row->setting].method;
        bool is_new = row->trait == trait && row->error > 0; /* none on a log axis is no curve */
        for (size_t k = 0; k < count && is_new; k++) is_new = strcmp(method[k], name) != 0;
        if (is_new && count < MOST_METHODS) method[count++] = name;
    }
    return count;
}

static bool has_front(const tradeoff *study, const plm_trait *trait, tradeoff_labels labels)
{
    for (size_t i = 0; i < study->row_count; i++) {
        const tradeoff_row *row = &study->row[i];
        if (row->trait == trait && row->is_on_front && row->error > 0 && study->setting[row->setting].labels == labels)
            return true;
    }
    return false;
}

static const char script_head[] =
    "# gnuplot script; run it in this folder\nset datafile separator comma\nset datafile missing NaN\n"
    "set logscale xy\nset format y '%g'\nset format x '%g'\nset grid lc rgb '#dddddd'\nset border lc rgb '#444444'\n"
    "set key outside right top noenhanced\nset xlabel 'seconds a plant'\n"
    "of(column_number, name) = strcol(column_number) eq name\n";

/* Fronts as steps, then a mark a row with its interval. */
static plm_status write_curves(const tradeoff *study, const plm_trait *trait, const char *const *method, size_t count,
                               plm_output *output, plm_error *error)
{
    static const char *const colour[TRADEOFF_LABELS] = {"#0072b2", "#d55e00"};
    plm_status status = plm_output_print(output, error, "plot ");
    for (int labels = 0; labels < TRADEOFF_LABELS && status == PLM_OK; labels++)
        if (has_front(study, trait, (tradeoff_labels)labels))
            status =
                plm_output_print(output, error,
                                 "'tradeoff.csv' skip 1 using (of(1,'%s') && of(13,'%s') && of(18,'yes') ? $%d : "
                                 "NaN):%d smooth unique with steps lw 2 lc rgb '%s' title 'front, %s labels', \\\n  ",
                                 trait->name, tradeoff_labels_name((tradeoff_labels)labels), COLUMN_SECONDS,
                                 COLUMN_ERROR, colour[labels], tradeoff_labels_name((tradeoff_labels)labels));
    static const char *const marks[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#8a6d00", "#56b4e9", "#444444"};
    for (size_t k = 0; k < count && status == PLM_OK; k++)
        status = plm_output_print(output, error,
                                  "'tradeoff.csv' skip 1 using (of(1,'%s') && of(2,'%s') ? $%d : NaN):%d:%d:%d with "
                                  "yerrorbars pt %zu ps 0.7 lw 0.6 lc rgb '%s' title '%s'%s",
                                  trait->name, method[k], COLUMN_SECONDS, COLUMN_ERROR, COLUMN_LOW, COLUMN_HIGH,
                                  k < 2 ? 7 - 2 * k : 4 + 2 * (k % 5), marks[k % COUNT(marks)], method[k],
                                  k + 1 < count ? ", \\\n  " : "\n");
    return status;
}

static plm_status write_script(const tradeoff *study, const plm_trait *trait, const char *name,
                               const char *const *method, size_t count, plm_error *error)
{
    static const char *const terminals[] = {
        "svg size 900,480 enhanced font 'sans,12' background '#ffffff'",
        "pngcairo size 1800,960 enhanced font 'sans,12' fontscale 2 linewidth 2 pointscale 2"};
    static const char *const endings[] = {"svg", "png"};
    char file[TRADEOFF_TEXT];
    snprintf(file, sizeof file, "%.80s.gp", name);
    plm_sheet s = plm_sheet_open(study->settings->output, file, error);
    plm_sheet_line(&s, script_head);
    if (s.status == PLM_OK)
        s.status = plm_output_print(s.output, error, "set title '%s' noenhanced\nset ylabel 'mean error, %s'\n",
                                    trait->name, trait->unit == PLM_DEGREE ? "degrees" : "%");
    for (int k = 0; k < 2 && s.status == PLM_OK; k++) {
        s.status =
            plm_output_print(s.output, error, "set terminal %s\nset output '%s.%s'\n", terminals[k], name, endings[k]);
        if (s.status == PLM_OK) s.status = write_curves(study, trait, method, count, s.output, error);
        if (s.status == PLM_OK) s.status = plm_output_print(s.output, error, "unset output\n");
    }
    return plm_sheet_close(&s);
}

plm_status tradeoff_write(const tradeoff *study, bool *is_drawn, plm_error *error)
{
    size_t trait_count;
    const plm_trait *table = plm_traits(&trait_count);
    plm_status status = write_table(study, error);
    if (status == PLM_OK) status = write_failures(study, error);
    *is_drawn = true;
    for (size_t t = 0; t < trait_count && status == PLM_OK; t++) {
        const char *method[MOST_METHODS];
        const size_t count = study->is_wanted[t] ? find_methods(study, &table[t], method) : 0;
        char name[TRADEOFF_TEXT], script[TRADEOFF_TEXT + 8];
        if (count == 0) continue;
        snprintf(name, sizeof name, "tradeoff_%.60s", table[t].name);
        snprintf(script, sizeof script, "%s.gp", name);
        status = write_script(study, &table[t], name, method, count, error);
        if (status == PLM_OK && *is_drawn) status = plm_gnuplot_run(study->settings->output, script, is_drawn, error);
    }
    return status;
}
