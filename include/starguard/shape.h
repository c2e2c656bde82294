/* SPDX-License-Identifier: Apache-2.0 */
/* Shape comparison: signatures, distances, and retrieval measures. */
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
    STARG_SIGNATURE_SHAPE_DNA = 1, /* Laplace-Beltrami spectrum */
    STARG_SIGNATURE_STAR = 2,      /* visibility and spectra of a star decomposition */
    STARG_SIGNATURE_PAPER = 3      /* the guarding graph and histograms of [YL11]            */
} starg_signature_kind;

enum { STARG_SIGNATURE_KINDS = 4, STARG_SIGNATURE_DEFAULT = STARG_SIGNATURE_STAR };

/* A signature of a model. Only signatures of the same kind and version are comparable; a version
 * changes whenever the numbers do. */
typedef struct starg_signature {
    starg_signature_kind kind;
    int version;
    size_t count;
    double *numbers;
} starg_signature;

/* The name of a kind in files and on the command line; NULL for an unknown kind. */
STARG_API const char *starg_signature_name(starg_signature_kind kind);

/* The current version of a kind. */
STARG_API int starg_signature_version(starg_signature_kind kind);

/* Computes a signature. It is invariant to translation, rotation, scaling, reflection and vertex
 * order, up to rounding (SHAPE_DNA) or sampling noise (D2). Errors: ARGUMENT (unknown kind), MESH
 * (no area), SOLVER, MEMORY, CANCELLED. */
STARG_API starg_status starg_signature_create(starg_context *context, const starg_mesh *mesh,
                                              starg_signature_kind kind, starg_signature **out);

/* Computes signatures of all kinds with a single descriptor. */
STARG_API starg_status starg_signature_create_all(starg_context *context, const starg_mesh *mesh,
                                                  starg_signature *out[STARG_SIGNATURE_KINDS]);

/* Whether a kind is computed from a descriptor (starguard/descriptor.h). */
STARG_API bool starg_signature_needs_descriptor(starg_signature_kind kind);
STARG_API void starg_signature_free(starg_context *context, starg_signature *signature);

/* Restores a signature from stored numbers. Errors: ARGUMENT (unknown kind), FORMAT (wrong numbers
 * for the current version), MEMORY. */
STARG_API starg_status starg_signature_restore(starg_context *context, starg_signature_kind kind,
                                               int version, const double *numbers, size_t count,
                                               starg_signature **out);

/* Distance between two signatures, 0 or more. Errors: ARGUMENT (kinds or versions differ). */
STARG_API starg_status starg_signature_distance(starg_context *context, const starg_signature *a,
                                                const starg_signature *b, double *out);

/* Distance matrix of `count` signatures of one kind: count x count, symmetric, zero diagonal.
 * Errors: ARGUMENT, MEMORY, CANCELLED. */
STARG_API starg_status starg_signature_distances(starg_context *context,
                                                 starg_signature *const *signatures, size_t count,
                                                 double *distances);

/* ---- scale and hand ---- */

typedef enum starg_hand {
    STARG_HAND_SAME = 0,
    STARG_HAND_MIRRORED = 1,
    STARG_HAND_UNDECIDED = 2 /* symmetric, or no copies of each other */
} starg_hand;

/* The name of a hand in reports; NULL for an unknown one. */
STARG_API const char *starg_hand_name(starg_hand hand);

/* How B lies to A once moved and scaled onto it, which signatures do not tell. */
typedef struct starg_alignment {
    double scale; /* a length in B by that in A: root of the ratio of areas */
    starg_hand hand;
    double same, mirrored; /* root mean square distance of B from A and from A's mirror image, where
                              a motion makes them least, by the diagonal of A's bounding box */
} starg_alignment;

/* Measures it. Limbs that bend make shapes differ. Errors: MESH (no area), MEMORY, CANCELLED. */
STARG_API starg_status starg_alignment_measure(starg_context *context, const starg_mesh *a,
                                               const starg_mesh *b, starg_alignment *out);

/* ---- retrieval ---- */

enum { STARG_RECALL_LEVELS = 20 };
#define STARG_NO_CLASS UINT32_MAX

/* Retrieval measures, averaged over queries, each in [0, 1]; 1 is perfect. A query ranks all other
 * models by distance (ties by index); the r others of its class are relevant. */
typedef struct starg_retrieval {
    size_t models, queries;   /* in the class; a query needs another model of its class */
    double nearest_neighbour; /* the first is relevant                                      */
    double first_tier;        /* relevant ones among the first r, by r                      */
    double second_tier;       /* relevant ones among the first 2 r, by r                    */
    double e_measure;         /* 2 / (1 / precision + 1 / recall) of the first 32           */
    double dcg;               /* normalized discounted cumulative gain */
    /* Interpolated precision at recall 1/20, 2/20, ..., 1. */
    double precision[STARG_RECALL_LEVELS];
} starg_retrieval;

/* Computes the measures of [SMKF04] from a distance matrix (count x count) and classes. Every model
 * is a query once. Models of class STARG_NO_CLASS are neither queries nor ranked. `classes`
 * receives class_count results (all zero for classes without queries), `overall` the means over all
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
