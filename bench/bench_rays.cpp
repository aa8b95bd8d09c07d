/* bench/bench_rays.cpp: goals L1 and L2, the light run and the dome scan of the laser-scanning paper's tomato, against Embree's bare rate:
 * the same rays, scattered ones too, made before the clock starts, cast one by one by rtcIntersect1 and eight by eight by
 * rtcIntersect8. Figures are seconds
 * for a million rays. Rows L3 and L4 are the whole runs beside the paper's seconds (i7-4710MQ, 4 cores). */
#include "bench.hpp"

extern "C" {
#include "cloud/linear.h"
#include "cloud/random.h"
#include "simulate/light_rays.h"
#include "simulate/rays.h"
#include "simulate/scan.h"
}

#include <embree3/rtcore.h>
#include <memory>

namespace
{

/** Rays and a scene of our own. */
struct Bare {
    RTCDevice device = rtcNewDevice("threads=1");
    RTCScene scene = rtcNewScene(device);
    std::vector<float> ray; /* origin and direction, six a ray */
    size_t hits = 0;

    explicit Bare(const plm_mesh &mesh)
    {
        RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
        auto *points = static_cast<float *>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertex_count));
        auto *corners = static_cast<unsigned *>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), mesh.triangle_count));
        for (size_t i = 0; i < 3 * mesh.vertex_count; i++) points[i] = static_cast<float>(mesh.vertex[i / 3][i % 3]);
        for (size_t i = 0; i < 3 * mesh.triangle_count; i++) corners[i] = mesh.triangle[i / 3][i % 3];
        rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene);
    }

    ~Bare()
    {
        rtcReleaseScene(scene);
        rtcReleaseDevice(device);
    }

    void add(const double origin[3], const double direction[3])
    {
        for (int i = 0; i < 3; i++) ray.push_back(static_cast<float>(origin[i]));
        for (int i = 0; i < 3; i++) ray.push_back(static_cast<float>(direction[i]));
    }

    size_t count() const
    {
        return ray.size() / 6;
    }

    /** Adds what becomes of the rays from number first on: each that meets a face goes on from there, scattered to one side of it.
     * Gives the number of the first new ray. */
    size_t scatter(size_t first, double gap)
    {
        const size_t last = count();
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        for (size_t k = first; k < last; k++) {
            RTCRayHit one = made(k);
            rtcIntersect1(scene, &context, &one);
            if (one.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;
            const float t = one.ray.tfar;
            double normal[3] = {one.hit.Ng_x, one.hit.Ng_y, one.hit.Ng_z}, u[3], v[3], origin[3], direction[3];
            const double before[3] = {one.ray.dir_x, one.ray.dir_y, one.ray.dir_z};
            const bool is_reflected = plm_uniform_at(7, 3 * k) < 0.87; /* of what is not absorbed, all bands together */
            const double side = (plm_dot(normal, before) < 0) == is_reflected ? 1 : -1;
            plm_normalise(normal);
            plm_frame_of_axis(normal, u, v);
            const double share = plm_uniform_at(7, 3 * k + 1), r = std::sqrt(share), up = side * std::sqrt(1 - share);
            const double round = 2 * M_PI * plm_uniform_at(7, 3 * k + 2);
            for (int i = 0; i < 3; i++) {
                direction[i] = r * std::cos(round) * u[i] + r * std::sin(round) * v[i] + up * normal[i];
                origin[i] =
                    static_cast<double>(ray[6 * k + static_cast<size_t>(i)] + t * static_cast<float>(before[i])) +
                    gap * side * normal[i];
            }
            add(origin, direction);
        }
        return last;
    }

    RTCRayHit made(size_t k) const
    {
        const float *from = &ray[6 * k];
        RTCRayHit one = {};
        one.ray.org_x = from[0], one.ray.org_y = from[1], one.ray.org_z = from[2];
        one.ray.dir_x = from[3], one.ray.dir_y = from[4], one.ray.dir_z = from[5];
        one.ray.tfar = INFINITY;
        one.ray.mask = ~0u;
        one.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        return one;
    }

    void one_by_one()
    {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        for (size_t k = 0; k < count(); k++) {
            RTCRayHit one = made(k);
            rtcIntersect1(scene, &context, &one);
            hits += one.hit.geomID != RTC_INVALID_GEOMETRY_ID;
        }
    }

    void eight_by_eight()
    {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
        alignas(32) const int valid[8] = {-1, -1, -1, -1, -1, -1, -1, -1};
        for (size_t first = 0; first + 8 <= count(); first += 8) {
            RTCRayHit8 eight = {};
            for (size_t k = 0; k < 8; k++) {
                const float *from = &ray[6 * (first + k)];
                eight.ray.org_x[k] = from[0], eight.ray.org_y[k] = from[1], eight.ray.org_z[k] = from[2];
                eight.ray.dir_x[k] = from[3], eight.ray.dir_y[k] = from[4], eight.ray.dir_z[k] = from[5];
                eight.ray.tfar[k] = INFINITY;
                eight.ray.mask[k] = ~0u;
                eight.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
            }
            rtcIntersect8(valid, scene, &context, &eight);
            for (size_t k = 0; k < 8; k++) hits += eight.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID;
        }
    }
};

/* The rays of the light run: the first ones in the order in which it casts them, and then those that scattering makes of them. */
void add_light_rays(const plm_mesh &mesh, const double centre[3], double radius, size_t wanted, Bare &bare)
{
    plm_light_options options;
    plm_light_defaults(&options);
    plm_light_run run = {};
    std::vector<plm_light_source> source(72);
    auto batch = std::make_unique<plm_ray_batch>();
    run.mesh = &mesh;
    run.options = &options;
    run.source = source.data();
    run.radius = radius;
    std::copy(centre, centre + 3, run.centre);
    plm_light_place_sources(&run);
    plm_light_shift(&run, plm_key(1, 500));
    const size_t each = wanted / 72;
    for (int s = 0; s < 72; s++)
        for (size_t first = 0; first < each; first += PLM_RAY_BATCH) {
            plm_light_start(&run, s, first, std::min<size_t>(each - first, PLM_RAY_BATCH), batch.get());
            for (size_t k = 0; k < batch->count; k++)
                for (const auto *from : {batch->lanes.origin, batch->lanes.direction})
                    for (int i = 0; i < 3; i++) bare.ray.push_back(from[i][k]);
        }
    size_t begin = 0;
    for (int depth = 1; depth < options.depth; depth++) begin = bare.scatter(begin, 1e-6 * radius);
}

/* Rays of the dome: from each scanner into the cone that holds the plant. */
void add_dome_rays(const plm_stage_set &stage, const plm_scan_options &options, size_t each, Bare &bare)
{
    std::vector<double> position(3 * PLM_DOME_LAYERS * PLM_DOME_AROUND);
    plm_dome_positions(&stage, &options, reinterpret_cast<double(*)[3]>(position.data()));
    for (size_t s = 0; s < position.size() / 3; s++) {
        double axis[3], u[3], v[3];
        for (int i = 0; i < 3; i++) axis[i] = stage.target[i] - position[3 * s + i];
        const double distance = plm_normalise(axis), low = std::sqrt(1 - std::pow(stage.target_radius / distance, 2));
        plm_frame_of_axis(axis, u, v);
        for (size_t k = 0; k < each; k++) {
            const double a = 0.7548776662466927 * static_cast<double>(k),
                         b = 0.5698402909980532 * static_cast<double>(k);
            const double cosine = 1 - (1 - low) * (a - std::floor(a)), away = std::sqrt(1 - cosine * cosine);
            double direction[3];
            for (int i = 0; i < 3; i++)
                direction[i] =
                    cosine * axis[i] + away * (std::cos(2 * M_PI * b) * u[i] + std::sin(2 * M_PI * b) * v[i]);
            bare.add(&position[3 * s], direction);
        }
    }
}

/* Median seconds of turns in which ours and both bare ways follow each other. */
template <class Ours> void compare(bench::Run &run, const char *id, const char *what, Bare &bare, Ours ours)
{
    std::vector<double> own, single, packet, ratio[2];
    const double million = 1e-6 * static_cast<double>(bare.count());
    for (int turn = 0; turn < run.turns(); turn++) {
        size_t rays = 0;
        const double seconds = bench::timed(1, [&] { rays = ours(); });
        own.push_back(seconds / (1e-6 * static_cast<double>(rays)));
        single.push_back(bench::timed(1, [&] { bare.one_by_one(); }) / million);
        packet.push_back(bench::timed(1, [&] { bare.eight_by_eight(); }) / million);
        ratio[0].push_back(own.back() / single.back());
        ratio[1].push_back(own.back() / packet.back());
    }
    run.report({id, what, "Embree, bare rtcIntersect1", 1 / 0.7, 1}, bench::median(own), bench::median(single),
               bench::median(ratio[0]), "s/1e6");
    run.report({id, what, "Embree, bare rtcIntersect8", 1 / 0.7, 1}, bench::median(own), bench::median(packet),
               bench::median(ratio[1]), "s/1e6");
}

} // namespace

int main(int count, char **arguments)
{
    bench::Run run(count, arguments);
    if (!run.wanted("L1") && !run.wanted("L2") && !run.wanted("L3") && !run.wanted("L4")) return 0;
    plm_error error;
    plm_virtual_plant plant;
    plm_stage_set stage = {};
    const plm_plant_options grow = {1, 0.05, false};
    plm_scan_options dome = {};
    dome.scanner = PLM_SCANNER_DOME;
    dome.seed = 1;
    dome.dome_radius = 3.6;
    bench::check(plm_plant_grow("tomato_large", &grow, &plant, &error), error);
    bench::check(plm_stage_make(&plant, &dome, &stage, &error), error);
    plm_light_options options;
    plm_light_defaults(&options);
    plm_light light = {};
    uint64_t rays = 0;
    const size_t wanted = static_cast<size_t>(0.105e6 * plm_plant_area(&plant));
    bench::check(plm_dome_rays(&stage, &dome, wanted, &rays, &error), error);

    Bare lit(plant.mesh), seen(plant.mesh);
    add_light_rays(plant.mesh, stage.centre, stage.radius, run.points(1e6), lit);
    add_dome_rays(stage, dome, rays, seen);
    options.rays = run.points(2e6);
    compare(run, "L1", "light, tomato of 8.5 k faces, 1 thread", lit, [&] {
        bench::check(plm_light_trace(&plant.mesh, nullptr, 0, &options, &light, &error), error);
        const size_t cast = light.ray_count;
        plm_light_free(&light);
        return cast;
    });
    compare(run, "L2", "dome, the same tomato, 1 thread", seen, [&] {
        plm_samples samples = {};
        size_t hits = 0;
        bench::check(plm_dome_cast(&stage, &dome, rays, &samples, &hits, &error), error);
        plm_free(samples.sample);
        return PLM_DOME_LAYERS * PLM_DOME_AROUND * static_cast<size_t>(rays);
    });
    options.rays = run.points(1e7);
    const double light_seconds = bench::timed(
        0, [&] { bench::check(plm_light_trace(&plant.mesh, nullptr, 0, &options, &light, &error), error); });
    run.report({"L3", "light, 1e7 rays, all threads", "paper, 20.8 s on 4 cores", 1, 0}, light_seconds, 20.8,
               light_seconds / 20.8, "s");
    plm_light_free(&light);
    const double dome_seconds = bench::timed(0, [&] {
        plm_scan_options scan = dome;
        plm_scan made;
        scan.density = 0.105e6;
        bench::check(plm_scan_plant(&plant, &scan, &made, &error), error);
        plm_scan_free(&made);
    });
    run.report({"L4", "dome scan, 0.105 hits/mm2, all threads", "paper, 9.3 s on 4 cores", 1, 0}, dome_seconds, 9.3,
               dome_seconds / 9.3, "s");
    plm_stage_free(&stage);
    plm_virtual_plant_free(&plant);
    return run.end();
}
