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

static bool sees_vertex(const visibility_scene *scene, const double p[3], uint32_t slot,
                        const sensor *looks) {
    const double q[3] = {scene->x[slot], scene->y[slot], scene->z[slot]};
    tree_query query = {scene, p, NULL, slot};
    return sensor_reaches(looks, p, q) && sensor_frames(looks, p, q) &&
           bvh_query_segment(scene->solid->tree, p, q, passes_alone, &query);
}

static bool sees_side(const visibility_scene *scene, const double p[3], size_t rank,
                      const sensor *looks) {
    const double *a = scene_corner(scene, rank, 0), *b = scene_corner(scene, rank, 1);
    const double *c = scene_corner(scene, rank, 2);
    if (orient3d(a, b, c, p) <= 0 || !sensor_faces(looks, p, a, b, c))
        return false;
    for (size_t k = 0; k < 3; k++)
        if (!sees_vertex(scene, p, scene->corners[3 * rank + k], looks))
            return false;
    return looks->options->face_rule != STARG_FACES_WHOLE ||
           face_is_wholly_visible(scene, p, NULL, rank);
}

static sensor aimed(const starg_visibility_options *options) {
    sensor looks = sensor_of(options);
    if (sensor_is_directed(options))
        sensor_aim(&looks, options->directions, options->ups);
    return looks;
}

bool scene_sees_vertex(const visibility_scene *scene, const double p[3], uint32_t slot,
                       const starg_visibility_options *options) {
    const sensor looks = aimed(options);
    return sees_vertex(scene, p, slot, &looks);
}

bool scene_sees_face(const visibility_scene *scene, const double p[3], size_t rank,
                     const starg_visibility_options *options) {
    const sensor looks = aimed(options);
    uint32_t back = scene_back(scene, rank);
    return sees_side(scene, p, rank, &looks) ||
           (back != SCENE_NONE && sees_side(scene, p, back, &looks));
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
