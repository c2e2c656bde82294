/* SPDX-License-Identifier: Apache-2.0 */
/* The ratio of the largest to the smallest singular value: the largest is the root of the largest
 * eigenvalue of the matrix times its transpose, and the smallest that of the inverse map. Matrices
 * of flat tetrahedra are quotients of exact sums: rounding may leave nothing of their determinants,
 * nor of their products. */
#include "verify/pieces.h"

#include <math.h>

static const double TOLERANCE = 1e-6;
static const double ROUNDING = 4e-15; /* of a determinant, over the product of its rows' lengths */
static const double FLAT = 1e-9;      /* of the same: below it sums are exact */
static const double HIGH = 10;

typedef double matrix[3][3];

typedef struct simplex {
    const double *const *corners;
    int scale;
    matrix edges; /* from the last corner */
    double determinant;
    double flatness; /* the determinant over the product of the edges' lengths */
} simplex;

static double determinant(matrix m) {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

static void make_simplex(const double *const corners[4], int scale, simplex *out) {
    double lengths = 1;
    out->corners = corners;
    out->scale = scale;
    for (int i = 0; i < 3; i++) {
        double square = 0;
        for (int k = 0; k < 3; k++) {
            out->edges[i][k] = ldexp(corners[i][k] - corners[3][k], scale);
            square += out->edges[i][k] * out->edges[i][k];
        }
        lengths *= sqrt(square);
    }
    out->determinant = determinant(out->edges);
    out->flatness = fabs(out->determinant) / lengths;
}

static bool is_flat(const simplex *s) {
    return !(s->flatness > FLAT);
}

/* How far rounding in doubles may move a value, as a share of it, that is divided by the
 * determinant. */
static double rounding_of(const simplex *s) {
    return ROUNDING / s->flatness;
}

/* ---- matrices ---- */

/* An entry of the transposed cofactors of the edges times a factor: row `axis`, column j. */
static void add_cofactor(exact_sum *sum, const simplex *s, int axis, int j, double factor) {
    const double *rows[3] = {s->corners[(j + 1) % 3], s->corners[(j + 2) % 3], s->corners[3]};
    int a = (axis + 1) % 3, b = (axis + 2) % 3;
    for (int i = 0; i < 3; i++) {
        const double *x = rows[i], *y = rows[(i + 1) % 3];
        exact_sum_add(sum, x[a], y[b], factor);
        exact_sum_add(sum, -x[b], y[a], factor);
    }
}

/* Row `axis` of the transposed cofactors times a column of the edges of a simplex. */
static double exact_product(const simplex *from, const simplex *to, int axis, int column) {
    exact_sum sum;
    exact_sum_clear(&sum);
    for (int j = 0; j < 3; j++) {
        add_cofactor(&sum, from, axis, j, to->corners[j][column]);
        add_cofactor(&sum, from, axis, j, -to->corners[3][column]);
    }
    return exact_sum_value(&sum, 2 * from->scale + to->scale);
}

/* The same in doubles. */
static double product(const simplex *from, const simplex *to, int axis, int column) {
    const double(*e)[3] = from->edges;
    int a = (axis + 1) % 3, b = (axis + 2) % 3;
    double sum = 0;
    for (int j = 0; j < 3; j++) {
        int p = (j + 1) % 3, q = (j + 2) % 3;
        sum += (e[p][a] * e[q][b] - e[p][b] * e[q][a]) * to->edges[j][column];
    }
    return sum;
}

/* The map that takes the edges of `from` to those of `to` [Cramer]; returns the determinant of
 * `from`. */
static double map_of(const simplex *from, const simplex *to, bool exact, matrix out) {
    double all = exact ? exact_product(from, from, 0, 0) : from->determinant;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            out[i][k] = (exact ? exact_product(from, to, i, k) : product(from, to, i, k)) / all;
    return all;
}

/* The square of the norm of a matrix, by the largest root of the characteristic polynomial. */
static double squared_norm(matrix map) {
    matrix s;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            s[i][k] = map[i][0] * map[k][0] + map[i][1] * map[k][1] + map[i][2] * map[k][2];
    double mean = (s[0][0] + s[1][1] + s[2][2]) / 3, spread = 0;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            spread += (s[i][k] - (i == k ? mean : 0)) * (s[i][k] - (i == k ? mean : 0));
    spread = sqrt(spread / 6);
    if (!(spread > 0))
        return mean;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            s[i][k] = (s[i][k] - (i == k ? mean : 0)) / spread;
    double angle = acos(fmin(fmax(determinant(s) / 2, -1), 1)) / 3;
    return mean + 2 * spread * cos(angle);
}

void verify_add_distortion(verify_distortion *own, const double *const from[4], int from_scale,
                           const double *const to[4], int to_scale) {
    simplex a, b;
    matrix map, inverse;
    make_simplex(from, from_scale, &a);
    make_simplex(to, to_scale, &b);
    bool exact = is_flat(&a) || is_flat(&b);
    double volume = fabs(map_of(&a, &b, exact, map));
    map_of(&b, &a, exact, inverse);
    double ratio = sqrt(squared_norm(map)) * sqrt(squared_norm(inverse));
    double room = ratio * (rounding_of(&a) + rounding_of(&b));
    own->worst = fmax(own->worst, ratio);
    own->sum += volume * ratio;
    own->above += ratio > HIGH ? volume : 0;
    own->all += volume;
    own->worst_room = fmax(own->worst_room, room);
    own->sum_room += volume * room;
    own->above_room += fabs(ratio - HIGH) <= room ? volume : 0;
}

int verify_near_distortion(double claimed, double found, double room) {
    return fabs(claimed - found) <= TOLERANCE * (1 + found) + room;
}
