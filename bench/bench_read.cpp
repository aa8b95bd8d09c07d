/* bench/bench_read.cpp: goal P12: a binary PLY of 5 million points against pcl_io, against `cat` and against a copy; text
 * in MB/s; peak memory against the cloud's. */
#include "bench.hpp"
#include "cloud/guard.hpp"
#include "io/io.h"

#include <pcl/io/ply_io.h>
#include <pcl/point_types.h>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

namespace
{
using bench::check;

plm_cloud make_cloud(size_t count)
{
    plm_error error;
    plm_cloud cloud;
    check(plm_cloud_create(count, PLM_HAS_RGB, &cloud, &error), error);
    uint32_t state = 1;
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            state = state * 1664525u + 1013904223u;
            cloud.xyz[i][k] = (float)(state >> 8) * 0x1p-24f;
            cloud.rgb[i][k] = (uint8_t)(state >> 24);
        }
    return cloud;
}

void read_once(const std::string &path)
{
    plm_error error;
    plm_cloud cloud;
    check(plm_cloud_read(path.c_str(), nullptr, &cloud, nullptr, &error), error);
    plm_cloud_free(&cloud);
}

/* Peak memory of a process that reads the file, less that of one that does not. */
double peak_bytes(const std::string &path)
{
    long peak[2];
    for (int i = 0; i < 2; i++) {
        const pid_t child = fork();
        if (child == 0) {
            if (i) read_once(path);
            _exit(0);
        }
        struct rusage used;
        int state;
        wait4(child, &state, 0, &used);
        peak[i] = used.ru_maxrss;
    }
    return (double)(peak[1] - peak[0]) * 1024;
}

void copy_once(const std::vector<char> &from)
{
    char *to = static_cast<char *>(std::malloc(from.size()));
    std::memcpy(to, from.data(), from.size());
    asm volatile("" : : "r"(to) : "memory");
    std::free(to);
}

size_t write_file(const std::string &path, const plm_cloud &cloud)
{
    plm_error error;
    check(plm_cloud_write(path.c_str(), &cloud, &error), error);
    FILE *file = std::fopen(path.c_str(), "rb");
    std::fseek(file, 0, SEEK_END);
    const size_t size = (size_t)std::ftell(file);
    std::fclose(file);
    return size;
}

void bench_ply(bench::Run &run, const std::string &path, size_t size, size_t points)
{
    /* first: a process forked once threads of OpenMP wait would wait for them for ever */
    const double peak = peak_bytes(path), cloud = 15 * static_cast<double>(points);
    const std::vector<char> bytes(size, 1);
    const std::string cat = "cat " + path + " >/dev/null";
    run.compare(
        {"P12", "binary PLY, 5e6 points", "pcl_io loadPLYFile", 0.2, 0}, [&] { read_once(path); },
        [&] {
            pcl::PointCloud<pcl::PointXYZRGB> cloud;
            pcl::io::loadPLYFile(path, cloud);
        });
    run.compare(
        {"P12", "binary PLY, 5e6 points", "cat three times and a copy", 1, 0}, [&] { read_once(path); },
        [&] {
            for (int i = 0; i < 3; i++)
                if (std::system(cat.c_str()) != 0) bench::Run::fail("cat failed");
            copy_once(bytes);
        });
    run.report({"P12", "peak memory of reading", "bytes of the cloud", 2, 0}, peak / 1e6, cloud / 1e6, peak / cloud,
               "MB");
}

void bench_text(bench::Run &run, const std::string &path, size_t size)
{
    std::vector<double> times;
    for (int i = 0; i < 5; i++) times.push_back(bench::timed(0, [&] { read_once(path); }));
    const double seconds = bench::median(times), allowed = static_cast<double>(size) / 50e6;
    run.report({"P12", "text, 1e6 points", "50 MB a second", 1, 0}, seconds, allowed, seconds / allowed, "s");
}
} // namespace

int main(int count, char **arguments)
{
    bench::Run run(count, arguments);
    if (!run.wanted("P12")) return 0;
    const size_t points = run.points(5e6);
    const char *base = std::getenv("TMPDIR");
    std::string folder = std::string(base ? base : P_tmpdir) + "/bench_read_XXXXXX";
    if (!mkdtemp(folder.data())) return 1;
    const std::string ply = folder + "/cloud.ply", text = folder + "/cloud.xyz";
    plm_cloud cloud = make_cloud(points);
    const size_t ply_size = write_file(ply, cloud);
    cloud.count = points / 5;
    const size_t text_size = write_file(text, cloud);
    plm_cloud_free(&cloud);
    bench_ply(run, ply, ply_size, points);
    bench_text(run, text, text_size);
    std::remove(ply.c_str());
    std::remove(text.c_str());
    rmdir(folder.c_str());
    return run.end();
}
