/* simulate/scan.h: what the scanners share. Internal. */
#ifndef PLANTIMETER_SIMULATE_SCAN_H
#define PLANTIMETER_SIMULATE_SCAN_H

#include "simulate/rays.h"
#include "simulate/simulate.h"

/** What the rays can meet: the plant's faces first, then those of pot, soil and table. */
typedef struct plm_stage_set {
    const plm_virtual_plant *plant;
    plm_mesh mesh;      /* all faces */
    size_t plant_faces; /* faces below this number are the plant's */
    plm_rays *rays;
    plm_surroundings surroundings;
    double centre[3]; /* middle of the plant's bounding box */
    double radius;    /* of the sphere about it that holds the plant */
    double target[3]; /* the same with the surroundings: what a scanner should cover */
    double target_radius;
} plm_stage_set;

/** Puts the plant on its stage. options have their defaults filled in. */
plm_status plm_stage_make(const plm_virtual_plant *plant, const plm_scan_options *options, plm_stage_set *stage,
                          plm_error *error);
void plm_stage_free(plm_stage_set *stage);

/** Area of the plant's faces, one-sided. */
double plm_plant_area(const plm_virtual_plant *plant);

/** One scanned point before it becomes a row of the cloud. */
typedef struct plm_sample {
    float xyz[3], normal[3]; /* normal: of the face, turned to the scanner */
    uint32_t face;           /* of the stage's mesh; PLM_NO_FACE: of none (floaters, ghosts) */
    uint8_t rgb[3];
    uint8_t label;
    int32_t organ, leaflet;
} plm_sample;

#define PLM_NO_FACE UINT32_MAX

/** A growing list of samples. */
typedef struct plm_samples {
    size_t count, room;
    plm_sample *sample;
} plm_samples;

plm_status plm_samples_add(plm_samples *samples, const plm_sample *sample, plm_error *error);

/** Fills label, organ, leaflet, normal and colour from the face at a point; direction (may be NULL) of the ray that met
 * it. */
void plm_sample_label(const plm_stage_set *stage, uint32_t face, const double direction[3], uint64_t seed,
                      plm_sample *sample);

/** Adds share * count floaters: half of them near the plant, half anywhere about it. */
plm_status plm_add_floaters(const plm_stage_set *stage, double share, uint64_t seed, plm_samples *samples,
                            plm_error *error);

/** Shifts every sample by independent normal noise along each axis. */
void plm_add_noise(plm_samples *samples, double sigma, uint64_t seed);

/** Sampling of faces at random, evenly over their area. */
typedef struct plm_face_sampler {
    const plm_mesh *mesh;
    size_t count;
    double *sum; /* area up to and with each face */
} plm_face_sampler;

plm_status plm_face_sampler_make(const plm_mesh *mesh, size_t count, plm_face_sampler *sampler, plm_error *error);
void plm_face_sampler_free(plm_face_sampler *sampler);
/** The face and the point that belong to three uniform numbers. */
uint32_t plm_face_sampler_draw(const plm_face_sampler *sampler, double pick, double u, double v, double point[3]);

/** Unit normal of a face of a mesh; gives its area. */
double plm_face_normal(const plm_mesh *mesh, size_t face, double normal[3]);

/** Visible share and number of points of each organ: points drawn on the organ count as seen when a straight line to
 * any of the positions meets nothing. */
plm_status plm_visibility(plm_virtual_plant *plant, const plm_stage_set *stage, const double (*position)[3],
                          size_t count, uint64_t seed, plm_error *error);

/** The scanners. Each fills samples (and what is its own in scan) from a stage. */
plm_status plm_scan_dome(const plm_stage_set *stage, const plm_scan_options *options, plm_samples *samples,
                         plm_scan *scan, plm_error *error);
plm_status plm_scan_rgbd(const plm_stage_set *stage, const plm_scan_options *options, plm_samples *samples,
                         plm_scan *scan, plm_error *error);
plm_status plm_scan_uniform(const plm_stage_set *stage, const plm_scan_options *options, plm_samples *samples,
                            plm_scan *scan, plm_error *error);
plm_status plm_scan_splat(const plm_stage_set *stage, const plm_scan_options *options, plm_samples *samples,
                          plm_scan *scan, plm_error *error);

/** Casts the given number of rays from every scanner of the dome. Samples (may be NULL) get the hits in the order of the rays;
 * hits: out, those on the plant, added. */
plm_status plm_dome_cast(const plm_stage_set *stage, const plm_scan_options *options, uint64_t rays,
                         plm_samples *samples, size_t *hits, plm_error *error);

/** Rays a scanner that give about `wanted` hits on the plant (never fewer, but for the chance of one in a billion), from a trial.
 * PLM_E_DEGENERATE when none meets it. */
plm_status plm_dome_rays(const plm_stage_set *stage, const plm_scan_options *options, size_t wanted, uint64_t *rays,
                         plm_error *error);

/** Positions that a scanner sees from; at most room of them. Gives how many. */
enum { PLM_DOME_LAYERS = 13, PLM_DOME_AROUND = 25, PLM_POSITIONS_MAXIMUM = 1024 };
size_t plm_dome_positions(const plm_stage_set *stage, const plm_scan_options *options, double (*position)[3]);
size_t plm_ring_positions(const plm_stage_set *stage, const plm_scan_options *options, double (*position)[3]);
size_t plm_splat_positions(const plm_stage_set *stage, const plm_scan_options *options, double (*position)[3]);

#endif
