/* tool/study_light.c: how wrong absorbed light is by the number of rays, and how honest its standard error. */
#include "tool/study.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "io/io.h"

enum { SEEDS = 8, REFERENCE = 4 };

/** The plant and its leaves as groups of faces. */
typedef struct light_subject {
    plm_virtual_plant plant;
    int32_t *face_leaf; /* number of the leaf, -1 for other faces */
} light_subject;

/* One row of the table; leaves are taken together, each relative to its own light. */
typedef struct error_row {
    double rays, plant_error, plant_told, leaf_error, leaf_told;
} error_row;

static plm_status grow(int plant, uint64_t seed, light_subject *subject, plm_error *error)
{
    const plm_plant_options options = {.seed = seed, .resolution = study_plants[plant].resolution};
    const plm_status status = plm_plant_grow(study_plants[plant].kind, &options, &subject->plant, error);
    if (status != PLM_OK) return status;
    const plm_virtual_plant *grown = &subject->plant;
    subject->face_leaf = plm_alloc(grown->mesh.triangle_count, sizeof *subject->face_leaf, error);
    if (!subject->face_leaf) {
        plm_virtual_plant_free(&subject->plant);
        return PLM_E_MEMORY;
    }
    for (size_t f = 0; f < grown->mesh.triangle_count; f++)
        subject->face_leaf[f] = grown->face_label[f] == PLM_LABEL_LEAF ? grown->mesh.face_organ[f] : -1;
    return PLM_OK;
}

static plm_status trace(const light_subject *subject, uint64_t rays, uint64_t seed, plm_light *light, plm_error *error)
{
    plm_light_options options;
    plm_light_defaults(&options);
    options.rays = rays;
    options.seed = seed;
    return plm_light_trace(&subject->plant.mesh, subject->face_leaf, subject->plant.leaf_count, &options, light, error);
}

/* The best that is known: the mean of some runs. power[leaf_count] is the plant's. */
static plm_status find_reference(const light_subject *subject, uint64_t rays, uint64_t seed, double *power,
                                 plm_error *error)
{
    const size_t leaves = subject->plant.leaf_count;
    plm_status status = PLM_OK;
    for (size_t g = 0; g <= leaves; g++) power[g] = 0;
    for (uint64_t k = 0; k < REFERENCE && status == PLM_OK; k++) {
        plm_light light;
        status = trace(subject, rays, seed + 1000 + k, &light, error);
        if (status != PLM_OK) break;
        for (size_t g = 0; g < leaves; g++) power[g] += light.group_power[g] / REFERENCE;
        power[leaves] += light.absorbed / REFERENCE;
        plm_light_free(&light);
    }
    return status;
}

static plm_status measure_row(const light_subject *subject, uint64_t rays, uint64_t seed, const double *power,
                              error_row *row, plm_error *error)
{
    const size_t leaves = subject->plant.leaf_count;
    double square[2] = {0, 0}, told[2] = {0, 0};
    plm_status status = PLM_OK;
    for (uint64_t k = 0; k < SEEDS && status == PLM_OK; k++) {
        plm_light light;
        status = trace(subject, rays, seed + k, &light, error);
        if (status != PLM_OK) break;
        square[0] += pow(light.absorbed / power[leaves] - 1, 2);
        told[0] += pow(light.absorbed_std_error / power[leaves], 2);
        for (size_t g = 0; g < leaves; g++) {
            square[1] += pow(light.group_power[g] / power[g] - 1, 2);
            told[1] += pow(light.group_std_error[g] / power[g], 2);
        }
        plm_light_free(&light);
    }
    const double leaf_count = SEEDS * (double)leaves;
    *row = (error_row){(double)rays, sqrt(square[0] / SEEDS), sqrt(told[0] / SEEDS), sqrt(square[1] / leaf_count),
                       sqrt(told[1] / leaf_count)};
    return status;
}

static const char script[] =
    "# Run as: gnuplot -e \"ending='png'\" light_error.gp   (or svg)\n"
    "if (!exists('ending')) ending = 'svg'\n"
    "if (ending eq 'png') set terminal pngcairo size 1000,700 font ',12'\n"
    "if (ending eq 'svg') set terminal svg size 1000,700 mouse standalone\n"
    "set output 'light_error.' . ending\nset datafile separator comma\nset grid\nset logscale xy\n"
    "set format x '10^{%T}'\nset format y '10^{%T}'\nset key bottom left\n"
    "set xlabel 'rays'\nset ylabel 'relative error of absorbed light'\n"
    "stats 'light_error.csv' skip 1 using 1:2 every ::0::0 nooutput name 'P'\n"
    "plot 'light_error.csv' skip 1 using 1:2 with linespoints linewidth 2 pointtype 7 title 'plant: RMS error of 8 "
    "seeds', \\\n"
    "  '' skip 1 using 1:3 with linespoints dashtype 2 title 'plant: standard error as told', \\\n"
    "  '' skip 1 using 1:4 with linespoints linewidth 2 pointtype 5 title 'leaves: RMS error', \\\n"
    "  '' skip 1 using 1:5 with linespoints dashtype 2 title 'leaves: standard error as told', \\\n"
    "  P_max_y * sqrt(1000 / x) with lines dashtype 3 linecolor rgb '#888888' title 'as 1/sqrt(rays): plain Monte "
    "Carlo'\n";

static plm_status write_text(const study *all, const char *name, const char *text, plm_error *error)
{
    char path[STUDY_PATH];
    plm_output *output;
    plm_status status = study_path(all, name, path, error);
    if (status == PLM_OK) status = plm_output_open(path, &output, error);
    if (status != PLM_OK) return status;
    status = plm_output_print(output, error, "%s", text);
    const plm_status closed = plm_output_close(output, status == PLM_OK, error);
    return status == PLM_OK ? closed : status;
}

plm_status study_light(const study *all, int plant, uint64_t most, uint64_t seed, bool *is_drawn, plm_error *error)
{
    light_subject subject;
    char table[4096] = "rays,plant_error,plant_std_error,leaf_error,leaf_std_error\n";
    plm_status status = grow(plant, seed, &subject, error);
    if (status != PLM_OK) return status;
    double *power = plm_alloc(subject.plant.leaf_count + 1, sizeof *power, error);
    status = power ? find_reference(&subject, most, seed, power, error) : PLM_E_MEMORY;
    size_t used = strlen(table);
    for (uint64_t rays = 1000; rays <= most && status == PLM_OK; rays *= 4) {
        error_row row;
        status = measure_row(&subject, rays, seed, power, &row, error);
        if (status == PLM_OK && used < sizeof table)
            used += (size_t)snprintf(table + used, sizeof table - used, "%.0f,%.4g,%.4g,%.4g,%.4g\n", row.rays,
                                     row.plant_error, row.plant_told, row.leaf_error, row.leaf_told);
    }
    if (status == PLM_OK) status = write_text(all, "light_error.csv", table, error);
    if (status == PLM_OK) status = write_text(all, "light_error.gp", script, error);
    if (status == PLM_OK) {
        const bool has_svg = study_run_gnuplot(all->folder, "light_error", "svg");
        *is_drawn = study_run_gnuplot(all->folder, "light_error", "png") && has_svg;
    }
    plm_free(power);
    plm_free(subject.face_leaf);
    plm_virtual_plant_free(&subject.plant);
    return status;
}
