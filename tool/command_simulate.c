/* tool/command_simulate.c: the `simulate` sub-command: virtual plants, scanned, with their truth. */
#include "io/io.h"
#include "mesh/mesh.h"
#include "simulate/simulate.h"
#include "tool/command.h"

#include <stdio.h>
#include <string.h>

typedef enum cloud_format { FORMAT_PLY = 0, FORMAT_3DGS, FORMAT_PCD, FORMAT_XYZ, FORMAT_CSV } cloud_format;

typedef struct simulate_settings {
    int count, scanner, points, format, views;
    uint64_t seed;
    int image_width;
    double density, noise, outliers, resolution, axis_tilt, axis_shift;
    bool has_pot, has_table, is_arched, is_quiet, has_views_out;
    const char *output;
} simulate_settings;

#define AT(field) .offset = offsetof(simulate_settings, field)

static const plm_option options[] = {
    {.letter = 'o',
     .name = "output",
     .argument = "DIR",
     .help = "write here (required)",
     .kind = PLM_OPTION_TEXT,
     AT(output)},
    {.letter = 'n',
     .name = "count",
     .argument = "COUNT",
     .help = "plants of each KIND (default: 1)",
     .kind = PLM_OPTION_INTEGER,
     AT(count),
     .minimum = 1,
     .maximum = 100000},
    {.name = "seed",
     .argument = "N",
     .help = "seed of the first plant; the next ones count on (default: 1)",
     .kind = PLM_OPTION_SEED,
     AT(seed)},
    {.name = "scanner",
     .argument = "none|dome|rgbd|uniform|splat",
     .help = "dome: 325 scanners on a hemisphere; rgbd: depth views on a ring, fused; uniform: points on the surface, "
             "seen or not; splat: like gaussians fitted to photographs (default: dome)",
     .kind = PLM_OPTION_CHOICE,
     AT(scanner)},
    {.name = "points",
     .argument = "N",
     .help = "points on the plant (default: from --density)",
     .kind = PLM_OPTION_INTEGER,
     AT(points),
     .minimum = 1,
     .maximum = 100000000},
    {.name = "density",
     .argument = "HITS_PER_MM2",
     .help = "points on a mm2 of the plant (default: 0.1, and at least 60 000 points on the plant)",
     .kind = PLM_OPTION_NUMBER,
     AT(density),
     .minimum = 1e-6,
     .maximum = 1e4},
    {.name = "noise",
     .argument = "MM",
     .help = "standard deviation; rgbd: of depth at 0.4 m, growing with the square of range (default: 0.5 for rgbd and "
             "splat, else 0)",
     .kind = PLM_OPTION_NUMBER,
     AT(noise),
     .minimum = 0,
     .maximum = 100},
    {.name = "outliers",
     .argument = "SHARE",
     .help = "floaters as a share of the points (default: 0.01 for splat, else 0)",
     .kind = PLM_OPTION_NUMBER,
     AT(outliers),
     .minimum = 0,
     .maximum = 10},
    {.name = "views",
     .argument = "V",
     .help = "views of rgbd (default: 12) and splat (default: 60)",
     .kind = PLM_OPTION_INTEGER,
     AT(views),
     .minimum = 1,
     .maximum = 1024},
    {.name = "views-out",
     .help =
         "rgbd: write each view too, into DIR/PLANT.views: depth (16-bit PNG, 0.1 mm), colour, mask, and pose (JSON)",
     .kind = PLM_OPTION_FLAG,
     AT(has_views_out)},
    {.name = "image-width",
     .argument = "PIXELS",
     .help = "of rgbd's views, 16 to 9 (default: 960)",
     .kind = PLM_OPTION_INTEGER,
     AT(image_width),
     .minimum = 16,
     .maximum = 8192},
    {.name = "axis-tilt",
     .argument = "DEGREES",
     .help = "rgbd: how far the calibrated axis of the turntable leans from the true one (default: 0)",
     .kind = PLM_OPTION_NUMBER,
     AT(axis_tilt),
     .minimum = 0,
     .maximum = 45},
    {.name = "axis-shift",
     .argument = "MM",
     .help = "rgbd: how far it stands from the true one (default: 0)",
     .kind = PLM_OPTION_NUMBER,
     AT(axis_shift),
     .minimum = 0,
     .maximum = 1000},
    {.name = "pot", .help = "stand the plants in pots", .kind = PLM_OPTION_FLAG, AT(has_pot)},
    {.name = "table", .help = "stand them on a table", .kind = PLM_OPTION_FLAG, AT(has_table)},
    {.name = "resolution",
     .argument = "F",
     .help = "fineness of the plants' meshes (default: 1, about 5 000 faces a leaf)",
     .kind = PLM_OPTION_NUMBER,
     AT(resolution),
     .minimum = 0.02,
     .maximum = 8},
    {.name = "arched",
     .help = "seedlings: petioles leave the stem steeply and arch; okra and cucumber: deep sinuses; other kinds as "
             "without it",
     .kind = PLM_OPTION_FLAG,
     AT(is_arched)},
    {.name = "format",
     .argument = "ply|3dgs|pcd|xyz|csv",
     .help = "of the cloud without labels (default: ply)",
     .kind = PLM_OPTION_CHOICE,
     AT(format)},
    {.letter = 'q', .name = "quiet", .help = "print nothing but errors", .kind = PLM_OPTION_FLAG, AT(is_quiet)},
};

/* What is kept of each plant for the index and the table of readings. */
typedef struct simulated {
    char plant_id[96], file[112], labelled[112], truth[112];
    char kind[32];
    uint64_t seed;
    plm_scan scan; /* without its points */
} simulated;

static plm_scan_options scan_options(const simulate_settings *settings, uint64_t seed)
{
    const bool is_noisy = settings->scanner == PLM_SCANNER_RGBD || settings->scanner == PLM_SCANNER_SPLAT;
    return (plm_scan_options){
        .scanner = (plm_scanner)settings->scanner,
        .seed = seed,
        .points = (size_t)settings->points,
        .density = settings->density * 1e6,
        .noise = settings->noise >= 0 ? settings->noise * 1e-3
                 : is_noisy           ? 5e-4
                                      : 0,
        .outliers = settings->outliers >= 0                  ? settings->outliers
                    : settings->scanner == PLM_SCANNER_SPLAT ? 0.01
                                                             : 0,
        .has_pot = settings->has_pot,
        .has_table = settings->has_table,
        .views = settings->views,
        .image_width = settings->image_width,
        .axis_tilt = settings->axis_tilt * 3.14159265358979323846 / 180,
        .axis_shift = settings->axis_shift * 1e-3,
        .is_gaussians = settings->format == FORMAT_3DGS,
    };
}

/* eggplant_11_clean, pepper_22_rgbd_pot, okra_32_3dgs. */
static void name_plant(const simulate_settings *settings, simulated *row)
{
    static const char *const mode[] = {"mesh", "dome", "rgbd", "uniform", "splat"};
    const plm_scan_options scan = scan_options(settings, 0);
    const char *text = mode[settings->scanner];
    if (settings->scanner == PLM_SCANNER_DOME && scan.noise == 0 && scan.outliers == 0) text = "clean";
    if (settings->format == FORMAT_3DGS) text = "3dgs";
    snprintf(row->plant_id, sizeof row->plant_id, "%s_%llu_%s%s%s", row->kind, (unsigned long long)row->seed, text,
             settings->has_pot ? "_pot" : "", settings->has_table ? "_table" : "");
    static const char *const ending[] = {"ply", "ply", "pcd", "xyz", "csv"};
    snprintf(row->file, sizeof row->file, "%s.%s", row->plant_id, ending[settings->format]);
    snprintf(row->labelled, sizeof row->labelled, "%s.labelled.ply", row->plant_id);
    snprintf(row->truth, sizeof row->truth, "%s.truth.json", row->plant_id);
}

static plm_status path_of(const char *folder, const char *name, char path[4096], plm_error *error)
{
    if (snprintf(path, 4096, "%s/%s", folder, name) >= 4096)
        return plm_fail(error, PLM_E_ARGUMENT, "%.200s...: the path is too long", folder);
    return PLM_OK;
}

/* Hull of all faces: simulate/ knows no hulls. */
static plm_status add_hull(plm_virtual_plant *plant, plm_error *error)
{
    float(*point)[3] = plm_alloc(plant->mesh.vertex_count, sizeof *point, error);
    if (!point) return PLM_E_MEMORY;
    for (size_t k = 0; k < plant->mesh.vertex_count; k++)
        for (int i = 0; i < 3; i++) point[k][i] = (float)plant->mesh.vertex[k][i];
    const plm_status status = plm_convex_hull((const float(*)[3])point, plant->mesh.vertex_count,
                                              &plant->whole.hull_volume, &plant->whole.hull_area, NULL, error);
    plm_free(point);
    return status;
}

/* The cloud as a user would bring it. */
static plm_status write_plain(const char *path, plm_scan *scan, plm_error *error)
{
    if (scan->splat.rotation) return plm_scan_write(path, scan, false, error);
    uint8_t *label = scan->cloud.label;
    int32_t *organ = scan->cloud.organ;
    scan->cloud.label = NULL;
    scan->cloud.organ = NULL;
    const plm_status status = plm_cloud_write(path, &scan->cloud, error);
    scan->cloud.label = label;
    scan->cloud.organ = organ;
    return status;
}

static plm_status write_files(const simulate_settings *settings, const simulated *row, const plm_virtual_plant *plant,
                              plm_scan *scan, plm_error *error)
{
    char path[4096], mesh[112];
    snprintf(mesh, sizeof mesh, "%s.mesh.ply", row->plant_id);
    plm_status status = path_of(settings->output, mesh, path, error);
    if (status == PLM_OK) status = plm_virtual_plant_write(path, plant, error);
    if (status == PLM_OK) status = path_of(settings->output, row->truth, path, error);
    if (status == PLM_OK) status = plm_truth_write(path, row->plant_id, plant, scan, error);
    if (status != PLM_OK || !scan) return status;
    status = path_of(settings->output, row->file, path, error);
    if (status == PLM_OK) status = write_plain(path, scan, error);
    if (status == PLM_OK) status = path_of(settings->output, row->labelled, path, error);
    if (status == PLM_OK) status = plm_scan_write(path, scan, true, error);
    return status;
}

/* Keeps what the index tells of a scan. */
static void forget_points(plm_scan *scan)
{
    plm_scan light = *scan;
    light.cloud = (plm_cloud){0};
    light.leaflet = NULL;
    light.splat = (plm_gaussians){0};
    plm_scan_free(scan);
    *scan = light;
}

static plm_status make_plant(const simulate_settings *settings, simulated *row, char **readings, plm_error *error)
{
    plm_virtual_plant plant = {0};
    const plm_plant_options grow = {
        .seed = row->seed, .resolution = settings->resolution, .is_arched = settings->is_arched};
    plm_scan_options scan = scan_options(settings, row->seed);
    char views[4096];
    const bool has_scan = settings->scanner != PLM_SCANNER_NONE;
    plm_status status = PLM_OK;
    if (settings->has_views_out) {
        char name[112];
        snprintf(name, sizeof name, "%s.views", row->plant_id);
        status = path_of(settings->output, name, views, error);
        scan.views_folder = views;
    }
    if (status == PLM_OK) status = plm_plant_grow(row->kind, &grow, &plant, error);
    if (status == PLM_OK) status = add_hull(&plant, error);
    if (status == PLM_OK && has_scan) status = plm_scan_plant(&plant, &scan, &row->scan, error);
    row->scan.used.views_folder = NULL; /* it does not outlive this call */
    if (status == PLM_OK) status = write_files(settings, row, &plant, has_scan ? &row->scan : NULL, error);
    if (status == PLM_OK) status = plm_manual_readings(row->plant_id, &plant, row->seed, readings, error);
    if (status == PLM_OK && !settings->is_quiet)
        printf("%s: %zu faces, %zu leaves, %.1f mm high, %zu points\n", row->plant_id, plant.mesh.triangle_count,
               plant.leaf_count, 1000 * plant.whole.height, row->scan.cloud.count);
    forget_points(&row->scan);
    plm_virtual_plant_free(&plant);
    return status;
}

static plm_status write_index(const simulate_settings *settings, const simulated *rows, size_t count, plm_error *error)
{
    char path[4096];
    plm_truth_case *cases = plm_alloc(count, sizeof *cases, error);
    plm_status status = cases ? path_of(settings->output, "truth.json", path, error) : PLM_E_MEMORY;
    if (status == PLM_OK) {
        const bool has_scan = settings->scanner != PLM_SCANNER_NONE;
        for (size_t k = 0; k < count; k++)
            cases[k] = (plm_truth_case){rows[k].plant_id,
                                        has_scan ? rows[k].file : NULL,
                                        has_scan ? rows[k].labelled : NULL,
                                        rows[k].truth,
                                        rows[k].kind,
                                        rows[k].seed,
                                        has_scan ? &rows[k].scan : NULL};
        status = plm_truth_index_write(path, "simulated", cases, count, error);
    }
    plm_free(cases);
    return status;
}

static plm_status write_readings(const simulate_settings *settings, const char *readings, plm_error *error)
{
    char path[4096];
    plm_output *output;
    plm_status status = path_of(settings->output, "manual.csv", path, error);
    if (status == PLM_OK) status = plm_output_open(path, &output, error);
    if (status != PLM_OK) return status;
    status = plm_output_print(output, error, "plant_id,organ,organ_id,trait,value,unit\n%s", readings ? readings : "");
    const plm_status closed = plm_output_close(output, status == PLM_OK, error);
    return status == PLM_OK ? closed : status;
}

/* A plant that fails does not stop the others. */
static int simulate_all(const simulate_settings *settings, int kinds, char **kind)
{
    plm_error error = {0};
    char *readings = NULL;
    size_t done = 0, wanted = (size_t)kinds * (size_t)settings->count;
    int code = PLM_EXIT_GOOD;
    simulated *rows = plm_alloc_zero(wanted, sizeof *rows, &error);
    if (!rows) return plm_report_failure(PLM_E_MEMORY, &error);
    for (size_t k = 0; k < wanted; k++) {
        simulated *row = &rows[done];
        *row = (simulated){.seed = settings->seed + k % (size_t)settings->count};
        snprintf(row->kind, sizeof row->kind, "%s", kind[k / (size_t)settings->count]);
        name_plant(settings, row);
        const plm_status status = make_plant(settings, row, &readings, &error);
        if (status == PLM_OK) {
            done++;
            continue;
        }
        const int failure = plm_report_failure(status, &error);
        code = status == PLM_E_ARGUMENT || status == PLM_E_WRITE ? failure : PLM_EXIT_SOME_FAILED;
        if (code == failure) break; /* the others would fail alike */
    }
    plm_status status = done ? write_index(settings, rows, done, &error) : PLM_OK;
    if (status == PLM_OK && done) status = write_readings(settings, readings, &error);
    if (status != PLM_OK) code = plm_report_failure(status, &error);
    plm_free(readings);
    plm_free(rows);
    return code;
}

static int run(int argc, char **argv)
{
    simulate_settings settings = {
        .count = 1, .seed = 1, .scanner = PLM_SCANNER_DOME, .noise = -1, .outliers = -1, .resolution = 1};
    const int code = plm_parse_options(&plm_command_simulate, &argc, argv, &settings);
    if (code >= 0) return code;
    if (argc < 1) return plm_usage_error(&plm_command_simulate, "which KIND of plant?");
    if (!settings.output) return plm_usage_error(&plm_command_simulate, "--output is missing");
    if (settings.format == FORMAT_3DGS && settings.scanner != PLM_SCANNER_SPLAT)
        return plm_usage_error(&plm_command_simulate, "--format 3dgs needs --scanner splat");
    if (settings.scanner != PLM_SCANNER_RGBD &&
        (settings.has_views_out || settings.axis_tilt > 0 || settings.axis_shift > 0))
        return plm_usage_error(&plm_command_simulate, "--views-out, --axis-tilt and --axis-shift need --scanner rgbd");
    plm_error error = {0};
    const plm_status made = plm_folder_make(settings.output, &error);
    if (made != PLM_OK) return plm_report_failure(made, &error);
    return simulate_all(&settings, argc, argv);
}

const plm_command plm_command_simulate = {
    .name = "simulate",
    .arguments = "[OPTION]... -o DIR KIND...",
    .summary = "grow virtual plants, scan them, and write clouds with their truth",
    .description =
        "KIND is eggplant, pepper, okra, cucumber (seedlings), tomato, soybean, maize, arabidopsis, lettuce, "
        "single_leaf, "
        "bare_stem, or one of the plants of the laser-scanning paper: tomato_large, cucumber_large, maize_large, "
        "arabidopsis_large.\n\n"
        "For each plant DIR gets PLANT.ply (the cloud as a user would bring it), PLANT.labelled.ply (with label, organ "
        "and leaflet), PLANT.mesh.ply (its faces) and PLANT.truth.json (its true traits in metres and degrees); and "
        "for "
        "the run truth.json (an index) and manual.csv (readings as of ruler and protractor). --views-out adds "
        "PLANT.views/view_NN.depth.png, .colour.png, .mask.png and .json of each view.\n\n"
        "The same seed gives the same files, whatever the number of threads.",
    .options = options,
    .option_count = COUNT(options),
    .run = run};
