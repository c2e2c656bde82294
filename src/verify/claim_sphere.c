/* SPDX-License-Identifier: Apache-2.0 */
/* A map by way of the sphere is a bijection, and its points are where it takes them.
 *
 * Let every face be a positive triangle of directions, det(a, b, c) > 0, and let every edge have
 * two faces that run along it in opposite directions. Then as many triangles cover a direction as
 * cover those across an edge: all directions but finitely many are covered equally often. If one is
 * covered once, all are, and the surface is mapped to the sphere one to one. So are both surfaces,
 * and points in the same direction correspond.
 *
 * Signs are exact. Weights of a point in its face are compared with those of its direction within
 * 1e-6. */
#include <math.h>

#include "verify/map.h"

static const char STAGE[] = "verify";
static const double TOLERANCE = 1e-6;
static const double ORIGIN[3];
enum { CANCEL_STEP = 1024 };

static void directions_of(const verify_map *own, int s, size_t face, const double *d[3]) {
    for (size_t k = 0; k < 3; k++)
        d[k] = own->file->directions[s] + 3 * (size_t)own->surface[s]->faces[3 * face + k];
}

/* The sign of det(p, q, x). */
static int turn(const double *p, const double *q, const double *x) {
    return verify_side(p, q, x, ORIGIN);
}

/* 1 if x is strictly in the cone of a face, 0 if on its boundary, -1 outside. */
static int in_cone(const double *const d[3], const double *x) {
    int least = 1;
    for (int k = 0; k < 3; k++) {
        int sign = turn(d[k], d[(k + 1) % 3], x);
        least = sign < least ? sign : least;
    }
    return least;
}

static void claim_positive(const verify_map *own, int s) {
    size_t folded = 0, first = 0, count = own->surface[s]->face_count;
    for (size_t f = count; f-- > 0;) {
        const double *d[3];
        directions_of(own, s, f, d);
        if (turn(d[0], d[1], d[2]) <= 0) {
            folded++;
            first = f;
        }
    }
    verify_claim_all(own->verdict, folded, first,
                     "all faces of %c are positive on the sphere: none folds (exact signs)",
                     'A' + s);
}

/* How many faces cover the middle of one? Negative: it is on the boundary of some. */
static int count_cover(const verify_map *own, int s, size_t middle) {
    const double *d[3];
    double x[3];
    int count = 0;
    directions_of(own, s, middle, d);
    for (int k = 0; k < 3; k++)
        x[k] = d[0][k] + d[1][k] + d[2][k];
    for (size_t f = 0; f < own->surface[s]->face_count; f++) {
        directions_of(own, s, f, d);
        int found = in_cone(d, x);
        if (found == 0)
            return -1;
        count += found > 0;
    }
    return count;
}

static void claim_once(const verify_map *own, int s) {
    int count = -1;
    for (size_t f = 0; f < own->surface[s]->face_count && count < 0; f++)
        count = count_cover(own, s, f);
    verify_claim(own->verdict, count == 1,
                 "the faces of %c cover the sphere once (found: %d times)", 'A' + s, count);
}

/* Is the point of vertex v in the face that its direction is in? */
static bool is_located(const verify_map *own, size_t v) {
    const double *d[3], *x = own->file->directions[0] + 3 * v;
    directions_of(own, 1, own->file->points.faces[v], d);
    return in_cone(d, x) >= 0;
}

/* The difference between a point's weights and those of its direction. */
static double deviation_of(const verify_map *own, size_t v) {
    const double *d[3], *x = own->file->directions[0] + 3 * v;
    double w[3], found[3], sum = 0, most = 0;
    size_t face = own->file->points.faces[v];
    directions_of(own, 1, face, d);
    for (int k = 0; k < 3; k++) {
        const double *p = d[(k + 1) % 3], *q = d[(k + 2) % 3];
        found[k] = x[0] * (p[1] * q[2] - p[2] * q[1]) + x[1] * (p[2] * q[0] - p[0] * q[2]) +
                   x[2] * (p[0] * q[1] - p[1] * q[0]);
        sum += found[k];
    }
    verify_weights_in(own->mesh[1], &own->file->points, v, own->surface[1]->faces + 3 * face, w);
    for (int k = 0; k < 3; k++)
        most = fmax(most, fabs(found[k] / sum - w[k]));
    return isfinite(most) ? most : 1;
}

static starg_status claim_points(const verify_map *own) {
    size_t elsewhere = 0, first = 0, far = 0, first_far = 0;
    for (size_t v = own->file->point_count; v-- > 0;) {
        if (v % CANCEL_STEP == 0)
            TRY(starg_check_cancel(own->context, STAGE));
        if (!is_located(own, v)) {
            elsewhere++;
            first = v;
        } else if (deviation_of(own, v) > TOLERANCE) {
            far++;
            first_far = v;
        }
    }
    verify_claim_all(own->verdict, elsewhere, first,
                     "vertices of A go to the faces of B that their directions are in");
    if (own->file->overlay_faces == 0)
        verify_claim_all(own->verdict, far, first_far, "and to their places there, within 1e-6");
    return STARG_OK;
}

starg_status verify_claim_sphere(const verify_map *own) {
    for (int s = 0; s < 2; s++) {
        claim_positive(own, s);
        claim_once(own, s);
    }
    return claim_points(own);
}
