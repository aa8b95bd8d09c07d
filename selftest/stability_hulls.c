/* selftest/stability_hulls.c: convex hulls of grids, solids whose corners lie on one ball, duplicates and few points.
 * Corners are integers times a power of two that float holds exactly; volumes and areas are closed forms. */
#include "cloud/linear.h"
#include "mesh/mesh.h"
#include "selftest/checks.h"

#include <float.h>

enum { ROOM = 8000 };

/* Points of a case, on the heap: a few thousand. */
typedef struct points {
    plm_checker *checker;
    size_t count;
    float (*xyz)[3];
    double offset, unit;
} points;

static void add(points *p, double x, double y, double z)
{
    if (p->count >= ROOM || !p->xyz) return;
    p->xyz[p->count][0] = (float)(p->unit * (x + p->offset));
    p->xyz[p->count][1] = (float)(p->unit * (y - p->offset));
    p->xyz[p->count++][2] = (float)(p->unit * (z + p->offset));
}

static void begin(points *p, double offset, double unit)
{
    p->count = 0;
    p->offset = offset;
    p->unit = unit;
}

static void check_hull(points *p, double volume, double area)
{
    plm_error why = {0};
    double found_volume = NAN, found_area = NAN;
    const plm_status status =
        plm_convex_hull((const float(*)[3])p->xyz, p->count, &found_volume, &found_area, NULL, &why);
    if (!plm_check_ran(p->checker, "hull", status, &why)) return;
    const double edge = p->unit;
    plm_check_value(p->checker, "hull volume", found_volume, volume * edge * edge * edge,
                    (plm_bound){.error = 16 * DBL_EPSILON, .condition = 3, .note = "16 roundings"});
    plm_check_value(p->checker, "hull area", found_area, area * edge * edge,
                    (plm_bound){.error = 16 * DBL_EPSILON, .condition = 2, .note = "16 roundings"});
}

static void check_no_hull(points *p)
{
    plm_error why = {0};
    double volume, area;
    plm_check_refused(p->checker, "hull",
                      plm_convex_hull((const float(*)[3])p->xyz, p->count, &volume, &area, NULL, &why), &why);
}

static void grid(points *p, int nx, int ny, int nz)
{
    for (int i = 0; i < nx; i++)
        for (int j = 0; j < ny; j++)
            for (int k = 0; k < nz; k++) add(p, i, j, k);
}

/* Corners that are permutations of (a, b, c) with all signs, each once: all on one ball, many on one circle. */
static void signed_permutations(points *p, int a, int b, int c)
{
    const int order[6][3] = {{a, b, c}, {a, c, b}, {b, a, c}, {b, c, a}, {c, a, b}, {c, b, a}};
    for (int o = 0; o < 6; o++)
        for (int sign = 0; sign < 8; sign++)
            add(p, order[o][0] * (sign & 1 ? -1 : 1), order[o][1] * (sign & 2 ? -1 : 1),
                order[o][2] * (sign & 4 ? -1 : 1));
}

/* A prism of height 7 over all integer points of the circle x^2 + y^2 = 5525 (radius of 13 right triangles), and its
 * closed forms: the ring has mirror images in eight sectors, so walking by angle gives the polygon. */
static void prism(points *p, double *volume, double *area)
{
    int x = 74, y = 7; /* 74^2 + 7^2 = 5525 */
    const int first_x = x, first_y = y;
    double twice = 0, round = 0;
    do { /* the next integer point counter-clockwise: the one with the smallest positive turn */
        int next_x = 0, next_y = 0;
        double best = 10;
        for (int a = -74; a <= 74; a++)
            for (int b = -74; b <= 74; b++) {
                if (a * a + b * b != 5525) continue;
                const double ahead = atan2(x * b - y * a, x * a + y * b);
                if (ahead > 1e-9 && ahead < best) best = ahead, next_x = a, next_y = b;
            }
        twice += x * next_y - y * next_x;
        round += hypot(next_x - x, next_y - y);
        x = next_x;
        y = next_y;
        add(p, x, y, 0);
        add(p, x, y, 7);
    } while (x != first_x || y != first_y);
    *volume = 3.5 * twice;
    *area = twice + 7 * round;
}

static void solids(points *p)
{
    const double root3 = sqrt(3);
    plm_check_scene(p->checker, "12 corners on one ball (cuboctahedron)");
    begin(p, 0, 1);
    signed_permutations(p, 1, 1, 0);
    check_hull(p, 20.0 / 3, 12 + 4 * root3);
    plm_check_scene(p->checker, "24 corners on one ball (truncated octahedron)");
    begin(p, 0, 1);
    signed_permutations(p, 0, 1, 2);
    check_hull(p, 32, 12 + 24 * root3);
    plm_check_scene(p->checker, "prism over a circle of integer points");
    begin(p, 0, 1);
    double volume, area;
    prism(p, &volume, &area);
    check_hull(p, volume, area);
}

static void grids(points *p)
{
    plm_check_scene(p->checker, "cube, grid of 12^3");
    begin(p, 0, 1);
    grid(p, 12, 12, 12);
    check_hull(p, 1331, 6 * 121);
    plm_check_scene(p->checker, "plane, grid of 40^2");
    begin(p, 0, 1);
    grid(p, 40, 40, 1);
    check_hull(p, 0, 2 * 39 * 39);
    plm_check_scene(p->checker, "upright plane, grid of 40^2");
    begin(p, 0, 1);
    grid(p, 1, 40, 40);
    check_hull(p, 0, 2 * 39 * 39);
    plm_check_scene(p->checker, "line of 100 points");
    begin(p, 0, 1);
    for (int i = 0; i < 100; i++) add(p, i, 2 * i, -3 * i);
    check_no_hull(p);
}

static void offsets_and_units(points *p)
{
    for (int digits = 3; digits <= 9; digits += 3) {
        plm_check_scene(p->checker, "cube of 4096, 1e%d of its units away", digits);
        begin(p, round(pow(10, digits) / 64) * 64, 1);
        for (int i = 0; i < 8; i++) add(p, i & 1 ? 4096 : 0, i & 2 ? 4096 : 0, i & 4 ? 4096 : 0);
        check_hull(p, 4096.0 * 4096 * 4096, 6 * 4096.0 * 4096);
    }
    for (int power = -20; power <= 20; power += 10) {
        plm_check_scene(p->checker, "cube, grid of 6^3, unit 2^%d", power);
        begin(p, 0, ldexp(1, power));
        grid(p, 6, 6, 6);
        check_hull(p, 125, 150);
    }
    static const int ends[] = {-40, 40};
    for (int i = 0; i < 2; i++) {
        plm_check_scene(p->checker, "cube, grid of 6^3, unit 2^%d", ends[i]);
        begin(p, 0, ldexp(1, ends[i]));
        grid(p, 6, 6, 6);
        check_hull(p, 125, 150);
    }
}

static void few_and_many(points *p)
{
    for (int count = 0; count <= 2; count++) {
        plm_check_scene(p->checker, count == 1 ? "%d point" : "%d points", count);
        begin(p, 0, 1);
        for (int i = 0; i < count; i++) add(p, i, 0, 0);
        check_no_hull(p);
    }
    plm_check_scene(p->checker, "3 points");
    begin(p, 0, 1);
    add(p, 0, 0, 0), add(p, 3, 0, 0), add(p, 0, 4, 0);
    check_hull(p, 0, 12);
    plm_check_scene(p->checker, "4 points");
    begin(p, 0, 1);
    add(p, 0, 0, 0), add(p, 2, 0, 0), add(p, 0, 2, 0), add(p, 0, 0, 2);
    check_hull(p, 8.0 / 6, 6 + 2 * sqrt(3));
    plm_check_scene(p->checker, "one place, 1000 times");
    begin(p, 0, 1);
    for (int i = 0; i < 1000; i++) add(p, 1, 2, 3);
    check_no_hull(p);
    plm_check_scene(p->checker, "cube, each corner 1000 times");
    begin(p, 0, 1);
    for (int i = 0; i < 8000; i++) add(p, i & 1, i >> 1 & 1, i >> 2 & 1);
    check_hull(p, 1, 6);
}

void plm_stability_hulls(plm_checker *checker)
{
    points p = {.checker = checker};
    if (checker->status != PLM_OK) return;
    p.xyz = plm_alloc(ROOM, sizeof *p.xyz, checker->error);
    if (!p.xyz) {
        checker->status = PLM_E_MEMORY;
        return;
    }
    grids(&p);
    solids(&p);
    offsets_and_units(&p);
    few_and_many(&p);
    plm_free(p.xyz);
}
