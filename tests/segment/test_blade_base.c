/* The border between petiole and blade by the outline of the blade's base: flattened leaves of known shape. */
#include "support/test.h"

#include "cloud/linear.h"
#include "cloud/neighbours.h"
#include "cloud/random.h"
#include "cloud/sampling.h"
#include "cloud/voxel_pitch.h"
#include "segment/blade_base.h"

#include <math.h>
#include <string.h>

enum { MOST = 60000, VOXELS = 64 };
static const double R = 0.0045, TUBE = 0.0007;

/* Where the blade begins when nothing is known of outlines. */
static plm_status find_base(const plm_base_view *view, double expected, double *found, plm_error *error)
{
    static plm_base_table table;
    double any[PLM_BASE_OUTLINES];
    bool told;
    plm_base_any(any);
    const plm_status status = plm_base_look(view, expected, &table, &told, error);
    *found = told ? plm_base_mean(&table, any) : NAN;
    return status;
}

typedef struct base_shape {
    const char *name;
    double wedge;       /* blade's half width over the way ahead; 0: as below */
    double round;       /* radius of the base's curvature, in R; 0: as below */
    double slope, bend; /* of the lobes' edges */
} base_shape;

static const base_shape shapes[] = {
    {.name = "a wedge", .wedge = 1.0},
    {.name = "a round base", .round = 1.0},
    {.name = "a straight base", .wedge = INFINITY},
    {.name = "deep lobes", .slope = 0.45, .bend = 0.2},
    {.name = "wide lobes", .slope = 1.2, .bend = 0.1},
};

static bool is_blade(const base_shape *shape, double ahead, double side)
{
    if (shape->wedge > 0) return ahead > 0 && side < shape->wedge * ahead;
    if (shape->round > 0) return ahead > 0 && side * side < 2 * shape->round * R * ahead;
    return ahead > 0 || side > -shape->slope * ahead + shape->bend * ahead * ahead / R;
}

/* A leaf whose blade begins at `junction`: a tube that ends there and a sheet, `density` points per square millimetre of both,
 * moved by noise to all sides. */
static size_t make_leaf(const base_shape *shape, double junction, double density, double noise, uint64_t seed,
                        double (*place)[3])
{
    plm_random random = {.key = plm_key(seed, 0)};
    const double half = 3 * R, side = 2 * R;
    const size_t tries = (size_t)(density * 1e6 * 2 * half * 2 * side);
    const size_t around = (size_t)(density * 1e6 * (half + junction) * 2 * 3.14159 * TUBE);
    size_t count = 0;
    for (size_t i = 0; i < tries; i++) {
        const double x = (2 * plm_draw(&random) - 1) * half, y = (2 * plm_draw(&random) - 1) * side;
        if (!is_blade(shape, x - junction, fabs(y))) continue;
        place[count][0] = x, place[count][1] = y, place[count++][2] = 0;
    }
    for (size_t i = 0; i < around; i++) {
        const double angle = 2 * 3.14159 * plm_draw(&random);
        place[count][0] = -half + (half + junction) * plm_draw(&random);
        place[count][1] = TUBE * cos(angle), place[count++][2] = TUBE * sin(angle);
    }
    assert_true(count < MOST);
    for (size_t i = 0; i < count; i++)
        for (int a = 0; a < 3; a++) place[i][a] += noise * plm_draw_normal(&random);
    return count;
}

/* Largest error over places of the junction, in millimetres; the first guess is 0 throughout. */
static double largest_error(const base_shape *shape, double density, double noise)
{
    static double place[MOST][3];
    double largest = 0;
    for (int k = -2; k <= 4; k++) {
        const double built = 0.2 * k * R;
        plm_error error = {0};
        double found;
        const size_t count = make_leaf(shape, built, density, noise, (uint64_t)(k + 3), place);
        const plm_base_view view = {
            .count = count, .place = place, .scale = R, .radius = TUBE, .noise = noise, .blur = noise};
        assert_ok(find_base(&view, 0, &found, &error));
        assert_true(isfinite(found));
        largest = fmax(largest, 1e3 * fabs(found - built));
    }
    print_message("%s, %.1f mm of noise: %.2f mm\n", shape->name, 1e3 * noise, largest);
    return largest;
}

static void without_noise_the_border_is_told_to_a_tenth_of_R(void **state)
{
    (void)state;
    for (size_t k = 0; k < sizeof shapes / sizeof *shapes; k++) assert_true(largest_error(&shapes[k], 8, 0) < 0.45);
}

/* Half a millimetre of noise fills the end of a sinus: its edges tell where it was. The likeliest junction alone was off by 0.8
 * to 1 mm at four of the shapes. */
static void in_noise_the_outline_tells_it(void **state)
{
    (void)state;
    for (size_t k = 0; k < sizeof shapes / sizeof *shapes; k++) assert_true(largest_error(&shapes[k], 4, 0.0005) < 0.8);
}

/* Deep lobes beside the petiole make the first guess, which goes by widths, far too early, and noise fills the end of the sinus
 * between them: the data tell the place to half an R, and a guess that is trusted pulls to the early end. */
static void a_first_guess_far_off_is_not_trusted(void **state)
{
    (void)state;
    static double place[MOST][3];
    const base_shape sinus = {.name = "a narrow sinus", .slope = 0.4, .bend = 0.12};
    const double built = 1.6 * R;
    enum { LEAVES = 8 };
    double mean = 0;
    for (int k = 0; k < LEAVES; k++) {
        plm_error error = {0};
        double found;
        size_t count = 0;
        const size_t all = make_leaf(&sinus, built, 2, 0.0005, (uint64_t)(k + 40), place);
        for (size_t i = 0; i < all; i++) /* of the petiole, 1.2 R are seen */
            if (place[i][0] > -1.2 * R) memcpy(place[count++], place[i], sizeof *place);
        const plm_base_view view = {
            .count = count, .place = place, .scale = R, .radius = TUBE, .noise = 0.0005, .blur = 0.0005};
        assert_ok(find_base(&view, 0, &found, &error));
        assert_true(isfinite(found));
        mean += 1e3 * (found - built) / LEAVES;
    }
    print_message("%s, the first guess %.1f mm early: %+.2f mm\n", sinus.name, 1e3 * built, mean);
    assert_true(fabs(mean) < 1.5);
}

/* Each leaf alone hardly tells a narrow lobe that begins late from a wide one that begins early; all of them together do. */
static void the_leaves_of_a_plant_begin_alike(void **state)
{
    (void)state;
    static double place[MOST][3];
    const base_shape sinus = {.name = "a narrow sinus", .slope = 0.4, .bend = 0.12};
    enum { LEAVES = 8 };
    static plm_base_table table[LEAVES];
    const plm_base_table *all[LEAVES];
    double built[LEAVES], share[2][PLM_BASE_OUTLINES], squares[2] = {0}, sum = 0;
    for (int k = 0; k < LEAVES; k++) {
        plm_error error = {0};
        bool told;
        built[k] = (1 + 0.1 * k) * R;
        const size_t count = make_leaf(&sinus, built[k], 2, 0.0006, (uint64_t)(k + 60), place);
        const plm_base_view view = {
            .count = count, .place = place, .scale = R, .radius = TUBE, .noise = 0.0006, .blur = 0.0006};
        assert_ok(plm_base_look(&view, 0, &table[k], &told, &error));
        assert_true(told);
        all[k] = &table[k];
    }
    plm_base_any(share[0]);
    plm_base_shares(all, LEAVES, share[1]);
    for (size_t which = 0; which < PLM_BASE_OUTLINES; which++) sum += share[1][which];
    assert_float_equal(sum, 1, 1e-9);
    for (int together = 0; together < 2; together++) {
        double mean = 0;
        for (int k = 0; k < LEAVES; k++) {
            const double off = 1e3 * (plm_base_mean(&table[k], share[together]) - built[k]);
            mean += off / LEAVES, squares[together] += off * off / LEAVES;
        }
        print_message("%s, %s: %+.2f mm, RMS %.2f\n", sinus.name, together ? "together" : "alone", mean,
                      sqrt(squares[together]));
    }
    assert_true(squares[1] < 0.65 * squares[0]);
}

/* Means of the points in each voxel of a grid that lies askew to the leaf, which is turned and tilted for it and back; gives their
 * number, and what their sampling is found to be. */
static size_t fuse(double (*place)[3], size_t count, double pitch, plm_sampling *sampling)
{
    static double sum[VOXELS * VOXELS * VOXELS][3];
    static int pixels[VOXELS * VOXELS * VOXELS];
    static float mean[MOST][3];
    const double c = cos(0.5), s = sin(0.5), ct = cos(0.29), st = sin(0.29);
    const double axis[3][3] = {{ct * c, -ct * s, st}, {s, c, 0}, {-st * c, st * s, ct}};
    memset(sum, 0, sizeof sum);
    memset(pixels, 0, sizeof pixels);
    for (size_t i = 0; i < count; i++) {
        double turned[3];
        size_t voxel = 0;
        for (int a = 0; a < 3; a++) {
            turned[a] = plm_dot(axis[a], place[i]) + 0.3 * a * pitch;
            const double index = floor(turned[a] / pitch) + VOXELS / 2;
            assert_true(index >= 0 && index < VOXELS);
            voxel = voxel * VOXELS + (size_t)index;
        }
        pixels[voxel]++;
        for (int a = 0; a < 3; a++) sum[voxel][a] += turned[a];
    }
    size_t kept = 0;
    for (size_t v = 0; v < VOXELS * VOXELS * VOXELS; v++) {
        if (!pixels[v]) continue;
        for (int a = 0; a < 3; a++) mean[kept][a] = (float)(sum[v][a] /= pixels[v]);
        for (int a = 0; a < 3; a++) {
            place[kept][a] = 0;
            for (int b = 0; b < 3; b++) place[kept][a] += axis[b][a] * (sum[v][b] - 0.3 * b * pitch);
        }
        kept++;
    }
    plm_error error = {0};
    plm_index *index = NULL;
    assert_ok(plm_index_build((const float(*)[3])mean, kept, &index, &error));
    assert_ok(plm_sampling_measure(index, (const float(*)[3])mean, kept, NULL, sampling, &error));
    assert_ok(plm_voxels_measure((const float(*)[3])mean, kept, sampling, &error));
    plm_index_free(index);
    return kept;
}

/* Root of the mean squared error over leaves of a shape, in millimetres, of points that are means of some ten pixels; told is
 * whether the search knows that they are. */
static double fused_error(const base_shape *shape, bool told)
{
    static double place[MOST][3];
    enum { LEAVES = 8 };
    double mean = 0, squares = 0;
    for (int k = 0; k < LEAVES; k++) {
        const double built = 0.1 * k * R;
        plm_error error = {0};
        double found;
        plm_sampling sampling;
        size_t count = make_leaf(shape, built, 40, 0.0005, (uint64_t)(k + 20), place);
        count = fuse(place, count, 0.0009, &sampling);
        assert_float_equal(sampling.pitch, 0.0009, 1e-5);
        const plm_base_view view = {.count = count,
                                    .place = place,
                                    .scale = R,
                                    .radius = TUBE,
                                    .noise = sampling.noise,
                                    .blur = plm_base_blur(sampling.noise, told ? sampling.pitch : 0),
                                    .gathering = told ? sampling.gathering : 0};
        assert_ok(find_base(&view, 0, &found, &error));
        assert_true(isfinite(found));
        mean += 1e3 * (found - built) / LEAVES;
        squares += 1e6 * (found - built) * (found - built) / LEAVES;
    }
    print_message("%s, fused, %s: %+.2f mm, RMS %.2f\n", shape->name, told ? "told" : "not told", mean, sqrt(squares));
    return sqrt(squares);
}

/* Voxel means of a leaf with a narrow sinus whose pixels lie off along the blade by more than across it, as where the rays of depth
 * cameras graze it and views are a little off each other. */
static size_t make_grazed(double built, uint64_t seed, double (*place)[3], plm_sampling *sampling)
{
    const base_shape narrow = {.name = "narrow lobes", .slope = 0.65, .bend = 0.05};
    const double across = 0.0003, more = 0.0005;
    plm_random random = {.key = plm_key(seed, 1)};
    const size_t count = make_leaf(&narrow, built, 40, across, seed, place);
    for (size_t i = 0; i < count; i++)
        for (int a = 0; a < 2; a++) place[i][a] += more * plm_draw_normal(&random);
    return fuse(place, count, 0.0009, sampling);
}

/* Mean error over such leaves, in millimetres; told is whether the search takes for granted that their edges are blurred. */
static double grazed_error(bool told)
{
    static double place[MOST][3];
    enum { LEAVES = 8 };
    double mean = 0;
    for (int k = 0; k < LEAVES; k++) {
        const double built = 0.1 * k * R;
        plm_error error = {0};
        double found;
        plm_sampling sampling;
        const size_t count = make_grazed(built, (uint64_t)(k + 90), place, &sampling);
        const plm_base_view view = {.count = count,
                                    .place = place,
                                    .scale = R,
                                    .radius = TUBE,
                                    .noise = sampling.noise,
                                    .blur = told ? plm_base_blur(sampling.noise, sampling.pitch) : sampling.noise,
                                    .gathering = sampling.gathering};
        assert_ok(find_base(&view, 0, &found, &error));
        assert_true(isfinite(found));
        mean += 1e3 * (found - built) / LEAVES;
    }
    print_message("narrow lobes, grazed, %s: %+.2f mm\n", told ? "told" : "not told", mean);
    return mean;
}

static void rays_that_graze_a_blade_blur_its_edges(void **state)
{
    (void)state;
    const double told = grazed_error(true), not_told = grazed_error(false);
    assert_true(fabs(told) < 1.1);
    assert_true(fabs(told) < 0.65 * fabs(not_told));
    assert_float_equal(plm_base_blur(0.0003, 0), 0.0003, 0);
}

/* Where such a leaf's petiole ends by its labels once the borders were set, in metres beyond the place at which it was built. */
static double border_off(plm_habit habit, bool has_pitch)
{
    static double place[MOST][3];
    static float xyz[MOST][3], ends[MOST];
    static uint32_t row[MOST];
    static uint8_t label[MOST];
    static int32_t organ[MOST];
    const double built = 0.3 * R;
    plm_sampling sampling;
    const size_t count = make_grazed(built, 93, place, &sampling);
    for (size_t i = 0; i < count; i++) {
        for (int a = 0; a < 3; a++) xyz[i][a] = (float)place[i][a];
        label[i] = place[i][0] < 0 && fabs(place[i][1]) < 1.5 * TUBE ? PLM_LABEL_PETIOLE : PLM_LABEL_LEAF;
        row[i] = (uint32_t)i;
    }
    plm_error error = {0};
    plm_segmentation out = {.count = count, .label = label, .organ = organ, .leaf_count = 1, .habit = habit};
    const plm_scale scale = {.radius = R,
                             .stem_radius = TUBE,
                             .noise = sampling.noise,
                             .gathering = sampling.gathering,
                             .pitch = has_pitch ? sampling.pitch : 0};
    assert_ok(plm_blade_bases((const float(*)[3])xyz, row, count, &scale, &out, &error));
    size_t petiole = 0;
    for (size_t i = 0; i < count; i++)
        if (label[i] == PLM_LABEL_PETIOLE) ends[petiole++] = xyz[i][0];
    return (double)plm_quantile(ends, petiole, 0.99) - built;
}

static void borders_know_the_voxels_but_a_rosettes(void **state)
{
    (void)state;
    const double with = border_off(PLM_HABIT_SIMPLE, true), without = border_off(PLM_HABIT_SIMPLE, false);
    print_message("the petiole ends at %+.2f mm, without the voxels' edge at %+.2f mm\n", 1e3 * with, 1e3 * without);
    assert_true(fabs(with) < fabs(without) - 1e-4);
    assert_true(border_off(PLM_HABIT_ROSETTE, true) == border_off(PLM_HABIT_ROSETTE, false));
}

/* Bases without a sinus have no edges that fill it; their junction comes out 0.6 to 1.2 mm late. */
static void voxel_means_move_other_bases_little(void **state)
{
    (void)state;
    for (size_t k = 0; k < 3; k++) assert_true(fused_error(&shapes[k], true) < 1.3);
}

/* A voxel has one point, however many pixels: the blurred edges of a sinus and of the petiole look full, and a model whose
 * density follows the pixels puts the junction where they meet. */
static void in_voxel_means_a_sinus_ends_where_it_ends(void **state)
{
    (void)state;
    const base_shape sinus[] = {{.name = "deep lobes", .slope = 0.45, .bend = 0.2},
                                {.name = "narrow lobes", .slope = 0.65, .bend = 0.05}};
    for (size_t k = 0; k < 2; k++) {
        const double told = fused_error(&sinus[k], true), not_told = fused_error(&sinus[k], false);
        assert_true(told < 1.2);
        assert_true(told < 0.6 * not_told);
    }
}

static void too_little_tells_none(void **state)
{
    (void)state;
    double place[40][3] = {{0}}, found = 0;
    plm_error error = {0};
    for (int i = 0; i < 40; i++) place[i][0] = -1e-4 * i; /* a petiole without blade */
    const plm_base_view bare = {.count = 40, .place = place, .scale = R, .radius = TUBE};
    assert_ok(find_base(&bare, 0, &found, &error));
    assert_true(isnan(found));
    for (int i = 0; i < 40; i++) place[i][0] = 2e-4 * i; /* a blade without petiole */
    assert_ok(find_base(&bare, 0, &found, &error));
    assert_true(isnan(found));
    const plm_base_view empty = {.scale = R, .radius = TUBE};
    assert_ok(find_base(&empty, 0, &found, &error));
    assert_true(isnan(found));
}

static void a_stray_point_makes_no_blade_wide(void **state)
{
    (void)state;
    double place[121][3] = {{0}};
    for (int i = 0; i < 120; i++) place[i][0] = (0.01 * i + 0.05) * R, place[i][1] = (i % 2 ? 0.5 : -0.5) * R;
    for (int i = 114; i < 120; i++) place[i][0] = 2.5 * R; /* a few at the tip, ... */
    place[120][0] = 2.5 * R, place[120][1] = 4 * R;        /* ... and one beside it */
    const plm_base_view blade = {.count = 121, .place = place, .scale = R, .radius = TUBE};
    assert_false(plm_base_is_wide(&blade));
    for (int i = 0; i < 114; i++) place[i][1] *= 4;
    assert_true(plm_base_is_wide(&blade));
}

/* Leaves of a compound plant whose petioles end 0.3 R beyond the junction: the first and the last have one leaflet, that between
 * them two. The first is a simple leaf. */
static void of_a_compound_plant_the_first_leaves_without_leaflets_are_asked(void **state)
{
    (void)state;
    enum { LEAVES = 3 };
    static double place[MOST][3];
    static float xyz[MOST][3];
    static uint32_t row[MOST];
    static uint8_t label[MOST];
    static int32_t organ[MOST], leaflet[MOST];
    const base_shape round_base = {.name = "a round base", .round = 1.0};
    size_t count = 0, changed[LEAVES] = {0};
    for (int leaf = 0; leaf < LEAVES; leaf++) {
        const size_t end = count + make_leaf(&round_base, 0, 8, 0, 5, place + count);
        for (; count < end; count++) {
            const bool petiole = place[count][0] < 0.3 * R && fabs(place[count][1]) < 2 * TUBE;
            for (int a = 0; a < 3; a++) xyz[count][a] = (float)(place[count][a] + (a == 2 ? 0.1 * leaf : 0));
            label[count] = petiole ? PLM_LABEL_PETIOLE : PLM_LABEL_LEAF;
            organ[count] = leaf, row[count] = (uint32_t)count;
            leaflet[count] = petiole ? -1 : leaf == 1 && place[count][1] > 0;
        }
    }
    static uint8_t before[MOST];
    memcpy(before, label, sizeof before);
    plm_error error = {0};
    plm_segmentation out = {.count = count,
                            .label = label,
                            .organ = organ,
                            .leaflet = leaflet,
                            .leaf_count = LEAVES,
                            .habit = PLM_HABIT_COMPOUND};
    const plm_scale scale = {.radius = R, .stem_radius = TUBE};
    assert_ok(plm_blade_bases((const float(*)[3])xyz, row, count, &scale, &out, &error));
    for (size_t i = 0; i < count; i++) changed[organ[i]] += label[i] != before[i];
    print_message("%zu points changed\n", changed[0]);
    assert_true(changed[0] > 20);
    assert_int_equal(changed[1] + changed[2], 0);
    for (size_t i = 0; i < count; i++) { /* what became blade has the leaflet of the blade, what became petiole none */
        if (organ[i] != 0) continue;
        assert_int_equal(leaflet[i], label[i] == PLM_LABEL_LEAF ? 0 : -1);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(without_noise_the_border_is_told_to_a_tenth_of_R),
        plant_case(in_noise_the_outline_tells_it),
        cmocka_unit_test(a_first_guess_far_off_is_not_trusted),
        cmocka_unit_test(the_leaves_of_a_plant_begin_alike),
        plant_case(in_voxel_means_a_sinus_ends_where_it_ends),
        plant_case(voxel_means_move_other_bases_little),
        cmocka_unit_test(rays_that_graze_a_blade_blur_its_edges),
        cmocka_unit_test(borders_know_the_voxels_but_a_rosettes),
        cmocka_unit_test(too_little_tells_none),
        cmocka_unit_test(a_stray_point_makes_no_blade_wide),
        cmocka_unit_test(of_a_compound_plant_the_first_leaves_without_leaflets_are_asked),
    };
    return run_cases(tests);
}
