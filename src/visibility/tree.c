/* Visibility by a bounding volume hierarchy: one query per vertex, O(log n) where little stands
 * between. Uses every face, whatever its side. */
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

const visibility_engine visibility_tree = {make_scratch, free_scratch, find};
