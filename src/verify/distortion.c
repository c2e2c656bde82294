/* SPDX-License-Identifier: Apache-2.0 */
/* The ratio of the largest to the smallest singular value: the largest is the root of the largest
 * eigenvalue of the matrix times its transpose, and the smallest that of the inverse map. */
#include "verify/distortion.h"

#include <math.h>

static const double TOLERANCE = 1e-6;
static const double ROUNDING = 4e-15; /* of a determinant, over the product of its rows' lengths */
static const double HIGH = 10;

typedef double matrix[3][3];

/* The edges of a tetrahedron from its last corner. */
static void edges(const double *const corners[4], int scale, matrix out) {
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            out[i][k] = ldexp(corners[i][k] - corners[3][k], scale);
}

static double determinant(matrix m) {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

/* How far rounding may move a value, as a share of it, that is divided by the determinant. */
static double rounding_of(matrix m) {
    double lengths = 1;
    for (int i = 0; i < 3; i++)
        lengths *= sqrt(m[i][0] * m[i][0] + m[i][1] * m[i][1] + m[i][2] * m[i][2]);
    return ROUNDING * lengths / fabs(determinant(m));
}

/* The square of the norm of the map that takes the rows of `from` to those of `to`, by the largest
 * root of the characteristic polynomial. */
static double squared_norm(matrix from, matrix to) {
    matrix map, s;
    double d = determinant(from);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            map[i][k] = 0;
            for (int j = 0; j < 3; j++) {
                int a = (i + 1) % 3, b = (i + 2) % 3, p = (j + 1) % 3, q = (j + 2) % 3;
                map[i][k] += (from[p][a] * from[q][b] - from[p][b] * from[q][a]) / d * to[j][k];
            }
        }
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
    matrix a, b;
    edges(from, from_scale, a);
    edges(to, to_scale, b);
    double ratio = sqrt(squared_norm(a, b)) * sqrt(squared_norm(b, a));
    double room = ratio * (rounding_of(a) + rounding_of(b));
    double volume = fabs(determinant(a));
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
