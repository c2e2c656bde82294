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

typedef struct sight_query {
    const visibility_scene *scene;
    const double *p, *q;
    uint32_t slot;
} sight_query;

/* Most faces have both ends on the same side, as their planes tell. */
static bool passes_alone(void *user, size_t rank) {
    const sight_query *query = user;
    const visibility_scene *scene = query->scene;
    int side = scene_likely_side(scene, rank, query->p);
    if (side != 0 && (!scene_may_block(scene, rank, (int8_t)side) ||
                      side == scene_likely_side(scene, rank, query->q)))
        return true;
    if (side == 0 && scene_has_corner(scene, rank, query->slot))
        side = scene_side(scene, rank, query->p);
    return !scene_blocks(scene, rank, side, query->p, query->slot);
}

/* Without planes, for ends that may lie outside the box. */
static bool passes_exactly(void *user, size_t rank) {
    const sight_query *query = user;
    const visibility_scene *scene = query->scene;
    int side = scene_has_corner(scene, rank, query->slot) ? scene_side(scene, rank, query->p) : 0;
    return !scene_blocks(scene, rank, side, query->p, query->slot);
}

static bool is_free(sight_query *query) {
    const visibility_scene *scene = query->scene;
    return scene->sights != NULL && scene_holds(scene, query->p)
               ? sight_tree_query(scene->sights, query->p, query->q, passes_alone, query)
               : bvh_query_segment(scene->solid->tree, query->p, query->q, passes_exactly, query);
}

static bool sees_vertex(const visibility_scene *scene, const double p[3], uint32_t slot,
                        const sensor *looks) {
    const double q[3] = {scene->x[slot], scene->y[slot], scene->z[slot]};
    sight_query query = {scene, p, q, slot};
    return sensor_reaches(looks, p, q) && sensor_frames(looks, p, q) && is_free(&query);
}

static bool sees_side(const visibility_scene *scene, const double p[3], size_t rank,
                      const sensor *looks) {
    const double *a = scene_corner(scene, rank, 0), *b = scene_corner(scene, rank, 1);
    const double *c = scene_corner(scene, rank, 2);
    if (scene_side(scene, rank, p) <= 0 || !sensor_faces(looks, p, a, b, c))
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
