/* tool/reading.c: options about inputs, and reading a cloud by them: file, unit, coordinate system. */
#include "tool/reading.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { UNIT_AUTO = 0 };
static const double unit_metres[] = {0, 1, 1e-2, 1e-3}; /* as the words of --unit */

const plm_option reading_options[READING_OPTION_COUNT] = {
    {.name = "up",
     .argument = "auto|x|y|z|-x|-y|-z",
     .help = "the axis of the file that points to zenith (default: auto, found out)",
     .kind = PLM_OPTION_CHOICE,
     .offset = offsetof(reading_settings, up)},
    {.name = "unit",
     .argument = "auto|m|cm|mm",
     .help = "unit of the file (default: auto: metres, unless the size is none that a plant has)",
     .kind = PLM_OPTION_CHOICE,
     .offset = offsetof(reading_settings, unit)},
    {.name = "scale",
     .argument = "F",
     .help = "metres per unit of the file",
     .kind = PLM_OPTION_NUMBER,
     .offset = offsetof(reading_settings, scale),
     .minimum = 1e-12,
     .maximum = 1e12},
    {.name = "known-length",
     .argument = "A,B,LENGTH",
     .help =
         "scale the file so that points A and B are LENGTH apart; a point is x:y:z in the file's coordinates, or the "
         "number of its row, from 0 on; e.g. 0:0:0,0:0:31.5,20cm",
     .kind = PLM_OPTION_TEXT,
     .offset = offsetof(reading_settings, known_length)},
    {.name = "scale-from",
     .argument = "pot:DIAMETER",
     .help = "scale the file so that the pot's rim has this outer diameter, e.g. pot:90mm",
     .kind = PLM_OPTION_TEXT,
     .offset = offsetof(reading_settings, scale_from)},
    {.name = "crs",
     .argument = "geodetic|utm:ZONE[N|S]",
     .help =
         "coordinates are longitude, latitude and height, or UTM; they are brought to a local east-north-up frame, and "
         "the tables get the plant's place",
     .kind = PLM_OPTION_TEXT,
     .offset = offsetof(reading_settings, crs)},
    {.name = "labels",
     .argument = "FIELD",
     .help = "use the labels in this field of the file (its name, or its number from 1 on) instead of segmenting",
     .kind = PLM_OPTION_TEXT,
     .offset = offsetof(reading_settings, labels)},
    {.name = "organs",
     .argument = "FIELD",
     .help = "field of the organ numbers beside the labels (default: organ)",
     .kind = PLM_OPTION_TEXT,
     .offset = offsetof(reading_settings, organs)},
    {.name = "label-scheme",
     .argument = "classes|instances",
     .help = "what labels mean: classes (0 other, 1 stem, 2 petiole, 3 leaf, 4 ground; the default), or one number an "
             "organ "
             "(see --stem-label)",
     .kind = PLM_OPTION_CHOICE,
     .offset = offsetof(reading_settings, label_scheme)},
    {.name = "stem-label",
     .argument = "N",
     .help = "number of the stem with --label-scheme instances (default: 0); every other number from 0 on is a leaf",
     .kind = PLM_OPTION_INTEGER,
     .offset = offsetof(reading_settings, stem_label)},
    {.name = "columns",
     .argument = "LIST",
     .help = "columns of text files, e.g. x,y,z,red,green,blue,label; - leaves one out (default: found out)",
     .kind = PLM_OPTION_TEXT,
     .offset = offsetof(reading_settings, columns)},
    {.name = "min-opacity",
     .argument = "F",
     .help = "drop gaussians of lower opacity (default: 0.005)",
     .kind = PLM_OPTION_NUMBER,
     .offset = offsetof(reading_settings, minimum_opacity),
     .minimum = 0,
     .maximum = 1},
    {.name = "splat-points",
     .argument = "1|5",
     .help = "points made of one gaussian: its centre, or the ends of its two long axes too (default: 1)",
     .kind = PLM_OPTION_CHOICE,
     .offset = offsetof(reading_settings, splat_points)},
};

/* ---- Checking --------------------------------------------------------------------------------------------------- */

/* "pot:90mm". */
static plm_status parse_scale_from(const char *text, double *diameter, plm_error *error)
{
    if (strncmp(text, "pot:", 4))
        return plm_fail(error, PLM_E_ARGUMENT, "--scale-from: \"%s\"; expected pot:DIAMETER, e.g. pot:90mm", text);
    const plm_status status = plm_parse_length(text + 4, diameter, error);
    if (status == PLM_OK && !(*diameter > 0))
        return plm_fail(error, PLM_E_ARGUMENT, "--scale-from: the pot's diameter must be more than 0");
    return status;
}

/** One end of a known length: a place, or a row of the file. */
typedef struct length_end {
    bool is_row;
    size_t row;
    double place[3];
} length_end;

static bool parse_end(const char *text, size_t length, length_end *end)
{
    char word[128];
    if (length == 0 || length >= sizeof word) return false;
    memcpy(word, text, length);
    word[length] = 0;
    if (strspn(word, "0123456789") == length && length < 18) {
        *end = (length_end){.is_row = true, .row = (size_t)strtoull(word, NULL, 10)};
        return true;
    }
    *end = (length_end){0};
    char *at = word;
    for (int axis = 0; axis < 3; axis++) {
        char *colon = strchr(at, ':');
        if ((axis < 2) != (colon != NULL)) return false;
        if (colon) *colon = 0;
        if (!plm_parse_number(at, &end->place[axis])) return false;
        if (colon) at = colon + 1;
    }
    return true;
}

static plm_status parse_known_length(const char *text, length_end end[2], double *metres, plm_error *error)
{
    const char *first = strchr(text, ','), *second = first ? strchr(first + 1, ',') : NULL;
    if (!second || !parse_end(text, (size_t)(first - text), &end[0]) ||
        !parse_end(first + 1, (size_t)(second - first - 1), &end[1]))
        return plm_fail(error, PLM_E_ARGUMENT,
                        "--known-length: \"%s\"; expected A,B,LENGTH with A and B as x:y:z or as row numbers, e.g. "
                        "0:0:0,0:0:31.5,20cm",
                        text);
    return plm_parse_length(second + 1, metres, error);
}

plm_status check_reading(const reading_settings *settings, plm_error *error)
{
    const int scales = (settings->unit != UNIT_AUTO) + (settings->scale != 0) + (settings->known_length != NULL) +
                       (settings->scale_from != NULL);
    if (scales > 1)
        return plm_fail(error, PLM_E_ARGUMENT,
                        "--unit, --scale, --known-length and --scale-from say the same thing; give one of them");
    if (settings->crs && scales)
        return plm_fail(error, PLM_E_ARGUMENT,
                        "with --crs the unit is known; leave out --unit, --scale, --known-length "
                        "and --scale-from");
    plm_status status = PLM_OK;
    plm_crs crs;
    length_end end[2];
    double metres;
    if (settings->crs) status = plm_crs_parse(settings->crs, &crs, error);
    if (status == PLM_OK && settings->known_length)
        status = parse_known_length(settings->known_length, end, &metres, error);
    if (status == PLM_OK && settings->scale_from) status = parse_scale_from(settings->scale_from, &metres, error);
    return status;
}

/* ---- Reading ---------------------------------------------------------------------------------------------------- */

static plm_status keep_coordinates(loaded_cloud *loaded, plm_error *error)
{
    const plm_cloud *cloud = &loaded->cloud;
    loaded->original = plm_alloc(cloud->count, sizeof *loaded->original, error);
    if (!loaded->original) return PLM_E_MEMORY;
    memcpy(loaded->original, cloud->xyz, cloud->count * sizeof *cloud->xyz);
    memcpy(loaded->original_origin, cloud->origin, sizeof cloud->origin);
    return PLM_OK;
}

/* Where an end lies, in the file's unit. Rows count as in the file, so dropped ones keep their numbers. */
static plm_status place_of(const plm_cloud *cloud, const length_end *end, double place[3], plm_error *error)
{
    memcpy(place, end->place, 3 * sizeof *place);
    if (!end->is_row) return PLM_OK;
    size_t i = end->row;
    for (i = cloud->source ? 0 : end->row; cloud->source && i < cloud->count && cloud->source[i] != end->row;) i++;
    if (i >= cloud->count)
        return plm_fail(error, PLM_E_ARGUMENT, "--known-length: row %zu is not among the %zu points that were read",
                        end->row, cloud->count);
    for (int axis = 0; axis < 3; axis++) place[axis] = cloud->origin[axis] + cloud->xyz[i][axis];
    return PLM_OK;
}

static plm_status scale_of_known_length(const plm_cloud *cloud, const char *text, plm_unit_scale *scale,
                                        plm_error *error)
{
    length_end end[2];
    double metres, place[2][3];
    plm_status status = parse_known_length(text, end, &metres, error);
    for (int i = 0; i < 2 && status == PLM_OK; i++) status = place_of(cloud, &end[i], place[i], error);
    return status == PLM_OK ? plm_scale_of_length(place[0], place[1], metres, scale, error) : status;
}

static plm_status find_scale(const reading_settings *settings, const plm_cloud *cloud, plm_format format,
                             plm_unit_scale *scale, plm_error *error)
{
    static const char *const units[] = {"", "m", "cm", "mm"};
    if (settings->scale_from) {
        double diameter;
        const plm_status status = parse_scale_from(settings->scale_from, &diameter, error);
        if (status != PLM_OK) return status;
        return plm_scale_of_pot(cloud, (plm_up)settings->up, diameter, scale, error);
    }
    if (settings->known_length) return scale_of_known_length(cloud, settings->known_length, scale, error);
    if (settings->unit != UNIT_AUTO) {
        *scale = (plm_unit_scale){.metres_per_unit = unit_metres[settings->unit], .unit = units[settings->unit]};
        snprintf(scale->evidence, sizeof scale->evidence, "given: --unit %s", scale->unit);
    } else if (settings->scale != 0) {
        *scale = (plm_unit_scale){.metres_per_unit = settings->scale, .unit = "?"};
        snprintf(scale->evidence, sizeof scale->evidence, "given: --scale %.9g", settings->scale);
    } else if (format == PLM_FORMAT_LAS || settings->crs) {
        *scale = (plm_unit_scale){.metres_per_unit = 1, .unit = "m"};
        snprintf(scale->evidence, sizeof scale->evidence, settings->crs ? "given: --crs" : "LAS files are in metres");
    } else {
        return plm_scale_guess(cloud, scale, error);
    }
    return PLM_OK;
}

static plm_status to_metres(const reading_settings *settings, loaded_cloud *loaded, plm_error *error)
{
    plm_status status = find_scale(settings, &loaded->cloud, loaded->report.format, &loaded->scale, error);
    if (status != PLM_OK) return status;
    plm_cloud_rescale(&loaded->cloud, loaded->scale.metres_per_unit);
    if (!settings->crs) return PLM_OK;
    plm_crs crs;
    status = plm_crs_parse(settings->crs, &crs, error);
    if (status == PLM_OK) status = plm_cloud_georeference(&loaded->cloud, &crs, &loaded->georeference, error);
    loaded->is_georeferenced = status == PLM_OK;
    return status;
}

plm_status load_cloud(const char *path, const reading_settings *settings, bool keep_original, loaded_cloud *loaded,
                      plm_error *error)
{
    const plm_read_options options = {.label_field = settings->labels,
                                      .organ_field = settings->organs,
                                      .label_scheme = (plm_label_scheme)settings->label_scheme,
                                      .stem_label = settings->stem_label,
                                      .columns = settings->columns,
                                      .minimum_opacity = settings->minimum_opacity,
                                      .splat_points = settings->splat_points ? 5 : 1};
    loaded_cloud made = {0};
    plm_status status = plm_cloud_read(path, &options, &made.cloud, &made.report, error);
    if (status == PLM_OK && made.cloud.count == 0)
        status = plm_fail(error, PLM_E_FORMAT, "%s: no point is left of %llu rows", path,
                          (unsigned long long)made.report.rows);
    if (status == PLM_OK && keep_original) status = keep_coordinates(&made, error);
    if (status == PLM_OK) status = to_metres(settings, &made, error);
    if (status == PLM_OK)
        *loaded = made;
    else
        free_loaded(&made);
    return status;
}

void free_loaded(loaded_cloud *loaded)
{
    plm_cloud_free(&loaded->cloud);
    plm_free(loaded->original);
    *loaded = (loaded_cloud){0};
}
