/* simulate/blade.h: leaf blades as bent parametric sheets. Internal.
 *
 * A blade is drawn flat (x along the midrib from the junction, y to its side, metres) and then bent: the midrib follows
 * a curve, each cross-section is an arc of a circle with a fold at the midrib, and waves and dimples lift it along the
 * midrib's normal. Without waves, lengths along the midrib and along cross-sections are those of the drawing. */
#ifndef PLANTIMETER_SIMULATE_BLADE_H
#define PLANTIMETER_SIMULATE_BLADE_H

#include <stdbool.h>

#include "simulate/curve.h"

enum { PLM_OUTLINE_POINTS = 512 };

typedef struct plm_blade_spec {
    double detail;         /* of the mesh against other blades; 0 means 1 */
    double length, width;  /* of the midrib; largest width of the drawing */
    bool is_palmate;       /* outline around a centre (heart-shaped base, lobes all around), else two margins */
    double rise, fall;     /* margins: half width goes as t^rise (1 - t)^fall, t the share of the length */
    double base_width;     /* margins: width at the junction */
    int lobe_count;        /* a side (margins), all around (palmate) */
    double lobe_depth;     /* 0 to 1 */
    double lobe_power;     /* palmate: below 1 round lobes, above 1 pointed ones */
    double sinus;          /* palmate: how far the basal lobes reach back, share of the length */
    double sinus_width;    /* palmate: of the gap between them, radians about the centre; 0 means 0.35 */
    int tooth_count;       /* a side (margins), all around (palmate) */
    double tooth_depth;    /* 0 to 1 */
    double asymmetry;      /* -1 to 1: the left half is wider */
    plm_bend bend;         /* of the midrib */
    double fold, fold_end; /* angle of each half against the flat sheet at the junction and at the tip, radians */
    double cup;            /* turn of each half from midrib to margin, radians (positive: margins upwards) */
    double clasp_radius, clasp_length; /* the foot is rolled to this radius, and unrolls over this length; 0: none */
    double wave, wave_count, wave_phase[2];    /* of the margins: amplitude in m, periods over the length, each side */
    double dimple, dimple_count, dimple_phase; /* relief between the veins: amplitude in m */
} plm_blade_spec;

/** A blade in its place. */
typedef struct plm_blade {
    plm_blade_spec spec;
    plm_curve midrib;
    int outline_count; /* of the closed polygon of the drawing */
    double outline[PLM_OUTLINE_POINTS][2];
    double centre; /* palmate: x of the centre */
} plm_blade;

/** Makes the outline and the midrib. start and frame: the junction, the midrib's direction and the upper side there. */
void plm_blade_place(const plm_blade_spec *spec, const double start[3], const plm_frame_at *frame, plm_blade *blade);

/** Half widths of the drawing at the share t of the length: left (positive y) and right. Margins only. */
void plm_blade_margins(const plm_blade_spec *spec, double t, double half[2]);

/** Point of the surface that belongs to (x, y) of the drawing. */
void plm_blade_point(const plm_blade *blade, double x, double y, double point[3]);

/** Distance of (x, y) from the drawing's outline. */
double plm_blade_rim(const plm_blade *blade, double x, double y);

/** Largest cross-section: along the surface and as a chord. */
void plm_blade_width(const plm_blade *blade, double *width, double *chord);

#endif
