/* SPDX-License-Identifier: Apache-2.0 */
/* Pairs of faces that cross, overlap or touch, and the segment that they share.
 *
 * Two triangles in different planes share a segment or a point of the line in which these meet. Its
 * ends are where the border of one meets the plane of the other within the other: corners in the
 * plane, edges through it. In one plane and without a common area, they are corners. Predicates on
 * vertices decide which; only the places are rational. */
#include "mesh/union/arrangement.h"

#include <math.h>

#include "geometry/predicates.h"
#include "mesh/topology.h"

/* ---- pairs ---- */

enum { PAIRS_PER_CLOCK = 4096 };

typedef struct finder {
    const union_surface *surface;
    union_contacts *out;
    bool all;
    uint32_t face; /* whose partners are sought */
    size_t looks;
    starg_status status;
} finder;

static bool in_plane_of(const union_surface *surface, uint32_t face, uint32_t other) {
    for (int k = 0; k < 3; k++)
        if (orient3d(union_corner(surface, face, 0), union_corner(surface, face, 1),
                     union_corner(surface, face, 2), union_corner(surface, other, k)) != 0)
            return false;
    return true;
}

static starg_status note(finder *f, uint32_t a, uint32_t b, triangle_contact how) {
    union_contact contact = {.face = {a, b}, .coplanar = in_plane_of(f->surface, a, b)};
    contact.overlap = contact.coplanar && how == TRIANGLES_CROSS;
    PUSH(f->surface->context, UNION_STAGE, f->out, contact);
    return STARG_OK;
}

static bool look_at_pair(void *user, uint32_t other) {
    finder *f = user;
    const uint32_t *faces = f->surface->faces.data;
    uint32_t face = f->face;
    if (other == face || (other < face && (f->all || f->surface->flags.data[other] & UNION_FRESH)))
        return true; /* itself, or seen from there */
    triangle_contact how = faces_contact(f->surface->vertices.data, faces + 3 * (size_t)face,
                                         faces + 3 * (size_t)other);
    if (how == TRIANGLES_TOUCH || how == TRIANGLES_CROSS)
        f->status = note(f, face, other, how);
    if (f->status == STARG_OK && ++f->looks % PAIRS_PER_CLOCK == 0)
        f->status = starg_check_cancel(f->surface->context, UNION_STAGE);
    return f->status == STARG_OK;
}

static bvh_box box_of(const union_surface *surface, uint32_t face) {
    bvh_box box;
    for (int i = 0; i < 3; i++) {
        double a = union_corner(surface, face, 0)[i], b = union_corner(surface, face, 1)[i];
        double c = union_corner(surface, face, 2)[i];
        box.lower[i] = fmin(a, fmin(b, c));
        box.upper[i] = fmax(a, fmax(b, c));
    }
    return box;
}

starg_status union_find_contacts(const union_surface *surface, const bvh *tree, bool all,
                                 union_contacts *out) {
    finder f = {.surface = surface, .out = out, .all = all};
    for (f.face = 0; f.face < union_face_count(surface) && f.status == STARG_OK; f.face++) {
        if (!all && !(surface->flags.data[f.face] & UNION_FRESH))
            continue;
        bvh_box box = box_of(surface, f.face);
        bvh_query_box(tree, &box, look_at_pair, &f);
    }
    return f.status == STARG_OK ? starg_check_cancel(surface->context, UNION_STAGE) : f.status;
}

/* ---- ends ---- */

static void add_end(union_contact *contact, int *count, uint32_t point) {
    if (*count > 0 && contact->end[0] == point)
        return;
    contact->end[1] = point;
    if ((*count)++ == 0)
        contact->end[0] = point;
}

/* Adds where the border of s meets the plane of t within t. */
static starg_status add_ends(const union_surface *surface, const uint32_t *point,
                             exact_points *points, uint32_t face, uint32_t other,
                             union_contact *contact, int *count) {
    const double *s[3], *t[3];
    int at[3];
    for (int k = 0; k < 3; k++) {
        s[k] = union_corner(surface, face, k);
        t[k] = union_corner(surface, other, k);
    }
    for (int k = 0; k < 3; k++) {
        at[k] = orient3d(t[0], t[1], t[2], s[k]);
        if (at[k] == 0 && point_on_triangle(s[k], t[0], t[1], t[2]))
            add_end(contact, count, point[surface->faces.data[3 * (size_t)face + (size_t)k]]);
    }
    for (int k = 0; k < 3; k++) {
        const double *p = s[k], *q = s[(k + 1) % 3];
        if (at[k] * at[(k + 1) % 3] >= 0 || !segment_meets_triangle(p, q, t[0], t[1], t[2]))
            continue;
        exact_plane plane;
        exact_point meeting;
        uint32_t number;
        exact_plane_set(&plane, t, points->scale);
        exact_point_on_plane(&meeting, p, q, &plane, points->scale);
        TRY(exact_points_add(points, &meeting, &number));
        add_end(contact, count, number);
    }
    return STARG_OK;
}

starg_status union_find_ends(const union_surface *surface, const uint32_t *point,
                             exact_points *points, union_contact *contact) {
    int count = 0;
    for (int i = 0; i < 2; i++)
        TRY(add_ends(surface, point, points, contact->face[i], contact->face[1 - i], contact,
                     &count));
    return STARG_OK;
}
