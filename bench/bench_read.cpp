/* bench/bench_read.cpp: goal P12: a binary PLY of 5 million points against pcl_io, against `cat` and against a copy; text
 * in MB/s; peak memory against the cloud's. Medians of alternated repeats.
 *
 *   bench_read [POINTS [REPEATS]] */
#include "cloud/guard.hpp"
#include "io/io.h"

#include <pcl/io/ply_io.h>
#include <pcl/point_types.h>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

namespace
{
double seconds()
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double median(std::vector<double> times)
{
    std::sort(times.begin(), times.end());
    return times[times.size() / 2];
}

template <class Work> double timed(Work work)
{
    const double begin = seconds();
    work();
    return seconds() - begin;
}

void check(plm_status status, const plm_error &error)
{
    if (status == PLM_OK) return;
    std::fprintf(stderr, "bench_read: %s\n", error.message);
    std::exit(1);
}

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

void bench_ply(const std::string &path, size_t size, size_t points, int repeats)
{
    const double peak = peak_bytes(path);
    const std::vector<char> bytes(size, 1);
    const std::string cat = "cat " + path + " >/dev/null";
    std::vector<double> own, pcl, plain, copy;
    for (int i = 0; i < repeats; i++) {
        own.push_back(timed([&] { read_once(path); }));
        plain.push_back(timed([&] {
            if (std::system(cat.c_str()) != 0) std::exit(1);
        }));
        copy.push_back(timed([&] { copy_once(bytes); }));
        pcl.push_back(timed([&] {
            pcl::PointCloud<pcl::PointXYZRGB> cloud;
            pcl::io::loadPLYFile(path, cloud);
        }));
    }
    const double allowed = 3 * median(plain) + median(copy);
    std::printf("PLY, %zu points, %.0f MB: %.1f ms; pcl_io %.1f ms, cat %.1f ms, copy %.1f ms\n", points,
                (double)size / 1e6, 1e3 * median(own), 1e3 * median(pcl), 1e3 * median(plain), 1e3 * median(copy));
    std::printf("P12 own / pcl_io               %.3f (goal 0.2)\n", median(own) / median(pcl));
    std::printf("    own / (3 cat + copy)       %.3f (goal 1)\n", median(own) / allowed);
    std::printf("    peak memory / cloud        %.3f (goal 2)\n", peak / (15 * (double)points));
}
} // namespace

int main(int count, char **arguments)
{
    const size_t points = count > 1 ? std::strtoul(arguments[1], nullptr, 10) : 5000000;
    const int repeats = count > 2 ? std::atoi(arguments[2]) : 9;
    const char *base = std::getenv("TMPDIR");
    std::string folder = std::string(base ? base : P_tmpdir) + "/bench_read_XXXXXX";
    if (!mkdtemp(folder.data())) return 1;
    const std::string ply = folder + "/cloud.ply", text = folder + "/cloud.xyz";
    plm_cloud cloud = make_cloud(points);
    const size_t ply_size = write_file(ply, cloud);
    cloud.count = points / 5;
    const size_t text_size = write_file(text, cloud);
    plm_cloud_free(&cloud);
    bench_ply(ply, ply_size, points, repeats);
    std::vector<double> times;
    for (int i = 0; i < repeats; i++) times.push_back(timed([&] { read_once(text); }));
    std::printf("text, %zu points, %.0f MB: %.1f ms, %.0f MB/s (goal 50)\n", points / 5, (double)text_size / 1e6,
                1e3 * median(times), (double)text_size / 1e6 / median(times));
    std::remove(ply.c_str());
    std::remove(text.c_str());
    rmdir(folder.c_str());
    return 0;
}
