/* bench/competitors/surfaces.cpp: leaf area by surfaces through the leaf's raw points: CGAL's alpha shapes and advancing front, PCL's
 * greedy projection with and without moving least squares. */
#include "bench/competitors/competitors.hpp"

#include <CGAL/Advancing_front_surface_reconstruction.h>
#include <CGAL/Alpha_shape_3.h>
#include <CGAL/Alpha_shape_cell_base_3.h>
#include <CGAL/Alpha_shape_vertex_base_3.h>
#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <pcl/features/normal_3d.h>
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/search/kdtree.h>
#include <pcl/surface/gp3.h>
#include <pcl/surface/mls.h>

#include <cmath>
#include <iterator>

namespace competitors
{
namespace
{

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertex = CGAL::Alpha_shape_vertex_base_3<Kernel>;
using Cell = CGAL::Alpha_shape_cell_base_3<Kernel>;
using Shape =
    CGAL::Alpha_shape_3<CGAL::Delaunay_triangulation_3<Kernel, CGAL::Triangulation_data_structure_3<Vertex, Cell>>>;
using Cloud = pcl::PointCloud<pcl::PointXYZ>;

std::vector<Kernel::Point_3> for_cgal(const Points &points)
{
    std::vector<Kernel::Point_3> made;
    made.reserve(points.size());
    for (const Point &p : points) made.emplace_back(p[0], p[1], p[2]);
    return made;
}

Cloud::Ptr for_pcl(const Points &points)
{
    Cloud::Ptr made(new Cloud);
    made->reserve(points.size());
    for (const Point &p : points) made->emplace_back(p[0], p[1], p[2]);
    return made;
}

double area_of(const std::array<Kernel::Point_3, 3> &corner)
{
    return std::sqrt(CGAL::squared_area(corner[0], corner[1], corner[2]));
}

/* 1 / sqrt(points per area), from the nearest neighbours: half of it apart, on the mean, where points are random. */
double spacing_of(const Cloud::Ptr &cloud)
{
    pcl::KdTreeFLANN<pcl::PointXYZ> tree;
    tree.setInputCloud(cloud);
    std::vector<int> index(2);
    std::vector<float> squared(2);
    double sum = 0;
    for (const auto &p : *cloud)
        if (tree.nearestKSearch(p, 2, index, squared) == 2) sum += std::sqrt(static_cast<double>(squared[1]));
    return 2 * sum / static_cast<double>(cloud->size());
}

/* A shell's facets count by half, those that hang free whole. spacings 0: the least alpha that leaves one piece. */
double alpha_shape_area(const Points &points, double spacings)
{
    const auto input = for_cgal(points);
    const double radius = spacings * (spacings > 0 ? spacing_of(for_pcl(points)) : 0);
    Shape shape(input.begin(), input.end(), radius * radius, Shape::GENERAL);
    if (spacings == 0) shape.set_alpha(*shape.find_optimal_alpha(1));
    double sum = 0;
    for (auto facet = shape.finite_facets_begin(); facet != shape.finite_facets_end(); ++facet) {
        const auto type = shape.classify(*facet);
        if (type != Shape::REGULAR && type != Shape::SINGULAR) continue;
        sum += std::sqrt(shape.triangle(*facet).squared_area()) * (type == Shape::REGULAR ? 0.5 : 1);
    }
    return sum;
}

double advancing_front_area(const Points &points)
{
    const auto input = for_cgal(points);
    std::vector<std::array<std::size_t, 3>> facets;
    CGAL::advancing_front_surface_reconstruction(input.begin(), input.end(), std::back_inserter(facets));
    double sum = 0;
    for (const auto &f : facets) sum += area_of({input[f[0]], input[f[1]], input[f[2]]});
    return sum;
}

/* The tutorial's settings, the radius in spacings; of points spread at random, mu 2.5 as there leaves holes. */
double greedy_area(const pcl::PointCloud<pcl::PointNormal>::Ptr &cloud, double spacing, double mu)
{
    pcl::search::KdTree<pcl::PointNormal>::Ptr tree(new pcl::search::KdTree<pcl::PointNormal>);
    tree->setInputCloud(cloud);
    pcl::GreedyProjectionTriangulation<pcl::PointNormal> greedy;
    greedy.setSearchRadius(2 * mu * spacing);
    greedy.setMu(mu);
    greedy.setMaximumNearestNeighbors(100);
    greedy.setMaximumSurfaceAngle(M_PI / 4);
    greedy.setMinimumAngle(M_PI / 18);
    greedy.setMaximumAngle(2 * M_PI / 3);
    greedy.setNormalConsistency(false);
    greedy.setInputCloud(cloud);
    greedy.setSearchMethod(tree);
    pcl::PolygonMesh mesh;
    greedy.reconstruct(mesh);
    double sum = 0;
    for (const auto &face : mesh.polygons) {
        const auto a = (*cloud)[face.vertices[0]].getVector3fMap(), b = (*cloud)[face.vertices[1]].getVector3fMap(),
                   c = (*cloud)[face.vertices[2]].getVector3fMap();
        sum += 0.5 * static_cast<double>((b - a).cross(c - a).norm());
    }
    return sum;
}

double raw_greedy_area(const Points &points, double mu)
{
    const Cloud::Ptr cloud = for_pcl(points);
    pcl::NormalEstimation<pcl::PointXYZ, pcl::PointNormal> estimation;
    pcl::PointCloud<pcl::PointNormal>::Ptr with_normals(new pcl::PointCloud<pcl::PointNormal>);
    estimation.setInputCloud(cloud);
    estimation.setSearchMethod(pcl::search::KdTree<pcl::PointXYZ>::Ptr(new pcl::search::KdTree<pcl::PointXYZ>));
    estimation.setKSearch(20);
    estimation.compute(*with_normals);
    for (std::size_t i = 0; i < cloud->size(); i++) (*with_normals)[i].getVector3fMap() = (*cloud)[i].getVector3fMap();
    return greedy_area(with_normals, spacing_of(cloud), mu);
}

double smoothed_greedy_area(const Points &points, double radius)
{
    const Cloud::Ptr cloud = for_pcl(points);
    pcl::MovingLeastSquares<pcl::PointXYZ, pcl::PointNormal> smoothing;
    pcl::PointCloud<pcl::PointNormal>::Ptr smooth(new pcl::PointCloud<pcl::PointNormal>);
    smoothing.setComputeNormals(true);
    smoothing.setInputCloud(cloud);
    smoothing.setPolynomialOrder(2);
    smoothing.setSearchMethod(pcl::search::KdTree<pcl::PointXYZ>::Ptr(new pcl::search::KdTree<pcl::PointXYZ>));
    smoothing.setSearchRadius(radius);
    smoothing.process(*smooth);
    return greedy_area(smooth, spacing_of(cloud), 5);
}

/* Areas of all leaves, and their sum. */
Method area_method(const char *method, const char *setting, std::function<double(const Points &)> area)
{
    const auto measure = [area](const Scene &scene) {
        std::vector<Value> values;
        double sum = 0;
        for (const Organ &leaf : scene.leaves) {
            if (leaf.points.size() < 12) continue;
            const double found = area(leaf.points);
            if (!std::isfinite(found)) continue;
            sum += found;
            values.push_back({"leaf_area", leaf.id, found});
        }
        if (!values.empty()) values.push_back({"total_leaf_area", -1, sum});
        return values;
    };
    return {method, setting, {"leaf_area", "total_leaf_area"}, measure};
}

} // namespace

std::vector<Method> surface_methods()
{
    return {
        area_method("CGAL Alpha_shape_3", "alpha=4 spacings", [](const Points &p) { return alpha_shape_area(p, 4); }),
        area_method("CGAL Alpha_shape_3", "alpha=8 spacings", [](const Points &p) { return alpha_shape_area(p, 8); }),
        area_method("CGAL Alpha_shape_3", "alpha=optimal", [](const Points &p) { return alpha_shape_area(p, 0); }),
        area_method("CGAL advancing front", "plain", advancing_front_area),
        area_method("PCL greedy projection", "mu=2.5", [](const Points &p) { return raw_greedy_area(p, 2.5); }),
        area_method("PCL greedy projection", "mu=5", [](const Points &p) { return raw_greedy_area(p, 5); }),
        area_method("PCL MLS + greedy projection", "radius=5mm",
                    [](const Points &p) { return smoothed_greedy_area(p, 0.005); }),
        area_method("PCL MLS + greedy projection", "radius=10mm",
                    [](const Points &p) { return smoothed_greedy_area(p, 0.01); }),
    };
}

} // namespace competitors
