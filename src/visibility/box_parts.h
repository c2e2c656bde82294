/* SPDX-License-Identifier: Apache-2.0 */
/* Inside of visibility from a box: the tables of a scene, what a worker keeps, and the three proofs
 * that a vertex is hidden. */
#ifndef STARG_VISIBILITY_BOX_PARTS_H
#define STARG_VISIBILITY_BOX_PARTS_H

#include <math.h>
#include <stdbool.h>

#include "geometry/bvh.h"
#include "geometry/predicates.h"
#include "visibility/box.h"

/* ---- triangles that a segment may meet, four boxes at a time (box_tree.c) ---- */
/* In single precision. */

typedef struct box_tree box_tree;

/* Folds two levels of the tree into one; triangles keep their ranks. `centre` and `extent` are
 * those of the bounding box. Errors: MEMORY. */
starg_status box_tree_create(starg_context *context, const bvh *tree, const double centre[3],
                             double extent, box_tree **out);
void box_tree_free(box_tree *tree);
STARG_DROP(box_tree, box_tree)

/* bvh_query_segment for p and q in the bounding box; triangles come one by one where their own
 * boxes may be met, in an order that the tree and the segment give. */
bool box_tree_query(const box_tree *tree, const double p[3], const double q[3],
                    bvh_visit_rank *visit, void *user);

/* The shaft of a point v and a box c: the union of the segments from v to the points of c, which is
 * conv(v, c), and what surely misses it.
 *
 * Faces of the shaft that hold v pass through an edge of the box; such an edge is parallel to an
 * axis, and so the plane is that of a line in the projection along this axis: there the shaft is
 * the hull of a point and a rectangle, with at most two lines through the point. The other faces
 * are faces of the hull's bounding box. So the shaft is the intersection of that box and at most
 * six half-spaces, each given by two numbers.
 *
 * A segment misses the shaft if both ends lie strictly outside of one of these twelve planes, or if
 * the box lies strictly on one side of the plane of the segment and v: then the shaft without v
 * does, and the segment, which does not hold v, lies in the plane. "Strictly" means by more than
 * the rounding error; what is not certain counts as meeting the shaft.
 *
 * Error bounds. All differences carry one rounding. A product of two carries three, a sum of two
 * such products four: below 8 x 2^-53 of the sum of the absolute products. A component of a cross
 * product has four, times a difference six, a sum of three such eight: below 16 x 2^-53 of the sum
 * of absolute products. Underflows lose less than TINY of each.
 *
 * A point v between vertices (geometry/dyadic.h) is off by at most `blur` in each coordinate. The
 * planes about the box are those of its rounded place; v itself lies beyond one by at most the sum
 * of the two numbers times blur, so that what is beyond by more is outside of the true shaft. With
 * a = |p - v|, b = |q - v| and c = |x - v| the largest differences, the determinant of v, p, q and
 * x is off by at most 6 blur ((a + b + blur)(c + blur) + a b). */

#define SHAFT_TINY_2 1e-290 /* for products of two differences below 2e100   */
#define SHAFT_TINY_3 1e-200 /* for products of three                         */

typedef struct box_shaft {
    double v[3];
    bvh_box box, hull;      /* c; the bounding box of v and c                               */
    double low[3], high[3]; /* corners of c, relative to v                                  */
    double blur, slack[6];  /* of v; how far beyond each side counts as outside             */
    double side[6][2];      /* planes 2k and 2k + 1 look along axis k: with d = p - v, p is
                               outside if side[0] d[k + 1] + side[1] d[k + 2] > 0           */
} box_shaft;

/* Bits of a code: p is strictly outside of these planes of the shaft. */
#define SHAFT_HULL  0x3fu  /* those of the bounding box */
#define SHAFT_SIDES 0xfc0u /* those that hold v         */

/* The two lines through v about the rectangle in the projection along axis k. Where the point lies
 * beside the rectangle says which of its corners they pass: counter-clockwise and clockwise. */
static inline void shaft_make_sides(box_shaft *s, int k) {
    /* by zone of (u, w): below, within, above; 0 the low corner, 1 the high one */
    static const signed char corners[3][3][4] = {{{0, 1, 1, 0}, {0, 1, 0, 0}, {1, 1, 0, 0}},
                                                 {{0, 0, 1, 0}, {-1, 0, 0, 0}, {1, 1, 0, 1}},
                                                 {{0, 0, 1, 1}, {1, 0, 1, 1}, {1, 0, 0, 1}}};
    int u = (k + 1) % 3, w = (k + 2) % 3;
    int zone_u = s->v[u] < s->box.lower[u] ? 0 : s->v[u] > s->box.upper[u] ? 2 : 1;
    int zone_w = s->v[w] < s->box.lower[w] ? 0 : s->v[w] > s->box.upper[w] ? 2 : 1;
    const signed char *c = corners[zone_u][zone_w];
    double *left = s->side[2 * k], *right = s->side[2 * k + 1];
    left[0] = left[1] = right[0] = right[1] = 0;
    if (c[0] < 0)
        return; /* v is seen through the rectangle: no lines */
    left[0] = -(c[1] ? s->high[w] : s->low[w]);
    left[1] = c[0] ? s->high[u] : s->low[u];
    right[0] = c[3] ? s->high[w] : s->low[w];
    right[1] = -(c[2] ? s->high[u] : s->low[u]);
}

static inline void shaft_make(box_shaft *s, const double v[3], double blur, const bvh_box *box) {
    s->box = *box;
    s->blur = blur;
    for (int k = 0; k < 3; k++) {
        s->v[k] = v[k];
        s->hull.lower[k] = v[k] - blur < box->lower[k] ? v[k] - blur : box->lower[k];
        s->hull.upper[k] = v[k] + blur > box->upper[k] ? v[k] + blur : box->upper[k];
        s->low[k] = box->lower[k] - v[k];
        s->high[k] = box->upper[k] - v[k];
    }
    for (int k = 0; k < 3; k++)
        shaft_make_sides(s, k);
    for (int i = 0; i < 6; i++)
        s->slack[i] = SHAFT_TINY_2 + 2 * blur * (fabs(s->side[i][0]) + fabs(s->side[i][1]));
}

static inline unsigned shaft_code(const box_shaft *s, const double p[3]) {
    const double d[5] = {p[0] - s->v[0], p[1] - s->v[1], p[2] - s->v[2], p[0] - s->v[0],
                         p[1] - s->v[1]};
    unsigned code = 0;
    for (int k = 0; k < 3; k++)
        code |= (unsigned)(p[k] < s->hull.lower[k]) << k | (unsigned)(p[k] > s->hull.upper[k])
                                                               << (3 + k);
    for (int i = 0; i < 6; i++) {
        double x = s->side[i][0] * d[i / 2 + 1], y = s->side[i][1] * d[i / 2 + 2];
        code |= (unsigned)(x + y > 8 * 0x1p-53 * (fabs(x) + fabs(y)) + s->slack[i]) << (6 + i);
    }
    return code;
}

static inline double shaft_blur_bound(const box_shaft *s, const double a[3], const double b[3]) {
    double from_a = 0, from_b = 0, from_c = 0;
    for (int k = 0; k < 3; k++) {
        from_a = fmax(from_a, fabs(a[k]));
        from_b = fmax(from_b, fabs(b[k]));
        from_c = fmax(from_c, fmax(fabs(s->low[k]), fabs(s->high[k])));
    }
    return 8 * s->blur * ((from_a + from_b + s->blur) * (from_c + s->blur) + from_a * from_b);
}

/* Does c lie strictly on one side of the plane of v, p and q? */
static inline bool shaft_is_beside(const box_shaft *s, const double p[3], const double q[3]) {
    double a[3], b[3], least = 0, most = 0, size = 0;
    for (int k = 0; k < 3; k++) {
        a[k] = p[k] - s->v[k];
        b[k] = q[k] - s->v[k];
    }
    for (int k = 0; k < 3; k++) {
        int u = k == 2 ? 0 : k + 1, w = k == 0 ? 2 : k - 1;
        double x = a[u] * b[w], y = a[w] * b[u];
        double low = (x - y) * s->low[k], high = (x - y) * s->high[k];
        least += low < high ? low : high;
        most += low < high ? high : low;
        size += (fabs(x) + fabs(y)) * fmax(fabs(s->low[k]), fabs(s->high[k]));
    }
    double bound = 16 * 0x1p-53 * size + SHAFT_TINY_3;
    if (s->blur > 0)
        bound += shaft_blur_bound(s, a, b);
    return least > bound || most < -bound;
}

/* May the edge meet the shaft? False only if it surely does not. */
static inline bool shaft_may_meet(const box_shaft *s, const double p[3], unsigned code_p,
                                  const double q[3], unsigned code_q) {
    if (code_p & code_q)
        return false;
    return code_p == 0 || code_q == 0 || !shaft_is_beside(s, p, q);
}

/* A blocker, by its rank in the order of the tree; one line of cache. */
typedef struct box_triangle {
    uint32_t corner[3];
    uint32_t twin[3]; /* 3 x rank + edge of the neighbour; edge k runs from corner k to the next */
    double normal[3], offset; /* offset - normal . (p - centre) is positive on the inner side,  */
    double bound;             /* beyond this                                                    */
} box_triangle;

/* A point of a face that is asked about and is no vertex; its number follows those of vertices. */
typedef struct box_point {
    dyadic_point place;
    const patch_point *of;
} box_point;

struct box_scene {
    starg_context *context;
    box_point *between;
    const starg_solid *solid;
    const bvh *tree;
    box_tree *boxes;      /* for segments */
    const double *points; /* of the mesh */
    size_t vertex_count, face_count;
    box_triangle *triangles; /* by rank                                                      */
    uint32_t *rank_of;       /* by face of the mesh                                          */
    uint32_t *outgoing;      /* by vertex: 3 x rank + corner of one triangle, or BOX_NONE    */
    bvh_box all;             /* of the blockers and of places where guards may be */
    double centre[3], extent;
    uint8_t *sound;       /* by rank: nonzero if it bounds the free space cleanly (box_sound.c) */
    uint8_t *sound_about; /* by vertex: do all of its triangles? */
};

struct box_worker {
    const box_scene *scene;
    bvh_box box;      /* of the question                                              */
    double centre[3]; /* of the box that is looked at, which may be a clipped one     */
    const bvh_box *current;
    uint32_t vertex;        /* that is asked about, or a point */
    const box_point *point; /* it, or NULL: a vertex is asked about */
    uint32_t *crossing;     /* ranks of the triangles that may meet the box of the question */
    size_t crossing_count;
    uint32_t *crossing_mark; /* by rank: the number of the question, if among them     */
    uint32_t question;
    uint32_t *visit;       /* by rank: number of the last flood that came here */
    uint32_t flood;        /* number of the last flood                         */
    uint32_t *stack;       /* 2 numbers an entry               */
    uint32_t *seed;        /* by vertex: rank of the seed that was last good   */
    uint32_t *answer_mark; /* by vertex: the number of the question, if known */
    uint8_t *answer;       /* by vertex: a box_reason_kind                    */
    uint64_t meeting; /* 1 + twice the last question of which the whole box was asked whether some
                         triangle meets it, 2 + that if one does */
    uint64_t tests, steps; /* vertices, and triangles looked at */
};

static inline const double *box_corner(const box_scene *scene, const box_triangle *t, int k) {
    return scene->points + 3 * (size_t)t->corner[k];
}

/* Side of the triangle's plane on which p, in the bounding box, lies: 1 inner, -1 outer, 0 in it.
 */
static inline int box_side(const box_scene *scene, const box_triangle *t, const double p[3]) {
    double sum = t->offset;
    for (int k = 0; k < 3; k++)
        sum -= t->normal[k] * (p[k] - scene->centre[k]);
    if (sum > t->bound)
        return 1;
    if (sum < -t->bound)
        return -1;
    return orient3d(box_corner(scene, t, 0), box_corner(scene, t, 1), box_corner(scene, t, 2), p);
}

/* box_side of the vertex or point that is asked about. */
static inline int box_side_of_target(const box_worker *w, const box_triangle *t,
                                     const double v[3]) {
    const box_scene *scene = w->scene;
    double sum = t->offset, slack = t->bound;
    if (w->point == NULL || w->point->place.exact)
        return box_side(scene, t, v);
    for (int k = 0; k < 3; k++) {
        sum -= t->normal[k] * (v[k] - scene->centre[k]);
        slack += 2 * fabs(t->normal[k]) * w->point->place.blur;
    }
    if (sum > slack)
        return 1;
    if (sum < -slack)
        return -1;
    const dyadic_point a = dyadic_of(box_corner(scene, t, 0)),
                       b = dyadic_of(box_corner(scene, t, 1));
    const dyadic_point c = dyadic_of(box_corner(scene, t, 2));
    return dyadic_orient3d(&a, &b, &c, &w->point->place);
}

/* Does the triangle hold the vertex or point that is asked about, as the mesh tells? Then that lies
 * in its plane: this saves the exact computation. */
static inline bool box_holds_target(const box_worker *w, const box_triangle *t) {
    bool has = true;
    if (w->point == NULL)
        return t->corner[0] == w->vertex || t->corner[1] == w->vertex || t->corner[2] == w->vertex;
    for (int k = 0; k < 3 && has && w->point->of->weight[k] > 0; k++) {
        uint32_t vertex = w->point->of->vertex[k];
        has = t->corner[0] == vertex || t->corner[1] == vertex || t->corner[2] == vertex;
    }
    return has;
}

/* Fills `sound` and `sound_about` from the rest of the scene. Errors: MEMORY. */
starg_status box_find_sound(box_scene *scene);

/* May the triangle meet the box? False only if it surely does not. */
bool box_may_cross(const box_scene *scene, const box_triangle *t, const bvh_box *box);

/* What becomes of a flood at triangles that meet the box, or hold v. */
typedef enum box_flood_kind {
    FLOOD_PATCH, /* it fails at both                */
    FLOOD_ENTRY, /* it fails at those that hold v   */
    FLOOD_FOLD   /* it stops before those that do; it fails at those that meet the box */
} box_flood_kind;

/* Does the flood of this seed close, with v on `side` of every triangle? Floods after number
 * `first` were made for the same v, box and kind. */
bool box_flood_closes(box_worker *worker, const box_shaft *shaft, uint32_t seed, int side,
                      box_flood_kind kind, uint32_t first);

/* Begins a question about the box: lists the triangles that may meet it. False: the box is surely
 * outside of the free space. */
bool box_enter(box_worker *worker, const bvh_box *box);

/* The next triangle around its vertex: corner numbers are 3 x rank + corner. */
static inline uint32_t box_turn(const box_scene *scene, uint32_t corner) {
    uint32_t k = corner % 3;
    return scene->triangles[corner / 3].twin[k == 0 ? 2 : k - 1];
}

/* May the directions of the triangle of this corner, v, meet those of the box? */
bool box_arc_may_meet(const box_scene *scene, const box_shaft *shaft, uint32_t corner);

/* Does the direction from v to the centre, which is not on the link, surely lead out of the solid?
 */
bool box_starts_outside(const box_worker *worker, const box_shaft *shaft);

/* Each of these is true only if no point of the shaft's box in the free space sees v. */

/* By a patch with a triangle that the segment from v to the centre meets, whose rank *seed becomes
 * (else BOX_NONE). If `recorded`, it is the first of them in the order of the tree. */
bool box_patch_hides(box_worker *worker, const box_shaft *shaft, box_flood_kind kind, bool recorded,
                     uint32_t *seed);
/* By the patches on which all triangles lie that meet the box. */
bool box_entry_hides(box_worker *worker, const box_shaft *shaft);
/* By where segments begin. */
bool box_start_hides(box_worker *worker, const box_shaft *shaft);
/* By where segments begin, and patches that begin next to the triangles around v. */
bool box_fold_hides(box_worker *worker, const box_shaft *shaft, bool recorded, uint32_t *seed);

#endif
