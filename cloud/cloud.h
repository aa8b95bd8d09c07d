/* cloud/cloud.h: the ground floor: status and errors, memory, point clouds and triangle meshes.
 *
 * Knows nothing of the other modules. SI throughout: metres, radians. A fallible function returns a plm_status; the
 * message (place, what was found, what was expected) travels in the caller's plm_error. Nothing here prints, exits or
 * aborts. Every function may run on many threads at once as long as each call has its own outputs. */
#ifndef PLANTIMETER_CLOUD_CLOUD_H
#define PLANTIMETER_CLOUD_CLOUD_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define PLM_API                 __attribute__((visibility("default")))
#define PLM_PRINTF(text, first) __attribute__((format(printf, text, first)))
#else
#define PLM_API
#define PLM_PRINTF(text, first)
#endif

/** Marks a function whose contract may still change in a minor version. */
#define PLM_EXPERIMENTAL

/** What a call came to. Grouped by who can mend it. */
typedef enum plm_status {
    PLM_OK = 0,
    PLM_E_ARGUMENT,   /**< the caller passed something out of its range */
    PLM_E_MEMORY,     /**< an allocation failed */
    PLM_E_READ,       /**< a file cannot be opened or read */
    PLM_E_FORMAT,     /**< a file's content is not what its format says */
    PLM_E_WRITE,      /**< a file cannot be written */
    PLM_E_DEGENERATE, /**< the points do not determine what was asked for (too few, collinear, no surface, ...) */
    PLM_E_LIBRARY,    /**< a library underneath failed; the message carries its text */
    PLM_E_TIME,       /**< given up: a deadline passed */
} plm_status;

enum { PLM_ERROR_LENGTH = 512 };

/** The message of a failed call. Fixed size, so that reporting "no memory" needs none. Cut, never overrun. */
typedef struct plm_error {
    plm_status status;
    char message[PLM_ERROR_LENGTH];
} plm_error;

/** Writes a printf-style message into error (which may be NULL) and returns status, so that
 * `return plm_fail(error, PLM_E_FORMAT, "...")` is one line. */
PLM_API plm_status plm_fail(plm_error *error, plm_status status, const char *format, ...) PLM_PRINTF(3, 4);

/** The status's name in words ("bad argument", "out of memory", ...). Static storage. */
PLM_API const char *plm_status_name(plm_status status);

/* ---- Time ------------------------------------------------------------------------------------------------------ */

/** A moment by which work should have ended. Work in several steps asks between them, and is given up with PLM_E_TIME. */
typedef struct plm_deadline {
    double at;                   /**< seconds on the clock */
    double (*clock)(void *user); /**< NULL: the machine's steady clock, CLOCK_MONOTONIC */
    void *user;
} plm_deadline;

/** The time on the deadline's clock; deadline may be NULL. */
PLM_API double plm_deadline_now(const plm_deadline *deadline);
/** Whether it passed; never where deadline is NULL. */
PLM_API bool plm_deadline_passed(const plm_deadline *deadline);
/** PLM_OK, or PLM_E_TIME where it passed. */
PLM_API plm_status plm_deadline_check(const plm_deadline *deadline, plm_error *error);

/* ---- Memory: the one seam through which the library allocates ------------------------------------------------ */

/** Replacement allocator. reallocate(NULL, size) allocates; reallocate may return NULL to fail; release(NULL) is
 * allowed. user is handed to each. Both are called from several threads. */
typedef struct plm_allocator {
    void *(*reallocate)(void *block, size_t size, void *user);
    void (*release)(void *block, void *user);
    void *user;
} plm_allocator;

/** Installs an allocator for the whole process; NULL brings back malloc and free. Call before anything is allocated. */
PLM_API void plm_set_allocator(const plm_allocator *allocator);

/** Room for count elements of size bytes each, not initialised. Checks count * size for overflow. count 0 gives a
 * valid block that must be freed. NULL on failure, with the number of bytes asked for in error (which may be NULL). */
PLM_API void *plm_alloc(size_t count, size_t size, plm_error *error);

/** As plm_alloc, filled with zero bytes. */
PLM_API void *plm_alloc_zero(size_t count, size_t size, plm_error *error);

/** Changes a block's size. NULL on failure; the old block is then still valid. block may be NULL. */
PLM_API void *plm_realloc(void *block, size_t count, size_t size, plm_error *error);

/** Frees a block of plm_alloc, plm_alloc_zero or plm_realloc. NULL is allowed. */
PLM_API void plm_free(void *block);

/** A copy of text in a block of its own; the caller frees it with plm_free. */
PLM_API char *plm_strdup(const char *text, plm_error *error);

/* ---- Organs -------------------------------------------------------------------------------------------------- */

/** Class of a point, as in the labelled files: field `label`. */
typedef enum plm_label {
    PLM_LABEL_OTHER = 0, /**< noise, floaters, fruit, whatever is not one of the below */
    PLM_LABEL_STEM = 1,
    PLM_LABEL_PETIOLE = 2,
    PLM_LABEL_LEAF = 3,
    PLM_LABEL_GROUND = 4, /**< pot, soil, table */
    PLM_LABEL_COUNT
} plm_label;

/** "other", "stem", "petiole", "leaf" or "ground". Static storage. */
PLM_API const char *plm_label_name(plm_label label);

/* ---- Clouds -------------------------------------------------------------------------------------------------- */

/** A point cloud: float32 offsets from a double-precision origin, and one array for each attribute that the scene has.
 * An array is NULL where the scene lacks the attribute. All arrays have count rows and belong to the cloud. */
typedef struct plm_cloud {
    size_t count;
    double origin[3];
    float (*xyz)[3];    /**< offset from origin, metres once the scale is known, file units before */
    uint8_t (*rgb)[3];  /**< colour, 0 to 255 */
    float (*normal)[3]; /**< unit normals as the file gives them; of a splat: its shortest axis */
    float (*extent)[2]; /**< of a splat: standard deviations along its two long axes, longest first, as xyz's unit */
    float *opacity;     /**< of a splat: 0 to 1 */
    uint8_t *label;     /**< plm_label; only where the file was labelled */
    int32_t *organ;     /**< number of the organ within its class, -1 for none */
    int32_t *leaflet;   /**< of a compound plant's leaf points: number within the leaf, from 0; -1 for none */
    uint32_t *source;   /**< row of the input file that the point came from (0-based); NULL: row i is point i */
} plm_cloud;

/** An attribute to make room for in plm_cloud_create. */
typedef enum plm_attribute {
    PLM_HAS_RGB = 1 << 0,
    PLM_HAS_NORMAL = 1 << 1,
    PLM_HAS_EXTENT = 1 << 2,
    PLM_HAS_OPACITY = 1 << 3,
    PLM_HAS_LABEL = 1 << 4,
    PLM_HAS_ORGAN = 1 << 5,
    PLM_HAS_SOURCE = 1 << 6,
    PLM_HAS_LEAFLET = 1 << 7
} plm_attribute;

/** Makes a cloud of count points with xyz and the named attributes (a bit set of plm_attribute), not initialised,
 * origin 0. cloud is overwritten without being freed; free it with plm_cloud_free. */
PLM_API plm_status plm_cloud_create(size_t count, unsigned attributes, plm_cloud *cloud, plm_error *error);

/** Frees what the cloud owns and leaves an empty cloud. A zeroed cloud and NULL are allowed. */
PLM_API void plm_cloud_free(plm_cloud *cloud);

/** The attributes that the cloud has, as a bit set of plm_attribute. */
PLM_API unsigned plm_cloud_attributes(const plm_cloud *cloud);

/** A new cloud of the rows index[0..count) of cloud, in that order, with all its attributes. source names the rows of
 * the original file (through cloud->source where that exists). PLM_E_ARGUMENT when an index is out of range. */
PLM_API plm_status plm_cloud_select(const plm_cloud *cloud, const uint32_t *index, size_t count, plm_cloud *selection,
                                    plm_error *error);

/** Smallest and largest offset along x, y and z (origin not added). An empty cloud gives PLM_E_DEGENERATE. */
PLM_API plm_status plm_cloud_bounds(const plm_cloud *cloud, float low[3], float high[3], plm_error *error);

/* ---- Triangle meshes ------------------------------------------------------------------------------------------ */

/** A triangle mesh. Vertices are double offsets from origin, in metres. face_organ is NULL or has one organ number a
 * triangle. Arrays belong to the mesh. */
typedef struct plm_mesh {
    size_t vertex_count;
    size_t triangle_count;
    double origin[3];
    double (*vertex)[3];
    uint32_t (*triangle)[3]; /**< indices of vertices, counter-clockwise seen from the front */
    int32_t *face_organ;
} plm_mesh;

/** Room for a mesh of the given sizes, not initialised, origin 0, no face_organ. mesh is overwritten unfreed. */
PLM_API plm_status plm_mesh_create(size_t vertex_count, size_t triangle_count, plm_mesh *mesh, plm_error *error);

/** Frees what the mesh owns and leaves an empty mesh. A zeroed mesh and NULL are allowed. */
PLM_API void plm_mesh_free(plm_mesh *mesh);

#ifdef __cplusplus
}
#endif
#endif
