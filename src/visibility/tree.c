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
    const scene_point *point; /* in place of the vertex in `slot`, or NULL */
} sight_query;

static bool holds_end(const sight_query *query, size_t rank) {
    return query->point != NULL ? scene_has_point(query->scene, rank, query->point)
                                : scene_has_corner(query->scene, rank, query->slot);
}

static bool blocks(const sight_query *query, size_t rank, int side) {
    return query->point != NULL
               ? scene_blocks_point(query->scene, rank, side, query->p, query->point)
               : scene_blocks(query->scene, rank, side, query->p, query->slot);
}

static int likely_side_of_end(const sight_query *query, size_t rank) {
    return query->point != NULL ? scene_likely_side_of(query->scene, rank, &query->point->place)
                                : scene_likely_side(query->scene, rank, query->q);
}

/* Most faces have both ends on the same side, as their planes tell. */
static bool passes_alone(void *user, size_t rank) {
    const sight_query *query = user;
    const visibility_scene *scene = query->scene;
    int side = scene_likely_side(scene, rank, query->p);
    if (side != 0 &&
        (!scene_may_block(scene, rank, (int8_t)side) || side == likely_side_of_end(query, rank)))
        return true;
    if (side == 0 && holds_end(query, rank))
        side = scene_side(scene, rank, query->p);
    return !blocks(query, rank, side);
}

/* Without planes, for ends that may lie outside the box. */
static bool passes_exactly(void *user, size_t rank) {
    const sight_query *query = user;
    int side = holds_end(query, rank) ? scene_side(query->scene, rank, query->p) : 0;
    return !blocks(query, rank, side);
}

/* Boxes in single precision are larger by more than points are off, unless coordinates are huge
 * beside the extent. */
static bool is_free(sight_query *query) {
    const visibility_scene *scene = query->scene;
    const bvh *tree = scene->solid->tree;
    double blur = query->point != NULL ? query->point->place.blur : 0;
    if (scene->sights != NULL && scene_holds(scene, query->p) && blur < 0x1p-24 * scene->extent)
        return sight_tree_query(scene->sights, query->p, query->q, passes_alone, query);
    return blur > 0 ? bvh_query_near_segment(tree, query->p, query->q, blur, passes_exactly, query)
                    : bvh_query_segment(tree, query->p, query->q, passes_exactly, query);
}

static bool sees_vertex(const visibility_scene *scene, const double p[3], uint32_t slot,
                        const sensor *looks) {
    const double q[3] = {scene->x[slot], scene->y[slot], scene->z[slot]};
    const scene_point *point =
        slot < scene->vertex_count ? NULL : &scene->points[slot - scene->vertex_count];
    sight_query query = {scene, p, q, slot, point};
    return sensor_reaches(looks, p, q) && sensor_frames(looks, p, q) && is_free(&query);
}

bool scene_sees_point(const visibility_scene *scene, const double p[3], const scene_point *point,
                      const sensor *looks) {
    sight_query query = {scene, p, point->place.at, 0, point};
    return sensor_reaches(looks, p, point->place.at) && sensor_frames(looks, p, point->place.at) &&
           is_free(&query);
}

static bool sees_side(const visibility_scene *scene, const double p[3], size_t rank, size_t patch,
                      const sensor *looks) {
    const uint32_t *corner = scene_patch_corners(scene, patch);
    size_t corners = scene_patch_size(scene);
    if (scene_side(scene, rank, p) <= 0 || !scene_faces_patch(scene, looks, p, rank, patch) ||
        !scene_resolves_patch(scene, looks, p, patch))
        return false;
    for (size_t k = 0; k < corners; k++)
        if (!sees_vertex(scene, p, corner[k], looks))
            return false;
    return looks->options->face_rule != STARG_FACES_WHOLE ||
           patch_is_wholly_visible(scene, p, NULL, rank, patch);
}

static sensor aimed(const visibility_scene *scene, const starg_visibility_options *options) {
    sensor looks = scene_sensor(scene, options);
    if (sensor_is_directed(options))
        sensor_aim(&looks, options->directions, options->ups);
    return looks;
}

bool scene_sees_vertex(const visibility_scene *scene, const double p[3], uint32_t slot,
                       const starg_visibility_options *options) {
    const sensor looks = aimed(scene, options);
    return sees_vertex(scene, p, slot, &looks);
}

bool scene_sees_patch(const visibility_scene *scene, const double p[3], size_t patch,
                      const starg_visibility_options *options) {
    const sensor looks = aimed(scene, options);
    size_t face = solid_patch_face(scene->solid, patch), rank = scene->rank_of[face];
    uint32_t back = scene_back(scene, rank);
    size_t behind = patch - solid_first_patch(scene->solid, face);
    return sees_side(scene, p, rank, patch, &looks) ||
           (back != SCENE_NONE &&
            sees_side(scene, p, back,
                      solid_first_patch(scene->solid, scene->face_of[back]) + behind, &looks));
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

bool scene_sees_slot(const visibility_scene *scene, const double p[3], const int8_t *side,
                     uint32_t slot) {
    const double q[3] = {scene->x[slot], scene->y[slot], scene->z[slot]};
    const bvh *tree = scene->solid->tree;
    tree_query query = {scene, p, side, slot};
    return slot < scene->vertex_count
               ? bvh_query_segment(tree, p, q, passes, &query)
               : bvh_query_near_segment(tree, p, q, scene->blur, passes, &query);
}

static void find(const visibility_scene *scene, void *scratch, const double p[3],
                 const int8_t *side, const scene_view *view, uint8_t *visible) {
    (void)view;
    (void)scratch;
    for (uint32_t slot = 0; slot < scene->slot_count; slot++)
        visible[slot] = scene_sees_slot(scene, p, side, slot);
}

const visibility_engine visibility_tree = {make_scratch, free_scratch, find, NULL};
