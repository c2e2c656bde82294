/* SPDX-License-Identifier: Apache-2.0 */
/* Stage 2 of the contour engine (visibility/contours.c): which edges the count follows. Included by
 * the stages.
 *
 * Any neighbour that precedes a vertex in the adjacency's order can be its parent: no cycle is
 * possible, and all paths lead to the root of the shell. Only edges needed for vertices with
 * front-facing faces are followed; the others are hidden anyway. */

/* The nearest of the best. */
static void choose_parents(const visibility_scene *scene, contours_scratch *s) {
    const uint32_t *choices = scene->adjacency->parents;
    for (size_t slot = 0; slot < scene->vertex_count; slot++) {
        const uint32_t *choice = choices + CHOICES * slot;
        uint32_t best = choice[CHOICES - 1], grade = s->grade[best];
        for (uint32_t k = CHOICES - 1; k-- > 0;) {
            bool better = s->grade[choice[k]] <= grade;
            best = better ? choice[k] : best;
            grade = better ? s->grade[choice[k]] : grade;
        }
        s->parent[slot] = best;
    }
}

/* Marks front and mixed vertices, and the paths from them to their roots. */
static void mark_followed(const visibility_scene *scene, contours_scratch *s) {
    uint32_t *starts = s->tree_edges; /* for now those whose parents are pending */
    size_t start_count = 0;
    for (uint32_t slot = 0; slot < scene->vertex_count; slot++) {
        s->followed[slot] = s->grade[slot] != SLOT_BACK;
        starts[start_count] = s->parent[slot];
        start_count += s->followed[slot] & (s->grade[s->parent[slot]] == SLOT_BACK);
    }
    for (size_t i = 0; i < start_count; i++)
        for (uint32_t slot = starts[i]; !s->followed[slot]; slot = s->parent[slot])
            s->followed[slot] = true;
}

/* Stage 2: a tree path to each vertex with a front-facing face. */
static void choose_tree_edges(const visibility_scene *scene, contours_scratch *s) {
    choose_parents(scene, s);
    mark_followed(scene, s);
    s->tree_edge_count = 0;
    for (uint32_t slot = 0; slot < scene->vertex_count; slot++) {
        s->tree_edges[s->tree_edge_count] = slot;
        s->tree_edge_count += s->followed[slot];
    }
}
