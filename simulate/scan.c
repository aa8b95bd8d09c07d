/* simulate/scan.c: options, the common end of all scans (noise, floaters, the cloud), and visibility. */
#include "simulate/scan.h"

#include <math.h>
#include <string.h>

#include "cloud/linear.h"
#include "cloud/random.h"

/* ---- Samples ---------------------------------------------------------------------------------------------------- */

plm_status plm_samples_add(plm_samples *samples, const plm_sample *sample, plm_error *error)
{
    if (samples->count == samples->room) {
        const size_t room = samples->room ? 2 * samples->room : 4096;
        plm_sample *larger = plm_realloc(samples->sample, room, sizeof *larger, error);
        if (!larger) return PLM_E_MEMORY;
        samples->sample = larger;
        samples->room = room;
    }
    samples->sample[samples->count++] = *sample;
    return PLM_OK;
}

static uint8_t channel(double value)
{
    return (uint8_t)fmin(fmax(value, 0), 255);
}

/* Made-up colours: greens that differ a little from organ to organ, paler stems, brown earth. */
static void colour(plm_label label, int32_t organ, uint32_t face, uint64_t seed, uint8_t rgb[3])
{
    static const double base[PLM_LABEL_COUNT][3] = {
        {178, 60, 45}, {125, 150, 80}, {120, 155, 75}, {70, 130, 55}, {110, 85, 65}};
    const uint64_t key = plm_key(seed, 40 + (uint64_t)label);
    for (int i = 0; i < 3; i++) {
        const double shade = 14 * plm_normal_at(key, (uint64_t)(organ + 1) * 3 + (uint64_t)i);
        const double grain = 6 * plm_normal_at(key, 1000 + (uint64_t)face);
        rgb[i] = channel(base[label][i] + shade + grain);
    }
}

void plm_sample_label(const plm_stage_set *stage, uint32_t face, const double direction[3], uint64_t seed,
                      plm_sample *sample)
{
    const bool is_plant = face < stage->plant_faces;
    double normal[3];
    plm_face_normal(&stage->mesh, face, normal);
    const double sign = direction && plm_dot(normal, direction) > 0 ? -1 : 1;
    for (int i = 0; i < 3; i++) sample->normal[i] = (float)(sign * normal[i]);
    sample->face = face;
    sample->label = is_plant ? stage->plant->face_label[face] : PLM_LABEL_GROUND;
    sample->organ = is_plant ? stage->plant->mesh.face_organ[face] : -1;
    sample->leaflet = is_plant ? stage->plant->face_leaflet[face] : -1;
    colour((plm_label)sample->label, sample->organ, face, seed, sample->rgb);
}

plm_status plm_add_floaters(const plm_stage_set *stage, double share, uint64_t seed, plm_samples *samples,
                            plm_error *error)
{
    const size_t real = samples->count, count = (size_t)(share * (double)real + 0.5);
    const uint64_t key = plm_key(seed, 11);
    plm_status status = PLM_OK;
    for (size_t k = 0; status == PLM_OK && k < count && real; k++) {
        plm_sample floater = {
            .face = PLM_NO_FACE, .label = PLM_LABEL_OTHER, .organ = -1, .leaflet = -1, .normal = {0, 0, 1}};
        const uint64_t at = 8 * k;
        if (k % 2) { /* within a few hundredths of the plant's size from one of its points */
            const plm_sample *near = &samples->sample[(size_t)(plm_uniform_at(key, at) * (double)real)];
            for (int i = 0; i < 3; i++)
                floater.xyz[i] =
                    near->xyz[i] + (float)(0.03 * stage->radius * plm_normal_at(key, 4 * k + 1 + (uint64_t)i));
        } else {
            for (int i = 0; i < 3; i++)
                floater.xyz[i] =
                    (float)(stage->centre[i] + 1.3 * stage->radius * (2 * plm_uniform_at(key, at + (uint64_t)i) - 1));
        }
        for (int i = 0; i < 3; i++) floater.rgb[i] = channel(60 + 140 * plm_uniform_at(key, at + 3 + (uint64_t)i));
        status = plm_samples_add(samples, &floater, error);
    }
    return status;
}

void plm_add_noise(plm_samples *samples, double sigma, uint64_t seed)
{
    const uint64_t key = plm_key(seed, 12);
    if (!(sigma > 0)) return;
    for (size_t k = 0; k < samples->count; k++)
        for (int i = 0; i < 3; i++)
            samples->sample[k].xyz[i] += (float)(sigma * plm_normal_at(key, 3 * k + (uint64_t)i));
}

/* ---- Visibility ------------------------------------------------------------------------------------------------- */

/* Faces of one organ: label, number and, for leaflets, the number within the leaf. */
typedef struct organ_key {
    plm_label label;
    int32_t organ, leaflet;
} organ_key;

static plm_status faces_of(const plm_virtual_plant *plant, const organ_key *key, plm_mesh *part, plm_error *error)
{
    size_t count = 0;
    *part = (plm_mesh){.vertex = plant->mesh.vertex, .vertex_count = plant->mesh.vertex_count};
    part->triangle = plm_alloc(plant->mesh.triangle_count, sizeof *part->triangle, error);
    if (!part->triangle) return PLM_E_MEMORY;
    for (size_t f = 0; f < plant->mesh.triangle_count; f++)
        if (plant->face_label[f] == key->label && plant->mesh.face_organ[f] == key->organ &&
            (key->leaflet == 0 || plant->face_leaflet[f] == key->leaflet))
            memcpy(part->triangle[count++], plant->mesh.triangle[f], sizeof *part->triangle);
    part->triangle_count = count;
    return PLM_OK;
}

static bool is_seen(const plm_stage_set *stage, const plm_mesh *part, uint32_t face, const double point[3],
                    const double (*position)[3], size_t count)
{
    double normal[3], off[3], direction[3];
    plm_face_normal(part, face, normal);
    for (size_t k = 0; k < count; k++) {
        for (int i = 0; i < 3; i++) direction[i] = position[k][i] - point[i];
        const double side = plm_dot(normal, direction) < 0 ? -1 : 1;
        for (int i = 0; i < 3; i++) { /* start a little off the face, so that it does not hide itself */
            off[i] = point[i] + side * 2e-5 * normal[i];
            direction[i] = position[k][i] - off[i];
        }
        plm_hit hit;
        if (!plm_rays_first(stage->rays, off, direction, 0, 1, &hit)) return true;
    }
    return false;
}

static plm_status organ_visibility(const plm_virtual_plant *plant, const plm_stage_set *stage, const organ_key *key,
                                   const double (*position)[3], size_t count, uint64_t seed, double *share,
                                   plm_error *error)
{
    enum { SAMPLES = 1000 };
    plm_mesh part;
    plm_face_sampler sampler = {0};
    plm_status status = faces_of(plant, key, &part, error);
    if (status == PLM_OK) status = plm_face_sampler_make(&part, part.triangle_count, &sampler, error);
    if (status == PLM_OK && part.triangle_count) {
        const uint64_t stream =
            plm_key(seed, 100 + (uint64_t)key->label + 10 * (uint64_t)key->organ + 100000 * (uint64_t)key->leaflet);
        int seen = 0;
#pragma omp parallel for schedule(static) reduction(+ : seen)
        for (int k = 0; k < SAMPLES; k++) {
            double point[3];
            const uint64_t at = 3 * (uint64_t)k;
            const uint32_t face =
                plm_face_sampler_draw(&sampler, plm_uniform_at(stream, at), plm_uniform_at(stream, at + 1),
                                      plm_uniform_at(stream, at + 2), point);
            seen += is_seen(stage, &part, face, point, position, count);
        }
        *share = (double)seen / SAMPLES;
    }
    plm_face_sampler_free(&sampler);
    plm_free(part.triangle);
    return status;
}

plm_status plm_visibility(plm_virtual_plant *plant, const plm_stage_set *stage, const double (*position)[3],
                          size_t count, uint64_t seed, plm_error *error)
{
    plm_status status = PLM_OK;
    for (size_t k = 0; status == PLM_OK && k < plant->stem_count; k++)
        status = organ_visibility(plant, stage, &(organ_key){PLM_LABEL_STEM, (int32_t)k, 0}, position, count, seed,
                                  &plant->stem[k].visible_fraction, error);
    for (size_t k = 0; status == PLM_OK && k < plant->petiole_count; k++)
        status = organ_visibility(plant, stage, &(organ_key){PLM_LABEL_PETIOLE, (int32_t)k, 0}, position, count, seed,
                                  &plant->petiole[k].visible_fraction, error);
    for (size_t k = 0; status == PLM_OK && k < plant->leaf_count; k++) {
        plm_true_leaf *leaf = &plant->leaf[k];
        status = organ_visibility(plant, stage, &(organ_key){PLM_LABEL_LEAF, (int32_t)k, 0}, position, count, seed,
                                  &leaf->visible_fraction, error);
        for (size_t j = 0; status == PLM_OK && j < leaf->leaflet_count; j++)
            status = organ_visibility(plant, stage, &(organ_key){PLM_LABEL_LEAF, (int32_t)k, (int32_t)j + 1}, position,
                                      count, seed, &plant->leaflet[leaf->first_leaflet + j].visible_fraction, error);
    }
    return status;
}

/* ---- The scan --------------------------------------------------------------------------------------------------- */

/** One row a scanner: where it sees from, and how it samples. */
typedef struct scanner_row {
    size_t (*positions)(const plm_stage_set *stage, const plm_scan_options *options, double (*position)[3]);
    plm_status (*scan)(const plm_stage_set *stage, const plm_scan_options *options, plm_samples *samples,
                       plm_scan *scan, plm_error *error);
} scanner_row;

static const scanner_row scanners[] = {
    [PLM_SCANNER_DOME] = {plm_dome_positions, plm_scan_dome},
    [PLM_SCANNER_RGBD] = {plm_ring_positions, plm_scan_rgbd},
    [PLM_SCANNER_UNIFORM] = {plm_dome_positions, plm_scan_uniform},
    [PLM_SCANNER_SPLAT] = {plm_splat_positions, plm_scan_splat},
};

static plm_status check(const plm_scan_options *options, plm_error *error)
{
    if (options->scanner <= PLM_SCANNER_NONE || options->scanner > PLM_SCANNER_SPLAT)
        return plm_fail(error, PLM_E_ARGUMENT, "scanner number %d is none", (int)options->scanner);
    if (!(options->noise >= 0 && options->noise < 1))
        return plm_fail(error, PLM_E_ARGUMENT, "noise of %g m; 0 to 1 was expected", options->noise);
    if (!(options->outliers >= 0 && options->outliers <= 10))
        return plm_fail(error, PLM_E_ARGUMENT, "outliers are %g of the points; 0 to 10 was expected",
                        options->outliers);
    if (!(options->density >= 0 && isfinite(options->density)))
        return plm_fail(error, PLM_E_ARGUMENT, "density of %g points per m2", options->density);
    if (options->image_width < 0 || options->image_width > 8192)
        return plm_fail(error, PLM_E_ARGUMENT, "images of %d pixels; 1 to 8192 was expected", options->image_width);
    if (!(fabs(options->axis_tilt) < 1 && fabs(options->axis_shift) < 10))
        return plm_fail(error, PLM_E_ARGUMENT, "an axis that is off by %g rad and %g m", options->axis_tilt,
                        options->axis_shift);
    if (options->views < 0 || options->views > PLM_POSITIONS_MAXIMUM)
        return plm_fail(error, PLM_E_ARGUMENT, "%d views; 1 to %d was expected", options->views, PLM_POSITIONS_MAXIMUM);
    return PLM_OK;
}

static plm_scan_options filled_in(const plm_virtual_plant *plant, const plm_scan_options *options)
{
    plm_scan_options filled = *options;
    const uint64_t key = plm_key(options->seed, 3);
    const bool is_splat = options->scanner == PLM_SCANNER_SPLAT;
    /* the paper's 0.1 hits per mm2 suits a plant of 1.2 m2; a seedling would have a few hundred points */
    if (!filled.points && filled.density == 0) filled.density = fmax(1e5, 60000 / plm_plant_area(plant));
    if (filled.dome_radius == 0) filled.dome_radius = 3.6;
    if (filled.views == 0) filled.views = is_splat ? 60 : 12;
    if (filled.elevation == 0) filled.elevation = plm_radians(15 + 25 * plm_uniform_at(key, 0));
    if (filled.image_width == 0) filled.image_width = 960;
    if (filled.distance == 0) /* 1.3 half sizes fill the view's shorter side */
        filled.distance =
            fmax(0.25 + 0.17 * plm_uniform_at(key, 2),
                 1.3 * fmax(plant->whole.width, plant->whole.height) * (1 + 0.25 * plm_uniform_at(key, 2)));
    if (filled.voxel == 0) filled.voxel = fmax(5e-4 + 5e-4 * plm_uniform_at(key, 3), 0.0018 * filled.distance);
    if (filled.misplacement == 0) filled.misplacement = 2e-4;
    if (filled.misrotation == 0) filled.misrotation = plm_radians(0.05);
    if (filled.thin_stem == 0) filled.thin_stem = 0.003;
    if (filled.unevenness == 0) filled.unevenness = 5 + 10 * plm_uniform_at(key, 1);
    return filled;
}

static void count_points(plm_virtual_plant *plant, const plm_samples *samples, plm_scan *scan)
{
    for (size_t k = 0; k < plant->stem_count; k++) plant->stem[k].points = 0;
    for (size_t k = 0; k < plant->petiole_count; k++) plant->petiole[k].points = 0;
    for (size_t k = 0; k < plant->leaf_count; k++) plant->leaf[k].points = 0;
    for (size_t k = 0; k < samples->count; k++) {
        const plm_sample *sample = &samples->sample[k];
        scan->class_points[sample->label]++;
        if (sample->label == PLM_LABEL_STEM) plant->stem[sample->organ].points++;
        if (sample->label == PLM_LABEL_PETIOLE) plant->petiole[sample->organ].points++;
        if (sample->label == PLM_LABEL_LEAF) plant->leaf[sample->organ].points++;
    }
}

static plm_status to_cloud(const plm_samples *samples, bool has_leaflets, bool has_normals, plm_scan *scan,
                           plm_error *error)
{
    const unsigned attributes = PLM_HAS_RGB | PLM_HAS_LABEL | PLM_HAS_ORGAN | (has_normals ? PLM_HAS_NORMAL : 0);
    plm_status status = plm_cloud_create(samples->count, attributes, &scan->cloud, error);
    if (status != PLM_OK) return status;
    if (has_leaflets) {
        scan->leaflet = plm_alloc(samples->count, sizeof *scan->leaflet, error);
        if (!scan->leaflet) return PLM_E_MEMORY;
    }
    for (size_t k = 0; k < samples->count; k++) {
        const plm_sample *sample = &samples->sample[k];
        memcpy(scan->cloud.xyz[k], sample->xyz, sizeof sample->xyz);
        memcpy(scan->cloud.rgb[k], sample->rgb, sizeof sample->rgb);
        if (has_normals) memcpy(scan->cloud.normal[k], sample->normal, sizeof sample->normal);
        scan->cloud.label[k] = sample->label;
        scan->cloud.organ[k] = sample->organ;
        if (has_leaflets) scan->leaflet[k] = sample->leaflet;
    }
    return PLM_OK;
}

plm_status plm_scan_plant(plm_virtual_plant *plant, const plm_scan_options *options, plm_scan *scan, plm_error *error)
{
    plm_scan made = {0};
    plm_stage_set stage = {0};
    plm_samples samples = {0};
    plm_status status = check(options, error);
    if (status != PLM_OK) return status;
    made.used = filled_in(plant, options);
    double(*position)[3] = plm_alloc(PLM_POSITIONS_MAXIMUM, sizeof *position, error);
    if (!position) status = PLM_E_MEMORY;
    if (status == PLM_OK) status = plm_stage_make(plant, &made.used, &stage, error);
    if (status == PLM_OK) {
        made.surroundings = stage.surroundings;
        status = scanners[made.used.scanner].scan(&stage, &made.used, &samples, &made, error);
    }
    if (status == PLM_OK)
        status = to_cloud(&samples, plant->leaflet_count > 0, made.splat.rotation != NULL, &made, error);
    if (status == PLM_OK) {
        const size_t count = scanners[made.used.scanner].positions(&stage, &made.used, position);
        status = plm_visibility(plant, &stage, (const double(*)[3])position, count, made.used.seed, error);
    }
    if (status == PLM_OK) {
        count_points(plant, &samples, &made);
        *scan = made;
    } else {
        plm_scan_free(&made);
    }
    plm_free(samples.sample);
    plm_stage_free(&stage);
    plm_free(position);
    return status;
}

void plm_scan_free(plm_scan *scan)
{
    if (!scan) return;
    plm_cloud_free(&scan->cloud);
    plm_free(scan->leaflet);
    plm_free(scan->splat.log_scale);
    plm_free(scan->splat.rotation);
    plm_free(scan->splat.logit_opacity);
    *scan = (plm_scan){0};
}
