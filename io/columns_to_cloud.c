/* io/columns_to_cloud.c: from columns of numbers to a cloud.
 *
 * Two passes over the rows: the first counts what is kept and finds bounds, the second converts. Rows go in spans, each
 * with its own counts, so that any number of threads gives the same cloud; a span's pages of a mapped file are handed
 * back when it is done, so that file and cloud are not both in memory. */
#include "io/columns.h"
#include "io/gaussian.h"
#include "io/labels.h"
#include "io/origin.h"
#include "io/plain_rows.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { SPAN = 1 << 16, STEP = 256 };

static const double default_minimum_opacity = 0.005; /* the threshold at which 3DGS training prunes gaussians */

/** What the first pass finds in one span of rows. */
typedef struct span_survey {
    size_t kept, not_finite, transparent, withheld;
    double low[3], high[3];
    double brightest; /* largest finite number of the colour columns */
    size_t bad_label; /* first row whose label is not of the scheme; SIZE_MAX: none */
} span_survey;

typedef struct conversion {
    const plm_columns *columns;
    const plm_roles *roles;
    const plm_bytes *bytes;
    const plm_read_options *options;
    double minimum_opacity;
    double colour_factor;
    size_t points_a_row;
    size_t span_count;
    span_survey *spans;
    plm_cloud cloud;
} conversion;

/** STEP rows of every role, and which of them are kept. */
typedef struct step_rows {
    double value[PLM_ROLE_COUNT][STEP];
    uint16_t kept[STEP];
    size_t kept_count;
    plm_gaussian gaussian[STEP]; /* of splats: one a kept row */
} step_rows;

static void load_roles(const conversion *work, plm_role first_role, plm_role last_role, size_t first, size_t count,
                       step_rows *rows)
{
    for (plm_role role = first_role; role <= last_role; role++)
        if (work->roles->column[role]) plm_column_load(work->roles->column[role], first, count, rows->value[role]);
}

static bool gaussian_at(const step_rows *rows, size_t i, plm_gaussian *gaussian)
{
    double log_scale[3], rotation[4];
    for (int k = 0; k < 3; k++) log_scale[k] = rows->value[PLM_ROLE_SCALE_0 + k][i];
    for (int k = 0; k < 4; k++) rotation[k] = rows->value[PLM_ROLE_ROTATION_0 + k][i];
    return plm_gaussian_decode(rows->value[PLM_ROLE_OPACITY][i], log_scale, rotation, gaussian);
}

/* Loads what decides about keeping rows, decides, and counts into survey. */
static void choose_rows(const conversion *work, size_t first, size_t count, step_rows *rows, span_survey *survey)
{
    load_roles(work, PLM_ROLE_X, PLM_ROLE_Z, first, count, rows);
    load_roles(work, PLM_ROLE_WITHHELD, PLM_ROLE_WITHHELD, first, count, rows);
    if (work->roles->is_splat) load_roles(work, PLM_ROLE_OPACITY, PLM_ROLE_ROTATION_3, first, count, rows);
    const double *x = rows->value[PLM_ROLE_X], *y = rows->value[PLM_ROLE_Y], *z = rows->value[PLM_ROLE_Z];
    rows->kept_count = 0;
    for (size_t i = 0; i < count; i++) {
        bool is_finite = fabs(x[i]) <= PLM_FARTHEST && fabs(y[i]) <= PLM_FARTHEST && fabs(z[i]) <= PLM_FARTHEST;
        plm_gaussian *gaussian = &rows->gaussian[rows->kept_count];
        if (is_finite && work->roles->is_splat) is_finite = gaussian_at(rows, i, gaussian);
        if (!is_finite) {
            survey->not_finite++;
        } else if (work->roles->column[PLM_ROLE_WITHHELD] && rows->value[PLM_ROLE_WITHHELD][i] != 0) {
            survey->withheld++;
        } else if (work->roles->is_splat && gaussian->opacity < work->minimum_opacity) {
            survey->transparent++;
        } else {
            rows->kept[rows->kept_count++] = (uint16_t)i;
        }
    }
    survey->kept += rows->kept_count;
}

static void survey_bounds(const step_rows *rows, span_survey *survey)
{
    for (int axis = 0; axis < 3; axis++) {
        const double *value = rows->value[PLM_ROLE_X + axis];
        double low = survey->low[axis], high = survey->high[axis];
        for (size_t j = 0; j < rows->kept_count; j++) {
            const double at = value[rows->kept[j]];
            low = at < low ? at : low;
            high = at > high ? at : high;
        }
        survey->low[axis] = low;
        survey->high[axis] = high;
    }
}

static bool is_byte_colour(const plm_roles *roles)
{
    for (plm_role role = PLM_ROLE_RED; role <= PLM_ROLE_BLUE; role++)
        if (!roles->column[role] || roles->column[role]->type != PLM_UINT8) return false;
    return true;
}

static size_t span_rows(const conversion *work, size_t span)
{
    const size_t left = work->columns->rows - span * SPAN;
    return left < SPAN ? left : SPAN;
}

/* The pages of a span are not needed again. Only true of columns that lie in the file itself. */
static void drop_span(const conversion *work, size_t span)
{
    const plm_column *x = work->roles->column[PLM_ROLE_X];
    plm_bytes_drop(work->bytes, x->data + span * SPAN * x->stride, (span_rows(work, span) - 1) * x->stride);
}

static void survey_colours(const conversion *work, size_t span, step_rows *rows, span_survey *survey)
{
    const size_t end = span * SPAN + span_rows(work, span);
    for (size_t first = span * SPAN; first < end; first += STEP) {
        const size_t count = end - first < STEP ? end - first : STEP;
        load_roles(work, PLM_ROLE_RED, PLM_ROLE_BLUE, first, count, rows);
        for (plm_role role = PLM_ROLE_RED; role <= PLM_ROLE_BLUE; role++)
            for (size_t i = 0; i < count; i++)
                if (rows->value[role][i] > survey->brightest && rows->value[role][i] <= DBL_MAX)
                    survey->brightest = rows->value[role][i];
    }
}

static void survey_span(const conversion *work, size_t span)
{
    const span_survey none = {
        .low = {INFINITY, INFINITY, INFINITY}, .high = {-INFINITY, -INFINITY, -INFINITY}, .bad_label = SIZE_MAX};
    const size_t begin = span * SPAN, end = begin + span_rows(work, span);
    span_survey survey = none;
    step_rows rows;
    if (plm_plain_places_are(work->roles) &&
        plm_plain_bounds(work->roles, begin, end - begin, survey.low, survey.high)) {
        survey.kept = end - begin;
    } else {
        survey = none;
        for (size_t first = begin; first < end; first += STEP) {
            choose_rows(work, first, end - first < STEP ? end - first : STEP, &rows, &survey);
            survey_bounds(&rows, &survey);
        }
    }
    if (work->roles->column[PLM_ROLE_RED] && !is_byte_colour(work->roles)) survey_colours(work, span, &rows, &survey);
    work->spans[span] = survey;
}

/* Colours come as 0 to 1, 0 to 255 or 0 to 65535. Whole numbers that the file declares as such are never 0 to 1. */
static double colour_factor(const plm_roles *roles, double brightest)
{
    const plm_column *red = roles->column[PLM_ROLE_RED];
    if (!red || is_byte_colour(roles)) return 1;
    if (brightest > 255) return 255.0 / 65535.0;
    return brightest <= 1 && !red->is_whole ? 255 : 1;
}

static uint8_t byte_of(double value)
{
    return value >= 255 ? 255 : value > 0 ? (uint8_t)(value + 0.5) : 0; /* NaN: 0 */
}

static void store_colour(const conversion *work, const step_rows *rows, size_t i, const plm_gaussian *gaussian,
                         uint8_t rgb[3])
{
    if (gaussian) {
        for (int k = 0; k < 3; k++) rgb[k] = byte_of(plm_gaussian_colour(rows->value[PLM_ROLE_DC_0 + k][i]));
    } else if (work->roles->column[PLM_ROLE_RED]) {
        for (int k = 0; k < 3; k++) rgb[k] = byte_of(rows->value[PLM_ROLE_RED + k][i] * work->colour_factor);
    } else {
        const double stored = rows->value[PLM_ROLE_PACKED_COLOUR][i];
        const uint32_t packed = stored >= 0 && stored <= UINT32_MAX ? (uint32_t)stored : 0;
        for (int k = 0; k < 3; k++) rgb[k] = (uint8_t)(packed >> (16 - 8 * k));
    }
}

static void store_normal(const step_rows *rows, size_t i, const plm_gaussian *gaussian, float normal[3])
{
    double n[3], length = 0;
    for (int k = 0; k < 3; k++) {
        n[k] = gaussian ? gaussian->normal[k] : rows->value[PLM_ROLE_NX + k][i];
        length += n[k] * n[k];
    }
    length = sqrt(length);
    for (int k = 0; k < 3; k++) normal[k] = length > 0 && length <= DBL_MAX ? (float)(n[k] / length) : 0.0f;
}

static void store_splat(const step_rows *rows, size_t i, const plm_gaussian *gaussian, plm_cloud *cloud, size_t at)
{
    for (int k = 0; k < 2; k++)
        cloud->extent[at][k] = (float)(gaussian ? gaussian->extent[k] : rows->value[PLM_ROLE_EXTENT_0 + k][i]);
    cloud->opacity[at] = (float)(gaussian ? gaussian->opacity : rows->value[PLM_ROLE_OPACITY][i]);
}

/* The centre, then centre + and - one standard deviation along the two long axes. */
static void store_place(const plm_cloud *cloud, const step_rows *rows, size_t i, size_t piece,
                        const plm_gaussian *gaussian, float xyz[3])
{
    for (int axis = 0; axis < 3; axis++) {
        double at = rows->value[PLM_ROLE_X + axis][i] - cloud->origin[axis];
        if (piece) {
            const size_t along = (piece - 1) / 2;
            const double step = gaussian->extent[along] * gaussian->axis[along][axis];
            at += piece % 2 ? step : -step;
        }
        xyz[axis] = (float)at;
    }
}

static void store_labels(const conversion *work, const step_rows *rows, size_t first, size_t at, span_survey *survey)
{
    const bool has_organ = work->roles->column[PLM_ROLE_ORGAN] != NULL;
    plm_cloud cloud = work->cloud; /* the arrays are the same */
    for (size_t j = 0; j < rows->kept_count; j++) {
        const size_t i = rows->kept[j];
        const double organ = has_organ ? rows->value[PLM_ROLE_ORGAN][i] : NAN;
        for (size_t piece = 0; piece < work->points_a_row; piece++)
            if (!plm_label_store(work->options->label_scheme, rows->value[PLM_ROLE_LABEL][i], organ, &cloud,
                                 at + j * work->points_a_row + piece) &&
                survey->bad_label == SIZE_MAX)
                survey->bad_label = first + i;
    }
}

/* Converts the kept rows of one step into the arrays that `to` has; at is the point that the first of them becomes. */
static void convert_step(const conversion *work, size_t first, const step_rows *rows, plm_cloud *to, size_t at)
{
    for (size_t j = 0; j < rows->kept_count; j++) {
        const size_t i = rows->kept[j];
        const plm_gaussian *gaussian = work->roles->is_splat ? &rows->gaussian[j] : NULL;
        for (size_t piece = 0; piece < work->points_a_row; piece++, at++) {
            if (to->xyz) store_place(to, rows, i, piece, gaussian, to->xyz[at]);
            if (to->rgb) store_colour(work, rows, i, gaussian, to->rgb[at]);
            if (to->normal) store_normal(rows, i, gaussian, to->normal[at]);
            if (to->extent) store_splat(rows, i, gaussian, to, at);
            if (to->source) to->source[at] = (uint32_t)(first + i);
        }
    }
}

/* Copies what can be copied as it stands, and takes it out of `to`. Step by step, so that the rows are in the cache when
 * their colours are copied. */
static void convert_plain(const conversion *work, size_t span, plm_cloud *to, size_t at)
{
    const size_t begin = span * SPAN, rows = span_rows(work, span);
    if (work->spans[span].kept != rows) return;
    const bool has_places = plm_plain_places_are(work->roles);
    const bool has_colours = to->rgb && plm_plain_colours_are(work->roles);
    for (size_t done = 0; done < rows; done += STEP) {
        const size_t count = rows - done < STEP ? rows - done : STEP;
        if (has_places) plm_plain_places(work->roles, begin + done, count, to->origin, to->xyz + at + done);
        if (has_colours) plm_plain_colours(work->roles, begin + done, count, to->rgb + at + done);
    }
    if (has_places) to->xyz = NULL;
    if (has_colours) to->rgb = NULL;
}

static void convert_span(const conversion *work, size_t span)
{
    span_survey *survey = &work->spans[span], again = *survey;
    plm_cloud to = work->cloud;
    size_t at = 0;
    for (size_t before = 0; before < span; before++) at += work->spans[before].kept * work->points_a_row;
    convert_plain(work, span, &to, at);
    const size_t end = span * SPAN + span_rows(work, span);
    for (size_t first = span * SPAN; first < end && (to.xyz || plm_cloud_attributes(&to)); first += STEP) {
        step_rows rows;
        const size_t count = end - first < STEP ? end - first : STEP;
        choose_rows(work, first, count, &rows, &again);
        load_roles(work, PLM_ROLE_RED, PLM_ROLE_EXTENT_1, first, count, &rows);
        load_roles(work, PLM_ROLE_OPACITY, PLM_ROLE_DC_2, first, count, &rows);
        load_roles(work, PLM_ROLE_LABEL, PLM_ROLE_ORGAN, first, count, &rows);
        convert_step(work, first, &rows, &to, at);
        if (to.label) store_labels(work, &rows, first, at, survey);
        at += rows.kept_count * work->points_a_row;
    }
    if (survey->bad_label == SIZE_MAX) drop_span(work, span); /* else the message shows the label */
}

static span_survey survey_all(const conversion *work)
{
#pragma omp parallel for schedule(dynamic) if (work->span_count > 1)
    for (size_t span = 0; span < work->span_count; span++) survey_span(work, span);
    span_survey all = work->spans[0];
    for (size_t span = 1; span < work->span_count; span++) {
        const span_survey *one = &work->spans[span];
        all.kept += one->kept;
        all.not_finite += one->not_finite;
        all.transparent += one->transparent;
        all.withheld += one->withheld;
        all.brightest = fmax(all.brightest, one->brightest);
        for (int axis = 0; axis < 3; axis++) {
            all.low[axis] = fmin(all.low[axis], one->low[axis]);
            all.high[axis] = fmax(all.high[axis], one->high[axis]);
        }
    }
    return all;
}

static unsigned attributes_of(const conversion *work, const span_survey *all)
{
    const plm_column *const *column = work->roles->column;
    unsigned wanted = 0;
    /* Point formats of LAS have colours whether the scanner saw any: all black is none. */
    const bool is_coloured = column[PLM_ROLE_RED] && (is_byte_colour(work->roles) || all->brightest > 0);
    if (work->roles->is_splat || is_coloured || column[PLM_ROLE_PACKED_COLOUR]) wanted |= PLM_HAS_RGB;
    if (work->roles->is_splat || column[PLM_ROLE_NX]) wanted |= PLM_HAS_NORMAL;
    if (work->roles->is_splat || column[PLM_ROLE_EXTENT_0]) wanted |= PLM_HAS_EXTENT | PLM_HAS_OPACITY;
    if (column[PLM_ROLE_LABEL]) wanted |= PLM_HAS_LABEL;
    if (column[PLM_ROLE_ORGAN] || (column[PLM_ROLE_LABEL] && work->options->label_scheme == PLM_LABELS_INSTANCES))
        wanted |= PLM_HAS_ORGAN;
    if (all->kept != work->columns->rows || work->points_a_row > 1) wanted |= PLM_HAS_SOURCE;
    return wanted;
}

/* Names the row whose label or organ is not of the scheme. */
static plm_status bad_label(const conversion *work, size_t row, plm_error *error)
{
    const plm_column *organs = work->roles->column[PLM_ROLE_ORGAN];
    double label, organ = 0;
    plm_column_load(work->roles->column[PLM_ROLE_LABEL], row, 1, &label);
    if (work->options->label_scheme == PLM_LABELS_INSTANCES)
        return plm_fail(error, PLM_E_FORMAT, "%s: point %zu: label %g, a whole number of 32 bits was expected",
                        work->bytes->name, row + 1, label);
    if (organs) plm_column_load(organs, row, 1, &organ);
    if (organ != floor(organ) || organ > INT32_MAX)
        return plm_fail(error, PLM_E_FORMAT, "%s: point %zu: organ %g, a whole number of 32 bits was expected",
                        work->bytes->name, row + 1, organ);
    return plm_fail(
        error, PLM_E_FORMAT,
        "%s: point %zu: label %g; 0 other, 1 stem, 2 petiole, 3 leaf or 4 ground was expected (the label scheme "
        "`instances` reads one number an organ)",
        work->bytes->name, row + 1, label);
}

static plm_status convert_all(conversion *work, plm_error *error)
{
#pragma omp parallel for schedule(dynamic) if (work->span_count > 1)
    for (size_t span = 0; span < work->span_count; span++) convert_span(work, span);
    for (size_t span = 0; span < work->span_count; span++) {
        const size_t row = work->spans[span].bad_label;
        if (row == SIZE_MAX) continue;
        return bad_label(work, row, error);
    }
    if (work->cloud.label && work->options->label_scheme == PLM_LABELS_INSTANCES)
        return plm_labels_from_instances(&work->cloud, work->options->stem_label, work->bytes->name, error);
    return PLM_OK;
}

static plm_status check_kept(const conversion *work, const span_survey *all, plm_error *error)
{
    if (all->kept) return PLM_OK;
    return plm_fail(error, PLM_E_FORMAT,
                    "%s: none of its %zu points is usable: %zu are not finite, %zu are transparent, %zu are marked as "
                    "deleted",
                    work->bytes->name, work->columns->rows, all->not_finite, all->transparent, all->withheld);
}

plm_status plm_columns_to_cloud(const plm_columns *columns, const plm_roles *roles, const plm_bytes *bytes,
                                const plm_read_options *options, plm_cloud *cloud, plm_read_report *report,
                                plm_error *error)
{
    conversion work = {.columns = columns, .roles = roles, .bytes = bytes, .options = options};
    work.minimum_opacity = options->minimum_opacity > 0 ? options->minimum_opacity : default_minimum_opacity;
    work.points_a_row = roles->is_splat && options->splat_points == 5 ? 5 : 1;
    work.span_count = (columns->rows + SPAN - 1) / SPAN;
    if (columns->rows == 0) return plm_fail(error, PLM_E_FORMAT, "%s: holds no points", bytes->name);
    work.spans = plm_alloc(work.span_count, sizeof *work.spans, error);
    if (!work.spans) return PLM_E_MEMORY;
    const span_survey all = survey_all(&work);
    plm_status status = check_kept(&work, &all, error);
    if (status == PLM_OK)
        status = plm_cloud_create(all.kept * work.points_a_row, attributes_of(&work, &all), &work.cloud, error);
    if (status == PLM_OK) {
        plm_choose_origin(columns, roles, all.low, all.high, work.cloud.origin);
        work.colour_factor = colour_factor(roles, all.brightest);
        status = convert_all(&work, error);
    }
    if (status == PLM_OK) {
        *cloud = work.cloud;
        report->rows = columns->rows;
        report->dropped_not_finite = all.not_finite;
        report->dropped_transparent = all.transparent;
        report->dropped_withheld = all.withheld;
    } else {
        plm_cloud_free(&work.cloud);
    }
    plm_free(work.spans);
    return status;
}
