/* bench/competitors/competitors.hpp: plain library methods and open formulas for traits, as somebody would write them first, on plants
 * whose labels are known. They stand beside the program's own estimators in `plantimeter tradeoff`. */
#ifndef PLANTIMETER_BENCH_COMPETITORS_HPP
#define PLANTIMETER_BENCH_COMPETITORS_HPP

#include <array>
#include <functional>
#include <string>
#include <vector>

namespace competitors
{

using Point = std::array<float, 3>; /* metres, z up */
using Points = std::vector<Point>;

struct Organ {
    int id;
    Points points;
};

/** The points that a method may look at, sorted by their labels. */
struct Scene {
    Points plant; /* stems, petioles and leaves */
    std::vector<Organ> stems, petioles, leaves;
};

/** SI; organ -1: of the plant. */
struct Value {
    const char *trait;
    int organ;
    double value;
};

/** One method with one setting: what it gives, and how. Organs that it cannot measure it leaves out. */
struct Method {
    std::string method, setting;
    std::vector<const char *> traits;
    std::function<std::vector<Value>(const Scene &)> measure;
};

/** Areas of leaves by surfaces of CGAL and PCL (surfaces.cpp). */
std::vector<Method> surface_methods();

/** Tilts and diameters by PCL's normals and RANSAC (fits.cpp). */
std::vector<Method> fit_methods();

/** Extents, principal axes and the hull of the raw points (formulas.cpp). */
std::vector<Method> formula_methods();

} // namespace competitors

#endif
