/* SPDX-License-Identifier: Apache-2.0 */
/* Common interface of all kinds of signatures: the table of kinds, and what is common to them. */

#include <math.h>

#include "core/parallel.h"
#include "shape/measures.h"
#include "shape/signature_kinds.h"

static const char STAGE[] = "signature";

/* In the order of starg_signature_kind. */
static const signature_method *const methods[STARG_SIGNATURE_KINDS] = {
    [STARG_SIGNATURE_D2] = &signature_d2,
    [STARG_SIGNATURE_SHAPE_DNA] = &signature_shape_dna,
    [STARG_SIGNATURE_STAR] = &signature_star,
    [STARG_SIGNATURE_PAPER] = &signature_paper,
};

static const signature_method *method_of(starg_signature_kind kind) {
    return (size_t)kind < STARG_SIGNATURE_KINDS ? methods[kind] : NULL;
}

const signature_method *signature_method_of(starg_signature_kind kind) {
    return methods[kind];
}

const char *starg_signature_name(starg_signature_kind kind) {
    const signature_method *method = method_of(kind);
    return method != NULL ? method->name : NULL;
}

int starg_signature_version(starg_signature_kind kind) {
    const signature_method *method = method_of(kind);
    return method != NULL ? method->version : 0;
}

static starg_status fail_kind(starg_context *context, starg_signature_kind kind) {
    return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE, "there is no signature kind %d",
                      (int)kind);
}

/* Takes ownership of the numbers. */
static starg_status wrap(starg_context *context, starg_signature_kind kind, double *numbers,
                         size_t count, starg_signature **out) {
    starg_status status = STARG_OK;
    starg_signature *signature = NULL;
    STARG_NEW(context, STAGE, signature, 1);
    *signature = (starg_signature){
        .kind = kind, .version = methods[kind]->version, .count = count, .numbers = numbers};
    *out = signature;
done:
    if (status != STARG_OK)
        starg_release(context, numbers);
    return status;
}

bool starg_signature_needs_descriptor(starg_signature_kind kind) {
    const signature_method *method = method_of(kind);
    return method != NULL && method->derive != NULL;
}

starg_status starg_signature_of_descriptor(starg_context *context,
                                           const starg_descriptor *descriptor,
                                           starg_signature_kind kind, starg_signature **out) {
    double *numbers = NULL;
    size_t count = 0;
    *out = NULL;
    if (!starg_signature_needs_descriptor(kind))
        return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                          "signatures of kind %d are not made of descriptors but of models",
                          (int)kind);
    TRY(methods[kind]->derive(context, descriptor, &numbers, &count));
    if (methods[kind]->check(numbers, count))
        return wrap(context, kind, numbers, count, out);
    starg_release(context, numbers);
    return starg_fail(context, STARG_ERROR_FORMAT, STAGE,
                      "the lengths and volumes of the descriptor are out of all proportion to each "
                      "other; describe the model anew");
}

/* From the descriptor if the kind uses one. */
static starg_status create(starg_context *context, const starg_mesh *mesh,
                           const starg_descriptor *descriptor, starg_signature_kind kind,
                           starg_signature **out) {
    double *numbers = NULL;
    size_t count = 0;
    if (starg_signature_needs_descriptor(kind))
        return starg_signature_of_descriptor(context, descriptor, kind, out);
    starg_status status = methods[kind]->compute(context, mesh, &numbers, &count);
    return status == STARG_OK ? wrap(context, kind, numbers, count, out) : status;
}

starg_status starg_signature_create(starg_context *context, const starg_mesh *mesh,
                                    starg_signature_kind kind, starg_signature **out) {
    SCOPED_BY(starg_descriptor_drop) starg_descriptor *descriptor = NULL;
    *out = NULL;
    if (method_of(kind) == NULL)
        return fail_kind(context, kind);
    if (starg_signature_needs_descriptor(kind))
        TRY(starg_descriptor_create(context, mesh, NULL, &descriptor));
    return create(context, mesh, descriptor, kind, out);
}

starg_status starg_signature_create_all(starg_context *context, const starg_mesh *mesh,
                                        starg_signature *out[STARG_SIGNATURE_KINDS]) {
    starg_status status = STARG_OK;
    starg_descriptor *descriptor = NULL;
    for (int kind = 0; kind < STARG_SIGNATURE_KINDS; kind++)
        out[kind] = NULL;
    STARG_TRY(starg_descriptor_create(context, mesh, NULL, &descriptor));
    for (int kind = 0; kind < STARG_SIGNATURE_KINDS; kind++)
        STARG_TRY(create(context, mesh, descriptor, (starg_signature_kind)kind, &out[kind]));
done:
    starg_descriptor_free(context, descriptor);
    for (int kind = 0; kind < STARG_SIGNATURE_KINDS && status != STARG_OK; kind++) {
        starg_signature_free(context, out[kind]);
        out[kind] = NULL;
    }
    return status;
}

starg_status starg_signature_restore(starg_context *context, starg_signature_kind kind, int version,
                                     const double *numbers, size_t count, starg_signature **out) {
    const signature_method *method = method_of(kind);
    double *copy = NULL;
    *out = NULL;
    if (method == NULL)
        return fail_kind(context, kind);
    if (version != method->version)
        return starg_fail(context, STARG_ERROR_FORMAT, STAGE,
                          "a %s signature of version %d cannot be used, only version %d",
                          method->name, version, method->version);
    if (!method->check(numbers, count))
        return starg_fail(context, STARG_ERROR_FORMAT, STAGE,
                          "these %zu numbers are no %s signature", count, method->name);
    NEW(context, STAGE, copy, count);
    memcpy(copy, numbers, count * sizeof *copy);
    return wrap(context, kind, copy, count, out);
}

void starg_signature_free(starg_context *context, starg_signature *signature) {
    (void)context;
    if (signature == NULL)
        return;
    RELEASE(signature->numbers, signature);
}

/* ---- distances ---- */

static bool comparable(const starg_signature *a, const starg_signature *b) {
    const signature_method *method = method_of(a->kind);
    return method != NULL && a->kind == b->kind && a->version == method->version &&
           b->version == method->version;
}

static starg_status fail_comparison(starg_context *context) {
    return starg_fail(context, STARG_ERROR_ARGUMENT, STAGE,
                      "only signatures of the same kind and of its present version compare");
}

/* The norm of the difference of the weighted numbers. */
static double weighted_distance(const signature_method *method, const double *a, const double *b) {
    double from[SIGNATURE_MOST_WEIGHTED], to[SIGNATURE_MOST_WEIGHTED], sum = 0;
    method->weigh(a, from);
    method->weigh(b, to);
    for (size_t i = 0; i < method->count; i++) {
        double difference = from[i] - to[i];
        sum += method->euclidean ? difference * difference : fabs(difference);
    }
    return method->euclidean ? sqrt(sum) : sum;
}

static starg_status distance(starg_context *context, const starg_signature *a,
                             const starg_signature *b, double *out) {
    const signature_method *method = methods[a->kind];
    if (method->weigh == NULL)
        return method->compare(context, a->numbers, a->count, b->numbers, b->count, out);
    *out = weighted_distance(method, a->numbers, b->numbers);
    return STARG_OK;
}

starg_status starg_signature_distance(starg_context *context, const starg_signature *a,
                                      const starg_signature *b, double *out) {
    *out = 0;
    if (!comparable(a, b))
        return fail_comparison(context);
    return distance(context, a, b, out);
}

typedef struct table {
    starg_signature *const *signatures;
    size_t count;
    double *distances;
} table;

/* The part of a row right of the diagonal, and its mirror image. */
static starg_status fill_row(starg_context *context, void *shared, void *scratch, size_t row) {
    const table *t = shared;
    (void)scratch;
    t->distances[row * t->count + row] = 0;
    for (size_t i = row + 1; i < t->count; i++) {
        double d = 0;
        TRY(distance(context, t->signatures[row], t->signatures[i], &d));
        t->distances[row * t->count + i] = d;
        t->distances[i * t->count + row] = d;
    }
    return STARG_OK;
}

starg_status starg_signature_distances(starg_context *context, starg_signature *const *signatures,
                                       size_t count, double *distances) {
    table t = {.signatures = signatures, .count = count, .distances = distances};
    for (size_t i = 0; i < count; i++)
        if (!comparable(signatures[0], signatures[i]))
            return fail_comparison(context);
    const starg_parallel_loop loop = {
        .stage = STAGE, .count = count, .shared = &t, .item = fill_row};
    return starg_parallel_for(context, &loop);
}
