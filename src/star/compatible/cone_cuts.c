/* SPDX-License-Identifier: Apache-2.0 */
/* Cuts of pieces: the planes that are tried, what they part, how much of a part can be seen, and
 * the division of a piece.
 *
 * A cut is given by heights of the piece's vertices: it passes where they are 0. What is above, and
 * hangs together there, is a part; a leaf is a part that is bounded by one loop. Cost: linear in
 * the faces of the piece, but for n log n where edges are listed. */
#include "star/compatible/cone_builder.h"

#include "geometry/linear_program.h"
#include "geometry/vec3.h"
#include "mesh/topology.h"

static const char STAGE[] = "cones";
enum { TRIES = 100 };
static const double TURN = 1e-3;  /* the sine of an angle at a notch, at least */
static const double LEVEL = 1e-9; /* of the heights: those of vertices in a face's plane */

/* ---- planes ---- */

void cones_draw_notch(cone_builder *b, uint32_t which, int end, const number_list *faces,
                      const edge_list *edges, double *heights, bool *found) {
    *found = false;
    for (int i = 0; i < TRIES && !*found; i++) {
        size_t f = 3 * (size_t)starg_rng_below(&b->rng, faces->count / 3), k = i % 3;
        const uint32_t *corner = faces->data + f;
        uint32_t beyond = cones_across(edges, corner[k], corner[(k + 1) % 3]), other[3];
        const double *at = cones_place_of(b, end, corner[0]);
        double normal[3], way[3];
        cones_find_normal(b, end, corner, normal);
        double size = vec3_length(normal);
        if (beyond == NOWHERE || !(size > 0))
            continue;
        cones_corners_of(b, beyond, which, other);
        double rise = 0, reach = 0;
        for (int j = 0; j < 3; j++) {
            vec3_subtract(cones_place_of(b, end, other[j]), at, way);
            rise = fmax(rise, vec3_dot(normal, way) / size);
            reach = fmax(reach, vec3_length(way));
        }
        *found = rise > TURN * reach;
        for (int j = 0; j < 3; j++)
            normal[j] /= -size;
        if (*found)
            cones_find_heights(b, end, faces, normal, at, heights);
    }
    double most = 0;
    for (size_t i = 0; i < faces->count && *found; i++)
        most = fmax(most, fabs(heights[faces->data[i]]));
    for (size_t i = 0; i < faces->count && *found; i++)
        if (fabs(heights[faces->data[i]]) < LEVEL * most)
            heights[faces->data[i]] = 0;
}

/* ---- parts ---- */

void cones_find_parts(const number_list *faces, const double *heights, bool through, uint32_t *part,
                      uint8_t *flat) {
    for (size_t i = 0; i < faces->count; i++) {
        part[faces->data[i]] = faces->data[i];
        flat[faces->data[i]] = 0;
    }
    for (size_t i = 0; i < faces->count; i += 3) {
        const uint32_t *corner = faces->data + i;
        bool in = heights[corner[0]] == 0 && heights[corner[1]] == 0 && heights[corner[2]] == 0;
        for (int k = 0; k < 3 && in; k++) {
            flat[corner[k]] = 1;
            if (through)
                sets_join(part, corner[k], corner[(k + 1) % 3]);
        }
    }
    for (size_t i = 0; i < faces->count; i++) {
        uint32_t u = faces->data[i], v = faces->data[i % 3 == 2 ? i - 2 : i + 1];
        double p = heights[u], q = heights[v];
        if ((p > 0 && (q > 0 || (through && flat[v]))) || (through && q > 0 && flat[u]))
            sets_join(part, u, v);
    }
}

void cones_keep_part(const number_list *vertices, const double *heights, uint32_t *part,
                     uint32_t root, double *out) {
    for (size_t i = 0; i < vertices->count; i++) {
        uint32_t v = vertices->data[i];
        bool other = heights[v] > 0 && sets_find(part, v) != root;
        out[v] = other ? -heights[v] : heights[v];
    }
}

void cones_drop_flat(const number_list *faces, const uint8_t *flat, double *heights) {
    double least = 0;
    bool any = false;
    for (size_t i = 0; i < faces->count; i++) {
        const double height = heights[faces->data[i]];
        least = height < least ? height : least;
        any = any || flat[faces->data[i]];
    }
    if (!any)
        return;
    for (size_t i = 0; i < faces->count; i++)
        if (flat[faces->data[i]])
            heights[faces->data[i]] = least;
    for (size_t i = 0; i < faces->count; i++) {
        uint32_t u = faces->data[i], v = faces->data[i % 3 == 2 ? i - 2 : i + 1];
        if (heights[u] > 0 && flat[v])
            heights[v] = 0;
        if (heights[v] > 0 && flat[u])
            heights[u] = 0;
    }
}

starg_status cones_list_side(const cone_builder *b, const number_list *faces, const double *heights,
                             bool below, number_list *out) {
    out->count = 0;
    for (size_t i = 0; i < faces->count; i += 3) {
        const uint32_t *corner = faces->data + i;
        bool on = false;
        for (int k = 0; k < 3; k++)
            on = on || (below ? heights[corner[k]] < 0 : heights[corner[k]] > 0);
        for (int k = 0; k < 3 && on; k++)
            PUSH(b->context, STAGE, out, corner[k]);
    }
    return STARG_OK;
}

/* ---- views ---- */

void cones_find_normal(const cone_builder *b, int end, const uint32_t corner[3], double out[3]) {
    vec3_triangle_normal(cones_place_of(b, end, corner[0]), cones_place_of(b, end, corner[1]),
                         cones_place_of(b, end, corner[2]), out);
}

void cones_put_row(const double normal[3], const double point[3], double *row) {
    double size = vec3_length(normal);
    for (int k = 0; k < 3; k++)
        row[k] = size > 0 ? normal[k] / size : 0;
    row[3] = size > 0 ? 1 : 0;
    row[4] = size > 0 ? vec3_dot(normal, point) / size : 1;
}

starg_status cones_see(const cone_builder *b, int end, const number_list *faces,
                       const double *further, size_t count, const double center[3], double extent,
                       side_view *out) {
    SCOPED double *rows = NULL;
    SCOPED uint32_t *order = NULL;
    linear_solution solution;
    const size_t own = faces->count / 3;
    NEW(b->context, STAGE, rows, 5 * (own + count));
    NEW(b->context, STAGE, order, own + count);
    *out = (side_view){.room = 0};
    memcpy(rows + 5 * own, further, 5 * count * sizeof *rows);
    for (size_t i = 0; i < faces->count; i += 3) {
        double normal[3];
        cones_find_normal(b, end, faces->data + i, normal);
        out->area += 0.5 * vec3_length(normal);
        cones_put_row(normal, cones_place_of(b, end, faces->data[i]), rows + 5 * (i / 3));
    }
    double size = sqrt(out->area);
    linear_program program = {.dimension = 4,
                              .rows = rows,
                              .count = own + count,
                              .objective = {0, 0, 0, 1},
                              .radius = 64 * (size + extent)};
    vec3_copy(center, program.center);
    linear_program_solve(&program, order, NULL, &solution);
    out->room = solution.feasible && size > 0 ? solution.point[3] / size : 0;
    vec3_copy(solution.point, out->point);
    for (size_t i = 0; i < faces->count; i += 3) {
        double normal[3], way[3];
        cones_find_normal(b, end, faces->data + i, normal);
        vec3_subtract(cones_place_of(b, end, faces->data[i]), out->point, way);
        out->seen += vec3_dot(way, normal) > 0 ? 0.5 * vec3_length(normal) : 0;
    }
    return STARG_OK;
}

/* ---- the division ---- */

starg_status cones_part_leaf(cone_builder *b, uint32_t which, const number_list *faces,
                             edge_list *edges, cut_loops *rim, uint32_t *leaf, bool *done) {
    double *heights = b->heights.data;
    size_t former = b->about.count;
    for (size_t i = 0; i < faces->count; i++) {
        uint32_t u = faces->data[i], v = faces->data[i % 3 == 2 ? i - 2 : i + 1];
        double p = heights[u], q = heights[v];
        if (u < v && cones_are_opposite(p, q)) {
            TRY(cones_split_edge(b, u, v, p / (p - q)));
            heights = b->heights.data;
        }
    }
    for (size_t v = former; v < b->about.count; v++)
        heights[v] = 0;
    TRY(cones_list_edges(b, which, edges));
    TRY(cones_find_loops(b, which, edges, heights, rim, done));
    *done = *done && rim->lengths.count == 1;
    if (!*done)
        return STARG_OK;
    TRY(cones_open_piece(b, 0, leaf));
    return cones_part(b, which, edges, rim->nodes.data, rim->nodes.count, *leaf);
}
