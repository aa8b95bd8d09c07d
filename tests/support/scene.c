#include "support/scene.h"

#include <math.h>

#include "cloud/linear.h"
#include "support/test.h"

enum { LEAVES = 6 };

typedef struct pen {
    const test_scene *scene;
    plm_cloud *cloud;
    size_t count;
    uint64_t state;
} pen;

static void put(pen *p, double x, double y, double z, plm_label label, const double colour[3])
{
    if (p->count >= p->scene->points) return;
    const double place[3] = {x, y, z};
    for (int i = 0; i < 3; i++) {
        p->cloud->xyz[p->count][i] = (float)(place[i] + p->scene->noise * test_normal(&p->state));
        const double shade = colour[i] + 8 * test_normal(&p->state);
        p->cloud->rgb[p->count][i] = (uint8_t)fmin(fmax(shade, 0), 255);
    }
    p->cloud->label[p->count++] = (uint8_t)label;
}

static size_t how_many(const pen *p, double area)
{
    return (size_t)(area / (p->scene->spacing * p->scene->spacing));
}

static void put_stem(pen *p, double radius, double height)
{
    static const double green[3] = {90, 110, 65};
    for (size_t i = 0, n = how_many(p, 2 * PLM_PI * radius * height); i < n; i++) {
        const double a = 2 * PLM_PI * test_uniform(&p->state);
        put(p, radius * cos(a), radius * sin(a), height * test_uniform(&p->state), PLM_LABEL_STEM, green);
    }
}

/* An elliptic leaf from the axis outwards, bent down along its length and folded along its middle. */
static void put_leaf(pen *p, double height, double azimuth, double rise)
{
    static const double green[3] = {80, 135, 60};
    const double length = p->scene->leaf_length, width = 0.5 * length, bend = p->scene->flat_leaves ? 0 : 0.5;
    for (size_t i = 0, n = how_many(p, PLM_PI / 4 * length * width); i < n; i++) {
        const double r = sqrt(test_uniform(&p->state)), a = 2 * PLM_PI * test_uniform(&p->state);
        const double along = length * (0.6 + 0.5 * r * cos(a)), across = 0.5 * width * r * sin(a);
        const double z = height + rise * along - bend * along * along / length + bend * fabs(across);
        put(p, along * cos(azimuth) - across * sin(azimuth), along * sin(azimuth) + across * cos(azimuth), z,
            PLM_LABEL_LEAF, green);
    }
    for (size_t i = 0, n = how_many(p, 0.02 * length); i < n; i++) { /* petiole */
        const double along = 0.15 * length * test_uniform(&p->state), a = 2 * PLM_PI * test_uniform(&p->state);
        const double z = height + rise * along + 0.01 * sin(a), side = 0.01 * cos(a);
        put(p, along * cos(azimuth) - side * sin(azimuth), along * sin(azimuth) + side * cos(azimuth), z,
            PLM_LABEL_PETIOLE, green);
    }
}

/* Radius of a pot's outline in a direction: a circle, or a square with round corners. */
static double outline(const test_scene *s, double a)
{
    return s->square ? pow(pow(fabs(cos(a)), 10) + pow(fabs(sin(a)), 10), -0.1) : 1;
}

static void put_pot(pen *p)
{
    static const double clay[3] = {150, 80, 55}, earth[3] = {70, 52, 38};
    const test_scene *s = p->scene;
    const double r = s->pot_radius, inner = 0.94 * r, foot = s->rim - s->pot_height;
    for (size_t i = 0, n = how_many(p, 2 * PLM_PI * r * s->pot_height); i < n; i++) {
        const double a = 2 * PLM_PI * test_uniform(&p->state), z = foot + s->pot_height * test_uniform(&p->state);
        const double at = r * (1 - 0.15 * (s->rim - z) / s->pot_height) * outline(s, a);
        put(p, at * cos(a), at * sin(a), z, PLM_LABEL_GROUND, clay);
    }
    for (size_t i = 0, n = how_many(p, 2 * PLM_PI * inner * s->rim); i < n; i++) {
        const double a = 2 * PLM_PI * test_uniform(&p->state), at = inner * outline(s, a);
        put(p, at * cos(a), at * sin(a), s->rim * test_uniform(&p->state), PLM_LABEL_GROUND, clay);
    }
    for (size_t i = 0, n = how_many(p, PLM_PI * r * r); i < n; i++) {
        const double a = 2 * PLM_PI * test_uniform(&p->state), at = r * sqrt(test_uniform(&p->state));
        const bool soil = at < inner;
        put(p, at * outline(s, a) * cos(a), at * outline(s, a) * sin(a), soil ? 0 : s->rim, PLM_LABEL_GROUND,
            soil ? earth : clay);
    }
}

static void put_table(pen *p)
{
    static const double wood[3] = {190, 180, 170};
    const test_scene *s = p->scene;
    const double hidden = 0.85 * s->pot_radius, z = s->pot_radius > 0 ? s->rim - s->pot_height : 0;
    for (size_t i = 0, n = how_many(p, PLM_PI * s->table_radius * s->table_radius); i < n; i++) {
        const double a = 2 * PLM_PI * test_uniform(&p->state), at = s->table_radius * sqrt(test_uniform(&p->state));
        if (at > hidden) put(p, at * cos(a), at * sin(a), z, PLM_LABEL_GROUND, wood);
    }
}

plm_status test_scene_make(const test_scene *s, plm_cloud *cloud, plm_error *error)
{
    const plm_status status = plm_cloud_create(s->points, PLM_HAS_RGB | PLM_HAS_LABEL, cloud, error);
    if (status != PLM_OK) return status;
    pen p = {.scene = s, .cloud = cloud, .state = s->seed};
    if (!s->rosette) put_stem(&p, 0.02, 1);
    for (int leaf = 0; leaf < LEAVES && s->leaf_length > 0; leaf++) {
        const double height = s->rosette ? 0.02 + 0.01 * leaf : 0.35 + 0.12 * leaf;
        put_leaf(&p, height, 2.4 * leaf, s->flat_leaves ? 0 : s->rosette ? 0.45 : 0.3);
    }
    if (s->pot_radius > 0) put_pot(&p);
    if (s->table_radius > 0) put_table(&p);
    static const double grey[3] = {130, 130, 130};
    const size_t strays = (size_t)(s->outliers * (double)p.count);
    for (size_t i = 0; i < strays; i++)
        put(&p, 1.6 * (test_uniform(&p.state) - 0.5), 1.6 * (test_uniform(&p.state) - 0.5),
            2.2 * test_uniform(&p.state) - 0.9, PLM_LABEL_OTHER, grey);
    cloud->count = p.count;
    return PLM_OK;
}
