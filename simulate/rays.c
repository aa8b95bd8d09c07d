/* simulate/rays.c: Embree's C interface behind four calls. */
#include "simulate/rays.h"

#include <math.h>
#include <string.h>

#include <embree3/rtcore.h>

struct plm_rays {
    RTCDevice device;
    RTCScene scene;
};

static plm_status embree_status(RTCDevice device, plm_error *error)
{
    const enum RTCError code = rtcGetDeviceError(device);
    if (code == RTC_ERROR_NONE) return PLM_OK;
    if (code == RTC_ERROR_OUT_OF_MEMORY) return plm_fail(error, PLM_E_MEMORY, "out of memory in Embree");
    return plm_fail(error, PLM_E_LIBRARY, "Embree reported error %d", (int)code);
}

static plm_status attach(plm_rays *rays, const double (*vertex)[3], size_t vertex_count, const uint32_t (*triangle)[3],
                         size_t count, plm_error *error)
{
    RTCGeometry geometry = rtcNewGeometry(rays->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    float *points = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                            vertex_count ? vertex_count : 1);
    unsigned *corners = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                3 * sizeof(unsigned), count ? count : 1);
    if (points && corners) {
        for (size_t i = 0; i < 3 * vertex_count; i++) points[i] = (float)vertex[i / 3][i % 3];
        for (size_t i = 0; i < 3 * count; i++) corners[i] = triangle[i / 3][i % 3];
        if (!vertex_count) points[0] = points[1] = points[2] = 0;
        if (!count) corners[0] = corners[1] = corners[2] = 0;
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(rays->scene, geometry);
        rtcCommitScene(rays->scene);
    }
    rtcReleaseGeometry(geometry);
    return embree_status(rays->device, error);
}

plm_status plm_rays_build(const double (*vertex)[3], size_t vertex_count, const uint32_t (*triangle)[3], size_t first,
                          size_t count, plm_rays **rays, plm_error *error)
{
    plm_rays *made = plm_alloc_zero(1, sizeof *made, error);
    if (!made) return PLM_E_MEMORY;
    plm_status status = PLM_OK;
    /* By default Embree takes the widest instructions there are, and some hits differ in their last bit by them. */
    made->device = rtcNewDevice("threads=1,isa=avx2");
    if (!made->device) status = plm_fail(error, PLM_E_LIBRARY, "Embree gave no device");
    if (status == PLM_OK) {
        made->scene = rtcNewScene(made->device);
        rtcSetSceneFlags(made->scene, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
        status = attach(made, vertex, vertex_count, triangle + first, count, error);
    }
    if (status == PLM_OK)
        *rays = made;
    else
        plm_rays_free(made);
    return status;
}

void plm_rays_free(plm_rays *rays)
{
    if (!rays) return;
    if (rays->scene) rtcReleaseScene(rays->scene);
    if (rays->device) rtcReleaseDevice(rays->device);
    plm_free(rays);
}

static struct RTCRay ray_of(const double origin[3], const double direction[3], double near, double far)
{
    return (struct RTCRay){.org_x = (float)origin[0],
                           .org_y = (float)origin[1],
                           .org_z = (float)origin[2],
                           .tnear = (float)near,
                           .dir_x = (float)direction[0],
                           .dir_y = (float)direction[1],
                           .dir_z = (float)direction[2],
                           .tfar = (float)far,
                           .mask = ~0u};
}

bool plm_rays_first(const plm_rays *rays, const double origin[3], const double direction[3], double near, double far,
                    plm_hit *hit)
{
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    struct RTCRayHit ray = {.ray = ray_of(origin, direction, near, far)};
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(rays->scene, &context, &ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
    *hit = (plm_hit){ray.hit.primID, (double)ray.ray.tfar, (double)ray.hit.u, (double)ray.hit.v};
    return true;
}

enum { PACKET = 8 };

/* Rays [first, first + count) of the lanes; what lies behind them is not looked at. */
static void load_packet(const plm_ray_lanes *lanes, size_t first, size_t count, struct RTCRay8 *ray)
{
    float *const to[2][3] = {{ray->org_x, ray->org_y, ray->org_z}, {ray->dir_x, ray->dir_y, ray->dir_z}};
    for (int i = 0; i < 3; i++) {
        if (count == PACKET) { /* the usual case, of a size that the compiler knows */
            memcpy(to[0][i], &lanes->origin[i][first], PACKET * sizeof(float));
            memcpy(to[1][i], &lanes->direction[i][first], PACKET * sizeof(float));
        } else {
            memcpy(to[0][i], &lanes->origin[i][first], count * sizeof(float));
            memcpy(to[1][i], &lanes->direction[i][first], count * sizeof(float));
        }
    }
}

static void cast_each(const plm_rays *rays, const plm_ray_lanes *lanes, size_t count, plm_hit *hit)
{
    for (size_t k = 0; k < count; k++) {
        double origin[3], direction[3];
        for (int i = 0; i < 3; i++) {
            origin[i] = (double)lanes->origin[i][k];
            direction[i] = (double)lanes->direction[i][k];
        }
        if (!plm_rays_first(rays, origin, direction, 0, INFINITY, &hit[k])) hit[k].face = PLM_NO_HIT;
    }
}

static void cast_packets(const plm_rays *rays, const plm_ray_lanes *lanes, size_t count, plm_hit *hit)
{
    struct RTCIntersectContext context;
    struct RTCRayHit8 packet = {0};
    int valid[PACKET] __attribute__((aligned(32)));
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    for (size_t k = 0; k < PACKET; k++) packet.ray.mask[k] = ~0u;
    for (size_t first = 0; first < count; first += PACKET) {
        const size_t here = count - first < PACKET ? count - first : PACKET;
        for (size_t k = 0; k < PACKET; k++) {
            valid[k] = k < here ? -1 : 0;
            packet.ray.tfar[k] = INFINITY;
            packet.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
        }
        load_packet(lanes, first, here, &packet.ray);
        rtcIntersect8(valid, rays->scene, &context, &packet);
        for (size_t k = 0; k < here; k++) {
            plm_hit *made = &hit[first + k];
            made->face = PLM_NO_HIT;
            if (packet.hit.geomID[k] == RTC_INVALID_GEOMETRY_ID) continue;
            *made = (plm_hit){packet.hit.primID[k], (double)packet.ray.tfar[k], (double)packet.hit.u[k],
                              (double)packet.hit.v[k]};
        }
    }
}

void plm_rays_first_many(const plm_rays *rays, const plm_ray_lanes *lanes, size_t count, bool are_side_by_side,
                         plm_hit *hit)
{
    if (are_side_by_side)
        cast_packets(rays, lanes, count, hit);
    else
        cast_each(rays, lanes, count, hit);
}

bool plm_rays_blocked(const plm_rays *rays, const double from[3], const double to[3])
{
    const double direction[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    struct RTCRay ray = ray_of(from, direction, 0.001, 0.999);
    rtcOccluded1(rays->scene, &context, &ray);
    return ray.tfar < 0;
}

/* A context that carries the caller's question to the filter. */
typedef struct cut_context {
    struct RTCIntersectContext context; /* first: Embree hands back a pointer to it */
    bool (*meet)(uint32_t face, double t, void *user);
    void *user;
    bool stopped;
} cut_context;

static void cut_filter(const struct RTCFilterFunctionNArguments *arguments)
{
    cut_context *cut = (cut_context *)(void *)arguments->context;
    if (arguments->valid[0] != -1) return;
    /* rays come one by one here: for N = 1 the structures of N rays are those of one */
    const uint32_t face = ((const struct RTCHit *)(const void *)arguments->hit)->primID;
    const double t = (double)((const struct RTCRay *)(const void *)arguments->ray)->tfar;
    if (cut->meet(face, t, cut->user))
        cut->stopped = true;
    else
        arguments->valid[0] = 0;
}

bool plm_rays_cut(const plm_rays *rays, const double from[3], const double to[3],
                  bool (*meet)(uint32_t face, double t, void *user), void *user)
{
    const double direction[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
    cut_context cut = {.meet = meet, .user = user};
    rtcInitIntersectContext(&cut.context);
    cut.context.filter = cut_filter;
    struct RTCRay ray = ray_of(from, direction, 0, 1);
    rtcOccluded1(rays->scene, &cut.context, &ray);
    return cut.stopped;
}
