/* simulate/organs.c: stems and leaves as a whole: their faces and, from the same curves, the part of their truth that
 * curves know (lengths, chords, diameters, junctions). Areas and planes are taken from the faces in truth.c. */
#include "simulate/build.h"

#include <string.h>

#include "cloud/linear.h"
#include "simulate/rays.h"

static double from_zenith(const double from[3], const double to[3])
{
    return atan2(hypot(to[0] - from[0], to[1] - from[1]), to[2] - from[2]);
}

/* ---- Stems ------------------------------------------------------------------------------------------------------ */

/* One row more in an array of truth rows, zeroed. */
static bool add_row(plm_builder *builder, void *array, size_t size, size_t count, size_t *room)
{
    if (builder->status != PLM_OK) return false;
    if (count == *room) {
        const size_t wanted = *room ? 2 * *room : 8;
        void *larger = plm_realloc(*(void **)array, wanted, size, builder->error);
        if (!larger) {
            builder->status = PLM_E_MEMORY;
            return false;
        }
        *(void **)array = larger;
        *room = wanted;
    }
    memset(*(char **)array + count * size, 0, size);
    return true;
}

static void stem_truth(const plm_curve *axis, const plm_taper *taper, int parent, plm_true_stem *truth)
{
    plm_frame_at frame;
    *truth = (plm_true_stem){.parent = parent, .length = axis->length, .visible_fraction = NAN};
    memcpy(truth->base, axis->point[0], sizeof truth->base);
    memcpy(truth->tip, axis->point[PLM_CURVE_STEPS], sizeof truth->tip);
    truth->inclination = from_zenith(truth->base, truth->tip);
    truth->is_short = axis->length < 0.04;
    truth->diameter_height = truth->is_short ? 0.5 * axis->length : 0.02;
    truth->diameter = 2 * plm_taper_at(taper, truth->diameter_height, axis->length);
    plm_curve_at(axis, truth->diameter_height, truth->diameter_point, &frame);
    memcpy(truth->axis, frame.tangent, sizeof truth->axis);
}

int plm_build_stem(plm_builder *builder, int parent, const plm_curve *axis, const plm_taper *taper, bool is_hidden)
{
    plm_virtual_plant *plant = builder->plant;
    if (!add_row(builder, &builder->stem, sizeof *builder->stem, builder->built_count, &builder->stem_room)) return 0;
    const int number = (int)builder->built_count++;
    builder->stem[number] = (plm_built_stem){.axis = *axis, .taper = *taper, .is_hidden = is_hidden};
    if (is_hidden) return number;
    size_t room = plant->stem_count; /* stems are few: one more row each time */
    if (!add_row(builder, &plant->stem, sizeof *plant->stem, plant->stem_count, &room)) return 0;
    builder->label = PLM_LABEL_STEM;
    builder->organ = (int32_t)plant->stem_count;
    builder->leaflet = -1;
    stem_truth(axis, taper, parent, &plant->stem[plant->stem_count++]);
    const double foot = parent < 0 ? 0 : -0.8 * plm_taper_at(&builder->stem[parent].taper, 0, 1);
    plm_build_tube(builder, axis, taper, foot, axis->length);
    return number;
}

/* ---- Leaves ----------------------------------------------------------------------------------------------------- */

/* Where and how a leaf leaves the stem: point on the stem's surface, frame of the petiole (or of the blade). */
typedef struct foot {
    double node[3], base[3], stem_axis[3];
    double inside; /* from the axis to the surface along the petiole */
    plm_frame_at frame;
} foot;

static foot find_foot(const plm_built_stem *stem, double node, const plm_leaf_spec *spec)
{
    foot made;
    plm_frame_at at;
    double zenith = spec->zenith, cosine = 1;
    plm_curve_at(&stem->axis, node, made.node, &at);
    memcpy(made.stem_axis, at.tangent, sizeof at.tangent);
    /* a direction closer than 10 degrees to the stem would never leave it */
    for (int k = 0; k < 40; k++) {
        made.frame = plm_frame_of_direction(zenith, spec->azimuth);
        cosine = plm_dot(made.frame.tangent, at.tangent);
        if (fabs(cosine) < 0.985) break;
        zenith += 0.04;
    }
    made.inside = plm_taper_at(&stem->taper, node, stem->axis.length) / sqrt(1 - cosine * cosine);
    if (!(spec->petiole_length > 0)) {
        /* a blade without petiole stands on the surface beside the node, its foot in the direction of its azimuth */
        const double radius = plm_taper_at(&stem->taper, node, stem->axis.length);
        double out[3];
        const double along = plm_dot(made.frame.tangent, at.tangent);
        for (int i = 0; i < 3; i++) out[i] = made.frame.tangent[i] - along * at.tangent[i];
        plm_normalise(out);
        for (int i = 0; i < 3; i++) made.base[i] = made.node[i] + 1.03 * radius * out[i];
    } else {
        for (int i = 0; i < 3; i++) made.base[i] = made.node[i] + made.inside * made.frame.tangent[i];
    }
    return made;
}

static plm_taper petiole_taper(const plm_leaf_spec *spec)
{
    return (plm_taper){.base = spec->petiole_radius,
                       .tip = spec->petiole_tip_radius,
                       .flare = spec->petiole_flare,
                       .flare_length = 3 * spec->petiole_radius};
}

/* The blade that ends a tube: its junction on the tube's axis, turned against the tube's end. */
static void place_blade(const plm_blade_spec *spec, const double start[3], const plm_frame_at *end, double pitch,
                        double yaw, double roll, plm_blade *blade)
{
    plm_frame_at frame = *end;
    plm_frame_yaw(&frame, yaw);
    plm_frame_roll(&frame, roll);
    plm_frame_pitch(&frame, pitch);
    plm_blade_place(spec, start, &frame, blade);
}

static void blade_truth(const plm_blade *blade, plm_true_leaf *truth)
{
    memcpy(truth->base, blade->midrib.point[0], sizeof truth->base);
    plm_blade_point(blade, blade->spec.length, 0, truth->tip);
    truth->length = blade->spec.length;
    plm_blade_width(blade, &truth->width, &truth->width_chord);
    truth->azimuth = atan2(truth->tip[1] - truth->base[1], truth->tip[0] - truth->base[0]);
    truth->visible_fraction = NAN;
}

/* The petiole's tube: from inside the stem to a little way under the blade, where it thins out. */
static void build_petiole(plm_builder *builder, const plm_curve *axis, const plm_taper *taper, double inside)
{
    plm_build_tube(builder, axis, taper, -0.9 * inside, axis->length);
}

static void petiole_truth(const plm_leaf_spec *spec, const plm_curve *axis, const plm_taper *taper,
                          plm_true_petiole *truth)
{
    *truth = (plm_true_petiole){.length = axis->length, .visible_fraction = NAN};
    memcpy(truth->base, axis->point[0], sizeof truth->base);
    memcpy(truth->junction, axis->point[PLM_CURVE_STEPS], sizeof truth->junction);
    truth->chord = plm_distance(truth->base, truth->junction);
    truth->inclination = from_zenith(truth->base, truth->junction);
    truth->is_compound = spec->leaflet_count > 0;
    const double to_first = truth->is_compound ? spec->leaflet[0].share * axis->length : axis->length;
    truth->diameter = 2 * plm_taper_at(taper, 0.5 * to_first, axis->length);
    if (!truth->is_compound) return;
    truth->first_length = to_first;
    plm_curve_at(axis, to_first, truth->first_junction, NULL);
    truth->first_inclination = from_zenith(truth->base, truth->first_junction);
}

/* The last blade of a compound leaf begins where its petiolule ends, which goes on from the rachis. */
static void end_at_last_blade(double petiolule, const plm_true_leaf *last, plm_true_petiole *truth)
{
    truth->length += petiolule;
    memcpy(truth->junction, last->base, sizeof truth->junction);
    truth->chord = plm_distance(truth->base, truth->junction);
    truth->inclination = from_zenith(truth->base, truth->junction);
}

/* One leaflet: a petiolule off the rachis (part of the petiole) and its blade. */
static void build_leaflet(plm_builder *builder, const plm_curve *rachis, const plm_taper *taper,
                          const plm_leaflet_spec *spec, int number, plm_true_leaf *truth)
{
    plm_blade blade;
    plm_frame_at frame;
    plm_curve stalk;
    double start[3], end[3];
    const double s = spec->share * rachis->length, thick = plm_taper_at(taper, s, rachis->length);
    plm_curve_at(rachis, s, start, &frame);
    const plm_taper thin = {.base = 0.6 * thick, .tip = 0.4 * thick};
    plm_frame_yaw(&frame, spec->turn);
    plm_curve_grow(start, &frame, fmax(spec->petiolule_length, 1e-5), &(plm_bend){0}, &stalk);
    if (spec->petiolule_length > 0) {
        builder->label = PLM_LABEL_PETIOLE;
        builder->leaflet = -1;
        plm_build_tube(builder, &stalk, &thin, 0, stalk.length);
    }
    plm_curve_at(&stalk, spec->petiolule_length, end, NULL);
    place_blade(&spec->blade, end, &frame, spec->pitch, 0, spec->roll, &blade);
    builder->label = PLM_LABEL_LEAF;
    builder->leaflet = number;
    plm_build_blade(builder, &blade);
    *truth = (plm_true_leaf){.leaflet = number, .insertion_angle = NAN};
    blade_truth(&blade, truth);
}

/* All leaflets of a leaf; the leaf's own tip and length follow from the last one. */
static void build_leaflets(plm_builder *builder, const plm_leaf_spec *spec, const plm_curve *rachis,
                           const plm_taper *taper, plm_true_leaf *leaf, plm_true_petiole *petiole)
{
    plm_virtual_plant *plant = builder->plant;
    leaf->is_compound = true;
    leaf->first_leaflet = plant->leaflet_count;
    for (int k = 0; k < spec->leaflet_count; k++) {
        if (!add_row(builder, &plant->leaflet, sizeof *plant->leaflet, plant->leaflet_count, &builder->leaflet_room))
            return;
        plm_true_leaf *leaflet = &plant->leaflet[plant->leaflet_count++];
        build_leaflet(builder, rachis, taper, &spec->leaflet[k], k + 1, leaflet);
        leaflet->role = spec->role;
    }
    const plm_true_leaf *last = &plant->leaflet[plant->leaflet_count - 1];
    const plm_leaflet_spec *end = &spec->leaflet[spec->leaflet_count - 1];
    leaf->leaflet_count = (size_t)spec->leaflet_count;
    memcpy(leaf->base, rachis->point[0], sizeof leaf->base);
    memcpy(leaf->tip, last->tip, sizeof leaf->tip);
    leaf->length = (1 - spec->leaflet[0].share) * rachis->length + end->petiolule_length + last->length;
    leaf->width = leaf->width_chord = NAN; /* the width is taken in the leaf's plane, from its faces */
    leaf->azimuth = atan2(leaf->tip[1] - leaf->base[1], leaf->tip[0] - leaf->base[0]);
    leaf->visible_fraction = NAN;
    end_at_last_blade(end->petiolule_length, last, petiole);
}

/* Faces and truth of one leaf as specified. */
static void build_once(plm_builder *builder, const plm_built_stem *stem, double node, const plm_leaf_spec *spec)
{
    plm_virtual_plant *plant = builder->plant;
    const foot at = find_foot(stem, node, spec);
    const bool has_petiole = spec->petiole_length > 0;
    plm_curve axis;
    plm_blade blade;
    const plm_taper taper = petiole_taper(spec);
    if (!add_row(builder, &plant->leaf, sizeof *plant->leaf, plant->leaf_count, &builder->leaf_room)) return;
    plm_true_leaf *leaf = &plant->leaf[plant->leaf_count];
    builder->organ = (int32_t)plant->leaf_count++;
    builder->leaflet = -1;
    *leaf = (plm_true_leaf){.insertion_angle = NAN};
    plm_true_petiole *petiole = NULL;
    const plm_frame_at *end = &at.frame;
    const double *start = at.base, *direction = at.frame.tangent;
    double chord[3];
    if (has_petiole) {
        if (!add_row(builder, &plant->petiole, sizeof *plant->petiole, plant->petiole_count, &builder->petiole_room))
            return;
        plm_curve_grow(at.base, &at.frame, spec->petiole_length, &spec->petiole_bend, &axis);
        petiole = &plant->petiole[plant->petiole_count++];
        petiole_truth(spec, &axis, &taper, petiole);
        builder->label = PLM_LABEL_PETIOLE;
        build_petiole(builder, &axis, &taper, at.inside);
        end = &axis.frame[PLM_CURVE_STEPS];
        start = axis.point[PLM_CURVE_STEPS];
    }
    if (spec->leaflet_count > 0) {
        build_leaflets(builder, spec, &axis, &taper, leaf, petiole);
    } else {
        place_blade(&spec->blade, start, end, spec->pitch, spec->yaw, spec->roll, &blade);
        builder->label = PLM_LABEL_LEAF;
        plm_build_blade(builder, &blade);
        blade_truth(&blade, leaf);
        if (!has_petiole) direction = blade.midrib.frame[0].tangent;
    }
    if (has_petiole) {
        for (int i = 0; i < 3; i++) chord[i] = petiole->junction[i] - petiole->base[i];
        plm_normalise(chord);
        direction = chord;
    }
    leaf->role = spec->role;
    const double cosine = plm_dot(direction, at.stem_axis);
    double across[3];
    plm_cross(direction, at.stem_axis, across);
    leaf->insertion_angle = stem->is_hidden ? NAN : atan2(plm_norm(across), cosine);
}

/* Sizes of all arrays of the plant, to go back to. */
typedef struct mark {
    size_t vertices, triangles, leaves, leaflets, petioles;
} mark;

static mark mark_of(const plm_virtual_plant *plant)
{
    return (mark){plant->mesh.vertex_count, plant->mesh.triangle_count, plant->leaf_count, plant->leaflet_count,
                  plant->petiole_count};
}

static void go_back(plm_virtual_plant *plant, const mark *to)
{
    plant->mesh.vertex_count = to->vertices;
    plant->mesh.triangle_count = to->triangles;
    plant->leaf_count = to->leaves;
    plant->leaflet_count = to->leaflets;
    plant->petiole_count = to->petioles;
}

static void note_node(plm_true_stem *stem, double node)
{
    if (stem->node_count == PLM_TRUE_NODES_MAXIMUM) return;
    int k = stem->node_count++;
    for (; k > 0 && stem->node[k - 1] > node; k--) stem->node[k] = stem->node[k - 1];
    if (k > 0 && node - stem->node[k - 1] < 1e-9) { /* opposite leaves share a node */
        for (int j = k; j + 1 < stem->node_count; j++) stem->node[j] = stem->node[j + 1];
        stem->node_count--;
        return;
    }
    stem->node[k] = node;
}

void plm_build_leaf(plm_builder *builder, int stem, double node, const plm_leaf_spec *spec)
{
    enum { TRIES = 7 };
    if (builder->status != PLM_OK) return;
    const mark before = mark_of(builder->plant);
    plm_leaf_spec best = *spec, now = *spec;
    size_t fewest = SIZE_MAX;
    plm_rays *earlier = plm_build_rays(builder);
    for (int k = 0; k < TRIES && fewest > 0 && builder->status == PLM_OK; k++) {
        if (k) {
            now = *spec;
            now.azimuth += 0.12 * k * plm_draw_normal(&builder->random);
            now.zenith += 0.05 * k * plm_draw_normal(&builder->random);
            now.pitch += 0.06 * k * plm_draw_normal(&builder->random);
        }
        build_once(builder, &builder->stem[stem], node, &now);
        const size_t crossings = plm_build_crossings(builder, earlier, before.triangles, stem);
        if (crossings < fewest) {
            fewest = crossings;
            best = now;
        }
        if (fewest > 0) go_back(builder->plant, &before);
    }
    plm_rays_free(earlier);
    if (builder->status != PLM_OK) return;
    if (fewest > 0) build_once(builder, &builder->stem[stem], node, &best);
    if (!builder->stem[stem].is_hidden) note_node(&builder->plant->stem[stem], node);
}
