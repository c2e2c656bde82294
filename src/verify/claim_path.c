/* SPDX-License-Identifier: Apache-2.0 */
/* The claim that no tetrahedron of a morph is inverted at any time: between two keys every vertex
 * moves on a line, and the volume of a tetrahedron is a cubic polynomial in time.
 *
 * Its Bernstein coefficients, times 3, are sums of determinants of edges, some as they are at the
 * first key and some as at the second. Each is expanded in the coordinates and added up without
 * rounding (verify/signs.h). All four positive: so is the polynomial. If only the inner ones
 * are not, the interval is halved, by sums alone. Coefficients that are positive by far in doubles
 * are not computed exactly. Cost: O(n) for each key. */
#include <math.h>

#include "verify/pieces.h"

static const char STAGE[] = "verify";
static const double CLEAR = 1e-10; /* far above rounding, relative to the sum of magnitudes */

enum { HALVINGS = 16, CANCEL_STEP = 1 << 12 };

/* A tetrahedron at two times. */
typedef const double *corners_at[2][4];

/* By number of edges from the later time: which edges these are, in three terms. */
static const uint8_t LATER[4][3][3] = {{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}},
                                       {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                       {{0, 1, 1}, {1, 0, 1}, {1, 1, 0}},
                                       {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}};

static bool is_clear(corners_at c, const uint8_t terms[3][3]) {
    double sum = 0, size = 0;
    for (int term = 0; term < 3; term++) {
        double e[3][3];
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++)
                e[i][k] = c[terms[term][i]][i + 1][k] - c[terms[term][i]][0][k];
        for (int k = 0; k < 3; k++) {
            double p = e[0][k] * e[1][(k + 1) % 3] * e[2][(k + 2) % 3];
            double q = e[0][k] * e[1][(k + 2) % 3] * e[2][(k + 1) % 3];
            sum += p - q;
            size += fabs(p) + fabs(q);
        }
    }
    return size > 1e-200 && sum > CLEAR * size;
}

/* The determinant of edges p - q, by the choice of p or -q for each of the three. */
static void add_edges(exact_sum *sum, corners_at c, const uint8_t later[3]) {
    for (int choice = 0; choice < 8; choice++) {
        double row[3][3];
        for (int i = 0; i < 3; i++) {
            bool back = choice >> i & 1;
            const double *p = c[later[i]][back ? 0 : i + 1];
            for (int k = 0; k < 3; k++)
                row[i][k] = back ? -p[k] : p[k];
        }
        exact_sum_add_determinant(sum, row[0], row[1], row[2]);
    }
}

/* out = a + b */
static void add(const exact_sum *a, const exact_sum *b, exact_sum *out) {
    exact_sum sum = *a;
    exact_sum_add_sum(&sum, b);
    *out = sum;
}

/* The coefficients over both halves, times 8: each row of de Casteljau's scheme holds sums of two
 * neighbours of the row before, and what is kept of it is doubled as often as rows are missing. */
static void halve(const exact_sum c[4], exact_sum left[4], exact_sum right[4]) {
    exact_sum row[4];
    for (int i = 0; i < 4; i++)
        row[i] = c[i];
    for (int level = 0; level < 4; level++) {
        left[level] = row[0];
        right[3 - level] = row[3 - level];
        for (int times = level; times < 3; times++) {
            add(&left[level], &left[level], &left[level]);
            add(&right[3 - level], &right[3 - level], &right[3 - level]);
        }
        for (int i = 0; i < 3 - level; i++)
            add(&row[i], &row[i + 1], &row[i]);
    }
}

static bool is_positive(const exact_sum c[4], int halvings) {
    exact_sum left[4], right[4];
    if (exact_sum_sign(&c[0]) <= 0 || exact_sum_sign(&c[3]) <= 0)
        return false;
    if (exact_sum_sign(&c[1]) > 0 && exact_sum_sign(&c[2]) > 0)
        return true;
    if (halvings == 0)
        return false;
    halve(c, left, right);
    return is_positive(left, halvings - 1) && is_positive(right, halvings - 1);
}

static bool stays_positive(corners_at c) {
    exact_sum sums[4];
    bool clear = true;
    for (int later = 0; later < 4 && clear; later++)
        clear = is_clear(c, LATER[later]);
    if (clear)
        return true;
    for (int later = 0; later < 4; later++) {
        exact_sum_clear(&sums[later]);
        for (int term = 0; term < 3; term++)
            add_edges(&sums[later], c, LATER[later][term]);
    }
    return is_positive(sums, HALVINGS);
}

/* Places after so many keys: those of A, the keys, those of B. */
static const double *places_of(const starg_solid_map *map, size_t key) {
    if (key == 0)
        return map->vertices;
    return key <= map->key_count ? map->keys + 3 * (key - 1) * map->vertex_count : map->images;
}

starg_status verify_claim_path(starg_context *context, const starg_solid_map *map,
                               starg_verdict *verdict) {
    size_t bad = 0, first = 0, first_step = 0;
    if (map->key_count == 0)
        return STARG_OK;
    for (size_t step = 0; step <= map->key_count; step++)
        for (size_t t = 0; t < map->count; t++) {
            corners_at c;
            if (t % CANCEL_STEP == 0)
                TRY(starg_check_cancel(context, STAGE));
            for (size_t end = 0; end < 2; end++)
                for (size_t i = 0; i < 4; i++)
                    c[end][i] = places_of(map, step + end) + 3 * (size_t)map->tetrahedra[4 * t + i];
            if (!stays_positive(c) && bad++ == 0) {
                first = t;
                first_step = step;
            }
        }
    if (bad == 0)
        verify_claim(verdict, true,
                     "no tetrahedron is inverted at any time on the way from A to B (%zu keys, "
                     "exact signs of cubic polynomials)",
                     map->key_count);
    else
        verify_claim(verdict, false,
                     "no tetrahedron is inverted at any time on the way from A to B: %zu are, "
                     "first tetrahedron %zu between keys %zu and %zu",
                     bad, first, first_step, first_step + 1);
    return STARG_OK;
}
