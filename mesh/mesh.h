/* mesh/mesh.h: surfaces from points, and what can be measured on them.
 *
 * Knows cloud/ only. Metres and radians. Functions that need only points take pointer and count. Every function may run
 * on many threads at once, each with its own outputs. */
#ifndef PLANTIMETER_MESH_MESH_H
#define PLANTIMETER_MESH_MESH_H

#include "../cloud/cloud.h"

#ifdef __cplusplus
extern "C" {
#endif

/** One-sided area of a triangle mesh, square metres: sum of |(b - a) x (c - a)| / 2 in double, compensated, in triangle
 * order. Not Heron's formula: it loses its digits on needles (W. Kahan, Miscalculating Area and Angles of a Needle-like
 * Triangle, 2014; the seedling paper's Eq. 22). A mesh without triangles gives 0.
 * PLM_E_ARGUMENT  a triangle names a vertex that the mesh does not have. */
PLM_API plm_status plm_mesh_area(const plm_mesh *mesh, double *area, plm_error *error);

/** Area-weighted best-fit plane of a mesh. */
typedef struct plm_plane {
    double centroid[3];   /**< area centroid, offset from the mesh's origin */
    double normal[3];     /**< unit, smallest eigenvector of the area-weighted second moments */
    double eigenvalue[3]; /**< second moments per area along the principal axes, largest first, m2 */
    double axis[2][3];    /**< unit axes of the two larger eigenvalues */
} plm_plane;

/** Fits the plane through the exact second moments of the triangles (not their centroids).
 * PLM_E_DEGENERATE  no area. */
PLM_API plm_status plm_mesh_plane(const plm_mesh *mesh, plm_plane *plane, plm_error *error);

/** Volume and area of the convex hull of points (offsets in metres), by exact predicates. Points inside are found by
 * directions first, so that 1e6 points cost little more than reading them. Coplanar points have volume 0 and the area
 * of both faces of the flat hull. hull (may be NULL): out, the hull as a closed mesh, outward facing.
 * PLM_E_DEGENERATE  fewer than 3 points, or all on one line. */
PLM_API plm_status plm_convex_hull(const float (*xyz)[3], size_t count, double *volume, double *area, plm_mesh *hull,
                                   plm_error *error);

typedef struct plm_surface_options {
    double alpha;  /**< radius of the alpha shape's circumcircles, metres; 0: from the spacing, at the area's plateau */
    double noise;  /**< sigma of the points, metres; < 0: measured */
    int fused;     /**< points are voxel means: 1 yes, 0 no, -1 found out */
    double voxel;  /**< edge of the voxels whose means the points are, metres; 0: not known */
    double extent; /**< splats: median larger scale of the gaussians, metres; 0: not a splat */
    uint64_t seed;
} plm_surface_options;

/** A leaf's surface and what it measures. */
typedef struct plm_leaf_surface {
    plm_mesh mesh; /**< one smooth one-sided surface; its own */
    double area;   /**< one-sided, rim bias from sampling and noise corrected, m2 */
    double area_std_error;
    double area_mesh;                                    /**< sum of the mesh's triangles, before the rim correction */
    double boundary_length;                              /**< m */
    double holes_filled;                                 /**< area of filled holes, m2 */
    double alpha;                                        /**< radius used, m */
    double alpha_sensitivity;                            /**< d ln A / d ln alpha at alpha */
    plm_plane plane;                                     /**< area-weighted best-fit plane */
    double plane_std_error;                              /**< of the normal's direction, radians */
    double facet_inclination_mean, facet_inclination_sd; /**< area-weighted, radians from zenith (z) */
    double spacing, noise;
    size_t component_count, chart_count;
    unsigned flags; /**< bit set of PLM_SURFACE_... */
} plm_leaf_surface;

enum {
    PLM_SURFACE_LOW_DENSITY = 1 << 0,
    PLM_SURFACE_OCCLUDED = 1 << 1,
    PLM_SURFACE_CURVED = 1 << 2,
    PLM_SURFACE_ALPHA_SENSITIVE = 1 << 3
};

/** The one-sided surface of a leaf from its points (offsets in metres), single or double layer, noisy or not: local
 * surface fit, charts, alpha-shape triangulation, hole filling, rim correction. Area, plane and their standard errors come
 * with it. The result is the caller's (plm_leaf_surface_free).
 * PLM_E_DEGENERATE  fewer than 12 points, or no triangle of the wanted size (the message names alpha and spacing). */
PLM_API plm_status plm_leaf_surface_make(const float (*xyz)[3], size_t count, const plm_surface_options *options,
                                         plm_leaf_surface *surface, plm_error *error);

PLM_API void plm_leaf_surface_free(plm_leaf_surface *surface);

/** A mesh that looks like the given one with at most about `triangles` triangles, for showing: edges are collapsed where
 * that moves the surface least (M. Garland and P. Heckbert, Surface simplification using quadric error metrics, 1997), by
 * OpenMesh. Areas change: never measure it. face_organ and origin are kept; corners that no triangle names are dropped.
 * out is overwritten unfreed and the caller's. PLM_E_ARGUMENT (a triangle names a missing vertex), PLM_E_MEMORY,
 * PLM_E_LIBRARY. */
PLM_API plm_status plm_mesh_decimate(const plm_mesh *mesh, size_t triangles, plm_mesh *out, plm_error *error);

#ifdef __cplusplus
}
#endif
#endif
