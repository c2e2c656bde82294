/* SPDX-License-Identifier: Apache-2.0 */
/* Does every segment from a vertex v to a box c begin outside the solid?
 *
 * The triangles around v cut the sphere of directions from v along a closed curve of arcs, its
 * link; if all of them are sound (box_sound.c) the curve is simple, and directions on one side of
 * it lead into the solid, on the other side out of it, and along it on the boundary. The directions
 * D to the points of c are connected. If D does not meet the link, all of D is on one side. If that
 * is the outer one, every segment from v to a point p of c inside the solid is outside near v, so
 * that it meets the boundary between v and p: p does not see v.
 *
 * D and an arc (the directions of a triangle v a b) are front-facing apart by a plane through v
 * that has c strictly on one side, and a and b on the other or in it, one of the shaft's sides with
 * a and b strictly outside, or the plane of the triangle itself with c strictly on one side.
 *
 * On which side one direction d of D lies (that to the centre): if no triangle around v has d on
 * its inner side, d is outside, because the first arc that one meets from an inner direction has it
 * on its inner side (scene.h has the proof). Otherwise take an arc of a great circle from d to a
 * point e beyond some triangle, shorter than a half, that holds no end of an arc of the link: if it
 * crosses the link, and every arc that it crosses has d on its outer side, then the first one has,
 * and d is outside. The signs of the determinants of v, d, e, a and b say which arcs it crosses.
 *
 * Cost: O(triangles around v), squared where d is on inner and outer sides. */
#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "visibility/box_parts.h"

static const double *around(const box_scene *scene, uint32_t corner, uint32_t steps) {
    const box_triangle *t = &scene->triangles[corner / 3];
    return box_corner(scene, t, (int)((corner % 3 + steps) % 3));
}

bool box_arc_may_meet(const box_scene *scene, const box_shaft *s, uint32_t corner) {
    const double *a = around(scene, corner, 1), *b = around(scene, corner, 2);
    for (int k = 0; k < 3; k++)
        if ((s->box.lower[k] > s->v[k] && a[k] <= s->v[k] && b[k] <= s->v[k]) ||
            (s->box.upper[k] < s->v[k] && a[k] >= s->v[k] && b[k] >= s->v[k]))
            return false;
    return (shaft_code(s, a) & shaft_code(s, b) & SHAFT_SIDES) == 0 && !shaft_is_beside(s, a, b);
}

/* Does the arc from d to e cross that of a and b? 1 or 0; -1 if it is not certain: a or b lies on
 * the circle through d and e, or e on that through a and b. */
static int crosses(const double v[3], const double d[3], const double e[3], const double a[3],
                   const double b[3], int side_d) {
    int at_a = orient3d(a, d, e, v), at_b = orient3d(b, d, e, v), at_e = orient3d(e, a, b, v);
    if (at_a == 0 || at_b == 0 || at_e == 0)
        return -1;
    return at_a != at_b && at_a == at_e && side_d == -at_e;
}

/* Crosses the arc from d to e only, and at least one, triangles with d on the outer side? */
static bool leads_in(const box_scene *scene, uint32_t first, const double v[3], const double d[3],
                     const double e[3]) {
    bool any = false;
    uint32_t corner = first;
    do {
        const double *a = around(scene, corner, 1), *b = around(scene, corner, 2);
        int side_d = orient3d(d, a, b, v), crossing = crosses(v, d, e, a, b, side_d);
        if (crossing < 0 || (crossing > 0 && box_side(scene, &scene->triangles[corner / 3], d) > 0))
            return false;
        any = any || crossing > 0;
        corner = box_turn(scene, corner);
    } while (corner != first);
    return any;
}

/* A point somewhat beyond the middle of a b as seen from v along the arc from d. */
static void beyond(const double v[3], const double d[3], const double a[3], const double b[3],
                   double e[3]) {
    double to_d[3], to_middle[3];
    vec3_subtract(d, v, to_d);
    for (int k = 0; k < 3; k++)
        to_middle[k] = (0.5 * a[k] - 0.5 * v[k]) + (0.5 * b[k] - 0.5 * v[k]);
    double ratio = 0.03125 * vec3_length(to_middle) / vec3_length(to_d);
    for (int k = 0; k < 3; k++)
        e[k] = v[k] + 0.5 * (to_middle[k] - ratio * to_d[k]);
}

bool box_starts_outside(const box_worker *w, const box_shaft *shaft) {
    const box_scene *scene = w->scene;
    const double *v = shaft->v, *d = w->centre;
    uint32_t first = scene->outgoing[w->vertex];
    bool inner = false;
    uint32_t corner = first;
    do {
        inner = inner || box_side(scene, &scene->triangles[corner / 3], d) > 0;
        corner = box_turn(scene, corner);
    } while (corner != first && !inner);
    if (!inner)
        return true;
    corner = first;
    do {
        double e[3];
        if (box_side(scene, &scene->triangles[corner / 3], d) < 0) {
            beyond(v, d, around(scene, corner, 1), around(scene, corner, 2), e);
            if (fabs(e[0]) < 1e100 && fabs(e[1]) < 1e100 && fabs(e[2]) < 1e100 &&
                leads_in(scene, first, v, d, e))
                return true;
        }
        corner = box_turn(scene, corner);
    } while (corner != first);
    return false;
}

bool box_start_hides(box_worker *w, const box_shaft *shaft) {
    const box_scene *scene = w->scene;
    uint32_t first = scene->outgoing[w->vertex], corner = first;
    if (first == BOX_NONE || !scene->sound_about[w->vertex])
        return false;
    do {
        if (box_arc_may_meet(scene, shaft, corner))
            return false;
        corner = box_turn(scene, corner);
    } while (corner != first);
    return box_starts_outside(w, shaft);
}
