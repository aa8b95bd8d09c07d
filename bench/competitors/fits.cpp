/* bench/competitors/fits.cpp: tilt of leaves by PCL's normals, and diameter of stems by PCL's RANSAC cylinder. */
#include "bench/competitors/competitors.hpp"

#include <pcl/features/normal_3d.h>
#include <pcl/sample_consensus/ransac.h>
#include <pcl/sample_consensus/sac_model_cylinder.h>
#include <pcl/search/kdtree.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace competitors
{
namespace
{

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
using Normals = pcl::PointCloud<pcl::Normal>;

Cloud::Ptr cloud_of(const Points &points, float low, float high)
{
    Cloud::Ptr made(new Cloud);
    for (const Point &p : points)
        if (p[2] >= low && p[2] <= high) made->emplace_back(p[0], p[1], p[2]);
    return made;
}

Normals::Ptr normals_of(const Cloud::Ptr &cloud, int k)
{
    Normals::Ptr made(new Normals);
    pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
    estimation.setInputCloud(cloud);
    estimation.setSearchMethod(pcl::search::KdTree<pcl::PointXYZ>::Ptr(new pcl::search::KdTree<pcl::PointXYZ>));
    estimation.setKSearch(k);
    estimation.compute(*made);
    return made;
}

/* The tilt of the mean of the normals, all turned up, and the mean of their tilts. */
std::vector<Value> tilts(const Scene &scene, int k)
{
    std::vector<Value> values;
    for (const Organ &leaf : scene.leaves) {
        if (leaf.points.size() < 12) continue;
        const Normals::Ptr normals = normals_of(cloud_of(leaf.points, -INFINITY, INFINITY), k);
        Eigen::Vector3d mean = Eigen::Vector3d::Zero();
        double tilt = 0, count = 0;
        for (const auto &n : *normals) {
            Eigen::Vector3d normal = n.getNormalVector3fMap().cast<double>();
            if (!normal.allFinite()) continue;
            if (normal.z() < 0) normal = -normal;
            mean += normal;
            tilt += std::atan2(std::hypot(normal.x(), normal.y()), normal.z());
            count++;
        }
        if (count == 0) continue;
        values.push_back({"leaf_inclination", leaf.id, std::atan2(std::hypot(mean.x(), mean.y()), mean.z())});
        values.push_back({"facet_inclination_mean", leaf.id, tilt / count});
    }
    return values;
}

/* A cylinder through the slice about 2 cm above the stem's lowest point. */
std::vector<Value> diameters(const Scene &scene, float half_slice)
{
    std::vector<Value> values;
    for (const Organ &stem : scene.stems) {
        float low = INFINITY;
        for (const Point &p : stem.points) low = std::min(low, p[2]);
        const Cloud::Ptr cloud = cloud_of(stem.points, low + 0.02f - half_slice, low + 0.02f + half_slice);
        if (cloud->size() < 10) continue;
        std::srand(1);
        pcl::SampleConsensusModelCylinder<pcl::PointXYZ, pcl::Normal>::Ptr model(
            new pcl::SampleConsensusModelCylinder<pcl::PointXYZ, pcl::Normal>(cloud));
        model->setInputNormals(normals_of(cloud, 10));
        model->setNormalDistanceWeight(0.1);
        model->setRadiusLimits(0.0002,
                               0.015); /* it is helped by what stems are: thin, and within 30 degrees of upright */
        model->setAxis(Eigen::Vector3f::UnitZ());
        model->setEpsAngle(M_PI / 6);
        pcl::RandomSampleConsensus<pcl::PointXYZ> ransac(model, 0.0005);
        ransac.setMaxIterations(2000);
        if (!ransac.computeModel()) continue;
        Eigen::VectorXf found, better;
        pcl::Indices inliers;
        ransac.getModelCoefficients(found);
        ransac.getInliers(inliers);
        model->optimizeModelCoefficients(inliers, found, better);
        values.push_back({"stem_diameter", stem.id, 2 * static_cast<double>(better[6])});
    }
    return values;
}

} // namespace

std::vector<Method> fit_methods()
{
    std::vector<Method> made;
    for (int k : {10, 30, 100})
        made.push_back({"PCL normals",
                        "neighbours=" + std::to_string(k),
                        {"leaf_inclination", "facet_inclination_mean"},
                        [k](const Scene &scene) { return tilts(scene, k); }});
    made.push_back({"PCL RANSAC cylinder", "slice=10mm", {"stem_diameter"}, [](const Scene &scene) {
                        return diameters(scene, 0.005f);
                    }});
    made.push_back({"PCL RANSAC cylinder", "slice=40mm", {"stem_diameter"}, [](const Scene &scene) {
                        return diameters(scene, 0.02f);
                    }});
    return made;
}

} // namespace competitors
