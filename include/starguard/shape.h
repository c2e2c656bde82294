/* SPDX-License-Identifier: Apache-2.0 */
/* Comparing shapes: signatures of models, distances between them, and how well such distances
 * retrieve models of the same class. */
#ifndef STARGUARD_SHAPE_H
#define STARGUARD_SHAPE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "context.h"
#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- signatures ---- */

typedef enum starg_signature_kind {
    STARG_SIGNATURE_D2 = 0,        /* distribution of distances between points of the surface */
    STARG_SIGNATURE_SHAPE_DNA = 1, /* eigenvalues of the surface's Laplacian                 */
    STARG_SIGNATURE_STAR = 2,      /* what is seen from a star decomposition, and its spectra   */
    STARG_SIGNATURE_PAPER = 3      /* the guarding graph and histograms of [YL11]            */
} starg_signature_kind;

enum { STARG_SIGNATURE_KINDS = 4, STARG_SIGNATURE_DEFAULT = STARG_SIGNATURE_STAR };

/* What a model is compared by. Signatures compare with those of the same kind and version only; a
 * version changes whenever the numbers do. */
typedef struct starg_signature {
    starg_signature_kind kind;
    int version;
    size_t count;
    double *numbers;
} starg_signature;

/* The word for a kind in files and on the command line; NULL if there is no such kind. */
STARG_API const char *starg_signature_name(starg_signature_kind kind);

/* The version that starg_signature_create makes. */
STARG_API int starg_signature_version(starg_signature_kind kind);

/* Computes a signature. It does not change when the model is moved, turned, scaled or mirrored or
 * its vertices are numbered anew, up to rounding (SHAPE_DNA) or the noise of a sample (D2).
 * Errors: ARGUMENT (unknown kind), MESH (no area), SOLVER, MEMORY, CANCELLED. */
STARG_API starg_status starg_signature_create(starg_context *context, const starg_mesh *mesh,
                                              starg_signature_kind kind, starg_signature **out);

/* The signatures of all kinds, for which a descriptor is made once. */
STARG_API starg_status starg_signature_create_all(starg_context *context, const starg_mesh *mesh,
                                                  starg_signature *out[STARG_SIGNATURE_KINDS]);

/* Is a kind made of a descriptor (starguard/descriptor.h)? */
STARG_API bool starg_signature_needs_descriptor(starg_signature_kind kind);
STARG_API void starg_signature_free(starg_context *context, starg_signature *signature);

/* A signature of numbers that were stored. Errors: ARGUMENT (unknown kind), FORMAT (not what the
 * kind's present version consists of), MEMORY. */
STARG_API starg_status starg_signature_restore(starg_context *context, starg_signature_kind kind,
                                               int version, const double *numbers, size_t count,
                                               starg_signature **out);

/* How unlike two models are, from 0 on. Errors: ARGUMENT (kinds or versions differ). */
STARG_API starg_status starg_signature_distance(starg_context *context, const starg_signature *a,
                                                const starg_signature *b, double *out);

/* All distances between `count` signatures of one kind: count x count, symmetric, zeros on the
 * diagonal. Errors: ARGUMENT, MEMORY, CANCELLED. */
STARG_API starg_status starg_signature_distances(starg_context *context,
                                                 starg_signature *const *signatures, size_t count,
                                                 double *distances);

/* ---- retrieval ---- */

enum { STARG_RECALL_LEVELS = 20 };
#define STARG_NO_CLASS UINT32_MAX

/* Means over queries, each in [0, 1]; 1 is perfect. A query ranks all other models by distance
 * (equal ones by their index); relevant are the r others of its class. */
typedef struct starg_retrieval {
    size_t models, queries;   /* of the class; queries are those with another model to find */
    double nearest_neighbour; /* the first is relevant                                      */
    double first_tier;        /* relevant ones among the first r, by r                      */
    double second_tier;       /* relevant ones among the first 2 r, by r                    */
    double e_measure;         /* 2 / (1 / precision + 1 / recall) of the first 32           */
    double dcg;               /* discounted cumulative gain, by its largest possible value  */
    /* Largest precision at or beyond the recalls 1/20, 2/20, ..., 1. */
    double precision[STARG_RECALL_LEVELS];
} starg_retrieval;

/* Measures of [SMKF04] for distances (count x count) between models of known classes. Every model
 * is a query in its turn. A model of class STARG_NO_CLASS is neither query nor ranked. `classes`
 * receives class_count results (queries 0: nothing to find, all zero), `overall` the means over all
 * queries. Errors: ARGUMENT (a class out of range, a distance that is negative or not a number),
 * MEMORY, CANCELLED. */
STARG_API starg_status starg_retrieval_measure(starg_context *context, const double *distances,
                                               const uint32_t *class_of, size_t count,
                                               size_t class_count, starg_retrieval *classes,
                                               starg_retrieval *overall);

#ifdef __cplusplus
}
#endif

#endif
