/* SPDX-License-Identifier: Apache-2.0 */
/* Procedural closed solids for demonstrations, tests and benchmarks. */
#ifndef STARGUARD_SAMPLE_H
#define STARGUARD_SAMPLE_H

#include <stdbool.h>
#include <stddef.h>

#include "context.h"
#include "fields.h"
#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* One entry of the catalogue; static storage. */
typedef struct starg_sample_info {
    const char *name;        /* lower case, for example "horse"                             */
    const char *description; /* one line                                                    */
    int poses;               /* 1: it has no others; poses of one sample share connectivity, those
                                of a family (vase, bust, bearing, table, tool) are its members */
    bool scene;              /* not one embedded shell: shells that touch or overlap, open sheets */
} starg_sample_info;

STARG_API size_t starg_sample_count(void);
/* NULL when `index` is not below starg_sample_count(). */
STARG_API const starg_sample_info *starg_sample_at(size_t index);

typedef struct starg_sample_options {
    int pose;            /* 0 to poses - 1                                                  */
    size_t vertex_count; /* 500 to 10,000,000, solids of cubes from 20; approximate (rigid polyhedra
                            have fixed sizes) */
} starg_sample_options;

/* Pose 0, 5,000 vertices. */
STARG_API void starg_sample_options_default(starg_sample_options *options);

/* Names, ranges and descriptions of the options. */
STARG_API const starg_fields *starg_sample_options_fields(void);

/* Generates the sample `name`: a closed, outward oriented, embedded mesh. `options` may be NULL.
 * Errors: ARGUMENT (unknown name, pose or size out of range), MEMORY, CANCELLED. */
STARG_API starg_status starg_sample_create(starg_context *context, const char *name,
                                           const starg_sample_options *options, starg_mesh **out);

#ifdef __cplusplus
}
#endif

#endif
