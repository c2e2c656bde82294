/* SPDX-License-Identifier: Apache-2.0 */
/* Chooses for each point between the contour engine and the grid, which give the same bits.
 *
 * The grid's work falls with the number of faces behind others, most of which it skips; the contour
 * engine's work grows with the contours, wherever they lie. So points with fewer front-facing
 * faces, or with more contours, go to the grid. Both numbers are known before anything is sorted:
 * faces by their sides, contours from a sample of the edges.
 *
 * The dividing line is fitted to the cycles of both engines at skeleton nodes (37 models of 500 to
 * 100,000 vertices, eight and sixteen lanes). On each model of 600 vertices or more the choice
 * costs at most 5 % more than the better engine alone, on average 1 % less, except where points in
 * special positions are common (cad), for which the contours are tried in vain. Without lanes the
 * contour engine, which mainly compares, pays only with almost no contours.
 *
 * Cost: a pass over the sides of the faces, and over some thousand edges. */
#include "visibility/contours.h"

/* The contour engine pays if there are fewer contours per vertex than SLOPE times the fraction of
 * front-facing faces, minus an offset. */
static const double SLOPE = 2, OFFSET_WITH_LANES = 1.1, OFFSET_PLAIN = 1.5;

static starg_status make_scratch(const visibility_scene *scene, void **scratch) {
    return visibility_contours.make_scratch(scene, scratch);
}

static void free_scratch(const visibility_scene *scene, void *scratch) {
    visibility_contours.free_scratch(scene, scratch);
}

static double share_of_front_faces(const visibility_scene *scene, const int8_t *side) {
    size_t front_facing = 0;
    for (size_t rank = 0; rank < scene->face_count; rank++)
        front_facing += side[rank] > 0;
    return (double)front_facing / (double)scene->face_count;
}

static double contours_per_vertex(const visibility_scene *scene, const int8_t *side) {
    const visibility_adjacency *adjacency = scene->adjacency;
    size_t stride = 8 + adjacency->edge_count / 4096, count = 0;
    for (size_t e = 0; e < adjacency->edge_count; e += stride)
        count += (side[adjacency->edges[e].left] > 0) != (side[adjacency->edges[e].right] > 0);
    return (double)(stride * count) / (double)scene->vertex_count;
}

static bool contours_pay(const visibility_scene *scene, const contours_scratch *s,
                         const int8_t *side) {
    double offset = s->variant == &contours_plain ? OFFSET_PLAIN : OFFSET_WITH_LANES;
    return contours_per_vertex(scene, side) < SLOPE * share_of_front_faces(scene, side) - offset;
}

static void find(const visibility_scene *scene, void *scratch, const double p[3],
                 const int8_t *side, const scene_view *view, uint8_t *visible) {
    const contours_scratch *s = scratch;
    if (scene->adjacency != NULL && contours_pay(scene, s, side))
        visibility_contours.find(scene, scratch, p, side, view, visible);
    else
        visibility_grid.find(scene, s->grid, p, side, view, visible);
}

const visibility_engine visibility_fastest = {make_scratch, free_scratch, find, NULL};
