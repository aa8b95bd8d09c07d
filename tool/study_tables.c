/* tool/study_tables.c: the tables of the thinning study, ours beside the laser-scanning paper's. */
#include "tool/study.h"

#include <math.h>
#include <stdio.h>

#include "io/io.h"

const study_plant study_plants[STUDY_PLANTS] = {
    {"tomato", "tomato_large", 0.045, 21, 21, 8558, 1.7, 0.43, 142.53, 0.59, 0.78},
    {"maize", "maize_large", 0.23, 14, 15, 5150, 2.5, 0.97, 699.83, 0.67, 0.94},
    {"cucumber", "cucumber_large", 0.105, 17, 18, 1931, 2.0, 0.43, 12.74, 0.48, 0.94},
    {"arabidopsis", "arabidopsis_large", 0.125, 10, 11, 1200, 0.03, 0.06, 189.92, 0.79, 0.81},
};

/* The paper's Table 3: correlation with visible area over 0 to 30 % loss. NAN: constant there. */
enum { TABLE3 = 6 };
static const plm_thinning_trait table3_trait[TABLE3] = {PLM_THIN_HEIGHT,      PLM_THIN_PCA1,     PLM_THIN_PCA2,
                                                        PLM_THIN_HULL_VOLUME, PLM_THIN_ABSORBED, PLM_THIN_AREA};
static const double table3_paper[STUDY_PLANTS][PLM_LOSS_COUNT][TABLE3] = {
    {{NAN, -0.75, 0.87, 0.94, 1.00, NAN}, {NAN, 0.98, 0.95, 0.78, 0.99, 1.00}, {NAN, 0.98, 0.98, 1.00, 1.00, 1.00}},
    {{NAN, 0.80, 0.87, 0.94, 1.00, 1.00}, {NAN, 0.95, 0.87, 0.97, 0.99, 1.00}, {NAN, 0.99, 0.92, 1.00, 1.00, 1.00}},
    {{NAN, -0.85, -0.73, 0.91, 1.00, NAN}, {NAN, 0.43, 0.42, 0.75, 0.98, 1.00}, {NAN, 0.99, 1.00, 1.00, 1.00, 1.00}},
    {{0.71, 0.89, 0.83, -0.77, 1.00, 1.00}, {NAN, -0.88, 0.87, 0.73, 0.95, 1.00}, {0.82, 0.98, 0.99, 1.00, 1.00, 1.00}},
};

plm_status study_path(const study *all, const char *name, char path[STUDY_PATH], plm_error *error)
{
    if (snprintf(path, STUDY_PATH, "%s/%s", all->folder, name) >= STUDY_PATH)
        return plm_fail(error, PLM_E_ARGUMENT, "%.200s...: the path is too long", all->folder);
    return PLM_OK;
}

/* A table that is written twice, as CSV and as Markdown, cell by cell. */
typedef struct two_tables {
    plm_output *csv, *markdown;
    plm_status status;
    plm_error *error;
    bool is_first;
} two_tables;

static void text_cell(two_tables *table, const char *text)
{
    if (table->status == PLM_OK)
        table->status = plm_output_print(table->csv, table->error, "%s%s", table->is_first ? "" : ",", text);
    if (table->status == PLM_OK) table->status = plm_output_print(table->markdown, table->error, "| %s ", text);
    table->is_first = false;
}

static void number_cell(two_tables *table, double value, int digits)
{
    char text[48] = "";
    if (isfinite(value)) snprintf(text, sizeof text, "%.*f", digits, value);
    text_cell(table, text);
}

static void end_row(two_tables *table, int columns)
{
    if (table->status == PLM_OK) table->status = plm_output_print(table->csv, table->error, "\n");
    if (table->status == PLM_OK) table->status = plm_output_print(table->markdown, table->error, "|\n");
    for (int k = 0; k < columns && table->status == PLM_OK; k++)
        table->status = plm_output_print(table->markdown, table->error, k + 1 < columns ? "|---" : "|---|\n");
    table->is_first = true;
}

static plm_status open_tables(const study *all, const char *name, two_tables *table, plm_error *error)
{
    char path[STUDY_PATH], file[64];
    *table = (two_tables){.error = error, .is_first = true};
    snprintf(file, sizeof file, "%s.csv", name);
    plm_status status = study_path(all, file, path, error);
    if (status == PLM_OK) status = plm_output_open(path, &table->csv, error);
    if (status != PLM_OK) return status;
    snprintf(file, sizeof file, "%s.md", name);
    status = study_path(all, file, path, error);
    if (status == PLM_OK) status = plm_output_open(path, &table->markdown, error);
    if (status != PLM_OK) plm_output_close(table->csv, false, NULL);
    return status;
}

static plm_status close_tables(two_tables *table)
{
    const bool is_good = table->status == PLM_OK;
    const plm_status first = plm_output_close(table->csv, is_good, table->error);
    const plm_status second = plm_output_close(table->markdown, is_good && first == PLM_OK, table->error);
    return !is_good ? table->status : first != PLM_OK ? first : second;
}

static void header(two_tables *table, const char *const *name, int count)
{
    for (int k = 0; k < count; k++) text_cell(table, name[k]);
    end_row(table, count);
}

static plm_status write_table1(const study *all, plm_error *error)
{
    static const char *const name[] = {"plant",    "source",   "leaves", "internodes",        "height_m",
                                       "radius_m", "vertices", "faces",  "mean_face_area_mm2"};
    two_tables table;
    const plm_status status = open_tables(all, "table1", &table, error);
    if (status != PLM_OK) return status;
    header(&table, name, 9);
    for (int p = 0; p < STUDY_PLANTS; p++) {
        const study_plant *paper = &study_plants[p];
        const study_model *model = &all->model[p];
        if (!model->is_there) continue;
        text_cell(&table, paper->name);
        text_cell(&table, "paper");
        number_cell(&table, paper->leaves, 0);
        number_cell(&table, paper->internodes, 0);
        number_cell(&table, paper->height, 2);
        number_cell(&table, paper->radius, 2);
        number_cell(&table, 3 * paper->faces, 0);
        number_cell(&table, paper->faces, 0);
        number_cell(&table, paper->face_area_mm2, 2);
        end_row(&table, 0);
        text_cell(&table, paper->name);
        text_cell(&table, "ours");
        number_cell(&table, (double)model->leaves, 0);
        number_cell(&table, (double)model->nodes, 0);
        number_cell(&table, model->height, 2);
        number_cell(&table, model->radius, 2);
        number_cell(&table, (double)model->vertices, 0);
        number_cell(&table, (double)model->faces, 0);
        number_cell(&table, 1e6 * model->area / (double)model->faces, 2);
        end_row(&table, 0);
    }
    return close_tables(&table);
}

static int first_loss(const study *all)
{
    int loss = 0;
    while (loss + 1 < PLM_LOSS_COUNT && !all->has_loss[loss]) loss++;
    return loss;
}

static plm_status write_table2(const study *all, plm_error *error)
{
    static const char *const name[] = {"plant", "visible_faces", "visible_faces_paper", "visible_area",
                                       "visible_area_paper"};
    two_tables table;
    const plm_status status = open_tables(all, "table2", &table, error);
    if (status != PLM_OK) return status;
    header(&table, name, 5);
    for (int p = 0; p < STUDY_PLANTS; p++) {
        if (!all->has_plant[p]) continue;
        const double *intact = all->value[p][first_loss(all)][0];
        text_cell(&table, study_plants[p].name);
        number_cell(&table, intact[PLM_THIN_VISIBLE_FACES], 2);
        number_cell(&table, study_plants[p].visible_faces, 2);
        number_cell(&table, intact[PLM_THIN_VISIBLE_AREA] / intact[PLM_THIN_AREA], 2);
        number_cell(&table, study_plants[p].visible_area, 2);
        end_row(&table, 0);
    }
    return close_tables(&table);
}

/* Pearson's r between visible area and a trait over the steps; NAN where the trait hardly changes (below 0.1 %). */
static double correlation(const study *all, int plant, int loss, plm_thinning_trait trait)
{
    double mean[2] = {0, 0}, xx = 0, yy = 0, xy = 0, low = INFINITY, high = -INFINITY;
    const int count = all->max_loss + 1;
    for (int k = 0; k < count; k++) {
        mean[0] += all->value[plant][loss][k][PLM_THIN_VISIBLE_AREA] / count;
        mean[1] += all->value[plant][loss][k][trait] / count;
    }
    for (int k = 0; k < count; k++) {
        const double x = all->value[plant][loss][k][PLM_THIN_VISIBLE_AREA] - mean[0];
        const double value = all->value[plant][loss][k][trait], y = value - mean[1];
        xx += x * x;
        yy += y * y;
        xy += x * y;
        low = fmin(low, value);
        high = fmax(high, value);
    }
    if (high - low < 1e-3 * fabs(mean[1]) || !(xx > 0)) return NAN;
    return xy / sqrt(xx * yy);
}

static plm_status write_table3(const study *all, plm_error *error)
{
    two_tables table;
    const plm_status status = open_tables(all, "table3", &table, error);
    if (status != PLM_OK) return status;
    text_cell(&table, "plant");
    text_cell(&table, "scenario");
    for (int k = 0; k < TABLE3; k++) {
        char paper[64];
        text_cell(&table, plm_thinning_trait_name(table3_trait[k]));
        snprintf(paper, sizeof paper, "%s_paper", plm_thinning_trait_name(table3_trait[k]));
        text_cell(&table, paper);
    }
    end_row(&table, 2 + 2 * TABLE3);
    for (int p = 0; p < STUDY_PLANTS; p++)
        for (int l = 0; l < PLM_LOSS_COUNT; l++) {
            if (!all->has_plant[p] || !all->has_loss[l]) continue;
            text_cell(&table, study_plants[p].name);
            text_cell(&table, plm_loss_name((plm_loss)l));
            for (int k = 0; k < TABLE3; k++) {
                number_cell(&table, correlation(all, p, l, table3_trait[k]), 2);
                number_cell(&table, table3_paper[p][l][k], 2);
            }
            end_row(&table, 0);
        }
    return close_tables(&table);
}

/* One long table, a row a value. */
static plm_status write_long(const study *all, plm_error *error)
{
    char path[STUDY_PATH];
    plm_output *output;
    plm_status status = study_path(all, "thinning.csv", path, error);
    if (status == PLM_OK) status = plm_output_open(path, &output, error);
    if (status != PLM_OK) return status;
    status = plm_output_print(output, error, "plant,scenario,loss_percent,trait,value,relative\n");
    for (int p = 0; p < STUDY_PLANTS; p++)
        for (int l = 0; l < PLM_LOSS_COUNT; l++)
            for (int k = 0; k <= all->max_loss && all->has_plant[p] && all->has_loss[l]; k++)
                for (int t = 0; t < PLM_THIN_COUNT && status == PLM_OK; t++) {
                    const double value = all->value[p][l][k][t], intact = all->value[p][l][0][t];
                    status = plm_output_print(output, error, "%s,%s,%d,%s,%.9g,", study_plants[p].name,
                                              plm_loss_name((plm_loss)l), k,
                                              plm_thinning_trait_name((plm_thinning_trait)t), value);
                    if (status == PLM_OK)
                        status = intact != 0 ? plm_output_print(output, error, "%.9g\n", value / intact)
                                             : plm_output_print(output, error, "\n");
                }
    const plm_status closed = plm_output_close(output, status == PLM_OK, error);
    return status == PLM_OK ? closed : status;
}

/* The relative values as a wide table: a row a step, a column a trait. */
static plm_status write_relative(const study *all, plm_error *error)
{
    char path[STUDY_PATH];
    plm_output *output;
    plm_status status = study_path(all, "relative.csv", path, error);
    if (status == PLM_OK) status = plm_output_open(path, &output, error);
    if (status != PLM_OK) return status;
    status = plm_output_print(output, error, "plant,scenario,loss_percent");
    for (int t = 0; t < PLM_THIN_COUNT && status == PLM_OK; t++)
        status = plm_output_print(output, error, ",%s", plm_thinning_trait_name((plm_thinning_trait)t));
    for (int p = 0; p < STUDY_PLANTS; p++)
        for (int l = 0; l < PLM_LOSS_COUNT; l++)
            for (int k = 0; k <= all->max_loss && all->has_plant[p] && all->has_loss[l] && status == PLM_OK; k++) {
                status =
                    plm_output_print(output, error, "\n%s,%s,%d", study_plants[p].name, plm_loss_name((plm_loss)l), k);
                for (int t = 0; t < PLM_THIN_COUNT && status == PLM_OK; t++) {
                    const double intact = all->value[p][l][0][t];
                    status = intact != 0 ? plm_output_print(output, error, ",%.9g", all->value[p][l][k][t] / intact)
                                         : plm_output_print(output, error, ",");
                }
            }
    if (status == PLM_OK) status = plm_output_print(output, error, "\n");
    const plm_status closed = plm_output_close(output, status == PLM_OK, error);
    return status == PLM_OK ? closed : status;
}

/* Straight line through (1, 1) from relative visible area to relative trait, over all steps and scenarios of a plant: the
 * curve that the paper proposes to normalise by. */
static void fit_correction(const study *all, int plant, plm_thinning_trait trait, double *slope, double *residual)
{
    double xx = 0, xy = 0, squares = 0;
    int count = 0;
    for (int pass = 0; pass < 2; pass++)
        for (int l = 0; l < PLM_LOSS_COUNT; l++)
            for (int k = 1; k <= all->max_loss && all->has_loss[l]; k++) {
                const double *now = all->value[plant][l][k], *intact = all->value[plant][l][0];
                const double x = now[PLM_THIN_VISIBLE_AREA] / intact[PLM_THIN_VISIBLE_AREA] - 1;
                const double y = now[trait] / intact[trait] - 1;
                if (pass == 0) {
                    xx += x * x;
                    xy += x * y;
                    count++;
                } else {
                    squares += (y - xy / xx * x) * (y - xy / xx * x);
                }
            }
    *slope = xx > 0 ? xy / xx : NAN;
    *residual = xx > 0 && count > 1 ? sqrt(squares / (count - 1)) : NAN;
}

static plm_status write_correction(const study *all, plm_error *error)
{
    char path[STUDY_PATH];
    plm_output *output;
    plm_status status = study_path(all, "visibility_correction.csv", path, error);
    if (status == PLM_OK) status = plm_output_open(path, &output, error);
    if (status != PLM_OK) return status;
    status = plm_output_print(output, error, "plant,trait,slope,residual_sd\n");
    for (int p = 0; p < STUDY_PLANTS; p++)
        for (int k = 0; k < TABLE3 && status == PLM_OK && all->has_plant[p]; k++) {
            double slope, residual;
            fit_correction(all, p, table3_trait[k], &slope, &residual);
            /* what measures area in a cloud is the area of leaves */
            status = plm_output_print(output, error, "%s,%s,%.6g,%.6g\n", study_plants[p].name,
                                      table3_trait[k] == PLM_THIN_AREA ? "total_leaf_area"
                                                                       : plm_thinning_trait_name(table3_trait[k]),
                                      slope, residual);
        }
    const plm_status closed = plm_output_close(output, status == PLM_OK, error);
    return status == PLM_OK ? closed : status;
}

plm_status study_write_ellipsoid(const study *all, int plant, const plm_thinning *thinning, plm_error *error)
{
    char path[STUDY_PATH], name[64];
    const double *area;
    const uint32_t *hits;
    size_t count;
    plm_output *output;
    plm_thinning_ellipsoid(thinning, &area, &hits, &count);
    snprintf(name, sizeof name, "ellipsoid_%s.csv", study_plants[plant].name);
    plm_status status = study_path(all, name, path, error);
    if (status == PLM_OK) status = plm_output_open(path, &output, error);
    if (status != PLM_OK) return status;
    status = plm_output_print(output, error, "face_area_mm2,hits\n");
    for (size_t f = 0; f < count && status == PLM_OK; f++)
        status = plm_output_print(output, error, "%.6g,%u\n", 1e6 * area[f], hits[f]);
    const plm_status closed = plm_output_close(output, status == PLM_OK, error);
    return status == PLM_OK ? closed : status;
}

plm_status study_write_tables(const study *all, plm_error *error)
{
    plm_status status = write_long(all, error);
    if (status == PLM_OK) status = write_relative(all, error);
    if (status == PLM_OK) status = write_table1(all, error);
    if (status == PLM_OK) status = write_table2(all, error);
    if (status == PLM_OK) status = write_table3(all, error);
    if (status == PLM_OK) status = write_correction(all, error);
    return status;
}
