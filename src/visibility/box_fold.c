/* SPDX-License-Identifier: Apache-2.0 */
/* A vertex v that is hidden from a box c partly by where segments begin, partly by what stands
 * right beside v: a fold of the surface.
 *
 * As in box_start.c the triangles around v cut the directions from v into those that lead into the
 * solid, S, those that lead out of it, and the arcs between. A segment from v to a point p of c
 * inside the solid is blocked at once unless its direction is in S. Let c' be the points of c with
 * directions in S. Floods (box_flood.c) run over the triangles that do not hold v; they stop before
 * those that do. That changes nothing for directions in S: an edge between a triangle that holds v
 * and one that does not lies in the directions of an arc, and so does every vertex of a triangle
 * that holds v. So by the lemma there, the points of c' that are hidden by patches are open and
 * closed in c', if no patch meets c: each connected component H of c' is hidden or not as a whole.
 *
 * Now let the following hold for each triangle t = (v, a, b) whose arc may meet the directions of
 * c. It surely does not meet c; its neighbour n over a b has its third corner strictly on the inner
 * side of t; and the flood of n closes. Besides, the direction to the centre of c leads out of the
 * solid, or the segment to it meets a patch that closes. Then no point of c inside the solid sees
 * v. Proof. If c' is all of c and connected, it is hidden with the centre, whose segment is
 * blocked. (If the centre is on the outer side, c' is not all of c.) Otherwise the closure of H has
 * a point y in c whose direction is on some arc, of t. The ray to y leaves t at a point x of a b,
 * before y since t does not meet c; so a b meets the shaft in x. Let x be inside the edge. Near x,
 * n covers the directions on the inner side of t, which are those in S, and points of H near y have
 * such directions: they are hidden. Let x be a, a vertex. Then the arcs of both triangles around
 * the edge v a may meet, and all edges at a meet the shaft; so the whole fan around a from one
 * neighbour to the other is in the patch. Seen from v it turns about a in one sense, from one arc,
 * where it begins on the inner side, to the other: it covers all directions of S near a. Again H
 * has hidden points. So all of H is hidden.
 *
 * Needs sound triangles around v (box_sound.c). Cost: that of the floods. */
#include "visibility/box_parts.h"

/* Is the triangle of this corner, v, followed by a patch that closes, on its inner side? */
static bool goes_on(box_worker *w, const box_shaft *shaft, uint32_t corner, uint32_t first) {
    const box_scene *scene = w->scene;
    uint32_t rank = corner / 3, k = corner % 3;
    const box_triangle *t = &scene->triangles[rank];
    uint32_t twin = t->twin[k == 2 ? 0 : k + 1], next = twin / 3;
    const box_triangle *n = &scene->triangles[next];
    if (w->crossing_mark[rank] == w->question && box_may_cross(scene, t, w->current))
        return false;
    if (box_side(scene, t, box_corner(scene, n, (int)((twin + 2) % 3))) <= 0)
        return false;
    if (w->visit[next] > first)
        return true; /* the flood of another one came here, and has closed */
    int side = box_side(scene, n, shaft->v);
    return side != 0 && box_flood_closes(w, shaft, next, side, FLOOD_FOLD, first);
}

bool box_fold_hides(box_worker *w, const box_shaft *shaft, bool recorded, uint32_t *seed) {
    const box_scene *scene = w->scene;
    uint32_t begin = scene->outgoing[w->vertex], corner = begin, first = w->flood;
    bool any = false;
    *seed = BOX_NONE;
    if (!scene->sound_about[w->vertex])
        return false;
    do {
        if (box_arc_may_meet(scene, shaft, corner)) {
            if (!goes_on(w, shaft, corner, first))
                return false;
            any = true;
        }
        corner = box_turn(scene, corner);
    } while (corner != begin);
    return any &&
           (box_starts_outside(w, shaft) || box_patch_hides(w, shaft, FLOOD_FOLD, recorded, seed));
}
