/* tool/study_plots.c: the figures of the thinning study: a gnuplot script a figure, kept beside its SVG and PNG, reading thinning.csv. */
#include "tool/study.h"

#include <fcntl.h>
#include <spawn.h>
#include <stdio.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/io.h"

extern char **environ;

/** One figure: a panel a plant, a line a trait or a scenario. */
typedef struct figure {
    const char *name, *title, *x_label, *y_label;
    int traits;
    plm_thinning_trait trait[6];
    bool is_a_line_a_scenario; /* of the first trait; else a panel a plant and scenario */
    bool is_against_visible;   /* x is the relative visible area, from relative.csv */
    bool is_random_only, is_absolute;
} figure;

static const figure figures[] = {
    {"figure9",
     "traits against loss",
     "faces removed, %",
     "relative to the intact plant",
     6,
     {PLM_THIN_HEIGHT, PLM_THIN_PCA1, PLM_THIN_PCA2, PLM_THIN_HULL_VOLUME, PLM_THIN_ABSORBED, PLM_THIN_AREA},
     false,
     false,
     false,
     false},
    {"figure10",
     "visible area against loss",
     "faces removed, %",
     "visible area, relative",
     1,
     {PLM_THIN_VISIBLE_AREA},
     true,
     false,
     false,
     false},
    {"figure13_mean",
     "mean smoothness factor against random loss",
     "faces removed, %",
     "mean SF",
     1,
     {PLM_THIN_SF_MEAN},
     true,
     false,
     true,
     true},
    {"figure13_sd",
     "SD of the smoothness factor against random loss",
     "faces removed, %",
     "SD of SF",
     1,
     {PLM_THIN_SF_SD},
     true,
     false,
     true,
     true},
    {"figure13_boundary",
     "share of points with SF above 0.5",
     "faces removed, %",
     "share",
     1,
     {PLM_THIN_SF_BOUNDARY},
     true,
     false,
     true,
     true},
    {"figure13_t",
     "t of the smoothness factor against the intact plant (Welch)",
     "faces removed, %",
     "t",
     1,
     {PLM_THIN_SF_T},
     true,
     false,
     true,
     true},
    {"figure11",
     "traits against visible area",
     "visible area, relative",
     "relative to the intact plant",
     6,
     {PLM_THIN_HEIGHT, PLM_THIN_PCA1, PLM_THIN_PCA2, PLM_THIN_HULL_VOLUME, PLM_THIN_ABSORBED, PLM_THIN_AREA},
     false,
     true,
     false,
     false},
};

/* One curve: rows of a plant, a scenario and a trait. Column 5 is the value, 6 the value relative to the intact plant. */
static plm_status curve(plm_output *output, int plant, int loss, plm_thinning_trait trait, bool is_absolute,
                        bool is_against_visible, const char *title, bool is_last, plm_error *error)
{
    if (is_against_visible)
        return plm_output_print(output, error,
                                "'relative.csv' using ((strcol(1) eq '%s' && strcol(2) eq '%s') ? column(%d) : NaN):%d "
                                "with linespoints linewidth 1.5 pointsize 0.3 title '%s'%s",
                                study_plants[plant].name, plm_loss_name((plm_loss)loss), 4 + (int)PLM_THIN_VISIBLE_AREA,
                                4 + (int)trait, title, is_last ? "\n" : ", \\\n  ");
    return plm_output_print(output, error,
                            "'thinning.csv' using 3:((strcol(1) eq '%s' && strcol(2) eq '%s' && strcol(4) eq '%s') ? "
                            "column(%d) : NaN) with linespoints linewidth 1.5 pointsize 0.3 title '%s'%s",
                            study_plants[plant].name, plm_loss_name((plm_loss)loss), plm_thinning_trait_name(trait),
                            is_absolute ? 5 : 6, title, is_last ? "\n" : ", \\\n  ");
}

static int last_loss(const study *all, bool is_random_only)
{
    int last = 0;
    for (int l = 0; l < PLM_LOSS_COUNT; l++)
        if (all->has_loss[l] && !(is_random_only && l != PLM_LOSS_RANDOM)) last = l;
    return last;
}

static plm_status panel(plm_output *output, const study *all, const figure *drawn, int plant, int loss,
                        plm_error *error)
{
    plm_status status = plm_output_print(output, error, "set title '%s%s%s'\nplot ", study_plants[plant].name,
                                         loss < 0 ? "" : ", ", loss < 0 ? "" : plm_loss_name((plm_loss)loss));
    if (loss >= 0)
        for (int t = 0; t < drawn->traits && status == PLM_OK; t++)
            status = curve(output, plant, loss, drawn->trait[t], drawn->is_absolute, drawn->is_against_visible,
                           plm_thinning_trait_name(drawn->trait[t]), t + 1 == drawn->traits, error);
    const int last = last_loss(all, drawn->is_random_only);
    for (int l = 0; loss < 0 && l <= last && status == PLM_OK; l++)
        if (all->has_loss[l])
            status = curve(output, plant, l, drawn->trait[0], drawn->is_absolute, drawn->is_against_visible,
                           plm_loss_name((plm_loss)l), l == last, error);
    return status;
}

static plm_status write_script(const study *all, const figure *drawn, const char *path, plm_error *error)
{
    plm_output *output;
    plm_status status = plm_output_open(path, &output, error);
    if (status != PLM_OK) return status;
    int plants = 0, losses = 0;
    for (int p = 0; p < STUDY_PLANTS; p++) plants += all->has_plant[p];
    for (int l = 0; l < PLM_LOSS_COUNT; l++) losses += all->has_loss[l];
    const int columns = drawn->is_a_line_a_scenario ? 2 : losses;
    const int rows = drawn->is_a_line_a_scenario ? (plants + 1) / 2 : plants;
    status = plm_output_print(output, error,
                              "# Run as: gnuplot -e \"ending='png'\" %s.gp   (or svg)\n"
                              "if (!exists('ending')) ending = 'svg'\n"
                              "if (ending eq 'png') set terminal pngcairo size 1500,%d font ',11'\n"
                              "if (ending eq 'svg') set terminal svg size 1500,%d mouse standalone\n"
                              "set output '%s.' . ending\nset datafile separator comma\nset datafile missing NaN\n"
                              "set key noenhanced font ',9' bottom left\nset grid\n"
                              "set xlabel '%s'\nset ylabel '%s'\nset multiplot layout %d,%d title '%s'\n",
                              drawn->name, 380 * rows, 380 * rows, drawn->name, drawn->x_label, drawn->y_label, rows,
                              columns, drawn->title);
    for (int p = 0; p < STUDY_PLANTS && status == PLM_OK; p++) {
        if (!all->has_plant[p]) continue;
        if (drawn->is_a_line_a_scenario) status = panel(output, all, drawn, p, -1, error);
        for (int l = 0; l < PLM_LOSS_COUNT && !drawn->is_a_line_a_scenario && status == PLM_OK; l++)
            if (all->has_loss[l]) status = panel(output, all, drawn, p, l, error);
    }
    if (status == PLM_OK) status = plm_output_print(output, error, "unset multiplot\n");
    const plm_status closed = plm_output_close(output, status == PLM_OK, error);
    return status == PLM_OK ? closed : status;
}

/* Figure 8: hits against the area of a fully visible face, on the half ellipsoid of each plant's size. */
static plm_status write_figure8(const study *all, const char *path, plm_error *error)
{
    plm_output *output;
    plm_status status = plm_output_open(path, &output, error);
    if (status != PLM_OK) return status;
    int plants = 0;
    for (int p = 0; p < STUDY_PLANTS; p++) plants += all->has_plant[p];
    status = plm_output_print(output, error,
                              "# Run as: gnuplot -e \"ending='png'\" figure8.gp   (or svg)\n"
                              "if (!exists('ending')) ending = 'svg'\n"
                              "if (ending eq 'png') set terminal pngcairo size 1500,%d font ',11'\n"
                              "if (ending eq 'svg') set terminal svg size 1500,%d mouse standalone\n"
                              "set output 'figure8.' . ending\nset datafile separator comma\nset key noenhanced font "
                              "',9' top left\nset grid\n"
                              "set xlabel 'face area, mm^2'\nset ylabel 'hits'\nset fit quiet logfile '/dev/null'\n"
                              "set multiplot layout %d,2 title 'hits on a fully visible half ellipsoid'\n",
                              380 * ((plants + 1) / 2), 380 * ((plants + 1) / 2), (plants + 1) / 2);
    for (int p = 0; p < STUDY_PLANTS && status == PLM_OK; p++)
        if (all->has_plant[p])
            status =
                plm_output_print(output, error,
                                 "a = 0.1\nhits(x) = a * x\nfit hits(x) 'ellipsoid_%s.csv' skip 1 using 1:2 via a\n"
                                 "stats 'ellipsoid_%s.csv' skip 1 using 1:2 nooutput name 'S'\n"
                                 "set title sprintf('%s: %%.4f hits/mm^2, r^2 = %%.2f', a, S_correlation**2)\n"
                                 "plot [0:*] [0:*] 'ellipsoid_%s.csv' skip 1 using 1:2 with dots linecolor rgb "
                                 "'#888888' title 'faces', \\\n"
                                 "  'ellipsoid_%s.csv' skip 1 using (25 * floor($1 / 25) + 12.5):2 smooth unique with "
                                 "linespoints linewidth 2 "
                                 "pointtype 7 title 'mean of classes of 25 mm2', \\\n"
                                 "  hits(x) with lines linewidth 2 title 'a x area'\n",
                                 study_plants[p].name, study_plants[p].name, study_plants[p].name, study_plants[p].name,
                                 study_plants[p].name);
    if (status == PLM_OK) status = plm_output_print(output, error, "unset multiplot\n");
    const plm_status closed = plm_output_close(output, status == PLM_OK, error);
    return status == PLM_OK ? closed : status;
}

/* Text inside gnuplot's single quotes: a quote is written twice. */
static void quote(const char *text, char *quoted, size_t room)
{
    size_t used = 0;
    for (; *text && used + 3 < room; text++) {
        if (*text == '\'') quoted[used++] = '\'';
        quoted[used++] = *text;
    }
    quoted[used] = 0;
}

/* Runs a script in the study's folder. */
bool study_run_gnuplot(const char *folder, const char *name, const char *ending)
{
    char quoted[2 * STUDY_PATH], command[2 * STUDY_PATH + 96], setting[32];
    quote(folder, quoted, sizeof quoted);
    snprintf(setting, sizeof setting, "ending='%s'", ending);
    snprintf(command, sizeof command, "cd '%s'; load '%s.gp'", quoted, name);
    char *argument[] = {"gnuplot", "-e", setting, "-e", command, NULL};
    char log[STUDY_PATH + 16];
    posix_spawn_file_actions_t actions;
    pid_t child;
    int result;
    if (posix_spawn_file_actions_init(&actions) != 0) return false;
    snprintf(log, sizeof log, "%s/gnuplot.log", folder); /* what it says belongs to the study, not to the terminal */
    const bool is_running =
        posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, log, O_WRONLY | O_CREAT | O_APPEND, 0666) == 0 &&
        posix_spawnp(&child, "gnuplot", &actions, NULL, argument, environ) == 0;
    posix_spawn_file_actions_destroy(&actions);
    if (!is_running) return false;
    return waitpid(child, &result, 0) == child && WIFEXITED(result) && WEXITSTATUS(result) == 0;
}

bool study_plot(const study *all, plm_status *status, plm_error *error)
{
    char figure8[STUDY_PATH];
    bool is_drawn = true;
    *status = study_path(all, "figure8.gp", figure8, error);
    if (*status == PLM_OK) *status = write_figure8(all, figure8, error);
    for (int k = 0; k < 2 && *status == PLM_OK; k++)
        is_drawn = study_run_gnuplot(all->folder, "figure8", k ? "png" : "svg") && is_drawn;
    for (size_t k = 0; k < sizeof figures / sizeof *figures && *status == PLM_OK; k++) {
        char name[64], path[STUDY_PATH];
        if (figures[k].is_random_only && !all->has_loss[PLM_LOSS_RANDOM]) continue;
        snprintf(name, sizeof name, "%s.gp", figures[k].name);
        *status = study_path(all, name, path, error);
        if (*status == PLM_OK) *status = write_script(all, &figures[k], path, error);
        if (*status != PLM_OK) break;
        is_drawn = study_run_gnuplot(all->folder, figures[k].name, "svg") && is_drawn;
        is_drawn = study_run_gnuplot(all->folder, figures[k].name, "png") && is_drawn;
    }
    return is_drawn;
}
