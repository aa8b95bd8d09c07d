/* selftest/clouds.c: clouds of known shape. */
#include "cloud/linear.h"
#include "cloud/random.h"
#include "selftest/checks.h"

void plm_maker_start(plm_maker *maker, plm_checker *checker, size_t count, uint64_t seed)
{
    *maker = (plm_maker){.checker = checker, .room = count, .key = plm_key(seed, 7)};
    if (checker->status != PLM_OK) maker->room = 0;
    const plm_status status =
        plm_cloud_create(maker->room, PLM_HAS_LABEL | PLM_HAS_ORGAN, &maker->cloud, checker->error);
    if (status != PLM_OK) {
        checker->status = status;
        maker->room = 0;
    }
    maker->cloud.count = 0;
}

void plm_maker_add(plm_maker *maker, const double point[3], plm_label label, int32_t organ)
{
    plm_cloud *cloud = &maker->cloud;
    if (cloud->count >= maker->room) return;
    for (int k = 0; k < 3; k++) cloud->xyz[cloud->count][k] = (float)point[k];
    cloud->label[cloud->count] = (uint8_t)label;
    cloud->organ[cloud->count++] = organ;
}

double plm_maker_uniform(plm_maker *maker)
{
    return plm_uniform_at(maker->key, maker->drawn++);
}

double plm_maker_normal(plm_maker *maker)
{
    return plm_normal_at(maker->key ^ 1, maker->drawn++);
}

void plm_maker_sheet(plm_maker *maker, const double corner[3], const double u[3], const double v[3], int per_side,
                     double noise, plm_label label, int32_t organ)
{
    double normal[3];
    plm_cross(u, v, normal);
    plm_normalise(normal);
    for (int i = 0; i < per_side; i++)
        for (int j = 0; j < per_side; j++) {
            const double a = (i + plm_maker_uniform(maker)) / per_side, b = (j + plm_maker_uniform(maker)) / per_side;
            const double off = noise > 0 ? noise * plm_maker_normal(maker) : 0;
            double point[3];
            for (int k = 0; k < 3; k++) point[k] = corner[k] + a * u[k] + b * v[k] + off * normal[k];
            plm_maker_add(maker, point, label, organ);
        }
}

void plm_maker_tube(plm_maker *maker, const double begin[3], const double end[3], double radius, double arc,
                    size_t count, double noise, plm_label label, int32_t organ)
{
    double along[3], u[3], v[3];
    for (int k = 0; k < 3; k++) along[k] = end[k] - begin[k];
    const double length = plm_normalise(along);
    plm_frame_of_axis(along, u, v);
    for (size_t i = 0; i < count; i++) {
        const double t = length * ((double)i + plm_maker_uniform(maker)) / (double)count;
        const double angle = arc * plm_maker_uniform(maker);
        double point[3];
        for (int k = 0; k < 3; k++) {
            point[k] = begin[k] + t * along[k] + radius * (cos(angle) * u[k] + sin(angle) * v[k]);
            if (noise > 0) point[k] += noise * plm_maker_normal(maker);
        }
        plm_maker_add(maker, point, label, organ);
    }
}

void plm_maker_unlabel(plm_maker *maker)
{
    plm_free(maker->cloud.label);
    plm_free(maker->cloud.organ);
    maker->cloud.label = NULL;
    maker->cloud.organ = NULL;
}
