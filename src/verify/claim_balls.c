/* SPDX-License-Identifier: Apache-2.0 */
/* The claim that each piece is mapped to a ball: the guard to the origin, every other vertex to one
 * point at a distance of 1, and each tetrahedron to a positive one. The boundary of a piece that is
 * star-shaped (verify/claim_stars.c) is a sphere; one whose triangles are all positive, seen from
 * the origin, covers the sphere of directions once. The distortion is found
 * again (verify/distortion.c). */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "verify/pieces.h"

static const char STAGE[] = "verify";
static const double ROUNDING = 1e-12; /* of distances from the origin */

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

static void claim_distortion(const verify_context *own) {
    const starg_pieces_mesh *mesh = own->mesh;
    verify_distortion found = {0};
    for (size_t t = 0; t < mesh->count; t++) {
        const double *corners[4], *images[4];
        for (size_t k = 0; k < 4; k++) {
            corners[k] = verify_point(mesh, mesh->tetrahedra[4 * t + k]);
            images[k] = mesh->corners + 12 * t + 3 * k;
        }
        verify_add_distortion(&found, corners, own->pieces->scale, images, 0);
    }
    const starg_pieces_report *r = own->report;
    verify_claim(own->verdict, verify_near_distortion(r->ball_worst, found.worst, found.worst_room),
                 "maps to balls stretch by a ratio of %.9g at most (found: %.9g)", r->ball_worst,
                 found.worst);
    verify_claim(
        own->verdict,
        verify_near_distortion(r->ball_mean, found.sum / found.all, found.sum_room / found.all),
        "their mean ratio is %.9g (found: %.9g)", r->ball_mean, found.sum / found.all);
    verify_claim(own->verdict,
                 verify_near_distortion(r->ball_above_10, found.above / found.all,
                                        found.above_room / found.all),
                 "a share of %.9g of the volume has a ratio above 10 (found: %.9g)",
                 r->ball_above_10, found.above / found.all);
}

/* ---- all of it ---- */

starg_status verify_claim_balls(const verify_context *own) {
    SCOPED image *images = NULL;
    size_t count = 4 * own->mesh->count;
    if (own->report->balls != (own->mesh->corners != NULL))
        verify_claim(own->verdict, false,
                     "the report and the tetrahedra agree on whether there are maps to balls");
    if (own->mesh->corners == NULL || !own->pieces->labels.good)
        return STARG_OK;
    NEW(own->context, STAGE, images, count);
    for (size_t i = 0; i < count; i++)
        images[i] = (image){own->mesh->labels[i / 4], own->mesh->tetrahedra[i], (uint32_t)i};
    qsort(images, count, sizeof *images, compare_images);
    claim_corners(own, images);
    claim_positive(own);
    if (own->report->balls)
        claim_distortion(own);
    return STARG_OK;
}
