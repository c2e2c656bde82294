/* SPDX-License-Identifier: Apache-2.0 */
/* The claims about dihedral angles: the smallest of each tetrahedron, by the parts of its edges
 * that are perpendicular to the edge between two faces; and which of the small ones are the
 * model's, because the tetrahedron is over a whole face of the model that has an angle as small.
 *
 * Numbers are rounded here and there, so they need to agree in six digits only, and to what is left
 * of them where faces are so thin that nothing is known of their normals. Cost: O(n log n) for
 * faces and the median. */
#include <math.h>
#include <stdlib.h>

#include "verify/pieces.h"

static const char STAGE[] = "verify";
static const double PI_DEGREES = 180, DOUBT = 1e-9;
static const double ROUNDING = 0x1p-28; /* of angles, times the least ones of two faces */

/* Two bounds of an angle, sorted each by itself where there are many. */
typedef struct span {
    double least, most;
} span;

static bool agrees(double claimed, span found) {
    return claimed >= found.least - (1e-8 + 1e-6 * found.least) &&
           claimed <= found.most + (1e-8 + 1e-6 * found.most);
}

/* ---- angles ---- */

static double degrees_between(const double u[3], const double v[3]) {
    double c[3], dot = 0;
    for (int k = 0; k < 3; k++) {
        c[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
        dot += u[k] * v[k];
    }
    return atan2(hypot(hypot(c[0], c[1]), c[2]), dot) * (PI_DEGREES / acos(-1));
}

/* From a to b, of length one; false if they are one point. */
static bool direction(const double a[3], const double b[3], double out[3]) {
    double most = 0;
    for (int k = 0; k < 3; k++)
        most = fmax(most, fabs(b[k] - a[k]));
    if (!(most > 0))
        return false;
    for (int k = 0; k < 3; k++)
        out[k] = (b[k] - a[k]) / most;
    double length = hypot(hypot(out[0], out[1]), out[2]);
    for (int k = 0; k < 3; k++)
        out[k] /= length;
    return true;
}

/* What of the direction from a to p is perpendicular to e. */
static void beside(const double a[3], const double p[3], const double e[3], double out[3]) {
    double d[3] = {0, 0, 0}, along = 0;
    direction(a, p, d);
    for (int k = 0; k < 3; k++)
        along += d[k] * e[k];
    for (int k = 0; k < 3; k++)
        out[k] = d[k] - along * e[k];
}

static double smallest_dihedral(const verify_context *own, size_t tetrahedron) {
    const double *p[4];
    double least = PI_DEGREES;
    for (int i = 0; i < 4; i++)
        p[i] = verify_point(own->mesh, own->mesh->tetrahedra[4 * tetrahedron + (size_t)i]);
    for (int i = 0; i < 4; i++)
        for (int j = i + 1; j < 4; j++) {
            double e[3], u[3], v[3];
            int c = 0;
            while (c == i || c == j)
                c++;
            if (!direction(p[i], p[j], e))
                return 0;
            beside(p[i], p[c], e, u);
            beside(p[i], p[6 - i - j - c], e, v);
            least = fmin(least, degrees_between(u, v));
        }
    return least;
}

static double smallest_corner(const double *const t[3]) {
    double least = PI_DEGREES;
    for (int i = 0; i < 3; i++) {
        double u[3], v[3];
        if (!direction(t[i], t[(i + 1) % 3], u) || !direction(t[i], t[(i + 2) % 3], v))
            return 0;
        least = fmin(least, degrees_between(u, v));
    }
    return least;
}

/* The normals of two faces are the less certain the smaller the least angle of either is. */
static double room_of(const verify_context *own, size_t tetrahedron) {
    double thinnest[2] = {PI_DEGREES, PI_DEGREES};
    for (uint32_t i = 0; i < 4; i++) {
        uint32_t side[3];
        const double *t[3];
        verify_facet_corners(own->mesh->tetrahedra, 4 * (uint32_t)tetrahedron + i, side);
        for (int k = 0; k < 3; k++)
            t[k] = verify_point(own->mesh, side[k]);
        double angle = smallest_corner(t);
        thinnest[1] = fmin(thinnest[1], fmax(angle, thinnest[0]));
        thinnest[0] = fmin(thinnest[0], angle);
    }
    return fmin(PI_DEGREES, ROUNDING / (thinnest[0] * thinnest[1]));
}

/* ---- faces of the model ---- */

/* The corners of a face in the order of their positions. */
typedef struct sorted_face {
    double corner[3][3];
} sorted_face;

static int compare(const void *x, const void *y) {
    const double *a = x, *b = y;
    for (int k = 0; k < 9; k++)
        if (a[k] != b[k])
            return a[k] < b[k] ? -1 : 1;
    return 0;
}

static bool is_after(const double a[3], const double b[3]) {
    return a[0] != b[0] ? a[0] > b[0] : a[1] != b[1] ? a[1] > b[1] : a[2] > b[2];
}

static sorted_face sort_corners(const double *t[3]) {
    static const int pairs[3][2] = {{0, 1}, {1, 2}, {0, 1}};
    sorted_face out;
    for (int i = 0; i < 3; i++) {
        const double **a = &t[pairs[i][0]], **b = &t[pairs[i][1]];
        if (is_after(*a, *b)) {
            const double *c = *a;
            *a = *b;
            *b = c;
        }
    }
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            out.corner[i][k] = t[i][k] == 0 ? 0 : t[i][k]; /* -0 is 0 */
    return out;
}

/* By tetrahedron: the smallest angle of a whole face of the model that it has; infinite without. */
static starg_status find_given(const verify_context *own, double *given) {
    const verify_surface *model = own->model, *outer = own->pieces->outer;
    SCOPED sorted_face *faces = NULL;
    NEW(own->context, STAGE, faces, model->face_count);
    for (size_t f = 0; f < model->face_count; f++) {
        const double *t[3];
        verify_corners(model, f, t);
        faces[f] = sort_corners(t);
    }
    qsort(faces, model->face_count, sizeof *faces, compare);
    for (size_t f = 0; f < outer->face_count; f++) {
        const double *t[3];
        size_t tetrahedron = own->pieces->outer_facets[f] / 4;
        verify_corners(outer, f, t);
        const sorted_face key = sort_corners(t);
        if (bsearch(&key, faces, model->face_count, sizeof key, compare) != NULL)
            given[tetrahedron] = fmin(given[tetrahedron], smallest_corner(t));
    }
    return STARG_OK;
}

/* ---- claims ---- */

/* Where an angle is hardly smaller than that of the face, it may be counted either way. */
static starg_status claim_made(const verify_context *own, const double *least, const double *most,
                               double *given) {
    double claimed = own->report->smallest_angle_made;
    span found = {PI_DEGREES, PI_DEGREES};
    for (size_t t = 0; t < own->mesh->count; t++)
        given[t] = INFINITY;
    TRY(find_given(own, given));
    for (size_t t = 0; t < own->mesh->count; t++) {
        if (most[t] < given[t] * (1 - DOUBT))
            found.most = fmin(found.most, most[t]);
        if (least[t] < given[t] * (1 + DOUBT))
            found.least = fmin(found.least, least[t]);
    }
    verify_claim(own->verdict, agrees(claimed, found),
                 "the smallest dihedral angle that faces of the model do not force is %.9g degrees "
                 "(found: %.9g)",
                 claimed, found.most);
    return STARG_OK;
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

starg_status verify_claim_angles(const verify_context *own) {
    const starg_pieces_report *report = own->report;
    SCOPED double *least = NULL, *most = NULL, *given = NULL;
    size_t count = own->mesh->count;
    if (!(report->smallest_angle > 0)) {
        verify_leave(own->verdict, "dihedral angles: the report does not tell them");
        return STARG_OK;
    }
    NEW(own->context, STAGE, least, count);
    NEW(own->context, STAGE, most, count);
    NEW(own->context, STAGE, given, count);
    for (size_t t = 0; t < count; t++) {
        double angle = smallest_dihedral(own, t), room = room_of(own, t);
        least[t] = fmax(angle - room, 0);
        most[t] = angle + room;
    }
    if (report->smallest_angle_made > 0)
        TRY(claim_made(own, least, most, given));
    qsort(least, count, sizeof *least, ascending);
    qsort(most, count, sizeof *most, ascending);
    verify_claim(own->verdict,
                 agrees(report->smallest_angle, (span){least[0], most[0]}) &&
                     agrees(report->median_angle, (span){least[count / 2], most[count / 2]}),
                 "the smallest dihedral angle is %.9g degrees, the median of the smallest of each "
                 "tetrahedron %.9g (found: %.9g, %.9g)",
                 report->smallest_angle, report->median_angle, least[0] / 2 + most[0] / 2,
                 least[count / 2] / 2 + most[count / 2] / 2);
    return STARG_OK;
}
