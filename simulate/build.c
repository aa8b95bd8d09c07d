/* simulate/build.c: the growing mesh, and the parts that organs are made of: tubes, blades, spheroids. */
#include "simulate/build.h"

#include <string.h>

#include "cloud/linear.h"

static void fail_with(plm_builder *builder, plm_status status)
{
    if (builder->status == PLM_OK) builder->status = status;
}

void plm_builder_start(plm_builder *builder, const char *kind, const plm_plant_options *options,
                       plm_virtual_plant *plant, plm_error *error)
{
    *builder = (plm_builder){.plant = plant,
                             .error = error,
                             .resolution = options->resolution,
                             .is_arched = options->is_arched,
                             .organ = -1,
                             .leaflet = -1};
    *plant = (plm_virtual_plant){.seed = options->seed, .has_petioles = true};
    strncpy(plant->kind, kind, sizeof plant->kind - 1);
    uint64_t stream = 0;
    for (const char *c = kind; *c; c++) stream = stream * 131 + (uint64_t)*c;
    builder->random.key = plm_key(options->seed, stream);
}

plm_status plm_builder_finish(plm_builder *builder)
{
    plm_free(builder->stem);
    builder->stem = NULL;
    if (builder->status != PLM_OK) plm_virtual_plant_free(builder->plant);
    return builder->status;
}

/* Makes room for one more row in an array that holds count rows; doubles. */
static bool grow(plm_builder *builder, void *array, size_t size, size_t count, size_t room)
{
    if (count < room) return true;
    void *larger = plm_realloc(*(void **)array, room ? 2 * room : 64, size, builder->error);
    if (!larger) {
        fail_with(builder, PLM_E_MEMORY);
        return false;
    }
    *(void **)array = larger;
    return true;
}

uint32_t plm_build_vertex(plm_builder *builder, const double point[3], double rim, double radius)
{
    plm_virtual_plant *plant = builder->plant;
    const size_t count = plant->mesh.vertex_count, room = builder->vertex_room;
    if (builder->status != PLM_OK) return 0;
    if (!grow(builder, &plant->mesh.vertex, sizeof *plant->mesh.vertex, count, room) ||
        !grow(builder, &plant->vertex_rim, sizeof *plant->vertex_rim, count, room) ||
        !grow(builder, &plant->vertex_radius, sizeof *plant->vertex_radius, count, room))
        return 0;
    if (count == room) builder->vertex_room = room ? 2 * room : 64;
    memcpy(plant->mesh.vertex[count], point, sizeof *plant->mesh.vertex);
    plant->vertex_rim[count] = (float)rim;
    plant->vertex_radius[count] = (float)radius;
    plant->mesh.vertex_count++;
    return (uint32_t)count;
}

void plm_build_triangle(plm_builder *builder, uint32_t a, uint32_t b, uint32_t c)
{
    plm_virtual_plant *plant = builder->plant;
    const size_t count = plant->mesh.triangle_count, room = builder->triangle_room;
    if (builder->status != PLM_OK) return;
    if (!grow(builder, &plant->mesh.triangle, sizeof *plant->mesh.triangle, count, room) ||
        !grow(builder, &plant->mesh.face_organ, sizeof *plant->mesh.face_organ, count, room) ||
        !grow(builder, &plant->face_label, sizeof *plant->face_label, count, room) ||
        !grow(builder, &plant->face_leaflet, sizeof *plant->face_leaflet, count, room))
        return;
    if (count == room) builder->triangle_room = room ? 2 * room : 64;
    plant->mesh.triangle[count][0] = a;
    plant->mesh.triangle[count][1] = b;
    plant->mesh.triangle[count][2] = c;
    plant->mesh.face_organ[count] = builder->organ;
    plant->face_label[count] = builder->label;
    plant->face_leaflet[count] = builder->leaflet;
    plant->mesh.triangle_count++;
}

int plm_build_steps(const plm_builder *builder, double steps, int least)
{
    const int count = (int)(steps * builder->resolution + 0.5);
    return count < least ? least : count;
}

double plm_taper_at(const plm_taper *taper, double s, double length)
{
    const double t = fmin(fmax(s / length, 0), 1);
    double radius = taper->base + (taper->tip - taper->base) * pow(t, taper->power > 0 ? taper->power : 1);
    double wider = 0;
    if (taper->flare_length > 0) wider += taper->flare * exp(-fmax(s, 0) / taper->flare_length);
    for (int k = 0; k < taper->node_count; k++) {
        const double away = (s - taper->node[k]) / taper->swell_length;
        wider += taper->swell * exp(-away * away);
    }
    return radius * (1 + wider);
}

/* One ring of a tube. The vertices lie outside of the circle by (pi / sides)^2 / 3, so that the polygon's mean radius
 * is the circle's. */
static uint32_t ring(plm_builder *builder, const plm_curve *axis, double s, double radius, int sides)
{
    double centre[3], point[3];
    plm_frame_at frame;
    plm_curve_at(axis, s, centre, &frame);
    const double outer = radius * (1 + PLM_PI * PLM_PI / (3.0 * sides * sides));
    uint32_t first = 0;
    for (int k = 0; k < sides; k++) {
        const double c = cos(2 * PLM_PI * k / sides) * outer, d = sin(2 * PLM_PI * k / sides) * outer;
        for (int i = 0; i < 3; i++) point[i] = centre[i] + c * frame.side[i] + d * frame.normal[i];
        const uint32_t vertex = plm_build_vertex(builder, point, INFINITY, radius);
        if (!k) first = vertex;
    }
    return first;
}

static void cap(plm_builder *builder, const plm_curve *axis, double s, double radius, uint32_t ring_first, int sides,
                bool is_end)
{
    double centre[3];
    plm_curve_at(axis, s, centre, NULL);
    const uint32_t middle = plm_build_vertex(builder, centre, INFINITY, radius);
    for (int k = 0; k < sides; k++) {
        const uint32_t a = ring_first + (uint32_t)k, b = ring_first + (uint32_t)((k + 1) % sides);
        if (is_end)
            plm_build_triangle(builder, middle, a, b);
        else
            plm_build_triangle(builder, middle, b, a);
    }
}

void plm_build_tube(plm_builder *builder, const plm_curve *axis, const plm_taper *taper, double from, double to)
{
    const double thick = plm_taper_at(taper, 0.5 * (from + to), axis->length);
    const int sides = plm_build_steps(builder, 24, 3);
    const int rings = plm_build_steps(builder, fmin(fmax((to - from) / (1.2 * thick), 12), 160), 1);
    uint32_t before = 0;
    for (int k = 0; k <= rings && builder->status == PLM_OK; k++) {
        const double s = from + (to - from) * k / rings;
        const double radius = plm_taper_at(taper, s, axis->length);
        const uint32_t first = ring(builder, axis, s, radius, sides);
        if (k == 0) cap(builder, axis, s, radius, first, sides, false);
        for (int j = 0; k && j < sides; j++) {
            const uint32_t a = (uint32_t)j, b = (uint32_t)((j + 1) % sides);
            plm_build_triangle(builder, before + a, before + b, first + b);
            plm_build_triangle(builder, before + a, first + b, first + a);
        }
        if (k == rings) cap(builder, axis, s + 0.6 * radius, radius, first, sides, true);
        before = first;
    }
}

static uint32_t blade_vertex(plm_builder *builder, const plm_blade *blade, double x, double y)
{
    double point[3];
    plm_blade_point(blade, x, y, point);
    return plm_build_vertex(builder, point, plm_blade_rim(blade, x, y), 0);
}

/* Rows across, from the junction to the tip; the tip row has a width of a thousandth, which adds no area worth a name.
 */
static void blade_by_margins(plm_builder *builder, const plm_blade *blade)
{
    const plm_blade_spec *spec = &blade->spec;
    const double narrow = spec->width / spec->length;
    const double detail = fmax(spec->lobe_count * 8, spec->tooth_count * 4);
    const double finer = spec->detail > 0 ? spec->detail : 1;
    const int rows = plm_build_steps(builder, finer * fmax(narrow < 0.25 ? 110 : 64, detail), 4);
    const int columns = plm_build_steps(builder, finer * fmin(fmax(40 * narrow, 8), 28), 1);
    uint32_t before = 0;
    for (int k = 0; k <= rows && builder->status == PLM_OK; k++) {
        const double even = (double)k / rows, t = 0.35 * even + 0.65 * (0.5 - 0.5 * cos(PLM_PI * even));
        double half[2];
        plm_blade_margins(spec, t, half);
        uint32_t first = 0;
        for (int j = -columns; j <= columns; j++) {
            const double wide = fmax(half[j > 0 ? 0 : 1], 0.0005 * spec->width);
            const uint32_t vertex = blade_vertex(builder, blade, t * spec->length, wide * j / columns);
            if (j == -columns) first = vertex;
        }
        for (uint32_t j = 0; k && j < 2 * (uint32_t)columns; j++) {
            /* the diagonal leans to the midrib on both sides: mirror-symmetric */
            const uint32_t a = before + j, b = before + j + 1, c = first + j + 1, d = first + j;
            if (j < (uint32_t)columns) {
                plm_build_triangle(builder, a, c, b);
                plm_build_triangle(builder, a, d, c);
            } else {
                plm_build_triangle(builder, a, d, b);
                plm_build_triangle(builder, b, d, c);
            }
        }
        before = first;
    }
}

/* Rings around the centre. */
static void blade_around(plm_builder *builder, const plm_blade *blade)
{
    const int rings = plm_build_steps(builder, 26, 2);
    int sectors = plm_build_steps(builder, fmax(112, 3.0 * blade->spec.tooth_count), 8);
    sectors = sectors > blade->outline_count ? blade->outline_count : sectors;
    const uint32_t centre = blade_vertex(builder, blade, blade->centre, 0);
    uint32_t before = 0;
    for (int k = 1; k <= rings && builder->status == PLM_OK; k++) {
        uint32_t first = 0;
        for (int j = 0; j < sectors; j++) {
            const double *edge = blade->outline[(size_t)j * (size_t)blade->outline_count / (size_t)sectors];
            const double share = (double)k / rings, x = blade->centre + share * (edge[0] - blade->centre);
            const uint32_t vertex = blade_vertex(builder, blade, x, share * edge[1]);
            if (!j) first = vertex;
        }
        for (int j = 0; j < sectors; j++) {
            const uint32_t a = (uint32_t)j, b = (uint32_t)((j + 1) % sectors);
            if (k == 1) {
                plm_build_triangle(builder, centre, first + a, first + b);
            } else {
                plm_build_triangle(builder, before + a, first + a, first + b);
                plm_build_triangle(builder, before + a, first + b, before + b);
            }
        }
        before = first;
    }
}

void plm_build_blade(plm_builder *builder, const plm_blade *blade)
{
    if (blade->spec.is_palmate)
        blade_around(builder, blade);
    else
        blade_by_margins(builder, blade);
}

void plm_build_spheroid(plm_builder *builder, const double centre[3], double radius, double stretch)
{
    const int rings = plm_build_steps(builder, 16, 4), sides = plm_build_steps(builder, 24, 6);
    uint32_t before = 0;
    for (int k = 0; k <= rings && builder->status == PLM_OK; k++) {
        const double polar = PLM_PI * k / rings;
        uint32_t first = 0;
        for (int j = 0; j < sides; j++) {
            const double around = 2 * PLM_PI * j / sides;
            const double point[3] = {centre[0] + radius * sin(polar) * cos(around),
                                     centre[1] + radius * sin(polar) * sin(around),
                                     centre[2] + radius * stretch * cos(polar)};
            const uint32_t vertex = plm_build_vertex(builder, point, INFINITY, radius);
            if (!j) first = vertex;
        }
        for (int j = 0; k && j < sides; j++) {
            const uint32_t a = (uint32_t)j, b = (uint32_t)((j + 1) % sides);
            if (k < rings) plm_build_triangle(builder, before + a, first + a, first + b);
            if (k > 1) plm_build_triangle(builder, before + a, first + b, before + b);
        }
        before = first;
    }
}
