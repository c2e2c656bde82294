/* SPDX-License-Identifier: Apache-2.0 */
/* Pieces of two solids with the same faces, bounded by triangles that lie in two places at once:
 * what divides edges, finds the loops in which a cut meets a piece, and the hubs of flat walls in
 * them.
 *
 * Invariant: triangles fit together, edge to edge, in all pieces: an edge is divided in all of its
 * triangles. Cost: linear in the piece, or n log n for loops. */
#include "star/compatible/cone_builder.h"

#include <stdlib.h>

#include "geometry/intersect.h"
#include "geometry/linear_program.h"
#include "geometry/vec3.h"

static const char STAGE[] = "cones";
enum { FAIR_FROM = 2, HALVE_FROM = 5, EFFORT = 1 };
static const double MARGIN = 2e-5; /* of the extent, for guards of the plane search */
static const double SHORT = 1e-7;  /* of a spoke: it ends on the surface */
static const double SNAP = 1e-4;   /* of an edge: a cut that near an end goes through it */

void cones_free(cone_builder *b) {
    for (int end = 0; end < 2; end++)
        STARG_ARRAY_FREE(b->context, &b->places[end]);
    for (size_t v = 0; v < b->about.count; v++)
        STARG_ARRAY_FREE(b->context, &b->about.data[v]);
    for (size_t p = 0; p < b->pieces.count; p++)
        STARG_ARRAY_FREE(b->context, &b->pieces.data[p].triangles);
    RELEASE(b->about.data, b->corners.data, b->sides.data, b->pieces.data, b->heights.data);
    region_scratch_free(&b->scratch);
}

/* ---- states ---- */

starg_status cones_save(const cone_builder *b, cone_state *out) {
    *out = (cone_state){.vertices = b->about.count};
    RESERVE(b->context, STAGE, &out->corners, b->corners.count);
    RESERVE(b->context, STAGE, &out->sides, b->sides.count);
    RESERVE(b->context, STAGE, &out->pieces, b->pieces.count);
    out->corners.count = b->corners.count;
    out->sides.count = b->sides.count;
    out->pieces.count = b->pieces.count;
    memcpy(out->corners.data, b->corners.data, b->corners.count * sizeof *b->corners.data);
    memcpy(out->sides.data, b->sides.data, b->sides.count * sizeof *b->sides.data);
    for (size_t p = 0; p < b->pieces.count; p++) {
        out->pieces.data[p] = b->pieces.data[p];
        out->pieces.data[p].triangles = (number_list){0};
    }
    return STARG_OK;
}

starg_status cones_restore(cone_builder *b, const cone_state *state) {
    for (size_t v = 0; v < b->about.count; v++)
        STARG_ARRAY_FREE(b->context, &b->about.data[v]);
    for (size_t p = 0; p < b->pieces.count; p++)
        STARG_ARRAY_FREE(b->context, &b->pieces.data[p].triangles);
    b->about.count = b->heights.count = state->vertices;
    b->places[0].count = b->places[1].count = 3 * state->vertices;
    b->corners.count = b->sides.count = 0;
    memset(b->about.data, 0, state->vertices * sizeof *b->about.data);
    b->pieces.count = state->pieces.count;
    memcpy(b->pieces.data, state->pieces.data, state->pieces.count * sizeof *b->pieces.data);
    for (size_t t = 0; t < state->corners.count / 3; t++)
        TRY(cones_add_triangle(b, state->corners.data + 3 * t, state->sides.data + 2 * t));
    return STARG_OK;
}

void cones_free_state(cone_state *state) {
    RELEASE(state->corners.data, state->sides.data, state->pieces.data);
}

const double *cones_place_of(const cone_builder *b, int end, uint32_t vertex) {
    return b->places[end].data + 3 * (size_t)vertex;
}

static uint32_t side_of_triangle(const cone_builder *b, uint32_t triangle, size_t side) {
    return b->sides.data[2 * (size_t)triangle + side];
}

/* The corners of a triangle, counter-clockwise seen from outside of the piece. */
void cones_corners_of(const cone_builder *b, uint32_t triangle, uint32_t which, uint32_t out[3]) {
    bool turned = b->sides.data[2 * (size_t)triangle] != which;
    for (size_t k = 0; k < 3; k++)
        out[k] = b->corners.data[3 * (size_t)triangle + (turned ? 2 - k : k)];
}

/* ---- building ---- */

starg_status cones_add_vertex(cone_builder *b, const double from[2][3], uint32_t *out) {
    *out = (uint32_t)b->about.count;
    for (int end = 0; end < 2; end++)
        for (int k = 0; k < 3; k++)
            PUSH(b->context, STAGE, &b->places[end], from[end][k]);
    PUSH(b->context, STAGE, &b->about, ((number_list){0}));
    PUSH(b->context, STAGE, &b->heights, 0);
    return STARG_OK;
}

starg_status cones_add_triangle(cone_builder *b, const uint32_t corners[3],
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
starg_status cones_split_edge(cone_builder *b, uint32_t u, uint32_t v, double share) {
    double middle[2][3];
    uint32_t fresh;
    for (int end = 0; end < 2; end++)
        for (int k = 0; k < 3; k++)
            middle[end][k] =
                (1 - share) * cones_place_of(b, end, u)[k] + share * cones_place_of(b, end, v)[k];
    TRY(cones_add_vertex(b, (const double(*)[3])middle, &fresh));
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
        TRY(cones_add_triangle(b, corners, sides));
    }
    return STARG_OK;
}

starg_status cones_open_piece(cone_builder *b, int attempts, uint32_t *out) {
    *out = (uint32_t)b->pieces.count;
    PUSH(b->context, STAGE, &b->pieces, ((cone_piece){.attempts = attempts}));
    return STARG_OK;
}

starg_status cones_list_faces(const cone_builder *b, uint32_t which, number_list *out) {
    const number_list *own = &b->pieces.data[which].triangles;
    out->count = 0;
    for (size_t i = 0; i < own->count; i++) {
        uint32_t corners[3];
        cones_corners_of(b, own->data[i], which, corners);
        for (int k = 0; k < 3; k++)
            PUSH(b->context, STAGE, out, corners[k]);
    }
    return STARG_OK;
}

/* ---- heights ---- */

/* Heights of the piece's vertices over a plane of one place. */
void cones_find_heights(cone_builder *b, int end, const number_list *faces, const double normal[3],
                        const double point[3], double *out) {
    double offset = vec3_dot(normal, point);
    for (size_t i = 0; i < faces->count; i++)
        out[faces->data[i]] = vec3_dot(normal, cones_place_of(b, end, faces->data[i])) - offset;
}

/* Over a plane that leaves less of the piece unseen in one place. */
starg_status cones_search_plane(cone_builder *b, uint32_t which, int end, const number_list *faces,
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
        cones_find_heights(b, end, faces, plane.normal, point, heights);
    }
    return STARG_OK;
}

/* Over a random plane, between two of its corners. */
void cones_draw_plane(cone_builder *b, int end, const number_list *faces, double *heights) {
    const double *ends[2];
    double normal[3], noise[3], middle[3];
    for (int i = 0; i < 2; i++)
        ends[i] = cones_place_of(b, end, faces->data[starg_rng_below(&b->rng, faces->count)]);
    vec3_subtract(ends[1], ends[0], normal);
    starg_rng_direction(&b->rng, noise);
    vec3_along(normal, 0.5 * vec3_length(normal), noise, normal);
    double share = starg_rng_unit(&b->rng);
    for (int k = 0; k < 3; k++)
        middle[k] = (1 - share) * ends[0][k] + share * ends[1][k];
    cones_find_heights(b, end, faces, normal, middle, heights);
}

/* Cuts near an end of an edge go through it. */
void cones_snap(const number_list *faces, double *heights) {
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

void cones_free_loops(cut_loops *loops) {
    RELEASE(loops->nodes.data, loops->lengths.data);
}

static uint64_t edge_name(uint32_t u, uint32_t v) {
    return (uint64_t)u << 32 | v;
}

static int by_edge(const void *left, const void *right) {
    const side_edge *a = left, *b = right;
    return (a->edge > b->edge) - (a->edge < b->edge);
}

/* All of a piece, ascending. */
starg_status cones_list_edges(const cone_builder *b, uint32_t which, edge_list *out) {
    const number_list *own = &b->pieces.data[which].triangles;
    out->count = 0;
    for (size_t i = 0; i < own->count; i++) {
        uint32_t corners[3];
        cones_corners_of(b, own->data[i], which, corners);
        for (int k = 0; k < 3; k++)
            PUSH(b->context, STAGE, out,
                 ((side_edge){edge_name(corners[k], corners[(k + 1) % 3]), own->data[i]}));
    }
    qsort(out->data, out->count, sizeof *out->data, by_edge);
    return STARG_OK;
}

/* The triangle across an edge. */
uint32_t cones_across(const edge_list *edges, uint32_t u, uint32_t v) {
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
    return cones_edge_name(node->from, node->to);
}

static int by_start(const void *left, const void *right) {
    uint64_t a = node_name(&((const cut_step *)left)->nodes[0]);
    uint64_t b = node_name(&((const cut_step *)right)->nodes[0]);
    return (a > b) - (a < b);
}

typedef STARG_ARRAY(cut_step) step_list;

/* The way through a triangle that is crossed: in by the edge that goes down, out by the one that
 * goes up, so that what is above is on the left. */
static cut_step step_through(const uint32_t corners[3], const double *heights) {
    cut_step step = {{{NOWHERE, NOWHERE, 0}, {NOWHERE, NOWHERE, 0}}};
    for (int k = 0; k < 3; k++) {
        uint32_t u = corners[k], v = corners[(k + 1) % 3], w = corners[(k + 2) % 3];
        double p = heights[u], q = heights[v];
        if (cones_are_opposite(p, q))
            step.nodes[p < 0] = (cut_node){u, v, p / (p - q)};
        else if (q == 0 && cones_are_opposite(p, heights[w]))
            step.nodes[p < 0] = (cut_node){v, NOWHERE, 0};
    }
    return step;
}

static starg_status list_steps(const cone_builder *b, uint32_t which, const edge_list *edges,
                               const double *heights, step_list *out) {
    const number_list *own = &b->pieces.data[which].triangles;
    for (size_t i = 0; i < own->count; i++) {
        uint32_t corners[3], other[3];
        cones_corners_of(b, own->data[i], which, corners);
        int side = side_of(corners, heights);
        if (side == 2)
            PUSH(b->context, STAGE, out, step_through(corners, heights));
        for (int k = 0; k < 3 && (side == 1 || side == 0); k++) {
            uint32_t u = corners[k], v = corners[(k + 1) % 3], beyond = NOWHERE;
            if (heights[u] == 0 && heights[v] == 0)
                beyond = cones_across(edges, u, v);
            if (beyond == NOWHERE)
                continue;
            cones_corners_of(b, beyond, which, other);
            if (side_of(other, heights) == -1)
                PUSH(b->context, STAGE, out, ((cut_step){{{u, NOWHERE, 0}, {v, NOWHERE, 0}}}));
        }
    }
    if (out->count > 0)
        qsort(out->data, out->count, sizeof *out->data, by_start);
    return STARG_OK;
}

/* Follows the cut. *simple: there is one, and no node is passed twice. */
starg_status cones_find_loops(const cone_builder *b, uint32_t which, const edge_list *edges,
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

starg_status cones_place_loop(const cone_builder *b, int end, const cut_node *nodes, size_t count,
                              loop_places *out) {
    double sum = 0;
    *out = (loop_places){.points = out->points};
    out->points.count = 0;
    for (size_t i = 0; i < count; i++) {
        const double *p = cones_place_of(b, end, nodes[i].from);
        const double *q = nodes[i].to == NOWHERE ? p : cones_place_of(b, end, nodes[i].to);
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

/* A point from which the loop, seen along its normal, is passed to the left: the one farthest from
 * the lines of its edges, at the height of the mean. Its distance, over the extent; at most 0:
 * there is none. */
starg_status cones_find_hub(cone_builder *b, const loop_places *loop, double hub[3], double *room) {
    size_t count = loop->points.count / 3;
    double axes[2][3];
    SCOPED double *rows = NULL;
    SCOPED uint32_t *order = NULL;
    linear_solution solution;
    *room = 0;
    if (!(vec3_length(loop->normal) > 0 && loop->extent > 0))
        return STARG_OK;
    vec3_axes_across(loop->normal, axes);
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

/* ---- walls ---- */

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
bool cones_is_inside(const bvh *tree, const loop_places *loop, const double hub[3]) {
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

/* What is reached from a loop's left side without crossing it goes to another piece. */
starg_status cones_part(cone_builder *b, uint32_t which, const edge_list *edges,
                        const cut_node *loop, size_t count, uint32_t fresh) {
    SCOPED number_list stack = {0};
    number_list *own = NULL;
    SCOPED uint32_t *next = NULL;
    size_t kept = 0;
    NEW(b->context, STAGE, next, b->about.count);
    memset(next, 0xff, b->about.count * sizeof *next);
    for (size_t i = 0; i < count; i++)
        next[loop[i].from] = loop[(i + 1) % count].from;
    PUSH(b->context, STAGE, &stack, cones_across(edges, loop[1].from, loop[0].from));
    while (stack.count > 0) {
        uint32_t t = stack.data[--stack.count], corners[3];
        if (t == NOWHERE)
            continue; /* across a rim */
        size_t side = side_of_triangle(b, t, 0) == which ? 0 : 1;
        if (side_of_triangle(b, t, side) != which)
            continue;
        cones_corners_of(b, t, which, corners);
        b->sides.data[2 * (size_t)t + side] = fresh;
        PUSH(b->context, STAGE, &b->pieces.data[fresh].triangles, t);
        for (int k = 0; k < 3; k++)
            if (next[corners[k]] != corners[(k + 1) % 3])
                PUSH(b->context, STAGE, &stack,
                     cones_across(edges, corners[k], corners[(k + 1) % 3]));
    }
    own = &b->pieces.data[which].triangles;
    for (size_t i = 0; i < own->count; i++)
        if (side_of_triangle(b, own->data[i], 0) == which ||
            side_of_triangle(b, own->data[i], 1) == which)
            own->data[kept++] = own->data[i];
    own->count = kept;
    return STARG_OK;
}
