/* cloud/voxel_pitch.c: the spectrum of the coordinates, and its one narrow line. */
#include "cloud/voxel_pitch.h"

#include "cloud/linear.h"
#include "cloud/selection.h"
#include "cloud/subset.h"
#include "cloud/voxel.h"

#include <string.h>

enum {
    FEWEST = 256,      /* points that can show a line */
    SAMPLE = 4096,     /* points looked at, about: their chance line is 0.02 high */
    MOST_LINES = 6000, /* frequencies */
    REFINE_STEPS = 20, /* to either side */
    BESIDE = 40,       /* frequencies to either side that a line is compared with ... */
    LINE = 8           /* ... but for these, which it is wide */
};

/* The pitch is looked for between these, in spacings. Noise stacks voxels, so that more than one lies on a spacing squared. */
static const double finest = 0.7, coarsest = 3.5;
static const double lines_per_size = 4.0; /* a line is as wide as one period over the points' extent */
/* Sum over the axes of squared gathering, and its ratio to that of frequencies beside. Organs (a stem's x and y) have broad
 * spectra, grids a line, beside which a plant whose points are few and far apart has much. Voxel means of virtual depth cameras:
 * 0.1 to 0.8 and 4.5 to 300; where there is no grid, or a turned one, the power is below 0.04 everywhere. */
static const double least_power = 0.04, least_ratio = 4.0;
/* All three axes show the grid, or two show it well (see below): turned about one axis, it shows along that one alone (by 30
 * degrees: 0.28, the others 0.01). Least of the weakest axis, and of the middle one against the strongest; 0.047 and 0.7 in virtual scans. */
static const double least_line = 0.035, least_middle = 0.5;
/* Leaves that lie across an axis, thinner than a voxel, show nothing along that one where the other two show it well (scans with
 * little noise: 0.01 to 0.04 beside 0.5). Turned by 45 degrees, a grid shows as one of another pitch along two axes (0.4), but more
 * so along their diagonals. */
static const double least_of_two = 0.25, most_diagonal = 0.5;
/* So does a single depth image along its rows and columns, but it has one point a pixel: share of points that have another in the
 * same column of voxels across the two axes; 0.8 and more in virtual scans, 0.2 at most in images of uneven ground. */
static const double least_stacked = 0.5;
/* Mean gathering of the better two axes above which the coordinates are the grid's own. */
static const double own_grid = 0.95;
static const double least_noise = 0.12; /* of the pitch: depth cameras have 0.2 and more */

/* The sample's coordinates along one axis, of those points that lie within a stretch of it. */
typedef struct coordinates {
    size_t count;
    double *value;
} coordinates;

/** A wave at each point: cosine and sine. */
typedef struct phase {
    double cosine, sine;
} phase;

static phase phase_of(double turns)
{
    return (phase){cos(2 * PLM_PI * turns), sin(2 * PLM_PI * turns)};
}

static void add(phase *sum, phase wave)
{
    sum->cosine += wave.cosine;
    sum->sine += wave.sine;
}

static double squared_length(phase sum)
{
    return sum.cosine * sum.cosine + sum.sine * sum.sine;
}

/* Length of the mean wave. */
static double line_height(const coordinates *along, double frequency)
{
    phase sum = {0, 0};
    for (size_t i = 0; i < along->count; i++) add(&sum, phase_of(frequency * along->value[i]));
    return sqrt(squared_length(sum)) / (double)along->count;
}

static double power_at(const coordinates axis[3], double frequency)
{
    double power = 0;
    for (int k = 0; k < 3; k++) {
        const double height = line_height(&axis[k], frequency);
        power += height * height;
    }
    return power;
}

/* Power at frequencies low + i * step: each point's wave is turned on from one to the next. turn, wave: room for all points. */
static void measure_spectrum(const coordinates axis[3], double low, double step, size_t lines, phase *turn, phase *wave,
                             double *power)
{
    memset(power, 0, lines * sizeof *power);
    for (int k = 0; k < 3; k++) {
        const size_t n = axis[k].count;
        for (size_t i = 0; i < n; i++) {
            wave[i] = phase_of(low * axis[k].value[i]);
            turn[i] = phase_of(step * axis[k].value[i]);
        }
        for (size_t line = 0; line < lines; line++) {
            phase sum = {0, 0};
            for (size_t i = 0; i < n; i++) {
                const phase w = wave[i], t = turn[i];
                add(&sum, w);
                wave[i] = (phase){w.cosine * t.cosine - w.sine * t.sine, w.cosine * t.sine + w.sine * t.cosine};
            }
            power[line] += squared_length(sum) / ((double)n * (double)n);
        }
    }
}

/* Median power of the frequencies beside a line. */
static double power_beside(const double *power, size_t lines, size_t line)
{
    double beside[2 * BESIDE];
    size_t count = 0;
    for (size_t j = line > BESIDE ? line - BESIDE : 0; j < lines && j <= line + BESIDE; j++)
        if (j + LINE < line || j > line + LINE) beside[count++] = power[j];
    return count ? plm_select_quantile(beside, count, 0.5) : HUGE_VAL;
}

static size_t strongest_line(const double *power, size_t lines)
{
    size_t best = lines;
    for (size_t line = 0; line < lines; line++)
        if (power[line] >= least_power && (best == lines || power[line] > power[best]) &&
            power[line] >= least_ratio * power_beside(power, lines, line))
            best = line;
    return best;
}

/* The frequency within range of a line at which all coordinates gather most. */
static double refine(const coordinates axis[3], double frequency, double range, double enough)
{
    for (; range > enough; range /= REFINE_STEPS / 2) {
        double best = 0, most = -1;
        for (int i = -REFINE_STEPS; i <= REFINE_STEPS; i++) {
            const double power = power_at(axis, frequency + range * i / REFINE_STEPS);
            if (power > most) most = power, best = range * i / REFINE_STEPS;
        }
        frequency += best;
    }
    return frequency;
}

/* Leaves those coordinates that lie within a stretch of the given length about their median. */
static void keep_middle(coordinates *along, double length, double *scratch)
{
    memcpy(scratch, along->value, along->count * sizeof *scratch);
    const double middle = plm_select_quantile(scratch, along->count, 0.5);
    size_t kept = 0;
    for (size_t i = 0; i < along->count; i++)
        if (fabs(along->value[i] - middle) <= length / 2) along->value[kept++] = along->value[i];
    along->count = kept;
}

static double extent_of(const coordinates axis[3])
{
    double extent = 0;
    for (int k = 0; k < 3; k++) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (size_t i = 0; i < axis[k].count; i++) {
            low = fmin(low, axis[k].value[i]);
            high = fmax(high, axis[k].value[i]);
        }
        extent = fmax(extent, high - low);
    }
    return extent;
}

/* Length of the mean wave along the diagonals of two axes, whose period is that of a grid turned by 45 degrees; the larger one. */
static double diagonal_height(const coordinates *a, const coordinates *b, double frequency)
{
    phase sum = {0, 0}, difference = {0, 0};
    for (size_t i = 0; i < a->count; i++) {
        add(&sum, phase_of(frequency / 2 * (a->value[i] + b->value[i])));
        add(&difference, phase_of(frequency / 2 * (a->value[i] - b->value[i])));
    }
    return sqrt(fmax(squared_length(sum), squared_length(difference))) / (double)a->count;
}

/* Whether the coordinates gather at a frequency as voxel means do; axis: all of the same points. across: out, the axis that shows no
 * grid while the other two do; -1 where all do. */
static bool is_grid(const coordinates axis[3], double frequency, int *across)
{
    double height[3];
    int weakest = 0;
    for (int k = 0; k < 3; k++) {
        height[k] = line_height(&axis[k], frequency);
        if (height[k] < height[weakest]) weakest = k;
    }
    const int one = (weakest + 1) % 3, two = (weakest + 2) % 3;
    const double middle = fmin(height[one], height[two]), strongest = fmax(height[one], height[two]);
    *across = height[weakest] >= least_line ? -1 : weakest;
    if (middle < least_middle * strongest || (middle + strongest) / 2 > own_grid) return false;
    if (diagonal_height(&axis[one], &axis[two], frequency) > most_diagonal * middle) return false;
    return *across < 0 || middle >= least_of_two;
}

/* Share of points that have another in their column of voxels along an axis; 0 where the cloud is too large for voxels. */
static plm_status stacked_share(const float (*xyz)[3], size_t count, int along, double pitch, double *share,
                                plm_error *error)
{
    float(*flat)[3] = plm_alloc(count, sizeof *flat, error);
    plm_voxels columns = {0};
    *share = 0;
    if (!flat) return PLM_E_MEMORY;
    for (size_t i = 0; i < count; i++) {
        memcpy(flat[i], xyz[i], sizeof *flat);
        flat[i][along] = 0;
    }
    const plm_status status = plm_voxel_thin((const float(*)[3])flat, count, pitch, &columns, error);
    for (size_t v = 0; status == PLM_OK && v < columns.count; v++)
        if (columns.size[v] > 1) *share += columns.size[v] / (double)count;
    plm_voxels_free(&columns);
    plm_free(flat);
    return status == PLM_E_ARGUMENT ? PLM_OK : status;
}

/* part: the same points as whole, its own copy. phases: room for two of each point; scratch: for one and MOST_LINES + 2.
 * across: as is_grid. */
static double pitch_of(const coordinates whole[3], coordinates part[3], double spacing, phase *phases, double *scratch,
                       int *across)
{
    const double size = extent_of(whole), low = 1 / (coarsest * spacing), high = 1 / (finest * spacing);
    /* As many periods as there are frequencies for: a stretch of a large cloud shows the line as well. */
    const double length = fmin(size, MOST_LINES / (lines_per_size * (high - low)));
    if (!(length > 0) || !isfinite(size)) return 0;
    phase *turn = phases, *wave = phases + whole[0].count;
    const double step = 1 / (lines_per_size * length);
    for (int k = 0; k < 3; k++) keep_middle(&part[k], length, scratch);
    const size_t lines = (size_t)((high - low) / step) + 1;
    measure_spectrum(part, low, step, lines, turn, wave, scratch);
    const size_t line = strongest_line(scratch, lines);
    if (line == lines) return 0;
    const double frequency = refine(whole, low + step * (double)line, step, 0.01 / size);
    return is_grid(whole, frequency, across) ? 1 / frequency : 0;
}

plm_status plm_voxel_pitch_find(const float (*xyz)[3], size_t count, double spacing, double *pitch, plm_error *error)
{
    *pitch = 0;
    if (count < FEWEST || !(spacing > 0)) return PLM_OK;
    uint32_t *row = plm_alloc(count, sizeof *row, error);
    size_t taken = row ? plm_sample_rows(xyz, count, SAMPLE, row) : 0;
    if (taken > 2 * SAMPLE) taken = 2 * SAMPLE; /* many in one place are all taken or none */
    double *values = row ? plm_alloc(7 * taken + MOST_LINES + 2, sizeof *values, error) : NULL;
    phase *phases = values ? plm_alloc(2 * taken + 1, sizeof *phases, error) : NULL;
    plm_status status = phases ? PLM_OK : PLM_E_MEMORY;
    int across = -1;
    if (status == PLM_OK && taken >= FEWEST) {
        coordinates whole[3], part[3];
        for (size_t k = 0; k < 3; k++) {
            whole[k] = (coordinates){taken, values + 2 * k * taken};
            part[k] = (coordinates){taken, values + (2 * k + 1) * taken};
            for (size_t i = 0; i < taken; i++) whole[k].value[i] = part[k].value[i] = (double)xyz[row[i]][k];
        }
        *pitch = pitch_of(whole, part, spacing, phases, values + 6 * taken, &across);
    }
    if (*pitch > 0 && across >= 0) {
        double share;
        status = stacked_share(xyz, count, across, *pitch, &share, error);
        if (share < least_stacked) *pitch = 0;
    }
    plm_free(row);
    plm_free(values);
    plm_free(phases);
    return status;
}

void plm_voxel_gathering(const float (*xyz)[3], size_t count, double pitch, double gathering[3])
{
    const double n = (double)count;
    for (int k = 0; k < 3; k++) {
        phase sum = {0, 0};
        for (size_t i = 0; i < count; i++) add(&sum, phase_of((double)xyz[i][k] / pitch));
        /* Chance makes the squared length of the sum too large by one for each point. */
        const double squares = fmax(squared_length(sum) - n, 0);
        gathering[k] = count > 1 ? fmin(sqrt(squares / (n * (n - 1))), 1) : 0;
    }
}

plm_status plm_voxels_measure(const float (*xyz)[3], size_t count, plm_sampling *sampling, plm_error *error)
{
    sampling->pitch = sampling->gathering = 0;
    if (!sampling->fused) return PLM_OK;
    const plm_status status = plm_voxel_pitch_find(xyz, count, sampling->spacing, &sampling->pitch, error);
    /* A scan without noise that was thinned to voxel means ends where it ends, however many points a voxel had. */
    if (sampling->noise < least_noise * sampling->pitch) sampling->pitch = 0;
    if (status != PLM_OK || !(sampling->pitch > 0)) return status;
    double along[3];
    plm_voxel_gathering(xyz, count, sampling->pitch, along);
    sampling->gathering = (along[0] + along[1] + along[2] - fmin(along[0], fmin(along[1], along[2]))) / 2;
    return PLM_OK;
}
