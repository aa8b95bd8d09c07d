/* Areas, hulls and eigenvalues against exact rational arithmetic (GMP through CGAL), with MPFR for the one root: random needles
 * in any place and unit, random and cospherical clouds, matrices with equal and nearly equal eigenvalues. */
/* The C++ libraries come first: cmocka has a macro `fail`. */
#if defined(__GNUC__) && !defined(__clang__)
/* Of CGAL's Epic_converter, where the sanitizers are on. */
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>
#include <array>
#include <cfloat>
#include <cmath>
#include <gmpxx.h>
#include <mpfr.h>
#include <vector>

extern "C" {
#include "support/test.h"

#include "cloud/linear.h"
#include "mesh/mesh.h"
}

namespace
{

typedef mpq_class rational;
typedef CGAL::Exact_predicates_exact_constructions_kernel kernel;

/* A rational as an MPFR number of 200 bits. */
class wide
{
  public:
    mpfr_t value;
    explicit wide(const rational &exact)
    {
        mpfr_init2(value, 200);
        mpfr_set_q(value, exact.get_mpq_t(), MPFR_RNDN);
    }
    ~wide()
    {
        mpfr_clear(value);
    }
    wide(const wide &) = delete;
    wide &operator=(const wide &) = delete;
};

/* |found - sqrt(squared)| / sqrt(squared) */
double error_of_root(double found, const rational &squared)
{
    wide exact(squared);
    mpfr_sqrt(exact.value, exact.value, MPFR_RNDN);
    wide gap{rational(0)};
    mpfr_d_sub(gap.value, found, exact.value, MPFR_RNDN);
    mpfr_div(gap.value, gap.value, exact.value, MPFR_RNDN);
    return std::fabs(mpfr_get_d(gap.value, MPFR_RNDN));
}

rational four_areas_squared(const double corner[3][3])
{
    rational a[3], b[3], sum = 0;
    for (int k = 0; k < 3; k++) {
        a[k] = rational(corner[1][k]) - rational(corner[0][k]);
        b[k] = rational(corner[2][k]) - rational(corner[0][k]);
    }
    for (int k = 0; k < 3; k++) {
        const rational c = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
        sum += c * c;
    }
    return sum;
}

/* Needles in any direction. Edges are differences of the corners: exact where those lie near each other, else rounded once,
 * which the area feels by the ratio of edges to height. */
void areas_of_needles_keep_their_digits(void **)
{
    uint64_t state = 4;
    double worst = 0;
    for (int trial = 0; trial < 2000; trial++) {
        const double aspect = std::pow(10, 12 * test_uniform(&state)),
                     unit = std::pow(10, 12 * test_uniform(&state) - 6);
        const double away = trial % 2 ? std::pow(10, 9 * test_uniform(&state)) : 0;
        double corner[3][3], along[3], across[3], place = test_uniform(&state);
        for (int k = 0; k < 3; k++) along[k] = test_normal(&state), across[k] = test_normal(&state);
        for (int k = 0; k < 3; k++) {
            const double far = away * (k + 1);
            corner[0][k] = unit * far;
            corner[1][k] = unit * (far + along[k]);
            corner[2][k] = unit * (far + place * along[k] + across[k] / aspect);
        }
        const rational squared = four_areas_squared(corner);
        if (squared == 0) continue; /* so far away, the corners have become one line */
        uint32_t triangle[1][3] = {{0, 1, 2}};
        plm_error error = {};
        plm_mesh mesh = {};
        mesh.vertex_count = 3, mesh.triangle_count = 1, mesh.vertex = corner, mesh.triangle = triangle;
        double area;
        assert_ok(plm_mesh_area(&mesh, &area, &error));
        double longest = 0;
        for (int i = 0; i < 3; i++) {
            double edge[3];
            for (int k = 0; k < 3; k++) edge[k] = corner[(i + 1) % 3][k] - corner[i][k];
            longest = std::fmax(longest, plm_dot(edge, edge));
        }
        const double condition = 2 * longest / (2 * area); /* of the rounding of the two edges */
        const double bound = 4 * DBL_EPSILON + DBL_EPSILON * condition;
        const double found = error_of_root(2 * area, squared);
        worst = std::fmax(worst, found / bound);
        assert_true(found <= bound);
    }
    print_message("needles: the worst error is %.2f of its bound\n", worst);
}

void check_hull(const std::vector<std::array<float, 3>> &points, double bound)
{
    plm_error error = {};
    double volume, area;
    assert_ok(plm_convex_hull(reinterpret_cast<const float(*)[3]>(points.data()), points.size(), &volume, &area,
                              nullptr, &error));
    std::vector<kernel::Point_3> exact;
    for (const auto &p : points) exact.emplace_back(p[0], p[1], p[2]);
    CGAL::Surface_mesh<kernel::Point_3> hull;
    CGAL::convex_hull_3(exact.begin(), exact.end(), hull);
    const kernel::FT reference = CGAL::Polygon_mesh_processing::volume(hull);
    const kernel::FT gap = (kernel::FT(volume) - reference) / reference;
    assert_true(std::fabs(CGAL::to_double(gap)) <= bound);
}

/* All integer points on the sphere x^2 + y^2 + z^2 = 1105: many on one circle, all on one ball. */
void hulls_of_cospherical_and_random_points_are_exact(void **)
{
    std::vector<std::array<float, 3>> ball;
    for (int x = -34; x <= 34; x++)
        for (int y = -34; y <= 34; y++)
            for (int z = -34; z <= 34; z++)
                if (x * x + y * y + z * z == 1105) ball.push_back({(float)x, (float)y, (float)z});
    assert_true(ball.size() > 100);
    check_hull(ball, 16 * DBL_EPSILON);
    uint64_t state = 6;
    for (int trial = 0; trial < 20; trial++) {
        const double unit = std::pow(10, 12 * test_uniform(&state) - 6), flat = std::pow(10, -6 * test_uniform(&state));
        std::vector<std::array<float, 3>> points;
        for (int i = 0; i < 2000; i++) {
            std::array<float, 3> p;
            for (int k = 0; k < 3; k++) p[k] = (float)(unit * (k == 2 ? flat : 1) * (3 + test_normal(&state)));
            for (int copy = 0; copy <= i % 3; copy++) points.push_back(p);
        }
        check_hull(points, 64 * DBL_EPSILON);
    }
}

/* How many eigenvalues of the symmetric matrix are below x: the negative pivots of A - x I (Sylvester's law of inertia). */
int eigenvalues_below(const double m[6], const rational &x)
{
    rational a[3][3] = {{m[0], m[1], m[2]}, {m[1], m[3], m[4]}, {m[2], m[4], m[5]}};
    int below = 0;
    for (int k = 0; k < 3; k++) a[k][k] -= x;
    for (int k = 0; k < 3; k++) {
        if (a[k][k] == 0) a[k][k] = rational(1e-300); /* a hair off: the bounds are not so near */
        if (a[k][k] < 0) below++;
        for (int i = k + 1; i < 3; i++)
            for (int j = k + 1; j < 3; j++) a[i][j] -= a[i][k] * a[k][j] / a[k][k];
    }
    return below;
}

void eigenvalues_lie_where_inertia_says(void **)
{
    uint64_t state = 9;
    for (int trial = 0; trial < 600; trial++) {
        const double unit = std::pow(10, 40 * test_uniform(&state) - 20);
        double m[6], value[3], vector[3][3];
        for (double &entry : m) entry = unit * (test_uniform(&state) - 0.5);
        if (trial % 3 == 0) { /* nearly a multiple of one: all eigenvalues nearly equal */
            const double hair = std::pow(10, -17 * test_uniform(&state));
            for (int i = 0; i < 6; i++) m[i] = (i == 0 || i == 3 || i == 5 ? unit : 0) + hair * m[i];
        }
        if (trial % 3 == 1) { /* of rank one, rounded */
            double v[3];
            for (double &c : v) c = test_normal(&state);
            for (int i = 0, e = 0; i < 3; i++)
                for (int j = i; j < 3; j++) m[e++] = unit * v[i] * v[j];
        }
        plm_eigen3(m, value, vector);
        const double size = std::fmax(std::fabs(value[0]), std::fabs(value[2]));
        const rational slack(8 * DBL_EPSILON * size);
        for (int i = 0; i < 3; i++) { /* value[0] is the largest: two are below it */
            assert_true(eigenvalues_below(m, rational(value[i]) - slack) <= 2 - i);
            assert_true(eigenvalues_below(m, rational(value[i]) + slack) >= 3 - i);
        }
    }
}

} // namespace

int main()
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(areas_of_needles_keep_their_digits),
        cmocka_unit_test(hulls_of_cospherical_and_random_points_are_exact),
        cmocka_unit_test(eigenvalues_lie_where_inertia_says),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
