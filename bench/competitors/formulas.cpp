/* bench/competitors/formulas.cpp: open formulas on raw points: extents, principal axes, and CGAL's convex hull. */
#include "bench/competitors/competitors.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace competitors
{
namespace
{

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

/** Principal axes, largest first, and the extent of the points along each. */
struct Axes {
    Eigen::Vector3d axis[3];
    double extent[3];
};

/* is_flat: of the projection on the ground. */
Axes axes_of(const Points &points, bool is_flat)
{
    const auto at = [is_flat](const Point &p) {
        return Eigen::Vector3d(static_cast<double>(p[0]), static_cast<double>(p[1]),
                               is_flat ? 0 : static_cast<double>(p[2]));
    };
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const Point &p : points) mean += at(p);
    mean /= static_cast<double>(points.size());
    Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
    for (const Point &p : points) moment += (at(p) - mean) * (at(p) - mean).transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moment);
    Axes made;
    for (int k = 0; k < 3; k++) {
        made.axis[k] = solver.eigenvectors().col(2 - k);
        double low = INFINITY, high = -INFINITY;
        for (const Point &p : points) {
            const double along = made.axis[k].dot(at(p) - mean);
            low = std::min(low, along);
            high = std::max(high, along);
        }
        made.extent[k] = high - low;
    }
    return made;
}

double tilt(const Eigen::Vector3d &axis)
{
    return std::atan2(std::hypot(axis.x(), axis.y()), std::fabs(axis.z()));
}

std::vector<Value> height(const Scene &scene)
{
    float low = INFINITY, high = -INFINITY;
    for (const Point &p : scene.plant) {
        low = std::min(low, p[2]);
        high = std::max(high, p[2]);
    }
    return {{"plant_height", -1, static_cast<double>(high) - static_cast<double>(low)}};
}

std::vector<Value> footprint(const Scene &scene)
{
    const Axes axes = axes_of(scene.plant, true);
    return {{"pca1", -1, axes.extent[0]}, {"pca2", -1, axes.extent[1]}};
}

std::vector<Value> hull(const Scene &scene)
{
    std::vector<Kernel::Point_3> input;
    for (const Point &p : scene.plant) input.emplace_back(p[0], p[1], p[2]);
    CGAL::Surface_mesh<Kernel::Point_3> mesh;
    CGAL::convex_hull_3(input.begin(), input.end(), mesh);
    const Kernel::Point_3 centre = input.front();
    double volume = 0, area = 0;
    for (const auto face : mesh.faces()) {
        std::vector<Kernel::Point_3> corner;
        for (const auto v : CGAL::vertices_around_face(mesh.halfedge(face), mesh)) corner.push_back(mesh.point(v));
        volume += std::fabs(CGAL::volume(centre, corner[0], corner[1], corner[2]));
        area += std::sqrt(CGAL::squared_area(corner[0], corner[1], corner[2]));
    }
    return {{"convex_hull_volume", -1, volume}, {"convex_hull_area", -1, area}};
}

std::vector<Value> leaves(const Scene &scene)
{
    std::vector<Value> values;
    for (const Organ &leaf : scene.leaves) {
        if (leaf.points.size() < 3) continue;
        const Axes axes = axes_of(leaf.points, false);
        values.push_back({"leaf_inclination", leaf.id, tilt(axes.axis[2])});
        values.push_back({"leaf_length", leaf.id, axes.extent[0]});
        values.push_back({"leaf_width", leaf.id, axes.extent[1]});
    }
    return values;
}

/* Petioles point away from the plant's stem: their end farther from the plant's axis is the upper one of the direction. */
std::vector<Value> petioles(const Scene &scene)
{
    std::vector<Value> values;
    Eigen::Vector3d stem = Eigen::Vector3d::Zero();
    double count = 0;
    for (const Organ &organ : scene.stems)
        for (const Point &p : organ.points) {
            stem += Eigen::Vector3d(static_cast<double>(p[0]), static_cast<double>(p[1]), 0);
            count++;
        }
    if (count > 0) stem /= count;
    for (const Organ &petiole : scene.petioles) {
        if (petiole.points.size() < 3) continue;
        const Axes axes = axes_of(petiole.points, false);
        Eigen::Vector3d middle = Eigen::Vector3d::Zero();
        for (const Point &p : petiole.points)
            middle += Eigen::Vector3d(static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2]));
        middle /= static_cast<double>(petiole.points.size());
        Eigen::Vector3d outward(middle.x() - stem.x(), middle.y() - stem.y(), 0);
        Eigen::Vector3d axis = axes.axis[0];
        if (axis.dot(outward) < 0) axis = -axis;
        values.push_back({"petiole_inclination", petiole.id, std::atan2(std::hypot(axis.x(), axis.y()), axis.z())});
        values.push_back({"petiole_length", petiole.id, axes.extent[0]});
    }
    return values;
}

std::vector<Value> stems(const Scene &scene)
{
    std::vector<Value> values;
    for (const Organ &stem : scene.stems) {
        if (stem.points.size() < 3) continue;
        const Axes axes = axes_of(stem.points, false);
        values.push_back({"stem_inclination", stem.id, tilt(axes.axis[0])});
        values.push_back({"stem_length", stem.id, axes.extent[0]});
    }
    return values;
}

} // namespace

std::vector<Method> formula_methods()
{
    return {
        {"open formula", "extent along z", {"plant_height"}, height},
        {"open formula", "extents along the footprint's axes", {"pca1", "pca2"}, footprint},
        {"CGAL convex_hull_3", "raw points", {"convex_hull_volume", "convex_hull_area"}, hull},
        {"open formula", "principal axes of the leaf", {"leaf_inclination", "leaf_length", "leaf_width"}, leaves},
        {"open formula", "principal axis of the petiole", {"petiole_inclination", "petiole_length"}, petioles},
        {"open formula", "principal axis of the stem", {"stem_inclination", "stem_length"}, stems},
    };
}

} // namespace competitors
