/* SPDX-License-Identifier: Apache-2.0 */
/* A shape descriptor based on guards [YL11, section 5.1]: a graph of guards with the distances from
 * each guard to the boundary in all directions. */
#ifndef STARGUARD_DESCRIPTOR_H
#define STARGUARD_DESCRIPTOR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "context.h"
#include "fields.h"
#include "mesh.h"
#include "shape.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A guard of a star-shaped piece of the solid. */
typedef struct starg_descriptor_guard {
    double position[3];
    double volume; /* of its piece */
} starg_descriptor_guard;

/* Two guards whose pieces share faces. */
typedef struct starg_descriptor_edge {
    uint32_t first, second; /* first < second; edges ascend           */
    double area;            /* of the shared faces                    */
    double gate[3];         /* their centroid */
} starg_descriptor_edge;

enum {
    STARG_DESCRIPTOR_VIEW = 8,
    STARG_DESCRIPTOR_SPREAD = 16,
    STARG_DESCRIPTOR_ENERGIES = 12,
    STARG_DESCRIPTOR_EIGENVALUES = 40
};

typedef struct starg_descriptor {
    char *file; /* as given to the writer, or NULL */
    size_t model_vertices, model_faces;
    double diagonal;   /* of the model's bounding box             */
    size_t detail;     /* vertices after simplification; 0: not simplified */
    uint64_t effort;   /* trials of the decomposition */
    bool time_limited; /* the time limit stopped the search */
    size_t guard_count;
    starg_descriptor_guard *guards;
    size_t edge_count;
    starg_descriptor_edge *edges;
    size_t direction_count;
    double *distances; /* guard_count x direction_count: to the first point of the boundary */
    /* Visibility statistics of points evenly distributed in the solid: row k holds quantiles, over
     * the points, of the k-th quantile of a point's distances to the boundary. Rows and columns
     * ascend. */
    double views[STARG_DESCRIPTOR_VIEW][STARG_DESCRIPTOR_SPREAD];
    /* The smallest nonzero eigenvalues of the Laplace-Beltrami operator of the boundary, times its
     * area, ascending. */
    double surface_spectrum[STARG_DESCRIPTOR_EIGENVALUES];
    /* Wave kernel signature of the boundary: row k holds its quantiles over the surface at the k-th
     * energy, normalized to mean 1. Rows ascend. */
    double wave_kernel[STARG_DESCRIPTOR_ENERGIES][STARG_DESCRIPTOR_SPREAD];
} starg_descriptor;

enum {
    STARG_DESCRIPTOR_DIRECTIONS = 256,
    STARG_DESCRIPTOR_EFFORT = 50,
    STARG_DESCRIPTOR_DETAIL = 3000
};

typedef struct starg_descriptor_options {
    size_t direction_count; /* 12 to 65536                                        */
    uint64_t effort; /* trials of the strict decomposition, 1 or more: more trials give fewer guards
                        and take longer */
    size_t detail;   /* vertices after smoothing, simplifying and repairing the model, which reduces
                        the influence of noise and resolution; a third of them for the pieces; 0:
                        keep the model. Default 3,000 */
} starg_descriptor_options;

STARG_API void starg_descriptor_options_default(starg_descriptor_options *options);

/* Names, ranges and descriptions of the options. */
STARG_API const starg_fields *starg_descriptor_options_fields(void);

/* Direction `index` of `count` evenly distributed directions: points of a Fibonacci lattice. */
STARG_API void starg_descriptor_direction(size_t count, size_t index, double out[3]);

/* Describes a model. A mesh with holes is never simplified, and is filled as by
 * starg_decompose_open_mesh. `options` may be NULL. Errors: ARGUMENT, MESH (encloses nothing),
 * SOLVER, MEMORY, CANCELLED, TIME. */
STARG_API starg_status starg_descriptor_create(starg_context *context, const starg_mesh *mesh,
                                               const starg_descriptor_options *options,
                                               starg_descriptor **out);
STARG_API void starg_descriptor_free(starg_context *context, starg_descriptor *descriptor);

/* Writes DESCRIPTOR.json (docs/formats.md); `model_file` is stored as the model's path and may be
 * NULL. "-" is standard output. Errors: WRITE, MEMORY. */
STARG_API starg_status starg_descriptor_write(starg_context *context,
                                              const starg_descriptor *descriptor,
                                              const char *model_file, const char *path);
/* The same in memory, followed by a zero byte. Free with starg_text_free. Errors: MEMORY. */
STARG_API starg_status starg_descriptor_write_memory(starg_context *context,
                                                     const starg_descriptor *descriptor,
                                                     const char *model_file, char **text,
                                                     size_t *size);

/* Reads a descriptor. Errors: READ, FORMAT, MEMORY. */
STARG_API starg_status starg_descriptor_read(starg_context *context, const char *path,
                                             starg_descriptor **out);
/* The same from memory; `name` is used in messages. */
STARG_API starg_status starg_descriptor_read_memory(starg_context *context, const void *bytes,
                                                    size_t size, const char *name,
                                                    starg_descriptor **out);

/* Whether these bytes may begin a descriptor, that is, a JSON object. No model begins so. */
STARG_API bool starg_descriptor_recognized(const void *bytes, size_t size);

/* ---- reconstruction ---- */

/* The boundary as the descriptor knows it: a point for each guard and direction, guard_count x
 * direction_count x 3 numbers, to be freed with starg_descriptor_points_free. Errors: MEMORY. */
STARG_API starg_status starg_descriptor_points(starg_context *context,
                                               const starg_descriptor *descriptor, double **out);
STARG_API void starg_descriptor_points_free(starg_context *context, double *points);

/* How close these points come to a model; all as fractions of the diagonal of its bounding box. */
typedef struct starg_reconstruction {
    size_t points, samples;     /* of the descriptor; of the surface, uniform in area          */
    double to_mean, to_largest; /* from the points to the surface                      */
    double from_mean, from_largest; /* from the samples to the nearest point               */
} starg_reconstruction;

/* Measures it. Errors: MESH (no area), MEMORY, CANCELLED. */
STARG_API starg_status starg_descriptor_reconstruct(starg_context *context,
                                                    const starg_descriptor *descriptor,
                                                    const starg_mesh *mesh,
                                                    starg_reconstruction *out);

/* ---- signatures ---- */

/* A signature of a kind that is made of descriptors (STAR, PAPER). Errors: ARGUMENT (another kind),
 * FORMAT (lengths that do not fit each other, as no model has), MEMORY. */
STARG_API starg_status starg_signature_of_descriptor(starg_context *context,
                                                     const starg_descriptor *descriptor,
                                                     starg_signature_kind kind,
                                                     starg_signature **out);

#ifdef __cplusplus
}
#endif

#endif
