/* bench/fit_problems.hpp: fits whose parameters differ by orders of magnitude or are nearly undetermined: circles and cylinders
 * seen over short arcs, leaf patches seen as strips, rotation axes seen over small turns. Lengths are metres of a plant's size;
 * derivatives are analytic. */
#ifndef PLANTIMETER_FIT_PROBLEMS_HPP
#define PLANTIMETER_FIT_PROBLEMS_HPP

#include <array>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace fits
{

enum { MOST = 6 };
using Parameters = std::array<double, MOST>;
using Place = std::array<double, 3>;
using Row = std::array<double, MOST>;
using Random = std::mt19937_64;

inline double uniform(Random &random)
{
    return std::uniform_real_distribution<double>(0, 1)(random);
}
inline double normal(Random &random)
{
    return std::normal_distribution<double>(0, 1)(random);
}
inline double dot(const Place &a, const Place &b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Place cross(const Place &a, const Place &b)
{
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/** A least-squares problem. Residual number i of count, and its derivatives by the parameters where row is not null. */
struct Problem {
    int size = 0;
    size_t count = 0;
    Parameters truth{}, start{}, typical{};
    virtual ~Problem() = default;
    virtual double residual(size_t i, const double *x, Row *row) const = 0;
    /** How far off the truth the wanted result is, as a share or in radians. */
    virtual double error(const double *x) const = 0;

    double cost(const double *x) const
    {
        double sum = 0;
        for (size_t i = 0; i < count; i++) {
            const double r = residual(i, x, nullptr);
            sum += r * r;
        }
        return 0.5 * sum;
    }
    void model(const double *x, double *matrix, double *gradient) const
    {
        for (int a = 0; a < size; a++) gradient[a] = 0;
        for (int a = 0; a < size * size; a++) matrix[a] = 0;
        Row row{};
        for (size_t i = 0; i < count; i++) {
            const double r = residual(i, x, &row);
            for (int a = 0; a < size; a++) {
                gradient[a] += row[static_cast<size_t>(a)] * r;
                for (int b = 0; b < size; b++)
                    matrix[a * size + b] += row[static_cast<size_t>(a)] * row[static_cast<size_t>(b)];
            }
        }
    }
};

/** Centre and radius of a stem's cross-section; started at the centroid and the mean distance from it. */
struct Circle : Problem {
    std::vector<Place> points;
    Circle(double arc, double noise, size_t points_wanted, Random &random)
    {
        size = 3, count = points_wanted;
        const double r = 0.003, turn = 2 * M_PI * uniform(random);
        truth = {0.02, -0.01, r};
        typical = {r, r, r};
        Place mean{};
        for (size_t i = 0; i < count; i++) {
            const double angle = turn + arc * uniform(random), d = r * (1 + noise * normal(random));
            points.push_back({truth[0] + d * std::cos(angle), truth[1] + d * std::sin(angle), 0});
            for (size_t k = 0; k < 3; k++) mean[k] += points.back()[k] / static_cast<double>(count);
        }
        start = {mean[0], mean[1], 0};
        for (const Place &p : points)
            start[2] += std::hypot(p[0] - mean[0], p[1] - mean[1]) / static_cast<double>(count);
    }
    double residual(size_t i, const double *x, Row *row) const override
    {
        const double u = points[i][0] - x[0], v = points[i][1] - x[1], d = std::hypot(u, v);
        if (row) *row = {d > 0 ? -u / d : 0, d > 0 ? -v / d : 0, -1};
        return d - x[2];
    }
    double error(const double *x) const override
    {
        return std::fabs(x[2] / truth[2] - 1);
    }
};

/** Axis (place at z = 0 and slopes) and radius of a stem piece of 60 mm; started upright through the centroid. */
struct Cylinder : Problem {
    std::vector<Place> points;
    Cylinder(double arc, double noise, size_t points_wanted, Random &random)
    {
        size = 5, count = points_wanted;
        const double r = 0.003, half = 0.03, turn = 2 * M_PI * uniform(random);
        truth = {0.02, -0.01, 0.15, -0.1, r};
        typical = {r, r, 1, 1, r};
        Place d{truth[2], truth[3], 1}, u{1, 0, -truth[2]}, v = cross(d, u);
        for (Place *axis : {&d, &u, &v}) {
            const double length = std::sqrt(dot(*axis, *axis));
            for (double &k : *axis) k /= length;
        }
        Place mean{};
        for (size_t i = 0; i < count; i++) {
            const double angle = turn + arc * uniform(random), at = half * (2 * uniform(random) - 1);
            const double out = r * (1 + noise * normal(random));
            Place p{truth[0], truth[1], 0};
            for (size_t k = 0; k < 3; k++) {
                p[k] += at * d[k] + out * (std::cos(angle) * u[k] + std::sin(angle) * v[k]);
                mean[k] += p[k] / static_cast<double>(count);
            }
            points.push_back(p);
        }
        start = {mean[0], mean[1], 0, 0, 0};
        for (const Place &p : points)
            start[4] += std::hypot(p[0] - mean[0], p[1] - mean[1]) / static_cast<double>(count);
    }
    double residual(size_t i, const double *x, Row *row) const override
    {
        const Place d{x[2], x[3], 1}, w{points[i][0] - x[0], points[i][1] - x[1], points[i][2]};
        const double t = dot(w, d) / dot(d, d);
        const Place gap{w[0] - t * d[0], w[1] - t * d[1], w[2] - t * d[2]};
        const double distance = std::sqrt(dot(gap, gap));
        if (row) {
            const double nx = distance > 0 ? gap[0] / distance : 0, ny = distance > 0 ? gap[1] / distance : 0;
            *row = {-nx, -ny, -t * nx, -t * ny, -1};
        }
        return distance - x[4];
    }
    double error(const double *x) const override
    {
        return std::fabs(x[4] / truth[4] - 1);
    }
};

/** Height, slopes and curvatures of an arched leaf patch of 60 mm, seen as a strip whose width is a share of that; distances at
 * right angles to the surface, to first order. Started flat. */
struct Surface : Problem {
    std::vector<Place> points;
    Surface(double width, double noise, size_t points_wanted, Random &random)
    {
        size = 6, count = points_wanted;
        const double half = 0.03;
        truth = {0.002, 0.6, -0.3, 20, 5, -8};
        typical = {half, 1, 1, 1 / half, 1 / half, 1 / half};
        for (size_t i = 0; i < count; i++) {
            const double x = half * (2 * uniform(random) - 1), y = width * half * (2 * uniform(random) - 1);
            double h, fx, fy;
            shape(truth.data(), x, y, h, fx, fy);
            const double off = noise * half * normal(random), g = std::sqrt(1 + fx * fx + fy * fy);
            points.push_back({x - off * fx / g, y - off * fy / g, h + off / g});
        }
    }
    static void shape(const double *p, double x, double y, double &h, double &fx, double &fy)
    {
        h = p[0] + p[1] * x + p[2] * y + 0.5 * p[3] * x * x + p[4] * x * y + 0.5 * p[5] * y * y;
        fx = p[1] + p[3] * x + p[4] * y;
        fy = p[2] + p[4] * x + p[5] * y;
    }
    double residual(size_t i, const double *p, Row *row) const override
    {
        const double x = points[i][0], y = points[i][1];
        double h, fx, fy;
        shape(p, x, y, h, fx, fy);
        const double off = points[i][2] - h, g = 1 + fx * fx + fy * fy, root = std::sqrt(g);
        if (row) {
            const Row basis{1, x, y, 0.5 * x * x, x * y, 0.5 * y * y}, dx{0, 1, 0, x, y, 0}, dy{0, 0, 1, 0, x, y};
            for (size_t a = 0; a < MOST; a++)
                (*row)[a] = -basis[a] / root - off * (fx * dx[a] + fy * dy[a]) / (g * root);
        }
        return off / root;
    }
    double error(const double *x) const override
    {
        return std::hypot(x[1] - truth[1], x[2] - truth[2]);
    }
};

/** Axis of a turntable (place at z = 0 and slopes) from points seen before and after a turn by a known angle, with noise as a
 * share of the 50 mm that they are spread over; started upright, 30 mm off. */
struct Axis : Problem {
    std::vector<Place> before, after;
    double cosine, sine;
    Axis(double turn, double noise, size_t points_wanted, Random &random) : cosine(std::cos(turn)), sine(std::sin(turn))
    {
        size = 4, count = 3 * points_wanted;
        const double half = 0.05;
        truth = {0.02, -0.01, 0.05, -0.08};
        typical = {half, half, 1, 1};
        start = {truth[0] + 0.03, truth[1], 0, 0};
        for (size_t i = 0; i < points_wanted; i++) {
            Place p{}, q{};
            for (double &k : p) k = half * (2 * uniform(random) - 1);
            p[2] += half;
            turned(truth.data(), p, q);
            for (double &k : q) k += noise * half * normal(random);
            before.push_back(p), after.push_back(q);
        }
    }
    static Place direction(const double *x, double &length)
    {
        length = std::sqrt(x[2] * x[2] + x[3] * x[3] + 1);
        return {x[2] / length, x[3] / length, 1 / length};
    }
    /** O. Rodrigues' rotation of w about k. */
    Place rotated(const Place &k, const Place &w) const
    {
        const Place across = cross(k, w);
        Place out{};
        for (size_t i = 0; i < 3; i++) out[i] = w[i] * cosine + across[i] * sine + k[i] * dot(k, w) * (1 - cosine);
        return out;
    }
    void turned(const double *x, const Place &p, Place &out) const
    {
        double length;
        const Place w{p[0] - x[0], p[1] - x[1], p[2]};
        out = rotated(direction(x, length), w);
        out[0] += x[0], out[1] += x[1];
    }
    double residual(size_t number, const double *x, Row *row) const override
    {
        const size_t i = number / 3, part = number % 3;
        Place q{};
        turned(x, before[i], q);
        if (row) {
            double length;
            const Place k = direction(x, length), w{before[i][0] - x[0], before[i][1] - x[1], before[i][2]};
            *row = Row{};
            for (size_t a = 0; a < 2; a++) {
                Place unit{}, bent{};
                unit[a] = 1;
                for (size_t c = 0; c < 3; c++) bent[c] = (unit[c] - k[c] * k[a]) / length;
                (*row)[a] = unit[part] - rotated(k, unit)[part];
                (*row)[2 + a] =
                    sine * cross(bent, w)[part] + (1 - cosine) * (bent[part] * dot(k, w) + k[part] * dot(bent, w));
            }
        }
        return q[part] - after[i][part];
    }
    double error(const double *x) const override
    {
        double length;
        const Place found = direction(x, length), was = direction(truth.data(), length), apart = cross(found, was);
        return std::asin(std::fmin(1, std::sqrt(dot(apart, apart))));
    }
};

} // namespace fits

#endif
