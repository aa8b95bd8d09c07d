/* bench/competitors/competitors.cpp: the program plantimeter-competitors, which `plantimeter tradeoff` runs.
 *
 *   plantimeter-competitors --list
 *   plantimeter-competitors --method M --setting S [--points N] [--scale METRES_PER_UNIT] [--up z] [--labels FIELD]
 *                           [--threads N] [--repeats N] CLOUD
 *
 * CLOUD must have labels and organ numbers: these methods find no organs. Prints a JSON object a line: a method (--list), or a
 * value with the seconds and the peak memory of the whole method on the plant. Thinning to N points counts, by the hash that
 * the program itself thins by; reading and turning z up do not. */
#include "bench/competitors/competitors.hpp"

#include "io/io.h"
#include "segment/segment.h"
#include "traits/traits.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <exception>
#include <map>
#include <omp.h>
#include <pcl/console/print.h>
#include <sys/resource.h>

extern "C" {
#include "cloud/subset.h"
}

using namespace competitors;

namespace
{

struct Settings {
    std::string method, setting, labels = "label", up = "auto", path;
    std::size_t points = 0;
    double scale = 1;
    int threads = 1, repeats = 1;
    bool is_list = false;
};

[[noreturn]] void fail(const std::string &why)
{
    std::string text;
    for (char c : why) text += c == '"' || c == '\\' || static_cast<unsigned char>(c) < 32 ? ' ' : c;
    std::printf("{\"failure\": \"%s\"}\n", text.c_str());
    std::exit(0);
}

Settings parse(int count, char **argument)
{
    Settings made;
    for (int i = 1; i < count; i++) {
        const std::string option = argument[i];
        if (option == "--list") {
            made.is_list = true;
            continue;
        }
        if (option.compare(0, 2, "--") != 0) {
            made.path = option;
            continue;
        }
        if (++i == count) fail(option + " needs a value");
        const char *value = argument[i];
        if (option == "--method")
            made.method = value;
        else if (option == "--setting")
            made.setting = value;
        else if (option == "--points")
            made.points = std::strtoull(value, nullptr, 10);
        else if (option == "--scale")
            made.scale = std::atof(value);
        else if (option == "--up")
            made.up = value;
        else if (option == "--labels")
            made.labels = value;
        else if (option == "--threads")
            made.threads = std::max(1, std::atoi(value));
        else if (option == "--repeats")
            made.repeats = std::max(1, std::atoi(value));
        else
            fail("unknown option " + option);
    }
    return made;
}

std::vector<Method> all_methods()
{
    std::vector<Method> made;
    for (const auto &part : {surface_methods(), fit_methods(), formula_methods()})
        made.insert(made.end(), part.begin(), part.end());
    return made;
}

void list(const std::vector<Method> &methods)
{
    for (const Method &m : methods) {
        std::printf("{\"method\": \"%s\", \"setting\": \"%s\", \"traits\": [", m.method.c_str(), m.setting.c_str());
        for (std::size_t k = 0; k < m.traits.size(); k++) std::printf("%s\"%s\"", k ? ", " : "", m.traits[k]);
        std::printf("]}\n");
    }
}

/* As the program reads it: metres, z up. */
plm_cloud read(const Settings &settings)
{
    plm_read_options options = {};
    options.label_field = settings.labels.c_str();
    plm_cloud cloud;
    plm_error error = {};
    if (plm_cloud_read(settings.path.c_str(), &options, &cloud, nullptr, &error) != PLM_OK) fail(error.message);
    if (!cloud.label || !cloud.organ) fail(settings.path + ": has no labels with organ numbers");
    plm_cloud_rescale(&cloud, settings.scale);
    static const char *const words[] = {"auto", "x", "y", "z", "-x", "-y", "-z"};
    int up = 0;
    while (up < 6 && settings.up != words[up]) up++;
    plm_frame frame;
    if (plm_find_up(&cloud, static_cast<plm_up>(up), &frame, &error) != PLM_OK) fail(error.message);
    plm_frame_apply(&frame, &cloud);
    return cloud;
}

std::vector<Organ> organs(std::map<int, Points> &&found)
{
    std::vector<Organ> made;
    for (auto &organ : found) made.push_back({organ.first, std::move(organ.second)});
    return made;
}

/* The rows that are looked at, sorted by their labels. */
Scene make_scene(const plm_cloud &cloud, std::size_t points)
{
    std::vector<uint32_t> row(cloud.count);
    std::size_t count = cloud.count;
    for (std::size_t i = 0; i < count; i++) row[i] = static_cast<uint32_t>(i);
    const auto *xyz = reinterpret_cast<const float(*)[3]>(cloud.xyz);
    if (points > 0 && points < count) count = plm_sample_rows(xyz, cloud.count, points, row.data());
    Scene scene;
    std::map<int, Points> found[PLM_LABEL_COUNT];
    for (std::size_t k = 0; k < count; k++) {
        const uint32_t i = row[k];
        const uint8_t label = cloud.label[i];
        if (label < PLM_LABEL_STEM || label > PLM_LABEL_LEAF) continue;
        const Point p = {cloud.xyz[i][0], cloud.xyz[i][1], cloud.xyz[i][2]};
        scene.plant.push_back(p);
        if (cloud.organ[i] >= 0) found[label][cloud.organ[i]].push_back(p);
    }
    scene.stems = organs(std::move(found[PLM_LABEL_STEM]));
    scene.petioles = organs(std::move(found[PLM_LABEL_PETIOLE]));
    scene.leaves = organs(std::move(found[PLM_LABEL_LEAF]));
    return scene;
}

/* Processor time for one thread, as `plantimeter tradeoff` takes it of its own runs. */
double now(const Settings &settings)
{
    timespec time;
    clock_gettime(settings.threads == 1 ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void run(const Settings &settings, const Method &method)
{
    const double enough_seconds = 10;
    const plm_cloud cloud = read(settings);
    std::vector<double> seconds;
    std::vector<Value> values;
    double total = 0;
    rusage usage = {};
    std::size_t looked_at = settings.points > 0 && settings.points < cloud.count ? settings.points : cloud.count;
    while (seconds.empty() || (static_cast<int>(seconds.size()) < settings.repeats && total < enough_seconds)) {
        const double begin = now(settings);
        const Scene scene = make_scene(cloud, settings.points);
        values = method.measure(scene);
        seconds.push_back(now(settings) - begin);
        total += seconds.back();
        if (seconds.size() == 1) getrusage(RUSAGE_SELF, &usage);
    }
    std::sort(seconds.begin(), seconds.end());
    const std::size_t n = seconds.size();
    const double median = n % 2 ? seconds[n / 2] : 0.5 * (seconds[n / 2 - 1] + seconds[n / 2]);
    char cost[160];
    std::snprintf(cost, sizeof cost, "\"seconds\": %.9g, \"peak_bytes\": %ld, \"points\": %zu", median,
                  usage.ru_maxrss * 1024L, looked_at);
    std::printf("{%s}\n", cost);
    for (const Value &v : values)
        if (std::isfinite(v.value))
            std::printf("{\"trait\": \"%s\", \"organ_id\": %d, \"value\": %.17g, %s}\n", v.trait, v.organ, v.value,
                        cost);
}

} // namespace

int main(int count, char **argument)
{
    pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
    const Settings settings = parse(count, argument);
    const std::vector<Method> methods = all_methods();
    if (settings.is_list) {
        list(methods);
        return 0;
    }
    omp_set_num_threads(settings.threads);
    for (const Method &m : methods)
        if (m.method == settings.method && m.setting == settings.setting) {
            try {
                run(settings, m);
            } catch (const std::exception &problem) {
                fail(problem.what());
            }
            return 0;
        }
    fail("no method \"" + settings.method + "\" with setting \"" + settings.setting + "\"");
}
