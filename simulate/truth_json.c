/* simulate/truth_json.c: the truth as JSON, in the layout of the development clouds' truth files: metres and degrees. */
#include <math.h>
#include <string.h>

#include "cloud/linear.h"
#include "io/json_file.h"
#include "simulate/simulate.h"

/* ---- Values: a value that JSON cannot hold (NaN: not known) leaves its key out -------------------------------------- */

static void put(json_t *object, const char *key, json_t *value)
{
    if (value) json_object_set_new(object, key, value);
}

static void put_real(json_t *object, const char *key, double value)
{
    if (isfinite(value)) put(object, key, json_real(value));
}

/* To 12 digits: a hull's facets in one plane may be cut into triangles in more than one way, which changes the last digits. */
static void put_hull(json_t *object, const char *key, double value)
{
    char text[32];
    if (!isfinite(value)) return;
    snprintf(text, sizeof text, "%.12g", value);
    put_real(object, key, strtod(text, NULL));
}

static void put_angle(json_t *object, const char *key, double radians)
{
    put_real(object, key, plm_degrees(radians));
}

static void put_azimuth(json_t *object, const char *key, double radians)
{
    put_real(object, key, fmod(plm_degrees(radians) + 360, 360));
}

static void put_count(json_t *object, const char *key, size_t count)
{
    put(object, key, json_integer((json_int_t)count));
}

static void put_text(json_t *object, const char *key, const char *text)
{
    put(object, key, json_string(text));
}

static json_t *numbers(const double *value, size_t count)
{
    json_t *array = json_array();
    for (size_t k = 0; k < count; k++) json_array_append_new(array, json_real(value[k]));
    return array;
}

static void put_point(json_t *object, const char *key, const double point[3])
{
    put(object, key, numbers(point, 3));
}

/* ---- Organs ------------------------------------------------------------------------------------------------------ */

static json_t *organ(const char *name, size_t id)
{
    json_t *object = json_object();
    put_text(object, "organ", name);
    put_count(object, "organ_id", id);
    return object;
}

/* What a scan adds. The file's coordinates are the plant's own. */
static void put_scanned(json_t *object, double visible_fraction, size_t points, const double centroid[3])
{
    put_real(object, "visible_fraction", visible_fraction);
    if (isfinite(visible_fraction)) put_count(object, "points", points);
    put_point(object, "centroid_in_file", centroid);
}

static json_t *stem_object(const plm_true_stem *stem, size_t id)
{
    json_t *object = organ("stem", id);
    double internode[PLM_TRUE_NODES_MAXIMUM];
    put(object, "parent", stem->parent < 0 ? json_null() : json_integer(stem->parent));
    put_point(object, "centroid", stem->centroid);
    put_real(object, "stem_diameter", stem->diameter);
    put_real(object, "stem_diameter_height", stem->diameter_height);
    put_text(object, "stem_diameter_rule", stem->is_short ? "half length" : "2 cm along the axis");
    put_point(object, "stem_diameter_point", stem->diameter_point);
    put_point(object, "stem_axis", stem->axis);
    put_real(object, "stem_length", stem->length);
    put_angle(object, "stem_inclination", stem->inclination);
    put(object, "node_position", numbers(stem->node, (size_t)stem->node_count));
    for (int k = 1; k < stem->node_count; k++) internode[k - 1] = stem->node[k] - stem->node[k - 1];
    put(object, "internode_length", numbers(internode, stem->node_count > 1 ? (size_t)stem->node_count - 1 : 0));
    put_point(object, "base", stem->base);
    put_point(object, "tip", stem->tip);
    put_scanned(object, stem->visible_fraction, stem->points, stem->centroid);
    return object;
}

static json_t *petiole_object(const plm_true_petiole *petiole, size_t id)
{
    json_t *object = organ("petiole", id);
    put_point(object, "centroid", petiole->centroid);
    put_angle(object, "petiole_inclination", petiole->inclination);
    put_angle(object, "petiole_inclination_pca", petiole->inclination_pca);
    put_real(object, "petiole_length", petiole->length);
    put_real(object, "petiole_diameter", petiole->diameter);
    put_real(object, "petiole_chord_length", petiole->chord);
    put_point(object, "base", petiole->base);
    put_point(object, "junction", petiole->junction);
    if (petiole->is_compound) {
        json_t *first = json_object();
        put_real(first, "length", petiole->first_length);
        put_angle(first, "inclination", petiole->first_inclination);
        put_point(first, "junction", petiole->first_junction);
        put(object, "to_first_leaflet", first);
    }
    put_scanned(object, petiole->visible_fraction, petiole->points, petiole->centroid);
    return object;
}

/* What leaves and leaflets have in common. */
static void put_blade(json_t *object, const plm_true_leaf *leaf)
{
    put_point(object, "centroid", leaf->centroid);
    put_real(object, "leaf_area", leaf->area);
    put_angle(object, "leaf_inclination", leaf->inclination);
    put_angle(object, "facet_inclination_mean", leaf->facet_inclination_mean);
    put_angle(object, "facet_inclination_sd", leaf->facet_inclination_sd);
    put_real(object, "flatness", leaf->flatness);
    put_point(object, "normal", leaf->normal);
    put_azimuth(object, "leaf_azimuth", leaf->azimuth);
    put_real(object, "leaf_length", leaf->length);
    put_real(object, "leaf_width", leaf->width);
    put_real(object, "leaf_width_chord", leaf->width_chord);
    put_point(object, "base", leaf->base);
    put_point(object, "tip", leaf->tip);
}

static json_t *leaflets_of(const plm_virtual_plant *plant, const plm_true_leaf *leaf)
{
    json_t *array = json_array();
    for (size_t k = 0; k < leaf->leaflet_count; k++) {
        const plm_true_leaf *leaflet = &plant->leaflet[leaf->first_leaflet + k];
        json_t *object = json_object();
        put_count(object, "leaflet_id", (size_t)leaflet->leaflet);
        put_blade(object, leaflet);
        put_real(object, "visible_fraction", leaflet->visible_fraction);
        json_array_append_new(array, object);
    }
    return array;
}

static json_t *leaf_object(const plm_virtual_plant *plant, const plm_true_leaf *leaf, size_t id)
{
    static const char *const role[] = {
        [PLM_LEAF_TRUE] = "true", [PLM_LEAF_COTYLEDON] = "cotyledon", [PLM_LEAF_UNIFOLIATE] = "unifoliate"};
    json_t *object = organ("leaf", id);
    put_text(object, "role", role[leaf->role]);
    put(object, "compound", json_boolean(leaf->is_compound));
    put_blade(object, leaf);
    if (leaf->is_compound) {
        put_count(object, "leaflet_count", leaf->leaflet_count);
        put(object, "leaflets", leaflets_of(plant, leaf));
    }
    put_azimuth(object, "leaf_azimuth_from_stem", leaf->azimuth_from_stem);
    put_angle(object, "leaf_insertion_angle", leaf->insertion_angle);
    put_scanned(object, leaf->visible_fraction, leaf->points, leaf->centroid);
    return object;
}

/* ---- The plant ---------------------------------------------------------------------------------------------------- */

static json_t *plant_object(const plm_virtual_plant *plant)
{
    const plm_true_plant *whole = &plant->whole;
    json_t *object = json_object();
    size_t cotyledons = 0;
    for (size_t k = 0; k < plant->leaf_count; k++) cotyledons += plant->leaf[k].role == PLM_LEAF_COTYLEDON;
    put_real(object, "plant_height", whole->height);
    put_real(object, "plant_width", whole->width);
    put_hull(object, "convex_hull_volume", whole->hull_volume);
    put_hull(object, "convex_hull_area", whole->hull_area);
    put_real(object, "pca1", whole->pca1);
    put_real(object, "pca2", whole->pca2);
    put_real(object, "pca_variance_ratio", whole->pca_variance_ratio);
    put(object, "pca_axis1", numbers(whole->pca_axis1, 2));
    put_real(object, "projected_area", whole->projected_area);
    put_real(object, "lowest_z", whole->lowest);
    put_real(object, "highest_z", whole->highest);
    put_real(object, "total_leaf_area", whole->leaf_area);
    put_count(object, "leaf_count", plant->leaf_count);
    put_count(object, "cotyledon_count", cotyledons);
    put_count(object, "leaflet_count", plant->leaflet_count);
    return object;
}

static json_t *organs_array(const plm_virtual_plant *plant)
{
    json_t *array = json_array();
    for (size_t k = 0; k < plant->stem_count; k++) json_array_append_new(array, stem_object(&plant->stem[k], k));
    for (size_t k = 0; k < plant->petiole_count; k++)
        json_array_append_new(array, petiole_object(&plant->petiole[k], k));
    for (size_t k = 0; k < plant->leaf_count; k++) json_array_append_new(array, leaf_object(plant, &plant->leaf[k], k));
    return array;
}

static json_t *definitions(void)
{
    static const char *const text[][2] = {
        {"pca1",
         "extent of the ground projection along the largest axis of the area-weighted xy covariance of the mesh"},
        {"pca2", "the same along the smallest axis"},
        {"plant_width", "largest horizontal distance between two points of the plant"},
        {"plant", "height, width, hull and pca are of all faces of the mesh (fruit and tassel included)"},
        {"leaf_count", "all leaf organs, cotyledons included; a compound leaf is one leaf"},
        {"leaf_inclination",
         "area-weighted best-fit plane normal against zenith, folded to [0,90]; compound: all leaflets"},
        {"leaf_azimuth",
         "ground projection of blade base -> tip, from +x towards +y (compound: petiole base -> last tip)"},
        {"leaf_azimuth_from_stem", "ground projection of plant base -> leaf centroid"},
        {"leaf_length",
         "midrib arc, junction to tip; compound: first leaflet junction along the rachis to the last tip"},
        {"leaf_width", "largest cross-section along the surface; compound: extent across the leaf in its plane"},
        {"petiole_inclination", "chord from the stem's surface to the (last) blade junction against zenith, [0,180]"},
        {"petiole_inclination_pca", "largest principal axis of the petiole's surface outside of the stem"},
        {"petiole_length", "arc from the stem's surface to the (last) blade junction, rachis included"},
        {"petiole_diameter", "half way along the petiole (compound: half way to the first leaflet)"},
        {"leaf_insertion_angle",
         "petiole chord (no petiole: blade's direction at its base) against the stem's axis there"},
        {"stem_diameter",
         "perpendicular to the axis, 2 cm (along the axis) from the base or the branching point; stems "
         "shorter than 4 cm: at half length"},
        {"internode_length", "distances along the stem between successive nodes, from the lowest"},
        {"projected_area", "area of the silhouette seen from above (raster)"},
        {"leaf_overlap", "share of the leaves' silhouettes lost to overlap, looking along z, x and y"},
        {"leaf_pairs_crossing", "pairs of leaves whose surfaces cut each other (junctions left out)"},
        {"flatness", "smallest over middle eigenvalue of the sheet; towards 1 the leaf's plane is not defined"},
    };
    json_t *object = json_object();
    for (size_t k = 0; k < sizeof text / sizeof *text; k++) put_text(object, text[k][0], text[k][1]);
    return object;
}

/* ---- The scan ----------------------------------------------------------------------------------------------------- */

static const char *mode_of(const plm_scan *scan)
{
    switch (scan->used.scanner) {
        case PLM_SCANNER_RGBD:
            return "rgbd";
        case PLM_SCANNER_SPLAT:
            return "splat";
        case PLM_SCANNER_UNIFORM:
            return "uniform";
        default:
            return scan->used.noise > 0 || scan->used.outliers > 0 ? "dome" : "clean";
    }
}

static void put_scanner(json_t *object, const plm_scan *scan)
{
    const plm_scan_options *used = &scan->used;
    char name[80] = "uniform sampling";
    if (used->scanner == PLM_SCANNER_DOME) snprintf(name, sizeof name, "dome of 13 x 25");
    if (used->scanner == PLM_SCANNER_SPLAT) snprintf(name, sizeof name, "splat, %d views", used->views);
    if (used->scanner == PLM_SCANNER_RGBD)
        snprintf(name, sizeof name, "ring of %d depth views at %.2f m", used->views, used->distance);
    put_text(object, "scanner", name);
    put_real(object, "sigma", used->noise);
    if (used->scanner == PLM_SCANNER_RGBD) {
        put_real(object, "voxel", used->voxel);
        put_real(object, "distance", used->distance);
        put_angle(object, "elevation", used->elevation);
        put_real(object, "sigma_at_plant", used->noise * (used->distance / 0.4) * (used->distance / 0.4));
        put_count(object, "pixels", scan->pixels);
        put_real(object, "ghost_share", scan->ghost_share);
    } else {
        put_real(object, "hits_per_mm2", scan->hits_per_area * 1e-6);
    }
    if (used->scanner == PLM_SCANNER_SPLAT) put_real(object, "uneven", used->unevenness);
    put_real(object, "outliers", used->outliers);
}

static json_t *pot_object(const plm_surroundings *place)
{
    json_t *object = json_object();
    put(object, "centre", numbers(place->centre, 2));
    put_real(object, "soil", place->soil);
    put_real(object, "rim", place->rim);
    put_real(object, "radius", place->radius);
    put(object, "table", place->has_table ? json_real(place->table) : json_null());
    return object;
}

static json_t *scan_object(const plm_scan *scan)
{
    json_t *object = json_object(), *has = json_array();
    put_scanner(object, scan);
    if (scan->surroundings.has_pot) put(object, "pot", pot_object(&scan->surroundings));
    if (scan->surroundings.has_pot) json_array_append_new(has, json_string("pot"));
    if (scan->surroundings.has_table) json_array_append_new(has, json_string("table"));
    if (scan->used.outliers > 0) json_array_append_new(has, json_string("outliers"));
    if (scan->used.is_gaussians) json_array_append_new(has, json_string("3dgs"));
    put_real(object, "scale", 1);
    put_text(object, "up", "z");
    put_text(object, "mode", mode_of(scan));
    put_real(object, "sigma_m", scan->used.noise);
    put_real(object, "unit_m", 1);
    put(object, "offset", json_pack("[iii]", 0, 0, 0));
    put(object, "has", has);
    return object;
}

plm_status plm_truth_write(const char *path, const char *plant_id, const plm_virtual_plant *plant, const plm_scan *scan,
                           plm_error *error)
{
    plm_json_use_seam();
    json_t *object = json_object();
    put_text(object, "plant_id", plant_id);
    put_text(object, "kind", plant->kind);
    put(object, "seed", json_integer((json_int_t)plant->seed));
    if (plant->is_arched) put(object, "arched", json_true());
    put_text(object, "unit", "m");
    put_text(object, "angle_unit", "deg");
    put(object, "plant", plant_object(plant));
    put(object, "organs", organs_array(plant));
    put_count(object, "faces", plant->mesh.triangle_count);
    put(object, "definitions", definitions());
    put_count(object, "leaf_pairs_crossing", plant->whole.leaf_pairs_crossing);
    put(object, "leaf_overlap", numbers(plant->whole.leaf_overlap, 3));
    put_text(object, "case", plant_id);
    if (scan) put(object, "scan", scan_object(scan));
    const plm_status status = plm_json_write(path, object, PLM_JSON_DIGITS_ALL, error);
    json_decref(object);
    return status;
}

static json_t *case_object(const plm_truth_case *row)
{
    json_t *object = json_object();
    put_text(object, "case", row->plant_id);
    put_text(object, "plant_id", row->plant_id);
    if (row->file) put_text(object, "file", row->file);
    if (row->labelled) put_text(object, "labelled", row->labelled);
    put_text(object, "truth", row->truth);
    put_text(object, "kind", row->kind);
    put(object, "seed", json_integer((json_int_t)row->seed));
    if (!row->scan) return object;
    json_t *classes = json_object();
    size_t points = 0;
    for (int k = 0; k < PLM_LABEL_COUNT; k++) {
        put_count(classes, plm_label_name((plm_label)k), row->scan->class_points[k]);
        points += row->scan->class_points[k];
    }
    put_text(object, "mode", mode_of(row->scan));
    put_count(object, "points", points);
    put(object, "points_per_class", classes);
    put_real(object, "sigma_m", row->scan->used.noise);
    put(object, "scan", scan_object(row->scan));
    return object;
}

plm_status plm_truth_index_write(const char *path, const char *set, const plm_truth_case *cases, size_t count,
                                 plm_error *error)
{
    plm_json_use_seam();
    json_t *object = json_object(), *rows = json_array(), *classes = json_object();
    for (int k = 0; k < PLM_LABEL_COUNT; k++) {
        const char number[2] = {(char)('0' + k), 0};
        put_text(classes, number, plm_label_name((plm_label)k));
    }
    for (size_t k = 0; k < count; k++) json_array_append_new(rows, case_object(&cases[k]));
    put_text(object, "set", set);
    put_text(object, "unit", "m");
    put(object, "classes", classes);
    put(object, "cases", rows);
    const plm_status status = plm_json_write(path, object, PLM_JSON_DIGITS_ALL, error);
    json_decref(object);
    return status;
}
