/* simulate/build.h: growing a plant organ by organ. Internal.
 *
 * A builder remembers the first failure and then does nothing more, so that the models read as lists of organs;
 * plm_builder_finish gives the status. */
#ifndef PLANTIMETER_SIMULATE_BUILD_H
#define PLANTIMETER_SIMULATE_BUILD_H

#include "cloud/random.h"
#include "simulate/blade.h"
#include "simulate/curve.h"
#include "simulate/simulate.h"

/** Radius of a tube along its axis: base to tip by a power of the share of the length, wider at the base by flare
 * (share) over flare_length, wider by swell (share) at each node over swell_length. */
typedef struct plm_taper {
    double base, tip, power;
    double flare, flare_length;
    double swell, swell_length;
    int node_count;
    double node[PLM_TRUE_NODES_MAXIMUM];
} plm_taper;

double plm_taper_at(const plm_taper *taper, double s, double length);

/** A leaflet on the rachis. */
typedef struct plm_leaflet_spec {
    double share;            /* place along the petiole and rachis, 0 to 1 */
    double turn;             /* from the rachis' direction, radians, positive to the left; 0 for the last one */
    double pitch, roll;      /* of its blade against the rachis' plane */
    double petiolule_length; /* m */
    plm_blade_spec blade;
} plm_leaflet_spec;

enum { PLM_LEAFLETS_MAXIMUM = 24 };

/** A leaf: its petiole and its blade, or its leaflets. */
typedef struct plm_leaf_spec {
    plm_leaf_role role;
    double zenith, azimuth; /* direction in which it leaves the stem */
    double petiole_length;  /* from the stem's surface to the blade; 0: the blade sits on the stem */
    double petiole_radius, petiole_tip_radius, petiole_flare;
    plm_bend petiole_bend;
    double pitch, yaw, roll; /* of the blade against the petiole's end */
    plm_blade_spec blade;    /* simple leaves */
    int leaflet_count;       /* above 0: compound; the last leaflet ends the rachis */
    plm_leaflet_spec leaflet[PLM_LEAFLETS_MAXIMUM];
} plm_leaf_spec;

/** A stem that leaves stand on. A rosette's is hidden: it has no faces and no truth. */
typedef struct plm_built_stem {
    plm_curve axis;
    plm_taper taper;
    bool is_hidden;
} plm_built_stem;

typedef struct plm_builder {
    plm_virtual_plant *plant;
    plm_random random;
    double resolution;
    bool is_arched;
    plm_status status;
    plm_error *error;
    size_t vertex_room, triangle_room, leaf_room, leaflet_room, petiole_room, stem_room;
    plm_built_stem *stem; /* as plant->stem, with curves; hidden ones come last */
    size_t built_count;
    uint8_t label; /* of the faces being added */
    int32_t organ, leaflet;
} plm_builder;

/** Starts an empty plant. */
void plm_builder_start(plm_builder *builder, const char *kind, const plm_plant_options *options,
                       plm_virtual_plant *plant, plm_error *error);

/** Frees the builder's own memory, and the plant when something failed. Gives the first failure. */
plm_status plm_builder_finish(plm_builder *builder);

/** A stem along axis; parent -1 for the main one. Gives its number for plm_build_leaf. A hidden one (a rosette's) only
 * carries. */
int plm_build_stem(plm_builder *builder, int parent, const plm_curve *axis, const plm_taper *taper, bool is_hidden);

/** A leaf at distance node along a stem. Where it would cut other organs, it is turned and lifted a little, some times,
 * and stays in the place where it cuts least. */
void plm_build_leaf(plm_builder *builder, int stem, double node, const plm_leaf_spec *spec);

/** A tube along a curve from s = from to s = to, closed at its ends, with the builder's current label and organ. */
void plm_build_tube(plm_builder *builder, const plm_curve *axis, const plm_taper *taper, double from, double to);

/** The sheet of a blade, with the builder's current label and organ. */
void plm_build_blade(plm_builder *builder, const plm_blade *blade);

/** A sphere, stretched along z: a fruit. */
void plm_build_spheroid(plm_builder *builder, const double centre[3], double radius, double stretch);

/** Number of steps for a part that needs `steps` at resolution 1, at least `least`. */
int plm_build_steps(const plm_builder *builder, double steps, int least);

/** Room for one more vertex or face; false when memory ran out. */
uint32_t plm_build_vertex(plm_builder *builder, const double point[3], double rim, double radius);
void plm_build_triangle(plm_builder *builder, uint32_t a, uint32_t b, uint32_t c);

/** Rays at the faces built so far; NULL when there are none or the builder has failed. Free with plm_rays_free. */
struct plm_rays *plm_build_rays(plm_builder *builder);

/** Number of edges of the faces [first, end) that cut the faces of `earlier`, but for cuts near the axis of stem, where organs
 * grow together. */
size_t plm_build_crossings(const plm_builder *builder, const struct plm_rays *earlier, size_t first, int stem);

#endif
