/* SPDX-License-Identifier: Apache-2.0 */
/* Slow, exact answers for tests: GMP rationals, and methods that share nothing with the library.
 * All work for all finite doubles. Triangles without area count as the segments or points that they
 * are. */
#ifndef TESTS_EXACT_ORACLE_H
#define TESTS_EXACT_ORACLE_H

#include <gmp.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The contracts of geometry/predicates.h. */
int oracle_orient3d(const double a[3], const double b[3], const double c[3], const double d[3]);
int oracle_orient2d(const double a[3], const double b[3], const double c[3], int u, int v);
int oracle_insphere(const double a[3], const double b[3], const double c[3], const double d[3],
                    const double e[3]);
int oracle_compare_distance(const double p[3], const double q[3], double radius);
int oracle_compare_cone(const double p[3], const double d[3], double cosine, const double q[3]);
int oracle_compare_plane(const double p[3], const double n[3], const double q[3]);
int oracle_compare_incidence(const double a[3], const double b[3], const double c[3],
                             const double p[3], const double q[3], double cosine);
int oracle_compare_parallax(const double a[3], const double b[3], const double c[3],
                            const double p[3], const double q[3], double cosine);
bool oracle_collinear(const double a[3], const double b[3], const double c[3]);

/* Is the tetrahedron of points that move straight positive at every time? */
bool oracle_stays_positive(const double *const from[4], const double *const to[4]);

/* The contracts of geometry/intersect.h. */
bool oracle_segment_meets_triangle(const double p[3], const double q[3], const double a[3],
                                   const double b[3], const double c[3]);
bool oracle_point_on_triangle(const double p[3], const double a[3], const double b[3],
                              const double c[3]);
bool oracle_segments_meet(const double a[3], const double b[3], const double c[3],
                          const double d[3]);

/* Do the closed triangles s and t, whose first `shared` corners are the same, have a common point
 * outside the simplex spanned by these corners? */
bool oracle_triangles_contact(const double *const s[3], const double *const t[3], int shared);

/* Does the closed triangle t have a point in the tetrahedron (p, face) off the face? */
bool oracle_tetrahedron_meets_triangle(const double p[3], const double *const face[3],
                                       const double *const t[3]);

/* A point between vertices: their sum with whole weights whose sum is 2^ORACLE_DEPTH, by that. */
enum { ORACLE_DEPTH = 28 };

typedef struct oracle_mix {
    const double *corner[3];
    int64_t weight[3];
} oracle_mix;

void oracle_mix_coordinate(const oracle_mix *mix, int k, mpq_ptr out);

/* Does [p, q), where q is not p, meet the closed triangle t? */
bool oracle_mix_hidden(const double p[3], const oracle_mix *q, const double *const t[3]);

/* Does t have a point in the tetrahedron of p and the part off the part? */
bool oracle_mixes_entered(const double p[3], const oracle_mix part[3], const double *const t[3]);

/* Do the open half-spaces of the points x with orient3d(a, b, c, x) = 1 have a common point (in the
 * closed box, unless lower is NULL)? `corners` are 3 per half-space. */
bool oracle_half_spaces_meet(const double *const *corners, int count, const double lower[3],
                             const double upper[3]);

/* Winding number of a closed mesh about p; *on_surface: p lies on a triangle (the result is then 0
 * and meaningless). */
int oracle_winding(const double *vertices, const uint32_t *faces, size_t face_count,
                   const double p[3], bool *on_surface);

#endif
