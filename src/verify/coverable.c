/* SPDX-License-Identifier: Apache-2.0 */
/* Elements that no guard sees but that a guard could see: each refutes the claim that it is not
 * coverable.
 *
 * If a point p strictly inside sees a whole face, nothing is in the tetrahedron (p, face), so every
 * point of that tetrahedron sees the whole face as well. Hence the line above the centroid is
 * enough: if a point at height h above any place of the face sees all of it, so do those above the
 * centroid up to h / 3. Heights double from the least one; the first at which the view is blocked
 * ends the search.
 *
 * A guard must also be admissible, and a whole interval of heights is asked for, from 0.7 h to h,
 * so that no search by geometric series, which augmentation is, can have missed it: range      the
 * corners are within the range from h, and nearer from below; near the same from 0.6 h and above;
 * clearance  the middle of the interval keeps it with half the interval to spare; cone, field of
 * view and incidence  looking at the centroid, they hold the corners from 0.6 h, and from above.
 * Faces that are so thin that rounding moves the centroid across them are left out. Of a face that
 * is seen in parts, this is asked of each of those that no guard sees. What sees a face whole sees
 * its vertices, so this holds for both rules, and for vertices as the target.
 *
 * Cost: at most MOST_TESTS visits of the tree, mostly of tiny boxes. Signs are exact. */
#include <math.h>

#include "verify/facts.h"

static const char STAGE[] = "verify";

enum { MOST_TESTS = 20000, CANCEL_STEP = 256 };

static const double LEAST_HEIGHT = 0x1p-28; /* relative to the diagonal */
static const double LEAST_WIDTH = 1e-6;     /* of a face, likewise */
static const double MARGIN = 1e-12;         /* for ranges and clearances */

typedef struct prover {
    const verify_facts *known;
    verify_view view;
    double diagonal, least;
    size_t tests; /* remaining */

    /* the current patch, its face, and the corners of both */
    size_t face;
    const double *plane[3], *corner[3];
    verify_spot spots[3];
    double centroid[3], normal[3]; /* of unit length, inward */
} prover;

static void along(const prover *own, double height, double p[3]) {
    for (int k = 0; k < 3; k++)
        p[k] = own->centroid[k] + height * own->normal[k];
}

/* False for patches that are too thin. */
static bool begin_patch(prover *own, size_t patch) {
    const verify_surface *surface = own->known->surface;
    double n[3], length = 0, longest = 0;
    own->face = verify_patch_face(surface, patch);
    verify_corners(surface, own->face, own->plane);
    verify_patch_spots(surface, patch, own->spots);
    for (int i = 0; i < 3; i++)
        own->corner[i] = own->spots[i].at;
    verify_normal(surface, own->face, own->known->scale, n);
    for (int k = 0; k < 3; k++)
        length = hypot(length, n[k]);
    for (int i = 0; i < 3; i++) {
        const double *a = own->corner[i], *b = own->corner[(i + 1) % 3];
        longest = fmax(longest, hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]));
    }
    for (int k = 0; k < 3; k++) {
        own->normal[k] = -n[k] / length;
        own->centroid[k] = own->corner[0][k] / 3 + own->corner[1][k] / 3 + own->corner[2][k] / 3;
    }
    double width =
        ldexp(length, -2 * own->known->scale) * verify_patch_share(surface, patch) / longest;
    return width > LEAST_WIDTH * own->diagonal && width > 0x1p20 * verify_rounding(surface);
}

typedef struct obstacle {
    const prover *own;
    const double *p;
} obstacle;

static bool passes(void *data, uint32_t other) {
    const obstacle *o = data;
    const double *t[3];
    if (other == o->own->face)
        return true;
    verify_corners(o->own->known->surface, other, t);
    if (verify_on_triangle(o->p, t))
        return false;
    int side = verify_side(t[0], t[1], t[2], o->p);
    for (int i = 0; i < 3; i++)
        if (verify_blocks_from(side, o->p, &o->own->spots[i], t))
            return false;
    return !verify_enters(o->p, o->own->plane, o->own->spots, t);
}

static bool sees_whole(const prover *own, const double p[3]) {
    double lower[3], upper[3];
    obstacle data = {own, p};
    for (int k = 0; k < 3; k++) {
        lower[k] = upper[k] = p[k];
        for (int i = 0; i < 3; i++) {
            lower[k] = fmin(lower[k], own->corner[i][k] - own->spots[i].blur);
            upper[k] = fmax(upper[k], own->corner[i][k] + own->spots[i].blur);
        }
    }
    return verify_tree_visit(own->known->tree, lower, upper, passes, &data);
}

static bool in_range(const prover *own, const double p[3]) {
    for (int i = 0; i < 3; i++)
        if (!verify_within(p, own->corner[i], own->view.range * (1 - MARGIN)))
            return false;
    return true;
}

/* Far enough, from 0.6 of the height as well. */
static bool is_clear_of_near(const prover *own, double height) {
    double low[3];
    along(own, 0.6 * height, low);
    for (int i = 0; i < 3; i++)
        if (own->view.near > 0 && verify_nearer(low, own->corner[i], own->view.near * (1 + MARGIN)))
            return false;
    return true;
}

static bool keeps_clearance(const prover *own, double height) {
    double middle[3], clearance = own->known->guards->options.clearance;
    if (!(clearance > 0))
        return true;
    along(own, 0.85 * height, middle);
    return verify_tree_distance(own->known->tree, middle, own->known->scale) >=
           clearance * (1 + MARGIN) + 0.16 * height;
}

/* Is the whole height within the depth at which the face has its density? */
static bool is_near_enough(const prover *own, double height) {
    const starg_guards *guards = own->known->guards;
    const starg_face_need *need = verify_need_of(guards, own->face);
    double depth =
        starg_density_depth(&guards->options.visibility, need != NULL ? need->density : 0);
    return height * (1 + MARGIN) <= depth;
}

/* Does a guard look in one direction? */
static bool verify_is_aimed(const verify_facts *known) {
    return known->guards->options.visibility.cone < 360 ||
           known->guards->options.visibility.fov[0] > 0;
}

/* Does a view from 0.6 of the height, straight down, hold the corners, at the incidence allowed?
 * From above it does as well. A rectangular view holds the cone of its smaller angle. */
static bool in_view(const prover *own, double height) {
    const starg_visibility_options *o = &own->known->guards->options.visibility;
    double low[3], direction[3];
    double cone = o->fov[0] > 0 ? fmin(o->fov[0], o->fov[1]) * (1 - MARGIN) : o->cone;
    along(own, 0.6 * height, low);
    for (int k = 0; k < 3; k++)
        direction[k] = -own->normal[k];
    if (verify_is_aimed(own->known) &&
        (!starg_tilt_holds(o, direction) || !is_near_enough(own, height)))
        return false;
    for (int i = 0; i < 3; i++)
        if (cone < 360 && !verify_in_cone(low, direction, starg_cone_cosine(cone), own->corner[i]))
            return false;
    return own->view.steepest == 0 ||
           (verify_side(own->plane[0], own->plane[1], own->plane[2], low) > 0 &&
            verify_faces(&own->view, low, own->plane, own->corner));
}

static bool is_inside(const prover *own, const double p[3]) {
    bool on_surface;
    int winding = verify_tree_winding(own->known->tree, p, &on_surface);
    return !on_surface && winding + own->known->surface->ambient >= 1;
}

/* Could a guard somewhere above the patch see it? */
static bool prove_patch(prover *own, size_t patch, double p[3]) {
    if (!begin_patch(own, patch))
        return false;
    for (double height = own->least; height < own->diagonal && own->tests > 0; height *= 2) {
        own->tests--;
        along(own, height, p);
        if (verify_side(own->plane[0], own->plane[1], own->plane[2], p) <= 0)
            continue; /* because of rounding */
        if (!sees_whole(own, p) || !in_range(own, p))
            return false;
        if (keeps_clearance(own, height) && is_clear_of_near(own, height) && in_view(own, height))
            return is_inside(own, p);
    }
    return false;
}

/* Could guards above them see the patches of the face that no guard sees? *p: the last such place.
 */
static bool prove_face(prover *own, size_t face, double p[3]) {
    const verify_facts *known = own->known;
    for (size_t j = verify_first_patch(known->surface, face);
         j < verify_first_patch(known->surface, face + 1); j++)
        if ((verify_targets_vertices(known) || !known->patch[j]) && !prove_patch(own, j, p))
            return false;
    return true;
}

static void begin(prover *own) {
    const verify_surface *surface = own->known->surface;
    own->diagonal = verify_diagonal(surface);
    own->least = fmax(LEAST_HEIGHT * own->diagonal, 0x1p16 * verify_rounding(surface));
    own->least = fmax(own->least, own->known->guards->options.clearance);
}

/* Does the face have a target element that no guard sees and that is not proven yet? */
static bool is_open(const verify_facts *known, const uint8_t *proven, size_t face) {
    const uint32_t *corner = known->surface->faces + 3 * face;
    if (!verify_targets_vertices(known))
        return !known->face[face];
    for (int i = 0; i < 3; i++)
        if (!known->vertex[corner[i]] && !proven[corner[i]])
            return true;
    return false;
}

static void note(const verify_facts *known, uint8_t *proven, size_t face, const double p[3],
                 verify_coverable *found) {
    const uint32_t *corner = known->surface->faces + 3 * face;
    bool vertices = verify_targets_vertices(known);
    for (int i = 0; i < (vertices ? 3 : 1); i++) {
        size_t element = vertices ? corner[i] : face;
        if (proven[element] || (vertices && known->vertex[element]))
            continue;
        proven[element] = 1;
        if (found->proven++ > 0)
            continue;
        found->first = element;
        for (int k = 0; k < 3; k++)
            found->place[k] = p[k];
    }
}

starg_status verify_find_coverable(const verify_facts *known, size_t enough,
                                   verify_coverable *found) {
    const verify_surface *surface = known->surface;
    prover own = {.known = known, .view = verify_view_around(known->guards), .tests = MOST_TESTS};
    SCOPED uint8_t *proven = NULL;
    *found = (verify_coverable){0};
    NEW_ZERO(surface->context, STAGE, proven,
             verify_targets_vertices(known) ? surface->vertex_count : surface->face_count);
    begin(&own);
    for (size_t f = 0; f < surface->face_count && found->proven <= enough && own.tests > 0; f++) {
        double p[3];
        if (is_open(known, proven, f) && prove_face(&own, f, p))
            note(known, proven, f, p, found);
        if (f % CANCEL_STEP == 0)
            TRY(starg_check_cancel(surface->context, STAGE));
    }
    return STARG_OK;
}
