/* SPDX-License-Identifier: Apache-2.0 */
/* Two solids with the same faces, cut alike into pieces that are star-shaped in both, and filled by
 * cones.
 *
 * Problem: a triangulated sphere lies in two places, and bounds a solid in each. Fill both with the
 * same tetrahedra, positive in both. No tetrahedra are given: nothing inside has to be unfolded.
 *
 * Method: the boundary of a piece is a triangulated sphere in both places. One with a kernel in
 * both is done: it is filled by cones from a point of each. Any other is cut. In one of the places
 * where it has no kernel, a plane is sought after which two guards miss the least of it
 * (star/strict/search/split_plane.c). Edges that cross the plane are divided, in the other place in
 * the same ratio, so that the plane meets the piece in loops of edges; each is spanned in both
 * places by a fan about a new vertex, a wall of the two pieces that the loop parts. The fan is flat
 * in the one place and nearly flat in the other.
 *
 * Invariants: triangles fit together, edge to edge, in all pieces: an edge is divided in all of its
 * triangles. Whether walls stay inside the solid is never asked: pieces with kernels on all sides
 * are proof enough, since tetrahedra that are positive in a place, with the surface there as their
 * boundary, fill the solid once. All signs of results are exact.
 *
 * Cost: for each cut a plane search and a few passes over the piece. */
#include "star/compatible/compatible.h"

#include <stdlib.h>

#include "geometry/intersect.h"
#include "geometry/linear_program.h"
#include "geometry/predicates.h"
#include "geometry/vec3.h"
#include "star/compatible/twin_region.h"
#include "star/strict/search/search.h"

static const char STAGE[] = "cones";

enum { ROUNDS = 6, WORK_MOST = 200000 };
enum { SEARCHED = 4 }; /* one cut of so many is by a search, the others are random */
enum {
    PLANES = 8,
    PLANES_MOST = 24,
    WORK = 20000,
    BENDS = 2
}; /* cuts that are looked at, and between both ends */
enum {
    FAIR_FROM = 2,
    HALVE_FROM = 5,
    TIGHT_FROM = 8,
    ATTEMPTS_MOST = 16,
    EFFORT = 1,
    GROWTH_MOST = 8
};
static const double MARGIN = 2e-5;              /* of the extent, for guards of the plane search */
static const double ROOMY = 0.02, TIGHT = 1e-6; /* of hubs, over the extents of loops */
static const double SHORT = 1e-7;               /* of a spoke: it ends on the surface */
static const double SNAP = 0.02; /* of an edge: a cut that near an end goes through it */

#define NOWHERE UINT32_MAX

typedef STARG_ARRAY(uint32_t) number_list;

typedef struct cone_piece {
    number_list triangles;
    int attempts;
    bool done;
    double centers[2][3];
} cone_piece;

typedef struct cone_builder {
    starg_context *context;
    STARG_ARRAY(double) places[2];  /* x 3 */
    STARG_ARRAY(number_list) about; /* per vertex: triangles; some have left it */
    number_list corners;            /* x 3 */
    number_list sides;              /* x 2: the pieces before and behind a triangle, or NOWHERE */
    STARG_ARRAY(cone_piece) pieces;
    STARG_ARRAY(double) heights; /* per vertex, of the piece that is cut */
    region_scratch scratch;
    starg_rng rng;
    size_t work; /* faces of pieces for which cuts were sought, in all rounds */
} cone_builder;

static void builder_free(cone_builder *b) {
    for (int end = 0; end < 2; end++)
        STARG_ARRAY_FREE(b->context, &b->places[end]);
    for (size_t v = 0; v < b->about.count; v++)
        STARG_ARRAY_FREE(b->context, &b->about.data[v]);
    for (size_t p = 0; p < b->pieces.count; p++)
        STARG_ARRAY_FREE(b->context, &b->pieces.data[p].triangles);
    RELEASE(b->about.data, b->corners.data, b->sides.data, b->pieces.data, b->heights.data);
    region_scratch_free(&b->scratch);
}

static const double *place_of(const cone_builder *b, int end, uint32_t vertex) {
    return b->places[end].data + 3 * (size_t)vertex;
}

static uint32_t b_side(const cone_builder *b, uint32_t triangle, size_t side) {
    return b->sides.data[2 * (size_t)triangle + side];
}

/* The corners of a triangle, counter-clockwise seen from outside of the piece. */
static void corners_of(const cone_builder *b, uint32_t triangle, uint32_t which, uint32_t out[3]) {
    bool turned = b->sides.data[2 * (size_t)triangle] != which;
    for (size_t k = 0; k < 3; k++)
        out[k] = b->corners.data[3 * (size_t)triangle + (turned ? 2 - k : k)];
}

/* ---- building ---- */

static starg_status add_vertex(cone_builder *b, const double from[2][3], uint32_t *out) {
    *out = (uint32_t)b->about.count;
    for (int end = 0; end < 2; end++)
        for (int k = 0; k < 3; k++)
            PUSH(b->context, STAGE, &b->places[end], from[end][k]);
    PUSH(b->context, STAGE, &b->about, ((number_list){0}));
    PUSH(b->context, STAGE, &b->heights, 0);
    return STARG_OK;
}

static starg_status add_triangle(cone_builder *b, const uint32_t corners[3],
                                 const uint32_t sides[2]) {
    uint32_t number = (uint32_t)(b->corners.count / 3);
    for (int k = 0; k < 3; k++) {
        PUSH(b->context, STAGE, &b->corners, corners[k]);
        PUSH(b->context, STAGE, &b->about.data[corners[k]], number);
    }
    for (int s = 0; s < 2; s++) {
        PUSH(b->context, STAGE, &b->sides, sides[s]);
        if (sides[s] != NOWHERE)
            PUSH(b->context, STAGE, &b->pieces.data[sides[s]].triangles, number);
    }
    return STARG_OK;
}

/* The place of a corner in a triangle; -1: it is none of it. */
static int corner_at(const cone_builder *b, uint32_t triangle, uint32_t vertex) {
    for (int k = 0; k < 3; k++)
        if (b->corners.data[3 * (size_t)triangle + (size_t)k] == vertex)
            return k;
    return -1;
}

/* Divides an edge in all its triangles; `share` of the way from u to v. */
static starg_status split_edge(cone_builder *b, uint32_t u, uint32_t v, double share) {
    double middle[2][3];
    uint32_t fresh;
    for (int end = 0; end < 2; end++)
        for (int k = 0; k < 3; k++)
            middle[end][k] = (1 - share) * place_of(b, end, u)[k] + share * place_of(b, end, v)[k];
    TRY(add_vertex(b, (const double(*)[3])middle, &fresh));
    for (size_t i = 0, count = b->about.data[u].count; i < count; i++) {
        uint32_t t = b->about.data[u].data[i], corners[3];
        int at = corner_at(b, t, u), other = corner_at(b, t, v);
        if (at < 0 || other < 0)
            continue;
        const uint32_t sides[2] = {b->sides.data[2 * (size_t)t], b->sides.data[2 * (size_t)t + 1]};
        memcpy(corners, b->corners.data + 3 * (size_t)t, sizeof corners);
        b->corners.data[3 * (size_t)t + (size_t)other] = fresh;
        PUSH(b->context, STAGE, &b->about.data[fresh], t);
        corners[at] = fresh;
        TRY(add_triangle(b, corners, sides));
    }
    return STARG_OK;
}

static starg_status open_piece(cone_builder *b, int attempts, uint32_t *out) {
    *out = (uint32_t)b->pieces.count;
    PUSH(b->context, STAGE, &b->pieces, ((cone_piece){.attempts = attempts}));
    return STARG_OK;
}

static starg_status begin(cone_builder *b, const double *const places[2], size_t vertices,
                          const uint32_t *faces, size_t count) {
    uint32_t whole, number;
    TRY(open_piece(b, 0, &whole));
    for (size_t v = 0; v < vertices; v++) {
        double from[2][3];
        for (int end = 0; end < 2; end++)
            vec3_copy(places[end] + 3 * v, from[end]);
        TRY(add_vertex(b, (const double(*)[3])from, &number));
    }
    for (size_t f = 0; f < count; f++) {
        const uint32_t sides[2] = {whole, NOWHERE};
        TRY(add_triangle(b, faces + 3 * f, sides));
    }
    return STARG_OK;
}

/* ---- kernels ---- */

static starg_status list_faces(const cone_builder *b, uint32_t which, number_list *out) {
    const number_list *own = &b->pieces.data[which].triangles;
    out->count = 0;
    for (size_t i = 0; i < own->count; i++) {
        uint32_t corners[3];
        corners_of(b, own->data[i], which, corners);
        for (int k = 0; k < 3; k++)
            PUSH(b->context, STAGE, out, corners[k]);
    }
    return STARG_OK;
}

static starg_status find_centers(cone_builder *b, uint32_t which, const number_list *faces,
                                 int *blind) {
    const size_t count = faces->count / 3;
    const kernel_faces surfaces[2] = {{b->places[0].data, faces->data, count},
                                      {b->places[1].data, faces->data, count}};
    cone_piece *own = &b->pieces.data[which];
    TRY(twin_kernels(b->context, surfaces, &b->rng, own->centers, blind));
    own->done = *blind < 0;
    return STARG_OK;
}

/* ---- heights ---- */

/* Heights of the piece's vertices over a plane of one place. */
static void find_heights(cone_builder *b, int end, const number_list *faces, const double normal[3],
                         const double point[3], double *out) {
    double offset = vec3_dot(normal, point);
    for (size_t i = 0; i < faces->count; i++)
        out[faces->data[i]] = vec3_dot(normal, place_of(b, end, faces->data[i])) - offset;
}

/* Over a plane that leaves less of the piece unseen in one place. */
static starg_status search_plane(cone_builder *b, uint32_t which, int end, const number_list *faces,
                                 double *heights, bool *found) {
    int attempts = b->pieces.data[which].attempts;
    const double *places = b->places[end].data;
    const twin_frame frame = twin_frame_of(places, faces->data, faces->count);
    const split_plane_options options = {.margin = MARGIN,
                                         .effort = EFFORT,
                                         .demand = attempts < FAIR_FROM    ? SPLIT_PLANE_GAIN
                                                   : attempts < HALVE_FROM ? SPLIT_PLANE_FAIR
                                                                           : SPLIT_PLANE_HALVE};
    SCOPED_BY(region_free) region r = {.vertices = {0}};
    partition_plane plane;
    TRY(twin_region(b->context, places, b->about.count, faces->data, faces->count, &frame, &r));
    TRY(split_plane_find(&r, &options, &b->rng, &b->scratch, &plane, found));
    if (*found) {
        double point[3];
        for (int k = 0; k < 3; k++)
            point[k] = frame.origin[k] + plane.normal[k] * plane.offset / frame.scale;
        find_heights(b, end, faces, plane.normal, point, heights);
    }
    return STARG_OK;
}

/* Over a random plane, between two of its corners. */
static void draw_plane(cone_builder *b, int end, const number_list *faces, double *heights) {
    const double *ends[2];
    double normal[3], noise[3], middle[3];
    for (int i = 0; i < 2; i++)
        ends[i] = place_of(b, end, faces->data[starg_rng_below(&b->rng, faces->count)]);
    vec3_subtract(ends[1], ends[0], normal);
    starg_rng_direction(&b->rng, noise);
    vec3_along(normal, 0.5 * vec3_length(normal), noise, normal);
    double share = starg_rng_unit(&b->rng);
    for (int k = 0; k < 3; k++)
        middle[k] = (1 - share) * ends[0][k] + share * ends[1][k];
    find_heights(b, end, faces, normal, middle, heights);
}

/* Cuts near an end of an edge go through it. */
static void snap(const number_list *faces, double *heights) {
    for (size_t i = 0; i < faces->count; i++) {
        double *p = &heights[faces->data[i]],
               *q = &heights[faces->data[i % 3 == 2 ? i - 2 : i + 1]];
        if (*p * *q >= 0)
            continue;
        double share = *p / (*p - *q);
        if (share < SNAP)
            *p = 0;
        else if (share > 1 - SNAP)
            *q = 0;
    }
}

/* ---- loops ---- */

/* A directed edge of a piece's boundary, and the triangle to its left. */
typedef struct side_edge {
    uint64_t edge;
    uint32_t triangle;
} side_edge;

typedef STARG_ARRAY(side_edge) edge_list;

/* Where a cut passes: a vertex, or a point of an edge. */
typedef struct cut_node {
    uint32_t from, to; /* NOWHERE: at the vertex */
    double share;      /* of the way */
} cut_node;

/* Loops, with what is above on the left. */
typedef struct cut_loops {
    STARG_ARRAY(cut_node) nodes; /* one loop after the other */
    number_list lengths;
    STARG_ARRAY(double) rooms; /* of hubs, the least of both places; 0: there is none inside */
} cut_loops;

static void loops_free(cut_loops *loops) {
    RELEASE(loops->nodes.data, loops->lengths.data, loops->rooms.data);
}

static uint64_t edge_name(uint32_t u, uint32_t v) {
    return (uint64_t)u << 32 | v;
}

static int by_edge(const void *left, const void *right) {
    const side_edge *a = left, *b = right;
    return (a->edge > b->edge) - (a->edge < b->edge);
}

/* All of a piece, ascending. */
static starg_status list_edges(const cone_builder *b, uint32_t which, edge_list *out) {
    const number_list *own = &b->pieces.data[which].triangles;
    out->count = 0;
    for (size_t i = 0; i < own->count; i++) {
        uint32_t corners[3];
        corners_of(b, own->data[i], which, corners);
        for (int k = 0; k < 3; k++)
            PUSH(b->context, STAGE, out,
                 ((side_edge){edge_name(corners[k], corners[(k + 1) % 3]), own->data[i]}));
    }
    qsort(out->data, out->count, sizeof *out->data, by_edge);
    return STARG_OK;
}

/* The triangle across an edge. */
static uint32_t across(const edge_list *edges, uint32_t u, uint32_t v) {
    const side_edge key = {edge_name(v, u), 0};
    const side_edge *found = bsearch(&key, edges->data, edges->count, sizeof *edges->data, by_edge);
    return found != NULL ? found->triangle : NOWHERE;
}

/* Above (1), below (-1), on (0) the cut, or crossed (2)? */
static int side_of(const uint32_t corners[3], const double *heights) {
    bool above = false, below = false;
    for (int k = 0; k < 3; k++) {
        above = above || heights[corners[k]] > 0;
        below = below || heights[corners[k]] < 0;
    }
    return above && below ? 2 : above ? 1 : below ? -1 : 0;
}

/* A step along a cut: from one node to another. */
typedef struct cut_step {
    cut_node nodes[2];
} cut_step;

static uint64_t node_name(const cut_node *node) {
    if (node->to == NOWHERE)
        return edge_name(node->from, node->from);
    return node->from < node->to ? edge_name(node->from, node->to)
                                 : edge_name(node->to, node->from);
}

static int by_start(const void *left, const void *right) {
    uint64_t a = node_name(&((const cut_step *)left)->nodes[0]);
    uint64_t b = node_name(&((const cut_step *)right)->nodes[0]);
    return (a > b) - (a < b);
}

typedef STARG_ARRAY(cut_step) step_list;

/* The way through a triangle that is crossed: in where it goes down, out where it goes up. */
static cut_step step_through(const uint32_t corners[3], const double *heights) {
    cut_step step = {{{NOWHERE, NOWHERE, 0}, {NOWHERE, NOWHERE, 0}}};
    for (int k = 0; k < 3; k++) {
        uint32_t u = corners[k], v = corners[(k + 1) % 3], w = corners[(k + 2) % 3];
        double p = heights[u], q = heights[v];
        /* with what is above on the left, the cut leaves by the edge that goes down */
        if (p * q < 0)
            step.nodes[p > 0] = (cut_node){u, v, p / (p - q)};
        else if (q == 0 && p * heights[w] < 0)
            step.nodes[p > 0] = (cut_node){v, NOWHERE, 0};
    }
    return step;
}

static starg_status list_steps(const cone_builder *b, uint32_t which, const edge_list *edges,
                               const double *heights, step_list *out) {
    const number_list *own = &b->pieces.data[which].triangles;
    for (size_t i = 0; i < own->count; i++) {
        uint32_t corners[3], other[3];
        corners_of(b, own->data[i], which, corners);
        int side = side_of(corners, heights);
        if (side == 2)
            PUSH(b->context, STAGE, out, step_through(corners, heights));
        for (int k = 0; k < 3 && (side == 1 || side == 0); k++) {
            uint32_t u = corners[k], v = corners[(k + 1) % 3], beyond = across(edges, u, v);
            if (heights[u] != 0 || heights[v] != 0 || beyond == NOWHERE)
                continue;
            corners_of(b, beyond, which, other);
            if (side_of(other, heights) == -1)
                PUSH(b->context, STAGE, out, ((cut_step){{{u, NOWHERE, 0}, {v, NOWHERE, 0}}}));
        }
    }
    if (out->count > 0)
        qsort(out->data, out->count, sizeof *out->data, by_start);
    return STARG_OK;
}

/* Follows the cut. *simple: there is one, and no node is passed twice. */
static starg_status find_loops(const cone_builder *b, uint32_t which, const edge_list *edges,
                               const double *heights, cut_loops *out, bool *simple) {
    SCOPED step_list steps = {0};
    SCOPED uint8_t *passed = NULL;
    out->nodes.count = out->lengths.count = 0;
    TRY(list_steps(b, which, edges, heights, &steps));
    *simple = steps.count > 0;
    for (size_t i = 1; i < steps.count && *simple; i++)
        *simple = by_start(&steps.data[i - 1], &steps.data[i]) != 0;
    NEW_ZERO(b->context, STAGE, passed, steps.count);
    for (size_t first = 0; first < steps.count && *simple; first++) {
        uint32_t length = 0;
        for (size_t at = first; *simple && !passed[at]; length++) {
            const cut_step key = {{steps.data[at].nodes[1], steps.data[at].nodes[1]}};
            passed[at] = 1;
            PUSH(b->context, STAGE, &out->nodes, steps.data[at].nodes[0]);
            const cut_step *after =
                bsearch(&key, steps.data, steps.count, sizeof *steps.data, by_start);
            *simple = after != NULL;
            if (*simple)
                at = (size_t)(after - steps.data);
        }
        if (length > 0)
            PUSH(b->context, STAGE, &out->lengths, length);
        *simple = *simple && length != 1 && length != 2;
    }
    return STARG_OK;
}

/* ---- hubs of walls ---- */

/* A loop in one place. */
typedef struct loop_places {
    STARG_ARRAY(double) points; /* x 3 */
    double normal[3], mean[3], extent;
} loop_places;

static starg_status place_loop(const cone_builder *b, int end, const cut_node *nodes, size_t count,
                               loop_places *out) {
    double sum = 0;
    *out = (loop_places){.points = out->points};
    out->points.count = 0;
    for (size_t i = 0; i < count; i++) {
        const double *p = place_of(b, end, nodes[i].from);
        const double *q = nodes[i].to == NOWHERE ? p : place_of(b, end, nodes[i].to);
        for (int k = 0; k < 3; k++)
            PUSH(b->context, STAGE, &out->points,
                 (1 - nodes[i].share) * p[k] + nodes[i].share * q[k]);
    }
    for (size_t i = 0; i < count; i++) {
        const double *first = out->points.data, *p = first + 3 * i,
                     *q = first + 3 * ((i + 1) % count);
        double u[3], v[3], cross[3], length = vec3_distance(p, q);
        vec3_subtract(p, first, u);
        vec3_subtract(q, first, v);
        vec3_cross(u, v, cross);
        vec3_along(out->normal, 1, cross, out->normal);
        vec3_along(out->mean, 0.5 * length, p, out->mean);
        vec3_along(out->mean, 0.5 * length, q, out->mean);
        sum += length;
    }
    double size = vec3_length(out->normal);
    for (int k = 0; k < 3; k++) {
        out->mean[k] /= sum;
        out->normal[k] /= size > 0 ? size : 1;
    }
    for (size_t i = 0; i < count; i++)
        out->extent = fmax(out->extent, vec3_distance(out->mean, out->points.data + 3 * i));
    return STARG_OK;
}

/* Two directions across a unit normal. */
static void axes_across(const double normal[3], double axes[2][3]) {
    int least = fabs(normal[0]) < fabs(normal[1]) ? 0 : 1;
    least = fabs(normal[2]) < fabs(normal[least]) ? 2 : least;
    const double unit[3] = {least == 0, least == 1, least == 2};
    vec3_cross(normal, unit, axes[0]);
    double length = vec3_length(axes[0]);
    for (int k = 0; k < 3; k++)
        axes[0][k] /= length;
    vec3_cross(normal, axes[0], axes[1]);
}

/* A point from which the loop, seen along its normal, is passed to the left: the one farthest from
 * the lines of its edges, at the height of the mean. Its distance, over the extent; at most 0:
 * there is none. */
static starg_status find_hub(cone_builder *b, const loop_places *loop, double hub[3],
                             double *room) {
    size_t count = loop->points.count / 3;
    double axes[2][3];
    SCOPED double *rows = NULL;
    SCOPED uint32_t *order = NULL;
    linear_solution solution;
    *room = 0;
    if (!(vec3_length(loop->normal) > 0 && loop->extent > 0))
        return STARG_OK;
    axes_across(loop->normal, axes);
    NEW(b->context, STAGE, rows, 4 * count);
    NEW(b->context, STAGE, order, count);
    for (size_t i = 0; i < count; i++) {
        double flat[2][2], *row = rows + 4 * i;
        for (size_t j = 0; j < 2; j++) {
            double p[3];
            vec3_subtract(loop->points.data + 3 * ((i + j) % count), loop->mean, p);
            for (int k = 0; k < 2; k++)
                flat[j][k] = vec3_dot(p, axes[k]) / loop->extent;
        }
        double x = flat[1][0] - flat[0][0], y = flat[1][1] - flat[0][1], side = hypot(x, y);
        row[0] = side > 0 ? y / side : 0;
        row[1] = side > 0 ? -x / side : 0;
        row[2] = 1;
        row[3] = side > 0 ? row[0] * flat[0][0] + row[1] * flat[0][1] : 0;
    }
    const linear_program program = {
        .dimension = 3, .rows = rows, .count = count, .objective = {0, 0, 1}, .radius = 16};
    linear_program_solve(&program, order, NULL, &solution);
    *room = solution.feasible ? solution.point[2] : 0;
    for (int k = 0; k < 3; k++)
        hub[k] = loop->mean[k] +
                 loop->extent * (solution.point[0] * axes[0][k] + solution.point[1] * axes[1][k]);
    return STARG_OK;
}

/* ---- the choice of a cut ---- */

/* Does a spoke of a wall meet the surface? */
typedef struct spoke_test {
    const bvh *tree;
    const double *from, *to;
} spoke_test;

static bool visit_spoke(void *user, size_t rank) {
    const spoke_test *s = user;
    const double *t[3];
    for (size_t k = 0; k < 3; k++)
        t[k] = s->tree->vertices + 3 * (size_t)s->tree->faces[3 * (size_t)s->tree->order[rank] + k];
    return !segment_meets_triangle(s->from, s->to, t[0], t[1], t[2]);
}

/* Is a hub inside, and sees it all nodes of its loop? (Up to SHORT of the way.) */
static bool is_inside(const bvh *tree, const loop_places *loop, const double hub[3]) {
    bool on_surface;
    if (bvh_winding(tree, hub, &on_surface) != 1 || on_surface)
        return false;
    for (size_t i = 0; i < loop->points.count; i += 3) {
        double way[3], end[3];
        vec3_subtract(loop->points.data + i, hub, way);
        vec3_along(hub, 1 - SHORT, way, end);
        spoke_test test = {tree, hub, end};
        if (!bvh_query_segment(tree, hub, end, visit_spoke, &test))
            return false;
    }
    return true;
}

typedef struct cut_choice {
    number_list faces;
    edge_list edges;
    cut_loops loops;
    loop_places places[2];
    bvh *trees[2];   /* of the faces */
    double *heights; /* per vertex: of the cut that is looked at */
    double room;     /* of the best so far, whose heights are the builder's */
} cut_choice;

static void choice_free(cut_choice *c) {
    bvh_free(c->trees[0]);
    bvh_free(c->trees[1]);
    RELEASE(c->faces.data, c->edges.data);
    loops_free(&c->loops);
    RELEASE(c->places[0].points.data, c->places[1].points.data, c->heights);
}

static starg_status make_trees(cone_builder *b, cut_choice *c) {
    for (int end = 0; end < 2; end++) {
        bvh_free(c->trees[end]);
        c->trees[end] = NULL;
        TRY(bvh_create(b->context, b->places[end].data, c->faces.data, c->faces.count / 3,
                       &c->trees[end]));
    }
    return STARG_OK;
}

/* How much room hubs have, in both places. Those of loops that have no more than `least` are not
 * looked at closely. */
static starg_status find_rooms(cone_builder *b, cut_choice *c, double least) {
    const cut_node *nodes = c->loops.nodes.data;
    c->loops.rooms.count = 0;
    for (size_t i = 0; i < c->loops.lengths.count; nodes += c->loops.lengths.data[i++]) {
        double hubs[2][3], most = INFINITY;
        for (int end = 0; end < 2; end++) {
            double room;
            TRY(place_loop(b, end, nodes, c->loops.lengths.data[i], &c->places[end]));
            TRY(find_hub(b, &c->places[end], hubs[end], &room));
            most = fmin(most, room);
        }
        for (int end = 0; end < 2; end++)
            if (most <= least || !is_inside(c->trees[end], &c->places[end], hubs[end]))
                most = 0;
        PUSH(b->context, STAGE, &c->loops.rooms, most);
    }
    return STARG_OK;
}

/* The cut is kept if one of its loops has more room than those before. */
static starg_status weigh(cone_builder *b, uint32_t which, cut_choice *c, bool *simple) {
    double best = 0;
    snap(&c->faces, c->heights);
    TRY(find_loops(b, which, &c->edges, c->heights, &c->loops, simple));
    if (!*simple)
        return STARG_OK;
    TRY(find_rooms(b, c, c->room));
    for (size_t i = 0; i < c->loops.rooms.count; i++)
        best = fmax(best, c->loops.rooms.data[i]);
    if (best > c->room) {
        c->room = best;
        for (size_t i = 0; i < c->faces.count; i++)
            b->heights.data[c->faces.data[i]] = c->heights[c->faces.data[i]];
    }
    return STARG_OK;
}

/* A cut that is nearly flat in both places: between the plane of one, in whose heights it was made,
 * and that of the loop's image in the other. */
static starg_status bend(cone_builder *b, int end, cut_choice *c, double share) {
    const loop_places *own = &c->places[end], *other = &c->places[1 - end];
    SCOPED double *image = NULL;
    NEW(b->context, STAGE, image, b->about.count);
    find_heights(b, end, &c->faces, own->normal, own->mean, c->heights);
    find_heights(b, 1 - end, &c->faces, other->normal, other->mean, image);
    for (size_t i = 0; i < c->faces.count; i++)
        image[c->faces.data[i]] = (1 - share) * c->heights[c->faces.data[i]] / own->extent +
                                  share * image[c->faces.data[i]] / other->extent;
    for (size_t i = 0; i < c->faces.count; i++)
        c->heights[c->faces.data[i]] = image[c->faces.data[i]];
    return STARG_OK;
}

static starg_status choose_cut(cone_builder *b, uint32_t which, int blind, cut_choice *c) {
    TRY(list_edges(b, which, &c->edges));
    NEW(b->context, STAGE, c->heights, b->about.count);
    TRY(make_trees(b, c));
    size_t planes = PLANES + WORK / c->faces.count;
    for (size_t i = 0; i < (planes < PLANES_MOST ? planes : PLANES_MOST); i++) {
        bool found = true;
        int end = blind;
        if (i % SEARCHED == 0)
            TRY(search_plane(b, which, end, &c->faces, c->heights, &found));
        else
            draw_plane(b, end = (int)starg_rng_below(&b->rng, 2), &c->faces, c->heights);
        if (!found)
            continue;
        TRY(weigh(b, which, c, &found));
        for (int k = 1; k <= BENDS && found && c->loops.lengths.count == 1; k++) {
            TRY(bend(b, end, c, k / (double)BENDS));
            TRY(weigh(b, which, c, &found));
        }
    }
    return STARG_OK;
}

/* ---- the cut ---- */

static starg_status split_crossed(cone_builder *b, const number_list *faces) {
    for (size_t i = 0; i < faces->count; i++) {
        uint32_t u = faces->data[i], v = faces->data[i % 3 == 2 ? i - 2 : i + 1];
        double p = b->heights.data[u], q = b->heights.data[v];
        if (u < v && p * q < 0)
            TRY(split_edge(b, u, v, p / (p - q)));
    }
    return STARG_OK;
}

/* What is reached from a loop's left side without crossing it goes to another piece. */
static starg_status part(cone_builder *b, uint32_t which, const edge_list *edges,
                         const cut_node *loop, size_t count, uint32_t fresh) {
    SCOPED number_list stack = {0};
    number_list *own = NULL;
    SCOPED uint32_t *next = NULL;
    size_t kept = 0;
    NEW(b->context, STAGE, next, b->about.count);
    memset(next, 0xff, b->about.count * sizeof *next);
    for (size_t i = 0; i < count; i++)
        next[loop[i].from] = loop[(i + 1) % count].from;
    PUSH(b->context, STAGE, &stack, across(edges, loop[1].from, loop[0].from));
    while (stack.count > 0) {
        uint32_t t = stack.data[--stack.count], corners[3];
        size_t side = b_side(b, t, 0) == which ? 0 : 1;
        if (b_side(b, t, side) != which)
            continue;
        corners_of(b, t, which, corners);
        b->sides.data[2 * (size_t)t + side] = fresh;
        PUSH(b->context, STAGE, &b->pieces.data[fresh].triangles, t);
        for (int k = 0; k < 3; k++)
            if (next[corners[k]] != corners[(k + 1) % 3])
                PUSH(b->context, STAGE, &stack, across(edges, corners[k], corners[(k + 1) % 3]));
    }
    own = &b->pieces.data[which].triangles;
    for (size_t i = 0; i < own->count; i++)
        if (b_side(b, own->data[i], 0) == which || b_side(b, own->data[i], 1) == which)
            own->data[kept++] = own->data[i];
    own->count = kept;
    return STARG_OK;
}

static starg_status build_wall(cone_builder *b, uint32_t which, const edge_list *edges,
                               const cut_node *loop, size_t count, loop_places places[2]) {
    uint32_t fresh, hub;
    double hubs[2][3], room;
    for (int end = 0; end < 2; end++) {
        TRY(place_loop(b, end, loop, count, &places[end]));
        TRY(find_hub(b, &places[end], hubs[end], &room));
    }
    TRY(open_piece(b, b->pieces.data[which].attempts / 2, &fresh));
    TRY(part(b, which, edges, loop, count, fresh));
    TRY(add_vertex(b, (const double(*)[3])hubs, &hub));
    for (size_t i = 0; i < count; i++) {
        const uint32_t corners[3] = {loop[(i + 1) % count].from, loop[i].from, hub};
        const uint32_t sides[2] = {fresh, which};
        TRY(add_triangle(b, corners, sides));
    }
    return STARG_OK;
}

/* The piece that holds the left side of an edge of `which` by now: itself or a later one. */
static uint32_t holder_of(const cone_builder *b, uint32_t which, const edge_list *edges, uint32_t u,
                          uint32_t v, uint32_t first_fresh) {
    uint32_t t = across(edges, v, u);
    for (size_t s = 0; s < 2; s++)
        if (b_side(b, t, s) == which ||
            (b_side(b, t, s) >= first_fresh && b_side(b, t, s) != NOWHERE))
            return b_side(b, t, s);
    return which;
}

/* Cuts a piece along the heights of its vertices, where hubs have more room than `least`. */
static starg_status apply_cut(cone_builder *b, uint32_t which, double least, cut_choice *c,
                              bool *done) {
    SCOPED edge_list edges = {0};
    uint32_t first_fresh = (uint32_t)b->pieces.count;
    TRY(split_crossed(b, &c->faces));
    TRY(list_edges(b, which, &c->edges));
    TRY(list_faces(b, which, &c->faces));
    TRY(make_trees(b, c));
    TRY(find_loops(b, which, &c->edges, b->heights.data, &c->loops, done));
    if (!*done)
        return STARG_OK;
    TRY(find_rooms(b, c, least));
    *done = false;
    const cut_node *loop = c->loops.nodes.data;
    for (size_t i = 0; i < c->loops.lengths.count; loop += c->loops.lengths.data[i++]) {
        if (!(c->loops.rooms.data[i] > 0))
            continue;
        *done = true;
        uint32_t holder = holder_of(b, which, &c->edges, loop[0].from, loop[1].from, first_fresh);
        TRY(list_edges(b, holder, &edges));
        TRY(build_wall(b, holder, &edges, loop, c->loops.lengths.data[i], c->places));
    }
    return STARG_OK;
}

static starg_status cut_piece(cone_builder *b, uint32_t which, int blind, number_list *faces) {
    SCOPED_BY(choice_free) cut_choice c = {.faces = *faces};
    b->work += faces->count / 3;
    bool done = false;
    *faces = (number_list){0};
    TRY(choose_cut(b, which, blind, &c));
    double least = b->pieces.data[which].attempts < TIGHT_FROM ? ROOMY : TIGHT;
    if (c.room > least)
        TRY(apply_cut(b, which, least, &c, &done));
    if (done)
        b->pieces.data[which].attempts /= 2;
    else
        b->pieces.data[which].attempts++;
    return STARG_OK;
}

/* ---- all pieces ---- */

/* Later cuts may have divided faces of pieces that were done, with rounded points. */
static starg_status prove(cone_builder *b, uint32_t which, number_list *faces) {
    cone_piece *own = &b->pieces.data[which];
    TRY(list_faces(b, which, faces));
    for (int end = 0; end < 2 && own->done; end++) {
        const kernel_faces surface = {b->places[end].data, faces->data, faces->count / 3};
        own->done = kernel_sees_all(&surface, own->centers[end]);
    }
    return STARG_OK;
}

/* Cuts until all are done (*left is 0) or one resists. */
static starg_status cut_all(cone_builder *b, size_t *left) {
    SCOPED number_list faces = {0};
    size_t most = GROWTH_MOST * (b->corners.count / 3);
    bool again = true;
    while (again) {
        again = false;
        for (uint32_t p = 0; p < b->pieces.count; p++)
            while (!b->pieces.data[p].done) {
                int blind;
                *left = 1;
                if (b->pieces.data[p].attempts == ATTEMPTS_MOST || b->corners.count / 3 > most)
                    return STARG_OK;
                TRY(starg_check_cancel(b->context, STAGE));
                TRY(list_faces(b, p, &faces));
                TRY(find_centers(b, p, &faces, &blind));
                if (blind >= 0)
                    TRY(cut_piece(b, p, blind, &faces));
            }
        *left = 0;
        for (uint32_t p = 0; p < b->pieces.count; p++) {
            bool before = b->pieces.data[p].done;
            TRY(prove(b, p, &faces));
            again = again || (before && !b->pieces.data[p].done);
            *left += !b->pieces.data[p].done;
        }
    }
    return STARG_OK;
}

/* ---- the result ---- */

/* Vertices of the surface first: those given, and those that divide it. */
static starg_status number_vertices(const cone_builder *b, uint32_t *numbers, size_t *surface) {
    size_t count = b->about.count, next = 0;
    memset(numbers, 0xff, count * sizeof *numbers);
    for (size_t t = 0; t < b->corners.count / 3; t++)
        if (b->sides.data[2 * t + 1] == NOWHERE)
            for (size_t k = 0; k < 3; k++)
                numbers[b->corners.data[3 * t + k]] = 0;
    for (size_t v = 0; v < count; v++)
        if (numbers[v] == 0)
            numbers[v] = (uint32_t)next++;
    *surface = next;
    for (size_t v = 0; v < count; v++)
        if (numbers[v] == NOWHERE)
            numbers[v] = (uint32_t)next++;
    return STARG_OK;
}

static starg_status make_places(const cone_builder *b, const uint32_t *numbers, int end,
                                double **out) {
    size_t count = b->about.count;
    NEW(b->context, STAGE, *out, 3 * (count + b->pieces.count));
    for (size_t v = 0; v < count; v++)
        vec3_copy(b->places[end].data + 3 * v, *out + 3 * (size_t)numbers[v]);
    for (size_t p = 0; p < b->pieces.count; p++)
        vec3_copy(b->pieces.data[p].centers[end], *out + 3 * (count + p));
    return STARG_OK;
}

static starg_status finish(const cone_builder *b, compatible_cones *out) {
    SCOPED uint32_t *numbers = NULL;
    SCOPED number_list faces = {0};
    size_t next = 0;
    out->vertex_count = b->about.count + b->pieces.count;
    out->piece_count = b->pieces.count;
    for (uint32_t p = 0; p < b->pieces.count; p++)
        out->count += b->pieces.data[p].triangles.count;
    NEW(b->context, STAGE, numbers, b->about.count);
    NEW(b->context, STAGE, out->tetrahedra, 4 * out->count);
    NEW(b->context, STAGE, out->labels, out->count);
    TRY(number_vertices(b, numbers, &out->surface_count));
    for (int end = 0; end < 2; end++)
        TRY(make_places(b, numbers, end, &out->places[end]));
    for (uint32_t p = 0; p < b->pieces.count; p++) {
        TRY(list_faces(b, p, &faces));
        for (size_t f = 0; f < faces.count; f += 3) {
            uint32_t *cone = out->tetrahedra + 4 * next;
            cone[0] = numbers[faces.data[f]];
            cone[1] = numbers[faces.data[f + 2]];
            cone[2] = numbers[faces.data[f + 1]];
            cone[3] = (uint32_t)(b->about.count + p);
            out->labels[next++] = p;
        }
    }
    return STARG_OK;
}

void compatible_cones_free(starg_context *context, compatible_cones *cones) {
    for (int end = 0; end < 2; end++)
        starg_release(context, cones->places[end]);
    RELEASE(cones->tetrahedra, cones->labels);
    *cones = (compatible_cones){0};
}

starg_status compatible_fill(starg_context *context, const double *const places[2], size_t vertices,
                             const uint32_t *faces, size_t count, compatible_cones *out,
                             size_t *left) {
    starg_status status = STARG_OK;
    cone_builder b = {.context = context};
    *out = (compatible_cones){0};
    *left = 1;
    for (uint64_t round = 0; round<ROUNDS && * left> 0 && b.work < WORK_MOST; round++) {
        size_t work = b.work;
        builder_free(&b);
        b = (cone_builder){.context = context,
                           .work = work,
                           .scratch = {.context = context},
                           .rng = starg_rng_make(context->seed, 3, round)};
        STARG_TRY(begin(&b, places, vertices, faces, count));
        STARG_TRY(cut_all(&b, left));
    }
    if (*left == 0)
        STARG_TRY(finish(&b, out));
done:
    builder_free(&b);
    if (status != STARG_OK)
        compatible_cones_free(context, out);
    return status;
}
