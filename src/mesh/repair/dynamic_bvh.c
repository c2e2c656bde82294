/* SPDX-License-Identifier: Apache-2.0 */
/* Bounding volume hierarchy under edge collapses: when a face leaves the box of its leaf, that box
 * and its ancestors grow; dead faces are skipped. Boxes never shrink, so no face is missed.
 * Rebuilding when half of the faces are dead keeps boxes tight and costs at most twice the first
 * construction in total. */
#include "mesh/repair/dynamic_bvh.h"

#include "core/memory.h"

bvh_box dynamic_bvh_face_box(const mesh_surface *surface, const uint32_t corner[3]) {
    bvh_box box;
    for (int k = 0; k < 3; k++) {
        double x = surface_at(surface, corner[0])[k], y = surface_at(surface, corner[1])[k];
        double z = surface_at(surface, corner[2])[k];
        double low = x < y ? x : y, high = x < y ? y : x;
        box.lower[k] = low < z ? low : z;
        box.upper[k] = high > z ? high : z;
    }
    return box;
}

bool dynamic_bvh_boxes_meet(const bvh_box *a, const bvh_box *b) {
    for (int k = 0; k < 3; k++)
        if (a->upper[k] < b->lower[k] || b->upper[k] < a->lower[k])
            return false;
    return true;
}

static void clear(dynamic_bvh *n) {
    bvh_free(n->tree);
    starg_release(n->context, n->corners);
    starg_release(n->context, n->face);
    starg_release(n->context, n->parent);
    n->tree = NULL;
    n->corners = n->face = n->parent = NULL;
}

/* Lists the living faces. */
static starg_status list_faces(dynamic_bvh *n) {
    starg_status status = STARG_OK;
    const mesh_surface *surface = n->surface;
    size_t count = 0;
    for (uint32_t f = 0; f < surface->face_count; f++)
        count += halfedges_face_lives(&surface->mesh, f);
    STARG_NEW(n->context, "simplify", n->corners, 3 * count);
    STARG_NEW(n->context, "simplify", n->face, count);
    n->listed = 0;
    for (uint32_t f = 0; f < surface->face_count; f++) {
        if (!halfedges_face_lives(&surface->mesh, f))
            continue;
        for (size_t k = 0; k < 3; k++)
            n->corners[3 * n->listed + k] = surface_face(surface, f)[k];
        n->face[n->listed++] = f;
    }
done:
    return status;
}

static bool is_leaf(const dynamic_bvh *n, const bvh_node *node) {
    return node->count > 0 || n->tree->node_count == 1;
}

static void link_nodes(dynamic_bvh *n) {
    n->parent[0] = 0;
    for (uint32_t i = 0; i < n->tree->node_count; i++) {
        const bvh_node *node = &n->tree->nodes[i];
        if (!is_leaf(n, node))
            n->parent[node->first] = n->parent[node->first + 1] = i;
        else
            for (uint32_t j = node->first; j < node->first + node->count; j++)
                n->leaf[n->face[n->tree->order[j]]] = i;
    }
}

static starg_status build(dynamic_bvh *n) {
    starg_status status = STARG_OK;
    STARG_TRY(list_faces(n));
    STARG_TRY(bvh_create(n->context, n->surface->vertices, n->corners, n->listed, &n->tree));
    STARG_NEW(n->context, "simplify", n->parent, n->tree->node_count);
    link_nodes(n);
done:
    return status;
}

starg_status dynamic_bvh_create(starg_context *context, const mesh_surface *surface,
                                dynamic_bvh **out) {
    starg_status status = STARG_OK;
    dynamic_bvh *tree = NULL;
    *out = NULL;
    STARG_NEW_ZERO(context, "simplify", tree, 1);
    tree->context = context;
    tree->surface = surface;
    STARG_NEW(context, "simplify", tree->leaf, surface->face_count);
    STARG_TRY(build(tree));
    *out = tree;
done:
    if (status != STARG_OK)
        dynamic_bvh_free(tree);
    return status;
}

void dynamic_bvh_free(dynamic_bvh *tree) {
    if (tree == NULL)
        return;
    clear(tree);
    starg_release(tree->context, tree->leaf);
    starg_release(tree->context, tree);
}

/* Extends a box to contain another; false if it already did. */
static bool enclose(bvh_box *box, const bvh_box *other) {
    bool grown = false;
    for (int k = 0; k < 3; k++) {
        if (other->lower[k] < box->lower[k]) {
            box->lower[k] = other->lower[k];
            grown = true;
        }
        if (other->upper[k] > box->upper[k]) {
            box->upper[k] = other->upper[k];
            grown = true;
        }
    }
    return grown;
}

void dynamic_bvh_update(dynamic_bvh *n, uint32_t face) {
    bvh_box box = dynamic_bvh_face_box(n->surface, surface_face(n->surface, face));
    uint32_t node = n->leaf[face];
    while (enclose(&n->tree->nodes[node].box, &box) && node != 0)
        node = n->parent[node];
}

starg_status dynamic_bvh_renew(dynamic_bvh *n) {
    if (2 * n->surface->faces_left > n->listed)
        return STARG_OK;
    clear(n);
    return build(n);
}

typedef struct box_query {
    const dynamic_bvh *tree;
    const bvh_box *box;
    bvh_visit *visit;
    void *user;
} box_query;

static bool may_meet(void *user, const bvh_box *box) {
    const box_query *query = user;
    return dynamic_bvh_boxes_meet(query->box, box);
}

static bool visit_rank(void *user, size_t rank) {
    const box_query *query = user;
    const dynamic_bvh *n = query->tree;
    uint32_t face = n->face[n->tree->order[rank]];
    if (!halfedges_face_lives(&n->surface->mesh, face))
        return true;
    bvh_box own = dynamic_bvh_face_box(n->surface, surface_face(n->surface, face));
    return !dynamic_bvh_boxes_meet(&own, query->box) || query->visit(query->user, face);
}

bool dynamic_bvh_query(const dynamic_bvh *tree, const bvh_box *box, bvh_visit *visit, void *user) {
    box_query query = {tree, box, visit, user};
    return bvh_query(tree->tree, may_meet, &query, visit_rank, &query);
}
