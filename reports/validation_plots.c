/* reports/validation_plots.c: estimate against manual, Bland-Altman and the distribution of differences, one script a
 * trait. J. M. Bland and D. G. Altman, Lancet 327 (1986). */
#include "reports/plots.h"

#include "io/io.h"
#include "reports/csv_write.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { PATH_ROOM = 4096 };

static plm_status open_in(const char *folder, const char *trait, const char *ending, plm_output **output,
                          plm_error *error)
{
    char path[PATH_ROOM];
    if ((size_t)snprintf(path, sizeof path, "%s/%s%s", folder, trait, ending) >= sizeof path)
        return plm_fail(error, PLM_E_ARGUMENT, "the folder's name is too long");
    return plm_output_open(path, output, error);
}

static plm_status close_after(plm_output *output, plm_status status, plm_error *error)
{
    const plm_status closed = plm_output_close(output, status == PLM_OK, status == PLM_OK ? error : NULL);
    return status != PLM_OK ? status : closed;
}

/* manual, estimate, half of the 95 % interval, mean, difference, what the pointer shows */
static plm_status write_data(const plm_validation *v, const plm_validated_group *g, const char *folder,
                             plm_error *error)
{
    plm_output *output;
    plm_status status = open_in(folder, g->trait, ".dat", &output, error);
    if (status != PLM_OK) return status;
    status = plm_output_print(output, error, "# manual estimate half_interval mean difference label\n");
    for (size_t i = 0; i < g->count && status == PLM_OK; i++) {
        const plm_validated_pair *pair = &v->pair[g->first + i];
        double difference = pair->estimate_value - pair->manual_value;
        if (strstr(g->trait, "azimuth")) difference = remainder(difference, 360);
        char number[5][PLM_NUMBER_LENGTH], label[256];
        snprintf(label, sizeof label, "%s %s %s", pair->estimate->plant_id, pair->estimate->organ,
                 pair->estimate->organ_id);
        for (char *c = label; *c; c++)
            if (*c == '"' || *c == '\\' || (unsigned char)*c < ' ') *c = '_';
        status =
            plm_output_print(output, error, "%s %s %s %s %s \"%s\"\n", plm_format_number(pair->manual_value, number[0]),
                             plm_format_number(pair->estimate_value, number[1]),
                             plm_format_number(isfinite(pair->std_error) ? 1.96 * pair->std_error : 0, number[2]),
                             plm_format_number((pair->estimate_value + pair->manual_value) / 2, number[3]),
                             plm_format_number(difference, number[4]), label);
    }
    return close_after(output, status, error);
}

static const char script_head[] = "# gnuplot script; run it in this folder\n"
                                  "set datafile separator whitespace\n"
                                  "set style line 1 lc rgb '#0072b2' pt 7 ps 0.7\n"
                                  "set style line 2 lc rgb '#d55e00' lw 2\n"
                                  "set style line 3 lc rgb '#777777' lw 1 dt 2\n"
                                  "set style line 4 lc rgb '#b8cfe0' lw 1\n"
                                  "set border lc rgb '#444444'\n"
                                  "set grid lc rgb '#dddddd'\n"
                                  "unset key\n";

static const char script_panels[] =
    "set multiplot layout 1,3\n"
    "set title name.': estimate against manual' noenhanced\n"
    "set xlabel 'manual ['.unit.']'\nset ylabel 'estimate ['.unit.']'\n"
    "set label 1 facts at graph 0.04,0.96 left front\n"
    "plot x w l ls 3, slope*x+intercept w l ls 2, data u 1:2:3 w yerrorbars ls 4 ps 0, "
    "data u 1:2:6 w labels hypertext point ls 1\n"
    "unset label 1\n"
    "set title 'Bland-Altman'\n"
    "set xlabel 'mean ['.unit.']'\nset ylabel 'estimate - manual ['.unit.']'\n"
    "plot 0 w l ls 3, bias w l ls 2, low w l ls 2 dt 2, high w l ls 2 dt 2, data u 4:5:6 w labels hypertext point ls "
    "1\n"
    "set title 'differences'\n"
    "set xlabel 'estimate - manual ['.unit.']'\nset ylabel 'pairs'\n"
    "set style fill solid 0.7 border lc rgb 'white'\nset boxwidth width\nset yrange [0:*]\n"
    "bin(x) = width*(floor(x/width)+0.5)\n"
    "plot data u (bin($5)):(1.0) smooth freq w boxes lc rgb '#0072b2'\n"
    "unset multiplot\nset autoscale\n";

static double value_or(const plm_validated_group *g, plm_statistic_id id, double otherwise)
{
    return isfinite(g->statistic[id].value) ? g->statistic[id].value : otherwise;
}

static plm_status write_facts(plm_output *output, const plm_validated_group *g, plm_error *error)
{
    char r2[PLM_NUMBER_LENGTH] = "-";
    if (isfinite(g->statistic[PLM_STAT_R2].value)) snprintf(r2, sizeof r2, "%.4f", g->statistic[PLM_STAT_R2].value);
    const double sd = value_or(g, PLM_STAT_SD_DIFF, 0), bias = value_or(g, PLM_STAT_BIAS, 0);
    /* Scott's rule; any width does where all differences are equal. */
    const double width = sd > 0 ? 3.49 * sd / cbrt((double)g->count) : 1;
    plm_status status =
        plm_output_print(output, error, "data = '%s.dat'\nname = '%s'\nunit = '%s'\n", g->trait, g->trait, g->unit);
    if (status == PLM_OK)
        status = plm_output_print(output, error,
                                  "facts = \"n = %zu\\nR2 = %s\\nRMSE = %.4g %s\\nrRMSE = %.3g %%\\nMAPE = %.3g %%\"\n",
                                  g->count, r2, value_or(g, PLM_STAT_RMSE, 0), g->unit, value_or(g, PLM_STAT_RRMSE, 0),
                                  value_or(g, PLM_STAT_MAPE, 0));
    if (status == PLM_OK)
        status = plm_output_print(
            output, error, "slope = %.9g\nintercept = %.9g\nbias = %.9g\nlow = %.9g\nhigh = %.9g\nwidth = %.9g\n",
            value_or(g, PLM_STAT_DEMING_SLOPE, 1), value_or(g, PLM_STAT_DEMING_INTERCEPT, 0), bias,
            value_or(g, PLM_STAT_LOA_LOW, bias), value_or(g, PLM_STAT_LOA_HIGH, bias), width);
    return status;
}

static plm_status write_script(const plm_validated_group *g, const char *folder, plm_error *error)
{
    plm_output *output;
    plm_status status = open_in(folder, g->trait, ".gp", &output, error);
    if (status != PLM_OK) return status;
    status = plm_output_write(output, script_head, sizeof script_head - 1, error);
    if (status == PLM_OK) status = write_facts(output, g, error);
    static const char *const terminals[] = {
        "svg size 1500,480 enhanced font 'sans,13' mouse standalone background '#ffffff'",
        "pngcairo size 4500,1440 enhanced font 'sans,13' fontscale 3 linewidth 3 pointscale 3"};
    static const char *const endings[] = {"svg", "png"};
    for (int k = 0; k < 2 && status == PLM_OK; k++) {
        status = plm_output_print(output, error, "set terminal %s\nset output '%s.%s'\n", terminals[k], g->trait,
                                  endings[k]);
        if (status == PLM_OK) status = plm_output_write(output, script_panels, sizeof script_panels - 1, error);
        if (status == PLM_OK) status = plm_output_print(output, error, "unset output\n");
    }
    return close_after(output, status, error);
}

plm_status plm_validation_plots(const plm_validation *validation, const char *folder, bool *drawn, plm_error *error)
{
    *drawn = true;
    plm_status status = plm_folder_make(folder, error);
    for (size_t i = 0; i < validation->group_count && status == PLM_OK; i++) {
        const plm_validated_group *g = &validation->group[i];
        if (strcmp(g->group, "all")) continue;
        status = write_data(validation, g, folder, error);
        if (status == PLM_OK) status = write_script(g, folder, error);
        char script[256];
        snprintf(script, sizeof script, "%s.gp", g->trait);
        if (status == PLM_OK && *drawn) status = plm_gnuplot_run(folder, script, drawn, error);
    }
    return status;
}
