/* SPDX-License-Identifier: Apache-2.0 */
/* Visibility by counting the layers in front of each vertex, which change only at contours: Appel's
 * quantitative invisibility [A. Appel, The notion of quantitative invisibility and the machine
 * rendering of solids, ACM 1967], made exact.
 *
 * Let p lie strictly inside a solid with an embedded boundary M. A face is front-facing if p lies
 * strictly on its inner side; K is the union of the front-facing faces; a contour is an edge
 * between a front-facing face and one that is not. For x on M let N(x) be the number of points of K
 * before x, on the open segment from p to x. By the proof in scene.h, p sees the vertex v exactly
 * if N(v) = 0.
 *
 * Change of N along an edge of M from w to v that is not collinear with p:
 * - Between the ends. A point of K before x that is off the contours persists when x moves a
 *   little: there K is a surface that the directions from p map injectively (at a vertex because a
 *   simple closed curve on a sphere winds around a point at most once). Points of K near x lie on
 *   the two faces of the edge, by embedding, and the planes of front-facing ones contain neither p
 *   nor points before x. So N changes only where a contour passes before x. Where the contour (a,
 *   b) crosses the plane of p, w, v there, N grows by one towards the side of its front-facing
 *   face, and falls on the other side.
 * - At an end w. Leaving w, N also counts the points of K that converge to w: on front-facing faces
 *   (w, a, b) off the edge whose wedge, seen from p, contains the start of the edge, and which lie
 *   before it. If all faces at w are front-facing, or none, there are no such points; otherwise
 *   they are counted.
 * So N of one vertex per shell determines N along the edges of a tree. The first is counted by the
 * BVH. Vertices without front-facing faces are hidden; only tree edges that lead to other vertices
 * are followed. The tree is chosen to have short edges, few of which start on contours, where
 * points of K would have to be counted (visibility/contours_forest.h).
 *
 * With det(x, y, z) for vectors relative to p, and the contour (a, b) with its front-facing face on
 * the left:
 * - it crosses the tree edge from w to v if det(w, v, a) and det(a, b, v) have one sign and det(w,
 *   v, b) and det(a, b, w) the other (otherwise their planes cross on opposite sides of p, or not
 *   between the ends). It lies before the tree edge if orient3d(v, a, b, w) has the sign of det(w,
 *   v, b). The step is the sign of det(a, b, v).
 * - front-facing faces count at w if det(w, v, a) < 0, det(w, v, b) > 0 and v lies beyond their
 *   plane.
 * Signs that floating point does not decide are decided exactly. If a relevant one is 0, p is in a
 * special position (a contour behind or before a vertex, or an edge in a plane with p), and the
 * grid computes p; likewise if the boundary is not embedded, or tables would grow out of proportion
 * to the mesh.
 *
 * Stages for a point p:
 *   1. find the contours;
 *   2. choose the tree edges;
 *   3. project all vertices to the faces of a cube around p; sort the contours' projections into
 *      rows of cells there by counting;
 *   4. follow each tree edge: compare it with the contours in the cells that it touches, first in
 *      single precision with an error bound; count at ends that lie on contours;
 *   5. sum along the trees.
 * Cells only select what is compared, with a margin above the rounding of the projection.
 *
 * Cost per point: O(n), plus the pairs of tree edges and contours in common cells; contours are few
 * on smooth fine meshes, O(sqrt(n)). Memory per thread: 250 bytes a vertex, the grid included. */
#include "visibility/contours.h"

#include <stdlib.h>

#include "geometry/predicates.h"

static void free_scratch(const visibility_scene *scene, void *scratch) {
    contours_scratch *s = scratch;
    if (s == NULL)
        return;
    visibility_grid.free_scratch(scene, s->grid);
    cube_free(&s->directions);
    RELEASE(s->grade, s->followed, s->parent, s->tree_edges, s->contours, s->contour_edges, s->rows,
            s->cell_start, s->pieces, s->sorted.low, s->sorted.a, s->layers, s);
}

/* The columns are in two blocks, of reals and of integers. */
static bool make_piece_table(starg_context *context, size_t limit, piece_table *table) {
    float *reals = starg_allocate_zero(context, 8 * limit, sizeof *reals);
    uint32_t *numbers = starg_allocate_zero(context, 3 * limit, sizeof *numbers);
    table->low = reals;
    table->a = numbers;
    if (reals == NULL || numbers == NULL)
        return false;
    table->high = reals + limit;
    table->au = reals + 2 * limit;
    table->av = reals + 3 * limit;
    table->an = reals + 4 * limit;
    table->bu = reals + 5 * limit;
    table->bv = reals + 6 * limit;
    table->bn = reals + 7 * limit;
    table->b = numbers + limit;
    table->label = numbers + 2 * limit;
    return true;
}

static bool make_tables(const visibility_scene *scene, contours_scratch *s) {
    starg_context *context = scene->context;
    size_t n = scene->vertex_count;
    s->contour_limit = n + 64 < PIECE_NUMBER ? n + 64 : PIECE_NUMBER;
    s->piece_limit = 4 * n + 1024;
    s->row_limit = s->contour_limit / ROW_LOAD + CUBE_FACES + 1;
    s->cell_limit = s->piece_limit + s->row_limit + 1;
    s->grade = starg_allocate(context, n, sizeof *s->grade);
    s->followed = starg_allocate(context, n, sizeof *s->followed);
    s->parent = starg_allocate(context, n, sizeof *s->parent);
    s->tree_edges = starg_allocate(context, n + 1, sizeof *s->tree_edges);
    s->contours = starg_allocate(context, s->contour_limit, sizeof *s->contours);
    s->contour_edges = starg_allocate(context, s->contour_limit, sizeof *s->contour_edges);
    s->rows = starg_allocate(context, s->row_limit, sizeof *s->rows);
    s->cell_start = starg_allocate(context, s->cell_limit, sizeof *s->cell_start);
    s->pieces = starg_allocate(context, s->piece_limit, sizeof *s->pieces);
    s->layers = starg_allocate(context, n, sizeof *s->layers);
    return cube_make(context, n, &s->directions) && s->grade && s->followed && s->parent &&
           s->tree_edges && s->contours && s->contour_edges && s->rows && s->cell_start &&
           s->pieces && s->layers &&
           make_piece_table(context, s->piece_limit + PIECE_PADDING, &s->sorted);
}

static starg_status make_scratch(const visibility_scene *scene, void **scratch) {
    contours_scratch *s = starg_allocate_zero(scene->context, 1, sizeof *s);
    *scratch = NULL;
    if (s == NULL)
        return STARG_ERROR_MEMORY;
    starg_status status = visibility_grid.make_scratch(scene, &s->grid);
    if (status == STARG_OK && scene->adjacency != NULL && !make_tables(scene, s))
        status = STARG_ERROR_MEMORY;
    if (status != STARG_OK) {
        free_scratch(scene, s);
        return status;
    }
    s->variant = contours_choose_variant(ISA_WIDEST);
    *scratch = s;
    return STARG_OK;
}

const contours_variant *contours_choose_variant(visibility_isa wanted) {
    static const contours_variant *const variants[] = {
        &contours_plain,
#if defined(__aarch64__)
        &contours_neon,
#elif defined(__x86_64__)
        &contours_avx2,
        &contours_avx512,
#endif
    };
    wanted = isa_resolve(wanted);
    return isa_is_supported(wanted) ? variants[wanted] : NULL;
}

typedef struct layer_query {
    const visibility_scene *scene;
    const double *p, *q;
    const int8_t *side;
    uint32_t slot;
    int32_t layers;
} layer_query;

/* Does the segment to q pass through the interior of a front-facing face? It must not touch its
 * border. */
static bool count_layer(void *user, size_t rank) {
    layer_query *query = user;
    const double *p = query->p, *q = query->q;
    if (query->side[rank] <= 0 || scene_has_corner(query->scene, rank, query->slot))
        return true;
    const double *a = scene_corner(query->scene, rank, 0);
    const double *b = scene_corner(query->scene, rank, 1);
    const double *c = scene_corner(query->scene, rank, 2);
    if (orient3d(a, b, c, q) >= 0)
        return true;
    int ab = orient3d(a, b, q, p), bc = orient3d(b, c, q, p), ca = orient3d(c, a, q, p);
    if (ab < 0 || bc < 0 || ca < 0)
        return true;
    query->layers++;
    return ab > 0 && bc > 0 && ca > 0;
}

bool contours_count_layers(const visibility_scene *scene, const double p[3], const int8_t *side,
                           uint32_t slot, int32_t *layers) {
    const double q[3] = {scene->x[slot], scene->y[slot], scene->z[slot]};
    layer_query query = {scene, p, q, side, slot, 0};
    bool clear = bvh_query_segment(scene->solid->tree, p, q, count_layer, &query);
    *layers = query.layers;
    return clear;
}

static void find(const visibility_scene *scene, void *scratch, const double p[3],
                 const int8_t *side, const scene_view *view, uint8_t *visible) {
    contours_scratch *s = scratch;
    s->decided = scene->adjacency != NULL && s->variant->run(scene, s, p, side, visible);
    if (!s->decided)
        visibility_grid.find(scene, s->grid, p, side, view, visible);
}

static bool sees_plainly(const visibility_scene *scene, void *scratch, size_t rank) {
    contours_scratch *s = scratch;
    return s->decided && !s->variant->may_cover(scene, s, rank);
}

const visibility_engine visibility_contours = {make_scratch, free_scratch, find, sees_plainly};
