/* A young leaf whose petiole counts as its elder's gets it back; leaves that have one, and pieces to which none leads, take nothing. */
#include "support/test.h"

#include "cloud/linear.h"
#include "segment/rosette_petioles.h"

#include <string.h>

enum { LEAVES = 5, ALONG = 400, SHORT_ALONG = 100, BLADE = 200, ROWS = LEAVES * (ALONG + BLADE), YOUNG = 3 };
static const double PETIOLE = 12e-3, SHORT = 3e-3, THICK = 0.6e-3;

static float xyz[ROWS][3];
static uint32_t row[ROWS];
static uint8_t label[ROWS];
static int32_t organ[ROWS];
static size_t count;

static void add(const double at[3], uint8_t what, int32_t leaf)
{
    assert_true(count < ROWS);
    for (int a = 0; a < 3; a++) xyz[count][a] = (float)at[a];
    row[count] = (uint32_t)count, label[count] = what, organ[count] = leaf;
    count++;
}

/* A petiole from the middle, as thick as its noise is wide, and a round blade beyond. sag: of the petiole, upwards. */
static void add_bent(double azimuth, double rise, double sag, double petiole, double radius, int32_t leaf)
{
    double along[3] = {cos(azimuth), sin(azimuth), rise}, u[3], v[3];
    plm_normalise(along);
    plm_frame_of_axis(along, u, v);
    const int points = petiole < PETIOLE ? SHORT_ALONG : ALONG;
    for (int i = 0; i < points; i++) {
        double at[3];
        const double s = petiole * (i + 0.5) / points, off = THICK * sqrt(fmod(0.618 * i, 1)), turn = 2.4 * i;
        for (int a = 0; a < 3; a++) at[a] = s * along[a] + off * (cos(turn) * u[a] + sin(turn) * v[a]);
        at[2] += 4 * sag * s / petiole * (1 - s / petiole);
        add(at, PLM_LABEL_PETIOLE, leaf);
    }
    for (int i = 0; i < BLADE; i++) {
        double at[3];
        const double off = radius * sqrt((i + 0.5) / BLADE), turn = 2.4 * i;
        for (int a = 0; a < 3; a++) at[a] = (petiole + radius + off * cos(turn)) * along[a] + off * sin(turn) * u[a];
        add(at, PLM_LABEL_LEAF, leaf);
    }
}

static void add_leaf(double azimuth, double rise, double petiole, double radius, int32_t leaf)
{
    add_bent(azimuth, rise, 0, petiole, radius, leaf);
}

static plm_segmentation result(size_t leaves)
{
    return (plm_segmentation){.count = count, .label = label, .organ = organ, .leaf_count = leaves};
}

/* Three elders, and a young one between the first two. */
static plm_segmentation make(void)
{
    count = 0;
    for (int32_t k = 0; k < YOUNG; k++) add_leaf(k * 2 * PLM_PI / 3, 0.2, PETIOLE, 5e-3, k);
    add_leaf(PLM_PI / 5, 0.5, SHORT, 2e-3, YOUNG);
    return result(YOUNG + 1);
}

static bool is_of(size_t i, uint8_t what, int32_t leaf)
{
    return label[i] == what && organ[i] == leaf;
}

static size_t number(uint8_t what, int32_t leaf)
{
    size_t n = 0;
    for (size_t i = 0; i < count; i++) n += is_of(i, what, leaf);
    return n;
}

static double from_middle(size_t i)
{
    return plm_norm((double[3]){xyz[i][0], xyz[i][1], xyz[i][2]});
}

static void give_back(plm_segmentation *out)
{
    plm_error error = {0};
    assert_ok(plm_rosette_petioles((const float(*)[3])xyz, row, count, (double[3]){0}, out, &error));
}

static void a_young_leaf_gets_its_petiole(void **unused)
{
    (void)unused;
    plm_segmentation out = make();
    static bool was[ROWS];
    for (size_t i = 0; i < count; i++)
        if ((was[i] = is_of(i, PLM_LABEL_PETIOLE, YOUNG))) organ[i] = 0;
    give_back(&out);
    size_t far = 0, back = 0, wrong = 0;
    for (size_t i = 0; i < count; i++) {
        const bool is_far = xyz[i][0] * xyz[i][0] + xyz[i][1] * xyz[i][1] + xyz[i][2] * xyz[i][2] > 1.5e-3 * 1.5e-3;
        far += was[i] && is_far;
        back += was[i] && is_far && is_of(i, PLM_LABEL_PETIOLE, YOUNG);
        wrong += !was[i] && is_far && is_of(i, PLM_LABEL_PETIOLE, YOUNG);
    }
    assert_true(far > SHORT_ALONG / 3);
    assert_in_range(back, (size_t)(0.95 * (double)far), far);
    assert_in_range(wrong, 0, 2); /* nearer to the core it is of both */
    for (int32_t k = 0; k <= YOUNG; k++) assert_int_equal(number(PLM_LABEL_LEAF, k), BLADE);
}

/* The base of the blade passes as a tube, too. */
static void and_the_base_of_its_blade(void **unused)
{
    (void)unused;
    plm_segmentation out = make();
    size_t base = 0, back = 0;
    static bool was[ROWS];
    for (size_t i = 0; i < count; i++) {
        const bool is_base = is_of(i, PLM_LABEL_LEAF, YOUNG) && from_middle(i) < 3.5e-3;
        was[i] = is_base;
        if (is_base || is_of(i, PLM_LABEL_PETIOLE, YOUNG)) label[i] = PLM_LABEL_PETIOLE, organ[i] = 0;
    }
    give_back(&out);
    for (size_t i = 0; i < count; i++) base += was[i], back += was[i] && organ[i] == YOUNG;
    assert_true(base > BLADE / 20);
    assert_in_range(back, (size_t)(0.9 * (double)base), base);
}

/* Two young ones lean on one elder: each gets its own, however they are numbered. */
static void of_two_each_gets_its_own(void **unused)
{
    (void)unused;
    for (int first = 0; first < 2; first++) {
        static int32_t was[ROWS];
        size_t far = 0, back = 0;
        make();
        count -= SHORT_ALONG + BLADE;
        add_leaf(PLM_PI / 5, 0.5, SHORT, 2e-3, YOUNG + first);
        add_leaf(PLM_PI / 2.9, 0.5, SHORT, 2e-3, YOUNG + !first);
        for (size_t i = 0; i < count; i++) {
            was[i] = label[i] == PLM_LABEL_PETIOLE ? organ[i] : -1;
            if (was[i] >= YOUNG) organ[i] = 0;
        }
        plm_segmentation out = result(LEAVES);
        give_back(&out);
        for (size_t i = 0; i < count; i++) {
            if (was[i] < YOUNG || from_middle(i) < 0.5 * SHORT) continue;
            far++;
            back += organ[i] == was[i];
        }
        assert_true(far > SHORT_ALONG / 2);
        assert_true(back > 0.85 * (double)far);
    }
}

/* An arched elder keeps its own beside a young one that gets its petiole. */
static void an_arched_elder_keeps_its_own(void **unused)
{
    (void)unused;
    static bool was[ROWS];
    count = 0;
    add_bent(0, 0, 2.5e-3, PETIOLE, 5e-3, 0);
    for (int32_t k = 1; k < YOUNG; k++) add_leaf(k * 2 * PLM_PI / 3, 0.2, PETIOLE, 5e-3, k);
    add_leaf(0.4, 1.2, SHORT, 2e-3, YOUNG);
    for (size_t i = 0; i < count; i++)
        if ((was[i] = is_of(i, PLM_LABEL_PETIOLE, YOUNG))) organ[i] = 0;
    plm_segmentation out = result(YOUNG + 1);
    give_back(&out);
    size_t lost = 0, back = 0, far = 0;
    for (size_t i = 0; i < count; i++) {
        if (label[i] != PLM_LABEL_PETIOLE || from_middle(i) < 0.5 * SHORT) continue;
        lost += !was[i] && organ[i] == YOUNG;
        far += was[i];
        back += was[i] && organ[i] == YOUNG;
    }
    assert_true(back > 0.85 * (double)far);
    assert_in_range(lost, 0, 2);
}

/* The scan has nothing of a young leaf's petiole, close above an elder's: one tube is not parted in two. */
static void a_petiole_that_is_not_seen_is_not_made(void **unused)
{
    (void)unused;
    make();
    count -= SHORT_ALONG + BLADE;
    const size_t begin = count;
    add_leaf(0.03, 0.36, SHORT, 2e-3, YOUNG);
    for (size_t i = begin; i + SHORT_ALONG < count; i++) /* its blade follows its petiole */
        label[i] = label[i + SHORT_ALONG], memcpy(xyz[i], xyz[i + SHORT_ALONG], sizeof xyz[i]);
    count -= SHORT_ALONG;
    plm_segmentation out = result(YOUNG + 1);
    give_back(&out);
    assert_int_equal(number(PLM_LABEL_PETIOLE, YOUNG), 0);
    assert_int_equal(number(PLM_LABEL_PETIOLE, 0), ALONG);
}

static void nothing_is_no_trouble(void **unused)
{
    (void)unused;
    count = 0;
    plm_segmentation out = result(0);
    give_back(&out);
    out.leaf_count = 2; /* leaves without points */
    give_back(&out);
}

static void a_leaf_with_a_petiole_takes_nothing(void **unused)
{
    (void)unused;
    plm_segmentation out = make();
    for (size_t i = 0; i < count; i++)
        if (is_of(i, PLM_LABEL_PETIOLE, YOUNG) && i % 2) organ[i] = 0; /* half of it counts as the elder's */
    give_back(&out);
    assert_int_equal(number(PLM_LABEL_PETIOLE, YOUNG), SHORT_ALONG / 2);
}

/* A blade beyond a gap: what lies along its way begins in the middle and ends far before it. */
static void no_petiole_leads_to_a_piece(void **unused)
{
    (void)unused;
    plm_segmentation out = make();
    for (size_t i = 0; i < count; i++) {
        if (is_of(i, PLM_LABEL_PETIOLE, YOUNG)) organ[i] = 0;
        for (int a = 0; a < 3 && is_of(i, PLM_LABEL_LEAF, YOUNG); a++) xyz[i][a] *= 2.2f;
    }
    give_back(&out);
    assert_int_equal(number(PLM_LABEL_PETIOLE, YOUNG), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_young_leaf_gets_its_petiole),
                                       cmocka_unit_test(and_the_base_of_its_blade),
                                       cmocka_unit_test(of_two_each_gets_its_own),
                                       cmocka_unit_test(an_arched_elder_keeps_its_own),
                                       cmocka_unit_test(a_petiole_that_is_not_seen_is_not_made),
                                       cmocka_unit_test(nothing_is_no_trouble),
                                       cmocka_unit_test(a_leaf_with_a_petiole_takes_nothing),
                                       cmocka_unit_test(no_petiole_leads_to_a_piece)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
