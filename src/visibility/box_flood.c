/* SPDX-License-Identifier: Apache-2.0 */
/* Patches of triangles that hide a point v from a box c.
 *
 * Let K be the shaft conv(v, c). A *flood* begins at a triangle, its seed, and spreads over every
 * edge that may meet K to the triangle on the other side. It *closes* if v lies strictly on the
 * same side of the planes of all triangles that it reaches. The triangles reached are a patch P.
 * None of them holds v then, since v is off their planes.
 *
 * Lemma. Let C be the points p of c such that the segment [v, p] meets P. C is closed, and a point
 * p of C is an inner point of C (relative to c) unless p itself lies on P.
 * Proof. P is compact, so C is closed. Let x be a point of P on [v, p]; x is neither v nor p, and
 * lies in K. If x lies in the interior of a triangle of P: v is off its plane, so that the triangle
 * covers all directions from v near that of x, strictly before points near p. If x lies in the
 * interior of an edge, this edge meets K, so both of its triangles are in P; they turn the same
 * side to v, so that they lie on different sides of the edge as seen from v, and cover all
 * directions near x. If x is a vertex, all of its edges meet K, so the whole fan of triangles
 * around x, to which the triangle with x belongs, is in P; seen from v all of them turn about x in
 * the same sense, once or more often, and again cover all directions near x.
 *
 * Patch. If no triangle of P meets c, and the seed meets the segment from v to some point of c,
 * then C is open and closed in c and not empty; c is connected, so C = c. For each p in c the
 * boundary meets [v, p] in a point other than v and p: p does not see v. (This needs no embedding.)
 *
 * Entry. Let some triangles meet c, all of them sound (box_sound.c). If all those lie in patches
 * that close, and turn their outer side to v (then all of these patches do), no point of c inside
 * the solid sees v. Proof: let G be a connected component of the part of c inside the solid, and P
 * the union of the patches. G is open in c and does not meet P, so that by the lemma either all
 * points of G are hidden by P or none. If the closure of G did not meet the boundary, G would be
 * closed and open in c, so all of c, which no triangle could meet. So a point y of the boundary
 * lies in c and in the closure of G; the triangles through y meet c and are in P. They are one fan
 * (or edge, or interior) that turns its outer side to v: as nothing else meets them, their link in
 * a small sphere about y is a simple closed curve that runs about the axis through v in one sense,
 * so it does so exactly once; the side towards v is the outer one, the other the inner one. A point
 * of G near y is on the inner side, the other one not being free, and its segment to v, almost
 * parallel to the axis, has to pass the fan. So one point of G is hidden, and with it all.
 *
 * If c is clipped, or the free space is asked for in a part of c only, the same holds with the
 * part.
 *
 * What is not certain counts against closing: an edge that may meet K is crossed, a triangle that
 * may meet c does; a larger flood that closes has the exact one as a part. Sides are exact.
 *
 * All triangles of the component of a flood (over edges that may meet K) fail or close together, so
 * a flood that meets an earlier one of the same v and c fails with it. Whether v is hidden does not
 * depend on the order of seeds, for that reason: the seed of the last success may be tried first.
 *
 * Cost: O(triangles that meet K), 10 to 30 ns for each; seeds by the tree. */
#include "geometry/intersect.h"
#include "visibility/box_parts.h"

/* Looks at a triangle that take as long as a test of whether a box meets one, and as a search for a
 * seed. That depends on which boxes the worker was asked about before, and must not be counted. */
enum { STEPS_OF_MEETING = 16, STEPS_OF_SEED = 8 };

typedef struct flood {
    box_worker *worker;
    const box_shaft *shaft;
    int side;
    box_flood_kind kind;
    size_t depth;
} flood;

/* May the triangle be in the patch? */
static bool admits(const flood *f, uint32_t rank, const box_triangle *t) {
    box_worker *w = f->worker;
    w->steps++;
    if (box_holds_target(w, t))
        return false;
    if (f->kind != FLOOD_ENTRY && w->crossing_mark[rank] == w->question &&
        box_may_cross(w->scene, t, w->current))
        return false;
    return box_side_of_target(w, t, f->shaft->v) == f->side;
}

/* An entry holds the edge by which the triangle was entered and the codes of its ends. */
static void push(flood *f, uint32_t edge, unsigned code_start, unsigned code_end) {
    uint32_t *entry = f->worker->stack + 2 * f->depth++;
    entry[0] = edge;
    entry[1] = code_start << 16 | code_end;
}

/* Goes over edge k if it may meet the shaft. False: the flood fails. */
static bool cross(flood *f, const box_triangle *t, int k, unsigned code, unsigned code_next,
                  uint32_t first) {
    box_worker *w = f->worker;
    const box_scene *scene = w->scene;
    uint32_t twin = t->twin[k], rank = twin / 3;
    if (w->visit[rank] == w->flood)
        return true;
    if (!shaft_may_meet(f->shaft, box_corner(scene, t, k), code,
                        box_corner(scene, t, k == 2 ? 0 : k + 1), code_next))
        return true;
    if (w->visit[rank] > first)
        return false; /* an earlier flood came here, and failed: one that closes has it all */
    if (f->kind == FLOOD_FOLD && box_holds_target(w, &scene->triangles[rank]))
        return true;
    w->visit[rank] = w->flood;
    if (!admits(f, rank, &scene->triangles[rank]))
        return false;
    push(f, twin, code_next, code);
    return true;
}

bool box_flood_closes(box_worker *w, const box_shaft *shaft, uint32_t seed, int side,
                      box_flood_kind kind, uint32_t first) {
    const box_scene *scene = w->scene;
    flood f = {.worker = w, .shaft = shaft, .side = side, .kind = kind};
    const box_triangle *t = &scene->triangles[seed];
    w->flood++;
    w->visit[seed] = w->flood;
    if (!admits(&f, seed, t))
        return false;
    unsigned code[3];
    for (int k = 0; k < 3; k++)
        code[k] = shaft_code(shaft, box_corner(scene, t, k));
    for (int k = 0; k < 3; k++)
        if (!cross(&f, t, k, code[k], code[k == 2 ? 0 : k + 1], first))
            return false;
    while (f.depth > 0) {
        const uint32_t *entry = w->stack + 2 * --f.depth;
        int k = (int)(entry[0] % 3), next = k == 2 ? 0 : k + 1, last = k == 0 ? 2 : k - 1;
        unsigned start = entry[1] >> 16, end = entry[1] & 0xffff;
        t = &scene->triangles[entry[0] / 3];
        unsigned apex = shaft_code(shaft, box_corner(scene, t, last));
        if (!cross(&f, t, next, end, apex, first) || !cross(&f, t, last, apex, start, first))
            return false;
    }
    return true;
}

typedef struct seed_search {
    box_worker *worker;
    const box_shaft *shaft;
    uint32_t first, found;
    box_flood_kind kind;
} seed_search;

static bool meets_sight(const box_worker *w, const box_triangle *t, const double v[3]) {
    const double *a = box_corner(w->scene, t, 0), *b = box_corner(w->scene, t, 1);
    const double *c = box_corner(w->scene, t, 2);
    return w->point != NULL ? dyadic_segment_meets_triangle(w->centre, &w->point->place, a, b, c)
                            : segment_meets_triangle(w->centre, v, a, b, c);
}

/* Goes on searching unless the triangle is a seed whose flood closes. */
static bool try_seed(void *user, size_t rank) {
    seed_search *search = user;
    box_worker *w = search->worker;
    const box_scene *scene = w->scene;
    const box_triangle *t = &scene->triangles[rank];
    const double *v = search->shaft->v;
    w->steps++;
    if (w->visit[rank] > search->first || box_holds_target(w, t))
        return true; /* a failed flood came here, or it would fail at once */
    int side = box_side_of_target(w, t, v);
    if (side == 0 || side == box_side(scene, t, w->centre) || !meets_sight(w, t, v))
        return true;
    if (!box_flood_closes(w, search->shaft, (uint32_t)rank, side, search->kind, search->first))
        return true;
    search->found = (uint32_t)rank;
    return false;
}

bool box_patch_hides(box_worker *w, const box_shaft *shaft, box_flood_kind kind, bool recorded,
                     uint32_t *seed) {
    seed_search search = {w, shaft, w->flood, BOX_NONE, kind};
    uint64_t steps = w->steps + STEPS_OF_SEED;
    if (recorded || w->seed[w->vertex] == BOX_NONE || try_seed(&search, w->seed[w->vertex]))
        box_tree_query(w->scene->boxes, shaft->v, w->centre, try_seed, &search);
    w->steps = steps;
    *seed = search.found;
    if (search.found != BOX_NONE)
        w->seed[w->vertex] = search.found;
    return search.found != BOX_NONE;
}

static bool is_within(const bvh_box *box, const double p[3]) {
    for (int k = 0; k < 3; k++)
        if (p[k] < box->lower[k] || p[k] > box->upper[k])
            return false;
    return true;
}

/* Corner i of a box: bit k says on which side along axis k. */
static void corner_of(const bvh_box *box, int i, double out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] = i >> k & 1 ? box->upper[k] : box->lower[k];
}

/* Does the boundary of the box meet the triangle? An edge of either meets a side of the other. */
static bool meets_border(const bvh_box *box, const double *const t[3]) {
    double corner[8][3];
    for (int i = 0; i < 8; i++)
        corner_of(box, i, corner[i]);
    for (int i = 0; i < 8; i++)
        for (int k = 0; k < 3; k++)
            if (segment_meets_triangle(corner[i], corner[i ^ 1 << k], t[0], t[1], t[2]))
                return true;
    for (int axis = 0; axis < 3; axis++)
        for (int side = 0; side < 2; side++) {
            int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3, i = side << axis;
            for (int e = 0; e < 3; e++)
                if (segment_meets_triangle(t[e], t[(e + 1) % 3], corner[i], corner[i ^ u],
                                           corner[i ^ u ^ v]) ||
                    segment_meets_triangle(t[e], t[(e + 1) % 3], corner[i], corner[i ^ v],
                                           corner[i ^ u ^ v]))
                    return true;
        }
    return false;
}

/* Exactly; a flat box may be taken for one that is missed. */
static bool meets(const box_scene *scene, const box_triangle *t, const bvh_box *box) {
    const double *corner[3];
    for (int k = 0; k < 3; k++) {
        corner[k] = box_corner(scene, t, k);
        if (is_within(box, corner[k]))
            return true;
    }
    return meets_border(box, corner);
}

/* One triangle at least has to meet the box, not only perhaps. The whole box is asked once. */
static bool some_meets(box_worker *w) {
    bool found = false, whole = w->current == &w->box;
    if (whole && (w->meeting - 1) / 2 == w->question)
        return w->meeting % 2 == 0;
    for (size_t i = 0; i < w->crossing_count && !found; i++) {
        w->steps += STEPS_OF_MEETING;
        found = meets(w->scene, &w->scene->triangles[w->crossing[i]], w->current);
    }
    if (whole)
        w->meeting = 2 * w->question + 1 + found;
    return found;
}

bool box_entry_hides(box_worker *w, const box_shaft *shaft) {
    const box_scene *scene = w->scene;
    uint32_t first = w->flood;
    for (size_t i = 0; i < w->crossing_count; i++) {
        uint32_t rank = w->crossing[i];
        const box_triangle *t = &scene->triangles[rank];
        w->steps++;
        if (w->current != &w->box && !box_may_cross(scene, t, w->current))
            continue;
        if (!scene->sound[rank])
            return false;
        if (w->visit[rank] <= first && !box_flood_closes(w, shaft, rank, -1, FLOOD_ENTRY, first))
            return false;
    }
    return some_meets(w);
}
