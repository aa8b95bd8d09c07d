/* bench/bench_neighbours.cpp: goals P1 to P4, P6 to P8 and P13 (P5: bench/instructions.sh), all nearest neighbours and what is measured from them, against PCL and
 * FLANN on the same points in the same (random) order. Own sorting is counted. */
#include "bench.hpp"
#include "clouds.hpp"
extern "C" {
#include "cloud/morton.h"
#include "cloud/neighbours.h"
#include "cloud/smoothness.h"
}

#include <flann/flann.h>
#include <pcl/features/normal_3d_omp.h>
#include <pcl/filters/statistical_outlier_removal.h>
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>

#include <numeric>

namespace
{

constexpr size_t neighbours = 16;
using Points = const float (*)[3];

Points points_of(const bench::Cloud &cloud)
{
    return reinterpret_cast<Points>(cloud.data());
}

/* ---- Ours ---- */

void pass(const bench::Cloud &cloud, const plm_neighbour_measures &out)
{
    plm_error error;
    bench::check(plm_neighbour_pass(points_of(cloud), cloud.size(), neighbours, &out, &error), error);
}

std::vector<float> smoothness_by_us(const bench::Cloud &cloud)
{
    std::vector<float> smoothness(cloud.size());
    plm_neighbour_measures out = {};
    out.smoothness = smoothness.data();
    pass(cloud, out);
    return smoothness;
}

void table_by_us(const bench::Cloud &cloud, std::vector<uint32_t> &row, std::vector<float> &squared)
{
    plm_error error;
    bench::check(plm_neighbour_table(points_of(cloud), cloud.size(), neighbours, row.data(), squared.data(), &error),
                 error);
}

/* ---- Theirs ---- */

pcl::PointCloud<pcl::PointXYZ>::Ptr to_pcl(const bench::Cloud &cloud)
{
    pcl::PointCloud<pcl::PointXYZ>::Ptr points(new pcl::PointCloud<pcl::PointXYZ>);
    points->reserve(cloud.size());
    for (const auto &p : cloud) points->emplace_back(p[0], p[1], p[2]);
    return points;
}

/** Smoothness factor of a point from rows and squared distances, as one writes it. */
template <class Row> float smoothness_of(Points xyz, size_t self, const Row *row, const float *squared, size_t count)
{
    float sum[3] = {0, 0, 0};
    int apart = 0;
    for (size_t j = 0; j < count; j++) {
        if (!(squared[j] > 0)) continue;
        const float scale = 1 / std::sqrt(squared[j]);
        for (int axis = 0; axis < 3; axis++) sum[axis] += (xyz[row[j]][axis] - xyz[self][axis]) * scale;
        apart++;
    }
    return apart ? std::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]) / static_cast<float>(apart) : 0;
}

std::vector<float> smoothness_by_pcl(const bench::Cloud &cloud, const pcl::PointCloud<pcl::PointXYZ>::Ptr &points)
{
    pcl::KdTreeFLANN<pcl::PointXYZ> tree;
    tree.setInputCloud(points);
    std::vector<float> smoothness(cloud.size());
#pragma omp parallel
    {
        pcl::Indices row;
        std::vector<float> squared;
#pragma omp for schedule(dynamic, 1024)
        for (size_t i = 0; i < cloud.size(); i++) {
            const int found = tree.nearestKSearch((*points)[i], neighbours + 1, row, squared);
            smoothness[i] = smoothness_of(points_of(cloud), i, row.data(), squared.data(), static_cast<size_t>(found));
        }
    }
    return smoothness;
}

void table_by_flann(const bench::Cloud &cloud, std::vector<int> &row, std::vector<float> &squared, int leaf)
{
    constexpr size_t chunk =
        65536; /* rows asked at once: with all of them FLANN is slower and takes 4 times the memory */
    FLANNParameters parameters = DEFAULT_FLANN_PARAMETERS;
    parameters.algorithm = FLANN_INDEX_KDTREE_SINGLE;
    parameters.leaf_max_size = leaf;
    parameters.eps = 0;
    parameters.cores = omp_get_max_threads();
    float speedup;
    float *data = const_cast<float *>(&cloud[0][0]);
    flann_index_t index = flann_build_index(data, static_cast<int>(cloud.size()), 3, &speedup, &parameters);
    for (size_t begin = 0; begin < cloud.size(); begin += chunk) {
        const size_t count = std::min(chunk, cloud.size() - begin), at = begin * (neighbours + 1);
        flann_find_nearest_neighbors_index(index, data + 3 * begin, static_cast<int>(count), &row[at], &squared[at],
                                           neighbours + 1, &parameters);
    }
    flann_free_index(index, &parameters);
}

void measures_by_pcl(const pcl::PointCloud<pcl::PointXYZ>::Ptr &points)
{
    pcl::StatisticalOutlierRemoval<pcl::PointXYZ> outliers;
    outliers.setInputCloud(points);
    outliers.setMeanK(neighbours);
    pcl::Indices kept;
    outliers.filter(kept);
    pcl::NormalEstimationOMP<pcl::PointXYZ, pcl::Normal> estimation(static_cast<unsigned>(omp_get_max_threads()));
    estimation.setInputCloud(points);
    estimation.setSearchMethod(pcl::search::KdTree<pcl::PointXYZ>::Ptr(new pcl::search::KdTree<pcl::PointXYZ>));
    estimation.setKSearch(neighbours);
    pcl::PointCloud<pcl::Normal> normals;
    estimation.compute(normals);
}

/* ---- The goals ---- */

/** Equal but for float rounding; where two points are equally far for the last place, PCL takes any of them. */
void check_equal(const std::vector<float> &ours, const std::vector<float> &theirs)
{
    size_t apart = 0;
    for (size_t i = 0; i < ours.size(); i++) apart += !(std::fabs(ours[i] - theirs[i]) < 1e-5f);
    if (apart > 1 + ours.size() / 10000) {
        std::fprintf(stderr, "%zu of %zu: ", apart, ours.size());
        bench::Run::fail("smoothness is not that of PCL");
    }
}

double compare_smoothness(bench::Run &run, const bench::Goal &goal, const bench::Cloud &cloud)
{
    if (!run.wanted(goal.id)) return NAN;
    const auto points = to_pcl(cloud);
    std::vector<float> ours, theirs;
    const double seconds = run.compare(
        goal, [&] { ours = smoothness_by_us(cloud); }, [&] { theirs = smoothness_by_pcl(cloud, points); });
    check_equal(ours, theirs);
    return seconds;
}

void p2_many_points(bench::Run &run)
{
    if (!run.wanted("P2")) return;
    double seconds[2];
    {
        const bench::Cloud cloud = bench::plant(run.points(1e6));
        seconds[0] = bench::timed(2, [&] { smoothness_by_us(cloud); });
        seconds[0] = std::min(seconds[0], bench::timed(2, [&] { smoothness_by_us(cloud); }));
    }
    const bench::Cloud cloud = bench::plant(run.points(5e6));
    seconds[1] =
        compare_smoothness(run, {"P2", "SF, 5e6 points of a plant, 2 threads", "PCL KdTreeFLANN", 0.15, 2}, cloud);
    run.report({"P2", "SF, growth from 1e6 to 5e6 points", "1e6 points", 7, 2}, seconds[1], seconds[0],
               seconds[1] / seconds[0], "s");
}

/** What cannot be saved: the keys sorted once, and the smoothness factor from known neighbours. */
void p3_floor(bench::Run &run, const bench::Cloud &cloud)
{
    if (!run.wanted("P3")) return;
    std::vector<uint32_t> row(cloud.size() * neighbours);
    std::vector<float> squared(row.size()), smoothness(cloud.size());
    table_by_us(cloud, row, squared);
    run.compare(
        {"P3", "SF, 1e6 points of a plant, 1 thread", "floor: known neighbours + a sort", 6, 1},
        [&] { smoothness_by_us(cloud); },
        [&] {
            plm_error error;
            plm_keys keys;
            bench::check(plm_keys_create(cloud.size(), &keys, &error), error);
            for (size_t i = 0; i < cloud.size(); i++) {
                uint64_t number[3];
                for (int axis = 0; axis < 3; axis++) number[axis] = static_cast<uint64_t>((cloud[i][axis] + 1) * 1000);
                keys.key[i] = plm_morton_key(number[0], number[1], number[2]);
                keys.row[i] = static_cast<uint32_t>(i);
            }
            bench::check(plm_keys_sort(&keys, 33, &error), error);
            plm_keys_free(&keys);
            for (size_t i = 0; i < cloud.size(); i++)
                smoothness[i] =
                    smoothness_of(points_of(cloud), i, &row[i * neighbours], &squared[i * neighbours], neighbours);
        });
}

void p4_densities(bench::Run &run)
{
    if (!run.wanted("P4")) return;
    const bench::Cloud mixed = bench::two_densities(run.points(1e6)), uniform = bench::box(run.points(1e6));
    compare_smoothness(run, {"P4", "SF, 1e6, densities 30:1 side by side, 1 thread", "PCL KdTreeFLANN", 0.25, 1},
                       mixed);
    run.compare(
        {"P4", "SF, 1e6, densities 30:1 side by side, 1 thread", "own, one density", 2, 1},
        [&] { smoothness_by_us(mixed); }, [&] { smoothness_by_us(uniform); });
}

void p6_table(bench::Run &run, const bench::Cloud &cloud)
{
    if (!run.wanted("P6")) return;
    plm_error error;
    plm_keys keys;
    bench::check(plm_keys_create(cloud.size(), &keys, &error), error);
    for (size_t i = 0; i < cloud.size(); i++) {
        uint64_t number[3];
        for (int axis = 0; axis < 3; axis++) number[axis] = static_cast<uint64_t>((cloud[i][axis] + 1) * 100000);
        keys.key[i] = plm_morton_key(number[0], number[1], number[2]);
        keys.row[i] = static_cast<uint32_t>(i);
    }
    bench::check(plm_keys_sort(&keys, 54, &error), error);
    bench::Cloud sorted(cloud.size());
    for (size_t i = 0; i < cloud.size(); i++) sorted[i] = cloud[keys.row[i]];
    plm_keys_free(&keys);
    std::vector<uint32_t> row(cloud.size() * neighbours);
    std::vector<float> squared(row.size());
    std::vector<int> flann_row(cloud.size() * (neighbours + 1));
    std::vector<float> flann_squared(flann_row.size());
    run.compare(
        {"P6", "kNN table, 1e6 points of a plant, 1 thread", "FLANN C, points sorted for it", 0.85, 1},
        [&] { table_by_us(cloud, row, squared); }, [&] { table_by_flann(sorted, flann_row, flann_squared, 32); });
}

void p7_fused(bench::Run &run, const bench::Cloud &cloud)
{
    if (!run.wanted("P7")) return;
    const auto points = to_pcl(cloud);
    std::vector<float> smoothness(cloud.size()), distance(cloud.size()), normal(3 * cloud.size()),
        curvature(cloud.size());
    const plm_neighbour_measures out = {smoothness.data(), distance.data(),
                                        reinterpret_cast<float(*)[3]>(normal.data()), curvature.data()};
    run.compare(
        {"P7", "SF + distance + normals, 1e6, 1 thread", "PCL outliers + normals", 0.25, 1}, [&] { pass(cloud, out); },
        [&] { measures_by_pcl(points); });
}

/* Bytes in use and the most there were, counted in front of each block. */
size_t in_use, most_in_use;

void *counting_reallocate(void *block, size_t size, void *)
{
    constexpr size_t head = 16;
    char *old = block ? static_cast<char *>(block) - head : nullptr;
    const size_t before = old ? *reinterpret_cast<size_t *>(old) : 0;
    char *result = static_cast<char *>(std::realloc(old, size + head));
    if (!result) return nullptr;
    *reinterpret_cast<size_t *>(result) = size;
#pragma omp critical
    {
        in_use += size - before;
        most_in_use = std::max(most_in_use, in_use + (old ? before : 0));
    }
    return result + head;
}

void counting_release(void *block, void *)
{
    if (!block) return;
    char *old = static_cast<char *>(block) - 16;
#pragma omp critical
    in_use -= *reinterpret_cast<size_t *>(old);
    std::free(old);
}

void p8_memory(bench::Run &run, const bench::Cloud &cloud)
{
    if (!run.wanted("P8")) return;
    const plm_allocator counting = {counting_reallocate, counting_release, nullptr};
    plm_set_allocator(&counting);
    smoothness_by_us(cloud);
    plm_set_allocator(nullptr);
    const double raw = 12.0 * static_cast<double>(cloud.size());
    const double used = raw + static_cast<double>(most_in_use) + 4.0 * static_cast<double>(cloud.size());
    run.report({"P8", "peak memory of SF, points and result included", "bytes of xyz", 5, 2}, used / 1e6, raw / 1e6,
               used / raw, "MB");
}

/** One run of one rival on 1e5 points and one thread, for bench/instructions.sh to count its instructions (goal P5). */
int run_once(const std::string &who)
{
    omp_set_num_threads(1);
    const bench::Cloud cloud = bench::box(100000);
    std::vector<float> smoothness(cloud.size());
    if (who == "ours") smoothness = smoothness_by_us(cloud);
    if (who == "flann") {
        std::vector<int> row(cloud.size() * (neighbours + 1));
        std::vector<float> squared(row.size());
        table_by_flann(cloud, row, squared, 16);
        for (size_t i = 0; i < cloud.size(); i++)
            smoothness[i] = smoothness_of(points_of(cloud), i, &row[i * (neighbours + 1)],
                                          &squared[i * (neighbours + 1)], neighbours + 1);
    }
    return std::accumulate(smoothness.begin(), smoothness.end(), 0.0) < 0;
}

} // namespace

int main(int count, char **arguments)
{
    if (count == 3 && std::string(arguments[1]) == "--once") return run_once(arguments[2]);
    bench::Run run(count, arguments);
    {
        const bench::Cloud plant = bench::plant(run.points(1e6));
        compare_smoothness(run, {"P1", "SF, 1e6 points of a plant, 1 thread", "PCL KdTreeFLANN", 0.22, 1}, plant);
        compare_smoothness(run, {"P1", "SF, 1e6 points of a plant, 2 threads", "PCL KdTreeFLANN", 0.22, 2}, plant);
        p3_floor(run, plant);
        p6_table(run, plant);
        p7_fused(run, plant);
        p8_memory(run, plant);
        if (run.wanted("P13")) {
            const auto on = [&](int threads) { omp_set_num_threads(threads), smoothness_by_us(plant); };
            run.compare(
                {"P13", "SF, 1e6 points of a plant, 2 threads", "1 thread (wall times)", 0.62, 0}, [&] { on(2); },
                [&] { on(1); });
        }
    }
    if (run.wanted("P1")) {
        const bench::Cloud box = bench::box(run.points(1e6));
        compare_smoothness(run, {"P1", "SF, 1e6 points in a box, 1 thread", "PCL KdTreeFLANN", 0.22, 1}, box);
    }
    p2_many_points(run);
    p4_densities(run);
    return run.end();
}
