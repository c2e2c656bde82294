/* SPDX-License-Identifier: Apache-2.0 */
/* Bounding volume hierarchy: median split along the longest axis of the centroids, leaves of up to
 * four triangles. Construction O(n log n), queries O(log n) when few triangles are hit.
 *
 * Boxes hold the exact minima and maxima of the corners, and the winding number tests its vertical
 * line by comparisons only. Only the slab test of segments computes; its interval is widened by
 * more than its rounding error, so that it never loses a triangle. */
#include "geometry/bvh.h"

#include "geometry/intersect.h"
#include "geometry/predicates.h"
#include "geometry/vec3.h"

enum { LEAF_SIZE = 4, STACK_SIZE = 128 };

typedef struct builder {
    bvh *tree;
    double *centroids; /* three per triangle, halved to avoid overflow */
} builder;

static const double *corner(const bvh *tree, uint32_t triangle, int k) {
    return tree->vertices + 3 * (size_t)tree->faces[3 * (size_t)triangle + (size_t)k];
}

static void box_clear(bvh_box *box) {
    for (int k = 0; k < 3; k++) {
        box->lower[k] = INFINITY;
        box->upper[k] = -INFINITY;
    }
}

static void box_add(bvh_box *box, const double p[3]) {
    for (int k = 0; k < 3; k++) {
        if (p[k] < box->lower[k])
            box->lower[k] = p[k];
        if (p[k] > box->upper[k])
            box->upper[k] = p[k];
    }
}

static bvh_box triangle_box(const bvh *tree, uint32_t triangle) {
    bvh_box box;
    box_clear(&box);
    for (int k = 0; k < 3; k++)
        box_add(&box, corner(tree, triangle, k));
    return box;
}

static bool before(const builder *build, int axis, uint32_t a, uint32_t b) {
    double x = build->centroids[3 * (size_t)a + (size_t)axis];
    double y = build->centroids[3 * (size_t)b + (size_t)axis];
    return x < y || (x == y && a < b);
}

/* Quickselect: order[middle] becomes what sorting would put there. */
static void select_median(const builder *build, int axis, uint32_t *order, size_t low, size_t high,
                          size_t middle) {
    while (high - low > 1) {
        uint32_t pivot = order[low + (high - low) / 2];
        size_t i = low, j = high - 1;
        while (i <= j) {
            while (before(build, axis, order[i], pivot))
                i++;
            while (before(build, axis, pivot, order[j]))
                j--;
            if (i > j)
                break;
            uint32_t swap = order[i];
            order[i] = order[j];
            order[j] = swap;
            i++;
            if (j == 0)
                break;
            j--;
        }
        if (middle <= j)
            high = j + 1;
        else if (middle >= i)
            low = i;
        else
            return;
    }
}

static int longest_axis(const builder *build, size_t first, size_t count) {
    bvh_box box;
    box_clear(&box);
    for (size_t i = first; i < first + count; i++)
        box_add(&box, build->centroids + 3 * (size_t)build->tree->order[i]);
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (box.upper[k] - box.lower[k] > box.upper[axis] - box.lower[axis])
            axis = k;
    return axis;
}

static void build_node(builder *build, size_t index, size_t first, size_t count) {
    bvh *tree = build->tree;
    bvh_node *node = &tree->nodes[index];
    if (count <= LEAF_SIZE) {
        *node = (bvh_node){.first = (uint32_t)first, .count = (uint32_t)count};
        box_clear(&node->box);
        for (size_t i = first; i < first + count; i++)
            for (int k = 0; k < 3; k++)
                box_add(&node->box, corner(tree, tree->order[i], k));
        return;
    }
    size_t half = count / 2, children = tree->node_count;
    select_median(build, longest_axis(build, first, count), tree->order, first, first + count,
                  first + half);
    tree->node_count += 2;
    build_node(build, children, first, half);
    build_node(build, children + 1, first + half, count - half);
    node->first = (uint32_t)children;
    node->count = 0;
    node->box = tree->nodes[children].box;
    box_add(&node->box, tree->nodes[children + 1].box.lower);
    box_add(&node->box, tree->nodes[children + 1].box.upper);
}

starg_status bvh_create(starg_context *context, const double *vertices, const uint32_t *faces,
                        size_t face_count, bvh **out) {
    starg_status status = STARG_OK;
    bvh *tree = NULL;
    builder build = {0};
    *out = NULL;
    STARG_NEW_ZERO(context, "bvh", tree, 1);
    tree->context = context;
    tree->triangle_count = face_count;
    tree->vertices = vertices;
    tree->faces = faces;
    build.tree = tree;
    STARG_NEW(context, "bvh", tree->nodes, face_count + 2); /* leaves hold two or more */
    STARG_NEW(context, "bvh", tree->order, face_count);
    STARG_NEW(context, "bvh", build.centroids, 3 * face_count);
    for (size_t f = 0; f < face_count; f++) {
        bvh_box box = triangle_box(tree, (uint32_t)f);
        tree->order[f] = (uint32_t)f;
        for (size_t k = 0; k < 3; k++)
            build.centroids[3 * f + k] = 0.5 * box.lower[k] + 0.5 * box.upper[k];
    }
    tree->node_count = 1;
    build_node(&build, 0, 0, face_count);
    *out = tree;
done:
    starg_release(context, build.centroids);
    if (status != STARG_OK)
        bvh_free(tree);
    return status;
}

void bvh_free(bvh *tree) {
    if (tree == NULL)
        return;
    RELEASE(tree->nodes, tree->order, tree);
}

bool bvh_query(const bvh *tree, bvh_box_test *may_meet, void *test_user, bvh_visit_rank *visit,
               void *visit_user) {
    uint32_t stack[STACK_SIZE];
    int depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
        const bvh_node *node = &tree->nodes[stack[--depth]];
        if (!may_meet(test_user, &node->box))
            continue;
        if (node->count == 0 && tree->triangle_count > LEAF_SIZE) {
            stack[depth++] = node->first + 1;
            stack[depth++] = node->first;
            continue;
        }
        for (uint32_t i = node->first; i < node->first + node->count; i++)
            if (!visit(visit_user, i))
                return false;
    }
    return true;
}

typedef struct box_query {
    const bvh *tree;
    const bvh_box *box;
    bvh_visit *visit;
    void *user;
} box_query;

static bool box_may_meet(void *user, const bvh_box *box) {
    const box_query *query = user;
    return bvh_boxes_meet(query->box, box);
}

static bool visit_if_met(void *user, size_t rank) {
    const box_query *query = user;
    bvh_box own = triangle_box(query->tree, query->tree->order[rank]);
    return !bvh_boxes_meet(&own, query->box) || query->visit(query->user, query->tree->order[rank]);
}

bool bvh_query_box(const bvh *tree, const bvh_box *box, bvh_visit *visit, void *user) {
    box_query query = {tree, box, visit, user};
    return bvh_query(tree, box_may_meet, &query, visit_if_met, &query);
}

typedef struct pair_query {
    bvh_visit_pair *visit;
    void *user;
    uint32_t triangle;
} pair_query;

static bool visit_later(void *user, uint32_t other) {
    pair_query *query = user;
    return other <= query->triangle || query->visit(query->user, query->triangle, other);
}

bool bvh_query_pairs_of(const bvh *tree, uint32_t triangle, bvh_visit_pair *visit, void *user) {
    pair_query query = {visit, user, triangle};
    bvh_box box = triangle_box(tree, triangle);
    return bvh_query_box(tree, &box, visit_later, &query);
}

bool bvh_query_pairs(const bvh *tree, bvh_visit_pair *visit, void *user) {
    for (size_t f = 0; f < tree->triangle_count; f++)
        if (!bvh_query_pairs_of(tree, (uint32_t)f, visit, user))
            return false;
    return true;
}

/* Of points p[0] .. p[count - 1], the tests look at p[0] + e (p[1] - p[0]) + e^2 (p[2] - p[0]) for
 * all small e > 0: an affine function has the sign there of its first value that is not 0. */

/* Where the upward line from there passes edge a b in projection: 1 if on its left. It is perturbed
 * by (d, d^2) for still smaller d, so that it never passes through the edge. */
static int perturbed_turn(const double a[3], const double b[3], const double *const *p, int count) {
    int turn = 0;
    for (int i = 0; i < count && turn == 0; i++)
        turn = orient2d(a, b, p[i], 0, 1);
    if (turn == 0)
        turn = (a[1] > b[1]) - (a[1] < b[1]);
    if (turn == 0)
        turn = (b[0] > a[0]) - (b[0] < a[0]);
    return turn;
}

static int crossing(const bvh *tree, uint32_t triangle, const double *const *p, int count) {
    const double *a = corner(tree, triangle, 0);
    const double *b = corner(tree, triangle, 1);
    const double *c = corner(tree, triangle, 2);
    int ab = perturbed_turn(a, b, p, count), bc = perturbed_turn(b, c, p, count);
    if (ab == 0 || ab != bc || bc != perturbed_turn(c, a, p, count))
        return 0;
    /* The triangle is not vertical, and ab tells whether it faces up. */
    int side = 0;
    for (int i = 0; i < count && side == 0; i++)
        side = orient3d(a, b, c, p[i]);
    return side * ab > 0 ? ab : 0;
}

int bvh_crossing(const bvh *tree, uint32_t triangle, const double p[3]) {
    return crossing(tree, triangle, &p, 1);
}

int bvh_crossing_beside(const bvh *tree, uint32_t triangle, const double *const p[3]) {
    return crossing(tree, triangle, p, 3);
}

typedef struct winding_query {
    const bvh *tree;
    const double *p;
    int winding;
    bool on_surface;
} winding_query;

static bool add_crossing(void *user, uint32_t triangle) {
    winding_query *query = user;
    query->winding += bvh_crossing(query->tree, triangle, query->p);
    query->on_surface =
        query->on_surface ||
        point_on_triangle(query->p, corner(query->tree, triangle, 0),
                          corner(query->tree, triangle, 1), corner(query->tree, triangle, 2));
    return true;
}

int bvh_winding(const bvh *tree, const double p[3], bool *on_surface) {
    winding_query query = {.tree = tree, .p = p};
    bvh_box line = {{p[0], p[1], p[2]}, {p[0], p[1], INFINITY}};
    bvh_query_box(tree, &line, add_crossing, &query);
    *on_surface = query.on_surface;
    return query.winding;
}

int bvh_covers_beside(const bvh *tree, uint32_t triangle, const double *const p[3]) {
    const double *t[3];
    int u = 0, turn = 0, other = 0;
    for (int k = 0; k < 3; k++)
        t[k] = corner(tree, triangle, k);
    for (int i = 0; i < 3; i++)
        if (orient3d(t[0], t[1], t[2], p[i]) != 0)
            return 0;
    for (; u < 3 && turn == 0; u += turn == 0)
        turn = orient2d(t[0], t[1], t[2], u, (u + 1) % 3);
    for (int k = 0; k < 3 && turn != 0; k++) {
        int side = 0;
        for (int i = 0; i < 3 && side == 0; i++)
            side = orient2d(t[k], t[(k + 1) % 3], p[i], u, (u + 1) % 3);
        turn = side == turn ? turn : 0;
    }
    if (turn != 0)
        other = orient2d(p[0], p[1], p[2], u, (u + 1) % 3);
    return turn * other;
}

typedef struct beside_query {
    const bvh *tree;
    const double *p[3];
    int winding, layers;
} beside_query;

static bool add_crossing_beside(void *user, uint32_t triangle) {
    beside_query *query = user;
    query->winding += bvh_crossing_beside(query->tree, triangle, query->p);
    query->layers += bvh_covers_beside(query->tree, triangle, query->p);
    return true;
}

/* The upward line begins above the triangle, or beside a vertical one, as perturbed_turn says. If
 * that is the outer side, the triangle, and others on it, are between there and the inner one. */
int bvh_winding_behind(const bvh *tree, uint32_t triangle, int k) {
    beside_query query = {.tree = tree};
    for (int i = 0; i < 3; i++)
        query.p[i] = corner(tree, triangle, (k + i) % 3);
    const double *p = query.p[0];
    const bvh_box line = {{p[0], p[1], p[2]}, {p[0], p[1], INFINITY}};
    int up = 0;
    for (int u = 0; u < 3 && up == 0; u++)
        up = orient2d(query.p[0], query.p[1], query.p[2], u, (u + 1) % 3);
    bvh_query_box(tree, &line, add_crossing_beside, &query);
    return up > 0 ? query.winding + query.layers : query.winding;
}

/* A segment p + t d, 0 <= t <= 1, prepared for slab tests. */
typedef struct slab_segment {
    double origin[3], extent[3], inverse[3];
    bool flat[3]; /* the extent is zero or its inverse overflows */
    bool any_flat;
} slab_segment;

static slab_segment slab_prepare(const double p[3], const double q[3]) {
    slab_segment s = {.any_flat = false};
    for (int k = 0; k < 3; k++) {
        double d = q[k] - p[k];
        s.origin[k] = p[k];
        s.extent[k] = d;
        s.inverse[k] = d == 0 ? 0 : 1 / d;
        s.flat[k] = d == 0 || isinf(s.inverse[k]);
        s.any_flat = s.any_flat || s.flat[k];
    }
    return s;
}

/* Does the box miss the segment along a flat axis? */
static inline bool slab_misses_flat(const slab_segment *s, const bvh_box *box, double pad) {
    for (int k = 0; k < 3; k++)
        if (s->flat[k] && (box->lower[k] - pad - s->origin[k] > fmax(s->extent[k], 0) ||
                           box->upper[k] + pad - s->origin[k] < fmin(s->extent[k], 0)))
            return true;
    return false;
}

/* Conservative: true whenever the exact segment meets the box, larger by `pad` on all sides, which
 * it enters at *at. Each bound has at most three roundings, a relative error below 4 x 2^-53; a pad
 * is twice what is needed, which covers its own. */
static inline bool slab_meets(const slab_segment *s, const bvh_box *box, double pad, double *at) {
    double enter = 0, leave = 1;
    *at = 0;
    if (s->any_flat && slab_misses_flat(s, box, pad))
        return false;
    for (int k = 0; k < 3; k++) {
        double t0 = (box->lower[k] - pad - s->origin[k]) * s->inverse[k];
        double t1 = (box->upper[k] + pad - s->origin[k]) * s->inverse[k];
        double near = t0 < t1 ? t0 : t1, far = t0 < t1 ? t1 : t0;
        if (s->flat[k])
            continue;
        enter = near > enter ? near : enter;
        leave = far < leave ? far : leave;
    }
    *at = enter;
    return enter <= leave * (1 + 0x1p-48) + 0x1p-1000;
}

/* The nearer child first: most segments that are stopped are stopped near p. */
static inline __attribute__((always_inline)) bool walk_segment(const bvh *tree, const double p[3],
                                                               const double q[3], double pad,
                                                               bvh_visit_rank *visit, void *user) {
    const slab_segment segment = slab_prepare(p, q);
    const bvh_node *stack[STACK_SIZE];
    stack[0] = &tree->nodes[0];
    double at[2];
    int depth = slab_meets(&segment, &tree->nodes[0].box, pad, at);
    while (depth > 0) {
        const bvh_node *node = stack[--depth];
        if (node->count == 0 && tree->triangle_count > LEAF_SIZE) {
            const bvh_node *child = &tree->nodes[node->first];
            bool meets[2] = {slab_meets(&segment, &child[0].box, pad, &at[0]),
                             slab_meets(&segment, &child[1].box, pad, &at[1])};
            int near = at[1] < at[0];
            if (meets[1 - near])
                stack[depth++] = &child[1 - near];
            if (meets[near])
                stack[depth++] = &child[near];
            continue;
        }
        for (uint32_t i = node->first; i < node->first + node->count; i++)
            if (!visit(user, i))
                return false;
    }
    return true;
}

bool bvh_query_segment(const bvh *tree, const double p[3], const double q[3], bvh_visit_rank *visit,
                       void *user) {
    return walk_segment(tree, p, q, 0, visit, user);
}

bool bvh_query_near_segment(const bvh *tree, const double p[3], const double q[3], double pad,
                            bvh_visit_rank *visit, void *user) {
    return walk_segment(tree, p, q, 2 * pad, visit, user);
}

/* The point of the segment a b nearest to p; returns its squared distance. */
static double segment_nearest(const double p[3], const double a[3], const double b[3],
                              double out[3]) {
    double ab[3], ap[3];
    vec3_subtract(b, a, ab);
    vec3_subtract(p, a, ap);
    double length = vec3_dot(ab, ab);
    double t = length > 0 ? vec3_dot(ap, ab) / length : 0;
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    vec3_along(a, t, ab, out);
    return vec3_distance_squared(p, out);
}

/* The same for a triangle: the foot of the perpendicular if it lies inside, else on an edge. */
static double triangle_nearest(const double p[3], const double *const corners[4], double out[3]) {
    double n[3], ap[3], s[3];
    vec3_triangle_normal(corners[0], corners[1], corners[2], n);
    vec3_subtract(p, corners[0], ap);
    double square = vec3_dot(n, n);
    bool inside = square > 0;
    for (int k = 0; k < 3 && inside; k++) {
        double edge[3], to_p[3];
        vec3_subtract(corners[k + 1], corners[k], edge);
        vec3_subtract(p, corners[k], to_p);
        vec3_cross(edge, to_p, s);
        inside = vec3_dot(s, n) >= 0;
    }
    if (inside) {
        double height = vec3_dot(ap, n);
        vec3_along(p, -height / square, n, out);
        return height * height / square;
    }
    double best = INFINITY;
    for (int k = 0; k < 3; k++) {
        double foot[3] = {0}, d = segment_nearest(p, corners[k], corners[k + 1], foot);
        if (d < best) {
            best = d;
            vec3_copy(foot, out);
        }
    }
    return best;
}

static double box_distance_squared(const double p[3], const bvh_box *box) {
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        double d = fmax(0, fmax(box->lower[k] - p[k], p[k] - box->upper[k]));
        sum += d * d;
    }
    return sum;
}

/* Sets the nearest point and its triangle, if there are triangles; returns its squared distance. */
static double nearest_squared(const bvh *tree, const double p[3], double out[3],
                              uint32_t *nearest) {
    uint32_t stack[STACK_SIZE];
    int depth = 0;
    double best = INFINITY;
    stack[depth++] = 0;
    while (depth > 0) {
        const bvh_node *node = &tree->nodes[stack[--depth]];
        if (box_distance_squared(p, &node->box) >= best)
            continue;
        if (node->count == 0 && tree->triangle_count > LEAF_SIZE) {
            double left = box_distance_squared(p, &tree->nodes[node->first].box);
            double right = box_distance_squared(p, &tree->nodes[node->first + 1].box);
            stack[depth++] = left < right ? node->first + 1 : node->first;
            stack[depth++] = left < right ? node->first : node->first + 1;
            continue;
        }
        for (uint32_t i = node->first; i < node->first + node->count; i++) {
            uint32_t triangle = tree->order[i];
            const double *const corners[4] = {corner(tree, triangle, 0), corner(tree, triangle, 1),
                                              corner(tree, triangle, 2), corner(tree, triangle, 0)};
            double foot[3] = {0}, d = triangle_nearest(p, corners, foot);
            if (d < best) {
                best = d;
                *nearest = triangle;
                vec3_copy(foot, out);
            }
        }
    }
    return best;
}

double bvh_distance(const bvh *tree, const double p[3]) {
    double foot[3];
    uint32_t triangle;
    return sqrt(nearest_squared(tree, p, foot, &triangle));
}

void bvh_nearest(const bvh *tree, const double p[3], double out[3]) {
    uint32_t triangle;
    vec3_copy(p, out);
    nearest_squared(tree, p, out, &triangle);
}

uint32_t bvh_nearest_triangle(const bvh *tree, const double p[3]) {
    double foot[3];
    uint32_t triangle = 0;
    nearest_squared(tree, p, foot, &triangle);
    return triangle;
}
