/* selftest/checks.h: rows of the table, and clouds to measure. Internal. */
#ifndef PLANTIMETER_SELFTEST_CHECKS_H
#define PLANTIMETER_SELFTEST_CHECKS_H

#include "selftest/selftest.h"
#include "traits/traits.h"

/** A table being filled, and the first failure to do so, after which nothing more is done. */
typedef struct plm_checker {
    plm_check_table *table;
    plm_status status;
    plm_error *error;
    char scene[64]; /**< the case of the rows that are added */
} plm_checker;

/** What a value is held to. */
typedef struct plm_bound {
    double error;
    double condition; /**< NAN: none */
    double scale;     /**< what the error is relative to; 0: the reference */
    const char *note; /**< NULL: none */
} plm_bound;

/** Names the case of the rows to come, in printf style. */
void plm_check_scene(plm_checker *checker, const char *format, ...) PLM_PRINTF(2, 3);

void plm_check_value(plm_checker *checker, const char *measure, double found, double reference, plm_bound bound);

/** A call that must give no value but say why. */
void plm_check_refused(plm_checker *checker, const char *measure, plm_status status, const plm_error *why);

/** A call that may not fail: the row of one that did is a defect. True when it went well. */
bool plm_check_ran(plm_checker *checker, const char *measure, plm_status status, const plm_error *why);

/** Measures a plant (cloud is taken over), and adds the row "all values": how many are neither finite nor explained.
 * traits: as plm_measure_options. False where the measurement itself was refused, which is a row as well. */
bool plm_check_measure(plm_checker *checker, plm_cloud *cloud, const char *traits, plm_measurement *plant);

/** Checks a trait of a measured plant, of the organ of the number (-1 at plant level), against reference. Where it is not
 * ok, its reason is the row; must: that is a defect. bound.error < 0: that many of its own standard errors. */
void plm_check_trait(plm_checker *checker, const plm_measurement *plant, const char *trait, int32_t organ,
                     double reference, plm_bound bound, bool must);

/* ---- Clouds that grow ------------------------------------------------------------------------------------------- */

/** A cloud in the making: labelled points in a frame of its own. */
typedef struct plm_maker {
    plm_checker *checker;
    plm_cloud cloud;
    size_t room;
    uint64_t key, drawn; /**< of random numbers */
} plm_maker;

/** Room for count points with labels and organs. */
void plm_maker_start(plm_maker *maker, plm_checker *checker, size_t count, uint64_t seed);
void plm_maker_add(plm_maker *maker, const double point[3], plm_label label, int32_t organ);
double plm_maker_uniform(plm_maker *maker);
double plm_maker_normal(plm_maker *maker);

/** A parallelogram corner + a u + b v, of as many points as are told, spread evenly at random (stratified) in a and b of
 * [0, 1); noise: SD off its plane, m. */
void plm_maker_sheet(plm_maker *maker, const double corner[3], const double u[3], const double v[3], int per_side,
                     double noise, plm_label label, int32_t organ);

/** A tube round the line from begin to end: directions of arc radians about it (from the x axis of its frame), as many
 * points as told; noise isotropic, m. */
void plm_maker_tube(plm_maker *maker, const double begin[3], const double end[3], double radius, double arc,
                    size_t count, double noise, plm_label label, int32_t organ);

/** Forgets the labels: the program must find the organs. */
void plm_maker_unlabel(plm_maker *maker);

/* ---- Groups: one file each ---------------------------------------------------------------------------------------- */

void plm_stability_meshes(plm_checker *checker);
void plm_stability_hulls(plm_checker *checker);
void plm_stability_eigenvectors(plm_checker *checker);
void plm_stability_leaves(plm_checker *checker);
void plm_stability_tubes(plm_checker *checker);
void plm_stability_plants(plm_checker *checker);
void plm_stability_numbers(plm_checker *checker);
void plm_stability_places(plm_checker *checker);

#endif
