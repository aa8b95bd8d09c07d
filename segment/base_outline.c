/* segment/base_outline.c: the place of the junction by the outline of the blade's base. Flattened, the petiole is a strip
 * that ends at the junction, and each side of the blade begins there: as a wedge ahead of it (a base that narrows to the
 * petiole), straight to the side, or with a lobe that reaches back and whose edge leaves the petiole by a slope and bends
 * away. The points are taken for a Poisson process whose density is that of the petiole in the strip, of the blade within
 * the outline, and little elsewhere, all blurred as points lie off along the blade (the strip's width and the outlines'
 * swelling go by the noise across); the junction is the mean over what is likely, all outlines of either side taken
 * together by their shares among the plant's leaves (base_shares.c): the likeliest alone jumps between
 * them. The first guess is good or, where deep lobes lie beside the petiole, far too early: its errors follow a Cauchy law.
 * Where the noise is small beside the petiole, that a tube is thick and a blade is not counts as well (base_thickness.c). */
#include "segment/blade_base.h"

#include "segment/scratch.h"

#include <math.h>
#include <string.h>

/* Lengths in R. */
static const double BACK = 3;                           /* what of the leaf is looked at, to ROWS steps along */
static const double STEP = 1.0 / 24, COLUMN = 1.0 / 18; /* of the pixels along and across */
static const double EXPECTED_OFF = 0.25; /* half width of the first guess's errors, in lengths of petiole seen */
static const double PETIOLE_FROM = -2.6, PETIOLE_TO = -0.4; /* these give the densities */
static const double SHORTEST = 0.35;                        /* petiole that tells its density */
static const double BLADE_FROM = 0.55, BLADE_TO = 1.8, BLADE_SIDE = 0.45;
static const double SHARPEST = 0.04;  /* blur, at least */
static const double ELSEWHERE = 0.03; /* density beside the leaf, of the blade's */
static const double FAINTEST = 0.1;   /* density of the petiole, of the blade's, at least, before voxels fill it */
/* Weight of the thickness: midribs are thick for a while, and neighbours' heights are not independent. */
static const double THICKNESS = 0.3;
/* Logarithm of how much likelier a change is than none, at least, where nothing else tells. */
static const double THICKNESS_TELLS = 5;
static const double SWOLLEN = 0.5; /* SDs of the noise by which an outline seems to lie outward */
/* Outlines: half width of the blade over the way ahead; slope of a lobe's edge, and its curvature over R. */
static const double WEDGE[] = {0.5, 0.8, 1.2, 1.8, 3, 6, INFINITY};
static const double ROUND[] = {0.15, 0.3, 0.6, 1.2, 2.4};
static const double SLOPE[] = {0.3, 0.4, 0.5, 0.65, 0.85, 1.1, 1.5, 2.2, 3.5};
static const double BEND[] = {0, 0.12, 0.25, 0.5, 0.9};
/* Where the blade's width is told: from so far before the first guess on, in windows of two such bins. */
static const double WIDTH_FROM = -1, WIDTH_BIN = 0.25;
/* Points of such a window, of the fullest: among fewer a stray one makes it wide. */
static const double FULL_ENOUGH = 0.2;
/* What of a narrow blade tells its direction, and by how much (radians) it is turned at most: what lies farther aside is bent. */
static const double TURN_FROM = 0.1, TURN_TO = 2.75, TURN_MOST = 0.8;
enum {
    WIDTH_BINS = 15,
    WEDGES = sizeof WEDGE / sizeof *WEDGE,
    ROUNDS = sizeof ROUND / sizeof *ROUND,
    BENDS = sizeof BEND / sizeof *BEND,
    LOBES = WEDGES + ROUNDS, /* the first of them */
    OUTLINES = PLM_BASE_OUTLINES,
    ROWS = 144,
    COLUMNS = 20,
    SEARCH_FROM = 46,                            /* rows: from 1.1 R before the first guess, ... */
    SEARCH_TO = SEARCH_FROM + PLM_BASE_ROWS - 1, /* ... to 2 R beyond, and IMAGE_ROWS hold all shifts */
    IMAGE_ROWS = ROWS + SEARCH_TO,
    COARSE = 2, /* rows between first tries, a divisor of SEARCH_TO - SEARCH_FROM */
    KERNEL = 40,
    FEWEST = 5
};
_Static_assert(OUTLINES == LOBES + BENDS * (sizeof SLOPE / sizeof *SLOPE), "a table has room for all outlines");

/* Logarithm of the density of a leaf with one outline (the share that is blade, while it is drawn): row k is (k - SEARCH_TO + 0.5) steps from the junction. */
typedef struct image {
    float density[IMAGE_ROWS][COLUMNS];
    double expected[IMAGE_ROWS + 1]; /* numbers of points up to each row */
} image;

typedef struct pixel {
    int row, column, count;
} pixel;

typedef struct outline {
    const plm_base_view *view;
    double step, column, blur;
    double petiole, blade, elsewhere; /* points per square metre */
    double fullness;                  /* of voxels: see filled */
    double foot;                      /* where the petiole begins, or what is looked at */
    int columns;                      /* that are compared: see blade_columns */
    pixel *side[2];
    size_t pixels[2];
    double before[IMAGE_ROWS], within[COLUMNS]; /* shares of the petiole that lie at a row, at a column */
    image *image;                               /* of each outline */
    double level[2];                            /* log likelihoods of either side are over these */
} outline;

/* Half width of the blade where it is widest, by windows along, each about its own middle; wider by the noise. */
static double half_width(const plm_base_view *view)
{
    double sum[WIDTH_BINS + 1][2] = {{0}}, widest = 0;
    size_t count[WIDTH_BINS + 1] = {0};
    for (size_t i = 0; i < view->count; i++) {
        const double bin = floor((view->place[i][0] / view->scale - WIDTH_FROM) / WIDTH_BIN), y = view->place[i][1];
        if (!(bin >= 0 && bin <= WIDTH_BINS)) continue;
        sum[(int)bin][0] += y, sum[(int)bin][1] += y * y;
        count[(int)bin]++;
    }
    size_t fullest = 0;
    for (int k = 0; k < WIDTH_BINS; k++)
        fullest = count[k] + count[k + 1] > fullest ? count[k] + count[k + 1] : fullest;
    for (int k = 0; k < WIDTH_BINS; k++) {
        const size_t points = count[k] + count[k + 1];
        if (points < FEWEST || (double)points < FULL_ENOUGH * (double)fullest) continue;
        const double mean = (sum[k][0] + sum[k + 1][0]) / (double)points;
        const double variance = (sum[k][1] + sum[k + 1][1]) / (double)points - mean * mean;
        widest = fmax(widest, 3 * variance); /* as of a strip */
    }
    return sqrt(widest);
}

double plm_base_own_scale(const plm_base_view *view)
{
    return half_width(view) / (COLUMNS * COLUMN);
}

bool plm_base_is_wide(const plm_base_view *view)
{
    return plm_base_own_scale(view) >= view->scale;
}

double plm_base_turn(const plm_base_view *view)
{
    const double most = TURN_TO * view->scale;
    double x = 0, y = 0;
    if (!plm_base_is_noisy(view) || plm_base_is_wide(view)) return 0;
    for (size_t i = 0; i < view->count; i++) {
        const double *p = view->place[i];
        if (p[0] > TURN_FROM * view->scale && hypot(p[0], p[1]) < most) x += p[0], y += p[1];
    }
    const double turn = atan2(y, x);
    return fabs(turn) < TURN_MOST ? turn : 0;
}

/* Outlines know no far side: beyond what a narrow blade reaches to, where it is widest and the blur leaves its edge full, nothing
 * is compared. Without noise thickness tells more than outlines, and all is. */
static int blade_columns(const outline *o)
{
    if (!plm_base_is_noisy(o->view) || plm_base_is_wide(o->view)) return COLUMNS;
    return (int)fmax((half_width(o->view) - o->blur) / o->column, 0);
}

static double below(double x)
{
    return 0.5 * erfc(-x / sqrt(2));
}

/* Of voxel means: points that a share of a surface's pixels leaves, in those that all of them leave. A voxel has one point,
 * however many pixels fall into it, so that half of the pixels, as at a blurred edge, fill most voxels. */
static double filled(double share, double fullness)
{
    return fullness > 0 ? expm1(-fullness * share) / expm1(-fullness) : share;
}

/* Densities of petiole and blade. false where either is too short or has too few points, or the blade is no wider. */
static bool find_densities(outline *o)
{
    const plm_base_view *v = o->view;
    const double R = v->scale, strip = v->radius + 2 * v->noise, side = fmin(BLADE_SIDE * R, o->columns * o->column);
    size_t petiole = 0, blade = 0;
    double foot = PETIOLE_TO * R;
    for (size_t i = 0; i < v->count; i++) {
        const double x = v->place[i][0], y = fabs(v->place[i][1]);
        if (x > PETIOLE_FROM * R && x < PETIOLE_TO * R && y < strip) {
            petiole++;
            foot = fmin(foot, x);
        }
        blade += x > BLADE_FROM * R && x < BLADE_TO * R && y < side;
    }
    const double length = PETIOLE_TO * R - foot;
    if (petiole < FEWEST || blade < FEWEST || length < SHORTEST * R || side < v->radius) return false;
    o->blade = (double)blade / ((BLADE_TO - BLADE_FROM) * R * 2 * side);
    o->petiole = fmax((double)petiole / (length * 2 * v->radius), FAINTEST * o->blade);
    o->elsewhere = ELSEWHERE * o->blade;
    o->foot = foot;
    return true;
}

/* By how strongly means gather about the middles of their voxels; 0 where points are none. A fit, within 5 % up to a gathering of
 * 0.6, to Poisson numbers of pixels in a sheet whose noise is one voxel. The less the noise, the less the means of as many pixels
 * gather: this is up to 30 % too little at half a voxel, and half of it is missing at a quarter. */
static double fullness_of(double gathering)
{
    return gathering > 0 ? -4.2 * log(1 - fmin(gathering, 0.8) / 0.9) : 0;
}

/* Points of either side by pixels; those without points are left out. */
static void count_pixels(outline *o, int (*count)[COLUMNS])
{
    const plm_base_view *v = o->view;
    for (int s = 0; s < 2; s++) {
        memset(count, 0, ROWS * sizeof *count);
        for (size_t i = 0; i < v->count; i++) {
            const double row = floor((v->place[i][0] + BACK * v->scale) / o->step);
            const double column = floor(fabs(v->place[i][1]) / o->column);
            if ((v->place[i][1] < 0) != s || !(row >= 0 && row < ROWS && column < o->columns)) continue;
            count[(int)row][(int)column]++;
        }
        for (int row = 0; row < ROWS; row++)
            for (int column = 0; column < COLUMNS; column++)
                if (count[row][column]) o->side[s][o->pixels[s]++] = (pixel){row, column, count[row][column]};
    }
}

/* ---- The image of an outline ------------------------------------------------------------------------------------ */

static bool is_blade(const outline *o, size_t which, double along, double across)
{
    const double swollen = SWOLLEN * o->view->noise;
    if (along < -swollen && across < o->view->radius) return false; /* the petiole takes its place */
    if (which < WEDGES) return along > -swollen && across < WEDGE[which] * (along + swollen);
    if (which < LOBES) {
        const double radius = ROUND[which - WEDGES] * o->view->scale;
        return along > -swollen && across * across < 2 * radius * (along + swollen);
    }
    if (along > -swollen) return true;
    const double slope = SLOPE[(which - LOBES) / BENDS], bend = BEND[(which - LOBES) % BENDS];
    return across > -slope * along + bend * along * along / o->view->scale - swollen;
}

/* Mean of what lies about each pixel, by a normal curve; across, the other side is taken for a mirror image. */
static void blur(image *m, float (*sharp)[COLUMNS], const double kernel[KERNEL], int reach, bool across)
{
    const int most = (across ? COLUMNS : IMAGE_ROWS) - 1;
    memcpy(sharp, m->density, sizeof m->density);
    for (int row = 0; row < IMAGE_ROWS; row++)
        for (int column = 0; column < COLUMNS; column++) {
            double sum = 0;
            for (int k = -reach; k <= reach; k++) {
                int at = (across ? column : row) + k;
                if (across && at < 0) at = -1 - at;
                at = at < 0 ? 0 : at > most ? most : at;
                sum += kernel[k < 0 ? -k : k] * (double)(across ? sharp[row][at] : sharp[at][column]);
            }
            m->density[row][column] = (float)sum;
        }
}

static void blur_along(image *m, float (*sharp)[COLUMNS], double sd, bool across)
{
    double kernel[KERNEL], sum = 0;
    int reach = (int)ceil(3 * sd);
    if (reach >= KERNEL) reach = KERNEL - 1;
    for (int k = 0; k <= reach; k++) {
        kernel[k] = exp(-0.5 * k * k / (sd * sd));
        sum += (k ? 2 : 1) * kernel[k];
    }
    for (int k = 0; k <= reach; k++) kernel[k] /= sum;
    blur(m, sharp, kernel, reach, across);
}

/* The petiole: it is as wide as it is, and ends at the junction. Its density is that which leaves its points. */
static void fill_strip(outline *o)
{
    double sharp = 0, left = 0;
    const double r = o->view->radius;
    for (int row = 0; row < IMAGE_ROWS; row++) o->before[row] = below((SEARCH_TO - row - 0.5) * o->step / o->blur);
    for (int column = 0; column < COLUMNS; column++) {
        const double y = (column + 0.5) * o->column;
        o->within[column] = below((r - y) / o->blur) - below((-r - y) / o->blur);
        sharp += o->within[column];
        left += filled(o->within[column], o->fullness);
    }
    o->petiole *= sharp / left;
}

/* Density where petiole and blade have these shares of a surface. */
static double density_at(const outline *o, double petiole, double blade)
{
    const double share = petiole + blade;
    const double points = share > 0 ? filled(share, o->fullness) / share : 0;
    return (o->petiole * petiole + o->blade * blade) * points + o->elsewhere;
}

/* Draws an outline: density becomes the logarithm. */
static void draw(outline *o, size_t which, float (*sharp)[COLUMNS])
{
    image *m = &o->image[which];
    for (int row = 0; row < IMAGE_ROWS; row++)
        for (int column = 0; column < COLUMNS; column++)
            m->density[row][column] =
                is_blade(o, which, (row - SEARCH_TO + 0.5) * o->step, (column + 0.5) * o->column) ? 1 : 0;
    blur_along(m, sharp, o->blur / o->step, false);
    blur_along(m, sharp, o->blur / o->column, true);
    m->expected[0] = 0;
    for (int row = 0; row < IMAGE_ROWS; row++) {
        double sum = 0;
        for (int column = 0; column < COLUMNS; column++) {
            const double density = density_at(o, o->before[row] * o->within[column], (double)m->density[row][column]);
            if (column < o->columns) sum += density;
            m->density[row][column] = logf((float)density);
        }
        m->expected[row + 1] = m->expected[row] + sum * o->step * o->column;
    }
}

/* Log likelihood of one side's points with one outline that begins at a row. */
static double compare(const outline *o, int s, const image *m, int junction)
{
    const int shift = SEARCH_TO - junction;
    double sum = m->expected[shift] - m->expected[shift + ROWS];
    for (size_t k = 0; k < o->pixels[s]; k++) {
        const pixel *p = &o->side[s][k];
        sum += p->count * (double)m->density[p->row + shift][p->column];
    }
    return sum;
}

/* ---- The search ------------------------------------------------------------------------------------------------- */

/* What the search goes by. */
typedef struct evidence {
    const plm_base_height *list;
    const double *cumulated;
    size_t heights;
    double expected;
} evidence;

/* What thickness tells; there is none where there is no memory. */
static evidence heights_of(const plm_base_view *view, double expected, plm_scratch *scratch)
{
    plm_base_height *list = plm_scratch_take(scratch, view->count + 1, sizeof *list);
    double *rest = plm_scratch_take(scratch, view->count + 1, sizeof *rest);
    double *cumulated = plm_scratch_take(scratch, view->count + 1, sizeof *cumulated);
    evidence found = {.list = list, .cumulated = cumulated, .expected = expected};
    if (!scratch->failed) found.heights = plm_base_heights(view, list, rest, cumulated);
    return found;
}

/* Fills a row of the table: the outlines of either side, thickness, and what was expected. */
static void judge(const outline *o, const evidence *e, int k, plm_base_table *table)
{
    const double at = table->first + k * table->step, off = (at - e->expected) / (EXPECTED_OFF * -o->foot);
    for (int s = 0; s < 2; s++)
        for (size_t which = 0; which < OUTLINES; which++)
            table->likelihood[k][s][which] = (float)(compare(o, s, &o->image[which], SEARCH_FROM + k) - o->level[s]);
    table->rest[k] = THICKNESS * plm_base_thickness(o->view, e->list, e->cumulated, e->heights, at) - log1p(off * off);
}

/* Place along the petiole of the first row that is tried. */
static double first_row(const plm_base_view *view)
{
    return SEARCH_FROM * (STEP * view->scale) - BACK * view->scale;
}

/* Every COARSE-th row, then those between likely ones. */
static void search(outline *o, const evidence *e, plm_base_table *table)
{
    double any[OUTLINES], total[PLM_BASE_ROWS], best = -INFINITY;
    plm_base_any(any);
    table->first = first_row(o->view), table->step = o->step;
    for (int s = 0; s < 2; s++) o->level[s] = compare(o, s, &o->image[0], SEARCH_FROM);
    for (int k = 0; k < PLM_BASE_ROWS; k++) table->rest[k] = total[k] = -INFINITY;
    for (int k = 0; k < PLM_BASE_ROWS; k += COARSE) {
        judge(o, e, k, table);
        best = fmax(best, total[k] = plm_base_evidence(table, k, any));
    }
    for (int k = 0; k + 1 < PLM_BASE_ROWS; k++) {
        const int before = k / COARSE * COARSE, after = before + COARSE;
        if (k != before && !(fmax(total[before], total[after]) < best - PLM_BASE_UNLIKELY)) judge(o, e, k, table);
    }
}

plm_status plm_base_look(const plm_base_view *view, double expected, plm_base_table *table, bool *told,
                         plm_error *error)
{
    plm_scratch scratch = {.error = error};
    outline *o = plm_scratch_take(&scratch, 1, sizeof *o);
    pixel *pixels = plm_scratch_take(&scratch, (size_t)2 * ROWS * COLUMNS, sizeof *pixels);
    int(*count)[COLUMNS] = plm_scratch_take(&scratch, ROWS, sizeof *count);
    image *images = plm_scratch_take(&scratch, OUTLINES, sizeof *images);
    float(*sharp)[COLUMNS] = plm_scratch_take(&scratch, IMAGE_ROWS, sizeof *sharp);
    *told = false;
    if (!scratch.failed) {
        *o = (outline){.view = view,
                       .step = STEP * view->scale,
                       .column = COLUMN * view->scale,
                       .blur = fmax(view->blur, SHARPEST * view->scale),
                       .fullness = fullness_of(view->gathering),
                       .image = images,
                       .side = {pixels, pixels + (size_t)ROWS * COLUMNS}};
        o->columns = blade_columns(o);
        if (find_densities(o)) {
            count_pixels(o, count);
            fill_strip(o);
            for (size_t which = 0; which < OUTLINES; which++) draw(o, which, sharp);
            const evidence found = heights_of(view, expected, &scratch);
            if (!scratch.failed) search(o, &found, table);
            *told = !scratch.failed;
        }
    }
    const plm_status status = scratch.failed ? PLM_E_MEMORY : PLM_OK;
    plm_scratch_free(&scratch, NULL);
    return status;
}

plm_status plm_base_look_at_thickness(const plm_base_view *view, plm_base_table *table, bool *told, plm_error *error)
{
    plm_scratch scratch = {.error = error};
    const evidence e = heights_of(view, 0, &scratch);
    *told = false;
    if (e.heights) {
        const double none = plm_base_thickness(view, e.list, e.cumulated, e.heights, INFINITY);
        *table = (plm_base_table){.first = first_row(view), .step = STEP * view->scale};
        for (int k = 0; k < PLM_BASE_ROWS; k++) {
            const double at = table->first + k * table->step;
            table->rest[k] = THICKNESS * (plm_base_thickness(view, e.list, e.cumulated, e.heights, at) - none);
            if (table->rest[k] > THICKNESS_TELLS) *told = true;
        }
    }
    const plm_status status = scratch.failed ? PLM_E_MEMORY : PLM_OK;
    plm_scratch_free(&scratch, NULL);
    return status;
}
