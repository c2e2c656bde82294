/* SPDX-License-Identifier: Apache-2.0 */
/* Visibility by a bounding volume hierarchy: one query per vertex, O(log n) if few faces are in
 * between. Uses every face, on either side. */
#include "geometry/predicates.h"
#include "visibility/scene.h"

typedef struct tree_query {
    const visibility_scene *scene;
    const double *p;
    const int8_t *side;
    uint32_t slot;
} tree_query;

static bool passes(void *user, size_t rank) {
    const tree_query *query = user;
    return !scene_blocks(query->scene, rank, query->side[rank], query->p, query->slot);
}

/* For a single vertex the sides are not precomputed; only those of its own faces matter. */
static bool passes_alone(void *user, size_t rank) {
    const tree_query *query = user;
    int side = 0;
    if (scene_has_corner(query->scene, rank, query->slot))
        side = orient3d(scene_corner(query->scene, rank, 0), scene_corner(query->scene, rank, 1),
                        scene_corner(query->scene, rank, 2), query->p);
    return !scene_blocks(query->scene, rank, side, query->p, query->slot);
}

bool scene_sees_vertex(const visibility_scene *scene, const double p[3], uint32_t slot,
                       const starg_visibility_options *options) {
    const double q[3] = {scene->x[slot], scene->y[slot], scene->z[slot]};
    tree_query query = {scene, p, NULL, slot};
    if (options->range < 1e100 && compare_distance(p, q, options->range) > 0)
        return false;
    if (options->cone < 360 &&
        compare_cone(p, options->directions, starg_cone_cosine(options->cone), q) < 0)
        return false;
    return bvh_query_segment(scene->solid->tree, p, q, passes_alone, &query);
}

bool scene_sees_face(const visibility_scene *scene, const double p[3], size_t rank,
                     const starg_visibility_options *options) {
    if (orient3d(scene_corner(scene, rank, 0), scene_corner(scene, rank, 1),
                 scene_corner(scene, rank, 2), p) <= 0)
        return false;
    for (size_t k = 0; k < 3; k++)
        if (!scene_sees_vertex(scene, p, scene->corners[3 * rank + k], options))
            return false;
    return options->face_rule != STARG_FACES_WHOLE || face_is_wholly_visible(scene, p, NULL, rank);
}

static starg_status make_scratch(const visibility_scene *scene, void **scratch) {
    (void)scene;
    *scratch = NULL;
    return STARG_OK;
}

static void free_scratch(const visibility_scene *scene, void *scratch) {
    (void)scene;
    (void)scratch;
}

static void find(const visibility_scene *scene, void *scratch, const double p[3],
                 const int8_t *side, uint8_t *visible) {
    (void)scratch;
    for (uint32_t slot = 0; slot < scene->vertex_count; slot++) {
        const double q[3] = {scene->x[slot], scene->y[slot], scene->z[slot]};
        tree_query query = {scene, p, side, slot};
        visible[slot] = bvh_query_segment(scene->solid->tree, p, q, passes, &query);
    }
}

const visibility_engine visibility_tree = {make_scratch, free_scratch, find, NULL};
