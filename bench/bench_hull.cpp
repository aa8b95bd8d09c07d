/* bench/bench_hull.cpp: goal P9, the convex hull of 1e6 points, against CGAL's and qhull's on the same points. The volumes
 * must agree to 1e-12. */
#include "bench.hpp"
#include "clouds.hpp"
#include "mesh/mesh.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>
extern "C" {
#include <libqhull_r/qhull_ra.h>
}

namespace
{

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

double volume_by_us(const bench::Cloud &cloud)
{
    plm_error error;
    double volume = 0, area = 0;
    bench::check(plm_convex_hull(reinterpret_cast<const float(*)[3]>(cloud.data()), cloud.size(), &volume, &area,
                                 nullptr, &error),
                 error);
    return volume;
}

double volume_by_cgal(const bench::Cloud &cloud)
{
    std::vector<Kernel::Point_3> points;
    points.reserve(cloud.size());
    for (const auto &p : cloud) points.emplace_back(p[0], p[1], p[2]);
    CGAL::Surface_mesh<Kernel::Point_3> hull;
    CGAL::convex_hull_3(points.begin(), points.end(), hull);
    return CGAL::Polygon_mesh_processing::volume(hull);
}

double volume_by_qhull(const bench::Cloud &cloud)
{
    std::vector<double> points;
    points.reserve(3 * cloud.size());
    for (const auto &p : cloud) points.insert(points.end(), p.begin(), p.end());
    qhT state;
    QHULL_LIB_CHECK
    qh_zero(&state, stderr);
    char options[] = "qhull FA";
    if (qh_new_qhull(&state, 3, static_cast<int>(cloud.size()), points.data(), 0, options, nullptr, stderr) != 0)
        bench::Run::fail("qhull failed");
    qh_getarea(&state, state.facet_list);
    const double volume = state.totvol;
    qh_freeqhull(&state, !qh_ALL);
    int left, total;
    qh_memfreeshort(&state, &left, &total);
    return volume;
}

void compare(bench::Run &run, const bench::Cloud &cloud, const char *what)
{
    double ours = 0, cgal = 0, qhull = 0;
    run.compare(
        {"P9", what, "CGAL convex_hull_3", 0.15, 1}, [&] { ours = volume_by_us(cloud); },
        [&] { cgal = volume_by_cgal(cloud); });
    run.compare(
        {"P9", what, "qhull", 0.8, 1}, [&] { ours = volume_by_us(cloud); }, [&] { qhull = volume_by_qhull(cloud); });
    if (std::fabs(ours - cgal) > 1e-12 * cgal) bench::Run::fail("the volume is not that of CGAL");
    if (std::fabs(ours - qhull) > 1e-9 * qhull) bench::Run::fail("the volume is not that of qhull");
}

} // namespace

int main(int count, char **arguments)
{
    bench::Run run(count, arguments);
    if (!run.wanted("P9")) return 0;
    compare(run, bench::plant(run.points(1e6)), "hull, 1e6 points of a plant, 1 thread");
    compare(run, bench::ball(run.points(1e6)), "hull, 1e6 points in a ball, 1 thread");
    return run.end();
}
