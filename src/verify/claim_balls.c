/* SPDX-License-Identifier: Apache-2.0 */
/* The claim that each piece is mapped to a ball: the guard to the origin, every other vertex to one
 * point at a distance of 1, and each tetrahedron to a positive one. The boundary of a piece that is
 * star-shaped (verify/claim_stars.c) is a sphere; one whose triangles are all positive, seen from
 * the origin, covers the sphere of directions once.
 *
 * The distortion is found again: the largest singular value of a map is the root of the largest
 * eigenvalue of its matrix times its transpose, and the smallest that of the inverse map. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "core/memory.h"
#include "verify/context.h"
#include "verify/signs.h"

static const char STAGE[] = "verify";
static const double TOLERANCE = 1e-6; /* of distortions */
static const double ROUNDING = 1e-12; /* of distances from the origin */
static const double HIGH = 10;

/* A corner of a tetrahedron, for sorting by piece and vertex. */
typedef struct image {
    int32_t piece;
    uint32_t vertex, corner; /* corner: 4 x tetrahedron + number */
} image;

static int compare_images(const void *left, const void *right) {
    const image *a = left, *b = right;
    if (a->piece != b->piece)
        return a->piece < b->piece ? -1 : 1;
    if (a->vertex != b->vertex)
        return a->vertex < b->vertex ? -1 : 1;
    return (a->corner > b->corner) - (a->corner < b->corner);
}

static bool equal(const double a[3], const double b[3]) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* ---- images ---- */

/* The fourth corner of a positive tetrahedron is behind the face of the others, seen from there. */
static bool is_turned(const double *corners) {
    for (int i = 0; i < 12; i++)
        if (!(fabs(corners[i]) < 2))
            return true;
    return verify_side(corners + 3, corners, corners + 6, corners + 9) != 1;
}

static bool is_placed(const verify_context *own, const image *i) {
    static const double origin[3];
    const double *at = own->mesh->corners + 3 * (size_t)i->corner;
    if (equal(verify_point(own->mesh, i->vertex), own->report->pieces[i->piece].guard))
        return equal(at, origin);
    return fabs(sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]) - 1) <= ROUNDING;
}

static void claim_corners(const verify_context *own, const image *images) {
    size_t count = 4 * own->mesh->count, wrong = 0, first = 0, split = 0;
    for (size_t i = count; i-- > 0;) {
        const image *it = &images[i];
        if (!is_placed(own, it)) {
            wrong++;
            first = it->corner / 4;
        }
        split += i > 0 && it[-1].piece == it->piece && it[-1].vertex == it->vertex &&
                 !equal(own->mesh->corners + 3 * (size_t)it->corner,
                        own->mesh->corners + 3 * (size_t)it[-1].corner);
    }
    if (wrong > 0)
        verify_claim(own->verdict, false,
                     "guards are mapped to the centres of balls and other vertices to their "
                     "spheres: %zu corners are not, one is of tetrahedron %zu",
                     wrong, first);
    else
        verify_claim(own->verdict, true,
                     "guards are mapped to the centres of balls and other vertices to their "
                     "spheres");
    verify_claim(own->verdict, split == 0,
                 "each vertex of a piece has one image in its ball (several: %zu)", split);
}

static void claim_positive(const verify_context *own) {
    size_t turned = 0, first = 0;
    for (size_t t = own->mesh->count; t-- > 0;)
        if (is_turned(own->mesh->corners + 12 * t)) {
            turned++;
            first = t;
        }
    if (turned > 0)
        verify_claim(own->verdict, false,
                     "all %zu tetrahedra have positive images: %zu have not, one is %zu",
                     own->mesh->count, turned, first);
    else
        verify_claim(own->verdict, true, "all %zu tetrahedra have positive images (exact signs)",
                     own->mesh->count);
}

/* ---- distortion ---- */

typedef double matrix[3][3];

/* The edges of a tetrahedron from its last corner, in units of 2^scale. */
static void edges(const double *const corners[4], int scale, matrix out) {
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            out[i][k] = ldexp(corners[i][k] - corners[3][k], -scale);
}

static double determinant(matrix m) {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
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

/* Rounding grows with the ratio, as tetrahedra get flatter. */
static bool is_near(double claimed, double found) {
    return fabs(claimed - found) <= (TOLERANCE + 1e-14 * found) * (1 + found);
}

static void claim_distortion(const verify_context *own) {
    const starg_pieces_mesh *mesh = own->mesh;
    double worst = 0, sum = 0, above = 0, all = 0;
    for (size_t t = 0; t < mesh->count; t++) {
        const double *corners[4], *images[4];
        matrix from, to;
        for (size_t k = 0; k < 4; k++) {
            corners[k] = verify_point(mesh, mesh->tetrahedra[4 * t + k]);
            images[k] = mesh->corners + 12 * t + 3 * k;
        }
        edges(corners, own->pieces->scale, from);
        edges(images, 0, to);
        double ratio = sqrt(squared_norm(from, to)) * sqrt(squared_norm(to, from));
        double volume = fabs(determinant(from));
        worst = fmax(worst, ratio);
        sum += volume * ratio;
        above += ratio > HIGH ? volume : 0;
        all += volume;
    }
    const starg_pieces_report *r = own->report;
    verify_claim(own->verdict, is_near(r->ball_worst, worst),
                 "maps to balls stretch by a ratio of %.9g at most (found: %.9g)", r->ball_worst,
                 worst);
    verify_claim(own->verdict, is_near(r->ball_mean, sum / all),
                 "their mean ratio is %.9g (found: %.9g)", r->ball_mean, sum / all);
    verify_claim(own->verdict, is_near(r->ball_above_10, above / all),
                 "a share of %.9g of the volume has a ratio above 10 (found: %.9g)",
                 r->ball_above_10, above / all);
}

/* ---- all of it ---- */

starg_status verify_claim_balls(const verify_context *own) {
    starg_status status = STARG_OK;
    image *images = NULL;
    size_t count = 4 * own->mesh->count;
    if (own->report->balls != (own->mesh->corners != NULL))
        verify_claim(own->verdict, false,
                     "the report and the tetrahedra agree on whether there are maps to balls");
    if (own->mesh->corners == NULL || !own->pieces->labels.good)
        return STARG_OK;
    STARG_NEW(own->context, STAGE, images, count);
    for (size_t i = 0; i < count; i++)
        images[i] = (image){own->mesh->labels[i / 4], own->mesh->tetrahedra[i], (uint32_t)i};
    qsort(images, count, sizeof *images, compare_images);
    claim_corners(own, images);
    claim_positive(own);
    if (own->report->balls)
        claim_distortion(own);
done:
    starg_release(own->context, images);
    return status;
}
