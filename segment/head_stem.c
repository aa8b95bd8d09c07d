/* segment/head_stem.c: what stands at the foot of a head is a short cylinder, and the leaves' feet lie around it. Where the
 * lines along level normals meet is its middle; from the lowest points there, circles are fitted step by step upwards,
 * until most of the way round there are leaves' feet instead. */
#include "segment/head.h"

#include "cloud/linear.h"
#include "segment/scale.h"
#include "segment/scratch.h"
#include "segment/stem_fit.h"

static const double FOOT = 0.4;      /* of the plant's height: the stem's middle is sought below */
static const double THICKEST = 0.07; /* radius of a stem over the plant's size, at most */
static const double LEVEL = 0.6;     /* |z| of a normal, at most, for its line to lead to the middle */
static const double RADIAL = 0.8;    /* cosine between such a normal and the way to the middle */
static const double STEP = 1.5,
                    WINDOW = 2; /* between circles, and half the height of what each is fitted to, in spacings */
static const double NEAR = 0.3; /* of the radius: points so near to the circle before are fitted */
static const double ON = 0.12;  /* of the radius: points so near to a circle lie on it */
static const double CHANGE = 0.25,
                    FIRST_CHANGE =
                        0.5;       /* of the radius from one circle to the next, at most; from the raster's guess */
static const double WIDENS = 1.15; /* a circle over the thinnest below, at most: leaves spread, stems taper */
enum { SECTORS = 12, FIRST_SECTORS = 8, LEAST_SECTORS = 5, RASTER = 512, CIRCLES = 200 };

typedef struct search {
    const plm_sheet_surface *surface;
    double noise, thickest, low, high;
    double corner[2], cell;
    int32_t size[2];
} search;

static plm_status search_start(search *s, plm_error *error)
{
    const size_t count = s->surface->thinned.count;
    float *value = plm_alloc(count, sizeof *value, error);
    if (!value) return PLM_E_MEMORY;
    double low[3], high[3], square = 0;
    for (int a = 0; a < 3; a++) {
        for (size_t i = 0; i < count; i++) value[i] = s->surface->thinned.xyz[i][a];
        low[a] = plm_quantile(value, count, 0.002);
        high[a] = plm_quantile(value, count, 0.998);
        square += (high[a] - low[a]) * (high[a] - low[a]);
    }
    plm_free(value);
    s->low = low[2];
    s->high = high[2];
    s->thickest = THICKEST * sqrt(square);
    s->cell = fmax(s->surface->spacing, fmax(high[0] - low[0], high[1] - low[1]) / (RASTER - 2));
    for (int a = 0; a < 2; a++) {
        s->corner[a] = low[a] - s->cell;
        s->size[a] = (int32_t)((high[a] - low[a]) / s->cell) + 3;
    }
    return PLM_OK;
}

/* Unit direction of a point's normal where it is level; false where it is not. */
static bool level_normal(const search *s, size_t i, double direction[2])
{
    const float *n = s->surface->normal[i];
    const double across = hypot(n[0], n[1]);
    if (fabs((double)n[2]) > LEVEL || !(across > 0)) return false;
    for (int a = 0; a < 2; a++) direction[a] = n[a] / across;
    return true;
}

/* The raster's cell where most lines of normals pass. */
static plm_status find_middle(const search *s, double middle[2], plm_error *error)
{
    const size_t cells = (size_t)s->size[0] * (size_t)s->size[1];
    uint32_t *votes = plm_alloc_zero(cells, sizeof *votes, error);
    if (!votes) return PLM_E_MEMORY;
    const double top = s->low + FOOT * (s->high - s->low);
    size_t best = 0;
    for (size_t i = 0; i < s->surface->thinned.count; i++) {
        const float *p = s->surface->thinned.xyz[i];
        double n[2];
        if (p[2] > top || !level_normal(s, i, n)) continue;
        for (double t = -s->thickest; t <= s->thickest; t += s->cell) {
            const double x = (p[0] + t * n[0] - s->corner[0]) / s->cell, y = (p[1] + t * n[1] - s->corner[1]) / s->cell;
            if (x >= 0 && y >= 0 && x < s->size[0] && y < s->size[1])
                votes[(size_t)x * (size_t)s->size[1] + (size_t)y]++;
        }
    }
    uint32_t most = 0;
    for (int32_t x = 1; x + 1 < s->size[0]; x++)
        for (int32_t y = 1; y + 1 < s->size[1]; y++) {
            uint32_t sum = 0;
            for (int32_t a = -1; a <= 1; a++)
                for (int32_t b = -1; b <= 1; b++) sum += votes[(size_t)(x + a) * (size_t)s->size[1] + (size_t)(y + b)];
            if (sum > most) {
                most = sum;
                best = (size_t)x * (size_t)s->size[1] + (size_t)y;
            }
        }
    middle[0] = s->corner[0] + ((double)(best / (size_t)s->size[1]) + 0.5) * s->cell;
    middle[1] = s->corner[1] + ((double)(best % (size_t)s->size[1]) + 0.5) * s->cell;
    plm_free(votes);
    return PLM_OK;
}

/* Lowest height near the middle, but for a few strays. */
static bool find_base(const search *s, const double middle[2], float *value, double *base)
{
    const double top = s->low + FOOT * (s->high - s->low);
    size_t near = 0;
    for (size_t i = 0; i < s->surface->thinned.count; i++) {
        const float *p = s->surface->thinned.xyz[i];
        if (p[2] < top && hypot(p[0] - middle[0], p[1] - middle[1]) < s->thickest) value[near++] = p[2];
    }
    if (near < 2 * SECTORS) return false;
    *base = plm_quantile(value, near, 0.02);
    return true;
}

/* The commonest distance from the middle among points whose normals lead there, low down. */
static double find_radius(const search *s, const double middle[2], double base)
{
    enum { BINS = 64 };
    double bin[BINS] = {0}, moment[BINS] = {0};
    const double width = s->thickest / BINS, top = base + 0.5 * s->thickest;
    for (size_t i = 0; i < s->surface->thinned.count; i++) {
        const float *p = s->surface->thinned.xyz[i];
        const double d[2] = {p[0] - middle[0], p[1] - middle[1]}, distance = hypot(d[0], d[1]);
        double n[2];
        if (p[2] > top || !(distance > 0 && distance < s->thickest) || !level_normal(s, i, n)) continue;
        if (fabs(n[0] * d[0] + n[1] * d[1]) < RADIAL * distance) continue;
        const int at = (int)fmin(distance / width, BINS - 1);
        bin[at]++;
        moment[at] += distance;
    }
    const int half = (int)ceil(s->surface->spacing / width);
    double most = 0, radius = 0;
    for (int b = 0; b < BINS; b++) {
        double sum = 0, distances = 0;
        for (int k = b - half; k <= b + half; k++) {
            if (k < 0 || k >= BINS) continue;
            sum += bin[k];
            distances += moment[k];
        }
        if (sum > most) {
            most = sum;
            radius = distances / sum;
        }
    }
    return radius;
}

/* How many of the sectors around a circle hold a point that lies on it, within a window of height. */
static int count_sectors(const search *s, const double circle[3], double height, double window, double tolerance)
{
    bool seen[SECTORS] = {false};
    int count = 0;
    for (size_t i = 0; i < s->surface->thinned.count; i++) {
        const float *p = s->surface->thinned.xyz[i];
        const double d[2] = {p[0] - circle[0], p[1] - circle[1]};
        double n[2];
        if (fabs(p[2] - height) > window || fabs(hypot(d[0], d[1]) - circle[2]) > tolerance) continue;
        if (!level_normal(s, i, n) || fabs(n[0] * d[0] + n[1] * d[1]) < RADIAL * hypot(d[0], d[1])) continue;
        seen[(int)((atan2(d[1], d[0]) / (2 * PLM_PI) + 1) * SECTORS) % SECTORS] = true;
    }
    for (int k = 0; k < SECTORS; k++) count += seen[k];
    return count;
}

/* Fits a circle to the points near the one given; no fit moves it by more than change. */
static bool fit_circle(const search *s, double height, double window, double change, double (*e)[2], double circle[3])
{
    size_t near = 0;
    const double reach = fmax(NEAR * circle[2], fmax(s->surface->spacing, 3 * s->noise));
    for (size_t i = 0; i < s->surface->thinned.count; i++) {
        const float *p = s->surface->thinned.xyz[i];
        const double d[2] = {p[0] - circle[0], p[1] - circle[1]};
        double n[2];
        if (fabs(p[2] - height) > window || fabs(hypot(d[0], d[1]) - circle[2]) > reach) continue;
        if (!level_normal(s, i, n)) continue;
        e[near][0] = d[0];
        e[near++][1] = d[1];
    }
    double x[3] = {0, 0, circle[2]};
    if (near < SECTORS || !plm_stem_circle((const double(*)[2])e, near, fmax(s->noise, 0.05 * circle[2]), reach, x))
        return false;
    if (fabs(x[2] - circle[2]) > change || hypot(x[0], x[1]) > change) return false;
    for (int a = 0; a < 2; a++) circle[a] += x[a];
    circle[2] = x[2];
    return true;
}

/* Circles from the base up, while there is a stem around them. */
static void follow(const search *s, double circle[3], double (*e)[2], plm_head_stem *stem)
{
    const double window = WINDOW * s->surface->spacing;
    for (int round = 0; round < 4; round++)
        if (!fit_circle(s, stem->base + window, window, fmax(FIRST_CHANGE * circle[2], s->cell), e, circle)) return;
    double thinnest = INFINITY;
    for (double z = stem->base; stem->count < CIRCLES && z < s->high; z += stem->step) {
        double next[3] = {circle[0], circle[1], circle[2]};
        const double tolerance = fmax(ON * circle[2], fmax(0.5 * s->surface->spacing, 2 * s->noise));
        if (!fit_circle(s, z, window, CHANGE * circle[2], e, next)) break;
        thinnest = fmin(thinnest, next[2]);
        if (next[2] > WIDENS * thinnest) break;
        if (count_sectors(s, next, z, window, tolerance) < (stem->count ? LEAST_SECTORS : FIRST_SECTORS)) break;
        for (int a = 0; a < 3; a++) stem->circle[stem->count][a] = circle[a] = next[a];
        stem->count++;
    }
}

plm_status plm_head_find_stem(const plm_sheet_surface *surface, double noise, plm_head_stem *stem, plm_error *error)
{
    search s = {.surface = surface, .noise = noise};
    double middle[2];
    plm_scratch scratch = {.error = error};
    plm_head_stem out = {.step = STEP * surface->spacing};
    float *value = plm_scratch_take(&scratch, surface->thinned.count, sizeof *value);
    double(*e)[2] = plm_scratch_take(&scratch, surface->thinned.count, sizeof *e);
    out.circle = plm_scratch_take(&scratch, CIRCLES, sizeof *out.circle);
    plm_status status = scratch.failed ? PLM_E_MEMORY : search_start(&s, error);
    if (status == PLM_OK) status = find_middle(&s, middle, error);
    if (status == PLM_OK && find_base(&s, middle, value, &out.base)) {
        double circle[3] = {middle[0], middle[1], find_radius(&s, middle, out.base)};
        if (circle[2] > 0) follow(&s, circle, e, &out);
    }
    plm_scratch_free(&scratch, status == PLM_OK ? out.circle : NULL);
    if (status == PLM_OK) *stem = out;
    return status;
}

void plm_head_stem_free(plm_head_stem *stem)
{
    plm_free(stem->circle);
    *stem = (plm_head_stem){0};
}

bool plm_head_is_stem(const plm_head_stem *stem, const float xyz[3], double tolerance)
{
    if (!stem->count) return false;
    const double place = (xyz[2] - stem->base) / stem->step;
    if (!(place < (double)stem->count - 0.5)) return false;
    const double *circle = stem->circle[place < 0 ? 0 : (size_t)(place + 0.5)];
    return hypot(xyz[0] - circle[0], xyz[1] - circle[1]) < circle[2] + tolerance;
}
