/* reports/overview_plot.c: the main traits of every plant of a run side by side. */
#include "reports/overview_plot.h"

#include "reports/plots.h"
#include "reports/sheet.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *const shown[] = {"plant_height", "total_leaf_area", "leaf_count", "stem_diameter"};
enum { SHOWN = sizeof shown / sizeof *shown };

/* A row a plant: number, and of each trait value and half of the 95 % interval (nan where there is none), then the name. */
static plm_status write_data(const plm_results *results, const char *folder, plm_error *error)
{
    plm_sheet s = plm_sheet_open(folder, "overview.dat", error);
    plm_sheet_line(&s, "# number, value and half_interval of each trait, plant");
    for (size_t i = 0; i < results->count; i++) {
        plm_sheet_number(&s, (double)(i + 1), ' ');
        for (int k = 0; k < SHOWN; k++) {
            const plm_trait *trait = plm_trait_find(shown[k]);
            const plm_result_row *row = trait ? plm_result_of_plant(&results->plant[i], trait) : NULL;
            if (row) {
                plm_sheet_number(&s, row->value, ' ');
                plm_sheet_number(&s, isfinite(row->std_error) ? 1.96 * row->std_error : 0, ' ');
            } else {
                plm_sheet_text(&s, "nan", ' ');
                plm_sheet_text(&s, "nan", ' ');
            }
        }
        plm_sheet_quoted(&s, results->plant[i].plant_id, '\n');
    }
    return plm_sheet_close(&s);
}

/* gnuplot refuses a panel without a single value. */
static bool is_there(const plm_results *results, const plm_trait *trait)
{
    for (size_t i = 0; trait && i < results->count; i++)
        if (plm_result_of_plant(&results->plant[i], trait)) return true;
    return false;
}

static plm_status write_script(const plm_results *results, const char *folder, plm_error *error)
{
    static const char *const terminals[] = {
        "svg size 1500,720 enhanced font 'sans,13' mouse standalone background '#ffffff'",
        "pngcairo size 4500,2160 enhanced font 'sans,13' fontscale 3 linewidth 3 pointscale 3"};
    static const char *const endings[] = {"svg", "png"};
    plm_sheet s = plm_sheet_open(folder, "overview.gp", error);
    plm_sheet_line(
        &s, "# gnuplot script; run it in this folder\nset datafile separator whitespace\nunset key\n"
            "set border lc rgb '#444444'\nset grid lc rgb '#dddddd'\nset xlabel 'plant, in the order of the table'\n"
            "set offsets 0,0,graph 0.08,graph 0.08");
    if (results->count <= 20) plm_sheet_line(&s, "set xtics 1");
    for (int t = 0; t < 2 && s.status == PLM_OK; t++) {
        s.status = plm_output_print(s.output, error,
                                    "set terminal %s\nset output 'overview.%s'\nset multiplot layout 2,2\nset xrange "
                                    "[0.5:%zu.5]\n",
                                    terminals[t], endings[t], results->count);
        for (int k = 0; k < SHOWN && s.status == PLM_OK; k++) {
            const plm_trait *trait = plm_trait_find(shown[k]);
            if (!is_there(results, trait)) continue;
            s.status = plm_output_print(
                s.output, error,
                "set title '%s' noenhanced\nset ylabel '%s'\nplot 'overview.dat' u 1:%d:%d w yerrorbars pt 7 "
                "ps 0.5 lc rgb '#0072b2', '' u 1:%d:10 w labels hypertext point pt 7 ps 0.1 lc rgb "
                "'#0072b2'\n",
                shown[k], trait->unit != PLM_NUMBER ? plm_unit_name(trait->unit) : "", 2 + 2 * k, 3 + 2 * k, 2 + 2 * k);
        }
        plm_sheet_line(&s, "unset multiplot\nunset output");
    }
    return plm_sheet_close(&s);
}

plm_status plm_overview_plot(const plm_results *results, const char *folder, bool *drawn, plm_error *error)
{
    plm_status status = plm_folder_make(folder, error);
    if (status == PLM_OK) status = write_data(results, folder, error);
    if (status == PLM_OK) status = write_script(results, folder, error);
    bool has_value = false;
    for (int k = 0; k < SHOWN; k++) has_value = has_value || is_there(results, plm_trait_find(shown[k]));
    *drawn = true;
    return status == PLM_OK && has_value ? plm_gnuplot_run(folder, "overview.gp", drawn, error) : status;
}
