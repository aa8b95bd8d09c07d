/* bench/bench_leaf_area.cpp: goals P10 and P11: leaf area from 10 k points (noise 0 to 1 mm, one layer or two, 1 mm apart)
 * against CGAL's Fixed_alpha_shape_3 on the same points in the same run, error and time; then 2 k and 50 k points, and
 * densities 10:1. The leaves are curved ellipses of 80 to 150 cm2 whose area is integrated numerically. Rows of errors
 * stand beside their bar, and beside the rival's error. */
#include "bench.hpp"
#include "mesh/mesh.h"

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Fixed_alpha_shape_3.h>
#include <CGAL/Fixed_alpha_shape_cell_base_3.h>
#include <CGAL/Fixed_alpha_shape_vertex_base_3.h>

#include <array>
#include <random>

namespace
{
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertex = CGAL::Fixed_alpha_shape_vertex_base_3<Kernel>;
using Cell = CGAL::Fixed_alpha_shape_cell_base_3<Kernel>;
using Shape = CGAL::Fixed_alpha_shape_3<
    CGAL::Delaunay_triangulation_3<Kernel, CGAL::Triangulation_data_structure_3<Vertex, Cell>>>;
using Points = std::vector<std::array<float, 3>>;

struct Leaf {
    double a, b;              /* half axes of the outline, metres */
    double arch, cup, ripple; /* curvatures 1/m along and across, and height of a wave at the rim */

    /* Height and slopes over (x, y). */
    std::array<double, 3> at(double x, double y) const
    {
        const double k = 80, q = y * y / (b * b);
        return {0.5 * arch * x * x + 0.5 * cup * y * y + ripple * q * std::sin(k * x),
                arch * x + ripple * q * k * std::cos(k * x), cup * y + 2 * ripple * y / (b * b) * std::sin(k * x)};
    }

    double secant(double x, double y) const
    {
        const auto z = at(x, y);
        return std::sqrt(1 + z[1] * z[1] + z[2] * z[2]);
    }

    double area() const
    {
        const int n = 1200; /* polar midpoint rule */
        double sum = 0;
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++) {
                const double r = (i + 0.5) / n, t = 2 * M_PI * (j + 0.5) / n;
                sum += secant(a * r * std::cos(t), b * r * std::sin(t)) * r;
            }
        return sum * a * b * 2 * M_PI / n / n;
    }
};

const Leaf leaves[] = {{0.07, 0.05, 0, 0, 0}, {0.065, 0.05, 6, 8, 0}, {0.08, 0.045, -5, 4, 0.003}};

enum Noise { ACROSS, ALL_AROUND };

/* Points spread evenly over the surface, or thinning tenfold along it. */
Points sample(const Leaf &leaf, size_t count, double noise, Noise kind, double layers, double gradient, unsigned seed)
{
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::normal_distribution<double> normal;
    const double steepest = 3;
    Points points;
    while (points.size() < count) {
        const double u = 2 * uniform(random) - 1, v = 2 * uniform(random) - 1;
        if (u * u + v * v > 1) continue;
        const double x = leaf.a * u, y = leaf.b * v, secant = leaf.secant(x, y);
        if (uniform(random) * steepest > secant) continue;
        if (uniform(random) > std::pow(gradient, -0.5 * (u + 1))) continue;
        const auto z = leaf.at(x, y);
        const double side = layers > 0 ? (uniform(random) < 0.5 ? -0.5 : 0.5) * layers : 0;
        const double off = (side + noise * normal(random)) / secant;
        double p[3] = {x - z[1] * off, y - z[2] * off, z[0] + off};
        if (kind == ALL_AROUND) {
            const double along = noise * normal(random), beside = noise * normal(random);
            const double run = std::hypot(1, z[1]);
            const double tx[3] = {1 / run, 0, z[1] / run}; /* two unit vectors in the surface, nearly square */
            const double ty[3] = {-z[1] * z[2] / (run * secant), run / secant, z[2] / (run * secant)};
            for (int k = 0; k < 3; k++) p[k] += along * tx[k] + beside * ty[k];
        }
        points.push_back({(float)p[0], (float)p[1], (float)p[2]});
    }
    return points;
}

double own_area(const Points &points)
{
    const plm_surface_options options = {0, -1, -1, 0, 0, 0};
    plm_leaf_surface surface;
    plm_error error;
    const auto *xyz = reinterpret_cast<const float(*)[3]>(points.data());
    bench::check(plm_leaf_surface_make(xyz, points.size(), &options, &surface, &error), error);
    const double area = surface.area;
    plm_leaf_surface_free(&surface);
    return area;
}

/* Half of a closed shell's facets, and all facets that hang free, with alpha 8 spacings. */
double shape_area(const Points &points, double area)
{
    std::vector<Kernel::Point_3> input;
    for (const auto &p : points) input.emplace_back(p[0], p[1], p[2]);
    const double radius = 8 * std::sqrt(area / (double)points.size());
    const Shape shape(input.begin(), input.end(), radius * radius);
    double sum = 0;
    for (auto facet = shape.finite_facets_begin(); facet != shape.finite_facets_end(); ++facet) {
        const auto type = shape.classify(*facet);
        if (type != Shape::REGULAR && type != Shape::SINGULAR) continue;
        sum += std::sqrt(shape.triangle(*facet).squared_area()) * (type == Shape::REGULAR ? 0.5 : 1);
    }
    return sum;
}

/* Mean errors in percent, and what the turns of both rivals took. */
struct Score {
    double error = 0, other = 0;
    std::vector<double> own, rival, ratio;
    size_t count = 0;

    void add(const Leaf &leaf, const Points &points, int repeats)
    {
        const double truth = leaf.area();
        double area = own_area(points);
        error += 100 * std::fabs(area / truth - 1);
        count++;
        for (int i = 0; i < repeats; i++) {
            own.push_back(bench::timed(1, [&] { own_area(points); }));
            rival.push_back(bench::timed(1, [&] { area = shape_area(points, truth); }));
            ratio.push_back(own.back() / rival.back());
        }
        if (repeats > 0) other += 100 * std::fabs(area / truth - 1);
    }
};

void bench_noise(bench::Run &run, Noise kind, const std::string &name)
{
    if (!run.wanted("P10")) return;
    Score score;
    for (const Leaf &leaf : leaves)
        for (double noise : {0.0, 0.25e-3, 0.5e-3, 0.75e-3, 1e-3})
            for (double layers : {0.0, 1e-3}) {
                const auto seed = static_cast<unsigned>(1 + score.count);
                score.add(leaf, sample(leaf, run.points(1e4), noise, kind, layers, 1, seed), run.turns());
            }
    const double n = static_cast<double>(score.count), error = score.error / n, other = score.other / n;
    const std::string what = "leaf area, 1e4 points, noise " + name;
    run.report({"P10", what.c_str(), "bar of the error", 1, 1}, error, 1.5, error / 1.5, "%");
    run.report({"P10", what.c_str(), "its error, Fixed_alpha_shape_3", 1, 1}, error, other, error / other, "%");
    run.report({"P10", what.c_str(), "CGAL Fixed_alpha_shape_3", 0.35, 1}, bench::median(score.own),
               bench::median(score.rival), bench::median(score.ratio), "s");
}

void bench_other(bench::Run &run, const char *what, double count, double gradient, double bar)
{
    if (!run.wanted("P11")) return;
    Score score;
    for (const Leaf &leaf : leaves)
        for (unsigned seed = 1; seed <= 3; seed++)
            score.add(leaf, sample(leaf, run.points(count), 0.3e-3, ACROSS, 0, gradient, seed), 0);
    const double error = score.error / static_cast<double>(score.count);
    run.report({"P11", what, "bar of the error", 1, 1}, error, bar, error / bar, "%");
}
} // namespace

int main(int count, char **arguments)
{
    bench::Run run(count, arguments);
    bench_noise(run, ACROSS, "across");
    bench_noise(run, ALL_AROUND, "all around");
    bench_other(run, "leaf area, 2e3 points", 2e3, 1, 3);
    bench_other(run, "leaf area, 5e4 points", 5e4, 1, 1.5);
    bench_other(run, "leaf area, 1e4 points, densities 10:1", 1e4, 10, 3);
    return run.end();
}
