/* SPDX-License-Identifier: Apache-2.0 */
/* Exact predicates in three steps: a floating-point filter, 128-bit integers for short inputs
 * (lattice-like coordinates), multi-limb integers otherwise.
 *
 * Source: J. R. Shewchuk, Adaptive precision floating-point arithmetic and fast robust geometric
 * predicates, 1997: the formulas of the filters and their bounds (the "A" stages), widened by one
 * unit roundoff of the permanent. The slack absorbs underflow, which his analysis excludes, unless
 * the permanent is tiny: each filter states its threshold. Integers replace his expansions, which
 * overflow and underflow at the ends of the supported range.
 *
 * Cost: 5-10 ns when the filter decides, about 30 ns in 128 bits, 0.2-2 us in limbs. */
#include "geometry/predicates.h"

#include <math.h>

#include "core/compiler.h"
#include "geometry/exact.h"

static const double EPSILON = 0x1p-53; /* unit roundoff */

static int sign_of(double x) {
    return (x > 0) - (x < 0);
}

static int sign_of_wide(starg_int128 x) {
    return (x > 0) - (x < 0);
}

/* out = p - q, all in units of 2^scale */
static void exact_difference(exact out[3], const double p[3], const double q[3], int scale) {
    for (int k = 0; k < 3; k++) {
        exact x, y;
        exact_set(&x, p[k], scale);
        exact_set(&y, q[k], scale);
        exact_subtract(&out[k], &x, &y);
    }
}

static void gather(double *values, const double *const *points, int count) {
    for (int i = 0; i < count; i++)
        for (int k = 0; k < 3; k++)
            values[3 * i + k] = points[i][k];
}

static int orient3d_short(const double values[12], int scale) {
    starg_int128 m[3][3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            m[i][k] = exact_small(values[3 * i + k], scale) - exact_small(values[9 + k], scale);
    return sign_of_wide(m[0][2] * (m[1][0] * m[2][1] - m[2][0] * m[1][1]) +
                        m[1][2] * (m[2][0] * m[0][1] - m[0][0] * m[2][1]) +
                        m[2][2] * (m[0][0] * m[1][1] - m[1][0] * m[0][1]));
}

static bool same(const double a[3], const double b[3]) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* The common causes of a zero: a corner is an endpoint of the segment; axis-aligned walls. */
static bool plainly_coplanar(const double a[3], const double b[3], const double c[3],
                             const double d[3]) {
    for (int k = 0; k < 3; k++)
        if (a[k] == b[k] && b[k] == c[k] && c[k] == d[k])
            return true;
    return same(a, b) || same(a, c) || same(a, d) || same(b, c) || same(b, d) || same(c, d);
}

static __attribute__((noinline)) int orient3d_exact(const double a[3], const double b[3],
                                                    const double c[3], const double d[3]) {
    if (plainly_coplanar(a, b, c, d))
        return 0;
    double values[12];
    gather(values, (const double *const[]){a, b, c, d}, 4);
    int bits, scale = exact_scale(values, 12, &bits);
    if (bits <= 40) /* 3 x 41 bits and six terms: below 127 */
        return orient3d_short(values, scale);
    exact ad[3], bd[3], cd[3], determinant;
    exact_difference(ad, a, d, scale);
    exact_difference(bd, b, d, scale);
    exact_difference(cd, c, d, scale);
    exact_determinant(&determinant, ad, bd, cd);
    return determinant.sign;
}

int orient3d(const double a[3], const double b[3], const double c[3], const double d[3]) {
    double adx = a[0] - d[0], ady = a[1] - d[1], adz = a[2] - d[2];
    double bdx = b[0] - d[0], bdy = b[1] - d[1], bdz = b[2] - d[2];
    double cdx = c[0] - d[0], cdy = c[1] - d[1], cdz = c[2] - d[2];
    double bdxcdy = bdx * cdy, cdxbdy = cdx * bdy;
    double cdxady = cdx * ady, adxcdy = adx * cdy;
    double adxbdy = adx * bdy, bdxady = bdx * ady;
    double determinant =
        adz * (bdxcdy - cdxbdy) + bdz * (cdxady - adxcdy) + cdz * (adxbdy - bdxady);
    double permanent = (fabs(bdxcdy) + fabs(cdxbdy)) * fabs(adz) +
                       (fabs(cdxady) + fabs(adxcdy)) * fabs(bdz) +
                       (fabs(adxbdy) + fabs(bdxady)) * fabs(cdz);
    /* An underflow costs at most 2^-1074 x 2e100; above 1e-200 the slack covers more than six. */
    double bound = 8 * EPSILON * permanent;
    if (permanent > 1e-200 && fabs(determinant) > bound)
        return sign_of(determinant);
    return orient3d_exact(a, b, c, d);
}

static __attribute__((noinline)) int orient2d_exact(const double a[3], const double b[3],
                                                    const double c[3], int u, int v) {
    /* differences of doubles have exact signs, and axis-aligned edges a zero in each product */
    int left = sign_of(a[u] - c[u]) * sign_of(b[v] - c[v]);
    int right = sign_of(a[v] - c[v]) * sign_of(b[u] - c[u]);
    if (left != right || left == 0)
        return (left > right) - (left < right);
    const double values[6] = {a[u], a[v], b[u], b[v], c[u], c[v]};
    int bits, scale = exact_scale(values, 6, &bits);
    exact x[6], acu, acv, bcu, bcv, determinant;
    for (int i = 0; i < 6; i++)
        exact_set(&x[i], values[i], scale);
    exact_subtract(&acu, &x[0], &x[4]);
    exact_subtract(&acv, &x[1], &x[5]);
    exact_subtract(&bcu, &x[2], &x[4]);
    exact_subtract(&bcv, &x[3], &x[5]);
    exact_minor(&determinant, &acu, &bcv, &acv, &bcu);
    return determinant.sign;
}

int orient2d(const double a[3], const double b[3], const double c[3], int u, int v) {
    double left = (a[u] - c[u]) * (b[v] - c[v]);
    double right = (a[v] - c[v]) * (b[u] - c[u]);
    double determinant = left - right, permanent = fabs(left) + fabs(right);
    if (permanent > 1e-290 && fabs(determinant) > 4 * EPSILON * permanent)
        return sign_of(determinant);
    return orient2d_exact(a, b, c, u, v);
}

/* out = x^2 + y^2 + z^2 */
static void exact_square(exact *out, const exact v[3]) {
    exact square, sum, partial;
    exact_multiply(&sum, &v[0], &v[0]);
    exact_multiply(&square, &v[1], &v[1]);
    exact_add(&partial, &sum, &square);
    exact_multiply(&square, &v[2], &v[2]);
    exact_add(out, &partial, &square);
}

static __attribute__((noinline)) int insphere_exact(const double *const points[5]) {
    double values[15];
    gather(values, points, 5);
    int bits, scale = exact_scale(values, 15, &bits);
    exact v[4][3], sum = {0}, total, lift, volume, term;
    for (int i = 0; i < 4; i++)
        exact_difference(v[i], points[i], points[4], scale);
    /* expansion along the column of squares: rows keep their order, signs alternate */
    static const int rows[4][3] = {{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}};
    for (int i = 0; i < 4; i++) {
        exact_determinant(&volume, v[rows[i][0]], v[rows[i][1]], v[rows[i][2]]);
        exact_square(&lift, v[i]);
        exact_multiply(&term, &lift, &volume);
        if (i % 2 == 0)
            exact_subtract(&total, &sum, &term);
        else
            exact_add(&total, &sum, &term);
        sum = total;
    }
    return sum.sign;
}

int insphere(const double a[3], const double b[3], const double c[3], const double d[3],
             const double e[3]) {
    double aex = a[0] - e[0], aey = a[1] - e[1], aez = a[2] - e[2];
    double bex = b[0] - e[0], bey = b[1] - e[1], bez = b[2] - e[2];
    double cex = c[0] - e[0], cey = c[1] - e[1], cez = c[2] - e[2];
    double dex = d[0] - e[0], dey = d[1] - e[1], dez = d[2] - e[2];
    double aexbey = aex * bey, bexaey = bex * aey, bexcey = bex * cey, cexbey = cex * bey;
    double cexdey = cex * dey, dexcey = dex * cey, dexaey = dex * aey, aexdey = aex * dey;
    double aexcey = aex * cey, cexaey = cex * aey, bexdey = bex * dey, dexbey = dex * bey;
    double ab = aexbey - bexaey, bc = bexcey - cexbey, cd = cexdey - dexcey;
    double da = dexaey - aexdey, ac = aexcey - cexaey, bd = bexdey - dexbey;
    double abc = aez * bc - bez * ac + cez * ab, bcd = bez * cd - cez * bd + dez * bc;
    double cda = cez * da + dez * ac + aez * cd, dab = dez * ab + aez * bd + bez * da;
    double alift = aex * aex + aey * aey + aez * aez, blift = bex * bex + bey * bey + bez * bez;
    double clift = cex * cex + cey * cey + cez * cez, dlift = dex * dex + dey * dey + dez * dez;
    double determinant = (dlift * abc - clift * dab) + (blift * cda - alift * bcd);

    double xab = fabs(aexbey) + fabs(bexaey), xbc = fabs(bexcey) + fabs(cexbey);
    double xcd = fabs(cexdey) + fabs(dexcey), xda = fabs(dexaey) + fabs(aexdey);
    double xac = fabs(aexcey) + fabs(cexaey), xbd = fabs(bexdey) + fabs(dexbey);
    double za = fabs(aez), zb = fabs(bez), zc = fabs(cez), zd = fabs(dez);
    double permanent =
        (xcd * zb + xbd * zc + xbc * zd) * alift + (xda * zc + xac * zd + xcd * za) * blift +
        (xab * zd + xbd * za + xda * zb) * clift + (xbc * za + xac * zb + xab * zc) * dlift;
    /* An underflow costs 2^-1074 times at most the cube of the largest difference. */
    double largest = alift + blift + clift + dlift;
    double tiny = 1e-290 * (1 + largest * sqrt(largest));
    if (permanent > tiny && fabs(determinant) > 17 * EPSILON * permanent)
        return sign_of(determinant);
    return insphere_exact((const double *const[]){a, b, c, d, e});
}

static __attribute__((noinline)) int compare_distance_exact(const double p[3], const double q[3],
                                                            double radius) {
    const double values[7] = {p[0], p[1], p[2], q[0], q[1], q[2], radius};
    int bits, scale = exact_scale(values, 7, &bits);
    exact difference[3], distance, r, square, result;
    exact_difference(difference, p, q, scale);
    exact_square(&distance, difference);
    exact_set(&r, radius, scale);
    exact_multiply(&square, &r, &r);
    exact_subtract(&result, &distance, &square);
    return result.sign;
}

int compare_distance(const double p[3], const double q[3], double radius) {
    double dx = p[0] - q[0], dy = p[1] - q[1], dz = p[2] - q[2];
    double distance = dx * dx + dy * dy + dz * dz, square = radius * radius;
    double difference = distance - square, permanent = distance + square;
    if (permanent > 1e-290 && fabs(difference) > 8 * EPSILON * permanent)
        return sign_of(difference);
    return compare_distance_exact(p, q, radius);
}

bool collinear(const double a[3], const double b[3], const double c[3]) {
    return orient2d(a, b, c, 0, 1) == 0 && orient2d(a, b, c, 1, 2) == 0 &&
           orient2d(a, b, c, 2, 0) == 0;
}

/* Sign of (u . v)^2 - cosine^2 |u|^2 |v|^2, each factor in units of its own: the cosine's unit is
 * made up for by a one. */
static __attribute__((noinline)) int compare_squares(const exact *dot, const exact u[3],
                                                     const exact v[3], double cosine) {
    const double cosines[2] = {cosine, 1};
    int bits, scale = exact_scale(cosines, 2, &bits);
    exact sum, term, one, c, left, right, length, product;
    exact_set(&one, 1, scale);
    exact_set(&c, cosine, scale);
    exact_multiply(&term, dot, &one);
    exact_multiply(&left, &term, &term);
    exact_square(&length, u);
    exact_square(&product, v);
    exact_multiply(&term, &length, &product);
    exact_multiply(&product, &c, &c);
    exact_multiply(&right, &term, &product);
    exact_subtract(&sum, &left, &right);
    return sum.sign;
}

static void exact_dot(exact *out, const exact u[3], const exact v[3]) {
    exact term, sum = {0};
    for (int k = 0; k < 3; k++) {
        exact_multiply(&term, &u[k], &v[k]);
        exact_add(out, &sum, &term);
        sum = *out;
    }
}

static bool exact_is_zero(const exact v[3]) {
    return v[0].sign == 0 && v[1].sign == 0 && v[2].sign == 0;
}

/* Sign of u . v - cosine |u| |v|. */
static int compare_angle(const exact u[3], const exact v[3], double cosine) {
    exact dot;
    exact_dot(&dot, u, v);
    int limit = exact_is_zero(u) || exact_is_zero(v) ? 0 : sign_of(cosine);
    if (dot.sign != limit)
        return dot.sign > limit ? 1 : -1;
    return limit == 0 ? 0 : limit * compare_squares(&dot, u, v, cosine);
}

static void exact_vector(exact out[3], const double d[3]) {
    int bits, scale = exact_scale(d, 3, &bits);
    for (int k = 0; k < 3; k++)
        exact_set(&out[k], d[k], scale);
}

static void exact_offset(exact out[3], const double p[3], const double q[3]) {
    const double points[6] = {p[0], p[1], p[2], q[0], q[1], q[2]};
    int bits, scale = exact_scale(points, 6, &bits);
    exact_difference(out, q, p, scale);
}

static __attribute__((noinline)) int compare_cone_exact(const double p[3], const double d[3],
                                                        double cosine, const double q[3]) {
    exact v[3], axis[3];
    exact_offset(v, p, q);
    exact_vector(axis, d);
    return compare_angle(v, axis, cosine);
}

int compare_cone(const double p[3], const double d[3], double cosine, const double q[3]) {
    double x = q[0] - p[0], y = q[1] - p[1], z = q[2] - p[2];
    double far = sqrt(x * x + y * y + z * z);
    double axis = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    double difference = x * d[0] + y * d[1] + z * d[2] - cosine * far * axis;
    if (far > 1e-140 && axis > 1e-140 && fabs(difference) > 24 * EPSILON * far * axis)
        return sign_of(difference);
    return compare_cone_exact(p, d, cosine, q);
}

static __attribute__((noinline)) int compare_plane_exact(const double p[3], const double n[3],
                                                         const double q[3]) {
    exact v[3], normal[3], dot;
    exact_offset(v, p, q);
    exact_vector(normal, n);
    exact_dot(&dot, v, normal);
    return dot.sign;
}

int compare_plane(const double p[3], const double n[3], const double q[3]) {
    double x = (q[0] - p[0]) * n[0], y = (q[1] - p[1]) * n[1], z = (q[2] - p[2]) * n[2];
    double sum = x + y + z, permanent = fabs(x) + fabs(y) + fabs(z);
    if (permanent > 1e-290 && fabs(sum) > 8 * EPSILON * permanent)
        return sign_of(sum);
    return compare_plane_exact(p, n, q);
}

static double length_of(const double v[3]) {
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static double dot_of(const double u[3], const double v[3]) {
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

static void difference_of(double out[3], const double p[3], const double q[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = p[k] - q[k];
}

/* The normal has degree two, so that its square times that of the line has six. */
static __attribute__((noinline)) int compare_incidence_exact(const double *const t[3],
                                                             const double p[3], const double q[3],
                                                             double cosine) {
    double values[9];
    gather(values, t, 3);
    int bits, scale = exact_scale(values, 9, &bits);
    exact e[2][3], normal[3], line[3];
    exact_difference(e[0], t[2], t[0], scale);
    exact_difference(e[1], t[1], t[0], scale);
    for (int k = 0; k < 3; k++)
        exact_minor(&normal[k], &e[0][(k + 1) % 3], &e[1][(k + 2) % 3], &e[0][(k + 2) % 3],
                    &e[1][(k + 1) % 3]);
    exact_offset(line, q, p);
    return compare_angle(normal, line, cosine);
}

/* The filter: differences come with a rounding each; the normal is off by 4 roundings of the
 * product of the sides' lengths, both products with the line by a few more. */
int compare_incidence(const double a[3], const double b[3], const double c[3], const double p[3],
                      const double q[3], double cosine) {
    if (orient3d(a, b, c, p) <= 0)
        return -1;
    double u[3], v[3], line[3];
    difference_of(u, c, a);
    difference_of(v, b, a);
    difference_of(line, p, q);
    const double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                         u[0] * v[1] - u[1] * v[0]};
    double far = length_of(line), first = length_of(u), second = length_of(v);
    double excess = dot_of(n, line) - cosine * length_of(n) * far;
    double least = fmin(far, fmin(first, second)), most = fmax(far, fmax(first, second));
    if (least > 1e-60 && most < 1e60 && /* squares of the normal neither vanish nor overflow */
        fabs(excess) > 64 * EPSILON * first * second * far)
        return sign_of(excess);
    return compare_incidence_exact((const double *const[]){a, b, c}, p, q, cosine);
}

/* out = 3 p - a - b - c */
static void exact_from_centroid(exact out[3], const double *const t[3], const double p[3],
                                int scale) {
    exact from[3], sum;
    exact_difference(out, p, t[0], scale);
    for (int i = 1; i < 3; i++) {
        exact_difference(from, p, t[i], scale);
        for (int k = 0; k < 3; k++) {
            exact_add(&sum, &out[k], &from[k]);
            out[k] = sum;
        }
    }
}

static __attribute__((noinline)) int compare_parallax_exact(const double *const t[3],
                                                            const double p[3], const double q[3],
                                                            double cosine) {
    const double *const points[5] = {t[0], t[1], t[2], p, q};
    double values[15];
    gather(values, points, 5);
    int bits, scale = exact_scale(values, 15, &bits);
    exact u[3], v[3];
    exact_from_centroid(u, t, p, scale);
    exact_from_centroid(v, t, q, scale);
    return compare_angle(u, v, cosine);
}

/* The filter: a component of 3 p - a - b - c is off by at most 6 roundings of the largest
 * coordinate times three. */
int compare_parallax(const double a[3], const double b[3], const double c[3], const double p[3],
                     const double q[3], double cosine) {
    double u[3], v[3], size = 0;
    for (int k = 0; k < 3; k++) {
        double sum = a[k] + b[k] + c[k];
        u[k] = 3 * p[k] - sum;
        v[k] = 3 * q[k] - sum;
        size = fmax(size, fabs(a[k]) + fabs(b[k]) + fabs(c[k]) + 3 * fabs(p[k]) + 3 * fabs(q[k]));
    }
    double first = length_of(u), second = length_of(v);
    double excess = dot_of(u, v) - cosine * first * second;
    double doubt = 64 * EPSILON * (size * (first + second) + first * second);
    if (first > 1e-100 && second > 1e-100 && fabs(excess) > doubt)
        return sign_of(excess);
    return compare_parallax_exact((const double *const[]){a, b, c}, p, q, cosine);
}
