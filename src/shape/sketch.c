/* SPDX-License-Identifier: Apache-2.0 */
/* Sketches of signatures, for filtering [FRM94].
 *
 * Problem: a query has to read every signature of a database, thousands of bytes each, although
 * only the nearest few matter.
 *
 * The distances are norms of a weighted difference, L1 or L2. A sketch is the sums of runs of
 * neighbouring weighted numbers: by the triangle inequality the difference of two sums is at most
 * the L1 norm of the difference of their runs; by Cauchy's, divided by the root of their length, at
 * most the L2 norm. Neighbours in a signature are alike (eigenvalues, quantiles, bins), so little
 * is lost.
 *
 * Invariants: the bound is at most the computed distance. The sums are rounded to floats, by less
 * than 2^-23 of the sum of all absolute values, which is the last number of a sketch; the bound is
 * lowered by that of both. Signatures too large or too small for floats get an infinite last
 * number, hence the bound 0.
 *
 * Cost: linear.
 *
 * [FRM94] Faloutsos, Ranganathan, Manolopoulos: Fast subsequence matching in time-series databases,
 * SIGMOD 1994. */
#include "shape/signature_kinds.h"

#include <math.h>
#include <string.h>

/* Sums of absolute values for which floats neither overflow nor lose more than their precision. */
static const double SMALLEST = 1e-30, LARGEST = 1e30;
static const double SLACK = 0x1p-23;  /* of the sums */
static const double ROUNDING = 1e-12; /* of a distance, relative */

size_t sketch_count(starg_signature_kind kind) {
    const signature_method *method = signature_method_of(kind);
    return method->weigh != NULL ? (method->count + method->run - 1) / method->run + 1 : 0;
}

void sketch_make(starg_signature_kind kind, const double *numbers, size_t count, sketch *out) {
    const signature_method *method = signature_method_of(kind);
    double weighted[SIGNATURE_MOST_WEIGHTED], size = 0;
    *out = (sketch){.count = sketch_count(kind)};
    if (out->count == 0)
        return;
    method->weigh(numbers, weighted);
    for (size_t i = 0; i < count; i++)
        size += fabs(weighted[i]);
    bool fits = size > SMALLEST && size < LARGEST;
    out->numbers[out->count - 1] = fits ? nextafterf((float)size, INFINITY) : INFINITY;
    for (size_t i = 0; i < count && fits; i += method->run) {
        size_t end = i + method->run < count ? i + method->run : count;
        double sum = 0;
        for (size_t k = i; k < end; k++)
            sum += weighted[k];
        out->numbers[i / method->run] =
            (float)(method->euclidean ? sum / sqrt((double)(end - i)) : sum);
    }
}

double sketch_bound(starg_signature_kind kind, const sketch *a, const sketch *b) {
    bool euclidean = signature_method_of(kind)->euclidean;
    size_t last = a->count - 1;
    double sum = 0;
    for (size_t i = 0; i < last; i++) {
        double difference = (double)a->numbers[i] - (double)b->numbers[i];
        sum += euclidean ? difference * difference : fabs(difference);
    }
    double slack = SLACK * ((double)a->numbers[last] + (double)b->numbers[last]);
    return fmax(0, ((euclidean ? sqrt(sum) : sum) - slack) * (1 - ROUNDING));
}

void sketch_store(const sketch *from, uint8_t bytes[SKETCH_MOST_BYTES]) {
    for (size_t i = 0; i < from->count; i++) {
        uint32_t bits;
        memcpy(&bits, &from->numbers[i], sizeof bits);
        for (size_t k = 0; k < 4; k++)
            bytes[4 * i + k] = (uint8_t)(bits >> (8 * k));
    }
}

void sketch_load(const uint8_t *bytes, size_t count, sketch *out) {
    out->count = count;
    for (size_t i = 0; i < count; i++, bytes += 4) {
        uint32_t bits = (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 |
                        (uint32_t)bytes[3] << 24;
        memcpy(&out->numbers[i], &bits, sizeof bits);
    }
}
